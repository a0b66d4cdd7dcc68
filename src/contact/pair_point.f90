!> Contact position of a tooth pair, on its flanks or at a tip edge, as a function of three lengths.
!>
!> These are the radii of curvature rho_A and rho_B of the involutes on the line of action, and the length rho of that line, the
!> distance of the tangent points on the base circles. The penetration of perfect flanks is rho_A + rho_B - rho. All derivatives in
!> this file are with respect to these three, in this order, up to second order. Derivatives with respect to the wheel positions
!> follow from them.
!>
!> A flank with a slope at its end touches there when its involute is past the end by x_* (see evl_tip_edge). Up to x_* its profile
!> is extended. Beyond x_* the gap contribution of the edge is e(x_*) + S(x) - S(x_*), and the contact on the mate is
!> r_b (delta(x) - delta(x_*)) beside the line of action. Gap and feet are continuous. The slope of the gap is also continuous,
!> except for axle motions: x_* is held constant.
module evl_pair_point
   use evl_deviating_flanks, only: flank_value
   use evl_flank_deviation, only: deviation_on, find_slope, flank_branch, flank_slope
   use evl_kinds, only: wp
   use evl_tip_edge, only: edge_geometry, edge_t, evaluate_edge
   implicit none (type, external)
   private

   public :: by_a, by_b, by_line, pair_feet, pair_depth, tip_t
   public :: edge_of, end_of, find_feet, on_edge, on_flank, on_straight_end, penetrate, turn_feet, zone_at

   integer, parameter :: by_a = 1, by_b = 2, by_line = 3 !! indices of derivatives (rho_A, rho_B, rho) and of wheels (A, B)

   integer, parameter :: on_flank = 0        !! contact of both flanks
   integer, parameter :: on_straight_end = 1 !! contact on the extension of the flank of A past its end; of B: 2
   integer, parameter :: on_edge = 3         !! contact of a tip edge of A; of B: 4

   !> Tip of the teeth of a wheel.
   type :: tip_t
      type(edge_t) :: edge
      type(flank_branch) :: profile   !! deviation of the flank at its end and beyond, without pitch errors and runout
      real(wp) :: leaves = 0.0_wp     !! roll length at which the flank ends
      real(wp) :: takes_over = 0.0_wp !! x_* [m]
      real(wp) :: value = 0.0_wp      !! e there [m]
      real(wp) :: slope = 0.0_wp      !! of the flank there, if it is of second order
   end type tip_t

   !> Contact positions and gap contribution for the zone of a pair, as functions of the three lengths.
   type :: pair_feet
      integer :: zone = on_flank
      integer :: wheel = 0                  !! wheel with the end or edge; 0: none
      logical :: exists = .true.            !! false if the edge is inside the mate's base circle
      real(wp) :: x = 0.0_wp                !! roll length past the end of that wheel's flank [m]
      real(wp) :: rho(3) = 0.0_wp           !! rho_A, rho_B, rho [m]
      real(wp) :: foot(2) = 0.0_wp          !! roll lengths at which A and B are loaded [m]
      real(wp) :: d_foot(3, 2) = 0.0_wp     !! their derivatives
      real(wp) :: d2_foot(3, 3, 2) = 0.0_wp
      real(wp) :: gap = 0.0_wp             !! gap contribution of the end or edge [m]
      real(wp) :: d_gap(3) = 0.0_wp, d2_gap(3, 3) = 0.0_wp
      real(wp) :: arm = 0.0_wp              !! of the friction force about the wheel with the end or edge [m]
      real(wp) :: d_arm(3) = 0.0_wp
      real(wp) :: turn = 0.0_wp             !! angle of the force to the line of action [rad]
      type(flank_slope) :: slope = flank_slope() !! of that wheel's flank at the contact
   end type pair_feet

   !> Penetration of a pair.
   type :: pair_depth
      real(wp) :: h = 0.0_wp !! [m]
      real(wp) :: d_h(3) = 0.0_wp, d2_h(3, 3) = 0.0_wp
   end type pair_depth

contains

   !> Zones: extension of a wheel's flank past its end; tip edge of a wheel.
   elemental integer function end_of(wheel)
      integer, intent(in) :: wheel !! by_a or by_b

      end_of = on_straight_end + wheel - 1
   end function end_of

   elemental integer function edge_of(wheel)
      integer, intent(in) :: wheel

      edge_of = on_edge + wheel - 1
   end function edge_of

   !> Zone of a pair. If both ends are passed, which requires a penetration as long as the path, the zone of A.
   pure integer function zone_at(tips, rho_a, rho_b) result(zone)
      type(tip_t), intent(in) :: tips(2)
      real(wp), intent(in) :: rho_a, rho_b
      real(wp) :: rho(2)
      integer :: wheel

      rho = [rho_a, rho_b]
      zone = on_flank
      do wheel = by_b, by_a, -1
         if (rho(wheel) - tips(wheel)%edge%rho_end > tips(wheel)%takes_over) then
            zone = edge_of(wheel)
         else if (rho(wheel) > tips(wheel)%leaves) then
            zone = end_of(wheel)
         end if
      end do
   end function zone_at

   !> Contact positions on both wheels.
   pure subroutine find_feet(tips, zone, rho_a, rho_b, line, feet)
      type(tip_t), intent(in) :: tips(2)
      integer, intent(in) :: zone             !! may be continued past its borders
      real(wp), intent(in) :: rho_a, rho_b    !! [m]
      real(wp), intent(in) :: line            !! rho [m]
      type(pair_feet), intent(out) :: feet

      feet%zone = zone
      feet%rho = [rho_a, rho_b, line]
      feet%foot = [rho_a, rho_b]
      feet%d_foot(by_a, by_a) = 1
      feet%d_foot(by_b, by_b) = 1
      if (zone == on_flank) return
      feet%wheel = merge(by_a, by_b, zone == end_of(by_a) .or. zone == edge_of(by_a))
      associate (w => feet%wheel, tip => tips(feet%wheel))
         feet%x = feet%rho(w) - tip%edge%rho_end
         feet%foot(w) = tip%leaves
         feet%d_foot(w, w) = 0
         if (zone == end_of(w)) then
            call deviation_on(tip%profile, feet%rho(w), feet%gap, feet%d_gap(w), feet%d2_gap(w, w))
            if (tip%profile%slopes) call find_slope(tip%profile, feet%rho(w), feet%slope)
            feet%arm = feet%rho(w)
            feet%d_arm(w) = 1
         else
            call touch_with_edge(tip, w, feet)
         end if
      end associate
   end subroutine find_feet

   !> Contact of an edge with the mate.
   pure subroutine touch_with_edge(tip, w, feet)
      type(tip_t), intent(in) :: tip
      integer, intent(in) :: w !! wheel with the edge
      type(pair_feet), intent(inout) :: feet
      type(edge_geometry) :: at, begin

      call evaluate_edge(tip%edge, feet%x, feet%rho(by_line), at)
      feet%exists = at%exists
      begin = edge_geometry() ! everything is zero at x = 0
      if (tip%takes_over > 0) call evaluate_edge(tip%edge, tip%takes_over, feet%rho(by_line), begin)
      feet%arm = at%arm
      feet%d_arm(w) = at%arm_x
      feet%d_arm(by_line) = at%arm_rho
      feet%turn = at%turn
      feet%slope%s = tip%slope
      feet%gap = tip%value + (at%gap - begin%gap)
      feet%d_gap(w) = at%d_x
      feet%d_gap(by_line) = at%d_rho - begin%d_rho
      feet%d2_gap(w, w) = at%d_xx
      feet%d2_gap(w, by_line) = at%d_x_rho
      feet%d2_gap(by_line, w) = at%d_x_rho
      feet%d2_gap(by_line, by_line) = at%d_rho_rho - begin%d_rho_rho
      associate (mate => 3 - w)
         feet%foot(mate) = feet%rho(mate) - (at%foot - begin%foot)
         feet%d_foot(w, mate) = -at%foot_x
         feet%d_foot(by_line, mate) = -(at%foot_rho - begin%foot_rho)
         feet%d2_foot(w, w, mate) = -at%foot_xx
         feet%d2_foot(w, by_line, mate) = -at%foot_x_rho
         feet%d2_foot(by_line, w, mate) = -at%foot_x_rho
         feet%d2_foot(by_line, by_line, mate) = -(at%foot_rho_rho - begin%foot_rho_rho)
      end associate
   end subroutine touch_with_edge

   !> Joint deviation term of two sloping flanks, as `turn_together`, with second derivatives.
   pure subroutine turn_feet(arm, turns, feet, flanks)
      real(wp), intent(in) :: arm                 !! `turning_arm` [m]
      type(flank_slope), intent(in) :: turns(2)   !! past the end of a flank, the slope of that wheel is in the feet
      type(pair_feet), intent(inout) :: feet
      type(flank_value), intent(inout) :: flanks(2)
      type(flank_slope) :: slopes(2)
      real(wp) :: along(3, 2)
      integer :: i, w

      slopes = turns
      along = feet%d_foot
      if (feet%wheel > 0) then
         slopes(feet%wheel) = feet%slope
         along(feet%wheel, feet%wheel) = 1
      end if
      feet%gap = feet%gap + arm*slopes(by_a)%s*slopes(by_b)%s
      do w = by_a, by_b
         associate (other => slopes(3 - w)%s, mine => slopes(w))
            if (w == feet%wheel) then
               feet%d_gap(w) = feet%d_gap(w) + arm*mine%ds*other
               feet%d2_gap(w, w) = feet%d2_gap(w, w) + arm*mine%d2s*other
            else
               flanks(w)%de = flanks(w)%de + arm*mine%ds*other
               flanks(w)%d2e = flanks(w)%d2e + arm*mine%d2s*other
            end if
         end associate
      end do
      do i = by_a, by_line
         feet%d2_gap(:, i) = feet%d2_gap(:, i) + arm*slopes(by_a)%ds*slopes(by_b)%ds*(along(:, by_a)*along(i, by_b) &
                                                                                      + along(:, by_b)*along(i, by_a))
      end do
   end subroutine turn_feet

   !> Penetration including the deviations of both wheels. On a flank, the whole deviation counts, at its foot. For a wheel with an
   !> end or edge, only the part that applies beyond the end of the profile counts, at its own radius of curvature. Equation D1.
   pure subroutine penetrate(feet, flanks, depth)
      type(pair_feet), intent(in) :: feet
      type(flank_value), intent(in) :: flanks(2)
      type(pair_depth), intent(out) :: depth
      integer :: i, w

      depth%h = feet%rho(by_a) + feet%rho(by_b) - feet%rho(by_line) - feet%gap
      depth%d_h = [1.0_wp, 1.0_wp, -1.0_wp] - feet%d_gap
      depth%d2_h = -feet%d2_gap
      do w = by_a, by_b
         depth%h = depth%h - flanks(w)%e
         if (w == feet%wheel) then
            depth%d_h(w) = depth%d_h(w) - flanks(w)%de
            depth%d2_h(w, w) = depth%d2_h(w, w) - flanks(w)%d2e
         else
            depth%d_h = depth%d_h - flanks(w)%de*feet%d_foot(:, w)
            do i = by_a, by_line
               depth%d2_h(:, i) = depth%d2_h(:, i) - flanks(w)%de*feet%d2_foot(:, i, w) &
                                  - flanks(w)%d2e*feet%d_foot(:, w)*feet%d_foot(i, w)
            end do
         end if
      end do
   end subroutine penetrate

end module evl_pair_point
