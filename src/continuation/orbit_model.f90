!> Interface of a system to the search for periodic orbits: an `ode_model` that also provides the derivatives of its events.
!>
!> The system is driven in time with a known period, or autonomous with an unknown one. All quantities that must repeat after a
!> period are in y and in `modes`. A memory variable, such as a speed at first contact, is a state with rate 0 that events set.
!>
!> Other states in y need not repeat: those on which no other depends, such as an energy, and those that depend on time alone,
!> such as the angle of a wheel with prescribed speed. The derivative of the flow excludes them.
module evl_orbit_model
   use evl_kinds, only: wp
   use evl_ode_model, only: ode_model
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: must_repeat, orbit_model

   !> The components are set before the search for an orbit; `period` and `modes` change.
   type, abstract, extends(ode_model) :: orbit_model
      logical :: autonomous = .false.       !! f and the root functions do not depend on time, and there are no time events
      real(wp) :: phase = 0                 !! time of the section, where a period begins; not at a time event
      real(wp) :: period = 0                !! of the excitation, > 0; `set_parameter` may change it. Not used if autonomous
      integer, allocatable :: modes(:)      !! discrete state: changed only by `settle` and `apply_event`
      logical, allocatable :: repeats(:)    !! [n] false for a state that need not repeat, as above. Not allocated: all do
      real(wp), allocatable :: advance(:)   !! [n] increase of a state per period, such as a revolution of an angle
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
      !> Set the value of the continuation parameter.
      subroutine set_parameter_interface(self, value, status)
         import :: orbit_model, status_t, wp
         implicit none (type, external)
         class(orbit_model), intent(inout) :: self
         real(wp), intent(in) :: value
         type(status_t), intent(inout) :: status !! touched on failure only: there is no such system
      end subroutine set_parameter_interface

      !> Set the modes of a state on the section. States that need not repeat, or have no meaning in these modes, receive
      !> their value.
      subroutine settle_interface(self, t, y, status)
         import :: orbit_model, status_t, wp
         implicit none (type, external)
         class(orbit_model), intent(inout) :: self
         real(wp), intent(in) :: t
         real(wp), intent(inout) :: y(self%n)
         type(status_t), intent(inout) :: status !! touched on failure only
      end subroutine settle_interface

      !> Derivatives of a root function that is zero at (t, y), by the state and by time, in the modes before the event.
      subroutine root_gradient_interface(self, t, y, root, by_state, by_time, status)
         import :: orbit_model, status_t, wp
         implicit none (type, external)
         class(orbit_model), intent(in) :: self
         real(wp), intent(in) :: t, y(self%n)
         integer, intent(in) :: root              !! its index, 1 .. n_roots
         real(wp), intent(out) :: by_state(self%n)
         real(wp), intent(out) :: by_time         !! at constant state
         type(status_t), intent(inout) :: status  !! touched on failure only
      end subroutine root_gradient_interface

      !> Apply an event: change modes and state, and return the derivatives of the new state by the old one and by the event time.
      subroutine apply_event_interface(self, t, fired, time_event, y, by_state, by_time, status)
         import :: orbit_model, status_t, wp
         implicit none (type, external)
         class(orbit_model), intent(inout) :: self
         real(wp), intent(in) :: t
         integer, intent(in) :: fired(self%n_roots) !! zero crossings: +1 rising, -1 falling, 0 none
         logical, intent(in) :: time_event          !! t is the time of `next_time_event`
         real(wp), intent(inout) :: y(self%n)
         real(wp), intent(out) :: by_state(self%n, self%n) !! (i, j): new state i by old state j
         real(wp), intent(out) :: by_time(self%n)   !! at constant old state
         type(status_t), intent(inout) :: status    !! touched on failure only
      end subroutine apply_event_interface
   end interface

contains

   !> Called before each flow. An extension that fails here ends the search, for instance after too many flows.
   subroutine allow_flow(self, status)
      class(orbit_model), intent(inout) :: self
      type(status_t), intent(inout) :: status
   end subroutine allow_flow

   !> Next time event after t that is not over according to the modes; huge if there is none.
   pure real(wp) function no_time_event(self, t) result(time)
      class(orbit_model), intent(in) :: self
      real(wp), intent(in) :: t

      time = huge(time)
   end function no_time_event

   !> After a number of periods: convert state, modes and derivative to their meaning on the section at the start, beyond what
   !> `advance` describes: for instance, permuted slots of a memory.
   subroutine nothing_to_bring(self, periods, y, derivative)
      class(orbit_model), intent(inout) :: self
      integer, intent(in) :: periods
      real(wp), intent(inout) :: y(self%n)
      real(wp), intent(inout) :: derivative(self%n, self%n) !! (i, j): state i by state j at the start
   end subroutine nothing_to_bring

   !> Number of other closed contacts in the present modes, among those that belong together with the contact of a root function.
   pure integer function no_others(self, root) result(n)
      class(orbit_model), intent(in) :: self
      integer, intent(in) :: root !! 1 .. n_roots

      n = 0*min(root, self%n_roots)
   end function no_others

   !> States that must repeat.
   pure function must_repeat(self) result(repeats)
      class(orbit_model), intent(in) :: self
      logical :: repeats(self%n)

      repeats = .true.
      if (allocated(self%repeats)) repeats = self%repeats
   end function must_repeat

end module evl_orbit_model
