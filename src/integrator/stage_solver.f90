!> Stages of one step of the seven-stage Radau IIA method: simplified Newton iteration on the transformed systems, and the
!> error estimate of the step.
!>
!> The unknowns are the increments z of the stages over the state at the start of the step. Lane 8 is the start itself: its
!> increment is 0, and lane 8 of f is f at the start. With w = T^-1 z an iteration solves, for each eigenvalue mu of A^-1,
!>
!>     (mu/h I - J) dw = T^-1 f(t + c h, y + z) - Lambda/h w
!>
!> for the coupled states; their integrals follow at the end (evl_quadrature_states).
!>
!> Error estimate: err = (gamma/h I - J)^-1 (f(t, y) - p'(t)), p the collocation polynomial, gamma the real eigenvalue. This
!> is the embedded formula of order 7, filtered: its weights are those of p'(t) (docs/theory/radau.md).
!>
!> For very stiff components the filter accepts any step: the stages are correct, however far apart, but the values between them
!> are not. The dense output therefore has a separate estimate: the Chebyshev coefficients of the polynomial, extrapolated by one.
!>
!> Sources: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., IV.8.
module evl_stage_solver
   use evl_condensed_systems, only: condensed_create, condensed_factor, condensed_solve, condensed_t
   use evl_dense_lu, only: dense_lu_create, dense_lu_factor, dense_lu_solve, dense_lu_t
   use evl_elementary, only: real_power
   use evl_estimate_rounding, only: estimate_rounding_create, estimate_rounding_t, find_rounding
   use evl_kinds, only: lanes, wp
   use evl_ode_model, only: ode_model
   use evl_quadrature_states, only: find_pure_integrals, integrate_stages, pure_integrals_t
   use evl_radau_coefficients, only: n_stages, n_systems, node, shift_im, shift_re
   use evl_stage_transforms, only: add_change, change_of_stages, residual
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: stage_counts, stage_solver_t, stage_solver_create, forget, set_weights, factor_systems, solve_stages
   public :: predict_nothing, predict_from, predict_linearly, linear_is_better, move_start, forget_start
   public :: estimate_error, predict_step, most_iterations
   public :: solve_systems ! for the submodules: gfortran 12 hides private entities from them
   public :: newton_converged, newton_slow, newton_diverged, newton_refused

   integer, parameter :: newton_converged = 0 !! the stages are solved
   integer, parameter :: newton_slow = 1      !! it would take too many iterations: `advice` is the factor for a smaller step
   integer, parameter :: newton_diverged = 2  !! it does not converge
   integer, parameter :: newton_refused = 3   !! the model cannot be evaluated at a stage: the status has no message

   integer, parameter :: most_iterations = 10
   real(wp), parameter :: eps = epsilon(1.0_wp)
   real(wp), parameter :: rounding = 4*eps !! smallest error that can be requested, relative to a state

   !> Of the change of a first iteration: smallest remaining error. A rate that was measured on another component may be too
   !> optimistic.
   real(wp), parameter :: least_left_over = 1.0e-4_wp
   real(wp), parameter :: rate_growth = 2       !! of the rate, with every step that reuses the factors
   real(wp), parameter :: output_share = 5      !! permitted estimate of the dense output's error over the user's tolerance

   type :: stage_counts
      integer :: iterations = 0     !! of Newton: lane-wise evaluations of f
      integer :: evaluations = 0    !! scalar evaluations of f
      integer :: factorisations = 0 !! of the four systems at once
      integer :: dense = 0          !! those with row exchanges
   end type stage_counts

   !> Extrapolation of a polynomial.
   type :: continuation_t
      real(wp) :: start = 0, ratio = 0       !! as in `predict_from`; ratio 0: none yet
      real(wp) :: matrix(lanes, lanes) = 0   !! from increments to increments
   end type continuation_t

   !> Quality of the predictions by the linear model.
   type :: linear_prediction_t
      logical :: is_used = .false. !! the present step started from it
      real(wp) :: error = 0        !! weighted error of the last one; 0: there was none
      real(wp) :: h = 1            !! its step
   end type linear_prediction_t

   !> All arrays of a step, of constant size.
   type :: stage_solver_t
      integer :: n = 0
      type(pure_integrals_t) :: integrals
      integer, allocatable :: row(:), column(:) !! pattern of J in the coupled states
      real(wp), allocatable :: coupled(:)   !! entries of J there
      real(wp) :: tolerance = 0  !! on the error estimate of a step, in units of the model's scales
      real(wp) :: output_factor = 1 !! factor on the error of the dense output
      real(wp) :: newton_stop = 0 !! share of the tolerance that may remain as iteration error
      real(wp), allocatable :: weight(:)    !! [n] inverse of the error that counts as 1
      type(estimate_rounding_t) :: rounding
      real(wp), allocatable :: most_weight(:) !! [n] limit set by the factors: inverse of the rounding error of an estimate
      real(wp), allocatable :: error_weight(:) !! [n] the smaller one of both
      real(wp), allocatable :: z(:, :)      !! [8, n] increments of the stages
      real(wp), allocatable :: shifted(:, :) !! [8, n] Lambda/h w, the transformed increments
      real(wp) :: times(lanes) = 0          !! of the stages
      real(wp), allocatable :: y(:, :)      !! [8, n] states at the stages
      real(wp), allocatable :: f(:, :)      !! [8, n] f at the stages
      real(wp), allocatable :: change(:, :) !! [8, n] in an iteration
      real(wp), allocatable :: jacobian(:)  !! [nnz] entries of df/dy
      real(wp), allocatable :: error(:)     !! [n] estimate
      real(wp), allocatable :: slope(:), slope_at_end(:) !! [n] of the polynomial at its start and end, per step
      real(wp), allocatable :: last(:), before(:) !! [n] squares of its last coefficients
      real(wp) :: next_coefficient = 0      !! weighted norm of the next Chebyshev coefficient
      real(wp), allocatable :: start(:)     !! [n] f at the start
      logical :: start_is_known = .false.   !! `start` is set before the first iteration
      real(wp), allocatable :: moved(:)     !! [n] state at which the estimate is repeated
      real(wp), allocatable :: moved_f(:)   !! [n] f there
      type(condensed_t) :: condensed
      type(dense_lu_t) :: dense
      logical :: is_dense = .false.
      type(continuation_t) :: continuation
      type(linear_prediction_t) :: linear
      real(wp) :: h_factored = 0 !! step size of the factors; 0: none
      logical :: factors_are_new = .false. !! computed since the last solution
      real(wp) :: rate = 0       !! of convergence in the last solution
      real(wp) :: rate_sum = 1   !! rate/(1 - rate), carried from step to step
      real(wp) :: advice = 1     !! factor on the step after `newton_slow`
      integer :: iterations = 0  !! of the last solution
      type(stage_counts) :: counts
   end type stage_solver_t

   interface
      !> Start Newton's iteration with zero increments.
      pure module subroutine predict_nothing(self, y)
         implicit none (type, external)
         type(stage_solver_t), intent(inout) :: self
         real(wp), intent(in) :: y(self%n)
      end subroutine predict_nothing

      !> Start Newton's iteration from the extrapolated polynomial of a step.
      pure module subroutine predict_from(self, y, old_z, start, h, old_h)
         implicit none (type, external)
         type(stage_solver_t), intent(inout) :: self
         real(wp), intent(in) :: y(self%n)
         real(wp), intent(in) :: old_z(lanes, self%n) !! increments of that step over its own start
         real(wp), intent(in) :: start !! start of the new step in that step, in units of it: 0 or 1
         real(wp), intent(in) :: h     !! new step
         real(wp), intent(in) :: old_h !! that step
      end subroutine predict_from

      !> Start Newton's iteration from the linear model z' = f(start) + J z; requires the factors of h, and f at the start.
      module subroutine predict_linearly(self, y, h)
         implicit none (type, external)
         type(stage_solver_t), intent(inout) :: self
         real(wp), intent(in) :: y(self%n)
         real(wp), intent(in) :: h
      end subroutine predict_linearly

      !> Whether the linear model is expected to predict the next step better than the polynomial of the last one.
      pure module logical function linear_is_better(self, h, old_h)
         implicit none (type, external)
         type(stage_solver_t), intent(in) :: self
         real(wp), intent(in) :: h, old_h !! next step, last step
      end function linear_is_better

      !> The step just solved was accepted to its end, where f is then known.
      pure module subroutine move_start(self, h)
         implicit none (type, external)
         type(stage_solver_t), intent(inout) :: self
         real(wp), intent(in) :: h
      end subroutine move_start

      !> After an event: f at the start is unknown, and so is the quality of the linear model and of Newton's iteration.
      pure module subroutine forget_start(self)
         implicit none (type, external)
         type(stage_solver_t), intent(inout) :: self
      end subroutine forget_start

      !> Weighted norm of the error estimate of the step just solved.
      module subroutine estimate_error(self, model, t, y, h, again, error, status)
         implicit none (type, external)
         type(stage_solver_t), intent(inout) :: self
         class(ode_model), intent(in) :: model
         real(wp), intent(in) :: t, h
         real(wp), intent(in) :: y(self%n)
         logical, intent(in) :: again   !! repeat the filter if the error is above 1: for a first step and after a rejection
         real(wp), intent(out) :: error !! root mean square; a step is accepted below 1
         type(status_t), intent(inout) :: status
      end subroutine estimate_error

      !> Step size with an error of about 1, before any step is made.
      pure module subroutine predict_step(self, model, h)
         implicit none (type, external)
         type(stage_solver_t), intent(inout) :: self !! f at the start in `start`, J in `jacobian`; its scratch changes
         class(ode_model), intent(in) :: model
         real(wp), intent(out) :: h !! 0 if the derivative is not finite
      end subroutine predict_step
   end interface

contains

   !> Allocate all arrays and analyse the pattern; the model has been checked.
   subroutine stage_solver_create(self, model, tolerance, user_tolerance)
      type(stage_solver_t), intent(out) :: self
      class(ode_model), intent(in) :: model
      real(wp), intent(in) :: tolerance        !! on the estimate of a step
      real(wp), intent(in) :: user_tolerance   !! tolerance of the user: measure of the dense output

      self%n = model%n
      self%tolerance = tolerance
      self%output_factor = max(1.0_wp, tolerance/(output_share*user_tolerance))
      self%newton_stop = max(10*eps/tolerance, min(0.03_wp, sqrt(tolerance)))
      allocate (self%weight(model%n), self%most_weight(model%n), self%error_weight(model%n))
      allocate (self%error(model%n), self%slope(model%n), self%slope_at_end(model%n), &
                self%last(model%n), self%before(model%n), self%start(model%n), self%moved(model%n), self%moved_f(model%n))
      allocate (self%z(lanes, model%n), self%shifted(lanes, model%n), self%y(lanes, model%n), self%f(lanes, model%n))
      allocate (self%change(lanes, model%n), self%jacobian(size(model%jacobian_row)))
      self%z = 0
      self%shifted = 0
      call find_pure_integrals(self%integrals, model%n, model%jacobian_row, model%jacobian_column)
      associate (n => size(self%integrals%coupled))
         allocate (self%row(n), self%column(n), self%coupled(n))
      end associate
      self%row(:) = model%jacobian_row(self%integrals%coupled)
      self%column(:) = model%jacobian_column(self%integrals%coupled)
      call estimate_rounding_create(self%rounding, model%n, model%jacobian_row, model%jacobian_column)
      self%most_weight = huge(1.0_wp)
      call condensed_create(self%condensed, self%integrals%n_coupled, self%row, self%column)
      call dense_lu_create(self%dense, self%integrals%n_coupled)
   end subroutine stage_solver_create

   !> Reset to the state after creation: counts and the rate of convergence belong to one integration.
   pure subroutine forget(self)
      type(stage_solver_t), intent(inout) :: self

      self%h_factored = 0
      self%rate = 0
      self%counts = stage_counts()
   end subroutine forget

   !> Set the weights: errors count in units of tolerance and scale, but never below rounding.
   pure subroutine set_weights(self, scale, y)
      type(stage_solver_t), intent(inout) :: self
      real(wp), intent(in) :: scale(self%n)
      real(wp), intent(in) :: y(self%n)

      self%weight = 1/max(self%tolerance*scale, rounding*abs(y))
   end subroutine set_weights

   !> Factor the four systems for a step of h, with row exchanges if diagonal pivots are insufficient. Equation R1.
   subroutine factor_systems(self, model, y, h, good)
      type(stage_solver_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(in) :: h
      logical, intent(out) :: good !! false if a matrix is singular
      integer :: p

      self%counts%factorisations = self%counts%factorisations + 1
      self%factors_are_new = .true.
      do p = 1, size(self%coupled)
         self%coupled(p) = self%jacobian(self%integrals%coupled(p))
      end do
      call condensed_factor(self%condensed, reshape([shift_re, shift_im], [n_systems, 2])/h, self%coupled, good)
      self%is_dense = .not. good
      if (self%is_dense) then
         self%counts%dense = self%counts%dense + 1
         call dense_lu_factor(self%dense, shift_re/h, shift_im/h, self%row, self%column, self%coupled, good)
      end if
      self%h_factored = merge(h, 0.0_wp, good)
      call find_rounding(self%rounding, model%jacobian_row, model%jacobian_column, self%jacobian, y, h, self%most_weight)
   end subroutine factor_systems

   !> Solve for the stages of the step from (t, y) to t + h, from the prediction in z and w; requires the factors of h.
   subroutine solve_stages(self, model, t, y, h, outcome, status)
      type(stage_solver_t), intent(inout) :: self
      class(ode_model), intent(inout) :: model
      real(wp), intent(in) :: t, h
      real(wp), intent(in) :: y(self%n)
      integer, intent(out) :: outcome         !! one of the codes newton_...
      type(status_t), intent(inout) :: status

      call iterate_to_end(self, model, t, y, h, outcome, status)
      if (outcome /= newton_converged) return
      call integrate_stages(self%integrals, self%n, h, self%jacobian, self%change, y, self%f, self%z, self%y)
   end subroutine solve_stages

   !> Newton's iteration for the coupled states; `change` returns the last change, transformed.
   subroutine iterate_to_end(self, model, t, y, h, outcome, status)
      type(stage_solver_t), intent(inout) :: self
      class(ode_model), intent(inout) :: model
      real(wp), intent(in) :: t, h
      real(wp), intent(in) :: y(self%n)
      integer, intent(out) :: outcome
      type(status_t), intent(inout) :: status
      real(wp) :: size_now, size_before, ratio, ratio_before, left_over
      integer :: i

      self%times = t + node*h
      if (self%factors_are_new) then
         self%rate_sum = max(sqrt(self%rate_sum*sqrt(self%rate_sum)), least_left_over) ! to the power of 3/4
      else
         self%rate_sum = max(min(rate_growth*self%rate_sum, 1.0_wp), least_left_over)
      end if
      self%factors_are_new = .false.
      self%advice = 0.5_wp
      size_before = 0
      ratio_before = 1
      do i = 1, most_iterations
         self%iterations = i
         self%counts%iterations = self%counts%iterations + 1
         status%in_words = .false. ! a smaller step needs no message
         call model%rhs_lanes(self%times, self%y, self%f, status)
         status%in_words = .true.
         if (has_failed(status)) then
            outcome = newton_refused
            return
         end if
         if (i == 1) call take_start(self%n, self%f, self%start)
         call iterate(self, y, h, size_now)
         if (i == 1 .and. self%linear%is_used) then
            self%linear%error = size_now
            self%linear%h = h
         end if
         if (i > 1) then
            ratio = size_now/size_before
            self%rate = merge(ratio, sqrt(ratio*ratio_before), i == 2)
            ratio_before = ratio
            if (.not. self%rate < 0.99_wp) then
               outcome = merge(newton_converged, newton_diverged, is_rounding(self))
               return
            end if
            self%rate_sum = self%rate/(1 - self%rate)
            left_over = self%rate_sum*size_now*self%rate**(most_iterations - 1 - i)
            if (left_over >= self%newton_stop .and. i < most_iterations) then
               outcome = merge(newton_converged, newton_slow, is_rounding(self))
               self%advice = 0.8_wp/real_power(max(1.0e-4_wp, min(20.0_wp, left_over/self%newton_stop)), &
                                               1.0_wp/(4 + most_iterations - 1 - i))
               return
            end if
         end if
         size_before = max(size_now, eps)
         if (self%rate_sum*size_now <= self%newton_stop) then
            outcome = newton_converged
            return
         end if
      end do
      outcome = merge(newton_converged, newton_diverged, is_rounding(self))
   end subroutine iterate_to_end

   !> f at the start, from lane 8.
   pure subroutine take_start(n, f, start)
      integer, intent(in) :: n
      real(wp), intent(in) :: f(lanes, n)
      real(wp), intent(out) :: start(n)

      start = f(lanes, :)
   end subroutine take_start

   !> One iteration: update z, w and the states; return the weighted norm of the change. Equation R1.
   subroutine iterate(self, y, h, length)
      type(stage_solver_t), intent(inout) :: self
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(in) :: h
      real(wp), intent(out) :: length !! root mean square over stages and components

      integer :: n

      n = self%integrals%n_coupled
      call residual(n, self%f, self%shifted, self%change)
      call solve_systems(self)
      call add_change(n, shift_re/h, shift_im/h, y, self%weight, self%change, self%shifted, self%z, self%y, length)
      length = sqrt(length/(n_stages*n))
   end subroutine iterate

   !> Solve the four systems for `change`. Equation R1.
   subroutine solve_systems(self)
      type(stage_solver_t), intent(inout) :: self

      if (self%is_dense) then
         call dense_lu_solve(self%dense, self%change)
      else
         call condensed_solve(self%condensed, self%change)
      end if
   end subroutine solve_systems

   !> Whether the last change is within rounding: no iteration can improve it.
   pure logical function is_rounding(self)
      type(stage_solver_t), intent(in) :: self
      real(wp) :: dz(lanes)
      integer :: i

      do i = 1, self%integrals%n_coupled
         call change_of_stages(1, self%change(:, i), dz)
         is_rounding = all(abs(dz) <= max(8*rounding*(abs(self%y(:, i)) + abs(self%z(:, i))), 1/self%most_weight(i)))
         if (.not. is_rounding) return
      end do
   end function is_rounding

end module evl_stage_solver
