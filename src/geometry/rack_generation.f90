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

   public :: involute_start

contains

   !> Radius of curvature at which the involute begins, and whether that is the end of undercut.   Valid: see arguments
   pure subroutine involute_start(reference_radius, pressure_angle, depth, rounding, curvature, is_undercut)
      real(wp), intent(in) :: reference_radius !! r [m], > 0
      real(wp), intent(in) :: pressure_angle   !! of the rack [rad], 0 < alpha < pi/2
      real(wp), intent(in) :: depth            !! of M below the rolling line [m]; > 0 where there is undercut
      real(wp), intent(in) :: rounding         !! radius of the rack's tip [m], >= 0
      real(wp), intent(out) :: curvature       !! radius of curvature [m], >= 0
      logical, intent(out) :: is_undercut
      real(wp) :: base_radius, flank_end, low, high, middle, radius, excess

      base_radius = reference_radius*cos(pressure_angle)
      flank_end = reference_radius*sin(pressure_angle) - (depth/sin(pressure_angle) + rounding)
      is_undercut = flank_end < 0
      curvature = max(flank_end, 0.0_wp)
      if (.not. is_undercut .or. .not. depth > 0) return
      ! M below P cuts the root, which lies inside the base circle; at u_F the fillet leaves the tooth
      low = 0
      high = depth/tan(pressure_angle)
      do
         middle = 0.5_wp*(low + high)
         if (.not. (middle > low .and. middle < high)) exit
         call fillet_point(middle, radius, excess)
         if (radius <= base_radius .or. excess > 0) then
            low = middle
         else
            high = middle
         end if
      end do
      call fillet_point(high, radius, excess)
      curvature = sqrt(max((radius - base_radius)*(radius + base_radius), 0.0_wp))

   contains

      !> A point of the fillet: its radius, and the angle by which it lies within the tooth that the involute alone would bound.
      pure subroutine fillet_point(u, radius, excess)
         real(wp), intent(in) :: u       !! of M along the rolling line [m]
         real(wp), intent(out) :: radius !! [m]
         real(wp), intent(out) :: excess !! [rad]; 0 inside the base circle
         real(wp) :: stretch, along, height

         stretch = 1 + rounding/hypot(u, depth)
         along = stretch*u
         height = reference_radius - stretch*depth
         radius = hypot(along, height)
         excess = 0
         if (radius <= base_radius) return
         excess = atan2(along, height) - (u - depth/tan(pressure_angle))/reference_radius - pressure_angle &
                  + flank_end/base_radius - involute_of_tangent(sqrt((radius - base_radius)*(radius + base_radius))/base_radius)
      end subroutine fillet_point

   end subroutine involute_start

end module evl_rack_generation
