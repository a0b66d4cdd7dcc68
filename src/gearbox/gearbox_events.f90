!> Root functions and time events of a gearbox, and the changes of state at events.
module evl_gearbox_events
   use evl_contact_events, only: root_of_contact
   use evl_contact_roots, only: contact_root_directions, contact_roots
   use evl_contact_tracking, only: project_points
   use evl_contacts_at_state, only: find_tracked, look_at
   use evl_dae_residual, only: gearbox_derivative
   use evl_discrete_state, only: take_mode
   use evl_event_kinds, only: event_knot, event_revolution
   use evl_event_log, only: event_log, moment_t, n_event_kinds, note
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_housing, only: housing_renormalise
   use evl_kinds, only: pi, wp
   use evl_knots, only: next_knot
   use evl_local_variables, only: at_track, i_theta, n_local, n_track
   use evl_rigid_events, only: closed_flanks, settle_rigid
   use evl_root_kinds, only: n_root_kinds, n_sides
   use evl_settle_modes, only: most_settling, settle_modes
   use evl_status, only: code_no_solution, fail, has_failed, status_t
   use evl_tooth_contact, only: contact_mode, contact_state
   implicit none (type, external)
   private

   public :: gearbox_most_events, turns_root
   public :: gearbox_root, gearbox_roots, gearbox_root_directions, gearbox_next_time_event, gearbox_apply_event

   integer, parameter :: most_turns = 2       !! theta is reduced at events after one revolution, and at the latest after this many

contains

   !> Root functions at a state: those of the tooth contacts, and that of the revolutions of the reference wheel.
   subroutine gearbox_roots(gearbox, y, integers, reals, roots, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: roots(gearbox%n_roots)
      type(status_t), intent(inout) :: status
      type(contact_state) :: at(size(gearbox%contacts))
      integer :: directions(n_root_kinds), i, m

      do i = 1, size(gearbox%flanks)
         associate (flank => gearbox%flanks(i)%flank, first => gearbox%flanks(i)%flank%first, last => gearbox%flanks(i)%flank%last)
            call look_at(gearbox, first, last, y, integers, reals, at, status)
            if (has_failed(status)) return
            do m = first, last
               call contact_roots(flank, gearbox%contacts(m), at(m), directions, &
                                  roots(gearbox%contacts(m)%i_root + 1))
            end do
         end associate
      end do
      roots(gearbox%n_roots) = turns_root(y(i_theta))
   end subroutine gearbox_roots

   !> One root function at a state, as in `gearbox_roots`; other elements of `roots` may change to their values.
   subroutine gearbox_root(gearbox, index, y, integers, reals, roots, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index               !! index of the root function: 1 .. n_roots
      real(wp), intent(in) :: y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(inout) :: roots(gearbox%n_roots)
      type(status_t), intent(inout) :: status
      integer :: m

      do m = 1, size(gearbox%contacts)
         associate (first => gearbox%contacts(m)%i_root + 1, last => gearbox%contacts(m)%i_root + gearbox%contacts(m)%n_roots)
            if (index > last) cycle
            call root_of_contact(gearbox, m, index - first + 1, y, integers, reals, roots(first:last), status)
         end associate
         return
      end do
      roots(gearbox%n_roots) = turns_root(y(i_theta))
   end subroutine gearbox_root

   !> Root function of the revolutions of the reference wheel.
   elemental real(wp) function turns_root(theta) result(root)
      real(wp), intent(in) :: theta !! [rad]

      root = 1 - (theta/(2*pi*most_turns))**2
   end function turns_root

   !> Directions that count in the present modes; 0 for root functions without a meaning, which are 1.
   pure subroutine gearbox_root_directions(gearbox, integers, directions)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: integers(gearbox%n_integers)
      integer, intent(out) :: directions(gearbox%n_roots)
      type(contact_mode) :: mode
      real(wp) :: no_reals(size(gearbox%contacts))
      integer :: m

      no_reals = 0
      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m))
            call take_mode(gearbox, m, integers, no_reals, mode)
            call contact_root_directions(contact, mode, directions(contact%i_root + 1:contact%i_root + contact%n_roots))
         end associate
      end do
      directions(gearbox%n_roots) = -1
   end subroutine gearbox_root_directions

   !> Largest number of entries in the log of one event: for each contact one set, one more in every iteration of settling, and
   !> again after an impact; entries for impacts and rigid forces; each kind once for further impacts; a knot and a revolution.
   pure integer function gearbox_most_events(gearbox) result(most)
      type(gearbox_t), intent(in) :: gearbox
      integer, parameter :: of_contact = 5 + n_sides !! pair, border, sliding, contact, distance; logged kinds
      integer, parameter :: of_flank = 4   !! opened, impact or closed, impacts ended, opened
      integer, parameter :: of_pairs = 3   !! a pair that left, one that entered, none

      most = size(gearbox%contacts)*(of_contact*(1 + 2*most_settling) + of_flank + n_event_kinds()*of_pairs) + 2
   end function gearbox_most_events

   !> Time of the next knot of a table [s]; huge if there is none.
   pure real(wp) function gearbox_next_time_event(gearbox, integers) result(time)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: integers(gearbox%n_integers)
      integer :: i

      time = huge(time)
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i)%load)
            if (load%i_segment > 0) time = min(time, next_knot(load%knots, integers(load%i_segment)))
         end associate
      end do
   end function gearbox_next_time_event

   !> Apply an event at t and make y' consistent.
   subroutine gearbox_apply_event(gearbox, t, fired, time_event, y, yp, integers, reals, log, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      integer, intent(in) :: fired(gearbox%n_roots) !! not 0 where a root function passed zero
      logical, intent(in) :: time_event      !! t is the time of the next knot
      real(wp), intent(inout) :: y(gearbox%n_states)
      real(wp), intent(out) :: yp(gearbox%n_states)
      integer, intent(inout) :: integers(gearbox%n_integers)
      real(wp), intent(inout) :: reals(size(gearbox%contacts))
      type(event_log), intent(out) :: log    !! at most gearbox_most_events
      type(status_t), intent(inout) :: status
      integer, parameter :: few = 8 !! initial size of the log, which grows if required
      logical :: was_closed(size(gearbox%contacts))
      type(moment_t) :: now
      integer :: i

      now%t = t
      now%y = y
      now%integers = integers
      now%reals = reals
      allocate (now%log%events(few))
      was_closed = closed_flanks(gearbox, integers)
      if (time_event) then
         do i = 1, size(gearbox%loads)
            associate (load => gearbox%loads(i)%load)
               if (load%i_segment == 0) cycle
               if (next_knot(load%knots, now%integers(load%i_segment)) <= t) &
                  now%integers(load%i_segment) = now%integers(load%i_segment) + 1
            end associate
         end do
         call note(now%log, event_knot)
      end if
      call settle_modes(gearbox, fired, now, status)
      if (abs(now%y(i_theta)) >= 2*pi .or. fired(gearbox%n_roots) /= 0) then
         i = int(now%y(i_theta)/(2*pi)*(1 + epsilon(pi)))
         now%integers(i_turns) = now%integers(i_turns) + i
         now%y(i_theta) = now%y(i_theta) - 2*pi*i
         call note(now%log, event_revolution)
      end if
      if (gearbox%n_multipliers > 0 .and. .not. has_failed(status)) &
         call settle_rigid(gearbox, was_closed, now, status)
      y = now%y
      integers = now%integers
      reals = now%reals
      log = now%log
      call project_tracked(gearbox, y, integers)
      call housing_renormalise(gearbox%housing, y)
      if (log%n > gearbox_most_events(gearbox)) call fail(status, code_no_solution, &
                                                          "more events occur at one instant than its log can store")
      if (.not. has_failed(status)) call gearbox_derivative(gearbox, t, y, integers, reals, yp, status)
   end subroutine gearbox_apply_event

   !> Put the tracked points exactly onto their flanks before the restart; if this fails, `gearbox_derivative` reports the error.
   subroutine project_tracked(gearbox, y, integers)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp) :: q(n_local), rho_a0
      logical :: solved, tracks
      integer :: m

      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m))
            call find_tracked(gearbox, m, y, integers, tracks, q, rho_a0)
            if (.not. tracks) cycle
            call project_points(contact%pair, rho_a0, q, solved)
            if (solved) y(contact%i_track:contact%i_track + n_track - 1) = q(at_track:)
         end associate
      end do
   end subroutine project_tracked

end module evl_gearbox_events
