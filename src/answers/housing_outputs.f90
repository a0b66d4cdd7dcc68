!> What the history tells of the housing: reactions of the wheels on it, its pose and motion, and energies seen from the ground.
!>
!> Source: docs/housing.md, sections 2 and 4.
module evl_housing_outputs
   use evl_gearbox, only: axle_acceleration, gearbox_t, wheel_position, wheel_speed, wheel_t
   use evl_housing, only: apparent_acceleration, frame_t, wheel_moment
   use evl_kinds, only: wp
   use evl_output, only: dims_accelerometer, dims_mesh, dims_none, dims_wheel, in_accelerometers, in_bearings, &
                         in_mesh_positions, in_mount, in_pose, in_wheel_positions, needs_nothing, needs_rates, needs_reactions
   use evl_rotation, only: cross, turned
   use evl_teller, only: begin, needs, tell, teller_t
   use evl_tooth_contact, only: tooth_contact_t
   use evl_wheel_loads, only: wheel_housing_torque
   implicit none (type, external)
   private

   public :: add_mesh_reaction, finish_reaction
   public :: tell_accelerometer, tell_bearing, tell_mesh_position, tell_mount, tell_pose, tell_wheel_position

contains

   !> Where a wheel stands along its axle.
   subroutine tell_wheel_position(teller, index, wheel)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      type(wheel_t), intent(in) :: wheel

      call begin(teller, in_wheel_positions, dims_wheel, index, is_static=.true.)
      call tell(teller, "axial_position", "m", "z_i", "axial position of the middle of the wheel", wheel%axial_position)
      call tell(teller, "transverse_inertia", "kg m2", "J_t", "moment of inertia about a diameter", wheel%transverse_inertia)
   end subroutine tell_wheel_position

   !> Where a mesh stands along the axles.
   subroutine tell_mesh_position(teller, index, contact)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      type(tooth_contact_t), intent(in) :: contact !! the first of the mesh

      call begin(teller, in_mesh_positions, dims_mesh, index, is_static=.true.)
      call tell(teller, "contact_axial_position", "m", "z_m", "axial position of the middle of the common width", &
                contact%axial_position)
   end subroutine tell_mesh_position

   !> What a wheel does to the housing.
   subroutine tell_bearing(teller, index, reaction)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      real(wp), intent(in) :: reaction(6) !! force [N], moment [N m]

      call begin(teller, in_bearings, dims_wheel, index)
      call needs(teller, needs_reactions)
      call tell(teller, "bearing_force", "N", "", "force of the wheel on the housing, housing frame", reaction(1:3))
      call tell(teller, "bearing_moment", "N m", "", "moment of the wheel and its loads on the housing about the wheel's centre", &
                reaction(4:6))
   end subroutine tell_bearing

   !> Pose and motion of a housing that is not fixed.
   subroutine tell_pose(teller, frame, gravity)
      type(teller_t), intent(inout) :: teller
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: gravity(3) !! [m/s^2]

      call begin(teller, in_pose, dims_none, 1)
      call tell(teller, "housing_position", "m", "r", "position of the housing's origin, ground frame", frame%position)
      call tell(teller, "housing_orientation", "1", "p", "unit quaternion from the housing frame to the ground frame", &
                frame%orientation)
      call tell(teller, "housing_velocity", "m s-1", "v", "velocity of the housing's origin, ground frame", frame%velocity, &
                rate_of="housing_position")
      call needs(teller, needs_rates)
      call tell(teller, "housing_acceleration", "m s-2", "v'", "acceleration of the housing's origin, ground frame", &
                turned(frame%rotation, frame%acceleration) + gravity, rate_of="housing_velocity")
      call needs(teller, needs_nothing)
      call tell(teller, "housing_angular_velocity", "rad s-1", "Omega", "angular velocity of the housing, housing frame", &
                frame%omega, no_rate="the rate of the orientation is its product with the quaternion")
      call needs(teller, needs_rates)
      call tell(teller, "housing_angular_acceleration", "rad s-2", "Omega'", "angular acceleration of the housing, housing frame", &
                frame%alpha, rate_of="housing_angular_velocity")
   end subroutine tell_pose

   !> Of a mounted housing.
   subroutine tell_mount(teller, loss)
      type(teller_t), intent(inout) :: teller
      real(wp), intent(in) :: loss !! [W]

      call begin(teller, in_mount, dims_none, 1)
      call tell(teller, "mount_damping_loss", "W", "P_m", "power lost in the dampers of the mount", loss, &
                rate_of="dissipated_energy")
   end subroutine tell_mount

   subroutine tell_accelerometer(teller, index, acceleration)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      real(wp), intent(in) :: acceleration !! [m/s^2]

      call begin(teller, in_accelerometers, dims_accelerometer, index)
      call needs(teller, needs_rates)
      call tell(teller, "accelerometer_acceleration", "m s-2", "a_k", &
                "acceleration of the housing there along the direction, gravity not counted", acceleration, &
                no_rate="along a direction that turns with the housing: no output has its integral")
   end subroutine tell_accelerometer

   !> Add a mesh's force to the reactions of its two wheels.
   pure subroutine add_mesh_reaction(gearbox, contact, on_a, reactions)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: on_a(2)               !! force on the driving wheel in (t_0, e_0) [N]
      real(wp), intent(inout) :: reactions(:, :)    !! (6, wheel): force [N], moment [N m]
      real(wp) :: force(3), arm_a(3), arm_b(3)

      associate (a => contact%wheel_a, b => contact%wheel_b)
         force = [on_a(1)*contact%t_0 + on_a(2)*contact%e_0, 0.0_wp]
         arm_a = [0.0_wp, 0.0_wp, contact%axial_position - gearbox%wheels(a)%axial_position]
         arm_b = [0.0_wp, 0.0_wp, contact%axial_position - gearbox%wheels(b)%axial_position]
         reactions(:, a) = reactions(:, a) + [force, cross(arm_a, force)]
         reactions(:, b) = reactions(:, b) - [force, cross(arm_b, force)]
      end associate
   end subroutine add_mesh_reaction

   !> From the forces of the meshes on a wheel to its reaction on the housing.
   pure subroutine finish_reaction(gearbox, index, t, y, f, integers, frame, load_torque, reaction)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t, y(:), f(:)
      integer, intent(in) :: integers(:)
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: load_torque
      real(wp), intent(inout) :: reaction(6)
      real(wp) :: centre(3), velocity(3), acceleration(3), moment(3)

      associate (wheel => gearbox%wheels(index))
         acceleration = axle_acceleration(wheel, t, f)
         if (gearbox%housing%acts) then
            call wheel_position(wheel, t, y, centre, velocity)
            acceleration = acceleration + apparent_acceleration(frame, centre, velocity)
            moment = wheel_moment(frame, wheel%inertia, wheel%transverse_inertia, wheel_speed(wheel, y), wheel_speed(wheel, f))
            reaction(4:5) = reaction(4:5) - moment(1:2)
         end if
         reaction(1:3) = reaction(1:3) - wheel%support%mass*acceleration
         reaction(6) = reaction(6) - wheel_housing_torque(gearbox, index, frame%omega(3), load_torque, t, y, integers)
      end associate
   end subroutine finish_reaction

end module evl_housing_outputs
