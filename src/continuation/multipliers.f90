!> Floquet multipliers of an orbit, and test functions that pass zero where an orbit's stability changes.
!>
!> All are polynomials in the multipliers, and therefore smooth where two real ones meet and become a pair.
!>
!> Sources: R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed., Springer 2010, ch. 5 and 7; T. S. Parker, L. O. Chua,
!> Practical Numerical Algorithms for Chaotic Systems, Springer 1989, ch. 3.
module evl_multipliers
   use evl_kinds, only: wp
   use evl_lapack, only: dgeevx
   use evl_status, only: code_no_solution, fail, status_t
   implicit none (type, external)
   private

   public :: are_inside, find_multipliers, product_over_one, product_over_minus_one, product_over_pairs

contains

   !> Eigenvalues of a matrix, by descending magnitude; pairs are adjacent, the one with the positive imaginary part first.
   subroutine find_multipliers(matrix, multipliers, status)
      real(wp), intent(in) :: matrix(:, :)                   !! [m, m] derivative of the period, in units of the scales
      complex(wp), allocatable, intent(out) :: multipliers(:) !! [m]
      type(status_t), intent(inout) :: status
      real(wp), allocatable :: a(:, :), re(:), im(:), scale(:), rconde(:), rcondv(:), work(:)
      real(wp) :: no_left(1, 1), no_right(1, 1), norm
      complex(wp) :: held
      integer, allocatable :: iwork(:)
      integer :: m, low, high, info, i, j

      m = size(matrix, 1)
      allocate (multipliers(m))
      if (m == 0) return
      allocate (a, source=matrix)
      allocate (re(m), im(m), scale(m), rconde(m), rcondv(m), work(4*m), iwork(2*m))
      call dgeevx("B", "N", "N", "N", m, a, m, re, im, no_left, 1, no_right, 1, low, high, scale, norm, rconde, rcondv, &
                  work, size(work), iwork, info)
      if (info /= 0) then
         call fail(status, code_no_solution, "the multipliers of the orbit were not found")
         return
      end if
      multipliers = cmplx(re, im, wp)
      do i = 2, m
         held = multipliers(i)
         do j = i - 1, 1, -1
            if (.not. abs(held) > abs(multipliers(j))*(1 + 4*epsilon(norm))) exit
            multipliers(j + 1) = multipliers(j)
         end do
         multipliers(j + 1) = held
      end do
   end subroutine find_multipliers

   !> Whether all lie inside the unit circle by more than rounding: those of an undamped system lie on it, which is not stable.
   pure logical function are_inside(multipliers)
      complex(wp), intent(in) :: multipliers(:)
      real(wp), parameter :: rounding = 1.0e-9_wp

      are_inside = all(abs(multipliers) < 1 - rounding)
   end function are_inside

   !> Product of mu - 1: zero at a fold, and where branches cross. Equation O11.
   pure real(wp) function product_over_one(multipliers) result(total)
      complex(wp), intent(in) :: multipliers(:)

      total = real(product(multipliers - 1), wp)
   end function product_over_one

   !> Product of mu + 1: zero at a period doubling. Equation O12.
   pure real(wp) function product_over_minus_one(multipliers) result(total)
      complex(wp), intent(in) :: multipliers(:)

      total = real(product(multipliers + 1), wp)
   end function product_over_minus_one

   !> Product of mu_i mu_j - 1 over all pairs: zero where a pair leaves the unit circle (Neimark-Sacker), and for mu and 1/mu.
   !> Equation O13.
   pure real(wp) function product_over_pairs(multipliers) result(total)
      complex(wp), intent(in) :: multipliers(:)
      complex(wp) :: so_far
      integer :: i, j

      so_far = 1
      do i = 1, size(multipliers)
         do j = i + 1, size(multipliers)
            so_far = so_far*(multipliers(i)*multipliers(j) - 1)
         end do
      end do
      total = real(so_far, wp)
   end function product_over_pairs

end module evl_multipliers
