!> Interference of a mate's tip with an undercut gear, outside the path of contact.
!>
!> The gear's centre is the origin, that of its mate lies at (0, a_w). The gear's flank faces the mate's tooth, and the line of
!> action touches the gear's base circle at T1, the angle alpha_w from the centre line. All angles are clockwise from it. A point
!> of the gear's tooth at the radius r has the angle theta_R + psi(r). theta_R is that of the root of the involute on the base
!> circle; psi is the involute function of r, or below the form circle that of the fillet. The end of the mate's involute, radius
!> of curvature rho_a2, meets the gear's involute, continued, at the radius of curvature rho_1 = T1T2 - rho_a2. Let beta be the
!> angle of the centre M of the mate's tip rounding about the mate's centre, radius r_a2 - r_t:
!>
!>    theta_R = alpha_w - rho_1/r_b1 + (z_2/z_1) (beta - beta_0)    beta_0 = atan((rho_a2 - r_t)/r_b2) - alpha_w
!>
!> Until the end of the involute is on the line of action, beta > beta_0, it is the outermost point of the mate's tip. Later
!> it is the envelope of the rounding, whose normals pass through the pitch point P: M + r_t (M - P)/|M - P|. The gap is the
!> arc from that point to the gear's tooth at the same radius; if it is negative, the tip enters material.
!>
!> Source: ISO 21771, interference of the tooth tip with the root fillet, named there without a formula; the law of gearing.
module evl_tip_interference
   use evl_gear, only: gear_t
   use evl_involute_angle, only: involute_of_tangent
   use evl_kinds, only: wp
   use evl_rack_generation, only: fillet_at_radius
   implicit none (type, external)
   private

   public :: tip_gap

   integer, parameter :: n_positions = 256 !! positions of the mate at which the gap is evaluated before it is minimised

   !> Positions and angles of a mesh, as above.
   type :: tips_t
      real(wp) :: ratio        !! z_2/z_1
      real(wp) :: distance     !! a_w [m]
      real(wp) :: pitch_radius !! r_w of the gear [m]
      real(wp) :: centre       !! radius of M [m]
      real(wp) :: rounding     !! r_t [m]
      real(wp) :: end_radius   !! r_Fa of the mate [m]
      real(wp) :: behind       !! angle from M to the end of the involute [rad]
      real(wp) :: first        !! beta_0 [rad]
      real(wp) :: root         !! theta_R at beta_0 [rad]
   end type tips_t

contains

   !> Smallest gap between the tip of a mate and an undercut gear [m]; negative: depth of interference. Equation G14.
   !>
   !> Valid: undercut gear; tip of the mate outside the root circle of the gear, a_w > r_a2 + r_f1.
   pure real(wp) function tip_gap(gear, mate, distance, alpha_w, rho_tip) result(gap)
      type(gear_t), intent(in) :: gear, mate
      real(wp), intent(in) :: distance !! a_w [m]
      real(wp), intent(in) :: alpha_w  !! working pressure angle [rad]
      real(wp), intent(in) :: rho_tip  !! radius of curvature at the end of the mate's involute [m]
      real(wp), parameter :: golden = 0.61803398874989484820_wp
      type(tips_t) :: tips
      real(wp) :: last, low, high, positions(2), gaps(2), at
      integer :: i, lowest

      tips%ratio = real(mate%teeth, wp)/real(gear%teeth, wp)
      tips%distance = distance
      tips%pitch_radius = distance*gear%teeth/(gear%teeth + mate%teeth)
      tips%rounding = mate%tip_rounding
      tips%centre = mate%tip_radius - mate%tip_rounding
      tips%end_radius = mate%tip_form_radius
      tips%first = atan((rho_tip - tips%rounding)/mate%base_radius) - alpha_w
      tips%behind = atan(rho_tip/mate%base_radius) - alpha_w - tips%first
      tips%root = alpha_w - (distance*sin(alpha_w) - rho_tip)/gear%base_radius
      ! position at which the end of the involute leaves the gear's tip circle
      last = acos(min((distance**2 + tips%end_radius**2 - gear%tip_radius**2)/(2*distance*tips%end_radius), 1.0_wp)) - tips%behind
      lowest = 0
      gap = huge(gap)
      do i = 0, n_positions
         at = gap_at(gear, tips, last*i/n_positions)
         if (at < gap) lowest = i
         gap = min(gap, at)
      end do
      low = last*max(lowest - 1, 0)/n_positions
      high = last*min(lowest + 1, n_positions)/n_positions
      positions = [high - golden*(high - low), low + golden*(high - low)]
      gaps = [gap_at(gear, tips, positions(1)), gap_at(gear, tips, positions(2))]
      do i = 1, 60
         gap = min(gap, gaps(1), gaps(2))
         if (gaps(1) < gaps(2)) then
            high = positions(2)
            positions = [high - golden*(high - low), positions(1)]
            gaps = [gap_at(gear, tips, positions(1)), gaps(1)]
         else
            low = positions(1)
            positions = [positions(2), low + golden*(high - low)]
            gaps = [gaps(2), gap_at(gear, tips, positions(2))]
         end if
      end do
   end function tip_gap

   !> Gap at a position of the mate [m]; huge outside the gear's tip circle. Equation G15.
   pure real(wp) function gap_at(gear, tips, beta) result(gap)
      type(gear_t), intent(in) :: gear
      type(tips_t), intent(in) :: tips
      real(wp), intent(in) :: beta !! [rad]
      real(wp) :: point(2), from_pitch(2), radius, tooth

      if (beta > tips%first) then
         point = [tips%end_radius*sin(beta + tips%behind), tips%distance - tips%end_radius*cos(beta + tips%behind)]
      else
         point = [tips%centre*sin(beta), tips%distance - tips%centre*cos(beta)]
         from_pitch = [point(1), point(2) - tips%pitch_radius]
         point = point + tips%rounding*from_pitch/norm2(from_pitch)
      end if
      radius = norm2(point)
      gap = huge(gap)
      if (radius >= gear%tip_radius) return
      if (radius > gear%form_radius) then
         tooth = involute_of_tangent(sqrt((radius - gear%base_radius)*(radius + gear%base_radius))/gear%base_radius)
      else
         tooth = fillet_at_radius(gear%reference_radius, gear%pressure_angle, gear%tool_depth, gear%tool_rounding, radius)
      end if
      gap = radius*(tips%root + tips%ratio*(beta - tips%first) + tooth - atan2(point(1), point(2)))
   end function gap_at

end module evl_tip_interference
