!> A gearbox as a system for the search for periodic orbits: `gearbox_ode` plus the shift by a period, the changes at events and
!> their derivatives with respect to the state. docs/theory/orbits.md.
!>
!> States: those of the gearbox, then the approach speed at the last closing of each tooth contact whose damping depends on it.
!> If a speed is prescribed, theta and omega are functions of time and need not repeat; energies never repeat.
module evl_gearbox_orbits
   use evl_common_period, only: common_period, period_t
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_ode, only: gearbox_ode, gearbox_ode_create, gearbox_ode_serves
   use evl_indices, only: indices
   use evl_kinds, only: lanes, pi, wp
   use evl_local_variables, only: i_omega, i_theta
   use evl_orbit_model, only: orbit_model
   use evl_root_kinds, only: root_rows
   use evl_status, only: code_invalid_input, fail, has_failed, status_t, subject_load
   implicit none (type, external)
   private

   public :: gearbox_family, gearbox_orbits, gearbox_orbits_arrive, gearbox_orbits_create, gearbox_orbits_start, &
             gearbox_orbits_state

   real(wp), parameter :: weight = 2             !! tightens the scales of all states, as in gearbox_ode
   integer, parameter :: per_contact = 4         !! number of modes per contact that must repeat

   !> A family of gearboxes that depend on one parameter.
   type, abstract :: gearbox_family
   contains
      procedure(take_interface), deferred :: take
   end type gearbox_family

   abstract interface
      !> Get the gearbox for a value of the parameter. It is valid until the next call.
      subroutine take_interface(self, value, gearbox, scale, status)
         import :: gearbox_family, gearbox_t, status_t, wp
         implicit none (type, external)
         class(gearbox_family), intent(inout) :: self
         real(wp), intent(in) :: value
         type(gearbox_t), pointer, intent(out) :: gearbox
         real(wp), allocatable, intent(out) :: scale(:) !! [n_states] as from gearbox_state_scales
         type(status_t), intent(inout) :: status !! set on failure only: no such gearbox
      end subroutine take_interface
   end interface

   !> Mesh, tooth contact and name of a root function.
   type :: root_id
      integer :: mesh = 0                  !! index from 1; 0: no mesh
      integer :: contact = 0               !! index of the tooth contact, from 1
      character(len=24) :: name = "turns"
   end type root_id

   type, extends(orbit_model) :: gearbox_orbits
      class(gearbox_family), pointer, private :: family => null()
      type(gearbox_t), pointer :: gearbox => null() !! for the last value
      type(period_t) :: common
      real(wp), private :: value = 0, section = 0     !! parameter value; section [pitches of the first mesh]
      logical, private :: is_made = .false., is_current = .false. !! a gearbox exists; it belongs to `value`
      type(gearbox_ode), private :: ode
      integer, private :: n_gears = 0               !! number of states of the gearbox
      integer, allocatable, private :: memory(:)    !! tooth contacts whose approach speeds are states
      integer, allocatable, private :: integers(:)  !! discrete state
      real(wp), allocatable, private :: reals(:)
      type(root_id), allocatable :: root_list(:) !! [n_roots], the same for all values; remains valid without a gearbox
   contains
      procedure :: rhs, rhs_lanes, jacobian
      procedure :: roots, roots_lanes, root_directions
      procedure :: resolved_time
      procedure :: set_parameter
      procedure :: settle
      procedure :: root_gradient
      procedure :: apply_event
      procedure :: come_back
      procedure :: other_contacts
   end type gearbox_orbits

   interface
      !> Modes of a state on the section.
      module subroutine settle(self, t, y, status)
         implicit none (type, external)
         class(gearbox_orbits), intent(inout) :: self
         real(wp), intent(in) :: t
         real(wp), intent(inout) :: y(self%n)
         type(status_t), intent(inout) :: status
      end subroutine settle

      !> Convert the state of a gearbox run that returned to the section to a state of this system.
      module subroutine gearbox_orbits_arrive(self, y_gears, integers, reals, y, same_modes)
         implicit none (type, external)
         type(gearbox_orbits), intent(inout) :: self !! with the modes of the state at the start of the run
         real(wp), intent(in) :: y_gears(:), reals(:)
         integer, intent(in) :: integers(:)
         real(wp), intent(out) :: y(self%n)
         logical, intent(out) :: same_modes          !! the modes equal those at the start
      end subroutine gearbox_orbits_arrive

      !> Shift tooth pairs, after whole periods, back to the indices at the start of the motion.
      module subroutine come_back(self, periods, y, derivative)
         implicit none (type, external)
         class(gearbox_orbits), intent(inout) :: self
         integer, intent(in) :: periods
         real(wp), intent(inout) :: y(self%n), derivative(self%n, self%n)
      end subroutine come_back

      !> Number of other touching tooth pairs of the mesh.
      pure module function other_contacts(self, root) result(n)
         implicit none (type, external)
         class(gearbox_orbits), intent(in) :: self
         integer, intent(in) :: root
         integer :: n
      end function other_contacts

      !> Derivative of f with respect to an approach speed.
      module subroutine by_memory(self, m, t, y, slope, status)
         implicit none (type, external)
         type(gearbox_orbits), intent(in) :: self
         integer, intent(in) :: m !! index of the tooth contact
         real(wp), intent(in) :: t, y(self%n_gears)
         real(wp), intent(out) :: slope(self%n_gears)
         type(status_t), intent(inout) :: status
      end subroutine by_memory

      !> Derivatives of a root function with respect to its states; no root function depends on time explicitly.
      module subroutine root_gradient(self, t, y, root, by_state, by_time, status)
         implicit none (type, external)
         class(gearbox_orbits), intent(in) :: self
         real(wp), intent(in) :: t, y(self%n)
         integer, intent(in) :: root
         real(wp), intent(out) :: by_state(self%n), by_time
         type(status_t), intent(inout) :: status
      end subroutine root_gradient

      !> Apply the changes of an event: modes, and the approach speeds of contacts that close or leave.
      module subroutine apply_event(self, t, fired, time_event, y, by_state, by_time, status)
         implicit none (type, external)
         class(gearbox_orbits), intent(inout) :: self
         real(wp), intent(in) :: t
         integer, intent(in) :: fired(self%n_roots)
         logical, intent(in) :: time_event
         real(wp), intent(inout) :: y(self%n)
         real(wp), intent(out) :: by_state(self%n, self%n), by_time(self%n)
         type(status_t), intent(inout) :: status
      end subroutine apply_event
   end interface

contains

   !> Create the system from the gearbox with an initial parameter value, which defines all scales.
   subroutine gearbox_orbits_create(self, family, value, section, status)
      type(gearbox_orbits), intent(out) :: self
      class(gearbox_family), intent(inout), target :: family !! must outlive this object
      real(wp), intent(in) :: value
      real(wp), intent(in) :: section !! position of the section if a speed is prescribed [pitches of the first mesh after t = 0]
      type(status_t), intent(inout) :: status

      self%family => family
      self%section = section
      call self%set_parameter(value, status)
   end subroutine gearbox_orbits_create

   !> Switch to the gearbox for a parameter value.
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
      if (common%by_time) self%phase = self%section*common%time/common%pitches
      call gearbox_ode_create(self%ode, gearbox, scale)
      self%is_made = .true.
      self%is_current = .true.
   end subroutine set_parameter

   !> Check that prescribed speeds are those of the reference wheel: then all angles except theta are free.
   pure subroutine check_speeds(gearbox, status)
      type(gearbox_t), intent(in) :: gearbox
      type(status_t), intent(inout) :: status
      integer :: i

      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i)%load)
            if (.not. load%prescribes) cycle
            if (gearbox%wheels(load%wheel)%i_psi > 0) call fail(status, code_invalid_input, "orbits are found where the" &
                        //" speed of the first wheel, or of one on its shaft, is prescribed; list the wheels in another order, or" &
                                                                //" omit the method", subject_load, i, "kind")
         end associate
         if (has_failed(status)) return
      end do
   end subroutine check_speeds

   !> Set the data common to all values.
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
      self%memory = indices(remembering(gearbox))
      self%n = self%n_gears + size(self%memory)
      self%n_roots = gearbox%n_roots
      self%root_list = root_ids(gearbox)
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

   !> Tooth contacts whose damping depends on the approach speed at the last closing.
   pure function remembering(gearbox)
      type(gearbox_t), intent(in) :: gearbox
      logical :: remembering(size(gearbox%contacts))
      integer :: m

      do m = 1, size(gearbox%contacts)
         remembering(m) = gearbox%contacts(m)%damping%remembers()
      end do
   end function remembering

   !> Convert a state of the gearbox on or near the section to a state of this system.
   pure subroutine gearbox_orbits_start(self, y_gears, turns, reals, y)
      type(gearbox_orbits), intent(in) :: self
      real(wp), intent(in) :: y_gears(:), reals(:)
      integer, intent(in) :: turns     !! revolutions of the reference wheel
      real(wp), intent(out) :: y(self%n)
      integer :: k

      y(:self%n_gears) = y_gears
      y(i_theta) = y(i_theta) + 2*pi*turns
      y([self%gearbox%i_dissipated, self%gearbox%i_work]) = 0
      do k = 1, size(self%memory)
         y(self%n_gears + k) = reals(self%memory(k))
      end do
   end subroutine gearbox_orbits_start

   !> The inverse: convert to a state of the gearbox, with consistent modes, at the current parameter value.
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

   !> f(t, y); approach speeds are constant.
   subroutine rhs(self, t, y, f, status)
      class(gearbox_orbits), intent(in) :: self
      real(wp), intent(in) :: t, y(self%n)
      real(wp), intent(out) :: f(self%n)
      type(status_t), intent(inout) :: status

      f(self%n_gears + 1:) = 0
      call self%ode%rhs(t, y(:self%n_gears), f(:self%n_gears), status)
   end subroutine rhs

   !> f of eight states.
   subroutine rhs_lanes(self, t, y, f, status)
      class(gearbox_orbits), intent(inout) :: self
      real(wp), intent(in) :: t(lanes), y(lanes, self%n)
      real(wp), intent(out) :: f(lanes, self%n)
      type(status_t), intent(inout) :: status

      f(:, self%n_gears + 1:) = 0
      call self%ode%rhs_lanes(t, y(:, :self%n_gears), f(:, :self%n_gears), status)
   end subroutine rhs_lanes

   !> df/dy; the derivative with respect to an approach speed is nonzero while its contact touches.
   subroutine jacobian(self, t, y, values, status)
      class(gearbox_orbits), intent(in) :: self
      real(wp), intent(in) :: t, y(self%n)
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

   !> Root functions.
   subroutine roots(self, t, y, values, status, only)
      class(gearbox_orbits), intent(in) :: self
      real(wp), intent(in) :: t, y(self%n)
      real(wp), intent(inout) :: values(self%n_roots)
      type(status_t), intent(inout) :: status
      integer, intent(in), optional :: only

      call self%ode%roots(t, y(:self%n_gears), values, status, only)
   end subroutine roots

   !> Root functions of eight states.
   subroutine roots_lanes(self, t, y, exact, values, status)
      class(gearbox_orbits), intent(inout) :: self
      real(wp), intent(in) :: t(lanes), y(lanes, self%n)
      logical, intent(inout) :: exact
      real(wp), intent(inout) :: values(lanes, self%n_roots)
      type(status_t), intent(inout) :: status

      call self%ode%roots_lanes(t, y(:, :self%n_gears), exact, values, status)
   end subroutine roots_lanes

   !> Active crossing directions.
   subroutine root_directions(self, directions)
      class(gearbox_orbits), intent(in) :: self
      integer, intent(out) :: directions(self%n_roots)

      call self%ode%root_directions(directions)
   end subroutine root_directions

   !> As for the gearbox.
   pure real(wp) function resolved_time(self, t) result(longest)
      class(gearbox_orbits), intent(in) :: self
      real(wp), intent(in) :: t

      longest = self%ode%resolved_time(t)
   end function resolved_time

   !> Mesh, contact and name of all root functions of a gearbox.
   pure function root_ids(gearbox) result(at)
      type(gearbox_t), intent(in) :: gearbox
      type(root_id) :: at(gearbox%n_roots)
      integer :: i, m

      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m))
            do i = 1, contact%n_roots
               at(contact%i_root + i) = root_id(contact%mesh, m, root_rows(contact%roots(i))%name)
            end do
         end associate
      end do
   end function root_ids

end module evl_gearbox_orbits
