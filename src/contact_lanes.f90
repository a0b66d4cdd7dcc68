!> The closed form of a tooth contact for eight states at once.
!>
!> The formulas are those of the scalar kernel, included here a second time so that the compiler can put them into loops over the
!> lanes: what it cannot see it cannot turn into vector instructions. Each loop calls a procedure with its own scalars and holds
!> no branch; which law acts is decided outside. Laws without a loop of their own are asked lane by lane.
module evl_contact_lanes
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_contact_laws, only: contact_johnson, contact_radzimovsky, &
                               damping_hunt_crossley, damping_lee_wang, damping_linear, damping_none, elastic_force, &
                               elastic_result, friction_coulomb, friction_factor, friction_none, impact_share, &
                               viscous_force, viscous_result
   use evl_contact_point, only: contact_point, tracked_pair
   use evl_deviating_flanks, only: flank_value, radius_rates
   use evl_deviation, only: deviation, small_sine, tangent_angle
   use evl_flank_deviation, only: deviation_at
   use evl_johnson, only: exp_minus_2, smallest_ratio
   use evl_kinds, only: pi, wp
   use evl_local_variables, only: at_normal, at_omega, at_psi_a, at_psi_b, at_psi_dot_a, at_psi_dot_b, at_theta, at_u_a, at_u_b, &
                                  at_v_a, at_v_b, n_local
   use evl_mesh, only: contact_t, contact_unloaded, context_of, mesh_force, mesh_mode, mesh_nominal_start, &
                       mesh_tooth_a, mesh_tooth_b
   use evl_ode_model, only: lanes
   use evl_radzimovsky, only: enlarged
   use evl_status, only: code_ok, code_out_of_domain
   implicit none (type, external)
   private

   public :: lane_contact, lane_force, contact_in_lanes, forces_in_lanes, laws_in_lanes, centre_turn_in_lanes

   !> A tooth contact in eight states; the components mean what those of `contact_point` mean.
   type :: lane_contact
      real(wp) :: q(lanes, at_normal)             !! local variables
      real(wp), dimension(lanes) :: margin        !! positive if there is a line of action
      real(wp), dimension(lanes) :: d_rho, rho, angle !! of the line of action
      real(wp), dimension(lanes) :: rho_a0, h, h_dot, rho_a, rho_b, s, c, l_a, l_b, v_t, arm_a, arm_b, tilt, rho_dot, &
                                    omega_a, omega_b
   end type lane_contact

   !> Forces of a tooth contact in eight states; the components mean what those of `mesh_force` mean.
   type :: lane_force
      real(wp), dimension(lanes) :: elastic, viscous, d_energy, factor
      real(wp), dimension(lanes) :: torque_a, torque_b, on_a_t, on_a_e, dissipation
   end type lane_force

contains

   include "formulas/logarithm.inc"
   include "formulas/tangent_line.inc"
   include "formulas/contact_point.inc"
   include "formulas/centre_line.inc"
   include "formulas/closed_form.inc"
   include "formulas/deviating_flanks.inc"
   include "formulas/johnson.inc"
   include "formulas/radzimovsky.inc"
   include "formulas/spread_over_width.inc"
   include "formulas/damping.inc"
   include "formulas/coulomb.inc"
   include "formulas/contact_forces.inc"

   !> The contact from the wheels' positions.
   subroutine contact_in_lanes(mesh, mode, turns, y, at)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      integer, intent(in) :: turns                  !! whole turns of the reference wheel beside theta
      real(wp), intent(in), contiguous :: y(:, :)   !! (lanes, states)
      type(lane_contact), intent(out) :: at
      real(wp) :: r, rho_0, rho_start, advance
      type(tracked_pair) :: pair
      integer :: i, l

      at%q = 0
      do i = 1, size(mesh%links)
         associate (link => mesh%links(i))
            at%q(:, link%local) = at%q(:, link%local) + link%weight*y(1:lanes, link%state)
         end associate
      end do
      pair = mesh%pair
      r = pair%r_ba + pair%r_bb
      rho_0 = pair%rho_0
      advance = pair%advance
      rho_start = mesh_nominal_start(mesh, turns, mode%teeth)
      !$omp simd
      do l = 1, lanes
         at%rho_a0(l) = rho_start + advance*at%q(l, at_theta)
         call tangent_line(r, rho_0, at%q(l, at_u_b) - at%q(l, at_u_a), at%q(l, at_u_b + 1) - at%q(l, at_u_a + 1), &
                           at%margin(l), at%d_rho(l), at%rho(l), at%s(l), at%c(l))
         at%angle(l) = small_angle(at%s(l))
      end do
      if (maxval(abs(at%s)) >= small_sine) call large_angles(at%s, at%c, at%angle)
      !$omp simd
      do l = 1, lanes
         call place_lane(pair, l, at)
      end do
      if (mesh%deviates) call deviate_lanes(mesh, mode, at)
   end subroutine contact_in_lanes

   !> Angles of which one is too large for the series.
   subroutine large_angles(s, c, angle)
      real(wp), intent(in) :: s(lanes), c(lanes)
      real(wp), intent(out) :: angle(lanes)
      integer :: l

      do l = 1, lanes
         angle(l) = tangent_angle(s(l), c(l))
      end do
   end subroutine large_angles

   !> One lane of a contact along its line of action.
   pure subroutine place_lane(pair, l, at)
      type(tracked_pair), intent(in) :: pair
      integer, intent(in) :: l
      type(lane_contact), intent(inout) :: at
      type(deviation) :: line
      type(contact_point) :: point
      real(wp) :: q(n_local)

      call lane_local(at, l, q)
      line%exists = .true.
      line%d_rho = at%d_rho(l)
      line%rho = at%rho(l)
      line%angle = at%angle(l)
      line%s = at%s(l)
      line%c = at%c(l)
      call place_contact(pair, at%rho_a0(l), q, line, point)
      call store_lane(point, l, at)
   end subroutine place_lane

   !> Local variables of one lane.
   pure subroutine lane_local(at, l, q)
      type(lane_contact), intent(in) :: at
      integer, intent(in) :: l
      real(wp), intent(out) :: q(n_local)

      q(at_psi_a) = at%q(l, at_psi_a)
      q(at_psi_b) = at%q(l, at_psi_b)
      q(at_omega) = at%q(l, at_omega)
      q(at_psi_dot_a) = at%q(l, at_psi_dot_a)
      q(at_psi_dot_b) = at%q(l, at_psi_dot_b)
      q(at_v_a) = at%q(l, at_v_a)
      q(at_v_a + 1) = at%q(l, at_v_a + 1)
      q(at_v_b) = at%q(l, at_v_b)
      q(at_v_b + 1) = at%q(l, at_v_b + 1)
      q(at_normal) = 0
   end subroutine lane_local

   !> Put a point into its lane.
   pure subroutine store_lane(point, l, at)
      type(contact_point), intent(in) :: point
      integer, intent(in) :: l
      type(lane_contact), intent(inout) :: at

      at%h(l) = point%h
      at%h_dot(l) = point%h_dot
      at%rho_a(l) = point%rho_a
      at%rho_b(l) = point%rho_b
      at%l_a(l) = point%l_a
      at%l_b(l) = point%l_b
      at%v_t(l) = point%v_t
      at%arm_a(l) = point%arm_a
      at%arm_b(l) = point%arm_b
      at%tilt(l) = point%tilt
      at%rho_dot(l) = point%rho_dot
      at%omega_a(l) = point%omega_a
      at%omega_b(l) = point%omega_b
   end subroutine store_lane

   !> Take a point from its lane.
   pure subroutine take_lane(at, l, point)
      type(lane_contact), intent(in) :: at
      integer, intent(in) :: l
      type(contact_point), intent(out) :: point

      point%exists = .true.
      point%multiplier = 0
      point%h = at%h(l)
      point%h_dot = at%h_dot(l)
      point%rho_a = at%rho_a(l)
      point%rho_b = at%rho_b(l)
      point%s = at%s(l)
      point%c = at%c(l)
      point%l_a = at%l_a(l)
      point%l_b = at%l_b(l)
      point%v_t = at%v_t(l)
      point%arm_a = at%arm_a(l)
      point%arm_b = at%arm_b(l)
      point%tilt = at%tilt(l)
      point%rho_dot = at%rho_dot(l)
      point%omega_a = at%omega_a(l)
      point%omega_b = at%omega_b(l)
   end subroutine take_lane

   !> From the contact of perfect involutes to that of deviating flanks.
   subroutine deviate_lanes(mesh, mode, at)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(lane_contact), intent(inout) :: at
      real(wp), dimension(lanes) :: e_a, de_a, e_b, de_b
      real(wp) :: d2e
      type(tracked_pair) :: pair
      integer :: l, side, tooth_a, tooth_b

      pair = mesh%pair
      side = nint(pair%sigma)
      tooth_a = mesh_tooth_a(mesh, mode%teeth)
      tooth_b = mesh_tooth_b(mesh, mode%teeth)
      do l = 1, lanes
         call deviation_at(mesh%deviation_a, tooth_a, side, at%rho_a(l), mode%zone_a, e_a(l), de_a(l), d2e)
         call deviation_at(mesh%deviation_b, tooth_b, side, at%rho_b(l), mode%zone_b, e_b(l), de_b(l), d2e)
      end do
      !$omp simd
      do l = 1, lanes
         call deviate_lane(pair, l, e_a(l), de_a(l), e_b(l), de_b(l), at)
      end do
   end subroutine deviate_lanes

   !> One lane of it.
   pure subroutine deviate_lane(pair, l, e_a, de_a, e_b, de_b, at)
      type(tracked_pair), intent(in) :: pair
      integer, intent(in) :: l
      real(wp), intent(in) :: e_a, de_a, e_b, de_b
      type(lane_contact), intent(inout) :: at
      type(contact_point) :: point
      real(wp) :: q(n_local)

      call lane_local(at, l, q)
      call take_lane(at, l, point)
      call deviate(pair, flank_value(e_a, de_a, 0.0_wp), flank_value(e_b, de_b, 0.0_wp), q, point)
      call store_lane(point, l, at)
   end subroutine deviate_lane

   !> How far the centre line has turned [rad].
   subroutine centre_turn_in_lanes(mesh, at, turn)
      type(contact_t), intent(in) :: mesh
      type(lane_contact), intent(in) :: at
      real(wp), intent(out) :: turn(lanes)
      real(wp), dimension(lanes) :: s, c
      type(tracked_pair) :: pair
      integer :: l

      pair = mesh%pair
      !$omp simd
      do l = 1, lanes
         call centre_line(pair, at%q(l, at_u_b) - at%q(l, at_u_a), at%q(l, at_u_b + 1) - at%q(l, at_u_a + 1), s(l), c(l))
         turn(l) = small_angle(s(l))
      end do
      if (maxval(abs(s)) >= small_sine) call large_angles(s, c, turn)
   end subroutine centre_turn_in_lanes

   !> Forces of flanks that overlap.
   subroutine forces_in_lanes(mesh, mode, at, force, answered)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(out) :: force
      logical, intent(out) :: answered !! false if the laws or the involutes have no answer in one of the lanes
      real(wp) :: sigma
      integer :: l

      call laws_in_lanes(mesh, mode, at, force, answered)
      if (.not. answered) return
      sigma = mesh%pair%sigma
      if (mode%contact == contact_unloaded) then
         force%torque_a = 0
         force%torque_b = 0
         force%on_a_t = 0
         force%on_a_e = 0
         do l = 1, lanes
            call lose_lane(at, l, force)
         end do
         return
      end if
      call friction_in_lanes(mesh, mode, at, force)
      !$omp simd
      do l = 1, lanes
         call resolve_lane(sigma, at, l, force)
      end do
   end subroutine forces_in_lanes

   !> Elastic and viscous force.
   subroutine laws_in_lanes(mesh, mode, at, force, answered)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(inout) :: force
      logical, intent(out) :: answered

      answered = minval(min(at%margin, at%rho_a, at%rho_b)) > 0
      if (.not. answered) return
      call elastic_in_lanes(mesh, mode, at, force, answered)
      call viscous_in_lanes(mesh, mode, at, force)
   end subroutine laws_in_lanes

   !> Elastic force.
   subroutine elastic_in_lanes(mesh, mode, at, force, answered)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(inout) :: force
      logical, intent(out) :: answered
      type(contact_point) :: point
      type(elastic_result) :: elastic
      real(wp) :: answers(lanes)
      integer :: code, l
      real(wp) :: e_star, width

      answers = 1
      e_star = mesh%e_star
      width = mesh%width
      select case (mesh%contact%law)
      case (contact_johnson)
         !$omp simd
         do l = 1, lanes
            call johnson_lane(at%h(l), at%rho_a(l) + at%rho_b(l), e_star, width, force%elastic(l), &
                              force%d_energy(l), answers(l))
         end do
      case (contact_radzimovsky)
         !$omp simd
         do l = 1, lanes
            call radzimovsky_lane(at%h(l), at%rho_a(l) + at%rho_b(l), e_star, width, force%elastic(l), force%d_energy(l), &
                                  answers(l))
         end do
      case default
         do l = 1, lanes
            call take_lane(at, l, point)
            call elastic_force(mesh%contact, context_of(mesh, point, mode%v0), elastic, code)
            if (code /= code_ok) answers(l) = 0
            force%elastic(l) = elastic%force
            force%d_energy(l) = elastic%d_energy
         end do
      end select
      answered = minval(answers) > 0
   end subroutine elastic_in_lanes

   !> Johnson's force in one lane.
   elemental subroutine johnson_lane(h, rho_sum, e_star, width, force, d_energy, answer)
      real(wp), intent(in) :: h, rho_sum, e_star, width
      real(wp), intent(out) :: force, d_energy
      real(wp), intent(out) :: answer !! 1, or 0 outside the law's domain: integers are shorter, and vectors would be too
      type(elastic_result) :: elastic
      integer :: code

      call johnson_force(h, rho_sum, e_star, elastic%force, elastic%d_h, elastic%d_rho, code)
      call spread_over_width(width, e_star, rho_sum, elastic)
      force = elastic%force
      d_energy = elastic%d_energy
      answer = merge(1.0_wp, 0.0_wp, code == code_ok)
   end subroutine johnson_lane

   !> Radzimovsky's force in one lane.
   elemental subroutine radzimovsky_lane(h, rho_sum, e_star, width, force, d_energy, answer)
      real(wp), intent(in) :: h, rho_sum, e_star, width
      real(wp), intent(out) :: force, d_energy
      real(wp), intent(out) :: answer !! 1, or 0 outside the law's domain: integers are shorter, and vectors would be too
      type(elastic_result) :: elastic
      integer :: code

      call radzimovsky_force(h, rho_sum, e_star, elastic%force, elastic%d_h, elastic%d_rho, code)
      call spread_over_width(width, e_star, rho_sum, elastic)
      force = elastic%force
      d_energy = elastic%d_energy
      answer = merge(1.0_wp, 0.0_wp, code == code_ok)
   end subroutine radzimovsky_lane

   !> Viscous force.
   subroutine viscous_in_lanes(mesh, mode, at, force)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(inout) :: force
      type(contact_point) :: point
      type(viscous_result) :: viscous
      real(wp) :: coefficient, slope
      integer :: l

      select case (mesh%damping%law)
      case (damping_none)
         force%viscous = 0
      case (damping_linear)
         coefficient = mesh%damping%parameters(1)
         do l = 1, lanes
            call linear_damping(at%h_dot(l), coefficient, force%viscous(l), slope)
         end do
      case (damping_hunt_crossley:damping_lee_wang)
         coefficient = impact_share(mesh%damping, mode%v0)
         force%viscous = impact_damping(coefficient, force%elastic, at%h_dot)
      case default
         do l = 1, lanes
            call take_lane(at, l, point)
            call viscous_force(mesh%damping, context_of(mesh, point, mode%v0), elastic_result(force=force%elastic(l)), viscous)
            force%viscous(l) = viscous%force
         end do
      end select
   end subroutine viscous_in_lanes

   !> The friction law's factor of the normal force.
   subroutine friction_in_lanes(mesh, mode, at, force)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(inout) :: force
      real(wp) :: coefficient, delta, slope
      integer :: branch, l

      select case (mesh%friction%law)
      case (friction_none)
         force%factor = 0
      case (friction_coulomb)
         branch = mode%friction
         coefficient = mesh%friction%parameters(1)
         delta = mesh%friction%parameters(2)
         do l = 1, lanes
            call coulomb_factor(branch, at%v_t(l), coefficient, delta, force%factor(l), slope)
         end do
      case default
         do l = 1, lanes
            call friction_factor(mesh%friction, mode%friction, at%v_t(l), force%factor(l), slope)
         end do
      end select
   end subroutine friction_in_lanes

   !> One lane of the forces on the wheels.
   pure subroutine resolve_lane(sigma, at, l, force)
      real(wp), intent(in) :: sigma
      type(lane_contact), intent(in) :: at
      integer, intent(in) :: l
      type(lane_force), intent(inout) :: force
      type(contact_point) :: point
      type(mesh_force) :: resolved

      call take_lane(at, l, point)
      call resolve_forces(sigma, point, elastic_result(force=force%elastic(l), d_energy=force%d_energy(l)), force%viscous(l), &
                          force%factor(l), resolved)
      force%torque_a(l) = resolved%torque_a
      force%torque_b(l) = resolved%torque_b
      force%on_a_t(l) = resolved%on_a(1)
      force%on_a_e(l) = resolved%on_a(2)
      force%dissipation(l) = resolved%dissipation
   end subroutine resolve_lane

   !> One lane of flanks that overlap without force.
   pure subroutine lose_lane(at, l, force)
      type(lane_contact), intent(in) :: at
      integer, intent(in) :: l
      type(lane_force), intent(inout) :: force
      type(contact_point) :: point

      call take_lane(at, l, point)
      force%dissipation(l) = unloaded_loss(point, elastic_result(force=force%elastic(l), d_energy=force%d_energy(l)))
   end subroutine lose_lane

end module evl_contact_lanes
