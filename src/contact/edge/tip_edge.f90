!> Contact of the tip edge of a tooth with the flank of its mate, before and after the path of contact (corner contact).
!>
!> Written for the edge of B on the flank of A; for the edge of A both wheels are exchanged. x = rho_B - rho_F is the roll length by
!> which B's contact has passed the end of its flank, with the radius of curvature rho_F there. r_t is the rounding of the tip (0: a
!> sharp edge), and l_M = rho_F - r_t the length at the centre M of the rounding. B rotates by theta = x/r_bB; M moves by
!>
!>    a_t = r_bB (1 - cos theta) + l_M sin theta,   a_e = -r_bB sin theta + l_M (1 - cos theta)
!>
!> The tangent from A's base circle to M had the length l_0 = rho - l_M, where rho is the length of the line of action. Its length
!> is now l, and it has rotated by delta. A's flank is an involute, whose normals are these tangents. The gap is therefore that of
!> the flanks without an end, and S = (l - l_0) + r_bA delta + x: a deviation of the edge's wheel beyond the end of its flank.
!>
!> Every term below is of second order in x, so that S keeps its precision beside lengths of the size of the wheel. With
!> beta = theta - delta, and V the motion of M per x along t and e rotated by delta:
!>
!>    S = r_bB (theta - sin theta) + l_M (1 - cos theta) - a_t sin delta - (a_e + l_0) (1 - cos delta) + r_bA (delta - sin delta)
!>    S' = 1 - cos beta + (l_M/r_bB) sin beta,   V_t = sin beta + (l_M/r_bB) cos beta,   S'' = V_t (1/r_bB + V_t/l)
!>    delta' = -V_t/l,   dS/drho = cos delta - 1
!>
!> Derived in docs/theory/compliant_flanks.md.
module evl_tip_edge
   use evl_flank_deviation, only: deviation_on, flank_branch
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: edge_geometry, edge_t, end_of_flank, evaluate_edge, small

   !> A tip edge and the wheels in contact at it.
   type :: edge_t
      real(wp) :: r_b = 0.0_wp     !! base radius of the edge's wheel [m]
      real(wp) :: r_mate = 0.0_wp  !! base radius of its mate [m]
      real(wp) :: rho_end = 0.0_wp !! radius of curvature at the end of the edge's flank [m]
      real(wp) :: rounding = 0.0_wp !! radius of the tip's rounding [m]
   end type edge_t

   !> Contact of an edge. Derivatives with respect to x at constant rho, and to rho at constant x.
   type :: edge_geometry
      logical :: exists = .false. !! false if the edge is inside the mate's base circle
      real(wp) :: gap = 0.0_wp    !! S [m]
      real(wp) :: d_x = 0.0_wp, d_rho = 0.0_wp
      real(wp) :: d_xx = 0.0_wp, d_x_rho = 0.0_wp, d_rho_rho = 0.0_wp !! [1/m]
      real(wp) :: foot = 0.0_wp   !! r_mate delta: radius of curvature of the mate on the path less that at the edge [m]
      real(wp) :: foot_x = 0.0_wp, foot_rho = 0.0_wp
      real(wp) :: foot_xx = 0.0_wp, foot_x_rho = 0.0_wp, foot_rho_rho = 0.0_wp !! [1/m]
      real(wp) :: arm = 0.0_wp    !! of the friction force about the edge's wheel [m]
      real(wp) :: arm_x = 0.0_wp, arm_rho = 0.0_wp
      real(wp) :: turn = 0.0_wp   !! delta, rotation of the normal [rad]
   end type edge_geometry

   real(wp), parameter :: small = 0.5_wp !! below this value x - sin x is computed from a series [rad]
   integer, parameter :: most_turns = 50
   real(wp), parameter :: tolerance = 1.0e-14_wp !! of x_*, relative

contains

   include "numerics/sine_cosine.inc"
   include "numerics/arctangent.inc"
   include "contact/tangent_line.inc"
   include "contact/edge/tip_edge.inc"

   !> Start of edge contact for a flank with a sloping deviation at its end: x_* [m], from S'(x_*) = e'. Before x_* the extension of
   !> the flank touches first. Equation F16.
   !>
   !> Valid: any slope of a flank; 0 for no slope, and for flanks with material increasing towards their end
   pure real(wp) function end_of_flank(edge, profile, rho) result(x)
      type(edge_t), intent(in) :: edge
      type(flank_branch), intent(in) :: profile !! deviation of the flank at its end and beyond
      real(wp), intent(in) :: rho               !! length of the line of action [m]
      type(edge_geometry) :: at
      real(wp) :: step, e, slope, d2e
      integer :: turn

      x = 0
      call deviation_on(profile, edge%rho_end, e, slope, d2e)
      if (.not. slope > 0) return
      do turn = 1, most_turns
         call evaluate_edge(edge, x, rho, at)
         call deviation_on(profile, edge%rho_end + x, e, slope, d2e)
         step = (slope - at%d_x)/(at%d_xx - d2e)
         x = x + step
         if (abs(step) <= tolerance*x) return
      end do
   end function end_of_flank

end module evl_tip_edge
