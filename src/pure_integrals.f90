!> States on which nothing depends, such as work and dissipated energy: integrals of what the others do.
!>
!> They take no part in Newton's iteration. When the others have converged, with dz the last change of their stages, one more
!> iteration for the integrals alone would end at
!>
!>     z = h A (f + J dz)
!>
!> where they are put at once: as exactly as if they had been iterated with the others.
module evl_pure_integrals
   use evl_collocation, only: combine
   use evl_kinds, only: wp
   use evl_ode_model, only: lanes
   use evl_radau_coefficients, only: integral_to_node, shift_re
   implicit none (type, external)
   private

   public :: pure_integrals_t, find_pure_integrals, integrate_stages, integrate_error

   !> Which states they are: the last ones, so that the coupled ones before them lie together.
   type :: pure_integrals_t
      integer :: n_coupled = 0             !! states before them, at least 1
      integer :: n = 0                     !! of them
      integer, allocatable :: coupled(:)   !! entries of J in the rows of the coupled states
      integer, allocatable :: entry(:)     !! entries of J in the rows of the integrals
      integer, allocatable :: row(:)       !! which integral
      integer, allocatable :: column(:)    !! which coupled state
   end type pure_integrals_t

contains

   !> Find them from the pattern of J.
   pure subroutine find_pure_integrals(self, n, row, column)
      type(pure_integrals_t), intent(out) :: self
      integer, intent(in) :: n !! states
      integer, intent(in) :: row(:), column(:)
      integer :: p, n_inside, n_outside

      self%n_coupled = max(1, maxval([0, column]))
      self%n = n - self%n_coupled
      n_inside = count(row <= self%n_coupled)
      n_outside = size(row) - n_inside
      allocate (self%coupled(n_inside), self%entry(n_outside), self%row(n_outside), self%column(n_outside))
      n_inside = 0
      n_outside = 0
      do p = 1, size(row)
         if (row(p) <= self%n_coupled) then
            n_inside = n_inside + 1
            self%coupled(n_inside) = p
         else
            n_outside = n_outside + 1
            self%entry(n_outside) = p
            self%row(n_outside) = row(p) - self%n_coupled
            self%column(n_outside) = column(p)
         end if
      end do
   end subroutine find_pure_integrals

   !> Their stages.
   pure subroutine integrate_stages(self, h, jacobian, change, y, f, z, stage_y)
      type(pure_integrals_t), intent(in) :: self
      real(wp), intent(in) :: h
      real(wp), intent(in) :: jacobian(:)                    !! entries of J
      real(wp), intent(in) :: change(lanes, self%n_coupled)  !! last change of the stages of the coupled states
      real(wp), intent(in) :: y(self%n)                      !! integrals at the start
      real(wp), intent(inout) :: f(lanes, self%n)            !! their rates before that change; after it
      real(wp), intent(inout) :: z(lanes, self%n)            !! their increments
      real(wp), intent(inout) :: stage_y(lanes, self%n)      !! their values
      integer :: i, p

      do p = 1, size(self%entry)
         f(:, self%row(p)) = f(:, self%row(p)) + jacobian(self%entry(p))*change(:, self%column(p))
      end do
      call combine(self%n, integral_to_node, f, z)
      do i = 1, self%n
         z(:, i) = h*z(:, i)
         stage_y(:, i) = y(i) + z(:, i)
      end do
   end subroutine integrate_stages

   !> Their rows of (gamma/h I - J) error = right: the error of the coupled states is known, that of the integrals follows.
   pure subroutine integrate_error(self, h, jacobian, error)
      type(pure_integrals_t), intent(in) :: self
      real(wp), intent(in) :: h
      real(wp), intent(in) :: jacobian(:)
      real(wp), intent(inout) :: error(:) !! [states] errors of the coupled states, right-hand sides of the integrals; all errors
      integer :: p

      do p = 1, size(self%entry)
         associate (i => self%n_coupled + self%row(p))
            error(i) = error(i) + jacobian(self%entry(p))*error(self%column(p))
         end associate
      end do
      error(self%n_coupled + 1:) = error(self%n_coupled + 1:)*(h/shift_re(1))
   end subroutine integrate_error

end module evl_pure_integrals
