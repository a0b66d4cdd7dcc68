!> Systems of which orbits are known: their equations, events, and how these change with the state.
module orbit_systems
   use evl_kinds, only: lanes, pi, wp
   use evl_ode_model, only: never
   use evl_orbit_model, only: orbit_model
   use evl_status, only: code_invalid_input, fail, status_t
   implicit none (type, external)
   private

   public :: orbit_system, orbit_system_create

   integer, parameter, public :: meissner = 1, duffing = 2, backlash = 3, ball = 4, remembering_stop = 5, van_der_pol = 6, &
                                 duffing_with_phase = 7, moving_focus = 8, moving_fold = 9, stop = 10, parting = 11, &
                                 floating = 12, alternating = 13, switched = 14, one_sided = 15
   integer, parameter :: n_states(15) = [2, 2, 2, 3, 3, 2, 3, 2, 1, 2, 2, 3, 2, 2, 2]
   integer, parameter :: n_roots(15) = [0, 0, 2, 1, 1, 0, 0, 0, 0, 1, 2, 1, 0, 1, 2]

   integer, parameter :: open = 0, loaded = 1, would_pull = 2

   !> What each takes in p, the first being the frequency of what drives, but of the autonomous ones:
   !>
   !> meissner    W, contact ratio, damping ratio, force:  x'' = F - k(t) (x + 2 z x'), k = 2 and then 1
   !> parting     the same where x > 0 and x + 2 z x' > 0, else x'' = F: a contact never pulls
   !> duffing     W, d, a, b, c:    x'' = c cos Wt - d x' - a x - b x^3;  duffing_with_phase: Wt is a state
   !> backlash    W, z, m, c:       x'' = m + c cos Wt - 2 z x' - x + min(max(x, -1), 1)
   !> ball        W, e, s, a, g:    y'' = -g over a table a sin Wt; approach w: v+ = u + (e + s w_before) w, w_before a memory
   !> remembering_stop W, z, m, c, s: x'' = m + c cos Wt - 2 z x' - x (1 + s x'/v0) where x > 0, v0 the speed at first touch
   !> floating    the same, and v0 is set nowhere
   !> van_der_pol m:                x'' = m (1 - x^2) x' - x
   !> moving_focus W, l, w, a:      z' = (l + iw - |z|^2) z around the moving centre a cos Wt
   !> alternating the same, with a mode that changes in the middle of each period and matters to nothing
   !> moving_fold W, l, a:          z' = l - z^2 around it
   !> stop        W, z, c, d, k:    x'' = c cos Wt - 2 z x' - x - k max(x - d, 0)
   !> switched    W, z, c, d, f:    x'' = c cos Wt - 2 z x' - x, less f where x > d
   !> one_sided   W, z, c, d, k, b: the same, less k (x - d) + b x' where x > d and that is positive
   type, extends(orbit_model) :: orbit_system
      integer :: kind = 0
      integer :: varied = 1          !! which of p is the parameter
      real(wp), allocatable :: p(:)
   contains
      procedure :: rhs
      procedure :: rhs_lanes
      procedure :: jacobian
      procedure :: roots
      procedure :: roots_lanes
      procedure :: root_directions
      procedure :: resolved_time
      procedure :: set_parameter
      procedure :: settle
      procedure :: root_gradient
      procedure :: apply_event
      procedure :: next_time_event
   end type orbit_system

contains

   subroutine orbit_system_create(self, kind, p, varied)
      type(orbit_system), intent(out) :: self
      integer, intent(in) :: kind, varied
      real(wp), intent(in) :: p(:)
      integer :: i, j

      self%kind = kind
      self%varied = varied
      self%p = p
      self%n = n_states(kind)
      self%n_roots = n_roots(kind)
      self%jacobian_row = [((i, i=1, self%n), j=1, self%n)]
      self%jacobian_column = [((j, i=1, self%n), j=1, self%n)]
      allocate (self%scale(self%n), source=1.0_wp)
      allocate (self%modes(2), source=0)
      self%autonomous = kind == van_der_pol .or. kind == duffing_with_phase
      if (kind == duffing_with_phase) self%advance = [0.0_wp, 0.0_wp, 2*pi]
      if (.not. self%autonomous) self%period = 2*pi/p(1)
   end subroutine orbit_system_create

   subroutine set_parameter(self, value, status)
      class(orbit_system), intent(inout) :: self
      real(wp), intent(in) :: value
      type(status_t), intent(inout) :: status

      self%p(self%varied) = value
      if (self%autonomous) return
      if (.not. self%p(1) > 0) call fail(status, code_invalid_input, "no frequency")
      self%period = 2*pi/self%p(1)
      ! the section lies in the middle of the time with one pair, which begins at 0
      if (self%kind == meissner .or. self%kind == parting) self%phase = self%period*(1 - self%p(2)/2)
      if (self%kind == switched .or. self%kind == one_sided) self%phase = self%period/4 ! away from where x is largest
   end subroutine set_parameter

   !> modes(1): pairs, or the contact; modes(2): where flanks part, what the contact does.
   subroutine settle(self, t, y, status)
      class(orbit_system), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(self%n)
      type(status_t), intent(inout) :: status

      self%modes = 0
      select case (self%kind)
      case (meissner)
         self%modes(1) = 1
      case (parting)
         self%modes = [1, open]
         if (y(1) > 0) self%modes(2) = merge(loaded, would_pull, y(1) + 2*self%p(3)*y(2) > 0)
      case (backlash)
         if (abs(y(1)) > 1) self%modes(1) = nint(sign(1.0_wp, y(1)))
      case (remembering_stop, floating)
         if (y(1) > 0) self%modes(1) = 1
      case (stop, switched)
         if (y(1) > self%p(4)) self%modes(1) = 1
      case (one_sided)
         if (y(1) > self%p(4)) self%modes(2) = merge(loaded, would_pull, push_of(self, y) > 0)
      end select
   end subroutine settle

   subroutine rhs(self, t, y, f, status)
      class(orbit_system), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: f(self%n)
      type(status_t), intent(inout) :: status
      real(wp) :: z(2)

      f(1) = 0
      if (self%n > 1) f(1) = y(2)
      if (self%n > 2) f(3) = 0
      associate (p => self%p, m => self%modes(1))
         select case (self%kind)
         case (meissner)
            f(2) = p(4) - m*(y(1) + 2*p(3)*y(2))
         case (parting)
            f(2) = p(4)
            if (self%modes(2) == loaded) f(2) = f(2) - m*(y(1) + 2*p(3)*y(2))
         case (duffing)
            f(2) = p(5)*cos(p(1)*t) - p(2)*y(2) - p(3)*y(1) - p(4)*y(1)**3
         case (duffing_with_phase)
            f(2) = p(5)*cos(y(3)) - p(2)*y(2) - p(3)*y(1) - p(4)*y(1)**3
            f(3) = p(1)
         case (backlash)
            f(2) = p(3) + p(4)*cos(p(1)*t) - 2*p(2)*y(2) - abs(m)*(y(1) - m)
         case (ball)
            f(2) = -p(5)
         case (remembering_stop, floating)
            f(2) = p(3) + p(4)*cos(p(1)*t) - 2*p(2)*y(2)
            if (m == 1) f(2) = f(2) - y(1)*(1 + p(5)*y(2)/y(3))
         case (van_der_pol)
            f(2) = p(1)*(1 - y(1)**2)*y(2) - y(1)
         case (moving_focus, alternating)
            z = [y(1) - p(4)*cos(p(1)*t), y(2)]
            f(1) = -p(4)*p(1)*sin(p(1)*t) + (p(2) - sum(z**2))*z(1) - p(3)*z(2)
            f(2) = (p(2) - sum(z**2))*z(2) + p(3)*z(1)
         case (moving_fold)
            f(1) = -p(3)*p(1)*sin(p(1)*t) + p(2) - (y(1) - p(3)*cos(p(1)*t))**2
         case (stop)
            f(2) = p(3)*cos(p(1)*t) - 2*p(2)*y(2) - y(1) - m*p(5)*(y(1) - p(4))
         case (switched)
            f(2) = p(3)*cos(p(1)*t) - 2*p(2)*y(2) - y(1) - m*p(5)
         case (one_sided)
            f(2) = p(3)*cos(p(1)*t) - 2*p(2)*y(2) - y(1)
            if (self%modes(2) == loaded) f(2) = f(2) - push_of(self, y)
         end select
      end associate
   end subroutine rhs

   !> What a one-sided stop does where it touches.
   pure real(wp) function push_of(self, y) result(push)
      class(orbit_system), intent(in) :: self
      real(wp), intent(in) :: y(:)

      push = self%p(5)*(y(1) - self%p(4)) + self%p(6)*y(2)
   end function push_of

   subroutine rhs_lanes(self, t, y, f, status)
      class(orbit_system), intent(inout) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      real(wp), intent(out) :: f(lanes, self%n)
      type(status_t), intent(inout) :: status
      real(wp) :: state(self%n), rate(self%n)
      integer :: k

      do k = 1, lanes
         state = y(k, :)
         call self%rhs(t(k), state, rate, status)
         f(k, :) = rate
      end do
   end subroutine rhs_lanes

   !> By columns.
   subroutine jacobian(self, t, y, values, status)
      class(orbit_system), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: values(:)
      type(status_t), intent(inout) :: status
      real(wp) :: j(self%n, self%n), z(2)

      j = 0
      if (self%n > 1) j(1, 2) = 1
      associate (p => self%p, m => self%modes(1))
         select case (self%kind)
         case (meissner)
            j(2, 1:2) = -m*[1.0_wp, 2*p(3)]
         case (parting)
            if (self%modes(2) == loaded) j(2, 1:2) = -m*[1.0_wp, 2*p(3)]
         case (duffing, duffing_with_phase)
            j(2, 1:2) = [-p(3) - 3*p(4)*y(1)**2, -p(2)]
            if (self%n > 2) j(2, 3) = -p(5)*sin(y(3))
         case (backlash)
            j(2, :) = [-real(abs(m), wp), -2*p(2)]
         case (remembering_stop, floating)
            j(2, 2) = -2*p(2)
            if (m == 1) j(2, :) = j(2, :) - [1 + p(5)*y(2)/y(3), y(1)*p(5)/y(3), -y(1)*p(5)*y(2)/y(3)**2]
         case (van_der_pol)
            j(2, :) = [-2*p(1)*y(1)*y(2) - 1, p(1)*(1 - y(1)**2)]
         case (moving_focus, alternating)
            z = [y(1) - p(4)*cos(p(1)*t), y(2)]
            j(1, :) = [p(2) - sum(z**2) - 2*z(1)**2, -p(3) - 2*z(1)*z(2)]
            j(2, :) = [p(3) - 2*z(1)*z(2), p(2) - sum(z**2) - 2*z(2)**2]
         case (moving_fold)
            j(1, 1) = -2*(y(1) - p(3)*cos(p(1)*t))
         case (stop)
            j(2, :) = [-1 - m*p(5), -2*p(2)]
         case (switched)
            j(2, :) = [-1.0_wp, -2*p(2)]
         case (one_sided)
            j(2, :) = [-1.0_wp, -2*p(2)]
            if (self%modes(2) == loaded) j(2, :) = j(2, :) - p(5:6)
         end select
      end associate
      values = reshape(j, [size(values)])
   end subroutine jacobian

   subroutine roots(self, t, y, values, status, only)
      class(orbit_system), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(inout) :: values(self%n_roots)
      type(status_t), intent(inout) :: status
      integer, intent(in), optional :: only

      select case (self%kind)
      case (backlash)
         values = [y(1) - 1, y(1) + 1]
      case (ball)
         values = y(1) - self%p(4)*sin(self%p(1)*t)
      case (remembering_stop, floating)
         values = y(1)
      case (parting)
         values = [y(1), y(1) + 2*self%p(3)*y(2)]
      case (stop, switched)
         values = y(1) - self%p(4)
      case (one_sided)
         values = [y(1) - self%p(4), push_of(self, y)]
      end select
   end subroutine roots

   subroutine roots_lanes(self, t, y, exact, values, status)
      class(orbit_system), intent(inout) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      logical, intent(inout) :: exact
      real(wp), intent(inout) :: values(lanes, self%n_roots)
      type(status_t), intent(inout) :: status
      real(wp) :: state(self%n), here(self%n_roots)
      integer :: k

      exact = .true.
      do k = 1, lanes
         state = y(k, :)
         call self%roots(t(k), state, here, status)
         values(k, :) = here
      end do
   end subroutine roots_lanes

   !> A step sees what drives.
   pure real(wp) function resolved_time(self, t) result(longest)
      class(orbit_system), intent(in) :: self
      real(wp), intent(in) :: t

      longest = huge(t)
      if (.not. self%autonomous) longest = self%period
   end function resolved_time

   subroutine root_directions(self, directions)
      class(orbit_system), intent(in) :: self
      integer, intent(out) :: directions(self%n_roots)

      select case (self%kind)
      case (backlash)
         directions = [1, -1]
         if (self%modes(1) == 1) directions = [-1, never]
         if (self%modes(1) == -1) directions = [never, 1]
      case (ball)
         directions = -1
      case (remembering_stop, floating, stop, switched)
         directions = 1 - 2*self%modes(1)
      case (parting, one_sided)
         directions = [1, never]
         if (self%modes(2) == loaded) directions = [never, -1]
         if (self%modes(2) == would_pull) directions = [-1, 1]
      end select
   end subroutine root_directions

   subroutine root_gradient(self, t, y, root, by_state, by_time, status)
      class(orbit_system), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      integer, intent(in) :: root
      real(wp), intent(out) :: by_state(self%n)
      real(wp), intent(out) :: by_time
      type(status_t), intent(inout) :: status

      by_state = 0
      by_state(1) = 1
      by_time = 0
      if (self%kind == parting .and. root == 2) by_state(2) = 2*self%p(3)
      if (self%kind == one_sided .and. root == 2) by_state = self%p(5:6)
      if (self%kind == ball) by_time = -self%p(4)*self%p(1)*cos(self%p(1)*t)
   end subroutine root_gradient

   subroutine apply_event(self, t, fired, time_event, y, by_state, by_time, status)
      class(orbit_system), intent(inout) :: self
      real(wp), intent(in) :: t
      integer, intent(in) :: fired(self%n_roots)
      logical, intent(in) :: time_event
      real(wp), intent(inout) :: y(self%n)
      real(wp), intent(out) :: by_state(self%n, self%n)
      real(wp), intent(out) :: by_time(self%n)
      type(status_t), intent(inout) :: status
      real(wp) :: approach, factor, table, table_rate
      integer :: i

      by_state = 0
      by_time = 0
      do i = 1, self%n
         by_state(i, i) = 1
      end do
      if (time_event) self%modes(1) = merge(1, 3, self%kind == alternating) - self%modes(1)
      if (all(fired == 0)) return
      select case (self%kind)
      case (backlash)
         self%modes(1) = sum(merge(fired, 0, self%modes(1) == 0))
      case (remembering_stop, floating)
         self%modes(1) = 1 - self%modes(1)
         if (self%modes(1) == 1 .and. self%kind == remembering_stop) then
            y(3) = y(2)
            by_state(3, :) = [0, 1, 0]
         end if
      case (stop, switched)
         self%modes(1) = 1 - self%modes(1)
      case (parting, one_sided)
         self%modes(2) = loaded
         if (any(fired == -1)) self%modes(2) = merge(would_pull, open, fired(2) == -1)
      case (ball)
         table = self%p(4)*self%p(1)*cos(self%p(1)*t)
         table_rate = -self%p(4)*self%p(1)**2*sin(self%p(1)*t)
         approach = table - y(2)
         factor = self%p(2) + self%p(3)*y(3)
         by_state(2, :) = [0.0_wp, -factor, self%p(3)*approach]
         by_state(3, :) = [0, -1, 0]
         by_time = [0.0_wp, (1 + factor)*table_rate, table_rate]
         y(2) = table + factor*approach
         y(3) = approach
      end select
   end subroutine apply_event

   !> Pairs come in where a pitch begins, and go when the contact ratio less 1 of it is over; at time 0 one pair begins alone.
   pure real(wp) function next_time_event(self, t) result(time)
      class(orbit_system), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp) :: alone, pitches

      time = huge(time)
      if (self%kind == alternating) then
         associate (odd => self%modes(1))
            time = (odd + 2*nint((t/self%period - odd)/2) + 0.5_wp)*self%period
         end associate
      end if
      if (self%kind /= meissner .and. self%kind /= parting) return
      alone = 2 - self%p(2)
      pitches = t/self%period
      if (self%modes(1) == 1) then ! halfway through the other time the next pitch counts: rounding does not matter
         time = (floor(pitches + (1 - alone)/2) + alone)*self%period
      else
         time = (floor(pitches - alone/2) + 1)*self%period
      end if
   end function next_time_event

end module orbit_systems
