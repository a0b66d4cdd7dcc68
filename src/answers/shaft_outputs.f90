!> What the history tells of the shafts.
module evl_shaft_outputs
   use evl_gearbox, only: gearbox_t
   use evl_housing, only: frame_t
   use evl_kinds, only: wp
   use evl_output, only: dims_shaft, output_t
   use evl_outside_torques, only: shaft_torques
   use evl_shaft, only: shaft_twist
   implicit none (type, external)
   private

   public :: n_shaft_outputs, shaft_outputs, put_shafts

   integer, parameter :: n_shaft_outputs = 7

contains

   !> Their entries in the table of outputs; a gearbox without shafts has no such values.
   pure function shaft_outputs() result(t)
      type(output_t) :: t(n_shaft_outputs)

      t(1) = output_t("shaft_wheel_first", "1", "", "index of the first wheel, from 0", dims_shaft, .true., .true.)
      t(2) = output_t("shaft_wheel_second", "1", "", "index of the second wheel, from 0", dims_shaft, .true., .true.)
      t(3) = output_t("rigid_shaft", "1", "", "1 if the shaft cannot twist", dims_shaft, .true., .true.)
      t(4) = output_t("shaft_stiffness", "N m rad-1", "c", "torsional stiffness; 0 for a rigid shaft", dims_shaft, .true.)
      t(5) = output_t("shaft_damping", "N m s rad-1", "d", "torsional damping; 0 for a rigid shaft", dims_shaft, .true.)
      t(6) = output_t("shaft_torque", "N m", "T", "torque on the second wheel; on the first one its opposite", dims_shaft)
      t(7) = output_t("shaft_twist", "rad", "", "angle of the first wheel less that of the second", dims_shaft)
   end function shaft_outputs

   !> All of these values, in the order of the table.
   pure subroutine put_shafts(gearbox, y, f, frame, torque, n, values)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(:), f(:)      !! f: rates of the states
      type(frame_t), intent(in) :: frame      !! of the housing there
      real(wp), intent(in) :: torque(:)       !! of meshes and loads on every wheel [N m]
      integer, intent(in) :: n                !! shafts
      real(wp), intent(inout) :: values(n, n_shaft_outputs)
      integer :: i

      call shaft_torques(gearbox, y, f, frame, torque, values(:, 6))
      do i = 1, n
         associate (shaft => gearbox%shafts(i))
            values(i, 1:2) = [shaft%wheel_a - 1, shaft%wheel_b - 1]
            values(i, 3:5) = [0.0_wp, shaft%stiffness, shaft%damping]
            if (shaft%rigid) values(i, 3:5) = [1.0_wp, 0.0_wp, 0.0_wp]
            values(i, 7) = shaft_twist(shaft, y)
         end associate
      end do
   end subroutine put_shafts

end module evl_shaft_outputs
