!> A point of a branch of periodic orbits, what happens there, and who follows its orbit to tell of it.
module evl_branch_point
   use evl_kinds, only: wp
   use evl_periodic_orbit, only: orbit_t
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: branch_point, kind_crossing, kind_doubling, kind_fold, kind_neimark_sacker, kind_ordinary, kind_touch, &
             kind_touch_fold, orbit_teller

   integer, parameter :: kind_ordinary = 0       !! nothing happens
   integer, parameter :: kind_fold = 1           !! the branch turns back: a multiplier 1
   integer, parameter :: kind_crossing = 2       !! a multiplier 1 where the branch goes on: another one crosses it
   integer, parameter :: kind_doubling = 3       !! a multiplier -1
   integer, parameter :: kind_neimark_sacker = 4 !! a pair of multipliers on the unit circle
   integer, parameter :: kind_touch = 5          !! a root function touches zero and does not cross it
   integer, parameter :: kind_touch_fold = 6     !! the same, and the branch turns back there: no multiplier is 1

   !> A point of a branch.
   type :: branch_point
      type(orbit_t) :: orbit
      integer :: kind = kind_ordinary
      integer :: root = 0           !! the root function that touches zero
      integer :: told = 0           !! the number under which an orbit_teller followed it: there is no derivative. 0: none did
      logical :: begins_anew = .false. !! what was known of the curve did not foresee it: something is not smooth before it
      real(wp) :: way = 0           !! from the last ordinary point, along its tangent, in units of the scales
   end type branch_point

   !> What is told of an orbit, such as means and extremes, needs a run of its own. That run says as well whether it is an orbit, so
   !> it saves a flow where orbits are well foreseen.
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

end module evl_branch_point
