!> What changes in one tooth contact when something happens to it: its tooth pair, contact mode and friction branch.
module evl_contact_events
   use evl_closed_form, only: closed_form_line, place_radii, points_from_closed_form
   use evl_contact_modes, only: mode_at
   use evl_contact_point, only: contact_point
   use evl_contact_roots, only: contact_root_direction, contact_roots, find_sides
   use evl_discrete_state, only: flanks_of, gearbox_mode, gearbox_store_mode, pairs_loaded
   use evl_event_log, only: event_log, event_of_root, note
   use evl_flank_deviation, only: zone_none, zone_root, zone_tip
   use evl_gearbox, only: gearbox_local, gearbox_t, i_turns
   use evl_kinds, only: wp
   use evl_local_variables, only: i_theta, n_local, n_track
   use evl_root_kinds, only: moves_friction, moves_pair, moves_zone_a, moves_zone_b, n_root_kinds, n_sides, root_of, root_rows
   use evl_status, only: code_no_solution, fail, quantity, status_t, subject_mesh
   use evl_tangent_line, only: tangent_line_t
   use evl_tooth_contact, only: contact_energy, contact_mode, flanks_apart, flanks_loaded, flanks_off, flanks_open, &
                                flanks_unloaded, locate_contact, nominal_rho, settle_friction, settle_zones, tooth_contact_t, &
                                touches, tracking_closed_form, unclipped_force
   implicit none (type, external)
   private

   public :: contact_event, point_of_contact, parts, roots_of_contact

   logical, parameter :: moves_zone(n_root_kinds) = root_rows%moves == moves_zone_a .or. root_rows%moves == moves_zone_b
   real(wp), parameter :: grazing = 1.0e-6_wp !! penetration over its scale: below it flanks that part have lost contact

contains

   !> Local variables and contact point of a tooth contact.
   !> Of a pair off the path of contact the radii of curvature are all that closed form gives: they say when a pair enters.
   pure subroutine point_of_contact(gearbox, index, y, integers, mode, q, rho_a0, point)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index, integers(:)
      real(wp), intent(in) :: y(:)
      type(contact_mode), intent(in) :: mode
      real(wp), intent(out) :: q(n_local), rho_a0
      type(contact_point), intent(out) :: point
      type(tangent_line_t) :: line

      associate (contact => gearbox%contacts(index))
         call gearbox_local(gearbox, contact, y, q)
         rho_a0 = nominal_rho(contact, y(i_theta), integers(i_turns), mode%tooth_pair)
         if (mode%flanks == flanks_off .and. contact%tracking == tracking_closed_form) then
            line = contact%rest_line
            if (.not. contact%axles_rest) call closed_form_line(contact%pair, q, line)
            call place_radii(contact%pair, rho_a0, q, line, point)
         else
            call locate_contact(contact, mode, rho_a0, q, point)
         end if
      end associate
   end subroutine point_of_contact

   !> The mode, the point and the root functions of one tooth contact.
   subroutine roots_of_contact(gearbox, index, y, integers, reals, mode, point, roots, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index, integers(:)
      real(wp), intent(in) :: y(:), reals(:)
      type(contact_mode), intent(out) :: mode
      type(contact_point), intent(out) :: point
      real(wp), intent(out) :: roots(gearbox%contacts(index)%n_roots)
      type(status_t), intent(inout) :: status
      real(wp) :: q(n_local), rho_a0

      mode = gearbox_mode(gearbox, index, integers, reals)
      call point_of_contact(gearbox, index, y, integers, mode, q, rho_a0, point)
      call contact_roots(gearbox%contacts(index), mode, rho_a0, q, point, roots, status)
   end subroutine roots_of_contact

   !> What happened to one tooth contact.
   subroutine contact_event(gearbox, m, fired, y, integers, reals, log, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m
      logical, intent(in) :: fired(n_root_kinds) !! by kind
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(event_log), intent(inout) :: log
      type(status_t), intent(inout) :: status
      type(contact_point) :: point
      type(contact_mode) :: mode
      real(wp) :: q(n_local), rho_a0, energy
      logical :: changed, entered, forward
      logical :: before(n_sides)

      mode = gearbox_mode(gearbox, m, integers, reals)
      associate (contact => gearbox%contacts(m))
         before = live_sides(contact, mode)
         changed = any(fired .and. root_rows%moves == moves_pair)
         forward = fired(root_of%forward) .or. fired(root_of%switch)
         entered = changed .and. mode%flanks == flanks_off
         energy = energy_of(gearbox, m, mode, y, integers)
         if (changed) call change_pair(contact, forward, mode, log)
         if (contact%deviates) call change_zones(gearbox, m, changed, fired, y, integers, mode, log)
         call point_of_contact(gearbox, m, y, integers, mode, q, rho_a0, point)
         if (entered) then
            call enter(gearbox, m, integers, point, mode, log, status)
         else if (mode%flanks /= flanks_off) then
            if (any(fired .and. root_rows%moves == moves_friction)) call change_friction(contact, fired, mode, log)
            call change_contact(contact, fired, point, mode, log)
         end if
         ! the radii of curvature jump at a switch, and friction starts anew with a contact
         if (mode%flanks == flanks_loaded .and. (changed .or. fired(root_of%contact) .or. fired(root_of%force))) &
            mode%friction = settle_friction(contact, point)
         ! what comes or goes with the flanks counts in the balance as negative loss or as loss
         y(gearbox%i_dissipated) = y(gearbox%i_dissipated) + (energy - energy_of(gearbox, m, mode, y, integers))
         call change_sides(contact, fired, mode, log)
         if (fired(root_of%apart)) call change_distance(contact, q, mode, y, log)
         call begin_sides(contact, before, point, mode, status)
      end associate
      call gearbox_store_mode(gearbox, m, mode, integers, reals)
   end subroutine contact_event

   !> Elastic energy of a tooth contact [J]. Flanks that overlap may take it away at once, or bring it: pairs that leave or enter
   !> the path under load, and flanks of another pair that deviate in another way.
   pure real(wp) function energy_of(gearbox, m, mode, y, integers) result(energy)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m, integers(:)
      type(contact_mode), intent(in) :: mode
      real(wp), intent(in) :: y(gearbox%n_states)
      type(contact_point) :: point
      real(wp) :: q(n_local), rho_a0

      energy = 0
      associate (contact => gearbox%contacts(m))
         if (.not. touches(mode) .or. contact%rigid) return
         if (contact%handover .and. .not. contact%deviates) return ! the next pair has the same energy
         call point_of_contact(gearbox, m, y, integers, mode, q, rho_a0, point)
         if (abs(point%h) > grazing*contact%h_scale) energy = contact_energy(contact, mode, point)
      end associate
   end function energy_of

   !> An end of the path, or a pitch, is passed: the next tooth pair takes the slot, or the one before.
   pure subroutine change_pair(contact, forward, mode, log)
      type(tooth_contact_t), intent(in) :: contact
      logical, intent(in) :: forward !! at the end where pairs leave in the nominal sense of rotation
      type(contact_mode), intent(inout) :: mode
      type(event_log), intent(inout) :: log

      if (contact%handover) then
         ! both tracked points move by one base pitch along e, and so does rho_A0: turn, zeta, dr, lambda and mu stay
         mode%tooth_pair = mode%tooth_pair + merge(1, -1, forward)
         call note(log, event_at(contact, mode, merge(root_of%switch, root_of%switch_back, forward)), contact, mode%tooth_pair)
      else if (mode%flanks == flanks_off) then
         if (forward) mode%tooth_pair = mode%tooth_pair - contact%n_slots
         call note(log, event_at(contact, mode, root_of%forward), contact, mode%tooth_pair)
         mode%flanks = flanks_open
      else
         call note(log, event_at(contact, mode, root_of%forward), contact, mode%tooth_pair)
         if (forward) mode%tooth_pair = mode%tooth_pair + contact%n_slots
         mode = contact_mode(tooth_pair=mode%tooth_pair, flanks=flanks_off, sides=mode%sides)
      end if
   end subroutine change_pair

   !> The mode of a tooth pair that enters the path: flanks that overlap push at once, unless the damper pulls more.
   subroutine enter(gearbox, m, integers, point, mode, log, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m, integers(:)
      type(contact_point), intent(in) :: point
      type(contact_mode), intent(inout) :: mode
      type(event_log), intent(inout) :: log
      type(status_t), intent(inout) :: status

      associate (contact => gearbox%contacts(m))
         if (contact%rigid) then
            if (pairs_loaded(gearbox, m, integers) > 0) then
               mode%flanks = flanks_loaded
            else if (point%h > grazing*contact%h_scale) then
               call fail(status, code_no_solution, "a tooth pair enters a rigid contact with flanks that overlap by " &
                         //quantity(point%h, "m")//": no other pair was on the path to keep them apart", subject_mesh, &
                         contact%mesh, "contact.law")
            end if
         else if (flank_rests(gearbox, m, integers)) then
            mode%flanks = flanks_apart
         else
            call mode_at(contact, point, mode, status)
            if (mode%flanks == flanks_unloaded) call note(log, root_rows(root_of%force)%falls, contact, mode%tooth_pair)
         end if
      end associate
   end subroutine enter

   !> Whether the tracking of a flank rests because its tooth pairs are too far apart.
   pure logical function flank_rests(gearbox, m, integers)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m, integers(:)
      integer :: i

      associate (first => m - gearbox%contacts(m)%slot, n => gearbox%contacts(m)%n_slots)
         flank_rests = any([(flanks_of(gearbox%contacts(i), integers) == flanks_apart, i=first, first + n - 1)])
      end associate
   end function flank_rests

   !> The contact passed the border of a relief, or lies on the flanks of another pair.
   subroutine change_zones(gearbox, m, changed, fired, y, integers, mode, log)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m, integers(:)
      logical, intent(in) :: changed, fired(:)
      real(wp), intent(in) :: y(:)
      type(contact_mode), intent(inout) :: mode
      type(event_log), intent(inout) :: log
      type(contact_point) :: point
      real(wp) :: q(n_local), rho_a0

      associate (contact => gearbox%contacts(m))
         if (changed) then
            call point_of_contact(gearbox, m, y, integers, mode, q, rho_a0, point)
            call settle_zones(contact, point, mode)
         else if (any(fired .and. moves_zone)) then
            if (fired(root_of%tip_a)) mode%zone_a = merge(zone_none, zone_tip, mode%zone_a == zone_tip)
            if (fired(root_of%root_a)) mode%zone_a = merge(zone_none, zone_root, mode%zone_a == zone_root)
            if (fired(root_of%tip_b)) mode%zone_b = merge(zone_none, zone_tip, mode%zone_b == zone_tip)
            if (fired(root_of%root_b)) mode%zone_b = merge(zone_none, zone_root, mode%zone_b == zone_root)
            call note(log, root_rows(findloc(fired .and. moves_zone, .true., dim=1))%rises, contact, mode%tooth_pair)
         end if
      end associate
   end subroutine change_zones

   !> The sliding velocity passed an end of the linear part of the friction law.
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

   !> A quantity passed a border that has sides. It deserves an event where its row has a text.
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

   !> Which kinds with sides have a meaning in a mode, as far as they are noted.
   pure function live_sides(contact, mode) result(live)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      logical :: live(n_sides)
      integer :: i

      do i = 1, n_sides
         associate (kind => n_root_kinds - n_sides + i)
            live(i) = root_rows(kind)%text /= ""
            if (live(i)) live(i) = contact_root_direction(contact, mode, kind) /= 0
         end associate
      end do
   end function live_sides

   !> Sides that begin to have a meaning are found: nothing has passed a border.
   subroutine begin_sides(contact, before, point, mode, status)
      type(tooth_contact_t), intent(in) :: contact
      logical, intent(in) :: before(n_sides) !! `live_sides` of the mode before
      type(contact_point), intent(in) :: point
      type(contact_mode), intent(inout) :: mode
      type(status_t), intent(inout) :: status
      type(contact_mode) :: found
      logical :: begins(n_sides)
      real(wp) :: force

      begins = live_sides(contact, mode) .and. .not. before
      if (.not. any(begins)) return
      force = 0
      if (touches(mode)) call unclipped_force(contact, mode, point, force, status)
      found = mode
      call find_sides(contact, point, force, found)
      where (begins) mode%sides = found%sides
   end subroutine begin_sides

   !> Closing, opening, and the clip of the force.
   pure subroutine change_contact(contact, fired, point, mode, log)
      type(tooth_contact_t), intent(in) :: contact
      logical, intent(in) :: fired(:)
      type(contact_point), intent(in) :: point
      type(contact_mode), intent(inout) :: mode
      type(event_log), intent(inout) :: log

      select case (mode%flanks)
      case (flanks_open)
         if (.not. fired(root_of%contact)) return
         mode%flanks = flanks_loaded
         mode%v0 = max(point%h_dot, 0.0_wp)
         if (contact%rigid) return ! an impact decides
         call note(log, root_rows(root_of%contact)%rises, contact, mode%tooth_pair)
      case (flanks_loaded, flanks_unloaded)
         if (fired(root_of%contact) .or. (fired(root_of%force) .and. parts(contact, point))) then
            mode%flanks = flanks_open
            call note(log, root_rows(root_of%contact)%falls, contact, mode%tooth_pair)
         else if (fired(root_of%force)) then
            call note(log, event_at(contact, mode, root_of%force), contact, mode%tooth_pair)
            mode%flanks = merge(flanks_unloaded, flanks_loaded, mode%flanks == flanks_loaded)
         end if
      end select
   end subroutine change_contact

   !> Whether the flanks lose contact at this instant: force and penetration vanish together, which of them first is rounding.
   pure logical function parts(contact, point)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_point), intent(in) :: point

      parts = point%h < grazing*contact%h_scale .and. (point%h_dot < 0 .or. contact%rigid)
   end function parts

   !> The event that a root function of a contact is which passes zero in a mode.
   pure integer function event_at(contact, mode, kind) result(event)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      integer, intent(in) :: kind

      event = root_rows(kind)%falls
      if (contact_root_direction(contact, mode, kind) > 0) event = root_rows(kind)%rises
   end function event_at

   !> Tracking ends where the flanks are too far apart for two of their points to face each other, and begins anew when they
   !> come near.
   pure subroutine change_distance(contact, q, mode, y, log)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: q(n_local)
      type(contact_mode), intent(inout) :: mode
      real(wp), intent(inout) :: y(:)
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
