!> What the history tells of the gearbox as a whole.
module evl_gearbox_output
   use evl_kinds, only: wp
   use evl_output, only: dims_none, in_gearbox, needs_meshes, needs_nothing
   use evl_teller, only: begin, needs, tell, teller_t
   implicit none (type, external)
   private

   public :: tell_gearbox

contains

   subroutine tell_gearbox(teller, theta, turns, kinetic, potential, dissipated, work)
      type(teller_t), intent(inout) :: teller
      real(wp), intent(in) :: theta                                !! [rad]
      integer, intent(in) :: turns
      real(wp), intent(in) :: kinetic, potential, dissipated, work !! [J]

      call begin(teller, in_gearbox, dims_none, 1)
      call tell(teller, "reference_angle", "rad", "theta", "angle of the reference wheel since the start, less whole turns", theta)
      call tell(teller, "reference_turns", "1", "", "whole turns of the reference wheel beside reference_angle", turns)
      call tell(teller, "kinetic_energy", "J", "T", "kinetic energy", kinetic)
      call needs(teller, needs_meshes)
      call tell(teller, "potential_energy", "J", "V", "elastic energy of contacts, supports and shafts", potential)
      call needs(teller, needs_nothing)
      call tell(teller, "dissipated_energy", "J", "D", "energy lost to damping and friction since the start", dissipated)
      call tell(teller, "load_work", "J", "W", "work of the loads since the start", work)
   end subroutine tell_gearbox

end module evl_gearbox_output
