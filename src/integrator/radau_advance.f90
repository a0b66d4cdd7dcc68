!> One step: trials until one is accepted.
submodule(evl_radau) evl_radau_advance
   use evl_growth, only: limit_step
   use evl_root_forecast, only: forecast_crossing
   use evl_step_control, only: fit_step, next_step, step_after_error
   implicit none (type, external)

   integer, parameter :: most_rejections = 200  !! of one step

contains

   !> Make one step, at most to t_stop and at most to the next event.
   module procedure radau_advance
      type(step_control_t) :: failed
      real(wp) :: h, h_proposed, h_most, error
      logical :: to_stop, done, refused
      integer :: try

      outcome = outcome_step
      refused = .false.
      self%fired = 0
      call set_weights(self%stages, model%scale, self%y)
      if (self%restarted) call choose_step(self, model, status)
      if (has_failed(status)) return
      h_most = min(self%options%max_step, step_limit(self, model))
      do try = 1, most_rejections
         h_proposed = min(self%h, h_most)
         call limit_step(self%growth, h_proposed)
         if (.not. h_proposed > smallest_step*abs(self%t)) exit
         call fit_step(t_stop - self%t, h_proposed, h, to_stop)
         call fit_event(self, h, to_stop)
         call attempt(self, model, h, error, status)
         done = .not. has_failed(status) .and. error < 1
         if (done) call check_resolution(self, model, h, done)
         if (done .and. model%growth /= growth_never) call follow_growth(self, model, h, done, status)
         if (done) then
            call finish(self, model, h, to_stop, t_stop, done, outcome, status)
            if (done .and. .not. has_failed(status)) then
               self%rejected = .false.
               if (.not. self%control%h > 0) call remember_step(self, h, error)
               if (outcome /= outcome_event) &
                  call next_step(self%control, h, h_proposed, error, self%stages%rate, self%stages%iterations, self%h, &
                                 self%jacobian_may_stay, self%matrix_may_stay)
               self%jacobian_may_stay = self%jacobian_may_stay .and. .not. self%growth%wants_jacobian
               self%matrix_may_stay = self%matrix_may_stay .and. .not. self%growth%wants_jacobian
               self%growth%wants_jacobian = .false.
               return
            end if
         else if (.not. has_failed(status) .and. error >= 1 .and. error < huge(error)) then
            call step_after_error(failed, h, error, self%h)
         end if
         if (has_failed(status)) then
            if (status%code /= code_out_of_domain) return
            self%h = h/4
            refused = .true.
            self%refusal = status
            self%refused_t = self%stages%times
            self%refused_y = self%stages%y
            call clear(status)
         end if
         self%rejected = .true.
         self%jacobian_may_stay = .false.
         self%matrix_may_stay = .false.
         self%counts%rejections = self%counts%rejections + 1
      end do
      if (refused) then
         status = self%refusal
         if (len_trim(status%message) == 0) call put_into_words(self, model, status)
         return
      end if
      call fail(status, code_no_solution, "the step fell to "//quantity(self%h, "")//" at time "//quantity(self%t, "")// &
                ": errors or iterations prevent a larger one")
   end procedure radau_advance

   !> Obtain the model's message for the stages of the last trial step that it refused.
   subroutine put_into_words(self, model, status)
      type(radau_t), intent(inout) :: self
      class(ode_model), intent(inout) :: model
      type(status_t), intent(inout) :: status

      call clear(status)
      call model%rhs_lanes(self%refused_t, self%refused_y, self%stages%f, status)
      if (.not. has_failed(status)) status = self%refusal
   end subroutine put_into_words

   !> End the step just past a predicted event, so that it need not be repeated to end there.
   pure subroutine fit_event(self, h, to_stop)
      type(radau_t), intent(in) :: self
      real(wp), intent(inout) :: h
      logical, intent(inout) :: to_stop
      real(wp), parameter :: past = 5.0e-5_wp      !! of the time to the event
      real(wp), parameter :: nearest = 1.0e-6_wp   !! of the step: a nearer event needs no step of its own
      real(wp) :: tau

      if (.not. self%old_h > 0 .or. self%roots%n == 0) return
      tau = forecast_crossing(self%roots, h/self%old_h)
      if (tau*(1 + past) >= 1 .or. tau < nearest .or. tau*h < 4*smallest_step*abs(self%t)) return
      h = tau*(1 + past)*h
      to_stop = .false.
   end subroutine fit_event

end submodule evl_radau_advance
