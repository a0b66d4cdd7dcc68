!> What the search for periodic orbits has to know of a system: an `ode_model` that also says how its events change with the state.
!>
!> The system is driven in time with a known period, or autonomous, with a period to be found. All that must repeat after a period
!> is in y and in `modes`. A memory variable, such as a speed at first touch, is a state at rest: its rate is 0, and events set it.
!>
!> States beside it need not repeat: those on which nothing depends, such as an energy, and those that depend on time alone, such as
!> the angle of a wheel whose speed is prescribed. The derivative of the flow is that of the others.
module evl_orbit_model
   use evl_kinds, only: wp
   use evl_ode_model, only: ode_model
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: must_repeat, orbit_model

   !> The components are set before an orbit is sought; `period` and `modes` change.
   type, abstract, extends(ode_model) :: orbit_model
      logical :: autonomous = .false.       !! f and the root functions do not depend on time, and there are no time events
      real(wp) :: phase = 0                 !! time of the section: where a period begins. Away from time events
      real(wp) :: period = 0                !! of what drives, > 0; `set_parameter` may change it. Not used if autonomous
      integer, allocatable :: modes(:)      !! discrete state: changed by `settle` and `apply_event` alone
      logical, allocatable :: repeats(:)    !! [n] false for a state that need not repeat, as above. Not allocated: all do
      real(wp), allocatable :: advance(:)   !! [n] by how much a state is larger after a period, such as an angle by a turn
   contains
      procedure(set_parameter_interface), deferred :: set_parameter
      procedure(settle_interface), deferred :: settle
      procedure(root_gradient_interface), deferred :: root_gradient
      procedure(apply_event_interface), deferred :: apply_event
      procedure :: begin_flow => allow_flow
      procedure :: next_time_event => no_time_event
      procedure :: come_back => nothing_to_bring
      procedure :: other_contacts => no_others
   end type orbit_model

   abstract interface
      !> Give the parameter along which orbits are followed a value.
      subroutine set_parameter_interface(self, value, status)
         import :: orbit_model, status_t, wp
         implicit none (type, external)
         class(orbit_model), intent(inout) :: self
         real(wp), intent(in) :: value
         type(status_t), intent(inout) :: status !! touched on failure only: there is no such system
      end subroutine set_parameter_interface

      !> Take the modes that belong to a state on the section; what need not repeat, or means nothing in them, gets its value.
      subroutine settle_interface(self, t, y, status)
         import :: orbit_model, status_t, wp
         implicit none (type, external)
         class(orbit_model), intent(inout) :: self
         real(wp), intent(in) :: t
         real(wp), intent(inout) :: y(self%n)
         type(status_t), intent(inout) :: status !! touched on failure only
      end subroutine settle_interface

      !> How a root function that is zero at (t, y) changes with the state and with time, in the modes before the event.
      subroutine root_gradient_interface(self, t, y, root, by_state, by_time, status)
         import :: orbit_model, status_t, wp
         implicit none (type, external)
         class(orbit_model), intent(in) :: self
         real(wp), intent(in) :: t, y(self%n)
         integer, intent(in) :: root              !! which one, 1 .. n_roots
         real(wp), intent(out) :: by_state(self%n)
         real(wp), intent(out) :: by_time         !! at the same state
         type(status_t), intent(inout) :: status  !! touched on failure only
      end subroutine root_gradient_interface

      !> What an event changes: modes and state, and how the new state depends on the old one and on when it happens.
      subroutine apply_event_interface(self, t, fired, time_event, y, by_state, by_time, status)
         import :: orbit_model, status_t, wp
         implicit none (type, external)
         class(orbit_model), intent(inout) :: self
         real(wp), intent(in) :: t
         integer, intent(in) :: fired(self%n_roots) !! +1 risen through zero, -1 fallen, 0 nothing
         logical, intent(in) :: time_event          !! t is the time of `next_time_event`
         real(wp), intent(inout) :: y(self%n)
         real(wp), intent(out) :: by_state(self%n, self%n) !! (i, j): new state i by old state j
         real(wp), intent(out) :: by_time(self%n)   !! at the same old state
         type(status_t), intent(inout) :: status    !! touched on failure only
      end subroutine apply_event_interface
   end interface

contains

   !> Called before each flow. An extension that fails here ends the search, for instance after too many flows.
   subroutine allow_flow(self, status)
      class(orbit_model), intent(inout) :: self
      type(status_t), intent(inout) :: status
   end subroutine allow_flow

   !> Time of the next event that time alone brings, after those that the modes say are over; huge if there is none.
   pure real(wp) function no_time_event(self, t) result(time)
      class(orbit_model), intent(in) :: self
      real(wp), intent(in) :: t

      time = huge(time)
   end function no_time_event

   !> After so many periods: change state and modes to what they are called on the section where these began, and the derivative
   !> with them, where that is more than `advance` says: places of memory that change round, for instance.
   subroutine nothing_to_bring(self, periods, y, derivative)
      class(orbit_model), intent(inout) :: self
      integer, intent(in) :: periods
      real(wp), intent(inout) :: y(self%n)
      real(wp), intent(inout) :: derivative(self%n, self%n) !! (i, j): state i by state j at the start
   end subroutine nothing_to_bring

   !> Number of other contacts that touch in the present modes, of those that belong together with the contact of a root function.
   pure integer function no_others(self, root) result(n)
      class(orbit_model), intent(in) :: self
      integer, intent(in) :: root !! 1 .. n_roots

      n = 0*min(root, self%n_roots)
   end function no_others

   !> States that have to repeat.
   pure function must_repeat(self) result(repeats)
      class(orbit_model), intent(in) :: self
      logical :: repeats(self%n)

      repeats = .true.
      if (allocated(self%repeats)) repeats = self%repeats
   end function must_repeat

end module evl_orbit_model
