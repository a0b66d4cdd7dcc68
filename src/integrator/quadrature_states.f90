!> Pure quadrature states, such as work and dissipated energy: integrals on which no other state depends.
!>
!> They are excluded from Newton's iteration. When the other states have converged, with dz the last change of their stages,
!> one more iteration for the integrals alone would end at
!>
!>   z = h A (f + J dz)
!>
!> They are set to this value directly, which is as accurate as an iteration together with the others.
module evl_quadrature_states
   use evl_indices, only: indices
   use evl_kinds, only: lanes, wp
   use evl_radau_coefficients, only: shift_re
   use evl_stage_transforms, only: change_of_stages, integrate
   implicit none (type, external)
   private

   public :: pure_integrals_t, find_pure_integrals, integrate_stages, integrate_error

   !> Indices of the quadrature states: the last ones, so that the coupled states before them are contiguous.
   type :: pure_integrals_t
      integer :: n_coupled = 0             !! number of coupled states, at least 1
      integer :: n = 0                     !! number of quadrature states
      integer, allocatable :: coupled(:)   !! entries of J in the rows of the coupled states
      integer, allocatable :: start(:)     !! [n + 1] first entry in the row of each integral
      integer, allocatable :: entry(:)     !! entries of J in these rows, row by row
      integer, allocatable :: column(:)    !! coupled state of each entry
      real(wp), allocatable :: rate(:, :), change(:, :) !! [8, n] scratch: f of the integrals, and its change
   end type pure_integrals_t

contains

   !> Find the quadrature states from the pattern of J.
   pure subroutine find_pure_integrals(self, n, row, column)
      type(pure_integrals_t), intent(out) :: self
      integer, intent(in) :: n !! states
      integer, intent(in) :: row(:), column(:)
      integer :: i

      self%n_coupled = max(1, maxval([0, column]))
      self%n = n - self%n_coupled
      self%coupled = indices(row <= self%n_coupled)
      allocate (self%start(self%n + 1), self%entry(0), self%rate(lanes, self%n), self%change(lanes, self%n))
      do i = 1, self%n
         self%start(i) = size(self%entry) + 1
         self%entry = [self%entry, indices(row == self%n_coupled + i)]
      end do
      self%start(self%n + 1) = size(self%entry) + 1
      self%column = column(self%entry)
   end subroutine find_pure_integrals

   !> Compute the stages of the quadrature states. Equation R11.
   pure subroutine integrate_stages(self, n, h, jacobian, dw, y, f, z, stage_y)
      type(pure_integrals_t), intent(inout) :: self       !! its scratch changes
      integer, intent(in) :: n                            !! states
      real(wp), intent(in) :: h
      real(wp), intent(in) :: jacobian(*)                 !! entries of J
      real(wp), intent(in) :: dw(lanes, self%n_coupled)   !! last change of the stages of the coupled states, transformed
      real(wp), intent(in) :: y(n)                        !! states at the start
      real(wp), intent(in) :: f(lanes, n)                 !! f at the stages before that change
      real(wp), intent(inout) :: z(lanes, n)              !! increments
      real(wp), intent(inout) :: stage_y(lanes, n)        !! states at the stages
      integer :: i

      if (self%n == 0) return
      call change_of_rates(self%n, self%start, self%entry, self%column, jacobian, dw, self%rate)
      call change_of_stages(self%n, self%rate, self%change)
      do i = 1, self%n
         self%rate(:, i) = f(:, self%n_coupled + i) + self%change(:, i)
      end do
      call integrate(self%n, h, self%rate, z(:, self%n_coupled + 1:))
      do i = self%n_coupled + 1, n
         stage_y(:, i) = y(i) + z(:, i)
      end do
   end subroutine integrate_stages

   !> J dw in the rows of the integrals. J is the same at all stages, so the result does not depend on their transformation.
   pure subroutine change_of_rates(n, start, entry, column, jacobian, dw, rate)
      integer, intent(in) :: n
      integer, intent(in) :: start(n + 1), entry(*), column(*)
      real(wp), intent(in) :: jacobian(*), dw(lanes, *)
      real(wp), intent(out) :: rate(lanes, n)
      real(wp) :: total(lanes)
      integer :: i, l, p

      do i = 1, n
         total = 0
         do p = start(i), start(i + 1) - 1
            !$omp simd
            do l = 1, lanes
               total(l) = total(l) + jacobian(entry(p))*dw(l, column(p))
            end do
         end do
         rate(:, i) = total
      end do
   end subroutine change_of_rates

   !> Rows of the integrals in (gamma/h I - J) error = right: their errors follow from those of the coupled states.
   pure subroutine integrate_error(self, n, h, jacobian, error)
      type(pure_integrals_t), intent(in) :: self
      integer, intent(in) :: n                !! states
      real(wp), intent(in) :: h
      real(wp), intent(in) :: jacobian(*)
      real(wp), intent(inout) :: error(n) !! in: errors of the coupled states, right-hand sides of the integrals; out: errors
      real(wp) :: total
      integer :: i, p

      do i = 1, self%n
         total = error(self%n_coupled + i)
         do p = self%start(i), self%start(i + 1) - 1
            total = total + jacobian(self%entry(p))*error(self%column(p))
         end do
         error(self%n_coupled + i) = h/shift_re(1)*total
      end do
   end subroutine integrate_error

end module evl_quadrature_states
