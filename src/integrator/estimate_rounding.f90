!> Rounding error of the error estimate: the lower bound of a meaningful tolerance.
!>
!> f has a rounding error of about eps sum_j |J_ij y_j|, rarely more than four times that: forces are differences of positions, and
!> stiff forces have rounding errors far above their own last digit. The estimate (gamma/h I - J)^-1 (f(t, y) - p'(t)) contains
!> that of f at the start, and that of the stages times the sum of the |weights| of their slopes in p'(t). Its filter divides
!> row i by
!>   gamma/h + |J_ii| + h/gamma sum_j |J_ij J_ji|,
!> which is exact for a mass on a spring and a damper.
module evl_estimate_rounding
   use evl_kinds, only: wp
   use evl_radau_coefficients, only: shift_re
   implicit none (type, external)
   private

   public :: estimate_rounding_t, estimate_rounding_create, find_rounding

   real(wp), parameter :: eps = epsilon(1.0_wp)
   real(wp), parameter :: roundings = 4 !! assumed rounding errors of each term of f; 99 % of the estimates stay below
   real(wp), parameter :: of_stages = 5.06_wp !! sum of |weights| that extrapolate slopes at the stages to the start

   !> Index of the transposed entry of each entry of J.
   type :: estimate_rounding_t
      integer, allocatable :: across(:) !! 0: none
      real(wp), allocatable :: left(:)  !! [n] scratch
   end type estimate_rounding_t

contains

   !> Find the transposed entries.
   pure subroutine estimate_rounding_create(self, n, row, column)
      type(estimate_rounding_t), intent(out) :: self
      integer, intent(in) :: n                !! states
      integer, intent(in) :: row(:), column(:) !! pattern of J
      integer :: first(n + 1), in_rows(size(row)), next(n), p, k

      first = 1
      do p = 1, size(row)
         first(row(p) + 1:) = first(row(p) + 1:) + 1
      end do
      next = first(:n)
      do p = 1, size(row)
         in_rows(next(row(p))) = p
         next(row(p)) = next(row(p)) + 1
      end do
      allocate (self%across(size(row)), source=0)
      allocate (self%left(n))
      do p = 1, size(row)
         do k = first(column(p)), first(column(p) + 1) - 1
            if (column(in_rows(k)) == row(p)) self%across(p) = in_rows(k)
         end do
      end do
   end subroutine estimate_rounding_create

   !> Largest weight of an error in a state: the inverse of the rounding error of the estimate for a step of h. Equation R6.
   pure subroutine find_rounding(self, row, column, jacobian, y, h, most_weight)
      type(estimate_rounding_t), intent(inout) :: self !! its scratch changes
      integer, intent(in) :: row(:), column(:)
      real(wp), intent(in) :: jacobian(:)      !! df/dy
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: h
      real(wp), intent(out) :: most_weight(:)
      real(wp) :: per_step
      integer :: p

      per_step = shift_re(1)/h
      most_weight = 0
      self%left = per_step
      do p = 1, size(row)
         associate (i => row(p), j => column(p), entry => abs(jacobian(p)))
            most_weight(i) = most_weight(i) + entry*abs(y(j))
            if (i == j) then
               self%left(i) = self%left(i) + entry
            else if (self%across(p) > 0) then
               self%left(i) = self%left(i) + entry*abs(jacobian(self%across(p)))/per_step
            end if
         end associate
      end do
      most_weight = self%left/max(roundings*(1 + of_stages)*eps*most_weight, tiny(1.0_wp))
   end subroutine find_rounding

end module evl_estimate_rounding
