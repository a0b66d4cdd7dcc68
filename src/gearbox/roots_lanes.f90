!> The root functions of a gearbox for eight states at once, as `gearbox_roots` gives them for one.
module evl_roots_lanes
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_contact_lanes, only: contact_in_lanes, lane_contact
   use evl_contacts_in_lanes, only: lane_slot
   use evl_force_lanes, only: lane_force, laws_in_lanes
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_events, only: gearbox_roots, turns_root
   use evl_kinds, only: lanes, wp
   use evl_line_lanes, only: centre_turn_in_lanes, lane_line, line_in_lanes, motion_in_lanes
   use evl_local_variables, only: i_theta
   use evl_root_kinds, only: root_of, root_rows
   use evl_status, only: code_out_of_domain, fail, has_failed, status_t
   use evl_tooth_contact, only: contact_mode, flank_drive, flanks_off, tooth_contact_t, touches
   implicit none (type, external)
   private

   public :: roots_in_lanes

   integer, parameter :: width = lanes !! states that the included formulas take at once

contains

   include "numerics/all_positive.inc"
   include "contact/contact_roots.inc"

   !> Root functions of all states.
   subroutine roots_in_lanes(gearbox, y, integers, reals, slots, nearby, roots, status)
      type(gearbox_t), intent(in) :: gearbox     !! one that `lanes_serve` accepts
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      type(lane_slot), intent(in) :: slots(:)    !! [tooth contacts] settled
      logical, intent(in) :: nearby              !! where flanks overlap those of the last `rates_in_lanes` will do
      real(wp), intent(out) :: roots(lanes, gearbox%n_roots)
      type(status_t), intent(inout) :: status    !! code_out_of_domain if a law has no answer in one of the lanes
      type(lane_line) :: line
      logical :: answered
      integer :: m

      do m = 1, size(gearbox%contacts)
         associate (first => gearbox%contacts(m)%i_root + 1, last => gearbox%contacts(m)%i_root + gearbox%contacts(m)%n_roots)
            if (nearby .and. touches(slots(m)%mode)) then
               call roots_of_touch(gearbox%contacts(m), slots(m), y, line, roots(:, first:last))
               cycle
            end if
            call roots_of_contact(gearbox%contacts(m), slots(m), y, line, roots(:, first:last), answered)
         end associate
         if (.not. answered) then
            call say_why(gearbox, y, integers, reals, status)
            return
         end if
      end do
      roots(:, gearbox%n_roots) = turns_root(y(:, i_theta))
   end subroutine roots_in_lanes

   !> Those of one tooth contact.
   subroutine roots_of_contact(contact, slot, y, line, roots, answered)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(in) :: slot
      real(wp), intent(in) :: y(lanes, *)
      type(lane_line), intent(inout) :: line       !! of the contact before, or nobody's
      real(wp), intent(out) :: roots(lanes, contact%n_roots)
      logical, intent(out) :: answered
      type(lane_contact) :: at
      type(lane_force) :: force
      real(wp), dimension(lanes) :: unclipped, moved

      call line_in_lanes(contact, y, line)
      answered = all_positive(line%margin)
      if (.not. answered) return
      call contact_in_lanes(contact, slot%mode, slot%rho_start, line, at)
      unclipped = 0
      if (touches(slot%mode)) then
         call laws_in_lanes(contact, line%margin, at, force, answered)
         if (.not. answered) return
         unclipped = force%elastic + force%viscous
      end if
      call moved_in_lanes(contact, line, at%rho_a0, moved)
      call closed_form_roots(contact, slot%mode, slot%directions, at%h, at%h_dot, at%v_t, at%rho_a, at%rho_b, unclipped, moved, &
                             roots)
   end subroutine roots_of_contact

   !> Those of one that touched in states nearby.
   subroutine roots_of_touch(contact, slot, y, line, roots)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(in) :: slot
      real(wp), intent(in) :: y(lanes, *)
      type(lane_line), intent(inout) :: line       !! its motion may be needed
      real(wp), intent(out) :: roots(lanes, contact%n_roots)
      real(wp) :: moved(lanes)

      if (contact%handover) call motion_in_lanes(contact, y, line)
      call moved_in_lanes(contact, line, slot%at%rho_a0, moved)
      call closed_form_roots(contact, slot%mode, slot%directions, slot%at%h, slot%at%h_dot, slot%at%v_t, slot%at%rho_a, &
                             slot%at%rho_b, slot%unclipped, moved, roots)
   end subroutine roots_of_touch

   !> How many pitches a pair that hands over has moved on; 0 for others.
   subroutine moved_in_lanes(contact, line, rho_a0, moved)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_line), intent(in) :: line
      real(wp), intent(in) :: rho_a0(lanes)
      real(wp), intent(out) :: moved(lanes)
      real(wp) :: turn(lanes)

      moved = 0
      if (.not. contact%handover) return
      call centre_turn_in_lanes(contact, line, turn)
      moved = pitches_moved(contact, rho_a0, line%psi_a, turn)
   end subroutine moved_in_lanes

   !> The first lane without an answer says why, in the words of the scalar kernel.
   subroutine say_why(gearbox, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(lanes, gearbox%n_states), reals(:)
      integer, intent(in) :: integers(:)
      type(status_t), intent(inout) :: status
      real(wp) :: roots(gearbox%n_roots)
      integer :: l

      do l = 1, lanes
         call gearbox_roots(gearbox, y(l, :), integers, reals, roots, status)
         if (has_failed(status)) return
      end do
      call fail(status, code_out_of_domain, "the axles have come too near for a line of action")
   end subroutine say_why

end module evl_roots_lanes
