!> Deviation of a flank at eight positions at once; evl_flank_deviation is the version for one position.
module evl_deviation_lanes
   use evl_flank_deviation, only: corner_in, flank_branch, flank_deviation_t, relief_t
   use evl_kinds, only: lanes, wp
   implicit none (type, external)
   private

   public :: deviation_in_lanes, find_slope_in_lanes, slope_in_lanes, turned_in_lanes

contains

   include "geometry/flank_branch.inc"
   include "numerics/sine_cosine.inc"

   !> e and its slope; `deviation_on` for eight positions.
   pure subroutine deviation_in_lanes(branch, rho, e, de)
      type(flank_branch), intent(in) :: branch
      real(wp), intent(in) :: rho(lanes) !! radii of curvature [m]
      real(wp), intent(out) :: e(lanes), de(lanes)
      real(wp) :: d2e(lanes)
      integer :: l

      !$omp simd
      do l = 1, lanes
         call profile_deviation(branch, rho(l), e(l), de(l), d2e(l))
      end do
      if (branch%is_second .and. branch%is_corner) then
         !$omp simd
         do l = 1, lanes
            call touch_at_corner(branch, rho(l), e(l), de(l), d2e(l))
         end do
      else if (branch%is_second) then
         !$omp simd
         do l = 1, lanes
            call touch_beside(branch, rho(l), e(l), de(l), d2e(l))
         end do
      end if
      if (.not. abs(branch%runout) > 0) return
      !$omp simd
      do l = 1, lanes
         call add_runout(branch, rho(l), e(l), de(l), d2e(l))
      end do
   end subroutine deviation_in_lanes

   !> Deviation, and slope with derivative at the touching point, in one loop that evaluates common terms once.
   pure subroutine turned_in_lanes(deviation, zone, branch, rho, e, de, s, ds)
      type(flank_deviation_t), intent(in) :: deviation
      integer, intent(in) :: zone
      type(flank_branch), intent(in) :: branch !! of the zone
      real(wp), intent(in) :: rho(lanes)
      real(wp), intent(out), dimension(lanes) :: e, de, s, ds
      real(wp) :: d2e(lanes), d2s(lanes)
      integer :: l

      if (branch%is_corner .or. abs(branch%runout) > 0) then
         call deviation_in_lanes(branch, rho, e, de)
         call slope_in_lanes(deviation, zone, branch, rho, s, ds)
         return
      end if
      !$omp simd
      do l = 1, lanes
         call touching_slope(branch, rho(l), s(l), ds(l), d2s(l))
         call profile_deviation(branch, rho(l), e(l), de(l), d2e(l))
         call touch_beside(branch, rho(l), e(l), de(l), d2e(l))
      end do
   end subroutine turned_in_lanes

   !> Slope at the touching point of a flank of second order, and its derivative; `slope_on` for eight positions.
   pure subroutine slope_in_lanes(deviation, zone, branch, rho, s, ds)
      type(flank_deviation_t), intent(in) :: deviation
      integer, intent(in) :: zone
      type(flank_branch), intent(in) :: branch !! of the zone
      real(wp), intent(in) :: rho(lanes)
      real(wp), intent(out) :: s(lanes), ds(lanes)
      real(wp) :: d2s(lanes)
      type(relief_t) :: relief
      integer :: l

      if (.not. branch%is_corner) then
         call find_slope_in_lanes(branch, rho, s, ds)
         return
      end if
      relief = corner_in(deviation, zone)
      !$omp simd
      do l = 1, lanes
         call slope_at_corner(relief, rho(l), s(l), ds(l), d2s(l))
      end do
   end subroutine slope_in_lanes

   !> The same away from corners; `find_slope` for eight positions.
   pure subroutine find_slope_in_lanes(branch, rho, s, ds)
      type(flank_branch), intent(in) :: branch
      real(wp), intent(in) :: rho(lanes)
      real(wp), intent(out) :: s(lanes), ds(lanes)
      real(wp) :: d2s(lanes)
      integer :: l

      !$omp simd
      do l = 1, lanes
         call touching_slope(branch, rho(l), s(l), ds(l), d2s(l))
      end do
   end subroutine find_slope_in_lanes

end module evl_deviation_lanes
