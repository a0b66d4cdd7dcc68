!> Rigid unilateral contact: kappa >= 0, F_n >= 0, kappa F_n = 0.
!>
!> While a contact is closed, its normal force is a multiplier, an algebraic state of the gearbox. One wheel of the mesh, the one
!> farther from the reference wheel, is the dependent one. Its two rows are the constraints kappa = 0 and kappa' = 0, and the row of
!> the multiplier is kappa'' = 0. Therefore neither position nor velocity drifts, and the index is 1.
!>
!> Source: Kosenko & Gusev 2011, section 7.3; impacts after Newton, see `impact` in evl_rigid_forces.
module evl_rigid_contact
   use evl_closed_form, only: closed_form_line, gradient_closed_form, track_closed_form
   use evl_contact_point, only: base_arc, contact_gradient, contact_point, tracked_pair
   use evl_kinds, only: wp
   use evl_local_variables, only: at_psi_dot_a, at_psi_dot_b, at_u_a, at_u_b, at_v_a, at_v_b, n_local
   use evl_tangent_line, only: tangent_line_t
   implicit none (type, external)
   private

   public :: rigid_gradient, rigid_constraint, rigid_acceleration, rigid_acceleration_gradient

contains

   !> Closed-form contact and its derivatives; the radii of curvature do not affect the constraint.
   pure subroutine rigid_gradient(pair, q, point, gradient)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      type(contact_point), intent(out) :: point
      type(contact_gradient), intent(out) :: gradient

      call track_closed_form(pair, pair%rho_0/2, q, point)
      call gradient_closed_form(pair, q, point, gradient)
   end subroutine rigid_gradient

   !> Constraint of a closed contact: kappa [m] and kappa' [m/s]. Equation T58.
   pure function rigid_constraint(pair, q) result(constraint)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      real(wp) :: constraint(2)
      type(contact_point) :: point

      call track_closed_form(pair, pair%rho_0/2, q, point)
      constraint = [-point%h, -point%h_dot]
   end function rigid_constraint

   !> kappa'' [m/s^2]: a.e + (v.t)^2/rho plus the contribution of the wheels; v, a are the relative velocity and acceleration of the
   !> axles. Equation T60.
   pure real(wp) function rigid_acceleration(pair, q, rates) result(acceleration)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)     !! local variables
      real(wp), intent(in) :: rates(n_local) !! and their rates
      type(tangent_line_t) :: line
      real(wp) :: v(2), a(2)

      call closed_form_line(pair, q, line)
      v = q(at_v_b:at_v_b + 1) - q(at_v_a:at_v_a + 1)
      a = rates(at_v_b:at_v_b + 1) - rates(at_v_a:at_v_a + 1)
      acceleration = pair%sigma*base_arc(pair, rates(at_psi_dot_a), rates(at_psi_dot_b)) &
                     - a(1)*line%s + a(2)*line%c + (v(1)*line%c + v(2)*line%s)**2/line%rho
   end function rigid_acceleration

   !> Derivatives of `rigid_acceleration` with respect to the local variables at constant rates of the velocities.
   pure subroutine rigid_acceleration_gradient(pair, q, rates, gradient)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local), rates(n_local)
      real(wp), intent(out) :: gradient(n_local)
      type(tangent_line_t) :: line
      real(wp) :: t(2), e(2), v(2), a(2), v_t, by_u(2), by_v(2)

      call closed_form_line(pair, q, line)
      t = [line%c, line%s]
      e = [-line%s, line%c]
      v = q(at_v_b:at_v_b + 1) - q(at_v_a:at_v_a + 1)
      a = rates(at_v_b:at_v_b + 1) - rates(at_v_a:at_v_a + 1)
      v_t = dot_product(v, t)
      by_v = 2*v_t/line%rho*t
      ! d angle = -t.du/rho, dt = e d angle, de = -t d angle, d rho = (e + R/rho t).du
      by_u = (dot_product(a, t) - 2*v_t/line%rho*dot_product(v, e))/line%rho*t &
             - (v_t/line%rho)**2*(e + pair%r_b/line%rho*t)
      gradient = 0
      gradient(at_u_b:at_u_b + 1) = by_u
      gradient(at_u_a:at_u_a + 1) = -by_u
      gradient(at_v_b:at_v_b + 1) = by_v
      gradient(at_v_a:at_v_a + 1) = -by_v
   end subroutine rigid_acceleration_gradient

end module evl_rigid_contact
