!> Actual contact position and curvature of deviating flanks, and the error of the gap of first order.
!>
!> Flanks rotated by their slopes touch beside the line of action, at x along the common tangent, where
!>
!>    g(x) = sum of  d**2 (rho/2 + d/3)/r_b**2 + e(rho + d)  over A and B,   (rho + d)**2 = rho**2 +- 2 r_b x,  + for A
!>
!> has its minimum: along the arc of an involute ds = rho/r_b drho, and it rotates by drho/r_b. Consider the involute moved by e
!> into the material. The derivatives of e along the arc are e_s = e' r_b/rho and e_ss = (r_b/rho)**2 (e'' - e'/rho). With
!> a = 1 - e/rho and a_s = -e_s/rho + e r_b/rho**3, the curvature is
!>
!>    ((a**2 + e_s**2)/rho + a e_ss - e_s a_s)/(a**2 + e_s**2)**(3/2)
!>
!> Source: derived in docs/theory/deviations.md.
module evl_contact_curvature
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use evl_contact_point, only: contact_point, is_internal
   use evl_deviating_flanks, only: flank_value, flanks_turned
   use evl_flank_deviation, only: deviation_borders, deviation_on, deviation_zone, flank_branch, flank_deviation_t, &
                                  profile_zone, zone_none, zone_root, zone_root_corner, zone_tip, zone_tip_corner
   use evl_kinds, only: pi, wp
   use evl_pair_point, only: by_a, by_b
   use evl_tooth_contact, only: contact_mode, edge_wheel, flank_branches, flank_values, no_mode, tooth_contact_t
   implicit none (type, external)
   private

   public :: contact_pressure, edge_curvature, first_order_gap, largest_second_order, pressure_at, second_order_gap, &
             contact_curvature

   integer, parameter :: n_positions = 200 !! number of positions evaluated on the path
   integer, parameter :: n_teeth = 60   !! number of tooth pairs evaluated if runout makes them differ
   integer, parameter :: n_sections = 60
   integer, parameter :: n_newton = 3   !! steps to the touching point, which is within a millimetre
   real(wp), parameter :: enough = 1.0e-9_wp !! step to that point over the radius of the contact; curvatures have the same accuracy
   real(wp), parameter :: golden = 0.61803398874989485_wp

contains

   include "laws/hertz_pressure.inc"

   !> Largest contact pressure of a tooth pair [Pa], Hertz's for a line contact.
   pure real(wp) function contact_pressure(contact, mode, normal, point, foot) result(pressure)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      real(wp), intent(in) :: normal !! F_n [N]
      type(contact_point), intent(in) :: point
      real(wp), intent(in) :: foot(2) !! as in `contact_curvature`

      pressure = 0
      if (normal > 0) pressure = pressure_at(contact, normal, contact_curvature(contact, mode, point, foot))
   end function contact_pressure

   !> The same for a given curvature of the flanks [Pa].
   pure real(wp) function pressure_at(contact, normal, curvature) result(pressure)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: normal    !! F_n [N] >= 0
      real(wp), intent(in) :: curvature !! as from `contact_curvature`

      pressure = hertz_pressure(normal, contact%width, contact%e_star, curvature)
   end function pressure_at

   !> Sum of the curvatures of two flanks at their contact [1/m]; NaN if it is not positive, that is, if one flank is more concave
   !> than the other is convex, and on a sharp edge. At the corner of a linear relief, the value of the relief.
   pure real(wp) function contact_curvature(contact, mode, point, foot) result(curvature)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point !! on the line of action
      real(wp), intent(in) :: foot(2)          !! roll lengths at which A and B are loaded, to locate edge contact on the mate [m]
      type(flank_branch) :: branch_a, branch_b
      type(flank_value) :: a, b
      type(contact_mode) :: profile
      real(wp) :: on_a, on_b, rho_a, rho_b, sharpness, step, x
      integer :: i, wheel

      wheel = edge_wheel(mode)
      if (wheel > 0) then
         curvature = edge_curvature(contact%tips(wheel)%edge%rounding, foot(by_a + by_b - wheel))
         return
      end if
      curvature = 1/point%rho_a + 1/point%rho_b
      if (is_involute(contact%deviation_a, mode%zone_a) .and. is_involute(contact%deviation_b, mode%zone_b)) return
      profile = on_profile(mode)
      call profile_branches(contact, profile, branch_a, branch_b)
      associate (r_a => contact%pair%r_ba, r_b => contact%pair%r_bb)
         curvature = ieee_value(curvature, ieee_quiet_nan)
         rho_a = point%rho_a
         rho_b = point%rho_b
         x = 0
         do i = 1, n_newton
            call deviation_on(branch_a, rho_a, a%e, a%de, a%d2e)
            call deviation_on(branch_b, rho_b, b%e, b%de, b%d2e)
            sharpness = 1/rho_a + 1/rho_b + arc_second(a, rho_a, r_a) + arc_second(b, rho_b, r_b)
            if (.not. sharpness > 0) return
            step = ((rho_a - point%rho_a)/r_a + a%de*r_a/rho_a - (rho_b - point%rho_b)/r_b - b%de*r_b/rho_b)/sharpness
            if (abs(step)*sharpness < enough) exit
            x = x - step
            rho_a = moved(point%rho_a, r_a, x)
            rho_b = moved(point%rho_b, r_b, -x)
         end do
         on_a = within(contact%deviation_a, profile%zone_a, rho_a)
         on_b = within(contact%deviation_b, profile%zone_b, rho_b)
         if (i > n_newton .or. abs(on_a - rho_a) > 0 .or. abs(on_b - rho_b) > 0) then
            call deviation_on(branch_a, on_a, a%e, a%de, a%d2e)
            call deviation_on(branch_b, on_b, b%e, b%de, b%d2e)
         end if
         x = flank_curvature(a, on_a, r_a) + flank_curvature(b, on_b, r_b)
      end associate
      if (x > 0) curvature = x
   end function contact_curvature

   !> Mode with the reliefs in place of their corners.
   elemental type(contact_mode) function on_profile(mode) result(profile)
      type(contact_mode), intent(in) :: mode

      profile = mode
      if (mode%zone_a == zone_tip_corner) profile%zone_a = zone_tip
      if (mode%zone_a == zone_root_corner) profile%zone_a = zone_root
      if (mode%zone_b == zone_tip_corner) profile%zone_b = zone_tip
      if (mode%zone_b == zone_root_corner) profile%zone_b = zone_root
   end function on_profile

   !> Branches of the material itself, on the line of action (first order).
   pure subroutine profile_branches(contact, mode, a, b)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(flank_branch), intent(out) :: a, b

      call flank_branches(contact, mode, a, b)
      a%is_second = .false.
      b%is_second = .false.
   end subroutine profile_branches

   !> Sum of the curvatures of a rounded edge and its mate [1/m]; NaN for a sharp edge.
   elemental real(wp) function edge_curvature(rounding, rho_mate) result(curvature)
      real(wp), intent(in) :: rounding, rho_mate !! [m]

      curvature = ieee_value(curvature, ieee_quiet_nan)
      if (rounding > 0) curvature = 1/rho_mate + 1/rounding
   end function edge_curvature

   !> Whether a flank is an undisplaced involute in a zone.
   pure logical function is_involute(deviation, zone)
      type(flank_deviation_t), intent(in) :: deviation
      integer, intent(in) :: zone

      is_involute = .not. deviation%exists
      if (is_involute .or. zone /= zone_none) return
      is_involute = .not. (deviation%crowning > 0 .or. allocated(deviation%pitch) .or. deviation%eccentricity > 0)
   end function is_involute

   !> Radius of curvature of an involute at a distance along its arc, limited short of its root [m].
   pure real(wp) function moved(rho, base_radius, arc)
      real(wp), intent(in) :: rho, base_radius, arc !! [m]

      moved = sign(sqrt(max(rho**2 + 2*base_radius*arc, (rho/10)**2)), rho)
   end function moved

   !> Radius of curvature limited to the borders of a zone.
   pure real(wp) function within(deviation, zone, rho)
      type(flank_deviation_t), intent(in) :: deviation
      integer, intent(in) :: zone
      real(wp), intent(in) :: rho
      real(wp) :: rho_root, rho_tip

      call deviation_borders(deviation, rho_root, rho_tip)
      within = rho
      if (zone == zone_tip) within = max(rho, rho_tip)
      if (zone == zone_root) within = min(rho, rho_root)
      if (zone == zone_none) within = min(max(rho, rho_root), rho_tip)
   end function within

   !> Second derivative of a deviation with respect to the arc of its involute [1/m]. Equation D8.
   pure real(wp) function arc_second(flank, rho, base_radius)
      type(flank_value), intent(in) :: flank
      real(wp), intent(in) :: rho, base_radius

      arc_second = (base_radius/rho)**2*(flank%d2e - flank%de/rho)
   end function arc_second

   !> Curvature of a deviating flank [1/m]. Equations D8, D9.
   pure real(wp) function flank_curvature(flank, rho, base_radius) result(curvature)
      type(flank_value), intent(in) :: flank
      real(wp), intent(in) :: rho, base_radius
      real(wp) :: slope, a, a_slope

      slope = flank%de*base_radius/rho
      a = 1 - flank%e/rho
      a_slope = -slope/rho + flank%e*base_radius/rho**3
      associate (length => a**2 + slope**2)
         curvature = (length/rho + a*arc_second(flank, rho, base_radius) - slope*a_slope)/(length*sqrt(length))
      end associate
   end function flank_curvature

   !> Amount by which the gap of the model, of first or second order, exceeds that of the actual flanks [m], at least 0.
   !> Equation D3.
   !>
   !> The minimum of g is found by golden section search: reliefs and crowning make g convex.
   pure real(wp) function second_order_gap(contact, pair, rho_a) result(gap)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: pair      !! number of the tooth pair
      real(wp), intent(in) :: rho_a    !! position on the line of action at its nominal length [m]
      real(wp) :: low, high, left, right, at_left, at_right
      integer :: i

      associate (rho_b => contact%pair%rho_0 - rho_a)
         low = -0.45_wp*rho_a**2/contact%pair%r_ba ! nine tenths of the arc to the root
         high = 0.45_wp*rho_b**2/contact%pair%r_bb
         if (is_internal(contact%pair)) then ! the arc of the ring goes on past its root
            low = -0.45_wp*min(abs(rho_a**2/contact%pair%r_ba), abs(rho_b**2/contact%pair%r_bb))
            high = -low
         end if
         left = high - golden*(high - low)
         right = low + golden*(high - low)
         at_left = gap_beside(contact, pair, rho_a, rho_b, left)
         at_right = gap_beside(contact, pair, rho_a, rho_b, right)
         do i = 1, n_sections
            if (at_left < at_right) then
               high = right
               right = left
               at_right = at_left
               left = high - golden*(high - low)
               at_left = gap_beside(contact, pair, rho_a, rho_b, left)
            else
               low = left
               left = right
               at_left = at_right
               right = low + golden*(high - low)
               at_right = gap_beside(contact, pair, rho_a, rho_b, right)
            end if
         end do
         gap = max(first_order_gap(contact, pair, rho_a, rho_b) - min(at_left, at_right), 0.0_wp)
      end associate
   end function second_order_gap

   !> Deviation of the flanks of a tooth pair on the line of action, as used in the gap of the model [m].
   pure real(wp) function first_order_gap(contact, pair, rho_a, rho_b) result(gap)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: pair
      real(wp), intent(in) :: rho_a, rho_b !! [m]
      type(contact_point) :: there
      type(flank_value) :: a, b
      type(flanks_turned) :: turned
      type(contact_mode) :: mode

      there%rho_a = rho_a
      there%rho_b = rho_b
      mode = no_mode
      mode%tooth_pair = pair
      mode%zone_a = deviation_zone(contact%deviation_a, rho_a)
      mode%zone_b = deviation_zone(contact%deviation_b, rho_b)
      call flank_values(contact, mode, there, a, b, turned)
      gap = a%e + b%e
   end function first_order_gap

   !> g(x) of a tooth pair [m]. Equation D3.
   pure real(wp) function gap_beside(contact, pair, rho_a, rho_b, x) result(gap)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: pair
      real(wp), intent(in) :: rho_a, rho_b, x !! [m]
      type(flank_branch) :: branch_a, branch_b
      type(flank_value) :: a, b
      type(contact_mode) :: mode
      real(wp) :: on_a, on_b

      on_a = moved(rho_a, contact%pair%r_ba, x)
      on_b = moved(rho_b, contact%pair%r_bb, -x)
      mode = no_mode
      mode%tooth_pair = pair
      mode%zone_a = profile_zone(contact%deviation_a, on_a) ! flanks are extended past their ends
      mode%zone_b = profile_zone(contact%deviation_b, on_b)
      call profile_branches(contact, mode, branch_a, branch_b)
      call deviation_on(branch_a, on_a, a%e, a%de, a%d2e)
      call deviation_on(branch_b, on_b, b%e, b%de, b%d2e)
      gap = turned_away(rho_a, on_a - rho_a, contact%pair%r_ba) + a%e + turned_away(rho_b, on_b - rho_b, contact%pair%r_bb) + b%e
   end function gap_beside

   !> Distance of an involute from its tangent at rho [m]. Equation D3.
   pure real(wp) function turned_away(rho, d, base_radius)
      real(wp), intent(in) :: rho, d, base_radius !! d: distance from rho [m]

      turned_away = (d/base_radius)**2*(rho/2 + d/3)
   end function turned_away

   !> Largest `second_order_gap` on the path of contact.
   pure subroutine largest_second_order(contact, gap, rho_a)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(out) :: gap   !! [m]
      real(wp), intent(out) :: rho_a !! its position [m]
      real(wp) :: here, found
      integer :: i, pair, pairs

      gap = 0
      rho_a = contact%rho_tip_a
      pairs = 1
      if (max(contact%deviation_a%eccentricity, contact%deviation_b%eccentricity) > 0) pairs = n_teeth
      associate (first => contact%pair%rho_0 - contact%rho_tip_b, last => contact%rho_tip_a)
         do i = 0, n_positions
            here = first + (last - first)*i/n_positions
            if (.not. min(here*contact%side(by_a), (contact%pair%rho_0 - here)*contact%side(by_b)) > 0) cycle
            do pair = 0, pairs - 1
               found = second_order_gap(contact, pair, here)
               if (found > gap) then
                  gap = found
                  rho_a = here
               end if
            end do
         end do
      end associate
   end subroutine largest_second_order

end module evl_contact_curvature
