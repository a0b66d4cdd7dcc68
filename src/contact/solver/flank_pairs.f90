!> Tooth pairs of a flank that affect each other's forces: indices and positions, for one state and for eight.
module evl_flank_pairs
   use evl_compliant_lanes, only: feet_in_lanes, line_in_lanes
   use evl_coupled_pairs, only: most_pairs
   use evl_force_lanes, only: lane_slot
   use evl_kinds, only: lanes, wp
   use evl_pair_point, only: pair_feet
   use evl_tooth_contact, only: contact_state, feet_of, flanks_open, line_of, touches
   implicit none (type, external)
   private

   public :: add_in_lanes, lane_pairs, list_pairs, pairs_t

   !> Pairs of a flank at a state.
   type :: pairs_t
      integer :: n = 0
      integer :: contact(most_pairs) = 0 !! index in the gearbox
      integer :: number(most_pairs) = 0  !! number of the tooth pair
      real(wp) :: h(most_pairs) = 0.0_wp, line(most_pairs) = 1.0_wp !! [m]
      type(pair_feet) :: feet(most_pairs)
   end type pairs_t

   !> The same for eight states.
   type :: lane_pairs
      integer :: n = 0
      integer :: contact(most_pairs), number(most_pairs)
      real(wp) :: h(lanes, most_pairs), line(lanes, most_pairs), foot(lanes, 2, most_pairs)
   end type lane_pairs

contains

   !> List the pairs in one state: those that touch and, if `with_open`, those that are open.
   pure subroutine list_pairs(first, last, at, with_open, pairs)
      integer, intent(in) :: first, last
      type(contact_state), intent(in) :: at(*)
      logical, intent(in) :: with_open
      type(pairs_t), intent(inout) :: pairs
      integer :: k

      do k = first, last
         if (.not. (touches(at(k)%mode) .or. (with_open .and. at(k)%mode%flanks == flanks_open))) cycle
         pairs%n = pairs%n + 1
         associate (n => pairs%n)
            pairs%contact(n) = k
            pairs%number(n) = at(k)%mode%tooth_pair
            pairs%h(n) = at(k)%point%h
            pairs%line(n) = line_of(at(k))
            pairs%feet(n)%foot = feet_of(at(k))
         end associate
      end do
   end subroutine list_pairs

   !> Add a pair for eight states.
   pure subroutine add_in_lanes(pairs, contact, slot)
      type(lane_pairs), intent(inout) :: pairs
      integer, intent(in) :: contact
      type(lane_slot), intent(in) :: slot

      pairs%n = pairs%n + 1
      associate (n => pairs%n, at => slot%at)
         pairs%contact(n) = contact
         pairs%number(n) = slot%mode%tooth_pair
         pairs%h(:, n) = at%h
         call line_in_lanes(slot, pairs%line(:, n))
         call feet_in_lanes(slot, pairs%foot(:, :, n))
      end associate
   end subroutine add_in_lanes

end module evl_flank_pairs
