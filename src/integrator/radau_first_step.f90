!> Size of the first step, at the start and after an event.
submodule(evl_radau) evl_radau_first_step
   use evl_stage_solver, only: predict_step
   implicit none (type, external)

contains

   !> First step that moves the state by about a hundredth of its scales, from f and its change along an Euler step: f may be
   !> 0 at the start.
   module procedure choose_first_step
      real(wp), parameter :: part = 0.01_wp, probe = 1.0e-6_wp
      real(wp) :: speed, acceleration, h

      associate (f => self%stages%start, moved => self%stages%moved, moved_f => self%stages%moved_f)
         call model%rhs(self%t, self%y, f, status)
         if (has_failed(status)) return
         speed = maxval(abs(f)/model%scale)
         h = min(self%options%max_step, probe/max(speed, part))
         self%stages%counts%evaluations = 2
         moved = self%y + h*f
         call model%rhs(self%t + h, moved, moved_f, status)
         if (has_failed(status)) then ! boundary of the domain: the step has to be small
            if (status%code /= code_out_of_domain) return
            call clear(status)
            self%h = h
            return
         end if
         acceleration = maxval(abs(moved_f - f)/model%scale)/h
         self%h = min(self%options%max_step, part/max(speed, sqrt(acceleration), part*probe))
      end associate
   end procedure choose_first_step

   !> Step to try after a start or an event, from f and J. The step before the event limits it, since J does not contain
   !> everything, such as a time-dependent load. For a recurring event, the stored step after the last one is the limit; at
   !> the start there is none.
   !>
   !> J at the event may differ from J after it (a force law may begin with slope 0). J is therefore also evaluated ahead, in
   !> the middle of the step; if the step then has to be much shorter, once more.
   module procedure choose_step
      real(wp), parameter :: most_down = 100, most_up = 8
      integer, parameter :: most_turns = 4
      real(wp) :: h, h_ahead, least, most
      integer :: turn

      call model%rhs(self%t, self%y, self%stages%start, status)
      if (has_failed(status)) return
      self%stages%start_is_known = .true.
      self%stages%counts%evaluations = self%stages%counts%evaluations + 1
      most = huge(most)
      do turn = 1, size(self%came_from)
         most = min(most, self%step_after(self%came_from(turn), turn))
      end do
      h = min(most, most_up*self%h)
      if (.not. most < huge(most)) h = self%h
      if (self%counts%steps == 0) then
         call refresh_jacobian(self, model, status)
         if (has_failed(status)) return
         call predict_step(self%stages, model, h)
      end if
      least = min(most, self%h/most_down)
      h = min(max(least, h), self%options%max_step, step_limit(self, model))
      do turn = 1, most_turns
         self%jacobian_is_new = .false.
         self%stages%moved = self%y + h/2*self%stages%start
         call model%jacobian(self%t + h/2, self%stages%moved, self%stages%jacobian, status)
         self%counts%jacobians = self%counts%jacobians + 1
         self%jacobian_is_ahead = .not. has_failed(status)
         if (has_failed(status)) then ! outside the model's domain: evaluate nearer
            if (status%code /= code_out_of_domain) return
            call clear(status)
            h = h/4
            cycle
         end if
         call predict_step(self%stages, model, h_ahead)
         h_ahead = max(least, min(h, h_ahead))
         if (h_ahead > h/2) exit
         h = h_ahead
      end do
      self%h = h
      self%restarted = .false.
   end procedure choose_step

   !> Store a suitable first step after an event, for the next event of the same kind.
   module procedure remember_step
      real(wp), parameter :: most_growth = 4, aim = 0.5_wp
      integer :: i

      do i = 1, size(self%came_from)
         if (self%came_from(i) /= 0) self%step_after(self%came_from(i), i) = &
            h*min(most_growth, real_power(aim/error, 0.125_wp))
      end do
   end procedure remember_step

   !> df/dy at the present state.
   module procedure refresh_jacobian
      call model%jacobian(self%t, self%y, self%stages%jacobian, status)
      self%counts%jacobians = self%counts%jacobians + 1
      self%jacobian_is_new = .not. has_failed(status)
   end procedure refresh_jacobian

end submodule evl_radau_first_step
