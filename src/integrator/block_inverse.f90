!> Inverses of four small complex matrices s_k I - J - K/s_k at once, J and K real.
!>
!> For a few unknowns, multiplication by the inverse costs no more than two substitutions, and its rows are independent of
!> each other. Newton's iteration needs only the accuracy of the inverse of a well-pivoted matrix. Remaining errors change the
!> rate of convergence by rounding errors times the condition number; they show in the next residual.
!>
!> Gauss-Jordan elimination in place with diagonal pivots. A pivot that is too small relative to the rest of its row is
!> reported, as by the sparse factorisation.
!>
!> Source: N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed. (2002), 14.4.
module evl_block_inverse
   use evl_kinds, only: wp
   use evl_radau_coefficients, only: n_systems
   use evl_sparse_lu, only: smallest_pivot
   use evl_stage_blocks, only: add_product, invert, multiply, subtract_product
   implicit none (type, external)
   private

   public :: invert_blocks, apply_inverse, apply_first_inverse

contains

   !> Invert the four matrices in place.
   pure subroutine invert_blocks(n, a, good)
      integer, intent(in) :: n
      real(wp), intent(inout) :: a(n_systems, 2, n, n) !! a(:, :, j, i) is entry j of row i
      logical, intent(out) :: good !! whether every pivot was large enough; if not, the result is useless
      real(wp) :: size_of(n_systems), beside(n_systems), pivot(n_systems, 2), factor(n_systems, 2)
      integer :: i, j, k

      good = .true.
      do k = 1, n
         size_of = a(:, 1, k, k)**2 + a(:, 2, k, k)**2
         beside = tiny(1.0_wp)/smallest_pivot**2
         do j = k + 1, n
            beside = max(beside, a(:, 1, j, k)**2 + a(:, 2, j, k)**2)
         end do
         if (.not. all(size_of > smallest_pivot**2*beside .and. size_of <= huge(1.0_wp))) then
            good = .false.
            return
         end if
         call invert(a(:, :, k, k), pivot)
         a(:, 1, k, k) = 1
         a(:, 2, k, k) = 0
         do j = 1, n
            call multiply(pivot, a(:, :, j, k), factor)
            a(:, :, j, k) = factor
         end do
         do i = 1, n
            if (i == k) cycle
            factor = a(:, :, k, i)
            a(:, :, k, i) = 0
            do j = 1, n
               call subtract_product(factor, a(:, :, j, k), a(:, :, j, i))
            end do
         end do
      end do
   end subroutine invert_blocks

   !> x(row_of) = a b.
   pure subroutine apply_inverse(n, a, b, row_of, x)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(n_systems, 2, n, n) !! as above
      real(wp), intent(in) :: b(n_systems, 2, n)
      integer, intent(in) :: row_of(n) !! index of row i in x
      real(wp), intent(inout) :: x(n_systems, 2, *)
      real(wp) :: total(n_systems, 2)
      integer :: i, j

      do i = 1, n
         total = 0
         do j = 1, n
            call add_product(a(:, :, j, i), b(:, :, j), total)
         end do
         x(:, :, row_of(i)) = total
      end do
   end subroutine apply_inverse

   !> x = a b for the first system, which is real.
   pure subroutine apply_first_inverse(n, a, b, x)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(n, n) !! a(j, i) is entry j of row i
      real(wp), intent(in) :: b(n)
      real(wp), intent(out) :: x(n)
      integer :: i, j

      do i = 1, n
         x(i) = 0
         do j = 1, n
            x(i) = x(i) + a(j, i)*b(j)
         end do
      end do
   end subroutine apply_first_inverse

end module evl_block_inverse
