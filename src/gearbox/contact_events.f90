!> What changes in one tooth contact when something happens to it: its tooth pair, contact mode and friction branch.
module evl_contact_events
   use evl_closed_form, only: closed_form_line, place_radii, points_from_closed_form
   use evl_contact_point, only: contact_point
   use evl_contact_roots, only: contact_roots, root_apart, root_back, root_borders_a, root_borders_b, root_contact, root_force, &
                                root_forward, root_friction_high, root_friction_low, root_side
   use evl_event_kinds, only: event_apart, event_border, event_closed, event_entered, event_left, event_log, event_near, &
                              event_opened, event_returned, event_sliding_began, event_sliding_ended, event_switch, &
                              event_switch_back, event_vanished, note
   use evl_flank_deviation, only: zone_none, zone_root, zone_tip
   use evl_gearbox, only: gearbox_local, gearbox_mode, gearbox_store_mode, gearbox_t, i_turns, pairs_loaded
   use evl_kinds, only: wp
   use evl_local_variables, only: i_theta, n_local, n_track
   use evl_status, only: code_no_solution, fail, has_failed, quantity, status_t, subject_mesh
   use evl_tangent_line, only: tangent_line_t
   use evl_tooth_contact, only: contact_energy, contact_mode, flanks_apart, flanks_loaded, flanks_off, flanks_open, &
                                flanks_unloaded, locate_contact, nominal_rho, settle_friction, settle_zones, tooth_contact_t, &
                                touches, tracking_closed_form
   implicit none (type, external)
   private

   public :: contact_event, point_of_contact, parts, roots_of_contact

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
      logical, intent(in) :: fired(:)
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(event_log), intent(inout) :: log
      type(status_t), intent(inout) :: status
      type(contact_point) :: point
      type(contact_mode) :: mode
      real(wp) :: q(n_local), rho_a0, energy
      logical :: changed, entered

      mode = gearbox_mode(gearbox, m, integers, reals)
      associate (contact => gearbox%contacts(m))
         changed = fired(root_forward) .or. fired(root_back)
         entered = changed .and. mode%flanks == flanks_off
         energy = energy_of(gearbox, m, mode, y, integers)
         if (changed) call change_pair(contact, fired(root_forward), mode, log)
         if (contact%deviates) call change_zones(gearbox, m, changed, fired, y, integers, mode, log)
         call point_of_contact(gearbox, m, y, integers, mode, q, rho_a0, point)
         if (entered) then
            call enter(gearbox, m, integers, point, mode, status)
         else if (mode%flanks /= flanks_off) then
            if (fired(root_friction_high) .or. fired(root_friction_low)) call change_friction(contact, fired, mode, log)
            call change_contact(contact, fired, point, mode, log)
         end if
         ! the radii of curvature jump at a switch, and friction starts anew with a contact
         if (mode%flanks == flanks_loaded .and. (changed .or. fired(root_contact) .or. fired(root_force))) &
            mode%friction = settle_friction(contact, point)
         ! what comes or goes with the flanks counts in the balance as negative loss or as loss
         y(gearbox%i_dissipated) = y(gearbox%i_dissipated) + (energy - energy_of(gearbox, m, mode, y, integers))
         if (fired(root_side)) mode%side = merge(-1, 1, mode%side > 0) ! nothing happens there that deserves an event
         if (fired(root_apart)) call change_distance(contact, q, mode, y, log)
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
         call note(log, merge(event_switch, event_switch_back, forward), contact, mode%tooth_pair)
      else if (mode%flanks == flanks_off) then
         if (forward) mode%tooth_pair = mode%tooth_pair - contact%n_slots
         mode%flanks = flanks_open
         call note(log, event_entered, contact, mode%tooth_pair)
      else
         call note(log, event_left, contact, mode%tooth_pair)
         if (forward) mode%tooth_pair = mode%tooth_pair + contact%n_slots
         mode = contact_mode(tooth_pair=mode%tooth_pair, flanks=flanks_off, side=mode%side)
      end if
   end subroutine change_pair

   !> The mode of a tooth pair that enters the path: flanks that overlap are loaded at once.
   subroutine enter(gearbox, m, integers, point, mode, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m, integers(:)
      type(contact_point), intent(in) :: point
      type(contact_mode), intent(inout) :: mode
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
         else if (point%h > 0) then
            mode%flanks = flanks_loaded
            mode%v0 = max(point%h_dot, 0.0_wp)
         end if
      end associate
   end subroutine enter

   !> Whether the tracking of a flank rests because its tooth pairs are too far apart.
   pure logical function flank_rests(gearbox, m, integers)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m, integers(:)

      associate (first => m - gearbox%contacts(m)%slot, n => gearbox%contacts(m)%n_slots)
         flank_rests = any(integers(gearbox%contacts(first:first + n - 1)%i_mode + 1) == flanks_apart)
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
         else if (any(fired(root_borders_a:root_borders_b + 1))) then
            if (fired(root_borders_a)) mode%zone_a = merge(zone_none, zone_tip, mode%zone_a == zone_tip)
            if (fired(root_borders_a + 1)) mode%zone_a = merge(zone_none, zone_root, mode%zone_a == zone_root)
            if (fired(root_borders_b)) mode%zone_b = merge(zone_none, zone_tip, mode%zone_b == zone_tip)
            if (fired(root_borders_b + 1)) mode%zone_b = merge(zone_none, zone_root, mode%zone_b == zone_root)
            call note(log, event_border, contact, mode%tooth_pair)
         end if
      end associate
   end subroutine change_zones

   !> The sliding velocity passed an end of the linear part of the friction law.
   pure subroutine change_friction(contact, fired, mode, log)
      type(tooth_contact_t), intent(in) :: contact
      logical, intent(in) :: fired(:)
      type(contact_mode), intent(inout) :: mode
      type(event_log), intent(inout) :: log

      if (mode%friction /= 0) then
         mode%friction = 0
         call note(log, event_sliding_ended, contact, mode%tooth_pair)
      else
         mode%friction = merge(1, -1, fired(root_friction_high))
         call note(log, event_sliding_began, contact, mode%tooth_pair)
      end if
   end subroutine change_friction

   !> Closing, opening, and the clip of the force.
   pure subroutine change_contact(contact, fired, point, mode, log)
      type(tooth_contact_t), intent(in) :: contact
      logical, intent(in) :: fired(:)
      type(contact_point), intent(in) :: point
      type(contact_mode), intent(inout) :: mode
      type(event_log), intent(inout) :: log

      select case (mode%flanks)
      case (flanks_open)
         if (.not. fired(root_contact)) return
         mode%flanks = flanks_loaded
         mode%v0 = max(point%h_dot, 0.0_wp)
         if (.not. contact%rigid) call note(log, event_closed, contact, mode%tooth_pair) ! else an impact decides
      case (flanks_loaded, flanks_unloaded)
         if (fired(root_contact) .or. (fired(root_force) .and. parts(contact, point))) then
            mode%flanks = flanks_open
            call note(log, event_opened, contact, mode%tooth_pair)
         else if (fired(root_force)) then
            call note(log, merge(event_vanished, event_returned, mode%flanks == flanks_loaded), contact, mode%tooth_pair)
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

   !> Tracking ends where the flanks are too far apart for two of their points to face each other, and begins anew when they
   !> come near.
   pure subroutine change_distance(contact, q, mode, y, log)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: q(n_local)
      type(contact_mode), intent(inout) :: mode
      real(wp), intent(inout) :: y(:)
      type(event_log), intent(inout) :: log

      if (mode%flanks == flanks_apart) then
         mode%flanks = flanks_open
         call points_from_closed_form(contact%pair, q, y(contact%i_track:contact%i_track + n_track - 1))
         call note(log, event_near, contact, mode%tooth_pair)
      else if (mode%flanks == flanks_open) then
         mode%flanks = flanks_apart
         call note(log, event_apart, contact, mode%tooth_pair)
      end if
   end subroutine change_distance

end module evl_contact_events
