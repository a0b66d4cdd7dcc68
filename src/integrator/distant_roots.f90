!> Selection of the root functions that may come near zero in a step, from their values at its nodes.
module evl_distant_roots
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_kinds, only: lanes, wp
   implicit none (type, external)
   private

   public :: list_near, near_zero, sign_of

   !> Relative to a function's largest value: an extremum nearer to zero is examined.
   real(wp), parameter :: near_zero = 0.05_wp
   real(wp), parameter :: most_between = 2.33_wp !! largest sum of |Lagrange polynomial k| on the step, k = 1 .. 7
   !> Relative to the value at the start: if no other node differs by more, the interpolant stays away from zero.
   real(wp), parameter :: little = (1 - near_zero)/(most_between + near_zero)

contains

   !> List the functions that may come near zero. The others have the sign of the previous step at all nodes, which is stored
   !> in `sign_after`. They change so little that their interpolants stay away from zero.
   pure subroutine list_near(n, n_live, live, g, sign_now, sign_after, n_near, near)
      integer, intent(in) :: n                    !! functions
      integer, intent(in) :: n_live, live(n_live) !! functions to examine
      real(wp), intent(in) :: g(lanes, n)         !! values at the nodes, the last one the start
      integer, intent(in) :: sign_now(n)          !! at the end of the previous step; 0: unknown
      integer, intent(inout) :: sign_after(n)
      integer, intent(out) :: n_near
      integer, intent(inout) :: near(n)           !! the first n_near of these: indices of the functions
      integer(int64) :: others ! as long as a real: vectors of both have the same lanes
      real(wp) :: at_start, most
      integer :: i, k, l

      n_near = 0
      do k = 1, n_live
         i = live(k)
         at_start = g(lanes, i)
         most = little*abs(at_start)
         others = 0
         !$omp simd reduction(ior:others)
         do l = 1, lanes
            others = ior(others, merge(0_int64, 1_int64, abs(g(l, i) - at_start) <= most))
         end do
         sign_after(i) = sign_of(at_start)
         if (others == 0 .and. abs(at_start) > 0 .and. sign_now(i)*at_start >= 0) cycle
         n_near = n_near + 1
         near(n_near) = i
      end do
   end subroutine list_near

   !> -1, 0 or 1
   pure integer function sign_of(value)
      real(wp), intent(in) :: value

      sign_of = merge(1, 0, value > 0) - merge(1, 0, value < 0)
   end function sign_of

end module evl_distant_roots
