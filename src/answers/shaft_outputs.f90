!> What the history tells of the shafts.
module evl_shaft_outputs
   use evl_kinds, only: wp
   use evl_output, only: dims_shaft, in_shaft_constants, in_shafts, needs_meshes, needs_nothing
   use evl_shaft, only: shaft_t
   use evl_teller, only: begin, needs, tell, teller_t
   implicit none (type, external)
   private

   public :: tell_shaft, tell_shaft_constants

contains

   subroutine tell_shaft_constants(teller, index, shaft)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      type(shaft_t), intent(in) :: shaft

      call begin(teller, in_shaft_constants, dims_shaft, index, is_static=.true.)
      call tell(teller, "shaft_wheel_first", "1", "", "index of the first wheel, from 0", shaft%wheel_a - 1)
      call tell(teller, "shaft_wheel_second", "1", "", "index of the second wheel, from 0", shaft%wheel_b - 1)
      call tell(teller, "rigid_shaft", "1", "", "1 if the shaft cannot twist", shaft%rigid)
      call tell(teller, "shaft_stiffness", "N m rad-1", "c", "torsional stiffness; 0 for a rigid shaft", &
                merge(0.0_wp, shaft%stiffness, shaft%rigid))
      call tell(teller, "shaft_damping", "N m s rad-1", "d", "torsional damping; 0 for a rigid shaft", &
                merge(0.0_wp, shaft%damping, shaft%rigid))
   end subroutine tell_shaft_constants

   subroutine tell_shaft(teller, index, torque, twist)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      real(wp), intent(in) :: torque !! that it carries [N m]
      real(wp), intent(in) :: twist  !! [rad]

      call begin(teller, in_shafts, dims_shaft, index)
      call needs(teller, needs_meshes)
      call tell(teller, "shaft_torque", "N m", "T", "torque on the second wheel; on the first one its opposite", torque)
      call needs(teller, needs_nothing)
      call tell(teller, "shaft_twist", "rad", "", "angle of the first wheel less that of the second", twist)
   end subroutine tell_shaft

end module evl_shaft_outputs
