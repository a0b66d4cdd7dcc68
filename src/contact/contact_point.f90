!> Kinematic quantities of a contact that the forces depend on, for every tracking method.
module evl_contact_point
   use evl_kinds, only: wp
   use evl_local_variables, only: at_normal, at_omega, at_psi_dot_a, at_psi_dot_b, at_v_a, at_v_b, n_local
   implicit none (type, external)
   private

   public :: tracked_pair, contact_point, contact_gradient, base_arc, complete_point, complete_gradient
   public :: is_internal, rho_of_ring

   !> Constants of one tooth pair for contact tracking. Base radii have a sign: that of an internal wheel is negative, and so are
   !> its radii of curvature, R and rho_0.
   type :: tracked_pair
      real(wp) :: sigma       !! +1: driving wheel nominally clockwise, -1: counterclockwise
      real(wp) :: r_ba, r_bb  !! base radii [m]
      real(wp) :: r_b         !! R = r_bA + r_bB [m]
      real(wp) :: rho_0       !! |K_A K_B| at the reference centre distance [m]
      real(wp) :: gap_0 = 0.0_wp !! gap of the flanks when the wheels are in their nominal positions [m]
      real(wp) :: ratio_a     !! g_A: nominal speed of A over that of the reference wheel
      real(wp) :: ratio_b     !! g_B
      real(wp) :: advance     !! d rho_A0/d theta = -sigma r_bA g_A [m]
      real(wp) :: share_a     !! w_A = E* (1-nu_A^2)/E_A: point of action of the force between P_A and P_B
      real(wp) :: share_b     !! w_B = 1 - w_A
   end type tracked_pair

   !> Kinematic quantities of a contact that the forces depend on.
   type :: contact_point
      logical :: exists        !! false if the tracked points have left the involutes
      real(wp) :: h            !! penetration; negative: gap [m]
      real(wp) :: h_dot        !! its rate [m/s]
      real(wp) :: rho_a, rho_b !! radii of curvature [m]
      real(wp) :: s, c         !! direction of the normal: e = (-s, c), t = (c, s) in (t_0, e_0)
      real(wp) :: l_a, l_b     !! arms of the friction force [m]
      real(wp) :: v_t          !! sliding velocity along t [m/s]
      real(wp) :: arm_a, arm_b !! arms of the normal force: the base radii, if the flanks have no deviations [m]
      real(wp) :: tilt         !! slope of a deviating flank: component of the normal force along t on A, relative to the force
      real(wp) :: rho_dot      !! rate of rho_a + rho_b - h: the length of the line of action if flanks have no deviations [m/s]
      real(wp) :: omega_a, omega_b !! angular velocities [rad/s]
      real(wp) :: multiplier   !! normal force of a rigid contact [N]
   end type contact_point

   !> Derivatives of a `contact_point` with respect to the local variables; `angle` is that of the normal.
   type :: contact_gradient
      real(wp) :: h(n_local), h_dot(n_local), rho_a(n_local), rho_b(n_local), angle(n_local)
      real(wp) :: l_a(n_local), l_b(n_local), v_t(n_local), rho_dot(n_local)
      real(wp) :: arm_a(n_local), arm_b(n_local), tilt(n_local) !! set for deviating flanks only
      real(wp) :: line(n_local), lift(n_local) !! past the end of a flank only: length of the line of action, force part against e
   end type contact_gradient

contains

   include "contact/contact_point.inc"

   !> Whether one of the wheels is internal.
   pure logical function is_internal(pair)
      type(tracked_pair), intent(in) :: pair

      is_internal = pair%r_b < 0
   end function is_internal

   !> Radius of curvature of an internal pair in the laws of force [m]: h - rho_i, so that the sum is |rho| + h as that of an
   !> external pair, in place of rho + h. Equation I9.
   elemental real(wp) function rho_of_ring(rho, h)
      real(wp), intent(in) :: rho, h !! radius of curvature rho_A or rho_B, penetration [m]

      rho_of_ring = h - rho
   end function rho_of_ring

   !> Derivatives of `complete_point`; h, rho_a, rho_b and angle must already be set.
   pure subroutine complete_gradient(pair, q, point, gradient)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      type(contact_point), intent(in) :: point
      type(contact_gradient), intent(inout) :: gradient
      real(wp) :: v_t, v_e

      v_t = q(at_v_b) - q(at_v_a)
      v_e = q(at_v_b + 1) - q(at_v_a + 1)
      gradient%h_dot = (v_t*point%c + v_e*point%s)*gradient%angle
      gradient%h_dot(at_psi_dot_a) = -pair%sigma*pair%r_ba
      gradient%h_dot(at_psi_dot_b) = -pair%sigma*pair%r_bb
      gradient%h_dot(at_v_b:at_v_b + 1) = [point%s, -point%c]
      gradient%h_dot(at_v_a:at_v_a + 1) = [-point%s, point%c]
      gradient%l_a = gradient%rho_a - pair%share_a*gradient%h
      gradient%l_b = gradient%rho_b - pair%share_b*gradient%h
      gradient%v_t = pair%sigma*(point%omega_a*gradient%l_a + point%omega_b*gradient%l_b) &
                     + (v_t*point%s - v_e*point%c)*gradient%angle
      gradient%v_t(at_omega) = pair%sigma*(pair%ratio_a*point%l_a + pair%ratio_b*point%l_b)
      gradient%v_t(at_psi_dot_a) = pair%sigma*point%l_a
      gradient%v_t(at_psi_dot_b) = pair%sigma*point%l_b
      gradient%v_t(at_v_b:at_v_b + 1) = -[point%c, point%s]
      gradient%v_t(at_v_a:at_v_a + 1) = [point%c, point%s]
      associate (rho => point%rho_a + point%rho_b - point%h, r => pair%r_b, along => v_t*point%c + v_e*point%s, &
                 across => v_e*point%c - v_t*point%s)
         gradient%rho_dot = (r/rho*across - along)*gradient%angle - r*along/rho**2*(gradient%rho_a + gradient%rho_b - gradient%h)
         gradient%rho_dot(at_v_b) = -point%s + r/rho*point%c
         gradient%rho_dot(at_v_b + 1) = point%c + r/rho*point%s
         gradient%rho_dot(at_v_a:at_v_a + 1) = -gradient%rho_dot(at_v_b:at_v_b + 1)
      end associate
   end subroutine complete_gradient

end module evl_contact_point
