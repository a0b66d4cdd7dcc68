!> Limits of a flank: a tooth pair carries force only on both involutes, and an edge only on the flank of its mate.
module evl_flank_limits
   use evl_contact_point, only: contact_point
   use evl_flank_deviation, only: zone_end
   use evl_force_lanes, only: lane_slot
   use evl_kinds, only: lanes, wp
   use evl_pair_point, only: by_a, by_b
   use evl_status, only: code_out_of_domain, fail, quantity, status_t, subject_mesh
   use evl_tooth_contact, only: beyond_flank, contact_mode, contact_state, ended_wheel, tooth_contact_t
   implicit none (type, external)
   private

   public :: check_edge, in_lanes_on_flank, in_lanes_on_involutes, left_involute

contains

   !> Fail if an edge has left the flank of its mate, or if a pair carries force past both ends of its path.
   pure subroutine check_edge(contact, at, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at !! of a touching pair
      type(status_t), intent(inout) :: status
      integer :: mate, wheel

      if (.not. beyond_flank(at%mode)) return
      if (past_both_ends(at%mode)) call fail(status, code_out_of_domain, "a tooth pair is past both ends of its path of contact" &
                                             //" and carries force: the teeth deflect by more than the length of the path", &
                                             subject_mesh, contact%mesh, "edge_contact")
      wheel = ended_wheel(at%mode)
      mate = by_a + by_b - wheel
      if (at%edge%exists .and. at%edge%foot(mate) >= contact%fillets(mate)) return
      call fail(status, code_out_of_domain, "a tip edge of the "//trim(name_of(wheel))//" wheel touches the fillet of the " &
                //trim(name_of(mate))//" wheel, which begins at a radius of curvature of "//quantity(contact%fillets(mate), "m") &
                //", "//quantity(contact%pair%rho_0 - contact%tips(wheel)%edge%rho_end, "m")//" where its path ends; relieve" &
                //" the tips, or reduce the load", subject_mesh, contact%mesh, "edge_contact")
   end subroutine check_edge

   !> Fail because the contact has left an involute; report which radius of curvature is exhausted.
   pure subroutine left_involute(contact, point, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_point), intent(in) :: point
      type(status_t), intent(inout) :: status
      character(len=7) :: which

      if (.not. status%in_words) then
         call fail(status, code_out_of_domain, "")
         return
      end if
      which = "driven"
      if (contact%side(by_a)*point%rho_a <= 0 .or. .not. point%exists) which = "driving"
      call fail(status, code_out_of_domain, "the contact has left the involute of the "//trim(which)//" wheel below its base" &
                //" circle (radii of curvature rho_A = "//quantity(point%rho_a, "m")//", rho_B = "//quantity(point%rho_b, "m") &
                //"): the tooth pair has turned back too far, or the gap is too wide", subject_mesh, contact%mesh, "tracking")
   end subroutine left_involute

   !> Name of a wheel for messages.
   pure character(len=7) function name_of(wheel)
      integer, intent(in) :: wheel

      name_of = merge("driving", "driven ", wheel == by_a)
   end function name_of

   !> Whether a pair is past both ends of its path.
   pure logical function past_both_ends(mode)
      type(contact_mode), intent(in) :: mode

      past_both_ends = min(mode%zone_a, mode%zone_b) >= zone_end
   end function past_both_ends

   !> Whether a pair lies on both involutes in all eight states.
   pure logical function in_lanes_on_involutes(slot) result(lies)
      type(lane_slot), intent(in) :: slot

      if (beyond_flank(slot%mode)) then
         lies = all_positive(slot%at%edge%margin) .and. all_positive(slot%at%edge%foot(:, by_a)) &
                .and. all_positive(slot%at%edge%foot(:, by_b))
      else
         lies = all_positive(slot%at%rho_a) .and. all_positive(slot%at%rho_b)
      end if
   end function in_lanes_on_involutes

   !> Whether `check_edge` reports no error in any of eight states.
   pure logical function in_lanes_on_flank(contact, slot) result(lies)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(in) :: slot
      integer :: mate

      lies = .true.
      if (.not. beyond_flank(slot%mode)) return
      mate = by_a + by_b - ended_wheel(slot%mode)
      lies = all_positive(slot%at%edge%margin) .and. .not. past_both_ends(slot%mode) &
             .and. all(slot%at%edge%foot(:, mate) >= contact%fillets(mate))
   end function in_lanes_on_flank

   include "numerics/all_positive.inc"

end module evl_flank_limits
