!> Linear system of a few unknowns, solved by elimination with row exchanges.
!>
!> For some ten unknowns, LAPACK's selection of block sizes costs more than the solution itself: the system of the variational
!> equations, with 14, takes two fifths of the instructions this way (docs/theory/orbits.md).
module evl_small_system
   use evl_kinds, only: wp
   use evl_lapack, only: dgesv
   implicit none (type, external)
   private

   public :: solve_small

   integer, parameter :: small = 60 !! largest number of unknowns; larger systems are solved by LAPACK

contains

   !> Solve A X = B.
   subroutine solve_small(a, b, good)
      real(wp), intent(inout), contiguous :: a(:, :) !! [n, n], destroyed
      real(wp), intent(inout), contiguous :: b(:, :) !! [n, m] in: right-hand sides; out: X
      logical, intent(out) :: good                   !! false if A is singular, or not finite; then B is undefined
      integer :: pivots(size(a, 1)), info

      if (size(a, 1) > small) then
         call dgesv(size(a, 1), size(b, 2), a, size(a, 1), pivots, b, size(b, 1), info)
         good = info == 0
      else
         call eliminate(size(a, 1), size(b, 2), a, b, good)
      end if
   end subroutine solve_small

   !> Gaussian elimination, column by column.
   pure subroutine eliminate(n, m, a, b, good)
      integer, intent(in) :: n, m
      real(wp), intent(inout) :: a(n, n), b(n, m)
      logical, intent(out) :: good
      real(wp) :: held
      integer :: i, j, k

      do k = 1, n
         i = k
         do j = k + 1, n
            if (abs(a(j, k)) > abs(a(i, k))) i = j
         end do
         good = abs(a(i, k)) > 0 .and. abs(a(i, k)) <= huge(1.0_wp)
         if (.not. good) return
         if (i /= k) then
            do j = k, n
               held = a(k, j)
               a(k, j) = a(i, j)
               a(i, j) = held
            end do
            do j = 1, m
               held = b(k, j)
               b(k, j) = b(i, j)
               b(i, j) = held
            end do
         end if
         a(k + 1:, k) = a(k + 1:, k)/a(k, k)
         do j = k + 1, n
            if (abs(a(k, j)) > 0) a(k + 1:, j) = a(k + 1:, j) - a(k + 1:, k)*a(k, j)
         end do
         do j = 1, m
            b(k + 1:, j) = b(k + 1:, j) - a(k + 1:, k)*b(k, j)
         end do
      end do
      do j = 1, m
         do k = n, 1, -1
            b(k, j) = b(k, j)/a(k, k)
            b(:k - 1, j) = b(:k - 1, j) - a(:k - 1, k)*b(k, j)
         end do
      end do
      good = .true.
   end subroutine eliminate

end module evl_small_system
