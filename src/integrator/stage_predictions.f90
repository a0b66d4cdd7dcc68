!> Initial values of Newton's iteration for the stages of a step: increments, their transformation, and the states at the stages.
!>
!> Two predictions serve different kinds of steps. The extrapolated polynomial of the last step is good where the solution is
!> smooth in units of the step. The linear model
!>
!>     z' = f(start) + J z
!>
!> costs a solution of the four systems, but no evaluation of f. It is good where the solution moves fast but nearly linearly,
!> such as a weakly damped oscillation with a radian or more per step. There its error is of the order of a thousandth of that
!> of the polynomial, and one iteration is often sufficient. In a linear model with constant coefficients it is exact.
submodule(evl_stage_solver) evl_stage_predictions
   use evl_collocation, only: lagrange_matrix
   use evl_stage_transforms, only: begin_with_change, continue_polynomial, linear_residual, start_stages
   implicit none (type, external)

contains

   !> Start Newton's iteration with zero increments.
   module procedure predict_nothing
      self%z = 0
      self%shifted = 0
      call start_stages(self%n, self%integrals%n_coupled, y, self%z, self%y)
      self%linear%is_used = .false.
   end procedure predict_nothing

   !> Start Newton's iteration from the extrapolated polynomial of a step.
   module procedure predict_from
      call find_continuation(self%continuation, start, h/old_h)
      call continue_polynomial(self%integrals%n_coupled, self%continuation%matrix, old_z, h, self%z, self%shifted)
      call start_stages(self%n, self%integrals%n_coupled, y, self%z, self%y)
      self%linear%is_used = .false.
   end procedure predict_from

   !> Compute the matrix of a prediction, unless it is that of the last one: consecutive steps often have the same length.
   pure subroutine find_continuation(self, start, ratio)
      type(continuation_t), intent(inout) :: self
      real(wp), intent(in) :: start, ratio !! as above
      integer :: from

      if (abs(start - self%start) <= 0 .and. abs(ratio - self%ratio) <= 0) return
      self%start = start
      self%ratio = ratio
      call lagrange_matrix(start + ratio*node, self%matrix)
      from = merge(n_stages, lanes, start > 0)
      self%matrix(:, from) = self%matrix(:, from) - 1
      self%matrix(lanes, :) = 0
   end subroutine find_continuation

   !> Start Newton's iteration from the linear model z' = f(start) + J z: one iteration from zero, with the same f at all stages.
   module procedure predict_linearly
      call linear_residual(self%integrals%n_coupled, self%start, self%change)
      call solve_systems(self)
      call begin_with_change(self%n, self%integrals%n_coupled, shift_re/h, shift_im/h, y, self%change, self%shifted, self%z, &
                             self%y)
      self%linear%is_used = .true.
   end procedure predict_linearly

   !> Whether the linear model is expected to predict the next step better than the polynomial of the last one.
   !>
   !> The error of the polynomial is that of the next Chebyshev coefficient, T_8 at the stages ahead: its root mean square
   !> over them is 0.4 of its value at the end. The error of the linear model was measured in the last step that started from
   !> it; it grows with the square of the step, as the change of J within the step does.
   module procedure linear_is_better
      real(wp), parameter :: mean_over_end = 0.4_wp

      linear_is_better = self%linear%error*(h/self%linear%h)**2 &
                         < mean_over_end*chebyshev_8(1 + 2*h/old_h)*self%next_coefficient
   end procedure linear_is_better

   !> T_8, from T_2n = 2 T_n**2 - 1.
   pure real(wp) function chebyshev_8(x)
      real(wp), intent(in) :: x

      chebyshev_8 = 2*(2*(2*x**2 - 1)**2 - 1)**2 - 1
   end function chebyshev_8

   !> The step just solved was accepted to its end: f there is the slope of its polynomial.
   module procedure move_start
      self%start(:) = self%slope_at_end*(1/h)
      self%start_is_known = .true.
   end procedure move_start

   !> After an event: f at the start is unknown, and so is the quality of the linear model and of Newton's iteration.
   module procedure forget_start
      self%start_is_known = .false.
      self%linear = linear_prediction_t()
      self%rate_sum = 1
   end procedure forget_start

end submodule evl_stage_predictions
