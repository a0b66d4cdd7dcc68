!> Shortening of steps that do not follow a growing vibration.
submodule(evl_radau) evl_radau_growth
   use evl_growth, only: follows_growth, judge_growth, step_may_be_too_long
   use evl_ode_model, only: growth_by_coupling
   use evl_radau_coefficients, only: n_stages, node
   implicit none (type, external)

contains

   !> Check that the step just solved follows the growing modes; if not, set the step to try next.
   !>
   !> Motions below the tolerance follow the Jacobian, since no iteration corrects them. While such a motion grows, the
   !> Jacobian must be renewed from time to time.
   !>
   !> If damping can be negative, every step that may be too long is checked in its middle and at its end. Otherwise forces
   !> change less, and an occasional check of the current Jacobian is sufficient.
   module procedure follow_growth
      integer, parameter :: few = 4, many = 8 !! steps between two checks: while a mode grows; with positive damping
      integer, parameter :: middle = 4        !! stage nearest to the middle of a step
      logical :: grows, look

      associate (growth => self%growth)
         followed = .true.
         grows = growth%shortens
         if (.not. grows) growth%longest = huge(h)
         growth%steps = growth%steps + 1
         if (grows .and. growth%steps < few .and. follows_growth(growth, h)) return
         if (model%growth == growth_by_coupling) then
            if (growth%jacobians == self%counts%jacobians .or. (growth%steps < many .and. .not. grows)) return
         end if
         look = grows
         if (.not. grows) call step_may_be_too_long(growth, self%stages%jacobian, self%counts%jacobians, h, look)
         if (.not. look) return
         growth%steps = 0
         growth%jacobians = self%counts%jacobians
         if (model%growth == growth_by_coupling) then
            call judge_growth(growth, self%stages%jacobian, h)
            call note(self, self%t)
            followed = follows_growth(growth, h)
            if (.not. followed) call cut(self, growth%longest)
         else
            call judge_at(self, model, h, middle, status)
            followed = follows_growth(growth, h)
            if (followed) then
               call judge_at(self, model, h, n_stages, status)
               followed = follows_growth(growth, h)
               if (.not. followed) call cut(self, max(h/2, growth%longest)) ! growth begins behind the middle: approach it
            else
               call cut(self, growth%longest)
            end if
         end if
         growth%shortens = growth%longest < huge(h) .and. growth%shortens
         growth%wants_jacobian = growth%shortens
      end associate
   end procedure follow_growth

   !> Check a stage of the step just solved.
   subroutine judge_at(self, model, h, stage, status)
      type(radau_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      real(wp), intent(in) :: h
      integer, intent(in) :: stage
      type(status_t), intent(inout) :: status

      self%stages%moved = self%stages%y(stage, :)
      status%in_words = .false.
      call model%jacobian(self%t + node(stage)*h, self%stages%moved, self%growth%jacobian, status)
      status%in_words = .true.
      if (has_failed(status)) then ! past an event the model may be outside its domain
         if (status%code == code_out_of_domain) call clear(status)
         self%growth%longest = huge(h)
      else
         call judge_growth(self%growth, self%growth%jacobian, h)
         call note(self, self%t + node(stage)*h)
      end if
   end subroutine judge_at

   !> Request a shorter step.
   pure subroutine cut(self, h)
      type(radau_t), intent(inout) :: self
      real(wp), intent(in) :: h

      self%h = h
      self%growth%shortens = .not. h > self%growth%longest
      if (h > self%growth%longest) self%growth%longest = huge(h) ! to be checked again
      self%counts%growth_cuts = self%counts%growth_cuts + 1
   end subroutine cut

   !> Record the fastest growing vibration; a mode that does not oscillate only if there is none.
   pure subroutine note(self, t)
      type(radau_t), intent(inout) :: self
      real(wp), intent(in) :: t !! time of the growth
      logical :: is_faster

      associate (growth => self%growth, fastest => self%fastest_growth)
         if (.not. growth%longest < huge(t)) return
         is_faster = growth%re > fastest%re
         if (growth%im > 0 .neqv. fastest%im > 0) is_faster = growth%im > 0
         if (is_faster) fastest = radau_growth(t, growth%re, growth%im)
      end associate
   end subroutine note

end submodule evl_radau_growth
