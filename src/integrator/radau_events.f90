!> End of an integrator step: at its intended end, or at the first event in it.
submodule(evl_radau) evl_radau_events
   use evl_collocation, only: lagrange_at
   use evl_distant_roots, only: sign_of
   use evl_extreme_finder, only: find_candidates
   use evl_radau_coefficients, only: n_stages, node
   use evl_root_finder, only: find_crossings, locate, step_state, values_at
   implicit none (type, external)

   !> A zero is located if the function is this close to it. Time may be too coarse for that: if a function changes by its
   !> scale within a nanosecond, one digit of a time of seconds is 1e-6 of it. The state then advances although time does not.
   real(wp), parameter :: located = 1.0e-8_wp

   !> Accuracy of a time on a polynomial compared with that on the recomputed one, in units of the step.
   real(wp), parameter :: accuracy = 1.0e-4_wp

contains

   !> Accept the step just solved, or the part of it before the first event.
   module procedure finish
      integer :: first

      done = .true.
      outcome = merge(outcome_stop, outcome_step, to_stop)
      if (self%roots%n > 0) then
         call find_crossings(self%roots, model, step_state(self%t, h), self%y, self%stages%z, self%stages%y, first, &
                             status)
         if (has_failed(status)) return
         if (first /= 0) then
            outcome = outcome_event
            call go_to_event(self, model, h, first, done, status)
            return
         end if
         self%roots%sign_now = self%roots%sign_after
         self%roots%fresh = .false.
      end if
      call take(self, h, merge(t_stop, self%t + h, to_stop), self%stages%y(n_stages, :))
      call move_start(self%stages, h)
   end procedure finish

   !> Store the polynomial of the step and advance.
   subroutine take(self, h, t, y)
      type(radau_t), intent(inout) :: self
      real(wp), intent(in) :: h    !! step of the polynomial
      real(wp), intent(in) :: t    !! new time
      real(wp), intent(in) :: y(:) !! new state

      self%t_before = self%t
      self%old_h = h
      self%t = t
      call store_polynomial(size(self%y), self%stages%z, self%y, self%old_z, self%y_before)
      self%y(:) = y
      self%jacobian_is_new = .false.
      self%jacobian_is_ahead = .false.
      self%counts%steps = self%counts%steps + 1
   end subroutine take

   !> Copy increments and start of the step; explicit-shape arguments avoid access to array descriptors.
   pure subroutine store_polynomial(n, z, y, old_z, y_before)
      integer, intent(in) :: n
      real(wp), intent(in) :: z(lanes, n), y(n)
      real(wp), intent(out) :: old_z(lanes, n), y_before(n)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            old_z(l, i) = z(l, i)
         end do
      end do
      y_before = y
   end subroutine store_polynomial

   !> Repeat the step of h up to the crossing of function `first`, correct the time for the resulting change, and stop there.
   !>
   !> Within a step the dense output has the accuracy of the internal tolerance; only the state at the end of a step has the
   !> full order. The step is therefore repeated up to the time found, where the function is zero except for the error of the
   !> dense output. The rest is a correction along the new polynomial or, if it is too large for that, one more step.
   subroutine go_to_event(self, model, h, first, done, status)
      type(radau_t), intent(inout) :: self
      class(ode_model), intent(inout) :: model
      real(wp), intent(in) :: h
      integer, intent(in) :: first
      logical, intent(out) :: done
      type(status_t), intent(inout) :: status
      integer, parameter :: most_hidden = 8 !! functions found in succession, each earlier than the previous one
      real(wp) :: at, h_now, slope
      integer :: earlier, event, turn
      logical :: good, at_start

      done = .false.
      event = first
      at = self%roots%tau(event)*h
      if (at <= smallest_step*abs(self%t)) then
         call fire_at_start(self, model, event, h, at, status)
         done = .true.
         return
      end if
      call slope_at(self%roots, event, slope)
      slope = slope/h
      self%old_z = self%stages%z
      self%old_h = h
      h_now = h
      do turn = 1, most_hidden
         call come_to(self, model, h, event, slope, h_now, at, good, at_start, status)
         if (has_failed(status) .or. .not. good) exit
         if (at_start) then
            call fire_at_start(self, model, event, h_now, max(at, 0.0_wp), status)
            self%old_h = 0
            done = .true.
            return
         end if
         call find_hidden(self, model, h, h_now, at, earlier, slope, status)
         if (has_failed(status) .or. earlier == 0) exit
         event = earlier
         at = self%roots%tau(event)*h
      end do
      self%matrix_may_stay = .false.
      if (has_failed(status) .or. .not. good) then
         ! the shorter step fails: approach the event in ordinary steps
         self%old_h = 0
         self%h = at/2
         return
      end if
      call note_fired(self, event, h)
      call take(self, h_now, self%t + at, self%roots%y)
      self%counts%events = self%counts%events + 1
      done = .true.
   end subroutine go_to_event

   !> Repeat the step up to the zero crossing of a function.
   subroutine come_to(self, model, h, event, slope, h_now, at, good, at_start, status)
      type(radau_t), intent(inout) :: self
      class(ode_model), intent(inout) :: model
      real(wp), intent(in) :: h         !! step that was searched
      integer, intent(in) :: event      !! the function
      real(wp), intent(in) :: slope     !! its slope at the crossing
      real(wp), intent(inout) :: h_now  !! step of the stages
      real(wp), intent(inout) :: at     !! time of the crossing from the start; in: on the polynomial of the stages
      logical, intent(out) :: good      !! false: Newton's iteration failed, results are undefined
      logical, intent(out) :: at_start  !! no time passes up to the crossing: roots and state there are undefined
      type(status_t), intent(inout) :: status
      integer, parameter :: most_turns = 6
      real(wp), parameter :: small = 1.0e-4_wp !! correction, over the step, up to which the polynomial is extrapolated
      real(wp) :: at_next, shift, last_shift
      integer :: outcome, turn

      good = .true.
      at_start = .false.
      at_next = at
      last_shift = huge(last_shift)
      do turn = 1, most_turns
         at = at_next
         if (abs(at - h_now) > small*at) then
            h_now = at
            call factor_systems(self%stages, model, self%y, h_now, good)
            if (good) then
               call predict_from(self%stages, self%y, self%old_z, 0.0_wp, h_now, self%old_h)
               call solve_stages(self%stages, model, self%t, self%y, h_now, outcome, status)
               if (has_failed(status)) return
               good = outcome == newton_converged
            end if
            if (.not. good) return
            self%old_z = self%stages%z
            self%old_h = h_now
         end if
         call values_at(self%roots, model, step_state(self%t, h_now), self%y, self%stages%z, at/h_now, status)
         if (has_failed(status)) return
         shift = -self%roots%value(event)/slope
         shift = max(self%roots%left(event)*h - at, min(self%roots%right(event)*h - at, shift))
         if (.not. abs(shift) < abs(last_shift)) return
         last_shift = shift
         if (abs(shift) <= 4*eps*max(abs(self%t + at), at) .and. abs(self%roots%value(event)) <= located) return
         at_next = at + shift
         if (at_next <= smallest_step*abs(self%t)) then ! a function that crosses just after another one
            at = at_next
            at_start = .true.
            return
         end if
      end do
   end subroutine come_to

   !> Find a function that is past zero at an event although no node of the searched step showed it, such as one that turns
   !> just behind the event: it crossed earlier.
   subroutine find_hidden(self, model, h, h_now, at, first, slope, status)
      type(radau_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      real(wp), intent(in) :: h       !! step that was searched
      real(wp), intent(in) :: h_now   !! step of the stages
      real(wp), intent(in) :: at      !! time of the event from the start; the functions are evaluated there
      integer, intent(out) :: first   !! index of such a function, 0: there is none
      real(wp), intent(inout) :: slope !! its slope at the crossing
      type(status_t), intent(inout) :: status
      integer, parameter :: most_cuts = 8    !! by 16 each: of the interval from the previous node to the crossing
      real(wp), parameter :: small = 1.0e-2_wp   !! of the value at the event: below it, the slope counts as that at zero
      type(step_state) :: step
      real(wp) :: at_zero, before
      integer :: i, k, last

      first = 0
      last = lanes ! node before the event, or the start
      do k = 1, n_stages
         if (node(k)*h < at) last = k
      end do
      do k = 1, self%roots%n_live
         i = self%roots%live(k)
         if (is_past(i)) first = i
      end do
      if (first == 0) return
      i = first
      step = step_state(self%t, h_now)
      self%roots%change(i) = -sign_of(self%roots%g(last, i))
      self%roots%left(i) = node(last)*h/h_now
      self%roots%right(i) = at/h_now
      self%roots%at_left(i) = self%roots%g(last, i)
      self%roots%at_right(i) = self%roots%value(i)
      call locate(self%roots, model, step, self%y, self%stages%z, i, status)
      if (has_failed(status)) return
      associate (roots => self%roots)
         call values_at(roots, model, step, self%y, self%stages%z, roots%tau(i), status, i)
         at_zero = roots%value(i)
         before = roots%tau(i) - roots%left(i)
         do k = 1, most_cuts
            if (has_failed(status)) return
            before = before/16
            call values_at(roots, model, step, self%y, self%stages%z, roots%tau(i) - before, status, i)
            if (abs(roots%value(i)) <= small*abs(roots%at_right(i))) exit
         end do
         slope = (at_zero - roots%value(i))/(before*h_now)
         roots%tau(i) = roots%tau(i)*(h_now/h)
         roots%left(i) = roots%left(i)*(h_now/h)
         roots%right(i) = roots%right(i)*(h_now/h)
      end associate

   contains

      !> Whether a function without a crossing, or with a later one, is past zero. For one that has just fired, only nodes
      !> determine the sign.
      pure logical function is_past(i)
         integer, intent(in) :: i
         integer :: s

         s = merge(self%roots%sign_after(i), -self%roots%change(i), self%roots%change(i) == 0)
         is_past = self%roots%direction(i) /= s .and. s*self%roots%g(last, i) > 0 .and. s*self%roots%value(i) < -located &
                   .and. .not. (last == lanes .and. self%roots%fresh(i))
         if (self%roots%change(i) /= 0) is_past = is_past .and. (self%roots%tau(i) - at/h > accuracy)
      end function is_past

   end subroutine find_hidden

   !> The event is at the start of the step within the resolution of time: no time passes.
   subroutine fire_at_start(self, model, first, h, at, status)
      type(radau_t), intent(inout) :: self
      class(ode_model), intent(inout) :: model
      integer, intent(in) :: first
      real(wp), intent(in) :: h  !! of the stages
      real(wp), intent(in) :: at !! from the start [s]
      type(status_t), intent(inout) :: status

      call values_at(self%roots, model, step_state(self%t, h), self%y, self%stages%z, 0.0_wp, status)
      if (abs(self%roots%value(first)) > located) then
         call values_at(self%roots, model, step_state(self%t, h), self%y, self%stages%z, at/h, status)
         if (.not. has_failed(status)) self%y(:) = self%roots%y
      end if
      self%roots%value = 0
      call note_fired(self, first, h)
      self%counts%events = self%counts%events + 1
   end subroutine fire_at_start

   !> Slope of the interpolant of a root function at its zero crossing, per step.
   pure subroutine slope_at(roots, i, slope)
      type(root_finder_t), intent(in) :: roots
      integer, intent(in) :: i
      real(wp), intent(out) :: slope
      real(wp) :: basis(lanes)

      call lagrange_at(roots%tau(i), basis)
      slope = sum(basis*roots%slope(:, i))
   end subroutine slope_at

   !> Mark all functions that cross zero at this event: the first, simultaneous ones, and those that crossed in the repeated step.
   pure subroutine note_fired(self, first, h)
      type(radau_t), intent(inout) :: self
      integer, intent(in) :: first
      real(wp), intent(in) :: h
      real(wp) :: same_time, later
      integer :: i

      same_time = 1.0e-12_wp + smallest_step*abs(self%t)/h
      do i = 1, self%roots%n
         if (self%roots%change(i) == 0) cycle
         later = self%roots%tau(i) - self%roots%tau(first)
         if (later <= same_time .or. (later < accuracy .and. self%roots%value(i)*self%roots%change(i) > 0)) then
            self%fired(i) = self%roots%change(i)
         end if
      end do
   end subroutine note_fired

   !> Candidates for new extremes in the last step; none if it has no length.
   module procedure radau_look
      n = 0
      if (.not. (self%old_h > 0 .and. self%t > self%t_before)) return
      call model%monitored_nearby(self%stages%y, self%monitored%n, self%monitored%channels, self%monitored%values)
      call find_candidates(self%monitored, high, low, n, found)
   end procedure radau_look

end submodule evl_radau_events
