!> Tooth pair past the end of a flank: the flank is extended straight, and further on its tip edge touches the mate
!> (evl_pair_point).
!>
!> The penetration is a function of rho_A, rho_B and rho, the length of the line of action. As for deviating flanks, the forces
!> follow its gradient: the arm about an axle is r_b dh/drho_i. The component along t on A is (r_bA (h_A + h_rho) + r_bB
!> (h_B + h_rho))/rho relative to the force. Since an edge rotates the normal, the component against e is -h_rho relative to the
!> force. On flanks h_rho is -1.
module evl_edge_contact
   use evl_contact_point, only: contact_gradient, contact_point, tracked_pair
   use evl_deviating_flanks, only: flank_value, radius_rates, rate_gradients, rates_of, sliding_gradient, turning_arm
   use evl_flank_deviation, only: deviation_branch, deviation_on, find_slope, flank_branch, flank_deviation_t, flank_slope, &
                                  slope_on, zone_edge, zone_end, zone_none, zone_tip
   use evl_kinds, only: wp
   use evl_local_variables, only: n_local
   use evl_pair_point, only: by_a, by_b, by_line, edge_of, end_of, find_feet, on_flank, pair_depth, pair_feet, penetrate, tip_t, &
                             turn_feet, zone_at
   use evl_tip_edge, only: edge_t, end_of_flank
   implicit none (type, external)
   private

   public :: change_of_foot, edge_contact, edge_gradient, feet_beyond, lift_of, make_tip, put_on_edge

   !> Additional data of a pair past the end of a flank; not initialised. Derivatives are with respect to rho_A, rho_B and rho.
   type :: edge_contact
      logical :: exists                               !! false if the edge is inside the mate's base circle
      integer :: wheel                                !! wheel whose flank end is passed: by_a or by_b
      real(wp) :: line                                !! rho [m]
      real(wp) :: foot(2), d_foot(3, 2), d2_foot(3, 3, 2) !! roll lengths at which A and B are loaded [m]
      real(wp) :: d_h(3), d2_h(3, 3)                  !! of the penetration
      real(wp) :: d_own(3)                            !! of the arm of the friction force about the edge's wheel
      real(wp) :: d_mate(3)                           !! and about its mate
   end type edge_contact

   real(wp), parameter :: on_path(3) = [1.0_wp, 1.0_wp, -1.0_wp] !! derivatives of the penetration of perfect flanks

contains

   include "contact/edge/edge_point.inc"

   !> Set up the tip of the teeth of a wheel.
   pure subroutine make_tip(deviation, r_b, r_mate, rho_end, rounding, line, tip)
      type(flank_deviation_t), intent(in) :: deviation
      real(wp), intent(in) :: r_b, r_mate !! base radii of the wheel and its mate [m]
      real(wp), intent(in) :: rho_end     !! radius of curvature at the end of the flank [m]
      real(wp), intent(in) :: rounding    !! of the tip [m]
      real(wp), intent(in) :: line        !! reference length of the line of action [m]
      type(tip_t), intent(out) :: tip
      type(flank_slope) :: there
      real(wp) :: slope, d2e

      tip%edge = edge_t(r_b=r_b, r_mate=r_mate, rho_end=rho_end, rounding=rounding)
      tip%leaves = rho_end
      if (deviation%tip%amount > 0) tip%leaves = max(rho_end, deviation%tip%taken(2)) ! for a relief shorter than its corner reaches
      tip%profile = deviation_branch(deviation, 0, 1, merge(zone_tip, zone_none, deviation%tip%amount > 0))
      tip%profile%offset = 0
      tip%profile%runout = 0
      tip%takes_over = max(end_of_flank(tip%edge, tip%profile, line), tip%leaves - rho_end)
      call deviation_on(tip%profile, rho_end + tip%takes_over, tip%value, slope, d2e)
      if (.not. tip%profile%slopes) return
      call find_slope(tip%profile, rho_end + tip%takes_over, there)
      tip%slope = there%s
   end subroutine make_tip

   !> Zones of both wheels of a pair, and the loaded positions; zones stay unchanged between the ends of the flanks.
   pure subroutine feet_beyond(tips, rho_a, rho_b, line, zones, foot)
      type(tip_t), intent(in) :: tips(2)
      real(wp), intent(in) :: rho_a, rho_b, line !! [m]
      integer, intent(inout) :: zones(2)
      real(wp), intent(out) :: foot(2)
      type(pair_feet) :: feet
      integer :: zone

      zone = zone_at(tips, rho_a, rho_b)
      call find_feet(tips, zone, rho_a, rho_b, line, feet)
      foot = feet%foot
      if (zone /= on_flank) zones(feet%wheel) = merge(zone_edge, zone_end, zone == edge_of(feet%wheel))
   end subroutine feet_beyond

   !> Correct the contact of perfect involutes for a pair past the end of a flank.
   pure subroutine put_on_edge(pair, tips, deviation_a, deviation_b, zones, branches, q, point, edge)
      type(tracked_pair), intent(in) :: pair
      type(tip_t), intent(in) :: tips(2)
      type(flank_deviation_t), intent(in) :: deviation_a, deviation_b
      integer, intent(in) :: zones(2)                !! of A and B, at least one of them >= zone_end
      type(flank_branch), intent(in) :: branches(2)
      real(wp), intent(in) :: q(n_local)
      type(contact_point), intent(inout) :: point
      type(edge_contact), intent(out) :: edge
      type(radius_rates) :: rate
      type(pair_feet) :: feet
      type(pair_depth) :: depth
      type(flank_value) :: flanks(2)
      type(flank_slope) :: turns(2)
      real(wp) :: arms(2), d_arms(3, 2)
      integer :: w

      w = merge(by_a, by_b, zones(by_a) >= zone_end)
      rate = rates_of(pair, q, point)
      call find_feet(tips, merge(edge_of(w), end_of(w), zones(w) == zone_edge), point%rho_a, point%rho_b, rate%line, feet)
      do w = by_a, by_b
         call deviation_on(branches(w), merge(feet%rho(w), feet%foot(w), w == feet%wheel), flanks(w)%e, flanks(w)%de, flanks(w)%d2e)
      end do
      edge%exists = feet%exists
      edge%wheel = feet%wheel
      edge%line = rate%line
      edge%foot = feet%foot
      edge%d_foot = feet%d_foot
      edge%d2_foot = feet%d2_foot
      call find_arms(feet, flanks, arms, d_arms)
      associate (mate => by_a + by_b - feet%wheel)
         if (tips(feet%wheel)%profile%slopes .and. branches(mate)%slopes) then
            if (mate == by_a) call slope_on(deviation_a, zones(mate), branches(mate), feet%foot(mate), turns(mate))
            if (mate == by_b) call slope_on(deviation_b, zones(mate), branches(mate), feet%foot(mate), turns(mate))
            call turn_feet(turning_arm(pair), turns, feet, flanks)
         end if
      end associate
      call penetrate(feet, flanks, depth)
      edge%d_h = depth%d_h
      edge%d2_h = depth%d2_h
      point%exists = point%exists .and. feet%exists
      edge%d_own = d_arms(:, feet%wheel)
      edge%d_mate = d_arms(:, by_a + by_b - feet%wheel)
      call correct_for_edge(pair, rate, merge(1.0_wp, 0.0_wp, feet%exists), feet%x, feet%gap, sum(flanks%e), edge%d_h(by_a), &
                            edge%d_h(by_b), edge%d_h(by_line), arms(by_a), arms(by_b), point)
   end subroutine put_on_edge

   !> Arms of the friction force without penetration.
   pure subroutine find_arms(feet, flanks, arms, d_arms)
      type(pair_feet), intent(in) :: feet
      type(flank_value), intent(in) :: flanks(2)
      real(wp), intent(out) :: arms(2), d_arms(3, 2) !! [m]
      integer :: w

      do w = by_a, by_b
         arms(w) = feet%foot(w) - flanks(w)%e
         d_arms(:, w) = (1 - flanks(w)%de)*feet%d_foot(:, w)
         if (w /= feet%wheel) cycle
         arms(w) = feet%arm - feet%gap - flanks(w)%e
         d_arms(:, w) = feet%d_arm - feet%d_gap
         d_arms(w, w) = d_arms(w, w) - flanks(w)%de
      end do
   end subroutine find_arms

   !> Derivatives of the loaded position on a wheel with respect to the local variables.
   pure function change_of_foot(edge, d, wheel) result(change)
      type(edge_contact), intent(in) :: edge
      type(contact_gradient), intent(in) :: d
      integer, intent(in) :: wheel !! by_a or by_b
      real(wp) :: change(n_local)

      change = edge%d_foot(by_a, wheel)*d%rho_a + edge%d_foot(by_b, wheel)*d%rho_b + edge%d_foot(by_line, wheel)*d%line
   end function change_of_foot

   !> Component of the force of an edge against e, relative to the force, less 1.
   pure real(wp) function lift_of(edge)
      type(edge_contact), intent(in) :: edge

      lift_of = -(1 + edge%d_h(by_line))
   end function lift_of

   !> Derivatives of `put_on_edge`. On entry: those of the contact of perfect involutes.
   pure subroutine edge_gradient(pair, edge, q, perfect, point, gradient)
      type(tracked_pair), intent(in) :: pair
      type(edge_contact), intent(in) :: edge
      real(wp), intent(in) :: q(n_local)
      type(contact_point), intent(in) :: perfect, point !! before and after `put_on_edge`
      type(contact_gradient), intent(inout) :: gradient
      type(radius_rates) :: rate
      real(wp) :: along(n_local), lengths(n_local, 3), rates(n_local, 3), d2(n_local, 3), of_rates(3)

      rate = rates_of(pair, q, perfect)
      lengths(:, by_a) = gradient%rho_a
      lengths(:, by_b) = gradient%rho_b
      call rate_gradients(pair, rate, q, point, gradient, lengths(:, by_line), along, rates(:, by_a), rates(:, by_b))
      rates(:, by_line) = gradient%rho_dot
      of_rates = [rate%a, rate%b, perfect%rho_dot]
      d2 = matmul(lengths, edge%d2_h)
      gradient%line = lengths(:, by_line)
      gradient%h = gradient%h + matmul(lengths, edge%d_h - on_path)
      gradient%h_dot = gradient%h_dot + matmul(rates, edge%d_h - on_path) + matmul(d2, of_rates)
      gradient%rho_dot = rates(:, by_a) + rates(:, by_b) - gradient%h_dot
      gradient%l_a = matmul(lengths, merge(edge%d_own, edge%d_mate, edge%wheel == by_a)) - pair%share_a*gradient%h
      gradient%l_b = matmul(lengths, merge(edge%d_own, edge%d_mate, edge%wheel == by_b)) - pair%share_b*gradient%h
      call sliding_gradient(pair, point, along, gradient)
      gradient%arm_a = pair%r_ba*d2(:, by_a)
      gradient%arm_b = pair%r_bb*d2(:, by_b)
      gradient%lift = -d2(:, by_line)
      gradient%tilt = (pair%r_ba*(d2(:, by_a) + d2(:, by_line)) + pair%r_bb*(d2(:, by_b) + d2(:, by_line)) &
                       - point%tilt*gradient%line)/edge%line
   end subroutine edge_gradient

end module evl_edge_contact
