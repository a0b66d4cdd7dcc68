!> What a flank lacks in material at eight places at once, as evl_flank_deviation has it at one.
module evl_deviation_lanes
   use evl_flank_deviation, only: flank_branch
   use evl_kinds, only: lanes, wp
   implicit none (type, external)
   private

   public :: deviation_in_lanes

contains

   include "geometry/flank_branch.inc"
   include "numerics/sine_cosine.inc"

   !> e and its slope, as `deviation_on`.
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

end module evl_deviation_lanes
