!> Root functions that stay far from zero in a step: their values at its nodes already say so.
module evl_far_roots
   use evl_kinds, only: wp
   use evl_ode_model, only: lanes
   implicit none (type, external)
   private

   public :: keep_away, near_zero, sign_of

   !> Of a function's largest value: how near an extremum has to come to be looked at.
   real(wp), parameter :: near_zero = 0.05_wp
   real(wp), parameter :: most_between = 2.33_wp !! largest sum of |Lagrange polynomial k| on the step, k = 1 .. 7
   !> Of the value at the start: if no other node differs by more, the interpolant keeps its distance from zero.
   real(wp), parameter :: little = (1 - near_zero)/(most_between + near_zero)

contains

   !> Whether some functions have one sign each at all nodes, that of the step before, and change so little that none of
   !> their interpolants comes anywhere near zero; then their signs are put down. Asked of all at once, since most often it
   !> is so.
   pure subroutine keep_away(n, n_some, some, g, sign_now, sign_after, away)
      integer, intent(in) :: n                    !! functions
      integer, intent(in) :: n_some, some(n_some) !! those looked at
      real(wp), intent(in) :: g(lanes, n)
      integer, intent(in) :: sign_now(n)          !! at the end of the step before; 0: not known
      integer, intent(inout) :: sign_after(n)
      logical, intent(out) :: away
      real(wp) :: near(lanes), at_start, most
      integer :: i, k, l

      near = 0
      away = .true.
      do k = 1, n_some
         i = some(k)
         at_start = g(lanes, i)
         most = little*abs(at_start)
         !$omp simd
         do l = 1, lanes
            near(l) = near(l) + merge(1.0_wp, 0.0_wp, abs(g(l, i) - at_start) <= most)
         end do
         away = away .and. abs(at_start) > 0 .and. sign_now(i)*at_start >= 0
         sign_after(i) = sign_of(at_start)
      end do
      away = away .and. sum(near) > lanes*n_some - 0.5_wp
   end subroutine keep_away

   !> -1, 0 or 1
   pure integer function sign_of(value)
      real(wp), intent(in) :: value

      sign_of = merge(1, 0, value > 0) - merge(1, 0, value < 0)
   end function sign_of

end module evl_far_roots
