!> Event handling of one tooth contact: changes of its tooth pair, contact mode and friction branch.
module evl_contact_events
   use evl_closed_form, only: points_from_closed_form
   use evl_contact_modes, only: mode_at
   use evl_contact_roots, only: contact_root_direction, contact_roots, find_sides, is_past
   use evl_contacts_at_state, only: flank_cache, look_at, position_contact
   use evl_damping_law, only: no_viscous
   use evl_discrete_state, only: gearbox_store_mode, pairs_with, take_mode
   use evl_elastic_law, only: no_elastic
   use evl_event_kinds, only: event_closed, event_edge_closed, event_edge_opened, event_opened
   use evl_event_log, only: event_log, event_of_root, moment_t, note
   use evl_flank, only: flank_t
   use evl_flank_limits, only: check_edge
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_local_variables, only: n_local, n_track
   use evl_pair_point, only: by_a, by_b
   use evl_pair_sequence, only: next_pair
   use evl_root_kinds, only: live_bends_a, live_bends_b, moves_friction, moves_pair, moves_zone_a, moves_zone_b, n_root_kinds, &
                             n_sides, root_of, root_rows, tie
   use evl_status, only: code_no_solution, fail, has_failed, quantity, status_t, subject_mesh
   use evl_tooth_contact, only: contact_mode, contact_state, edge_wheel, flanks_apart, flanks_loaded, flanks_off, flanks_open, &
                                flanks_unloaded, line_length, settle_friction, settle_zones, tooth_contact_t, touches, unclipped
   use evl_zone_changes, only: change_zone
   implicit none (type, external)
   private

   public :: contact_event, parts, root_of_contact, roots_of_contact

   logical, parameter :: moves_zone(n_root_kinds) = root_rows%moves == moves_zone_a .or. root_rows%moves == moves_zone_b
   real(wp), parameter :: jump = 1.0e-3_wp    !! overlap over its scale; the overlap of a gap that closes continuously is smaller
   real(wp), parameter :: grazing = 1.0e-6_wp !! penetration over its scale; below it parting flanks have lost contact

contains

   !> Root functions of a tooth contact with their directions; evaluates all contacts that its force depends on.
   subroutine roots_of_contact(gearbox, m, y, integers, reals, known, at, directions, roots, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m, integers(gearbox%n_integers)
      real(wp), intent(in) :: y(gearbox%n_states), reals(size(gearbox%contacts))
      logical, intent(inout) :: known(*)          !! [contacts of the gearbox] whether `at` is complete for this state
      type(contact_state), intent(inout) :: at(*) !! [contacts of the gearbox]
      integer, intent(out) :: directions(gearbox%contacts(m)%n_roots)
      real(wp), intent(out) :: roots(gearbox%contacts(m)%n_roots)
      type(status_t), intent(inout) :: status
      integer :: first, last

      associate (flank => gearbox%flanks(gearbox%contacts(m)%i_flank)%flank)
         if (.not. known(m)) then
            call flank%loaded_pairs_range(m, first, last)
            call look_at(gearbox, first, last, y, integers, reals, at, status)
            known(first:last) = .not. has_failed(status)
         end if
         call contact_roots(flank, gearbox%contacts(m), at(m), directions, roots)
      end associate
   end subroutine roots_of_contact

   !> One of its root functions; the others may be undefined.
   subroutine root_of_contact(gearbox, m, i, y, integers, reals, roots, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m, i !! contact, index of the root function in it
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: y(gearbox%n_states), reals(size(gearbox%contacts))
      real(wp), intent(out) :: roots(gearbox%contacts(m)%n_roots)
      type(status_t), intent(inout) :: status
      type(contact_state) :: at(size(gearbox%contacts))
      type(flank_cache) :: cache
      logical :: known(size(gearbox%contacts))
      integer :: directions(gearbox%contacts(m)%n_roots)

      known = .false.
      if (.not. any(gearbox%contacts(m)%roots(i) == [root_of%contact, root_of%force])) then ! only the position matters
         call take_mode(gearbox, m, integers, reals, at(m)%mode)
         call position_contact(gearbox, m, y, integers, cache, at)
         at(m)%elastic = no_elastic
         at(m)%viscous = no_viscous
         known(m) = .true.
      end if
      call roots_of_contact(gearbox, m, y, integers, reals, known, at, directions, roots, status)
   end subroutine root_of_contact

   !> Apply an event to one tooth contact.
   subroutine contact_event(gearbox, m, fired, now, known, at, status)
      type(gearbox_t), intent(in) :: gearbox
      type(moment_t), intent(inout) :: now
      integer, intent(in) :: m
      logical, intent(in) :: fired(n_root_kinds) !! by kind
      logical, intent(inout) :: known(:)          !! [contacts] as in `roots_of_contact`; all false on return
      type(contact_state), intent(inout) :: at(*) !! [contacts of the gearbox]
      type(status_t), intent(inout) :: status
      real(wp) :: energy
      logical :: changed, closes, entered, forward
      logical :: before(n_sides)
      type(flank_cache) :: cache
      integer :: first, last

      call gearbox%flanks(gearbox%contacts(m)%i_flank)%flank%loaded_pairs_range(m, first, last)
      if (.not. known(m)) call look_at(gearbox, first, last, now%y, now%integers, now%reals, at, status)
      known = .false.
      associate (contact => gearbox%contacts(m), mode => at(m)%mode)
         before = live_sides(contact, mode)
         changed = any(fired .and. root_rows%moves == moves_pair)
         forward = fired(root_of%forward) .or. fired(root_of%switch)
         entered = changed .and. mode%flanks == flanks_off
         energy = energy_of(gearbox, m, first, last, at)
         if (changed .and. contact%has_edges .and. touches(mode)) then
            call past_reach(gearbox, m, at(m), status)
            return
         end if
         if (changed) call change_pair(contact, forward, mode, now%log)
         if (contact%deviates) call change_zones(gearbox, m, changed, fired, now%y, now%integers, at, now%log)
         if (changed .and. .not. contact%deviates) call position_contact(gearbox, m, now%y, now%integers, cache, at)
         if (entered) then
            call enter(gearbox, m, first, last, now%integers, at, now%log, status)
            if (contact%has_edges .and. touches(mode)) call past_reach(gearbox, m, at(m), status)
         else if (mode%flanks /= flanks_off) then
            if (any(fired .and. root_rows%moves == moves_friction)) call change_friction(contact, fired, mode, now%log)
            closes = .not. touches(mode)
            if (touches(mode)) call check_edge(contact, at(m), status)
            call change_contact(gearbox%flanks(contact%i_flank)%flank, contact, fired, at(m), now%log)
            ! a gap closes by a jump only if an edge has just left the mate's base circle: check_edge then reports an error
            if (closes .and. touches(mode) .and. at(m)%overlap > jump*contact%h_scale) at(m)%edge%exists = .false.
            if (touches(mode) .and. .not. has_failed(status)) call check_edge(contact, at(m), status)
         end if
         ! the radii of curvature jump at a switch, and friction restarts with a contact
         if (mode%flanks == flanks_loaded .and. (changed .or. fired(root_of%contact) .or. fired(root_of%force))) &
            mode%friction = settle_friction(contact, at(m)%point)
         call gearbox%flanks(contact%i_flank)%flank%laws(gearbox%contacts, first, last, at, status)
         ! energy jumps with the flanks; gains and losses enter the balance as negative and positive loss
         now%y(gearbox%i_dissipated) = now%y(gearbox%i_dissipated) + (energy - energy_of(gearbox, m, first, last, at))
         call change_sides(contact, fired, mode, now%log)
         if (fired(root_of%apart)) call change_distance(contact, at(m)%q, mode, now%y, now%log)
         call begin_sides(gearbox, m, before, at)
         call gearbox_store_mode(gearbox, m, mode, now%integers, now%reals)
      end associate
   end subroutine contact_event

   !> Fail because a pair leaves the reach of its edges under load: no other pair could take over its force.
   subroutine past_reach(gearbox, m, at, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m
      type(contact_state), intent(in) :: at
      type(status_t), intent(inout) :: status

      associate (contact => gearbox%contacts(m))
         call fail(status, code_no_solution, "a tooth pair carries "//quantity(unclipped(at), "N")//" with a tip edge " &
                   //quantity(gearbox%flanks(contact%i_flank)%flank%reach, "")//" pitches off its path of contact: the teeth" &
                   //" deflect too much for their size; reduce the load", subject_mesh, contact%mesh, "edge_contact")
      end associate
   end subroutine past_reach

   !> Elastic energy of a tooth contact and the contacts that its force depends on [J]. It may jump at an event: when pairs leave or
   !> enter the path under load, or when the flanks of the next pair have other deviations or compliance.
   pure real(wp) function energy_of(gearbox, m, first, last, at) result(energy)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m, first, last
      type(contact_state), intent(in) :: at(*) !! with the results of the laws

      energy = 0
      associate (contact => gearbox%contacts(m), flank => gearbox%flanks(gearbox%contacts(m)%i_flank)%flank)
         if (contact%has_edges) return ! no jumps
         if (contact%handover .and. .not. (contact%deviates .or. flank%bends)) return ! the next pair has the same energy
         if (first == last .and. .not. touches(at(m)%mode)) return
         if (first == last .and. abs(at(m)%point%h) <= grazing*contact%h_scale) return
         call flank%add_energy(gearbox%contacts, first, last, at, energy)
      end associate
   end function energy_of

   !> Change to the next or the previous tooth pair after an end of the path, or a pitch, is passed.
   pure subroutine change_pair(contact, forward, mode, log)
      type(tooth_contact_t), intent(in) :: contact
      logical, intent(in) :: forward !! at the end where pairs leave in the nominal sense of rotation
      type(contact_mode), intent(inout) :: mode
      type(event_log), intent(inout) :: log
      integer :: next

      next = next_pair(contact, mode, forward)
      if (contact%handover) then
         ! both tracked points move by one base pitch along e, and so does rho_A0: turn, zeta, dr, lambda and mu do not change
         mode%tooth_pair = next
         call note(log, event_at(contact, mode, merge(root_of%switch, root_of%switch_back, forward)), contact, mode%tooth_pair)
      else if (mode%flanks == flanks_off) then
         mode%tooth_pair = next
         call note(log, event_at(contact, mode, root_of%forward), contact, mode%tooth_pair)
         mode%flanks = flanks_open
      else
         call note(log, event_at(contact, mode, root_of%forward), contact, mode%tooth_pair)
         mode = contact_mode(next, flanks_off, 0, 0, 0, mode%sides, 1.0_wp, 0.0_wp)
      end if
   end subroutine change_pair

   !> Mode of a tooth pair that enters the path: overlapping flanks are loaded at once, unless the damper pulls more.
   subroutine enter(gearbox, m, first, last, integers, at, log, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m, first, last, integers(gearbox%n_integers)
      type(contact_state), intent(inout) :: at(*)
      type(event_log), intent(inout) :: log
      type(status_t), intent(inout) :: status

      associate (contact => gearbox%contacts(m), mode => at(m)%mode, flank => gearbox%flanks(gearbox%contacts(m)%i_flank)%flank)
         if (contact%rigid) then
            if (pairs_with(gearbox, m, flanks_loaded, integers) > 0) then
               mode%flanks = flanks_loaded
            else if (at(m)%point%h > grazing*contact%h_scale) then
               call fail(status, code_no_solution, "a tooth pair enters a rigid contact with flanks that overlap by " &
                         //quantity(at(m)%point%h, "m")//": no other pair on the path separated them", subject_mesh, &
                         contact%mesh, "contact.law")
            end if
         else if (pairs_with(gearbox, m, flanks_apart, integers) > 0) then ! tracking is off
            mode%flanks = flanks_apart
         else
            call mode_at(flank, gearbox%contacts, m, first, last, at, status)
            if (mode%flanks == flanks_unloaded) call note(log, root_rows(root_of%force)%falls, contact, mode%tooth_pair)
         end if
      end associate
   end subroutine enter

   !> Change the zones after the contact passed a border, or for the flanks of another pair. A zone may be empty: a relief shorter
   !> than the reach of its corner ends where it begins. The contact is then also past the next border, and crosses both here.
   subroutine change_zones(gearbox, m, changed, fired, y, integers, at, log)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m, integers(gearbox%n_integers)
      logical, intent(in) :: changed, fired(n_root_kinds)
      real(wp), intent(in) :: y(gearbox%n_states)
      type(contact_state), intent(inout) :: at(*)
      type(event_log), intent(inout) :: log
      type(flank_cache) :: cache
      logical, dimension(n_root_kinds) :: crossed, passed
      real(wp) :: roots(n_root_kinds)
      integer :: directions(n_root_kinds), event, i

      associate (contact => gearbox%contacts(m), mode => at(m)%mode)
         if (changed) then
            call position_contact(gearbox, m, y, integers, cache, at)
            call settle_zones(contact, line_length(contact, at(m)%q), at(m)%point, mode)
            call position_contact(gearbox, m, y, integers, cache, at)
            return
         end if
         crossed = .false.
         passed = fired .and. moves_zone
         do while (any(passed))
            crossed = crossed .or. passed
            event = event_at(contact, mode, findloc(passed, .true., dim=1, back=.true.))
            call change_zone(contact%deviation_a, contact%tips(by_a), passed([root_of%tip_a, root_of%tip_corner_a]), &
                             passed([root_of%root_a, root_of%root_corner_a]), passed(root_of%end_a:root_of%edge_a), mode%zone_a)
            call change_zone(contact%deviation_b, contact%tips(by_b), passed([root_of%tip_b, root_of%tip_corner_b]), &
                             passed([root_of%root_b, root_of%root_corner_b]), passed(root_of%end_b:root_of%edge_b), mode%zone_b)
            call note(log, event, contact, mode%tooth_pair)
            call position_contact(gearbox, m, y, integers, cache, at)
            call contact_roots(gearbox%flanks(contact%i_flank)%flank, contact, at(m), directions, roots)
            passed = .false.
            do i = 1, contact%n_roots
               passed(contact%roots(i)) = is_past(directions(i), roots(i), -tie)
            end do
            passed = passed .and. moves_zone .and. .not. crossed
         end do
      end associate
   end subroutine change_zones

   !> Change the friction branch after the sliding velocity passed an end of the linear part of the friction law.
   pure subroutine change_friction(contact, fired, mode, log)
      type(tooth_contact_t), intent(in) :: contact
      logical, intent(in) :: fired(:)
      type(contact_mode), intent(inout) :: mode
      type(event_log), intent(inout) :: log
      logical :: is_high

      is_high = mode%friction == 1 .or. (mode%friction == 0 .and. fired(root_of%friction_high))
      call note(log, event_at(contact, mode, merge(root_of%friction_high, root_of%friction_low, is_high)), contact, mode%tooth_pair)
      mode%friction = merge(merge(1, -1, is_high), 0, mode%friction == 0)
   end subroutine change_friction

   !> Change the side after a quantity passed its border. An event is logged if the row of the kind has a text.
   pure subroutine change_sides(contact, fired, mode, log)
      type(tooth_contact_t), intent(in) :: contact
      logical, intent(in) :: fired(:)
      type(contact_mode), intent(inout) :: mode
      type(event_log), intent(inout) :: log
      integer :: i, kind

      do i = 1, n_sides
         kind = n_root_kinds - n_sides + i
         if (.not. fired(kind)) cycle
         mode%sides(i) = merge(-1, 1, mode%sides(i) > 0)
         if (root_rows(kind)%text /= "") call note(log, event_of_root(kind), contact, mode%tooth_pair)
      end do
   end subroutine change_sides

   !> Kinds with sides that are active in a mode; only those that are logged or are positions on a flank.
   pure function live_sides(contact, mode) result(live)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      logical :: live(n_sides)
      integer :: i

      do i = 1, n_sides
         associate (kind => n_root_kinds - n_sides + i)
            live(i) = root_rows(kind)%text /= "" .or. any(root_rows(kind)%live == [live_bends_a, live_bends_b])
            if (live(i)) live(i) = contact_root_direction(contact, mode, kind) /= 0
         end associate
      end do
   end function live_sides

   !> Determine the sides of kinds that become active; no border has been crossed.
   subroutine begin_sides(gearbox, m, before, at)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m
      logical, intent(in) :: before(n_sides) !! `live_sides` of the previous mode
      type(contact_state), intent(inout) :: at(*)
      logical :: begins(n_sides)
      integer :: sides(n_sides)

      associate (flank => gearbox%flanks(gearbox%contacts(m)%i_flank)%flank, mode => at(m)%mode)
         begins = live_sides(gearbox%contacts(m), mode) .and. .not. before
         if (.not. any(begins)) return
         sides = mode%sides
         call find_sides(flank, gearbox%contacts(m), at(m))
         where (.not. begins) mode%sides = sides
      end associate
   end subroutine begin_sides

   !> Change the mode at closing, opening, and clipping of the force.
   pure subroutine change_contact(flank, contact, fired, at, log)
      class(flank_t), intent(in) :: flank
      type(tooth_contact_t), intent(in) :: contact
      logical, intent(in) :: fired(:)
      type(contact_state), intent(inout) :: at
      type(event_log), intent(inout) :: log

      associate (mode => at%mode)
         select case (mode%flanks)
         case (flanks_open)
            if (.not. fired(root_of%contact)) return
            mode%flanks = flanks_loaded
            mode%v0 = max(at%point%h_dot, 0.0_wp)
            if (contact%rigid) return ! the impact decides
            call note(log, merge(event_edge_closed, event_closed, edge_wheel(mode) > 0), contact, mode%tooth_pair)
         case (flanks_loaded, flanks_unloaded)
            if (fired(root_of%contact) .or. (fired(root_of%force) .and. parts(flank, contact, at))) then
               mode%flanks = flanks_open
               call note(log, merge(event_edge_opened, event_opened, edge_wheel(mode) > 0), contact, mode%tooth_pair)
            else if (fired(root_of%force)) then
               call note(log, event_at(contact, mode, root_of%force), contact, mode%tooth_pair)
               mode%flanks = merge(flanks_unloaded, flanks_loaded, mode%flanks == flanks_loaded)
            end if
         end select
      end associate
   end subroutine change_contact

   !> Whether the flanks lose contact now. Force and penetration vanish together; rounding decides which one is first.
   !> If a gap opens so slowly that typical forces may close it at once, it does not count as open. A later opening is still
   !> detected, but a closing before the detected opening would be missed.
   !> With coupled pairs, other pairs of the flank also open and close the gap. Its own rate is then not conclusive, and the overlap
   !> alone decides.
   pure logical function parts(flank, contact, at)
      class(flank_t), intent(in) :: flank
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      real(wp), parameter :: strong = 100 !! twice the possible accelerations over the acceleration by the reference force

      parts = at%overlap < grazing*contact%h_scale .and. (at%point%h_dot < 0 .or. contact%rigid)
      if (.not. contact%rigid) &
         parts = parts .and. (at%point%h_dot/contact%rate_scale)**2 > strong*at%overlap/contact%h_scale
      if (flank%couples) parts = at%overlap <= 0
   end function parts

   !> Event kind of a root function that passes zero in a mode.
   pure integer function event_at(contact, mode, kind) result(event)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      integer, intent(in) :: kind

      event = root_rows(kind)%falls
      if (contact_root_direction(contact, mode, kind) > 0) event = root_rows(kind)%rises
   end function event_at

   !> Stop tracking when the flanks are too far apart for two of their points to face each other, and restart it when they are near.
   pure subroutine change_distance(contact, q, mode, y, log)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: q(n_local)
      type(contact_mode), intent(inout) :: mode
      real(wp), intent(inout) :: y(*)
      type(event_log), intent(inout) :: log

      if (touches(mode)) return
      call note(log, event_at(contact, mode, root_of%apart), contact, mode%tooth_pair)
      if (mode%flanks == flanks_apart) then
         mode%flanks = flanks_open
         call points_from_closed_form(contact%pair, q, y(contact%i_track:contact%i_track + n_track - 1))
      else if (mode%flanks == flanks_open) then
         mode%flanks = flanks_apart
      end if
   end subroutine change_distance

end module evl_contact_events
