!> Event handling of rigid contacts: impacts of closing flanks, normal forces of all, and opening of flanks.
!>
!> The flanks share wheels. The impact of one flank can therefore drive another touching flank into its mate, or away from it. After
!> any jump of the speeds, impacts follow one another at the same instant until no touching flank approaches. Flanks that part so
!> slowly that their load closes them again stay closed; otherwise they would open each other in turn, ever faster.
module evl_rigid_events
   use evl_contact_events, only: contact_event
   use evl_discrete_state, only: first_pair, flanks_of, is_closed, pairs_with
   use evl_event_kinds, only: event_closed, event_impact, event_impacts_ended, event_opened
   use evl_event_log, only: moment_t, note
   use evl_gearbox, only: gearbox_local, gearbox_t
   use evl_housing_dynamics, only: coupled_rates
   use evl_kinds, only: wp
   use evl_local_variables, only: n_local
   use evl_rigid_contact, only: rigid_acceleration, rigid_constraint
   use evl_rigid_forces, only: impact, open_flank, set_multipliers
   use evl_root_kinds, only: n_root_kinds, past, root_of, tie
   use evl_settle_modes, only: located, settle_modes
   use evl_status, only: code_no_solution, fail, has_failed, status_t, subject_mesh
   use evl_tooth_contact, only: contact_state, flanks_open, tooth_contact_t
   implicit none (type, external)
   private

   public :: closed_flanks, settle_rigid

   integer, parameter :: most_blows = 1000 !! at one instant; two flanks of restitution 0.9 that wedge a wheel need some hundred

contains

   !> Tooth contacts that are the leading ones of closed rigid flanks.
   pure function closed_flanks(gearbox, integers) result(closed)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: integers(gearbox%n_integers)
      logical :: closed(size(gearbox%contacts))
      integer :: m

      closed = [(is_closed(gearbox, m, integers), m=1, size(closed))]
   end function closed_flanks

   !> Apply impacts until no touching flank approaches, then compute the normal forces; flanks that would have to pull are opened.
   !> Equation T57.
   subroutine settle_rigid(gearbox, was_closed, now, status)
      type(gearbox_t), intent(in) :: gearbox
      type(moment_t), intent(inout) :: now
      logical, intent(in) :: was_closed(:) !! closed_flanks before the event
      type(status_t), intent(inout) :: status
      logical, dimension(size(gearbox%contacts)) :: closed, closing, held, opened, rebounded
      logical, dimension(size(gearbox%contacts)) :: parted, retried
      logical :: free(size(gearbox%contacts)) !! may be held: not parted by this event, and not yet held
      integer :: blow, m

      closed = was_closed
      rebounded = .false.
      parted = .false.
      retried = .false.
      ! a flank whose force has fallen through zero parts, regardless of rounding
      free = closed_flanks(gearbox, now%integers) .or. .not. was_closed
      do blow = 1, most_blows
         call close_approaching(gearbox, now, status)
         if (has_failed(status)) return
         closing = closed_flanks(gearbox, now%integers) .and. .not. closed
         if (any(closing)) then
            call strike(gearbox, closed, closing, rebounded, now, status)
            if (has_failed(status)) return
         else
            call set_multipliers(gearbox, now%t, now%y, now%integers, now%reals, opened, status)
            do m = 1, size(gearbox%contacts)
               if (opened(m)) call note(now%log, event_opened, gearbox%contacts(m), first_pair(gearbox, m, now%integers))
            end do
            if (has_failed(status)) return
            parted = parted .or. opened
            call come_back(gearbox, free, now, held, status)
            if (has_failed(status)) return
            held = held .or. (free .and. .not. rebounded .and. slow(gearbox, now%y, now%integers))
            if (any(held)) call hold(gearbox, held, now)
            if (.not. any(held .or. approach_past_zero(gearbox, now%y, now%integers))) return
            call look_again(parted, retried, free)
            free = free .and. .not. held
         end if
         closed = closed_flanks(gearbox, now%integers)
         now%log%once = .true.
      end do
      call fail(status, code_no_solution, "the impacts of its rigid flanks and those of other meshes do not end at this instant;" &
                //" a larger rest_velocity or a smaller restitution ends them", subject_mesh, &
                gearbox%contacts(max(findloc(closing, .true., dim=1), 1))%mesh, "contact")
   end subroutine settle_rigid

   !> Allow flanks that have parted to be held again, since the state of the other flanks has changed. Each is allowed once.
   pure subroutine look_again(parted, retried, free)
      logical, intent(inout) :: parted(:), retried(:), free(:)

      free = free .or. (parted .and. .not. retried)
      retried = retried .or. parted
      parted = .false.
   end subroutine look_again

   !> Impacts of the closing flanks.
   subroutine strike(gearbox, was_closed, closing, rebounded, now, status)
      type(gearbox_t), intent(in) :: gearbox
      type(moment_t), intent(inout) :: now
      logical, intent(in) :: was_closed(:), closing(:) !! closed_flanks before the impact; flanks that close in it
      logical, intent(inout) :: rebounded(:)           !! flanks that have rebounded at this instant
      type(status_t), intent(inout) :: status
      logical, dimension(size(gearbox%contacts)) :: rebounds, opened
      integer :: nothing(gearbox%n_roots), m

      call impact(gearbox, closing, .false., now, rebounds, opened, status)
      if (has_failed(status)) return
      do m = 1, size(gearbox%contacts)
         if (.not. gearbox%contacts(m)%leads) cycle
         associate (contact => gearbox%contacts(m), pair => first_pair(gearbox, m, now%integers))
            if (opened(m) .and. .not. was_closed(m)) cycle
            if (opened(m)) call note(now%log, event_opened, contact, pair)
            if (.not. closing(m)) cycle
            if (rebounds(m)) call open_flank(gearbox, m, now%y, now%integers)
            call note(now%log, merge(event_impact, event_closed, rebounds(m)), contact, pair)
            if (.not. rebounds(m) .and. contact%elastic%restitution() > 0) call note(now%log, event_impacts_ended, contact, pair)
         end associate
      end do
      rebounded = rebounded .or. rebounds
      nothing = 0
      call settle_modes(gearbox, nothing, now, status) ! speeds have jumped
   end subroutine strike

   !> Close approaching flanks whose gap is already past its zero, since that zero will not be crossed again.
   subroutine close_approaching(gearbox, now, status)
      type(gearbox_t), intent(in) :: gearbox
      type(moment_t), intent(inout) :: now
      type(status_t), intent(inout) :: status
      real(wp) :: gap(2)
      integer :: m

      do m = 1, size(gearbox%contacts)
         if (.not. may_close(gearbox, m, now%integers)) cycle
         gap = gap_of(gearbox, m, now%y)
         if (is_past(gap(1), gearbox%contacts(m)) .and. gap(2) < 0) call close_flank(gearbox, m, now, status)
         if (has_failed(status)) return
      end do
   end subroutine close_approaching

   !> Open flanks that approach past the zero of their gap faster than the limit for impacts. Closed flanks of the same wheels were
   !> projected onto their constraints, which moved these flanks by rounding.
   pure function approach_past_zero(gearbox, y, integers) result(approach)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      logical :: approach(size(gearbox%contacts))
      real(wp) :: gap(2)
      integer :: m

      approach = .false.
      do m = 1, size(gearbox%contacts)
         if (.not. may_close(gearbox, m, integers)) cycle
         gap = gap_of(gearbox, m, y)
         approach(m) = is_past(gap(1), gearbox%contacts(m)) .and. -gap(2) > gearbox%contacts(m)%elastic%rest_velocity()
      end do
   end function approach_past_zero

   !> Whether a gap is past its zero by the changes at one instant. Farther past it an event was missed, which `check_modes`
   !> reports.
   pure logical function is_past(gap, contact)
      real(wp), intent(in) :: gap !! [m]
      type(tooth_contact_t), intent(in) :: contact

      is_past = -gap/contact%h_scale > past - tie .and. -gap/contact%h_scale < located
   end function is_past

   !> Open flanks that touch and part so slowly that they would not rebound from an approach at the same speed.
   pure function slow(gearbox, y, integers) result(is_slow)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      logical :: is_slow(size(gearbox%contacts))
      real(wp) :: gap(2)
      integer :: m

      is_slow = .false.
      do m = 1, size(gearbox%contacts)
         if (.not. may_close(gearbox, m, integers)) cycle
         gap = gap_of(gearbox, m, y)
         is_slow(m) = abs(gap(1)) <= located*gearbox%contacts(m)%h_scale &
                      .and. gap(2) >= 0 .and. gap(2) <= gearbox%contacts(m)%elastic%rest_velocity()
      end do
   end function slow

   !> Flanks that part but return before their gap exceeds the accuracy of event location, and flanks that overlap, approach and do
   !> not reverse before they overlap by as much. For flanks that were closed, rounding decides the direction of motion.
   subroutine come_back(gearbox, free, now, back, status)
      type(gearbox_t), intent(in) :: gearbox
      type(moment_t), intent(in) :: now
      logical, intent(in) :: free(:) !! flanks to be checked
      logical, intent(out) :: back(:)
      type(status_t), intent(inout) :: status
      real(wp) :: gap(2, size(gearbox%contacts)), rates(gearbox%n_states), q(n_local), local_rates(n_local), bend
      integer :: m

      back = .false.
      do m = 1, size(gearbox%contacts)
         if (.not. free(m)) cycle
         if (.not. may_close(gearbox, m, now%integers)) cycle
         gap(:, m) = gap_of(gearbox, m, now%y)
         back(m) = abs(gap(1, m)) <= located*gearbox%contacts(m)%h_scale .and. (gap(2, m) >= 0 .or. drifts(m))
      end do
      if (.not. any(back)) return
      call coupled_rates(gearbox, now%t, now%y, now%integers, now%reals, rates, status)
      if (has_failed(status)) return
      do m = 1, size(gearbox%contacts)
         if (.not. back(m)) cycle
         associate (contact => gearbox%contacts(m))
            call gearbox_local(gearbox, contact, now%y, q)
            call gearbox_local(gearbox, contact, rates, local_rates)
            bend = 2*rigid_acceleration(contact%pair, q, local_rates)*located*contact%h_scale
            back(m) = merge(gap(2, m)**2 <= -bend, gap(2, m)**2 > bend, gap(2, m) >= 0)
         end associate
      end do

   contains

      !> Whether flanks approach past the zero of their gap, which will not be crossed again, too slowly for an impact.
      pure logical function drifts(m)
         integer, intent(in) :: m

         drifts = is_past(gap(1, m), gearbox%contacts(m)) .and. -gap(2, m) <= gearbox%contacts(m)%elastic%rest_velocity()
      end function drifts

   end subroutine come_back

   !> Close touching flanks that hardly move, if this puts them under load; the others are unchanged. If none of them is loaded
   !> together with the others, they are tried one by one: with friction, one of them may part all others.
   subroutine hold(gearbox, held, now)
      type(gearbox_t), intent(in) :: gearbox
      logical, intent(inout) :: held(:) !! in: flanks to be tried; out: flanks that are now closed
      type(moment_t), intent(inout) :: now
      logical :: tried(size(held))
      integer :: m

      tried = held
      call hold_together(gearbox, held, now)
      do m = 1, size(held)
         if (any(held)) return
         if (.not. tried(m)) cycle
         held(m) = .true.
         call hold_together(gearbox, held, now)
      end do
   end subroutine hold

   !> `hold` for flanks that are tried together.
   !>
   !> Their gap rates and those of all closed flanks become 0, which dissipates energy. The forces then decide.
   subroutine hold_together(gearbox, held, now)
      type(gearbox_t), intent(in) :: gearbox
      logical, intent(inout) :: held(:) !! in: flanks to be tried; out: flanks that are now closed
      type(moment_t), intent(inout) :: now
      type(moment_t) :: trial
      type(status_t) :: status !! of a trial: if it has no solution, no flank is held
      integer :: nothing(gearbox%n_roots), m
      logical, dimension(size(gearbox%contacts)) :: rebounds, opened, closed, was_closed

      nothing = 0
      was_closed = closed_flanks(gearbox, now%integers)
      do while (any(held))
         trial = now
         trial%log%once = .true.
         do m = 1, size(held)
            if (held(m)) call close_flank(gearbox, m, trial, status)
         end do
         if (.not. has_failed(status)) call impact(gearbox, held, .true., trial, rebounds, opened, status)
         if (.not. has_failed(status)) call settle_modes(gearbox, nothing, trial, status)
         if (.not. has_failed(status)) &
            call set_multipliers(gearbox, trial%t, trial%y, trial%integers, trial%reals, opened, status)
         if (has_failed(status)) held = .false.
         closed = closed_flanks(gearbox, trial%integers)
         if (all(closed .or. .not. held)) exit
         held = held .and. closed
      end do
      if (.not. any(held)) return
      now = trial
      do m = 1, size(held)
         if (held(m)) call note(now%log, event_closed, gearbox%contacts(m), first_pair(gearbox, m, now%integers))
         if (held(m) .and. gearbox%contacts(m)%elastic%restitution() > 0) &
            call note(now%log, event_impacts_ended, gearbox%contacts(m), first_pair(gearbox, m, now%integers))
         if (was_closed(m) .and. .not. closed(m)) &
            call note(now%log, event_opened, gearbox%contacts(m), first_pair(gearbox, m, now%integers))
      end do
   end subroutine hold_together

   !> Whether a tooth contact is the leading one of an open rigid flank with a tooth pair on the path.
   pure logical function may_close(gearbox, leader, integers)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: leader, integers(gearbox%n_integers)

      may_close = gearbox%contacts(leader)%leads
      if (.not. may_close) return
      may_close = .not. is_closed(gearbox, leader, integers) .and. pairs_with(gearbox, leader, flanks_open, integers) > 0
   end function may_close

   !> Gap of a rigid flank and its rate [m], [m/s].
   pure function gap_of(gearbox, leader, y) result(gap)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: leader
      real(wp), intent(in) :: y(gearbox%n_states)
      real(wp) :: gap(2), q(n_local)

      call gearbox_local(gearbox, gearbox%contacts(leader), y, q)
      gap = rigid_constraint(gearbox%contacts(leader)%pair, q)
   end function gap_of

   !> Close the tooth pairs of an open flank that are on the path.
   subroutine close_flank(gearbox, leader, now, status)
      type(gearbox_t), intent(in) :: gearbox
      type(moment_t), intent(inout) :: now
      integer, intent(in) :: leader
      type(status_t), intent(inout) :: status
      type(contact_state) :: at(size(gearbox%contacts))
      logical :: fired(n_root_kinds), known(size(gearbox%contacts))
      integer :: m

      known = .false.
      fired = .false.
      fired(root_of%contact) = .true.
      do m = leader, leader + gearbox%contacts(leader)%n_slots - 1
         if (flanks_of(gearbox%contacts(m), now%integers) == flanks_open) &
            call contact_event(gearbox, m, fired, now, known, at, status)
      end do
   end subroutine close_flank

end module evl_rigid_events
