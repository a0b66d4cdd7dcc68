!> A gearbox in closed form as y' = f(t, y) for the integrator evl_radau.
!>
!> The gearbox itself is constant and can be shared by several models. The discrete state belongs to the model and is set between
!> steps by gearbox_ode_set.
module evl_gearbox_ode
   use evl_archive, only: archive_t
   use evl_contact_roots, only: contact_root_directions
   use evl_discrete_state, only: take_mode
   use evl_extrema_lanes, only: monitored_in_lanes, most_rows, rough_channels
   use evl_extrema_monitor, only: mesh_states, n_channels
   use evl_force_jacobian, only: add_constants, add_forces, couple_reference, find_pattern
   use evl_force_lanes, only: lane_slot, put_force, put_position
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_gearbox_events, only: gearbox_root, gearbox_root_directions, gearbox_roots
   use evl_gearbox_lanes, only: supports_lanes, rates_in_lanes
   use evl_gearbox_rates, only: gearbox_rates
   use evl_housing, only: frame_t, housing_fixed, housing_frame, housing_prescribed
   use evl_housing_motion, only: resolved_motion_time
   use evl_jacobian_entries, only: jacobian_entries, listed_entries
   use evl_kinds, only: lanes, pi, wp
   use evl_local_variables, only: i_omega, i_theta
   use evl_ode_model, only: growth_by_coupling, growth_by_damping, growth_never, never, ode_model
   use evl_roots_lanes, only: roots_in_lanes
   use evl_status, only: code_invalid_input, fail, has_failed, status_t, subject_housing, subject_mesh
   use evl_tooth_contact, only: contact_state, nominal_start, touches, tracking_closed_form
   implicit none (type, external)
   private

   public :: gearbox_ode, gearbox_ode_serves, gearbox_ode_create, gearbox_ode_set, serialize_gearbox_ode
   public :: settle_aside, settle_slots

   !> Weights of the errors of theta and omega. Small errors shift the time at which a tooth pair enters, and with it a motion of 1
   !> kHz. They therefore weigh more than errors of states that move at that frequency.
   real(wp), parameter :: theta_weight = 1.0e4_wp, omega_weight = 300.0_wp
   !> Weight of all states: the mean over many states may be small although the error of one state is not.
   real(wp), parameter :: weight = 2

   type, extends(ode_model) :: gearbox_ode
      type(gearbox_t), pointer, private :: gearbox => null()
      integer, allocatable, private :: integers(:) !! discrete state
      real(wp), allocatable, private :: reals(:)   !! discrete state
      real(wp), private :: cycle = huge(1.0_wp)    !! shortest cycle of a load over time [s]
      type(jacobian_entries), private :: entries     !! of the Jacobian
      real(wp), allocatable, private :: constants(:) !! [nnz] constant part of dF/dy, psi'' not yet coupled with theta''
      logical, private :: in_lanes = .false.       !! whether eight states can be evaluated at once
      !> [tooth contacts] for evaluations in lanes, which change them
      type(lane_slot), allocatable, private :: slots(:)
      type(lane_slot), allocatable, private :: aside(:) !! the same for root functions at other states
   contains
      procedure :: rhs
      procedure :: rhs_lanes
      procedure :: jacobian
      procedure :: roots
      procedure :: roots_lanes
      procedure :: monitored_nearby
      procedure :: root_directions
      procedure :: resolved_time
   end type gearbox_ode

   interface
      !> Serialize the variable data: the discrete state, and the results of the last evaluation in lanes.
      module subroutine serialize_gearbox_ode(archive, self)
         implicit none (type, external)
         type(archive_t), intent(inout) :: archive
         type(gearbox_ode), intent(inout), target :: self
      end subroutine serialize_gearbox_ode
   end interface

contains

   !> Fail unless a gearbox can be written as y' = f(t, y) with differential states only.
   pure subroutine gearbox_ode_serves(gearbox, status, remedy)
      type(gearbox_t), intent(in) :: gearbox
      type(status_t), intent(inout) :: status !! `code_invalid_input`, with the reason and the location of the cause
      character(len=*), intent(in), optional :: remedy !! first remedy in the message; default: choose integrator ida
      character(len=:), allocatable :: first
      integer :: i

      first = "choose integrator ida"
      if (present(remedy)) first = remedy

      do i = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(i))
            if (contact%rigid) then
               call fail(status, code_invalid_input, "a rigid contact is a constraint, which radau does not integrate; "// &
                         first//", or another contact law", subject_mesh, contact%mesh, "contact")
            else if (contact%tracking /= tracking_closed_form) then
               call fail(status, code_invalid_input, "tracked contact points are algebraic states, which radau does not" &
                         //" integrate; "//first//", or tracking closed_form", subject_mesh, contact%mesh, "tracking")
            end if
         end associate
         if (has_failed(status)) return
      end do
      if (gearbox%housing%is_mounted) &
         call fail(status, code_invalid_input, "the accelerations of a mounted housing are coupled, which radau does not" &
                   //" integrate; "//first, subject_housing, field="kind")
   end subroutine gearbox_ode_serves

   !> Create the model of a supported gearbox; the gearbox must outlive it.
   subroutine gearbox_ode_create(self, gearbox, scale)
      type(gearbox_ode), intent(out) :: self
      type(gearbox_t), intent(in), target :: gearbox
      real(wp), intent(in) :: scale(:) !! [n_states] of the states, as from gearbox_state_scales

      self%gearbox => gearbox
      self%in_lanes = supports_lanes(gearbox)
      self%n = gearbox%n_states
      self%n_roots = gearbox%n_roots
      self%growth = kind_of_growth(gearbox)
      allocate (self%reach(gearbox%n_states), source=huge(1.0_wp))
      call find_cycles(gearbox, self%reach(i_theta), self%cycle)
      self%n_monitored = n_channels(gearbox)
      self%n_rows = most_rows(gearbox)
      self%is_rough = rough_channels(gearbox)
      allocate (self%scale(gearbox%n_states), source=scale/weight)
      self%scale(i_theta) = self%scale(i_theta)/theta_weight
      self%scale(i_omega) = self%scale(i_omega)/omega_weight
      allocate (self%integers(gearbox%n_integers), self%reals(size(gearbox%contacts)), self%slots(size(gearbox%contacts)), &
                self%aside(size(gearbox%contacts)))
      self%integers = 0
      self%reals = 0
      call find_pattern(gearbox, self%jacobian_row, self%jacobian_column)
      call listed_entries(gearbox%n_states, self%jacobian_row, self%jacobian_column, self%entries)
      allocate (self%constants(self%entries%n_entries), source=0.0_wp)
      call add_constants(gearbox, self%entries, self%constants)
      call list_root_states(gearbox, self)
   end subroutine gearbox_ode_create

   !> List the states on which each root function depends; the same for all of a mesh.
   pure subroutine list_root_states(gearbox, self)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_ode), intent(inout) :: self
      integer, allocatable :: states(:)
      integer :: i, m

      allocate (self%root_first(self%n_roots), self%root_last(self%n_roots))
      self%root_states = [i_theta] ! of the revolutions
      self%root_first = 1
      self%root_last = 1
      do i = 1, size(gearbox%pairs)
         call mesh_states(gearbox, i, states)
         do m = gearbox%first(i), gearbox%first(i + 1) - 1
            associate (before => gearbox%contacts(m)%i_root, n => gearbox%contacts(m)%n_roots)
               self%root_first(before + 1:before + n) = size(self%root_states) + 1
               self%root_last(before + 1:before + n) = size(self%root_states) + size(states)
            end associate
         end do
         self%root_states = [self%root_states, states]
      end do
   end subroutine list_root_states

   !> Possible source of growing vibrations: friction that falls or a load that grows with the speed, friction in general, or a
   !> moving housing. Supports, shafts and the dampers of contacts only dissipate energy.
   pure integer function kind_of_growth(gearbox) result(growth)
      type(gearbox_t), intent(in) :: gearbox
      logical :: falls
      integer :: i

      growth = growth_never
      if (gearbox%housing%kind /= housing_fixed) growth = growth_by_coupling
      falls = .false.
      do i = 1, size(gearbox%contacts)
         if (gearbox%contacts(i)%friction%acts()) growth = growth_by_coupling
         falls = falls .or. gearbox%contacts(i)%friction%falls()
      end do
      do i = 1, size(gearbox%loads)
         falls = falls .or. gearbox%loads(i)%load%may_feed
      end do
      if (falls) growth = growth_by_damping
   end function kind_of_growth

   !> Shortest cycles of a gearbox over the angle and over time.
   pure subroutine find_cycles(gearbox, of_angle, of_time)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(out) :: of_angle !! of theta: shortest pitch of all meshes, or a shorter cycle of a load [rad]
      real(wp), intent(out) :: of_time  !! of a load; huge if there is none [s]
      integer :: i

      of_angle = 2*pi
      of_time = huge(of_time)
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%teeth > 0) of_angle = min(of_angle, 2*pi/(wheel%teeth*abs(wheel%ratio)))
         end associate
      end do
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i)%load)
            if (.not. abs(load%swing) > 0) cycle
            if (load%by_angle) then
               of_angle = min(of_angle, load%cycle/abs(gearbox%wheels(load%wheel)%ratio))
            else
               of_time = min(of_time, load%cycle)
            end if
         end associate
      end do
   end subroutine find_cycles

   !> Step limit: the cycle of a load or of the housing's motion. Knots of the loads' tables are stop times.
   pure real(wp) function resolved_time(self, t) result(longest)
      class(gearbox_ode), intent(in) :: self
      real(wp), intent(in) :: t

      longest = self%cycle
      if (self%gearbox%housing%kind == housing_prescribed) &
         longest = min(longest, resolved_motion_time(self%gearbox%housing%motion, t))
   end function resolved_time

   !> Set the discrete state of the model.
   subroutine gearbox_ode_set(self, integers, reals)
      type(gearbox_ode), intent(inout) :: self
      integer, intent(in) :: integers(*) !! [n_integers]
      real(wp), intent(in) :: reals(*)   !! [one per tooth contact]

      self%integers = integers(:size(self%integers))
      self%reals = reals(:size(self%reals))
      call settle_slots(self%gearbox, self%integers, self%reals, self%slots)
      call settle_aside(self%slots, self%aside)
   end subroutine gearbox_ode_set

   !> f(t, y)
   subroutine rhs(self, t, y, f, status)
      class(gearbox_ode), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: f(self%n)
      type(status_t), intent(inout) :: status

      call gearbox_rates(self%gearbox, t, y, self%integers, self%reals, f, status)
   end subroutine rhs

   !> f for eight states.
   subroutine rhs_lanes(self, t, y, f, status)
      class(gearbox_ode), intent(inout) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      real(wp), intent(out) :: f(lanes, self%n)
      type(status_t), intent(inout) :: status

      if (self%in_lanes) then
         call rates_in_lanes(self%gearbox, t, y, self%integers, self%reals, self%slots, f, status)
      else
         call rhs_one_by_one(self, t, y, f, status)
      end if
   end subroutine rhs_lanes

   !> f for eight states, one by one. A separate procedure, because its local arrays cost an allocation that `rhs_lanes` avoids.
   subroutine rhs_one_by_one(self, t, y, f, status)
      class(gearbox_ode), intent(inout) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      real(wp), intent(out) :: f(lanes, self%n)
      type(status_t), intent(inout) :: status
      real(wp) :: y_lane(self%n), f_lane(self%n)
      type(contact_state) :: contacts(size(self%gearbox%contacts))
      integer :: i, lane

      do lane = 1, lanes
         y_lane = y(lane, :)
         call gearbox_rates(self%gearbox, t(lane), y_lane, self%integers, self%reals, f_lane, status, contacts=contacts)
         if (has_failed(status)) return
         f(lane, :) = f_lane
         do i = 1, size(contacts)
            if (.not. self%slots(i)%touches) cycle
            call put_position(self%gearbox%contacts(i), contacts(i), lane, self%slots(i))
            call put_force(contacts(i), lane, self%slots(i))
         end do
      end do
   end subroutine rhs_one_by_one

   !> df/dy, from the derivative of the residual y' - f.
   subroutine jacobian(self, t, y, values, status)
      class(gearbox_ode), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: values(:)
      type(status_t), intent(inout) :: status
      type(frame_t) :: frame

      if (self%gearbox%housing%acts) call housing_frame(self%gearbox%housing, t, y, frame)
      values = self%constants
      call add_forces(self%gearbox, t, y, self%integers, self%reals, frame, self%entries, values, status)
      if (has_failed(status)) return
      call couple_reference(self%gearbox, self%entries, values)
      values = -values
   end subroutine jacobian

   !> Root functions at a state, all or one.
   subroutine roots(self, t, y, values, status, only)
      class(gearbox_ode), intent(in) :: self
      real(wp), intent(in) :: t !! unused, since knots of tables are stop times
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(inout) :: values(self%n_roots)
      type(status_t), intent(inout) :: status
      integer, intent(in), optional :: only

      if (present(only)) then
         call gearbox_root(self%gearbox, only, y, self%integers, self%reals, values, status)
      else
         call gearbox_roots(self%gearbox, y, self%integers, self%reals, values, status)
      end if
   end subroutine roots

   !> Root functions for eight states near those of the last evaluation in lanes, whose data of touching contacts are used.
   subroutine roots_lanes(self, t, y, exact, values, status)
      class(gearbox_ode), intent(inout) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      logical, intent(inout) :: exact
      real(wp), intent(inout) :: values(lanes, self%n_roots)
      type(status_t), intent(inout) :: status

      if (self%in_lanes) then
         call roots_in_lanes(self%gearbox, y, self%integers, self%reals, self%slots, self%aside,.not. exact, values, status)
      else
         exact = .true.
         call roots_one_by_one(self, t, y, values, status)
      end if
   end subroutine roots_lanes

   !> Watched channels for eight states near those of the last evaluation.
   subroutine monitored_nearby(self, y, n, channels, values)
      class(gearbox_ode), intent(inout) :: self
      real(wp), intent(in) :: y(lanes, self%n)
      integer, intent(out) :: n
      integer, intent(inout) :: channels(:)
      real(wp), intent(inout) :: values(lanes, *)

      call monitored_in_lanes(self%gearbox, y, self%integers, self%slots, n, channels, values)
   end subroutine monitored_nearby

   !> Root functions for eight states, one by one.
   subroutine roots_one_by_one(self, t, y, values, status)
      class(gearbox_ode), intent(in) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      real(wp), intent(out) :: values(lanes, self%n_roots)
      type(status_t), intent(inout) :: status
      real(wp) :: y_lane(self%n), lane_values(self%n_roots)
      integer :: lane

      do lane = 1, lanes
         y_lane = y(lane, :)
         call self%roots(t(lane), y_lane, lane_values, status)
         if (has_failed(status)) return
         values(lane, :) = lane_values
      end do
   end subroutine roots_one_by_one

   !> Crossing directions that count in the present modes.
   subroutine root_directions(self, directions)
      class(gearbox_ode), intent(in) :: self
      integer, intent(out) :: directions(self%n_roots)

      call gearbox_root_directions(self%gearbox, self%integers, directions)
      where (directions == 0) directions = never
   end subroutine root_directions

   !> Set the discrete state of slots.
   subroutine settle_slots(gearbox, integers, reals, slots)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      type(lane_slot), intent(inout) :: slots(:) !! [tooth contacts]
      integer :: i

      do i = 1, size(gearbox%contacts)
         call take_mode(gearbox, i, integers, reals, slots(i)%mode)
         slots(i)%touches = touches(slots(i)%mode)
         call contact_root_directions(gearbox%contacts(i), slots(i)%mode, slots(i)%directions)
         slots(i)%rho_seen = 0
         slots(i)%rho_start = nominal_start(gearbox%contacts(i), integers(i_turns), slots(i)%mode%tooth_pair)
      end do
   end subroutine settle_slots

   !> Copy the discrete state to a second set of slots, for evaluations at other states.
   pure subroutine settle_aside(slots, aside)
      type(lane_slot), intent(in) :: slots(:) !! with their discrete state
      type(lane_slot), intent(inout) :: aside(:)
      integer :: i

      do i = 1, size(slots)
         aside(i)%mode = slots(i)%mode
         aside(i)%touches = slots(i)%touches
         aside(i)%directions = slots(i)%directions
         aside(i)%rho_start = slots(i)%rho_start
      end do
   end subroutine settle_aside

end module evl_gearbox_ode
