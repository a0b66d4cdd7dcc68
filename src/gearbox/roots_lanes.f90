!> Root functions of a gearbox for eight states at once; `gearbox_roots` is the version for one state.
module evl_roots_lanes
   use evl_contact_lanes, only: contact_in_lanes
   use evl_flank, only: flank_t
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_events, only: gearbox_roots, turns_root
   use evl_kinds, only: lanes, wp
   use evl_line_lanes, only: centre_turn_in_lanes, lane_line, line_in_lanes, motion_in_lanes
   use evl_local_variables, only: i_theta
   use evl_pair_point, only: by_a, by_b
   use evl_root_kinds, only: root_of, root_rows
   use evl_status, only: code_out_of_domain, fail, has_failed, status_t
   use evl_tooth_contact, only: beyond_flank, contact_mode, flank_drive, flanks_off, tooth_contact_t, touches
   implicit none (type, external)
   private

   public :: roots_in_lanes

   integer, parameter :: width = lanes !! states evaluated at once by the included formulas

contains

   include "numerics/all_positive.inc"
   include "contact/contact_roots.inc"

   !> Root functions of all states, in up to two passes. In the first (`nearby`), touching contacts use the data of the last
   !> `rates_in_lanes`. In the second, they are evaluated at these states; the other contacts are already complete.
   subroutine roots_in_lanes(gearbox, y, integers, reals, slots, aside, nearby, roots, status)
      type(gearbox_t), intent(in) :: gearbox     !! supported by `supports_lanes`
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      type(lane_slot), intent(in) :: slots(size(gearbox%contacts))    !! [tooth contacts] with their discrete state
      type(lane_slot), intent(inout) :: aside(size(gearbox%contacts)) !! [tooth contacts] likewise, as scratch for these states
      logical, intent(in) :: nearby              !! data of the last `rates_in_lanes` suffice; false: second pass in the same states
      real(wp), intent(inout) :: roots(lanes, gearbox%n_roots)
      type(status_t), intent(inout) :: status    !! code_out_of_domain if a law is not defined in one of the lanes
      logical :: is_defined
      integer :: i

      do i = 1, size(gearbox%flanks)
         call roots_of_flank(gearbox, gearbox%flanks(i)%flank, y, slots, aside, nearby, roots, is_defined)
         if (.not. is_defined) then
            call say_why(gearbox, y, integers, reals, status)
            return
         end if
      end do
      roots(:, gearbox%n_roots) = turns_root(y(:, i_theta))
   end subroutine roots_in_lanes

   !> Root functions of the tooth contacts of a flank.
   subroutine roots_of_flank(gearbox, flank, y, slots, aside, nearby, roots, is_defined)
      type(gearbox_t), intent(in) :: gearbox
      class(flank_t), intent(in) :: flank
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      type(lane_slot), intent(in) :: slots(size(gearbox%contacts))
      type(lane_slot), intent(inout) :: aside(size(gearbox%contacts))
      logical, intent(in) :: nearby
      real(wp), intent(inout) :: roots(lanes, gearbox%n_roots)
      logical, intent(out) :: is_defined
      type(lane_line) :: line
      integer :: m

      is_defined = .true.
      if (.not. (nearby .or. any(slots(flank%first:flank%last)%touches))) return ! no change
      do m = flank%first, flank%last
         if (nearby .eqv. slots(m)%touches) cycle
         call line_in_lanes(gearbox%contacts(m), y, line)
         is_defined = all_positive(line%margin)
         if (.not. is_defined) return
         call contact_in_lanes(gearbox%contacts(m), slots(m)%mode, slots(m)%rho_start, line, aside(m)%at)
      end do
      if (.not. nearby) call flank%laws_in_lanes(gearbox%contacts, flank%first, flank%last, aside, is_defined)
      if (.not. is_defined) return
      call flank%find_overlaps_in_lanes(gearbox%contacts, slots, aside, nearby)
      do m = flank%first, flank%last
         associate (contact => gearbox%contacts(m), first_root => gearbox%contacts(m)%i_root + 1)
            if (nearby .and. slots(m)%touches) then
               call roots_of_contact(flank, contact, slots(m), y, line, roots(1, first_root))
            else
               call roots_of_contact(flank, contact, aside(m), y, line, roots(1, first_root))
            end if
         end associate
      end do
   end subroutine roots_of_flank

   !> Root functions of one tooth contact.
   subroutine roots_of_contact(flank, contact, slot, y, line, roots)
      class(flank_t), intent(in) :: flank
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(in) :: slot
      real(wp), intent(in) :: y(lanes, *)
      type(lane_line), intent(inout) :: line       !! its motion may be needed
      real(wp), intent(out) :: roots(lanes, contact%n_roots)
      real(wp), dimension(lanes) :: foot_a, foot_b, moved, turn

      moved = 0
      if (contact%handover) then
         if (line%mesh == 0) call motion_in_lanes(contact, y, line)
         call centre_turn_in_lanes(contact, line, turn)
         moved = pitches_moved(contact, slot%at%rho_a0, line%psi_a, turn)
      end if
      associate (at => slot%at)
         foot_a = at%rho_a
         foot_b = at%rho_b
         if (slot%mode%flanks /= flanks_off .and. beyond_flank(slot%mode)) then
            foot_a = at%edge%foot(:, by_a)
            foot_b = at%edge%foot(:, by_b)
         end if
         call closed_form_roots(flank, contact, slot%mode, slot%directions, at%overlap, at%h_dot, at%v_t, at%rho_a, at%rho_b, &
                                foot_a, foot_b, &
                                slot%force%unclipped, moved, roots)
      end associate
   end subroutine roots_of_contact

   !> Report the error of the first lane without a solution, with the message of the scalar kernel.
   subroutine say_why(gearbox, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(lanes, gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      type(status_t), intent(inout) :: status
      real(wp) :: roots(gearbox%n_roots)
      integer :: l

      do l = 1, lanes
         call gearbox_roots(gearbox, y(l, :), integers, reals, roots, status)
         if (has_failed(status)) return
      end do
      call fail(status, code_out_of_domain, "the axles are too close for a line of action")
   end subroutine say_why

end module evl_roots_lanes
