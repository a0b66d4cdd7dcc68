!> A point of a branch of periodic orbits, and what happens there.
module evl_branch_point
   use evl_kinds, only: wp
   use evl_periodic_orbit, only: orbit_t
   implicit none (type, external)
   private

   public :: branch_point
   public :: kind_ordinary, kind_fold, kind_crossing, kind_doubling, kind_neimark_sacker, kind_touch, kind_touch_fold

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

end module evl_branch_point
