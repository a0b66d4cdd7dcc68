!> The two points of a tooth pair that touch or face each other, found in three ways.
!>
!> Everything is written in the nominal basis (t_0, e_0) of the mesh: e_0 along the line of action from K_A to K_B at the
!> reference centre distance, t_0 across it. Positions are deviations from the nominal rolling motion, so that a penetration of
!> 1e-9 m keeps its full relative precision beside radii of 0.1 m.
!>
!> One geometrical fact carries all three forms (`deviation_find`): a point near r_b t_0 + rho_0 e_0 lies on a line that touches
!> the circle of radius r_b; the line is turned from e_0 by `angle`, and the point lies `rho` from where it touches. With the base
!> circle of a wheel this gives the normal and the radius of curvature of the involute through a point; with the sum of both base
!> radii it gives the line of action for any centre distance.
!>
!> The tracked point of wheel A is r_PA = O_A + r_bA t + (rho_A0 + zeta) e, O_A where the axle is now, t and e turned by `turn`
!> from t_0 and e_0, rho_A0(theta) the nominal radius of curvature; that of wheel B is r_PB = r_PA + dr. In these coordinates g_A is
!> linear, and the rest of (1) is linear with constant coefficients but for terms that are smaller by a displacement over a
!> radius: a multistep method keeps the points on the flanks to rounding, and on the line of action to 1e-10 of the penetration.
!>
!> Source: Kosenko & Gusev 2011, (1)-(3) and Assertions 1 and 2.
module evl_contact_tracking
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: tracked_pair, contact_point, contact_gradient, deviation
   public :: deviation_find, track_closed_form, track_points, gradient_closed_form, gradient_points
   public :: closed_form_gap, algebraic_residual, differential_residual, algebraic_jacobian, differential_jacobian
   public :: differential_rates, points_from_closed_form, tracked_positions, centre_line_turn, line_distance
   public :: n_local, n_track, at_theta, at_psi_a, at_psi_b, at_u_a, at_u_b
   public :: at_omega, at_psi_dot_a, at_psi_dot_b, at_v_a, at_v_b, at_track, at_turn, at_zeta, at_dr, at_lambda, at_mu

   integer, parameter :: n_local = 20      !! variables that one mesh sees
   integer, parameter :: n_track = 6       !! tracked variables of a mesh: turn, zeta, dr (2), lambda, mu
   integer, parameter :: at_theta = 1      !! reference angle theta [rad]
   integer, parameter :: at_psi_a = 2      !! angle deviation psi_A [rad]
   integer, parameter :: at_psi_b = 3      !! angle deviation psi_B [rad]
   integer, parameter :: at_u_a = 4        !! displacement of axle A (t_0, e_0) [m], two places
   integer, parameter :: at_u_b = 6        !! displacement of axle B (t_0, e_0) [m], two places
   integer, parameter :: at_omega = 8      !! theta' [rad/s]
   integer, parameter :: at_psi_dot_a = 9  !! psi_A' [rad/s]
   integer, parameter :: at_psi_dot_b = 10 !! psi_B' [rad/s]
   integer, parameter :: at_v_a = 11       !! velocity of axle A (t_0, e_0) [m/s], two places
   integer, parameter :: at_v_b = 13       !! velocity of axle B (t_0, e_0) [m/s], two places
   integer, parameter :: at_turn = 15      !! angle from e_0 to A's normal at P_A [rad]
   integer, parameter :: at_zeta = 16      !! radius of curvature of A at P_A less rho_A0 [m]
   integer, parameter :: at_dr = 17        !! dr = r_PB - r_PA [m], two places
   integer, parameter :: at_lambda = 19    !! lambda of (1) [1]
   integer, parameter :: at_mu = 20        !! mu of (1) [m^2]
   integer, parameter :: at_track = at_turn !! first tracked variable

   !> Constants of one tooth pair that its tracking needs.
   type :: tracked_pair
      real(wp) :: sigma       !! +1: driving wheel nominally clockwise, -1: counterclockwise
      real(wp) :: r_ba, r_bb  !! base radii [m]
      real(wp) :: rho_0       !! |K_A K_B| at the reference centre distance [m]
      real(wp) :: ratio_a     !! g_A: nominal speed of A over that of the reference wheel
      real(wp) :: ratio_b     !! g_B
      real(wp) :: advance     !! d rho_A0/d theta = -sigma r_bA g_A [m]
      real(wp) :: share_a     !! w_A = E* (1-nu_A^2)/E_A: where between P_A and P_B the force acts
      real(wp) :: share_b     !! w_B = 1 - w_A
   end type tracked_pair

   !> Where a point lies relative to a circle's tangents, see `deviation_find`.
   type :: deviation
      logical :: exists   !! false if the point lies inside the circle
      real(wp) :: d_rho   !! rho - rho_0 [m]
      real(wp) :: rho     !! distance from the point of tangency [m]
      real(wp) :: angle   !! from e_0 to e, such that t = cos t_0 + sin e_0, e = -sin t_0 + cos e_0 [rad]
      real(wp) :: s, c    !! sine and cosine of `angle`
   end type deviation

   !> What the forces have to know of the contact.
   type :: contact_point
      logical :: exists        !! false if the tracked points left the involutes
      real(wp) :: h            !! penetration; negative: gap [m]
      real(wp) :: h_dot        !! its rate [m/s]
      real(wp) :: rho_a, rho_b !! radii of curvature [m]
      real(wp) :: s, c         !! direction of the normal: e = (-s, c), t = (c, s) in (t_0, e_0)
      real(wp) :: l_a, l_b     !! arms of the friction force [m]
      real(wp) :: v_t          !! sliding velocity along t [m/s]
      real(wp) :: omega_a, omega_b !! angular velocities [rad/s]
   end type contact_point

   !> Derivatives of a `contact_point` with respect to the local variables; `angle` is that of the normal.
   type :: contact_gradient
      real(wp) :: h(n_local), h_dot(n_local), rho_a(n_local), rho_b(n_local), angle(n_local)
      real(wp) :: l_a(n_local), l_b(n_local), v_t(n_local)
   end type contact_gradient

contains

   !> Tangent to a circle of radius r_b through the point (r_b + a_t, rho_0 + a_e).
   !>
   !> Valid: rho_0 > 0 and the point outside the circle. Written without cancellation: rho - rho_0 and the angle keep full relative
   !> precision in a. Derivatives: d angle = -(da.t + s drho_0)/rho, d rho = da.e + c drho_0 - r_b d angle, hence
   !> d(rho - rho_0 + r_b angle) = da.e + (c-1) drho_0.
   pure subroutine deviation_find(r_b, rho_0, a_t, a_e, found)
      real(wp), intent(in) :: r_b      !! radius of the circle [m]
      real(wp), intent(in) :: rho_0    !! nominal distance from the point of tangency [m]
      real(wp), intent(in) :: a_t, a_e !! deviation from the nominal point [m]
      type(deviation), intent(out) :: found
      real(wp) :: change, radicand, y, radius2, s2

      change = a_t*(2*r_b + a_t) + a_e*(2*rho_0 + a_e)
      radicand = rho_0**2 + change
      y = rho_0 + a_e
      found%exists = radicand > 0 .and. rho_0 > 0 .and. y > 0
      if (.not. found%exists) then
         found%d_rho = 0
         found%rho = rho_0
         found%angle = 0
         found%s = 0
         found%c = 1
         return
      end if
      found%rho = sqrt(radicand)
      found%d_rho = change/(found%rho + rho_0)
      radius2 = r_b**2 + radicand
      found%s = -a_t*(r_b*(2*r_b + a_t)/(found%rho + y) + found%rho)/radius2
      found%c = (r_b*(r_b + a_t) + found%rho*y)/radius2
      s2 = found%s**2
      if (s2 < 1.0e-4_wp) then ! the series of asin: next term 2e-22 relative
         found%angle = found%s*(1 + s2*(1/6.0_wp + s2*(3/40.0_wp + s2*(15/336.0_wp + s2*(105/3456.0_wp)))))
      else
         found%angle = atan2(found%s, found%c)
      end if
   end subroutine deviation_find

   !> 1 - cos of a deviation's angle, without cancellation.
   pure real(wp) function versine(found)
      type(deviation), intent(in) :: found

      versine = found%s**2/(1 + found%c)
   end function versine

   !> Closed form of the contact (Assertions 1 and 2): gap, normal and radii of curvature from the wheels' positions alone.
   !>
   !> kappa = rho - rho_A - rho_B = (rho - rho_0) + R angle + sigma (r_bA psi_A + r_bB psi_B), which is
   !> R (inv alpha - inv alpha_0) + sigma (r_bA Dphi_A + r_bB Dphi_B - R Dchi).
   pure subroutine track_closed_form(pair, rho_a0, q, point)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0      !! nominal radius of curvature on A at theta [m]
      real(wp), intent(in) :: q(n_local)  !! local variables
      type(contact_point), intent(out) :: point
      type(deviation) :: line

      call closed_form_line(pair, q, line)
      point%exists = line%exists
      point%h = -closed_form_gap(pair, q)
      point%rho_a = rho_a0 - pair%r_ba*(line%angle + pair%sigma*q(at_psi_a))
      point%rho_b = pair%rho_0 - rho_a0 - pair%r_bb*(line%angle + pair%sigma*q(at_psi_b))
      point%s = line%s
      point%c = line%c
      call complete_point(pair, q, point)
   end subroutine track_closed_form

   !> The line of action at the present centre distance.
   pure subroutine closed_form_line(pair, q, line)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      type(deviation), intent(out) :: line

      call deviation_find(pair%r_ba + pair%r_bb, pair%rho_0, q(at_u_b) - q(at_u_a), q(at_u_b + 1) - q(at_u_a + 1), line)
   end subroutine closed_form_line

   !> Gap kappa in closed form [m].
   pure real(wp) function closed_form_gap(pair, q) result(kappa)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      type(deviation) :: line

      call closed_form_line(pair, q, line)
      kappa = line%d_rho + (pair%r_ba + pair%r_bb)*line%angle &
              + pair%sigma*(pair%r_ba*q(at_psi_a) + pair%r_bb*q(at_psi_b))
   end function closed_form_gap

   !> The contact from the tracked points: penetration from mu, normal and radii from where the points lie on the two wheels.
   pure subroutine track_points(pair, rho_a0, q, point)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      type(contact_point), intent(out) :: point
      type(deviation) :: on_a, on_b

      call points_on_wheels(pair, rho_a0, q, on_a, on_b)
      point%exists = on_a%exists .and. on_b%exists
      point%h = -q(at_mu)/pair%r_bb
      point%rho_a = on_a%rho
      point%rho_b = on_b%rho
      point%s = on_a%s
      point%c = on_a%c
      call complete_point(pair, q, point)
   end subroutine track_points

   !> Where the tracked points lie relative to their wheels' base circles.
   pure subroutine points_on_wheels(pair, rho_a0, q, on_a, on_b)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      type(deviation), intent(out) :: on_a, on_b
      real(wp) :: a(2), b(2)

      on_a%angle = q(at_turn)
      on_a%s = sin(on_a%angle)
      on_a%c = cos(on_a%angle)
      on_a%d_rho = q(at_zeta)
      on_a%rho = rho_a0 + on_a%d_rho
      on_a%exists = on_a%rho > 0
      call point_positions(pair, on_a, q, a, b)
      call deviation_find(pair%r_bb, pair%rho_0 - rho_a0, b(1), b(2), on_b)
   end subroutine points_on_wheels

   !> Positions of the tracked points seen from their axles, less the nominal ones; that on B with opposite sign [m].
   pure subroutine point_positions(pair, on_a, q, a, b)
      type(tracked_pair), intent(in) :: pair
      type(deviation), intent(in) :: on_a
      real(wp), intent(in) :: q(n_local)
      real(wp), intent(out) :: a(2), b(2) !! (t_0, e_0)

      a(1) = -pair%r_ba*versine(on_a) - on_a%rho*on_a%s
      a(2) = pair%r_ba*on_a%s + on_a%d_rho - on_a%rho*versine(on_a)
      b = q(at_u_b:at_u_b + 1) - q(at_u_a:at_u_a + 1) - a - q(at_dr:at_dr + 1)
   end subroutine point_positions

   !> Derivatives of rho_A0, of the radius of curvature at P_A, and of the position of P_B.
   pure subroutine position_gradients(pair, on_a, rho_0, rho, b)
      type(tracked_pair), intent(in) :: pair
      type(deviation), intent(in) :: on_a
      real(wp), intent(out) :: rho_0(n_local), rho(n_local), b(n_local, 2)
      real(wp) :: along(n_local), across(n_local)

      rho_0 = unit(at_theta, pair%advance)
      rho = rho_0 + unit(at_zeta, 1.0_wp)
      along = rho + unit(at_turn, pair%r_ba)  ! P_A moves by this along e
      across = unit(at_turn, -on_a%rho)       ! and by this along t
      b(:, 1) = unit(at_u_b, 1.0_wp) - unit(at_u_a, 1.0_wp) - unit(at_dr, 1.0_wp) + on_a%s*along - on_a%c*across
      b(:, 2) = unit(at_u_b + 1, 1.0_wp) - unit(at_u_a + 1, 1.0_wp) - unit(at_dr + 1, 1.0_wp) - on_a%c*along - on_a%s*across &
                + rho_0
   end subroutine position_gradients

   !> Derivatives of a deviation: of its angle, and of rho - rho_0 + r_b angle.
   pure subroutine deviation_gradients(on, position, rho_0, angle, distance)
      type(deviation), intent(in) :: on
      real(wp), intent(in) :: position(n_local, 2), rho_0(n_local) !! derivatives of the point and of the nominal distance
      real(wp), intent(out) :: angle(n_local), distance(n_local)

      angle = -(position(:, 1)*on%c + (position(:, 2) + rho_0)*on%s)/on%rho
      distance = -position(:, 1)*on%s + position(:, 2)*on%c - versine(on)*rho_0
   end subroutine deviation_gradients

   !> Rates, arms and sliding velocity from penetration, normal and radii.
   pure subroutine complete_point(pair, q, point)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      type(contact_point), intent(inout) :: point
      real(wp) :: v_t, v_e

      v_t = q(at_v_b) - q(at_v_a)
      v_e = q(at_v_b + 1) - q(at_v_a + 1)
      point%omega_a = pair%ratio_a*q(at_omega) + q(at_psi_dot_a)
      point%omega_b = pair%ratio_b*q(at_omega) + q(at_psi_dot_b)
      point%h_dot = -pair%sigma*(pair%r_ba*q(at_psi_dot_a) + pair%r_bb*q(at_psi_dot_b)) + v_t*point%s - v_e*point%c
      point%l_a = point%rho_a - pair%share_a*point%h
      point%l_b = point%rho_b - pair%share_b*point%h
      point%v_t = pair%sigma*(point%omega_a*point%l_a + point%omega_b*point%l_b) - v_t*point%c - v_e*point%s
   end subroutine complete_point

   !> Derivatives of `track_closed_form`.
   pure subroutine gradient_closed_form(pair, q, point, gradient)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      type(contact_point), intent(in) :: point !! at q
      type(contact_gradient), intent(out) :: gradient
      type(deviation) :: line

      call closed_form_line(pair, q, line)
      gradient%angle = 0
      gradient%angle(at_u_b:at_u_b + 1) = -[line%c, line%s]/line%rho
      gradient%angle(at_u_a:at_u_a + 1) = -gradient%angle(at_u_b:at_u_b + 1)
      gradient%h = 0
      gradient%h(at_psi_a) = -pair%sigma*pair%r_ba
      gradient%h(at_psi_b) = -pair%sigma*pair%r_bb
      gradient%h(at_u_b:at_u_b + 1) = [line%s, -line%c]
      gradient%h(at_u_a:at_u_a + 1) = -gradient%h(at_u_b:at_u_b + 1)
      gradient%rho_a = -pair%r_ba*gradient%angle
      gradient%rho_a(at_theta) = pair%advance
      gradient%rho_a(at_psi_a) = -pair%r_ba*pair%sigma
      gradient%rho_b = -pair%r_bb*gradient%angle
      gradient%rho_b(at_theta) = -pair%advance
      gradient%rho_b(at_psi_b) = -pair%r_bb*pair%sigma
      call complete_gradient(pair, q, point, gradient)
   end subroutine gradient_closed_form

   !> Derivatives of `track_points`.
   pure subroutine gradient_points(pair, rho_a0, q, point, gradient)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      type(contact_point), intent(in) :: point !! at q
      type(contact_gradient), intent(out) :: gradient
      type(deviation) :: on_a, on_b
      real(wp), dimension(n_local) :: angle_b, distance_b, rho_0
      real(wp) :: b(n_local, 2)

      call points_on_wheels(pair, rho_a0, q, on_a, on_b)
      call position_gradients(pair, on_a, rho_0, gradient%rho_a, b)
      call deviation_gradients(on_b, b, -rho_0, angle_b, distance_b)
      gradient%angle = unit(at_turn, 1.0_wp)
      gradient%h = 0
      gradient%h(at_mu) = -1/pair%r_bb
      gradient%rho_b = -rho_0 + distance_b - pair%r_bb*angle_b
      call complete_gradient(pair, q, point, gradient)
   end subroutine gradient_points

   !> Derivatives of `complete_point`; h, rho_a, rho_b and angle are there already.
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
   end subroutine complete_gradient

   !> The algebraic form (1) as a residual.
   !>
   !> r_bA (grad g_A - lambda grad g_B) (t_0 component, times rho_B, and e_0 component), -(r_PA - r_PB - mu grad g_B), r_bA g_A,
   !> r_bB g_B. With its factor the first row has constant coefficients like the others: a Newton matrix from earlier still fits.
   pure subroutine algebraic_residual(pair, rho_a0, q, residual, exists)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      real(wp), intent(out) :: residual(n_track) !! [m, 1, m, m, m, m]
      logical, intent(out) :: exists             !! false if a point lies inside a base circle
      type(deviation) :: on_a, on_b
      real(wp) :: big_lambda, kappa

      call points_on_wheels(pair, rho_a0, q, on_a, on_b)
      exists = on_a%exists .and. on_b%exists
      big_lambda = q(at_lambda)*pair%r_ba/pair%r_bb
      kappa = q(at_mu)/pair%r_bb
      residual(1) = -on_b%rho*(on_a%s + big_lambda*on_b%s)
      residual(2) = on_a%c + big_lambda*on_b%c
      residual(3) = q(at_dr) + kappa*on_b%s
      residual(4) = q(at_dr + 1) - kappa*on_b%c
      residual(5) = on_a%d_rho + pair%r_ba*(on_a%angle + pair%sigma*q(at_psi_a))
      residual(6) = on_b%d_rho + pair%r_bb*(on_b%angle + pair%sigma*q(at_psi_b))
   end subroutine algebraic_residual

   !> Derivatives of `algebraic_residual` with respect to the local variables.
   pure subroutine algebraic_jacobian(pair, rho_a0, q, jacobian)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      real(wp), intent(out) :: jacobian(n_track, n_local)
      type(deviation) :: on_a, on_b
      real(wp), dimension(n_local) :: angle_a, angle_b, distance_b, rho_0, rho, rho_b, lambda
      real(wp) :: b(n_local, 2), big_lambda, kappa

      call points_on_wheels(pair, rho_a0, q, on_a, on_b)
      call position_gradients(pair, on_a, rho_0, rho, b)
      call deviation_gradients(on_b, b, -rho_0, angle_b, distance_b)
      angle_a = unit(at_turn, 1.0_wp)
      big_lambda = q(at_lambda)*pair%r_ba/pair%r_bb
      kappa = q(at_mu)/pair%r_bb
      rho_b = -rho_0 + distance_b - pair%r_bb*angle_b
      lambda = unit(at_lambda, pair%r_ba/pair%r_bb)
      jacobian(1, :) = -on_b%rho*(on_a%c*angle_a + big_lambda*on_b%c*angle_b + on_b%s*lambda) &
                       - (on_a%s + big_lambda*on_b%s)*rho_b
      jacobian(2, :) = -on_a%s*angle_a - big_lambda*on_b%s*angle_b + on_b%c*lambda
      jacobian(3, :) = kappa*on_b%c*angle_b
      jacobian(3, at_dr) = jacobian(3, at_dr) + 1
      jacobian(3, at_mu) = on_b%s/pair%r_bb
      jacobian(4, :) = kappa*on_b%s*angle_b
      jacobian(4, at_dr + 1) = jacobian(4, at_dr + 1) + 1
      jacobian(4, at_mu) = -on_b%c/pair%r_bb
      jacobian(5, :) = unit(at_zeta, 1.0_wp) + unit(at_turn, pair%r_ba) + unit(at_psi_a, pair%r_ba*pair%sigma)
      jacobian(6, :) = distance_b
      jacobian(6, at_psi_b) = pair%r_bb*pair%sigma
   end subroutine algebraic_jacobian

   !> The differential form (2)-(3) as a residual in the tracked variables' rates.
   !>
   !> The terms of [w, grad g] + Hess g (u - v) that grow with the angular velocity cancel on paper: what remains is the rate
   !> of turn of the normal, -t ((u - v_O).t)/(r_b rho). Rows as in `algebraic_residual`, per second.
   pure subroutine differential_residual(pair, rho_a0, q, rates, residual, exists)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      real(wp), intent(in) :: rates(n_track) !! turn', zeta', dr', lambda', mu'
      real(wp), intent(out) :: residual(n_track)
      logical, intent(out) :: exists
      type(deviation) :: on_a, on_b
      real(wp) :: big_lambda, kappa, b_dot(2), rho_dot, turn_b, lambda_dot, kappa_dot

      call points_on_wheels(pair, rho_a0, q, on_a, on_b)
      exists = on_a%exists .and. on_b%exists
      big_lambda = q(at_lambda)*pair%r_ba/pair%r_bb
      kappa = q(at_mu)/pair%r_bb
      rho_dot = pair%advance*q(at_omega)
      call point_rate(pair, on_a, q, rates, rho_dot, b_dot)
      turn_b = turn_rate(on_b, b_dot, -rho_dot)
      lambda_dot = rates(5)*pair%r_ba/pair%r_bb
      kappa_dot = rates(6)/pair%r_bb
      residual(1) = on_b%rho*(-rates(1)*on_a%c - big_lambda*turn_b*on_b%c - lambda_dot*on_b%s)
      residual(2) = -rates(1)*on_a%s - big_lambda*turn_b*on_b%s + lambda_dot*on_b%c
      residual(3) = rates(3) + kappa_dot*on_b%s + kappa*turn_b*on_b%c
      residual(4) = rates(4) - kappa_dot*on_b%c + kappa*turn_b*on_b%s
      residual(5) = rates(2) + pair%r_ba*(rates(1) + pair%sigma*q(at_psi_dot_a))
      residual(6) = -b_dot(1)*on_b%s + b_dot(2)*on_b%c + versine(on_b)*rho_dot + pair%sigma*pair%r_bb*q(at_psi_dot_b)
   end subroutine differential_residual

   !> Rate of the position of P_B as in `point_positions`.
   pure subroutine point_rate(pair, on_a, q, rates, rho_dot, b_dot)
      type(tracked_pair), intent(in) :: pair
      type(deviation), intent(in) :: on_a
      real(wp), intent(in) :: q(n_local), rates(n_track)
      real(wp), intent(in) :: rho_dot   !! of rho_A0 [m/s]
      real(wp), intent(out) :: b_dot(2) !! (t_0, e_0) [m/s]
      real(wp) :: along, across

      along = pair%r_ba*rates(1) + rates(2) ! of P_A along e, less rho_A0'
      across = -on_a%rho*rates(1)           ! along t
      b_dot = q(at_v_b:at_v_b + 1) - q(at_v_a:at_v_a + 1) - rates(3:4)
      b_dot(1) = b_dot(1) + on_a%s*(along + rho_dot) - on_a%c*across
      b_dot(2) = b_dot(2) - on_a%c*along - on_a%s*across + versine(on_a)*rho_dot
   end subroutine point_rate

   !> Rate of a deviation's angle.
   pure real(wp) function turn_rate(on, rate, rho_dot)
      type(deviation), intent(in) :: on
      real(wp), intent(in) :: rate(2), rho_dot !! of the point and of its nominal distance [m/s]

      turn_rate = -(rate(1)*on%c + (rate(2) + rho_dot)*on%s)/on%rho
   end function turn_rate

   !> Derivatives of `differential_residual`: with respect to the local variables, plus cj times those with respect to the rates.
   pure subroutine differential_jacobian(pair, rho_a0, q, rates, cj, jacobian)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local), rates(n_track), cj
      real(wp), intent(out) :: jacobian(n_track, n_local)
      type(deviation) :: on_a, on_b
      real(wp), dimension(n_local) :: angle_a, angle_b, distance_b, turn_a, turn_b, along, across
      real(wp), dimension(n_local) :: lambda, kappa, lambda_dot, kappa_dot, rho_0, rho, rho_b, rho_dot
      real(wp), dimension(n_local, 2) :: b, b_dot
      real(wp) :: b_rate(2), rho_rate, turn, turn_rate_b, ratio, l, k, k_dot, l_dot

      call points_on_wheels(pair, rho_a0, q, on_a, on_b)
      call position_gradients(pair, on_a, rho_0, rho, b)
      call deviation_gradients(on_b, b, -rho_0, angle_b, distance_b)
      angle_a = unit(at_turn, 1.0_wp)
      turn = rates(1)
      turn_a = unit(at_turn, cj)
      rho_rate = pair%advance*q(at_omega)
      rho_dot = unit(at_omega, pair%advance)
      call point_rate(pair, on_a, q, rates, rho_rate, b_rate)
      along = turn_a*pair%r_ba + unit(at_zeta, cj)
      across = -on_a%rho*turn_a - turn*rho
      b_dot(:, 1) = unit(at_v_b, 1.0_wp) - unit(at_v_a, 1.0_wp) - unit(at_dr, cj) + on_a%s*(along + rho_dot) - on_a%c*across
      b_dot(:, 2) = unit(at_v_b + 1, 1.0_wp) - unit(at_v_a + 1, 1.0_wp) - unit(at_dr + 1, cj) - on_a%c*along &
                    - on_a%s*across + versine(on_a)*rho_dot
      associate (g => pair%r_ba*turn + rates(2) + rho_rate)
         b_dot(:, 1) = b_dot(:, 1) + (on_a%c*g - on_a%s*on_a%rho*turn)*angle_a
         b_dot(:, 2) = b_dot(:, 2) + (on_a%s*g + on_a%c*on_a%rho*turn)*angle_a
      end associate
      turn_rate_b = turn_rate(on_b, b_rate, -rho_rate)
      rho_b = -rho_0 + distance_b - pair%r_bb*angle_b
      turn_b = turn_gradient(on_b, b_rate, -rho_rate, angle_b, b_dot, -rho_dot, rho_b)
      ratio = pair%r_ba/pair%r_bb
      l = q(at_lambda)*ratio
      k = q(at_mu)/pair%r_bb
      l_dot = rates(5)*ratio
      k_dot = rates(6)/pair%r_bb
      lambda = unit(at_lambda, ratio)
      kappa = unit(at_mu, 1/pair%r_bb)
      lambda_dot = unit(at_lambda, cj*ratio)
      kappa_dot = unit(at_mu, cj/pair%r_bb)

      jacobian(1, :) = on_b%rho*(-turn_a*on_a%c + turn*on_a%s*angle_a - (lambda*turn_rate_b + l*turn_b)*on_b%c &
                                 + l*turn_rate_b*on_b%s*angle_b - lambda_dot*on_b%s - l_dot*on_b%c*angle_b) &
                       + (-turn*on_a%c - l*turn_rate_b*on_b%c - l_dot*on_b%s)*rho_b
      jacobian(2, :) = -turn_a*on_a%s - turn*on_a%c*angle_a - (lambda*turn_rate_b + l*turn_b)*on_b%s &
                       - l*turn_rate_b*on_b%c*angle_b + lambda_dot*on_b%c - l_dot*on_b%s*angle_b
      jacobian(3, :) = unit(at_dr, cj) + kappa_dot*on_b%s + k_dot*on_b%c*angle_b + (kappa*turn_rate_b + k*turn_b)*on_b%c &
                       - k*turn_rate_b*on_b%s*angle_b
      jacobian(4, :) = unit(at_dr + 1, cj) - kappa_dot*on_b%c + k_dot*on_b%s*angle_b + (kappa*turn_rate_b + k*turn_b)*on_b%s &
                       + k*turn_rate_b*on_b%c*angle_b
      jacobian(5, :) = along + unit(at_psi_dot_a, pair%r_ba*pair%sigma)
      jacobian(6, :) = -b_dot(:, 1)*on_b%s + b_dot(:, 2)*on_b%c &
                       - (b_rate(1)*on_b%c + (b_rate(2) - rho_rate)*on_b%s)*angle_b + versine(on_b)*rho_dot
      jacobian(6, at_psi_dot_b) = pair%sigma*pair%r_bb
   end subroutine differential_jacobian

   !> Derivatives of `turn_rate`.
   pure function turn_gradient(on, rate, rho_rate, angle, dot, rho_dot, rho) result(turn)
      type(deviation), intent(in) :: on
      real(wp), intent(in) :: rate(2), rho_rate
      real(wp), intent(in) :: angle(n_local), dot(n_local, 2), rho_dot(n_local), rho(n_local) !! derivatives
      real(wp) :: turn(n_local)

      turn = -(dot(:, 1)*on%c + (dot(:, 2) + rho_dot)*on%s + (-rate(1)*on%s + (rate(2) + rho_rate)*on%c)*angle &
               + turn_rate(on, rate, rho_rate)*rho)/on%rho
   end function turn_gradient

   !> A vector of local variables that is zero but for one place.
   pure function unit(place, value) result(vector)
      integer, intent(in) :: place
      real(wp), intent(in) :: value
      real(wp) :: vector(n_local)

      vector = 0
      vector(place) = value
   end function unit

   !> The differential form solved for the rates: a linear system of order 6, by LAPACK.
   subroutine differential_rates(pair, rho_a0, q, rates, solved)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      real(wp), intent(out) :: rates(n_track) !! turn', zeta', dr', lambda', mu'
      logical, intent(out) :: solved          !! false if the system is singular or a point lies inside a base circle
      real(wp) :: jacobian(n_track, n_local), jacobian_0(n_track, n_local), matrix(n_track, n_track), constant(n_track)
      integer :: pivots(n_track), info
      interface
         subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
            use evl_kinds, only: wp
            implicit none (type, external)
            integer, intent(in) :: n, nrhs, lda, ldb
            real(wp), intent(inout) :: a(lda, *), b(ldb, *)
            integer, intent(out) :: ipiv(*), info
         end subroutine dgesv
      end interface

      rates = 0
      call differential_residual(pair, rho_a0, q, rates, constant, solved)
      if (.not. solved) return
      call differential_jacobian(pair, rho_a0, q, rates, 0.0_wp, jacobian_0)
      call differential_jacobian(pair, rho_a0, q, rates, 1.0_wp, jacobian)
      matrix = jacobian(:, at_track:) - jacobian_0(:, at_track:)
      rates = -constant
      call dgesv(n_track, 1, matrix, n_track, pivots, rates, n_track, info)
      solved = info == 0
   end subroutine differential_rates

   !> Tracked variables that belong to the wheels' positions, by Assertions 1 and 2: the points lie on the line of action.
   pure subroutine points_from_closed_form(pair, q, track)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)       !! local variables; the tracked ones are not looked at
      real(wp), intent(out) :: track(n_track)  !! turn, zeta, dr, lambda, mu
      type(deviation) :: line
      real(wp) :: kappa

      call closed_form_line(pair, q, line)
      kappa = closed_form_gap(pair, q)
      track(1) = line%angle
      track(2) = -pair%r_ba*(line%angle + pair%sigma*q(at_psi_a))
      track(3:4) = kappa*[-line%s, line%c]
      track(5) = -pair%r_bb/pair%r_ba
      track(6) = pair%r_bb*kappa
   end subroutine points_from_closed_form

   !> The tracked points in the nominal basis, from K_A at the reference centre distance [m].
   pure subroutine tracked_positions(pair, rho_a0, q, point_a, point_b)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0, q(n_local)
      real(wp), intent(out) :: point_a(2), point_b(2) !! (t_0, e_0)
      type(deviation) :: on_a, on_b
      real(wp) :: a(2), b(2)

      call points_on_wheels(pair, rho_a0, q, on_a, on_b)
      call point_positions(pair, on_a, q, a, b)
      point_a = q(at_u_a:at_u_a + 1) + a + [0.0_wp, rho_a0]
      point_b = point_a + q(at_dr:at_dr + 1)
   end subroutine tracked_positions

   !> Dchi: how far the centre line has turned from its reference direction [rad], counterclockwise.
   pure real(wp) function centre_line_turn(pair, q) result(turn)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      real(wp) :: w(2), r

      r = pair%r_ba + pair%r_bb
      w = q(at_u_b:at_u_b + 1) - q(at_u_a:at_u_a + 1)
      turn = atan2(-pair%sigma*(r*w(2) - pair%rho_0*w(1)), r*(r + w(1)) + pair%rho_0*(pair%rho_0 + w(2)))
   end function centre_line_turn

   !> Distances of the tracked points from the line of action [m], (r_PA - K_A).t and (r_PB - K_B).t.
   pure subroutine line_distance(pair, rho_a0, q, distance_a, distance_b)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      real(wp), intent(out) :: distance_a, distance_b
      type(deviation) :: line, on_a, on_b
      real(wp) :: a(2), b(2), off

      call closed_form_line(pair, q, line)
      call points_on_wheels(pair, rho_a0, q, on_a, on_b)
      call point_positions(pair, on_a, q, a, b)
      off = on_a%angle - line%angle
      distance_a = -2*pair%r_ba*sin(off/2)**2 - on_a%rho*sin(off)
      ! P_B is -(r_bB t_0 + rho_B0 e_0 + b) seen from its axle, K_B is -r_bB t
      distance_b = pair%r_bb*versine(line) - (pair%rho_0 - rho_a0)*line%s - b(1)*line%c - b(2)*line%s
   end subroutine line_distance

end module evl_contact_tracking
