!> One trial step: prediction, Jacobian and factors if needed, stages, error estimate.
submodule(evl_radau) evl_radau_attempt
   use evl_radau_coefficients, only: node
   use evl_stage_solver, only: estimate_error, linear_is_better, newton_refused, newton_slow, predict_linearly, predict_nothing
   implicit none (type, external)

   real(wp), parameter :: farthest = 5 !! largest step, over the last one, for which its polynomial is extrapolated
   integer, parameter :: middle = 4    !! stage nearest to the middle of a step

contains

   !> Try a step of h; if Newton's iteration fails, error is huge and the step to try next is set.
   module procedure attempt
      integer :: outcome
      logical :: good

      error = huge(error)
      do
         call prepare(self, model, h, good, status)
         if (has_failed(status)) return
         if (.not. good) then
            self%h = h/2
            return
         end if
         call solve_stages(self%stages, model, self%t, self%y, h, outcome, status)
         if (outcome == newton_refused) return
         if (outcome == newton_converged) exit
         if (self%jacobian_is_new) then
            self%h = h*merge(self%stages%advice, 0.5_wp, outcome == newton_slow)
            return
         end if
         self%jacobian_may_stay = .false.
         self%matrix_may_stay = .false. ! repeat with the Jacobian of this state
         self%jacobian_is_ahead = .false.
      end do
      call estimate_error(self%stages, model, self%t, self%y, h, self%rejected, error, status)
      if (.not. error < huge(error)) self%h = h/4
   end procedure attempt

   !> Predict the step, with a new Jacobian and new factors if needed. The state for the Jacobian is always predicted by the
   !> polynomial of the last step, since the linear model itself requires the Jacobian.
   subroutine prepare(self, model, h, good, status)
      type(radau_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      real(wp), intent(in) :: h
      logical, intent(out) :: good !! false if a matrix is singular
      type(status_t), intent(inout) :: status
      logical :: goes_on, linear, new_factors, new_jacobian

      good = .true.
      new_factors = .not. (self%matrix_may_stay .and. same(h, self%stages%h_factored))
      new_jacobian = new_factors .and. .not. (self%jacobian_is_new .or. self%jacobian_is_ahead .or. self%jacobian_may_stay)
      goes_on = self%old_h > 0 .and. h <= farthest*self%old_h
      linear = self%stages%start_is_known
      ! only the linear model predicts growth below the tolerance, which no iteration corrects
      if (linear .and. goes_on .and. .not. self%growth%shortens) linear = linear_is_better(self%stages, h, self%old_h)
      if (goes_on .and. (new_jacobian .or. .not. linear)) then
         call predict_from(self%stages, self%y, self%old_z, 1.0_wp, h, self%old_h)
      else if (.not. linear) then
         call predict_nothing(self%stages, self%y)
      end if
      if (new_jacobian .and. goes_on) then
         call look_ahead(self, model, h, status)
      else if (new_jacobian) then
         call refresh_jacobian(self, model, status)
      end if
      if (has_failed(status)) return
      if (new_factors) call factor_systems(self%stages, model, self%y, h, good)
      if (good .and. linear) call predict_linearly(self%stages, self%y, h)
   end subroutine prepare

   !> df/dy at the predicted middle of a step of h; at the present state if that is outside the model's domain.
   subroutine look_ahead(self, model, h, status)
      type(radau_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      real(wp), intent(in) :: h
      type(status_t), intent(inout) :: status

      self%stages%moved = self%y + self%stages%z(middle, :)
      status%in_words = .false.
      call model%jacobian(self%t + node(middle)*h, self%stages%moved, self%stages%jacobian, status)
      status%in_words = .true.
      self%counts%jacobians = self%counts%jacobians + 1
      self%jacobian_is_new = .not. has_failed(status)
      if (status%code /= code_out_of_domain) return
      call clear(status)
      call refresh_jacobian(self, model, status)
   end subroutine look_ahead

   !> Whether two step sizes are equal.
   pure logical function same(a, b)
      real(wp), intent(in) :: a, b

      same = .not. abs(a - b) > 0
   end function same

end submodule evl_radau_attempt
