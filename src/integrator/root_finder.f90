!> Detection and location of zeros of the root functions within a step.
!>
!> All root functions are known at the eight nodes of the step. A sign change between two nodes is a crossing. A function that
!> touches zero and returns between two nodes shows no sign change: its interpolant falls towards zero at the left node, rises at
!> the right one, and the two tangents intersect beyond zero. Only then is the extremum of the interpolant computed. If it is near
!> zero, the model is evaluated there and on the way to the extremum of its own function. A sign change found this way splits the
!> interval. Not detected are two extrema between two neighbouring nodes, and a dip below the accuracy of the dense output.
!>
!> Most functions change little in a step. If the values at the nodes exclude an interpolant near zero, no further test
!> follows. Functions that the model declares `never` zero in its discrete state cost nothing.
!>
!> A function that has just fired is zero at the start up to rounding: its sign there is that of its slope.
module evl_root_finder
   use evl_collocation, only: combine, extremum_between, lagrange_at, polynomial_at, slopes_of, weighted_sum
   use evl_distant_roots, only: list_near, near_zero, sign_of
   use evl_kinds, only: lanes, wp
   use evl_ode_model, only: never, ode_model
   use evl_radau_coefficients, only: n_stages, node
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: root_finder_t, root_finder_create, root_finder_restart, find_crossings, locate, step_state, values_at

   real(wp), parameter :: nearly_zero = 1.0e-8_wp !! of a function's largest value: below this, one that has fired is still zero
   real(wp), parameter :: clearly = 1.0e-8_wp     !! past zero, by more than the accuracy of event location
   real(wp), parameter :: tie = 1.0e-13_wp        !! crossings nearer together than this, in units of the step, coincide
   integer, parameter :: in_time(0:n_stages) = [lanes, 1, 2, 3, 4, 5, 6, 7] !! nodes from left to right

   !> Signs, and the first crossing of each function in the step last searched.
   type :: root_finder_t
      integer :: n = 0
      real(wp), allocatable :: g(:, :)      !! [8, n] values at the nodes
      real(wp), allocatable :: slope(:, :)  !! [8, n] slopes of their interpolants, per step
      real(wp), allocatable :: value(:)     !! [n] values at one time
      real(wp), allocatable :: y(:)         !! state at that time; for one function, only the components that it needs
      integer, allocatable :: sign_now(:)   !! [n] at the end of the last step, or after an event; 0: unknown
      integer, allocatable :: sign_after(:) !! [n] at the end of the step last searched
      integer, allocatable :: direction(:)  !! [n] of the crossings that count, 0: both
      integer :: n_live = 0                 !! functions that may become zero before the next event
      integer, allocatable :: live(:)       !! [n] the first n_live of these: their indices
      integer :: n_near = 0                 !! those of them that came near zero in the step last searched, or changed much
      integer, allocatable :: near(:)       !! [n] the first n_near of these: their indices
      logical, allocatable :: fresh(:)      !! [n] has fired at the start of the step
      integer, allocatable :: change(:)     !! [n] first crossing that counts: +1 rising, -1 falling, 0 none
      real(wp), allocatable :: left(:), right(:) !! [n] bracket of that crossing, in units of the step
      real(wp), allocatable :: at_left(:), at_right(:) !! [n] values there, of different sign
      real(wp), allocatable :: tau(:)       !! [n] the crossing, in units of the step, of a function with a `change`
      integer :: evaluations = 0            !! scalar evaluations of the root functions
   end type root_finder_t

   !> A step to search: y(t + tau h) = y + sum of basis(tau) z.
   type :: step_state
      real(wp) :: t = 0, h = 0
   end type step_state

contains

   !> Allocate the arrays for the root functions of a model.
   subroutine root_finder_create(self, model)
      type(root_finder_t), intent(out) :: self
      class(ode_model), intent(in) :: model
      integer :: n

      n = model%n_roots
      self%n = n
      allocate (self%g(lanes, n), self%slope(lanes, n), self%value(n), self%y(model%n), self%sign_now(n), self%sign_after(n), &
                self%direction(n), self%live(n), self%near(n), self%fresh(n), self%change(n), self%left(n), self%right(n), &
                self%at_left(n), self%at_right(n), self%tau(n))
      self%fresh = .false.
      self%sign_now = 0
   end subroutine root_finder_create

   !> Restart after an event, or with nothing fired.
   subroutine root_finder_restart(self, model, fired)
      type(root_finder_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      integer, intent(in) :: fired(:)
      integer :: i

      self%fresh = fired /= 0
      self%sign_after = 0
      self%change = 0
      call model%root_directions(self%direction)
      self%sign_now = merge(fired, 0, self%direction == -fired) ! if only the crossing back counts, the sign is that after the event
      self%n_live = 0
      do i = 1, self%n
         if (self%direction(i) == never) cycle
         self%n_live = self%n_live + 1
         self%live(self%n_live) = i
      end do
   end subroutine root_finder_restart

   !> Find the first crossing of each function in a step and locate it on the collocation polynomial.
   subroutine find_crossings(self, model, step, y, z, stage_y, first, status)
      type(root_finder_t), intent(inout) :: self
      class(ode_model), intent(inout) :: model
      type(step_state), intent(in) :: step
      real(wp), intent(in) :: y(model%n)        !! at the start
      real(wp), intent(in) :: z(lanes, model%n) !! increments
      real(wp), intent(in) :: stage_y(lanes, model%n) !! states at the nodes
      integer, intent(out) :: first             !! function that crosses zero first, 0: none
      type(status_t), intent(inout) :: status
      real(wp) :: earliest, time(lanes)
      logical :: exact
      integer :: i, k

      first = 0
      time = step%t + step%h*node
      self%change = 0
      exact = .false.
      call model%roots_lanes(time, stage_y, exact, self%g, status)
      if (has_failed(status)) return
      call list_near(self%n, self%n_live, self%live, self%g, self%sign_now, self%sign_after, self%n_near, self%near)
      if (self%n_near == 0) return
      if (.not. exact) then
         exact = .true.
         call model%roots_lanes(time, stage_y, exact, self%g, status)
         if (has_failed(status)) return
         call list_near(self%n, self%n_live, self%live, self%g, self%sign_now, self%sign_after, self%n_near, self%near)
      end if
      earliest = huge(earliest)
      do k = 1, self%n_near
         i = self%near(k)
         call combine(1, slopes_of, self%g(:, i), self%slope(:, i))
         call scan(self, model, step, y, z, i, status)
         if (has_failed(status)) return
         if (self%change(i) == 0) cycle
         call locate(self, model, step, y, z, i, status)
         if (has_failed(status)) return
         if (self%tau(i) < earliest) then
            first = i
            earliest = self%tau(i)
         end if
      end do
   end subroutine find_crossings

   !> Bracket the first crossing of function i that counts.
   subroutine scan(self, model, step, y, z, i, status)
      type(root_finder_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      type(step_state), intent(in) :: step
      real(wp), intent(in) :: y(:), z(:, :)
      integer, intent(in) :: i
      type(status_t), intent(inout) :: status
      integer :: k, l, r, s
      real(wp) :: last, at_last, middle, at_middle

      s = self%sign_now(i)
      if (s == 0 .or. self%fresh(i)) s = sign_of(self%g(lanes, i))
      last = 0
      at_last = self%g(lanes, i)
      if (starts_at_zero()) then
         s = sign_of(self%slope(lanes, i))
         if (s*self%sign_now(i) < 0 .and. s*at_last < 0) then ! it touched zero and returns
            s = -s
         else if (s*self%g(1, i) < 0) then ! away from zero and back before the first stage, or rounding
            s = 0
            if (self%slope(lanes, i)*self%slope(1, i) < 0) then
               last = extremum_between(0.0_wp, node(1), self%slope(:, i))
               call values_at(self, model, step, y, z, last, status, i)
               if (has_failed(status)) return
               at_last = self%value(i)
               if (at_last*self%slope(lanes, i) > 0) s = sign_of(at_last)
            end if
         end if
      else if (s*at_last < 0) then
         at_last = 0 ! rounding changed its sign; the crossing is at the start
      end if
      do k = 1, n_stages
         l = in_time(k - 1)
         r = in_time(k)
         if (s*self%g(r, i) < 0) then
            if (counts(-s)) then
               call bracket(last, node(r), at_last, self%g(r, i), -s)
               return
            end if
            s = -s
         else if (s /= 0 .and. may_dip()) then
            middle = extremum_between(node(l), node(r), self%slope(:, i))
            if (s*polynomial_at(middle, self%g(:, i)) < near_zero*maxval(abs(self%g(:, i)))) then
               call approach(self, model, step, y, z, i, s, l, r, middle, at_middle, status)
               if (has_failed(status)) return
               if (s*at_middle < 0) then
                  if (counts(-s)) then
                     call bracket(last, middle, at_last, at_middle, -s)
                  else
                     call bracket(middle, node(r), at_middle, self%g(r, i), s)
                  end if
                  return
               end if
            end if
         end if
         if (s == 0) s = sign_of(self%g(r, i))
         if (abs(self%g(r, i)) > 0) then
            last = node(r)
            at_last = self%g(r, i)
         end if
      end do
      if (never_came_back()) then
         call bracket(0.0_wp, node(1), 0.0_wp, self%g(1, i), -self%sign_now(i))
         return
      end if
      self%sign_after(i) = s

   contains

      !> Whether a function that has fired, and whose crossing back counts, is past that zero in the whole step, and clearly
      !> so at its end: it touched zero at the start of the step, and the crossing back is there.
      pure logical function never_came_back()

         never_came_back = .false.
         if (.not. self%fresh(i) .or. self%sign_now(i) == 0) return
         never_came_back = abs(self%g(lanes, i)) <= clearly .and. all(self%sign_now(i)*self%g(:n_stages, i) < 0) &
                           .and. self%sign_now(i)*self%g(n_stages, i) < -clearly
      end function never_came_back

      !> Whether the slope determines the sign at the start.
      pure logical function starts_at_zero()

         starts_at_zero = self%sign_now(i) == 0 .and. .not. abs(self%g(lanes, i)) > 0
         if (self%fresh(i)) starts_at_zero = abs(self%g(lanes, i)) <= nearly_zero*maxval(abs(self%g(:, i)))
      end function starts_at_zero

      !> Whether a crossing in this direction is an event.
      pure logical function counts(change)
         integer, intent(in) :: change

         counts = self%direction(i) == 0 .or. self%direction(i) == change
      end function counts

      !> Whether the tangents at two neighbouring nodes intersect beyond zero.
      pure logical function may_dip()
         real(wp) :: width, slope_l, slope_r, x

         width = node(r) - node(l)
         slope_l = s*self%slope(l, i)
         slope_r = s*self%slope(r, i)
         may_dip = .false.
         if (.not. (slope_l < 0 .and. slope_r > 0)) return
         x = (s*(self%g(r, i) - self%g(l, i)) - slope_r*width)/(slope_l - slope_r)
         may_dip = s*self%g(l, i) + slope_l*x <= 0
      end function may_dip

      !> Record the crossing.
      subroutine bracket(left, right, at_left, at_right, change)
         real(wp), intent(in) :: left, right, at_left, at_right
         integer, intent(in) :: change

         self%left(i) = left
         self%right(i) = right
         self%at_left(i) = at_left
         self%at_right(i) = at_right
         self%change(i) = change
         self%sign_after(i) = change
      end subroutine bracket

   end subroutine scan

   !> Follow function i from a time between two nodes towards its extremum until it crosses zero or is as near as it gets:
   !> parabolas through three values of the model itself, since its interpolant may be too inaccurate.
   subroutine approach(self, model, step, y, z, i, s, l, r, middle, at_middle, status)
      type(root_finder_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      type(step_state), intent(in) :: step
      real(wp), intent(in) :: y(:), z(:, :)
      integer, intent(in) :: i, s, l, r       !! function, its sign at both nodes, the nodes
      real(wp), intent(inout) :: middle       !! in: start of the search; out: its end
      real(wp), intent(out) :: at_middle      !! the function there
      type(status_t), intent(inout) :: status
      integer, parameter :: most_turns = 5
      real(wp), parameter :: near = 1.0e-3_wp !! of the interval: accuracy at which the search ends
      real(wp) :: a, b, f_a, f_b, f_middle, f, tau, slope_a, slope_b
      integer :: turn

      a = node(l)
      b = node(r)
      at_middle = 0
      f_a = s*self%g(l, i)
      f_b = s*self%g(r, i)
      call values_at(self, model, step, y, z, middle, status, i)
      if (has_failed(status)) return
      at_middle = self%value(i)
      do turn = 1, most_turns
         f_middle = s*at_middle
         if (f_middle < 0 .or. f_middle >= min(f_a, f_b)) return
         slope_a = (f_middle - f_a)/(middle - a)
         slope_b = (f_b - f_middle)/(b - middle)
         tau = (a + middle)/2 - slope_a*(b - a)/(2*(slope_b - slope_a))
         if (abs(tau - middle) < near*(node(r) - node(l))) return
         call values_at(self, model, step, y, z, tau, status, i)
         if (has_failed(status)) return
         f = s*self%value(i)
         if (f < f_middle) then
            if (tau < middle) then
               b = middle
               f_b = f_middle
            else
               a = middle
               f_a = f_middle
            end if
            middle = tau
            at_middle = self%value(i)
         else if (tau < middle) then
            a = tau
            f_a = f
         else
            b = tau
            f_b = f
         end if
      end do
   end subroutine approach

   !> Locate the crossing of function i in its bracket: false position with halving (Illinois), with evaluations of the model.
   subroutine locate(self, model, step, y, z, i, status)
      type(root_finder_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      type(step_state), intent(in) :: step
      real(wp), intent(in) :: y(:), z(:, :)
      integer, intent(in) :: i
      type(status_t), intent(inout) :: status
      integer, parameter :: most_turns = 60
      real(wp) :: a, b, at_a, at_b, tau
      integer :: side, turn

      a = self%left(i)
      b = self%right(i)
      at_a = self%at_left(i)
      at_b = self%at_right(i)
      side = 0
      do turn = 1, most_turns
         if (.not. abs(at_a) > 0) b = a
         if (b - a <= tie) exit
         tau = b - at_b*((b - a)/(at_b - at_a))
         if (tau <= a + tie/4) tau = a + tie/2 ! a step past the end of the bracket closes it
         if (tau >= b - tie/4) tau = b - tie/2
         call values_at(self, model, step, y, z, tau, status, i)
         if (has_failed(status)) return
         if (self%value(i)*self%change(i) >= 0) then
            b = tau
            at_b = self%value(i)
            if (.not. abs(at_b) > 0) exit
            if (side == 1) at_a = at_a/2
            side = 1
         else
            a = tau
            at_a = self%value(i)
            if (side == -1) at_b = at_b/2
            side = -1
         end if
      end do
      self%tau(i) = b
   end subroutine locate

   !> Evaluate the root functions at one time of a step.
   subroutine values_at(self, model, step, y, z, tau, status, only)
      type(root_finder_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      type(step_state), intent(in) :: step
      real(wp), intent(in) :: y(:), z(:, :)
      real(wp), intent(in) :: tau
      type(status_t), intent(inout) :: status
      integer, intent(in), optional :: only !! index of the requested function

      call go_to(self, model, y, z, tau, only)
      call model%roots(step%t + tau*step%h, self%y, self%value, status, only)
   end subroutine values_at

   !> Set the state at one time of a step for root functions, or only the components that one of them needs.
   pure subroutine go_to(self, model, y, z, tau, only)
      type(root_finder_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      real(wp), intent(in) :: y(:), z(:, :)
      real(wp), intent(in) :: tau
      integer, intent(in), optional :: only
      real(wp) :: basis(lanes)
      integer :: i, k
      logical :: needs_all

      call lagrange_at(tau, basis)
      self%evaluations = self%evaluations + 1
      needs_all = .not. (present(only) .and. allocated(model%root_states))
      if (needs_all) then
         do i = 1, size(y)
            self%y(i) = y(i) + weighted_sum(basis, z(:, i))
         end do
      else
         do k = model%root_first(only), model%root_last(only)
            i = model%root_states(k)
            self%y(i) = y(i) + weighted_sum(basis, z(:, i))
         end do
      end if
   end subroutine go_to

end module evl_root_finder
