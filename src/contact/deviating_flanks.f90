!> Effect of deviations of the two flanks on a contact.
!>
!> The gap of a tooth pair is kappa + e_A(rho_A) + e_B(rho_B), and the forces follow its gradient. With the slope e' of a flank, the
!> normal force has the arm r_b (1 - e') about its axle. Its component along t on A is -(e_A' r_bA + e_B' r_bB)/rho relative to the
!> force, where rho is the length of the line of action. With the arms left at r_b, energy would not be conserved.
!>
!> Deviations also change the radii of curvature of the flanks by the relative amount e'' rho; the force law neglects this.
!>
!> Source: derivatives of the closed form (Kosenko & Gusev 2011, Assertions 1 and 2) with the gap above; docs/theory/deviations.md.
module evl_deviating_flanks
   use evl_contact_point, only: base_arc, contact_gradient, contact_point, tracked_pair
   use evl_flank_deviation, only: flank_slope
   use evl_kinds, only: wp
   use evl_local_variables, only: at_omega, at_psi_dot_a, at_psi_dot_b, at_v_a, at_v_b, n_local
   implicit none (type, external)
   private

   public :: flank_value, radius_rates, deviate, deviate_gradient, rate_gradients, rates_of, sliding_gradient
   public :: flanks_turned, turn_together, turn_values, turning_arm

   !> Deviation of one flank at its contact point.
   type :: flank_value
      real(wp) :: e = 0.0_wp   !! [m], > 0: less material
      real(wp) :: de = 0.0_wp  !! de/drho
      real(wp) :: d2e = 0.0_wp !! d2e/drho2 [1/m]
   end type flank_value

   !> Derivatives of the joint deviation term of two flanks that both have a slope at the contact. The flank values already include
   !> them, except for the mixed derivative.
   type :: flanks_turned
      logical :: both = .false.
      real(wp) :: d_a = 0.0_wp, d_b = 0.0_wp, d_ab = 0.0_wp !! with respect to rho_A, to rho_B, to both [1/m]
   end type flanks_turned

   !> Rates of the radii of curvature, and the quantities they depend on.
   type :: radius_rates
      real(wp) :: line  !! length of the line of action [m]
      real(wp) :: along !! relative velocity of the axles along t [m/s]
      real(wp) :: a, b  !! rates of rho_A and rho_B [m/s]
   end type radius_rates

contains

   include "contact/deviating_flanks.inc"

   !> Add the joint deviation term to the values of both flanks.
   pure subroutine turn_values(pair, slope_a, slope_b, a, b, turned)
      type(tracked_pair), intent(in) :: pair
      type(flank_slope), intent(in) :: slope_a, slope_b
      type(flank_value), intent(inout) :: a, b
      type(flanks_turned), intent(out) :: turned
      real(wp) :: arm

      arm = turning_arm(pair)
      call turn_together(arm, slope_a%s, slope_a%ds, slope_b%s, slope_b%ds, a%e, a%de, b%e, b%de)
      a%d2e = a%d2e + arm*slope_a%d2s*slope_b%s
      b%d2e = b%d2e + arm*slope_a%s*slope_b%d2s
      turned = flanks_turned(.true., arm*slope_a%ds*slope_b%s, arm*slope_a%s*slope_b%ds, arm*slope_a%ds*slope_b%ds)
   end subroutine turn_values

   !> Derivatives of `deviate`. On entry: those of the contact of perfect involutes.
   pure subroutine deviate_gradient(pair, a, b, turned, q, perfect, point, gradient)
      type(tracked_pair), intent(in) :: pair
      type(flank_value), intent(in) :: a, b
      type(flanks_turned), intent(in) :: turned
      real(wp), intent(in) :: q(n_local)
      type(contact_point), intent(in) :: perfect, point !! before and after `deviate`
      type(contact_gradient), intent(inout) :: gradient
      type(radius_rates) :: rate
      real(wp), dimension(n_local) :: line, along, rate_a, rate_b, e_dot, more

      rate = rates_of(pair, q, perfect)
      call rate_gradients(pair, rate, q, point, gradient, line, along, rate_a, rate_b)
      e_dot = a%d2e*rate%a*gradient%rho_a + a%de*rate_a + b%d2e*rate%b*gradient%rho_b + b%de*rate_b
      if (turned%both) e_dot = e_dot + turned%d_ab*(rate%a*gradient%rho_b + rate%b*gradient%rho_a)
      gradient%h = gradient%h - a%de*gradient%rho_a - b%de*gradient%rho_b
      gradient%h_dot = gradient%h_dot - e_dot
      gradient%rho_dot = gradient%rho_dot + e_dot
      gradient%l_a = (1 - a%de)*gradient%rho_a - pair%share_a*gradient%h
      gradient%l_b = (1 - b%de)*gradient%rho_b - pair%share_b*gradient%h
      gradient%arm_a = -pair%r_ba*a%d2e*gradient%rho_a
      gradient%arm_b = -pair%r_bb*b%d2e*gradient%rho_b
      if (turned%both) then ! half of the joint term counts on each flank
         more = (turned%d_a*gradient%rho_a - turned%d_b*gradient%rho_b)/2
         gradient%l_a = gradient%l_a + more
         gradient%l_b = gradient%l_b - more
         gradient%arm_a = gradient%arm_a - pair%r_ba*turned%d_ab*gradient%rho_b
         gradient%arm_b = gradient%arm_b - pair%r_bb*turned%d_ab*gradient%rho_a
      end if
      call sliding_gradient(pair, point, along, gradient)
      gradient%tilt = (gradient%arm_a + gradient%arm_b)/rate%line - point%tilt/rate%line*line
   end subroutine deviate_gradient

   !> Derivatives of `rates_of`, of the length of the line of action, and of the relative velocity of the axles along t.
   pure subroutine rate_gradients(pair, rate, q, point, gradient, line, along, rate_a, rate_b)
      type(tracked_pair), intent(in) :: pair
      type(radius_rates), intent(in) :: rate
      real(wp), intent(in) :: q(n_local)
      type(contact_point), intent(in) :: point
      type(contact_gradient), intent(in) :: gradient !! of the contact of perfect involutes
      real(wp), dimension(n_local), intent(out) :: line, along, rate_a, rate_b
      real(wp) :: turn_rate(n_local)

      associate (v_t => q(at_v_b) - q(at_v_a), v_e => q(at_v_b + 1) - q(at_v_a + 1))
         along = (v_e*point%c - v_t*point%s)*gradient%angle
      end associate
      along(at_v_b:at_v_b + 1) = [point%c, point%s]
      along(at_v_a:at_v_a + 1) = -[point%c, point%s]
      line = gradient%rho_a + gradient%rho_b - gradient%h
      turn_rate = -along/rate%line + rate%along/rate%line**2*line
      rate_a = -pair%r_ba*turn_rate
      rate_b = -pair%r_bb*turn_rate
      rate_a(at_omega) = pair%advance
      rate_b(at_omega) = -pair%advance
      rate_a(at_psi_dot_a) = -pair%r_ba*pair%sigma
      rate_b(at_psi_dot_b) = -pair%r_bb*pair%sigma
   end subroutine rate_gradients

   !> Derivatives of the sliding velocity from those of its arms.
   pure subroutine sliding_gradient(pair, point, along, gradient)
      type(tracked_pair), intent(in) :: pair
      type(contact_point), intent(in) :: point
      real(wp), intent(in) :: along(n_local)
      type(contact_gradient), intent(inout) :: gradient

      gradient%v_t = pair%sigma*(point%omega_a*gradient%l_a + point%omega_b*gradient%l_b) - along
      gradient%v_t(at_omega) = pair%sigma*(pair%ratio_a*point%l_a + pair%ratio_b*point%l_b)
      gradient%v_t(at_psi_dot_a) = pair%sigma*point%l_a
      gradient%v_t(at_psi_dot_b) = pair%sigma*point%l_b
   end subroutine sliding_gradient

end module evl_deviating_flanks
