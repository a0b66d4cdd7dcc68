!> What the history tells of the housing: reactions of the wheels on it, its pose and motion, and energies seen from the ground.
!>
!> Source: docs/housing.md, sections 2 and 4.
module evl_housing_outputs
   use evl_gearbox, only: gearbox_t, wheel_housing_torque, wheel_position, wheel_speed
   use evl_housing, only: apparent_acceleration, frame_t, housing_fixed, wheel_moment
   use evl_housing_dynamics, only: wheel_accelerations
   use evl_kinds, only: wp
   use evl_output, only: dims_mesh, dims_quaternion, dims_space, dims_wheel, dims_wheel_space, output_t
   use evl_rotation, only: cross, turned
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: n_housing_outputs, housing_outputs, add_mesh_reaction, put_housing

   integer, parameter :: n_housing_outputs = 11

contains

   !> Their entries in the table of outputs. The pose and the motion are there if the housing is not fixed.
   pure function housing_outputs() result(t)
      type(output_t) :: t(n_housing_outputs)

      t(1) = output_t("axial_position", "m", "z_i", "axial position of the middle of the wheel", dims_wheel, .true.)
      t(2) = output_t("transverse_inertia", "kg m2", "J_t", "moment of inertia about a diameter", dims_wheel, .true.)
      t(3) = output_t("contact_axial_position", "m", "z_m", "axial position of the middle of the common width", dims_mesh, .true.)
      t(4) = output_t("bearing_force", "N", "", "force of the wheel on the housing, housing frame", dims_wheel_space)
      t(5) = output_t("bearing_moment", "N m", "", "moment of the wheel and its loads on the housing about the wheel's centre", &
                      dims_wheel_space)
      t(6) = output_t("housing_position", "m", "r", "position of the housing's origin, ground frame", dims_space)
      t(7) = output_t("housing_orientation", "1", "p", "unit quaternion from the housing frame to the ground frame", &
                      dims_quaternion)
      t(8) = output_t("housing_velocity", "m s-1", "v", "velocity of the housing's origin, ground frame", dims_space)
      t(9) = output_t("housing_acceleration", "m s-2", "v'", "acceleration of the housing's origin, ground frame", dims_space)
      t(10) = output_t("housing_angular_velocity", "rad s-1", "Omega", "angular velocity of the housing, housing frame", dims_space)
      t(11) = output_t("housing_angular_acceleration", "rad s-2", "Omega'", "angular acceleration of the housing, housing frame", &
                       dims_space)
   end function housing_outputs

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

   !> All of these values, in the order of the table.
   pure subroutine put_housing(gearbox, t, y, f, integers, frame, load_torque, reactions, values)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(:), f(:)        !! f: rates of the states
      integer, intent(in) :: integers(:)
      type(frame_t), intent(in) :: frame           !! there
      real(wp), intent(in) :: load_torque(:)       !! of every wheel [N m]
      real(wp), intent(inout) :: reactions(:, :)   !! (6, wheel): those of the meshes, then all of them
      real(wp), intent(out) :: values(:)
      integer :: i, n, nm

      n = size(gearbox%wheels)
      nm = size(gearbox%pairs)
      values(:n) = gearbox%wheels%axial_position
      values(n + 1:2*n) = gearbox%wheels%transverse_inertia
      values(2*n + 1:2*n + nm) = gearbox%contacts(gearbox%first(:nm))%axial_position
      do i = 1, n
         call finish_reaction(gearbox, i, t, y, f, integers, frame, load_torque(i), reactions(:, i))
         associate (force => 2*n + nm + 3*(i - 1), moment => 5*n + nm + 3*(i - 1))
            values(force + 1:force + 3) = reactions(1:3, i)
            values(moment + 1:moment + 3) = reactions(4:6, i)
         end associate
      end do
      if (gearbox%housing%kind == housing_fixed) return
      values(8*n + nm + 1:) = [frame%position, frame%orientation, frame%velocity, &
                               turned(frame%rotation, frame%acceleration) + gearbox%housing%gravity, frame%omega, frame%alpha]
   end subroutine put_housing

   !> From the forces of the meshes on a wheel to its reaction on the housing.
   pure subroutine finish_reaction(gearbox, index, t, y, f, integers, frame, load_torque, reaction)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t, y(:), f(:)
      integer, intent(in) :: integers(:)
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: load_torque
      real(wp), intent(inout) :: reaction(6)
      real(wp) :: centre(3), velocity(3), acceleration(3), moment(3), turn, speed

      associate (wheel => gearbox%wheels(index))
         call wheel_accelerations(wheel, f, turn, acceleration)
         speed = wheel_speed(wheel, y)
         if (gearbox%housing%acts) then
            call wheel_position(wheel, y, centre, velocity)
            acceleration = acceleration + apparent_acceleration(frame, centre, velocity)
            moment = wheel_moment(frame, wheel%inertia, wheel%transverse_inertia, speed, turn)
            reaction(4:5) = reaction(4:5) - moment(1:2)
         end if
         reaction(1:3) = reaction(1:3) - wheel%support%mass*acceleration
         reaction(6) = reaction(6) - wheel_housing_torque(gearbox, index, t, speed, frame%omega(3), load_torque, integers)
      end associate
   end subroutine finish_reaction

end module evl_housing_outputs
