!> Where the involute begins on a tooth that a rack cuts: at the end of the rack's straight flank, or where undercut ends it.
!>
!> The rack's tip is rounded by a circle round M, at `depth` below the line that rolls on the reference circle (radius r). The
!> straight flank ends where the circle begins, and cuts involute down to the radius of curvature
!>
!>    rho_F = r sin alpha - (depth/sin alpha + rounding)
!>
!> Where that is negative, the round tip cuts away a part of the involute: undercut. All normals of contact go through the
!> pitch point P. With M at u along the line and L = |PM|, the point of the fillet is P + (1 + rounding/L) (u, -depth) while the
!> wheel has turned by (u - u_F)/r, u_F = depth/tan alpha being the end of the flank. The involute begins where the fillet
!> crosses it.
!>
!> Source: ISO 21771, form diameter and undercut; ISO 53, basic rack; the fillet from the law of gearing.
module evl_rack_generation
   use evl_involute_angle, only: involute_of_tangent
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: fillet_at_radius, involute_start

contains

   !> Radius of curvature at which the involute begins, and whether that is the end of undercut.   Valid: see arguments
   pure subroutine involute_start(reference_radius, pressure_angle, depth, rounding, curvature, is_undercut)
      real(wp), intent(in) :: reference_radius !! r [m], > 0
      real(wp), intent(in) :: pressure_angle   !! of the rack [rad], 0 < alpha < pi/2
      real(wp), intent(in) :: depth            !! of M below the rolling line [m]; > 0 where there is undercut
      real(wp), intent(in) :: rounding         !! radius of the rack's tip [m], >= 0
      real(wp), intent(out) :: curvature       !! radius of curvature [m], >= 0
      logical, intent(out) :: is_undercut
      real(wp) :: base_radius, end_of_flank, low, high, middle, radius, angle, excess

      base_radius = reference_radius*cos(pressure_angle)
      end_of_flank = flank_end(reference_radius, pressure_angle, depth, rounding)
      is_undercut = end_of_flank < 0
      curvature = max(end_of_flank, 0.0_wp)
      if (.not. is_undercut .or. .not. depth > 0) return
      ! M below P cuts the root, which lies inside the base circle; at u_F the fillet leaves the tooth
      low = 0
      high = depth/tan(pressure_angle)
      do
         middle = 0.5_wp*(low + high)
         if (.not. (middle > low .and. middle < high)) exit
         call fillet_point(reference_radius, pressure_angle, depth, rounding, middle, radius, angle)
         ! the angle by which the fillet lies within the tooth that the involute alone would bound
         excess = 0
         if (radius > base_radius) excess = angle - involute_of_tangent(sqrt((radius - base_radius)*(radius + base_radius)) &
                                                                        /base_radius)
         if (radius <= base_radius .or. excess > 0) then
            low = middle
         else
            high = middle
         end if
      end do
      call fillet_point(reference_radius, pressure_angle, depth, rounding, high, radius, angle)
      curvature = sqrt(max((radius - base_radius)*(radius + base_radius), 0.0_wp))
   end subroutine involute_start

   !> rho_F, where the rack's straight flank ends; negative: undercut [m].
   pure real(wp) function flank_end(reference_radius, pressure_angle, depth, rounding)
      real(wp), intent(in) :: reference_radius, pressure_angle, depth, rounding !! as above

      flank_end = reference_radius*sin(pressure_angle) - (depth/sin(pressure_angle) + rounding)
   end function flank_end

   !> A point of the fillet: its radius, and its angle from the root of the involute on the base circle into the tooth.
   pure subroutine fillet_point(reference_radius, pressure_angle, depth, rounding, u, radius, angle)
      real(wp), intent(in) :: reference_radius, pressure_angle, depth, rounding !! as above
      real(wp), intent(in) :: u       !! of M along the rolling line [m]
      real(wp), intent(out) :: radius !! [m]
      real(wp), intent(out) :: angle  !! [rad]
      real(wp) :: stretch, along, height

      stretch = 1 + rounding/hypot(u, depth)
      along = stretch*u
      height = reference_radius - stretch*depth
      radius = hypot(along, height)
      angle = atan2(along, height) - (u - depth/tan(pressure_angle))/reference_radius - pressure_angle &
              + flank_end(reference_radius, pressure_angle, depth, rounding)/(reference_radius*cos(pressure_angle))
   end subroutine fillet_point

   !> The same angle, of the point at a radius; that of the deepest point below it [rad].   Valid: depth > 0, radius <= form radius
   pure real(wp) function fillet_at_radius(reference_radius, pressure_angle, depth, rounding, at_radius) result(angle)
      real(wp), intent(in) :: reference_radius, pressure_angle, depth, rounding !! as above
      real(wp), intent(in) :: at_radius !! [m]
      real(wp) :: low, high, middle, radius

      low = 0
      high = depth/tan(pressure_angle)
      do ! the radius increases with u
         middle = 0.5_wp*(low + high)
         call fillet_point(reference_radius, pressure_angle, depth, rounding, middle, radius, angle)
         if (.not. (middle > low .and. middle < high)) exit
         if (radius < at_radius) then
            low = middle
         else
            high = middle
         end if
      end do
   end function fillet_at_radius

end module evl_rack_generation
