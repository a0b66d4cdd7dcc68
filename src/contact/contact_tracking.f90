!> Tracking of the two points of a tooth pair that touch or face each other, in the algebraic (1) or differential (2)-(3) form.
!>
!> The tracked point of wheel A is r_PA = O_A + r_bA t + (rho_A0 + zeta) e. O_A is the actual position of the axle, t and e are t_0
!> and e_0 rotated by `turn`, and rho_A0(theta) is the nominal radius of curvature. The tracked point of wheel B is
!> r_PB = r_PA + dr. In these coordinates g_A is linear. The rest of (1) is linear with constant coefficients, except for terms that
!> are smaller by a displacement over a radius. A multistep method keeps the points on the flanks to rounding, and on the line of
!> action to 1e-10 of the penetration.
!>
!> Source: Kosenko & Gusev 2011, (1)-(3).
module evl_contact_tracking
   use evl_closed_form, only: closed_form_line
   use evl_contact_point, only: complete_gradient, complete_point, contact_gradient, contact_point, tracked_pair
   use evl_kinds, only: wp
   use evl_lapack, only: dgesv
   use evl_local_variables, only: at_dr, at_lambda, at_mu, at_omega, at_psi_a, at_psi_b, at_psi_dot_a, at_psi_dot_b, at_theta, &
                                  at_track, at_turn, at_u_a, at_u_b, at_v_a, at_v_b, at_zeta, n_local, n_track, unit
   use evl_tangent_line, only: find_tangent_line, tangent_line_gradients, tangent_line_t, versine
   implicit none (type, external)
   private

   public :: track_points, gradient_points, tracked_positions, line_distance, project_points
   public :: algebraic_residual, algebraic_jacobian, differential_residual, differential_jacobian, differential_rates

contains

   !> Contact from the tracked points: penetration from mu, normal and radii from the positions of the points on the two wheels.
   pure subroutine track_points(pair, rho_a0, q, point)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      type(contact_point), intent(out) :: point
      type(tangent_line_t) :: on_a, on_b

      call points_on_wheels(pair, rho_a0, q, on_a, on_b)
      point%exists = on_a%exists .and. on_b%exists
      point%h = -q(at_mu)/pair%r_bb
      point%rho_a = on_a%rho
      point%rho_b = on_b%rho
      point%s = on_a%s
      point%c = on_a%c
      call complete_point(pair, q, point)
   end subroutine track_points

   !> Positions of the tracked points relative to the base circles of their wheels.
   pure subroutine points_on_wheels(pair, rho_a0, q, on_a, on_b)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      type(tangent_line_t), intent(out) :: on_a, on_b
      real(wp) :: a(2), b(2)

      call point_on_driving(pair, rho_a0, q, on_a)
      call point_positions(pair, on_a, q, a, b)
      call find_tangent_line(pair%r_bb, pair%rho_0 - rho_a0, b(1), b(2), on_b)
   end subroutine points_on_wheels

   !> Position of the tracked point of the driving wheel relative to its base circle.
   pure subroutine point_on_driving(pair, rho_a0, q, on_a)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      type(tangent_line_t), intent(out) :: on_a

      on_a%angle = q(at_turn)
      on_a%s = sin(on_a%angle)
      on_a%c = cos(on_a%angle)
      on_a%d_rho = q(at_zeta)
      on_a%rho = rho_a0 + on_a%d_rho
      on_a%exists = on_a%rho*pair%r_ba > 0
   end subroutine point_on_driving

   !> Positions of the tracked points relative to their axles, less the nominal ones; that on B with opposite sign [m].
   pure subroutine point_positions(pair, on_a, q, a, b)
      type(tracked_pair), intent(in) :: pair
      type(tangent_line_t), intent(in) :: on_a
      real(wp), intent(in) :: q(n_local)
      real(wp), intent(out) :: a(2), b(2) !! (t_0, e_0)

      a(1) = -pair%r_ba*versine(on_a) - on_a%rho*on_a%s
      a(2) = pair%r_ba*on_a%s + on_a%d_rho - on_a%rho*versine(on_a)
      b = q(at_u_b:at_u_b + 1) - q(at_u_a:at_u_a + 1) - a - q(at_dr:at_dr + 1)
   end subroutine point_positions

   !> Derivatives of rho_A0, of the radius of curvature at P_A, and of the position of P_B.
   pure subroutine position_gradients(pair, on_a, rho_0, rho, b)
      type(tracked_pair), intent(in) :: pair
      type(tangent_line_t), intent(in) :: on_a
      real(wp), intent(out) :: rho_0(n_local), rho(n_local), b(n_local, 2)
      real(wp) :: along(n_local), across(n_local)

      rho_0 = unit(at_theta, pair%advance)
      rho = rho_0 + unit(at_zeta, 1.0_wp)
      along = rho + unit(at_turn, pair%r_ba)  ! displacement of P_A along e
      across = unit(at_turn, -on_a%rho)       ! displacement of P_A along t
      b(:, 1) = unit(at_u_b, 1.0_wp) - unit(at_u_a, 1.0_wp) - unit(at_dr, 1.0_wp) + on_a%s*along - on_a%c*across
      b(:, 2) = unit(at_u_b + 1, 1.0_wp) - unit(at_u_a + 1, 1.0_wp) - unit(at_dr + 1, 1.0_wp) - on_a%c*along - on_a%s*across &
                + rho_0
   end subroutine position_gradients

   !> Derivatives of `track_points`.
   pure subroutine gradient_points(pair, rho_a0, q, point, gradient)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      type(contact_point), intent(in) :: point !! at q
      type(contact_gradient), intent(out) :: gradient
      type(tangent_line_t) :: on_a, on_b
      real(wp), dimension(n_local) :: angle_b, distance_b, rho_0
      real(wp) :: b(n_local, 2)

      call points_on_wheels(pair, rho_a0, q, on_a, on_b)
      call position_gradients(pair, on_a, rho_0, gradient%rho_a, b)
      call tangent_line_gradients(on_b, b, -rho_0, angle_b, distance_b)
      gradient%angle = unit(at_turn, 1.0_wp)
      gradient%h = 0
      gradient%h(at_mu) = -1/pair%r_bb
      gradient%rho_b = -rho_0 + distance_b - pair%r_bb*angle_b
      call complete_gradient(pair, q, point, gradient)
   end subroutine gradient_points

   !> Residual of the algebraic form (1). Equations T12, T13, T28, T29, T30, T31.
   !>
   !> r_bA (grad g_A - lambda grad g_B) (t_0 component, times rho_B, and e_0 component), -(r_PA - r_PB - mu grad g_B), r_bA g_A,
   !> r_bB g_B. With its factor the first row has constant coefficients like the others, so an older Newton matrix can be reused.
   pure subroutine algebraic_residual(pair, rho_a0, q, residual, exists)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      real(wp), intent(out) :: residual(n_track) !! [m, 1, m, m, m, m]
      logical, intent(out) :: exists             !! false if a point lies inside a base circle
      type(tangent_line_t) :: on_a, on_b
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
      type(tangent_line_t) :: on_a, on_b
      real(wp), dimension(n_local) :: angle_a, angle_b, distance_b, rho_0, rho, rho_b, lambda
      real(wp) :: b(n_local, 2), big_lambda, kappa

      call points_on_wheels(pair, rho_a0, q, on_a, on_b)
      call position_gradients(pair, on_a, rho_0, rho, b)
      call tangent_line_gradients(on_b, b, -rho_0, angle_b, distance_b)
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

   !> Residual of the differential form (2)-(3) in the rates of the tracked variables.
   !> Equations T14, T15, T16, T32, T33, T34, T35, T36, T37.
   !>
   !> The terms of [w, grad g] + Hess g (u - v) that grow with the angular velocity cancel analytically. The remainder is the
   !> rotation rate of the normal, t ((u - v_O).t)/(r_b rho). Rows as in `algebraic_residual`, per second.
   pure subroutine differential_residual(pair, rho_a0, q, rates, residual, exists)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      real(wp), intent(in) :: rates(n_track) !! turn', zeta', dr', lambda', mu'
      real(wp), intent(out) :: residual(n_track)
      logical, intent(out) :: exists
      type(tangent_line_t) :: on_a, on_b
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

   !> Rate of the position of P_B as in `point_positions`. Equation T37.
   pure subroutine point_rate(pair, on_a, q, rates, rho_dot, b_dot)
      type(tracked_pair), intent(in) :: pair
      type(tangent_line_t), intent(in) :: on_a
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

   !> Rate of the angle of a tangent line. Equations T32, T33.
   pure real(wp) function turn_rate(on, rate, rho_dot)
      type(tangent_line_t), intent(in) :: on
      real(wp), intent(in) :: rate(2), rho_dot !! of the point and of its nominal distance [m/s]

      turn_rate = -(rate(1)*on%c + (rate(2) + rho_dot)*on%s)/on%rho
   end function turn_rate

   !> Derivatives of `differential_residual`: with respect to the local variables, plus cj times those with respect to the rates.
   pure subroutine differential_jacobian(pair, rho_a0, q, rates, cj, jacobian)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local), rates(n_track), cj
      real(wp), intent(out) :: jacobian(n_track, n_local)
      type(tangent_line_t) :: on_a, on_b
      real(wp), dimension(n_local) :: angle_a, angle_b, distance_b, turn_a, turn_b, along, across
      real(wp), dimension(n_local) :: lambda, kappa, lambda_dot, kappa_dot, rho_0, rho, rho_b, rho_dot
      real(wp), dimension(n_local, 2) :: b, b_dot
      real(wp) :: b_rate(2), rho_rate, turn, turn_rate_b, ratio, l, k, k_dot, l_dot

      call points_on_wheels(pair, rho_a0, q, on_a, on_b)
      call position_gradients(pair, on_a, rho_0, rho, b)
      call tangent_line_gradients(on_b, b, -rho_0, angle_b, distance_b)
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
      type(tangent_line_t), intent(in) :: on
      real(wp), intent(in) :: rate(2), rho_rate
      real(wp), intent(in) :: angle(n_local), dot(n_local, 2), rho_dot(n_local), rho(n_local) !! derivatives
      real(wp) :: turn(n_local)

      turn = -(dot(:, 1)*on%c + (dot(:, 2) + rho_dot)*on%s + (-rate(1)*on%s + (rate(2) + rho_rate)*on%c)*angle &
               + turn_rate(on, rate, rho_rate)*rho)/on%rho
   end function turn_gradient

   !> Rates from the differential form: solution of a linear system of order 6 by LAPACK.
   subroutine differential_rates(pair, rho_a0, q, rates, solved)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      real(wp), intent(out) :: rates(n_track) !! turn', zeta', dr', lambda', mu'
      logical, intent(out) :: solved          !! false if the system is singular or a point lies inside a base circle
      real(wp) :: jacobian(n_track, n_local), jacobian_0(n_track, n_local), matrix(n_track, n_track), constant(n_track)
      integer :: pivots(n_track), info

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

   !> Project the tracked points back onto (1) at the given wheel positions: Newton's method, by LAPACK. The residual of (1) after
   !> integration is so small that two corrections reach rounding.
   subroutine project_points(pair, rho_a0, q, solved)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(inout) :: q(n_local) !! local variables; the tracked ones are corrected
      logical, intent(out) :: solved        !! false if the system is singular or a point lies inside a base circle
      real(wp) :: jacobian(n_track, n_local), matrix(n_track, n_track), step(n_track)
      integer :: pivots(n_track), info, turn

      do turn = 1, 2
         call algebraic_residual(pair, rho_a0, q, step, solved)
         if (.not. solved) return
         call algebraic_jacobian(pair, rho_a0, q, jacobian)
         matrix = jacobian(:, at_track:)
         call dgesv(n_track, 1, matrix, n_track, pivots, step, n_track, info)
         solved = info == 0
         if (.not. solved) return
         q(at_track:) = q(at_track:) - step
      end do
   end subroutine project_points

   !> Positions of the tracked points in the nominal basis, from K_A at the reference centre distance [m].
   pure subroutine tracked_positions(pair, rho_a0, q, point_a, point_b)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0, q(n_local)
      real(wp), intent(out) :: point_a(2), point_b(2) !! (t_0, e_0)
      type(tangent_line_t) :: on_a
      real(wp) :: a(2), b(2)

      call point_on_driving(pair, rho_a0, q, on_a)
      call point_positions(pair, on_a, q, a, b)
      point_a = q(at_u_a:at_u_a + 1) + a + [0.0_wp, rho_a0]
      point_b = point_a + q(at_dr:at_dr + 1)
   end subroutine tracked_positions

   !> Distances of the tracked points from the line of action [m], (r_PA - K_A).t and (r_PB - K_B).t.
   pure subroutine line_distance(pair, rho_a0, q, distance_a, distance_b)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0
      real(wp), intent(in) :: q(n_local)
      real(wp), intent(out) :: distance_a, distance_b
      type(tangent_line_t) :: line, on_a, on_b
      real(wp) :: a(2), b(2), off

      call closed_form_line(pair, q, line)
      call points_on_wheels(pair, rho_a0, q, on_a, on_b)
      call point_positions(pair, on_a, q, a, b)
      off = on_a%angle - line%angle
      distance_a = -2*pair%r_ba*sin(off/2)**2 - on_a%rho*sin(off)
      ! relative to its axle P_B is -(r_bB t_0 + rho_B0 e_0 + b), and K_B is -r_bB t
      distance_b = pair%r_bb*versine(line) - (pair%rho_0 - rho_a0)*line%s - b(1)*line%c - b(2)*line%s
   end subroutine line_distance

end module evl_contact_tracking
