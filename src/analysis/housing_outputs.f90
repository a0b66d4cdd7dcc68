!> Outputs of the housing at eight states: its pose and motion, mount and accelerometers; and the axial positions of wheels and
!> meshes.
!>
!> Source: docs/theory/housing.md, sections 2 and 4.
module evl_housing_outputs
   use evl_gearbox, only: wheel_t
   use evl_housing, only: felt_acceleration, frame_t, housing_t, mount_force, mount_loss
   use evl_kinds, only: lanes, wp
   use evl_output, only: dims_accelerometer, dims_mesh, dims_none, dims_wheel, in_accelerometers, in_mesh_positions, in_mount, &
                         in_pose, in_wheel_positions, needs_nothing, needs_rates
   use evl_output_registry, only: add_output, begin_section, needs, registry_t, stores
   use evl_rotation, only: turned
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: add_accelerometer, add_mesh_position, add_mount, add_pose, add_wheel_position

contains

   !> Axial position of a wheel.
   subroutine add_wheel_position(registry, index, wheel)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      type(wheel_t), intent(in) :: wheel

      call begin_section(registry, in_wheel_positions, dims_wheel, index, is_static=.true.)
      call add_output(registry, "axial_position", "m", "z_i", "axial position of the middle of the wheel", wheel%axial_position)
      call add_output(registry, "transverse_inertia", "kg m2", "J_t", "moment of inertia about a diameter", &
                      wheel%transverse_inertia)
   end subroutine add_wheel_position

   !> Axial position of a mesh.
   subroutine add_mesh_position(registry, index, contact)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      type(tooth_contact_t), intent(in) :: contact !! first contact of the mesh

      call begin_section(registry, in_mesh_positions, dims_mesh, index, is_static=.true.)
      call add_output(registry, "contact_axial_position", "m", "z_m", "axial position of the middle of the common width", &
                      contact%axial_position)
   end subroutine add_mesh_position

   !> Pose and motion of a housing that is not fixed.
   subroutine add_pose(registry, frames, gravity)
      type(registry_t), intent(inout) :: registry
      type(frame_t), intent(in) :: frames(lanes)
      real(wp), intent(in) :: gravity(3) !! [m/s^2]
      real(wp) :: at(lanes, 19)
      integer :: l

      do l = 1, lanes
         associate (frame => frames(l))
            at(l, :) = [frame%position, frame%orientation, frame%velocity, &
                        turned(frame%rotation, frame%acceleration) + gravity, frame%omega, frame%alpha]
         end associate
      end do
      call begin_section(registry, in_pose, dims_none, 1)
      call add_output(registry, "housing_position", "m", "r", "position of the housing's origin, ground frame", at(:, 1:3))
      call add_output(registry, "housing_orientation", "1", "p", "unit quaternion from the housing frame to the ground frame", &
                      at(:, 4:7))
      call add_output(registry, "housing_velocity", "m s-1", "v", "velocity of the housing's origin, ground frame", at(:, 8:10), &
                      rate_of="housing_position")
      call needs(registry, needs_rates)
      call add_output(registry, "housing_acceleration", "m s-2", "v'", "acceleration of the housing's origin, ground frame", &
                      at(:, 11:13), rate_of="housing_velocity")
      call needs(registry, needs_nothing)
      call add_output(registry, "housing_angular_velocity", "rad s-1", "Omega", "angular velocity of the housing, housing frame", &
                      at(:, 14:16), no_rate="the rate of the orientation is its product with the quaternion")
      call needs(registry, needs_rates)
      call add_output(registry, "housing_angular_acceleration", "rad s-2", "Omega'", &
                      "angular acceleration of the housing, housing frame", at(:, 17:19), rate_of="housing_angular_velocity")
   end subroutine add_pose

   !> Outputs of a mounted housing.
   subroutine add_mount(registry, housing, frames)
      type(registry_t), intent(inout) :: registry
      type(housing_t), intent(in) :: housing
      type(frame_t), intent(in) :: frames(lanes)
      real(wp) :: force(3), loss(lanes), velocity(3)
      integer :: l

      loss = 0
      do l = 1, merge(lanes, 0, housing%is_mounted)
         call mount_force(housing, frames(l), force, velocity)
         loss(l) = mount_loss(housing, frames(l), velocity)
      end do
      call begin_section(registry, in_mount, dims_none, 1)
      call add_output(registry, "mount_damping_loss", "W", "P_m", "power lost in the dampers of the mount", loss, &
                      rate_of="dissipated_energy")
   end subroutine add_mount

   !> Outputs of one accelerometer.
   subroutine add_accelerometer(registry, index, housing, frames)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      type(housing_t), intent(in) :: housing
      type(frame_t), intent(in) :: frames(lanes)
      real(wp) :: felt(lanes) !! [m/s^2]
      integer :: l

      felt = 0
      if (stores(registry)) felt = [(felt_acceleration(housing, frames(l), housing%accelerometers(index)), l=1, lanes)]
      call begin_section(registry, in_accelerometers, dims_accelerometer, index)
      call needs(registry, needs_rates)
      call add_output(registry, "accelerometer_acceleration", "m s-2", "a_k", &
                      "acceleration of the housing there along the direction, without gravity", felt, &
                      no_rate="along a direction that turns with the housing: no output has its integral")
   end subroutine add_accelerometer

end module evl_housing_outputs
