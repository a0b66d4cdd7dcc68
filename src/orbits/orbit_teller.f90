!> Who wants to see an orbit go round: what is told of an orbit, such as means and extremes, needs a run of its own. That run says
!> as well whether it is an orbit, so it saves a flow where orbits are well foreseen.
module evl_orbit_teller
   use evl_periodic_orbit, only: orbit_t
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: orbit_teller

   type, abstract :: orbit_teller
   contains
      procedure(tell_interface), deferred :: tell
   end type orbit_teller

   abstract interface
      !> Follow what is to be an orbit once round, and keep what is to be told of it. Whatever was kept under that number before
      !> is not wanted any more. The model has the orbit's value of the parameter.
      subroutine tell_interface(self, number, orbit, status)
         import :: orbit_t, orbit_teller, status_t
         implicit none (type, external)
         class(orbit_teller), intent(inout) :: self
         integer, intent(in) :: number          !! >= 1
         type(orbit_t), intent(inout) :: orbit  !! `flow` gets its end, rate and same_modes; an autonomous one the period it took
         type(status_t), intent(inout) :: status !! touched on failure only
      end subroutine tell_interface
   end interface

end module evl_orbit_teller
