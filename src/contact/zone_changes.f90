!> Zone of a contact on the flank of one wheel after it has passed borders of the reliefs or the end of the flank.
module evl_zone_changes
   use evl_flank_deviation, only: flank_deviation_t, has_corner, relief_t, zone_edge, zone_end, zone_none, zone_root, &
                                  zone_root_corner, zone_tip, zone_tip_corner
   use evl_pair_point, only: tip_t
   implicit none (type, external)
   private

   public :: change_zone

contains

   !> Change the zone after borders of one wheel are passed.
   pure subroutine change_zone(deviation, tip, at_tip, at_root, beyond, zone)
      type(flank_deviation_t), intent(in) :: deviation
      type(tip_t), intent(in) :: tip
      logical, intent(in) :: at_tip(2), at_root(2) !! borders of the reliefs: near and far border of the corner
      logical, intent(in) :: beyond(2) !! end of the flank, and start of its edge contact
      integer, intent(inout) :: zone
      logical :: leaves
      integer :: i, inside, outside

      call change_relief(deviation%tip, at_tip, zone_tip, zone_tip_corner, zone)
      call change_relief(deviation%root, at_root, zone_root, zone_root_corner, zone)
      leaves = zone == zone_edge ! in the order in which they are passed
      do i = merge(2, 1, leaves), merge(1, 2, leaves), merge(-1, 1, leaves)
         if (.not. beyond(i)) cycle
         outside = merge(zone_end, zone_edge, i == 1)
         inside = merge(zone_tip, zone_none, deviation%tip%amount > 0)
         if (i == 2 .and. tip%takes_over > 0) inside = zone_end
         zone = merge(inside, outside, zone == outside)
      end do
   end subroutine change_zone

   !> Change the zone after borders of one relief are passed, in the order in which they are passed.
   pure subroutine change_relief(relief, fired, mine, corner, zone)
      type(relief_t), intent(in) :: relief
      logical, intent(in) :: fired(2)
      integer, intent(in) :: mine, corner !! its zone, and that of its corner
      integer, intent(inout) :: zone
      logical :: leaves
      integer :: i, inner, outer

      leaves = zone == mine
      do i = merge(2, 1, leaves), merge(1, 2, leaves), merge(-1, 1, leaves)
         if (.not. fired(i)) cycle
         inner = merge(zone_none, corner, i == 1)
         outer = merge(corner, mine, i == 1 .and. has_corner(relief))
         zone = merge(inner, outer, zone == outer)
      end do
   end subroutine change_relief

end module evl_zone_changes
