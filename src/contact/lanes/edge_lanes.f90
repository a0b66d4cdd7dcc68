!> Tooth pairs past the end of a flank in eight states at once, with first derivatives only. The versions for one state are
!> evl_pair_point and evl_edge_contact.
module evl_edge_lanes
   use evl_deviation_lanes, only: deviation_in_lanes, find_slope_in_lanes
   use evl_kinds, only: lanes, wp
   use evl_pair_point, only: by_a, by_b, by_line, tip_t
   use evl_tip_edge, only: edge_geometry, edge_t, small
   implicit none (type, external)
   private

   public :: find_feet_in_lanes, lane_edge, lane_gap, slopes_in_lanes

   !> As `edge_contact`, in eight states; not initialised.
   type :: lane_edge
      real(wp) :: margin(lanes)       !! 1, or 0 if the edge is inside the mate's base circle
      real(wp) :: line(lanes)         !! rho [m]
      real(wp) :: foot(lanes, 2)      !! roll lengths at which A and B are loaded [m]
      real(wp) :: d_foot(lanes, 3, 2) !! their derivatives
      real(wp) :: d_h(lanes, 3)       !! of the penetration
   end type lane_edge

   !> Gap contribution of the wheel whose flank end is passed, as in `pair_feet`.
   type :: lane_gap
      real(wp) :: x(lanes)                      !! roll length past the end [m]
      real(wp), dimension(lanes) :: gap, by_own, by_line !! [m], derivatives with respect to its radius of curvature and to rho
      real(wp) :: arm(lanes)                    !! of the friction force about it [m]
      real(wp) :: slope(lanes), d_slope(lanes)  !! of its flank at the contact, derivative to its radius of curvature [1/m]
   end type lane_gap

contains

   include "numerics/sine_cosine.inc"
   include "numerics/arctangent.inc"
   include "contact/tangent_line.inc"
   include "contact/edge/tip_edge.inc"

   !> Touching positions on both wheels.
   pure subroutine find_feet_in_lanes(tip, own, is_edge, rho_own, rho_mate, edge, past)
      type(tip_t), intent(in) :: tip
      integer, intent(in) :: own     !! wheel whose flank end is passed
      logical, intent(in) :: is_edge !! true: edge contact; false: contact on the extension of the flank
      real(wp), intent(in), dimension(lanes) :: rho_own, rho_mate
      type(lane_edge), intent(inout) :: edge !! with the length of the line of action
      type(lane_gap), intent(out) :: past
      integer :: mate

      mate = by_a + by_b - own
      edge%d_foot = 0
      edge%d_foot(:, mate, mate) = 1
      past%x = rho_own - tip%edge%rho_end
      past%slope = tip%slope
      past%d_slope = 0
      edge%foot(:, own) = tip%leaves
      if (is_edge) then
         call touch_in_lanes(tip, rho_mate, edge%line, past, edge%margin, edge%foot(:, mate), edge%d_foot(:, own, mate), &
                             edge%d_foot(:, by_line, mate))
         return
      end if
      edge%margin = 1
      edge%foot(:, mate) = rho_mate
      call deviation_in_lanes(tip%profile, rho_own, past%gap, past%by_own)
      if (tip%profile%slopes) call find_slope_in_lanes(tip%profile, rho_own, past%slope, past%d_slope)
      past%by_line = 0
      past%arm = rho_own
   end subroutine find_feet_in_lanes

   !> Contact of an edge with the mate.
   pure subroutine touch_in_lanes(tip, rho_mate, line, past, margin, foot, foot_own, foot_line)
      type(tip_t), intent(in) :: tip
      real(wp), intent(in), dimension(lanes) :: rho_mate, line
      type(lane_gap), intent(inout) :: past
      real(wp), intent(out), dimension(lanes) :: margin, foot, foot_own, foot_line !! roll length on the mate, its derivatives
      real(wp), dimension(lanes) :: gap_0, line_0, foot_0, foot_line_0
      type(edge_t) :: edge
      real(wp) :: tip_deviation
      integer :: l

      edge = tip%edge
      gap_0 = 0
      line_0 = 0
      foot_0 = 0
      foot_line_0 = 0
      if (tip%takes_over > 0) call begin_in_lanes(edge, tip%takes_over, line, gap_0, line_0, foot_0, foot_line_0)
      tip_deviation = tip%value
      !$omp simd
      do l = 1, lanes
         call touch_lane(edge, past%x(l), line(l), margin(l), past%gap(l), past%by_own(l), past%by_line(l), past%arm(l), foot(l), &
                         foot_own(l), foot_line(l))
         past%gap(l) = tip_deviation + (past%gap(l) - gap_0(l))
         past%by_line(l) = past%by_line(l) - line_0(l)
         foot(l) = rho_mate(l) - (foot(l) - foot_0(l))
         foot_own(l) = -foot_own(l)
         foot_line(l) = -(foot_line(l) - foot_line_0(l))
      end do
   end subroutine touch_in_lanes

   !> Edge contact at the position where it begins.
   pure subroutine begin_in_lanes(edge, x, line, gap, by_line, foot, foot_line)
      type(edge_t), intent(in) :: edge
      real(wp), intent(in) :: x, line(lanes)
      real(wp), intent(out), dimension(lanes) :: gap, by_line, foot, foot_line
      real(wp), dimension(lanes) :: margin, by_own, arm, foot_own
      integer :: l

      !$omp simd
      do l = 1, lanes
         call touch_lane(edge, x, line(l), margin(l), gap(l), by_own(l), by_line(l), arm(l), foot(l), foot_own(l), foot_line(l))
      end do
   end subroutine begin_in_lanes

   !> One lane of an edge, by `evaluate_edge`.
   pure subroutine touch_lane(edge, x, line, margin, gap, by_own, by_line, arm, foot, foot_own, foot_line)
      type(edge_t), intent(in) :: edge
      real(wp), intent(in) :: x, line
      real(wp), intent(out) :: margin, gap, by_own, by_line, arm, foot, foot_own, foot_line
      type(edge_geometry) :: at

      call evaluate_edge(edge, x, line, at)
      margin = merge(1.0_wp, 0.0_wp, at%exists)
      gap = at%gap
      by_own = at%d_x
      by_line = at%d_rho
      arm = at%arm
      foot = at%foot
      foot_own = at%foot_x
      foot_line = at%foot_rho
   end subroutine touch_lane

   !> Derivatives of the penetration, including the slopes of the deviations of both wheels.
   pure subroutine slopes_in_lanes(own, past, de, edge)
      integer, intent(in) :: own
      type(lane_gap), intent(in) :: past
      real(wp), intent(in) :: de(lanes, 2) !! of A and B
      type(lane_edge), intent(inout) :: edge
      integer :: i, w

      edge%d_h(:, by_a:by_b) = 1
      edge%d_h(:, own) = 1 - past%by_own
      edge%d_h(:, by_line) = -1 - past%by_line
      do w = by_a, by_b
         if (w == own) then
            edge%d_h(:, w) = edge%d_h(:, w) - de(:, w)
         else
            do i = by_a, by_line
               edge%d_h(:, i) = edge%d_h(:, i) - de(:, w)*edge%d_foot(:, i, w)
            end do
         end if
      end do
   end subroutine slopes_in_lanes

end module evl_edge_lanes
