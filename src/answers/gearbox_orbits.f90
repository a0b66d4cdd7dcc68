!> A gearbox as a system whose periodic orbits are sought: `gearbox_ode` with what a period brings back, what events change and how
!> they change with the state. docs/orbits.md.
!>
!> States: those of the gearbox, then for each tooth contact whose damping remembers it the approach speed at the last closing. Where
!> a speed is prescribed theta and omega are functions of time and need not repeat; energies never do.
!>
!> How root functions and approach speeds change with the state is a difference of fourth order over a thousandth of the scales:
!> they are smooth there, and exact to 1e-9. Residuals do not contain them.
module evl_gearbox_orbits
   use evl_carried_state, only: take_back, take_over
   use evl_common_period, only: common_period, period_t
   use evl_contacts_at_state, only: look_at
   use evl_discrete_state, only: take_mode
   use evl_event_log, only: event_log
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_gearbox_events, only: gearbox_apply_event, gearbox_root
   use evl_gearbox_ode, only: gearbox_ode, gearbox_ode_create, gearbox_ode_serves, gearbox_ode_set
   use evl_gearbox_rates, only: gearbox_rates
   use evl_kinds, only: lanes, pi, wp
   use evl_local_variables, only: i_omega, i_theta
   use evl_orbit_model, only: orbit_model
   use evl_root_kinds, only: root_rows
   use evl_status, only: code_invalid_input, fail, has_failed, status_t, subject_load
   use evl_tooth_contact, only: contact_mode, contact_state, touches
   implicit none (type, external)
   private

   public :: gearbox_family, gearbox_orbits, gearbox_orbits_create, gearbox_orbits_state, gearbox_orbits_start, root_place

   real(wp), parameter :: weight = 2             !! all states count a little more, as in gearbox_ode
   real(wp), parameter :: step = 1.0e-3_wp       !! of differences, over the scales
   integer, parameter :: per_contact = 4         !! modes that belong to what must repeat

   !> Gearboxes that differ in one number.
   type, abstract :: gearbox_family
   contains
      procedure(take_interface), deferred :: take
   end type gearbox_family

   abstract interface
      !> The gearbox with a value of the parameter. It lives until the next call.
      subroutine take_interface(self, value, gearbox, scale, status)
         import :: gearbox_family, gearbox_t, status_t, wp
         implicit none (type, external)
         class(gearbox_family), intent(inout) :: self
         real(wp), intent(in) :: value
         type(gearbox_t), pointer, intent(out) :: gearbox
         real(wp), allocatable, intent(out) :: scale(:) !! [n_states] as from gearbox_state_scales
         type(status_t), intent(inout) :: status !! touched on failure only: there is no such gearbox
      end subroutine take_interface
   end interface

   type, extends(orbit_model) :: gearbox_orbits
      class(gearbox_family), pointer, private :: family => null()
      type(gearbox_t), pointer :: gearbox => null() !! of the last value
      type(period_t) :: common
      real(wp), private :: value = 0, place = 0     !! of the parameter; of the section [pitches of the first mesh]
      logical, private :: is_made = .false., is_current = .false. !! whether there is a gearbox, and that of `value`
      type(gearbox_ode), private :: ode
      integer, private :: n_gears = 0               !! states of the gearbox
      integer, allocatable, private :: memory(:)    !! tooth contacts whose approach speeds are states
      integer, allocatable, private :: integers(:)  !! discrete state
      real(wp), allocatable, private :: reals(:)
   contains
      procedure :: rhs
      procedure :: rhs_lanes
      procedure :: jacobian
      procedure :: roots
      procedure :: roots_lanes
      procedure :: root_directions
      procedure :: time_in_sight
      procedure :: set_parameter
      procedure :: settle
      procedure :: root_gradient
      procedure :: apply_event
      procedure :: come_back
   end type gearbox_orbits

contains

   !> Make it for the gearbox with a first value, which gives all scales.
   subroutine gearbox_orbits_create(self, family, value, place, status)
      type(gearbox_orbits), intent(out) :: self
      class(gearbox_family), intent(inout), target :: family !! has to outlive it
      real(wp), intent(in) :: value
      real(wp), intent(in) :: place !! of the section, where a speed is prescribed [pitches of the first mesh after t = 0]
      type(status_t), intent(inout) :: status

      self%family => family
      self%place = place
      call self%set_parameter(value, status)
   end subroutine gearbox_orbits_create

   !> The gearbox with a value.
   subroutine set_parameter(self, value, status)
      class(gearbox_orbits), intent(inout) :: self
      real(wp), intent(in) :: value
      type(status_t), intent(inout) :: status
      type(gearbox_t), pointer :: gearbox
      type(period_t) :: common
      real(wp), allocatable :: scale(:)

      if (self%is_current .and. .not. abs(value - self%value) > 0) return
      self%is_current = .false.
      call self%family%take(value, gearbox, scale, status)
      if (.not. has_failed(status)) call gearbox_ode_serves(gearbox, status)
      if (.not. has_failed(status)) call common_period(gearbox, common, status)
      if (.not. has_failed(status)) call check_speeds(gearbox, status)
      if (has_failed(status)) return
      if (.not. self%is_made) then
         call begin(self, gearbox, common, scale)
      else if (gearbox%n_states /= self%n_gears .or. size(gearbox%contacts) /= size(self%reals) &
               .or. gearbox%n_roots /= self%n_roots .or. gearbox%n_integers /= size(self%integers) &
               .or. common%pitches /= self%common%pitches .or. (common%by_time .neqv. self%common%by_time)) then
         call fail(status, code_invalid_input, "with this value the gearbox has other states, other tooth pairs or another" &
                   //" common period: no orbit can be followed to it")
         return
      end if
      self%gearbox => gearbox
      self%common = common
      self%value = value
      self%period = common%time
      self%phase = 0
      if (common%by_time) self%phase = self%place*common%time/common%pitches
      call gearbox_ode_create(self%ode, gearbox, scale)
      self%is_made = .true.
      self%is_current = .true.
   end subroutine set_parameter

   !> A prescribed speed has to be that of the reference wheel: then all angles but theta are free.
   pure subroutine check_speeds(gearbox, status)
      type(gearbox_t), intent(in) :: gearbox
      type(status_t), intent(inout) :: status
      integer :: i

      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i)%load)
            if (.not. load%prescribes) cycle
            if (gearbox%wheels(load%wheel)%i_psi > 0) call fail(status, code_invalid_input, "orbits are found where the" &
                  //" speed of the first wheel, or of one on its shaft, is prescribed: name the wheels in another order, or leave" &
                                                                //" the method out", subject_load, i, "kind")
         end associate
         if (has_failed(status)) return
      end do
   end subroutine check_speeds

   !> What stays the same for all values.
   subroutine begin(self, gearbox, common, scale)
      class(gearbox_orbits), intent(inout) :: self
      type(gearbox_t), intent(in), target :: gearbox
      type(period_t), intent(in) :: common
      real(wp), intent(in) :: scale(:)
      type(gearbox_ode) :: ode
      integer, allocatable :: column(:)
      integer :: i, k

      self%autonomous = .not. common%by_time
      self%n_gears = gearbox%n_states
      self%memory = pack([(i, i=1, size(gearbox%contacts))], remembering(gearbox))
      self%n = self%n_gears + size(self%memory)
      self%n_roots = gearbox%n_roots
      call gearbox_ode_create(ode, gearbox, scale)
      self%growth = ode%growth
      allocate (self%scale(self%n), self%reach(self%n), self%repeats(self%n))
      self%scale(:self%n_gears) = scale/weight
      self%reach = huge(1.0_wp)
      self%reach(:self%n_gears) = ode%reach
      self%repeats = .true.
      self%repeats([gearbox%i_dissipated, gearbox%i_work]) = .false.
      if (common%by_time) self%repeats([i_theta, i_omega]) = .false.
      self%root_first = ode%root_first
      self%root_last = ode%root_last
      self%root_states = ode%root_states
      self%jacobian_row = ode%jacobian_row
      self%jacobian_column = ode%jacobian_column
      do k = 1, size(self%memory)
         self%scale(self%n_gears + k) = gearbox%contacts(self%memory(k))%rate_scale
         allocate (column(self%n_gears), source=self%n_gears + k)
         self%jacobian_row = [self%jacobian_row, [(i, i=1, self%n_gears)]]
         self%jacobian_column = [self%jacobian_column, column]
         deallocate (column)
      end do
      allocate (self%integers(gearbox%n_integers), source=0)
      allocate (self%reals(size(gearbox%contacts)), source=0.0_wp)
      allocate (self%modes(per_contact*size(gearbox%contacts)), source=0)
   end subroutine begin

   !> Tooth contacts whose damping knows the approach speed at the last closing.
   pure function remembering(gearbox)
      type(gearbox_t), intent(in) :: gearbox
      logical :: remembering(size(gearbox%contacts))
      integer :: m

      do m = 1, size(gearbox%contacts)
         remembering(m) = gearbox%contacts(m)%damping%remembers()
      end do
   end function remembering

   !> A state of the gearbox on the section, or what is near one, as one of this system.
   pure subroutine gearbox_orbits_start(self, y_gears, turns, reals, y)
      type(gearbox_orbits), intent(in) :: self
      real(wp), intent(in) :: y_gears(:), reals(:)
      integer, intent(in) :: turns     !! of the reference wheel
      real(wp), intent(out) :: y(self%n)
      integer :: k

      y(:self%n_gears) = y_gears
      y(i_theta) = y(i_theta) + 2*pi*turns
      y([self%gearbox%i_dissipated, self%gearbox%i_work]) = 0
      do k = 1, size(self%memory)
         y(self%n_gears + k) = reals(self%memory(k))
      end do
   end subroutine gearbox_orbits_start

   !> The other way round, with the modes that belong to it and the present value of the parameter.
   subroutine gearbox_orbits_state(self, y, y_gears, integers, reals, status)
      type(gearbox_orbits), intent(inout) :: self
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: y_gears(:), reals(:)
      integer, intent(out) :: integers(:)
      type(status_t), intent(inout) :: status
      real(wp) :: settled(self%n)

      settled = y
      y_gears = 0
      integers = 0
      reals = 0
      call self%settle(self%phase, settled, status)
      if (has_failed(status)) return
      y_gears = settled(:self%n_gears)
      integers = self%integers
      reals = self%reals
   end subroutine gearbox_orbits_state

   !> Put the discrete state where it is used.
   subroutine take_modes(self)
      type(gearbox_orbits), intent(inout) :: self
      type(contact_mode) :: mode
      integer :: m

      call gearbox_ode_set(self%ode, self%integers, self%reals)
      do m = 1, size(self%reals)
         call take_mode(self%gearbox, m, self%integers, self%reals, mode)
         associate (modes => self%modes(per_contact*(m - 1) + 1:per_contact*m))
            modes = [mode%tooth_pair, mode%flanks, mode%zone_a, mode%zone_b]
            if (.not. touches(mode)) modes(3:) = 0 ! they mean nothing
         end associate
      end do
   end subroutine take_modes

   !> The modes of a state on the section.
   subroutine settle(self, t, y, status)
      class(gearbox_orbits), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(self%n)
      type(status_t), intent(inout) :: status
      type(contact_mode) :: mode
      type(event_log) :: log
      integer :: nothing(self%n_roots), k
      real(wp) :: yp(self%n_gears)

      self%integers = 0
      self%reals = 0
      call take_over(self%gearbox, .false., t, y(:self%n_gears), yp, self%integers, self%reals, status)
      if (has_failed(status)) return
      self%reals = 0
      do k = 1, size(self%memory)
         call take_mode(self%gearbox, self%memory(k), self%integers, self%reals, mode)
         if (.not. touches(mode)) y(self%n_gears + k) = 0
         self%reals(self%memory(k)) = y(self%n_gears + k)
      end do
      nothing = 0
      if (size(self%memory) > 0) & ! whether flanks pull depends on it
         call gearbox_apply_event(self%gearbox, t, nothing, .false., y(:self%n_gears), yp, self%integers, self%reals, log, status)
      if (.not. has_failed(status)) call take_modes(self)
   end subroutine settle

   !> Tooth pairs that are as many pitches further take the names of those where the motion began.
   subroutine come_back(self, periods, y, derivative)
      class(gearbox_orbits), intent(inout) :: self
      integer, intent(in) :: periods
      real(wp), intent(inout) :: y(self%n)
      real(wp), intent(inout) :: derivative(self%n, self%n)
      real(wp) :: from(size(self%reals)), before(self%n), rows(self%n, self%n), scrap(self%n_gears)
      integer :: moved(size(self%integers)), k, old
      type(contact_mode) :: mode

      from = [(real(k, wp), k=1, size(from))]
      moved = self%integers
      scrap = y(:self%n_gears)
      call take_back(self%gearbox, self%common, periods, scrap, moved, from) ! where each contact's memory comes from
      before = y
      rows = derivative
      y(:self%n_gears) = scrap
      y(i_theta) = y(i_theta) + 2*pi*moved(i_turns)
      moved(i_turns) = 0
      self%integers = moved
      self%reals = 0
      do k = 1, size(self%memory)
         old = findloc(self%memory, nint(from(self%memory(k))), 1)
         call take_mode(self%gearbox, self%memory(k), self%integers, self%reals, mode)
         y(self%n_gears + k) = merge(before(self%n_gears + old), 0.0_wp, touches(mode))
         derivative(self%n_gears + k, :) = 0
         if (touches(mode)) derivative(self%n_gears + k, :) = rows(self%n_gears + old, :)
         self%reals(self%memory(k)) = y(self%n_gears + k)
      end do
      call take_modes(self)
   end subroutine come_back

   !> f(t, y): a memory rests.
   subroutine rhs(self, t, y, f, status)
      class(gearbox_orbits), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: f(self%n)
      type(status_t), intent(inout) :: status

      f(self%n_gears + 1:) = 0
      call self%ode%rhs(t, y(:self%n_gears), f(:self%n_gears), status)
   end subroutine rhs

   !> f of eight states.
   subroutine rhs_lanes(self, t, y, f, status)
      class(gearbox_orbits), intent(inout) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      real(wp), intent(out) :: f(lanes, self%n)
      type(status_t), intent(inout) :: status

      f(:, self%n_gears + 1:) = 0
      call self%ode%rhs_lanes(t, y(:, :self%n_gears), f(:, :self%n_gears), status)
   end subroutine rhs_lanes

   !> df/dy; with a memory f changes where its contact touches.
   subroutine jacobian(self, t, y, values, status)
      class(gearbox_orbits), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: values(:)
      type(status_t), intent(inout) :: status
      integer :: k, first

      first = size(values) - size(self%memory)*self%n_gears
      call self%ode%jacobian(t, y(:self%n_gears), values(:first), status)
      do k = 1, size(self%memory)
         if (has_failed(status)) return
         call by_memory(self, self%memory(k), t, y(:self%n_gears), values(first + 1:first + self%n_gears), status)
         first = first + self%n_gears
      end do
   end subroutine jacobian

   !> How f changes with an approach speed.
   subroutine by_memory(self, m, t, y, slope, status)
      type(gearbox_orbits), intent(in) :: self
      integer, intent(in) :: m
      real(wp), intent(in) :: t, y(self%n_gears)
      real(wp), intent(out) :: slope(self%n_gears)
      type(status_t), intent(inout) :: status
      real(wp) :: reals(size(self%reals)), f(self%n_gears, -2:2)
      type(contact_mode) :: mode
      integer :: k

      slope = 0
      call take_mode(self%gearbox, m, self%integers, self%reals, mode)
      if (.not. touches(mode) .or. .not. self%reals(m) > 0) return
      reals = self%reals
      do k = -2, 2
         reals(m) = self%reals(m)*(1 + k*step)
         call gearbox_rates(self%gearbox, t, y, self%integers, reals, f(:, k), status)
         if (has_failed(status)) return
      end do
      slope = (8*(f(:, 1) - f(:, -1)) - (f(:, 2) - f(:, -2)))/(12*step*self%reals(m))
   end subroutine by_memory

   !> Root functions.
   subroutine roots(self, t, y, values, status, only)
      class(gearbox_orbits), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(inout) :: values(self%n_roots)
      type(status_t), intent(inout) :: status
      integer, intent(in), optional :: only

      call self%ode%roots(t, y(:self%n_gears), values, status, only)
   end subroutine roots

   !> Root functions of eight states.
   subroutine roots_lanes(self, t, y, exact, values, status)
      class(gearbox_orbits), intent(inout) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      logical, intent(inout) :: exact
      real(wp), intent(inout) :: values(lanes, self%n_roots)
      type(status_t), intent(inout) :: status

      call self%ode%roots_lanes(t, y(:, :self%n_gears), exact, values, status)
   end subroutine roots_lanes

   !> Which crossings count.
   subroutine root_directions(self, directions)
      class(gearbox_orbits), intent(in) :: self
      integer, intent(out) :: directions(self%n_roots)

      call self%ode%root_directions(directions)
   end subroutine root_directions

   !> As of the gearbox.
   pure real(wp) function time_in_sight(self, t) result(longest)
      class(gearbox_orbits), intent(in) :: self
      real(wp), intent(in) :: t

      longest = self%ode%time_in_sight(t)
   end function time_in_sight

   !> How a root function changes with the states it depends on; none depends on time alone.
   subroutine root_gradient(self, t, y, root, by_state, by_time, status)
      class(gearbox_orbits), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      integer, intent(in) :: root
      real(wp), intent(out) :: by_state(self%n), by_time
      type(status_t), intent(inout) :: status
      real(wp) :: roots(self%n_roots), moved(self%n_gears), values(-2:2)
      integer :: i, k

      by_state = 0
      by_time = 0
      do i = self%root_first(root), self%root_last(root)
         associate (state => self%root_states(i))
            do k = -2, 2
               moved = y(:self%n_gears)
               moved(state) = moved(state) + k*step*self%scale(state)
               call gearbox_root(self%gearbox, root, moved, self%integers, self%reals, roots, status)
               if (has_failed(status)) return
               values(k) = roots(root)
            end do
            by_state(state) = slope_of(values)/(step*self%scale(state))
         end associate
      end do
   end subroutine root_gradient

   !> Slope in the middle of five values, by their number.
   pure real(wp) function slope_of(values) result(slope)
      real(wp), intent(in) :: values(-2:2)

      slope = (8*(values(1) - values(-1)) - (values(2) - values(-2)))/12
   end function slope_of

   !> What an event changes: modes, and the approach speeds of what closes or leaves.
   subroutine apply_event(self, t, fired, time_event, y, by_state, by_time, status)
      class(gearbox_orbits), intent(inout) :: self
      real(wp), intent(in) :: t
      integer, intent(in) :: fired(self%n_roots)
      logical, intent(in) :: time_event
      real(wp), intent(inout) :: y(self%n)
      real(wp), intent(out) :: by_state(self%n, self%n), by_time(self%n)
      type(status_t), intent(inout) :: status
      real(wp) :: before(size(self%reals)), yp(self%n_gears)
      type(event_log) :: log
      type(contact_mode) :: mode
      integer :: i, k

      by_time = 0
      by_state = 0
      do i = 1, self%n
         by_state(i, i) = 1
      end do
      before = self%reals
      call gearbox_apply_event(self%gearbox, t, fired, time_event, y(:self%n_gears), yp, self%integers, self%reals, log, status)
      if (has_failed(status)) return
      do k = 1, size(self%memory)
         associate (m => self%memory(k), row => self%n_gears + k)
            call take_mode(self%gearbox, m, self%integers, self%reals, mode)
            y(row) = self%reals(m)
            if (touches(mode) .and. .not. abs(self%reals(m) - before(m)) > 0) cycle
            by_state(row, :) = 0
            if (touches(mode) .and. self%reals(m) > 0) call approach_gradient(self, m, y, by_state(row, :self%n_gears), status)
         end associate
         if (has_failed(status)) return
      end do
      call take_modes(self)
   end subroutine apply_event

   !> How the speed at which a contact closes changes with the state.
   subroutine approach_gradient(self, m, y, gradient, status)
      type(gearbox_orbits), intent(in) :: self
      integer, intent(in) :: m
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: gradient(self%n_gears)
      type(status_t), intent(inout) :: status
      type(contact_state) :: at(size(self%reals))
      real(wp) :: moved(self%n_gears), values(-2:2)
      integer :: first, i, k, last

      gradient = 0
      call self%gearbox%flanks(self%gearbox%contacts(m)%i_flank)%flank%company(m, first, last)
      do i = 1, self%n_gears
         do k = -2, 2
            moved = y(:self%n_gears)
            moved(i) = moved(i) + k*step*self%scale(i)
            call look_at(self%gearbox, first, last, moved, self%integers, self%reals, at, status)
            if (has_failed(status)) return
            values(k) = at(m)%point%h_dot
         end do
         gradient(i) = slope_of(values)/(step*self%scale(i))
      end do
   end subroutine approach_gradient

   !> To what a root function belongs.
   pure subroutine root_place(gearbox, root, mesh, name)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: root           !! 1 .. n_roots
      integer, intent(out) :: mesh          !! 1 ..; 0: none
      character(len=:), allocatable, intent(out) :: name
      integer :: m

      mesh = 0
      name = "turns"
      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m))
            if (root <= contact%i_root .or. root > contact%i_root + contact%n_roots) cycle
            mesh = contact%mesh
            name = trim(root_rows(contact%roots(root - contact%i_root))%name)
         end associate
      end do
   end subroutine root_place

end module evl_gearbox_orbits
