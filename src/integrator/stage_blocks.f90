!> Arithmetic of the four transformed systems: a block is a vector of four complex numbers, one per system, stored as four
!> real parts and four imaginary parts.
!>
!> No procedure depends on the order in which the parts of a block are treated, so that each loop is vectorised.
module evl_stage_blocks
   use evl_kinds, only: wp
   use evl_radau_coefficients, only: n_systems
   implicit none (type, external)
   private

   public :: add_product, add_scaled, invert, matrix_entry, multiply, subtract_product

contains

   !> c = a b
   pure subroutine multiply(a, b, c)
      real(wp), intent(in) :: a(n_systems, 2), b(n_systems, 2)
      real(wp), intent(out) :: c(n_systems, 2)
      integer :: k

      !$omp simd
      do k = 1, n_systems
         c(k, 1) = a(k, 1)*b(k, 1) - a(k, 2)*b(k, 2)
         c(k, 2) = a(k, 1)*b(k, 2) + a(k, 2)*b(k, 1)
      end do
   end subroutine multiply

   !> c = c - a b
   pure subroutine subtract_product(a, b, c)
      real(wp), intent(in) :: a(n_systems, 2), b(n_systems, 2)
      real(wp), intent(inout) :: c(n_systems, 2)
      integer :: k

      !$omp simd
      do k = 1, n_systems
         c(k, 1) = c(k, 1) - (a(k, 1)*b(k, 1) - a(k, 2)*b(k, 2))
         c(k, 2) = c(k, 2) - (a(k, 1)*b(k, 2) + a(k, 2)*b(k, 1))
      end do
   end subroutine subtract_product

   !> c = c + a b
   pure subroutine add_product(a, b, c)
      real(wp), intent(in) :: a(n_systems, 2), b(n_systems, 2)
      real(wp), intent(inout) :: c(n_systems, 2)
      integer :: k

      !$omp simd
      do k = 1, n_systems
         c(k, 1) = c(k, 1) + (a(k, 1)*b(k, 1) - a(k, 2)*b(k, 2))
         c(k, 2) = c(k, 2) + (a(k, 1)*b(k, 2) + a(k, 2)*b(k, 1))
      end do
   end subroutine add_product

   !> c = c + a b, a real and the same in all systems
   pure subroutine add_scaled(a, b, c)
      real(wp), intent(in) :: a
      real(wp), intent(in) :: b(n_systems, 2)
      real(wp), intent(inout) :: c(n_systems, 2)
      integer :: k

      !$omp simd
      do k = 1, n_systems
         c(k, 1) = c(k, 1) + a*b(k, 1)
         c(k, 2) = c(k, 2) + a*b(k, 2)
      end do
   end subroutine add_scaled

   !> An entry of -J - K/s.
   pure subroutine matrix_entry(inverse_shift, j, k, entry)
      real(wp), intent(in) :: inverse_shift(n_systems, 2) !! 1/s
      real(wp), intent(in) :: j, k
      real(wp), intent(out) :: entry(n_systems, 2)

      entry(:, 1) = -j - k*inverse_shift(:, 1)
      entry(:, 2) = -k*inverse_shift(:, 2)
   end subroutine matrix_entry

   !> c = 1/a, a not near the limits of the number range
   pure subroutine invert(a, c)
      real(wp), intent(in) :: a(n_systems, 2)
      real(wp), intent(out) :: c(n_systems, 2)
      real(wp) :: scale
      integer :: k

      !$omp simd private(scale)
      do k = 1, n_systems
         scale = 1/(a(k, 1)**2 + a(k, 2)**2)
         c(k, 1) = a(k, 1)*scale
         c(k, 2) = -a(k, 2)*scale
      end do
   end subroutine invert

end module evl_stage_blocks
