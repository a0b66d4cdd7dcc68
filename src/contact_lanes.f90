!> The closed form of a tooth contact for eight states at once.
!>
!> The formulas are those of the scalar kernel, included here a second time so that the compiler can put them into loops over the
!> lanes: what it cannot see it cannot turn into vector instructions. Each loop calls a procedure with its own scalars and holds
!> no branch.
module evl_contact_lanes
   use evl_closed_form, only: centre_line_turn
   use evl_contact_point, only: contact_point, tracked_pair
   use evl_deviating_flanks, only: flank_value, radius_rates
   use evl_deviation, only: deviation, small_sine, tangent_angle
   use evl_flank_deviation, only: deviation_branch, flank_branch
   use evl_kinds, only: wp
   use evl_local_variables, only: at_normal, at_omega, at_psi_a, at_psi_b, at_psi_dot_a, at_psi_dot_b, at_theta, at_u_a, at_u_b, &
                                  at_v_a, at_v_b, n_local, unit
   use evl_mesh, only: contact_off, contact_t, mesh_mode, mesh_nominal_start, mesh_tooth_a, mesh_tooth_b
   use evl_ode_model, only: lanes
   implicit none (type, external)
   private

   public :: lane_contact, contact_in_lanes, centre_turn_in_lanes

   !> A tooth contact in eight states; the components mean what those of `contact_point` mean. The contacts of a flank share the
   !> local variables and the line of action: those of the last one stay for the next.
   type :: lane_contact
      integer :: mesh = 0, flank = 0              !! of the gearbox, whose line of action it is; 0: none yet
      real(wp) :: q(lanes, at_normal)             !! local variables
      real(wp), dimension(lanes) :: margin        !! positive if there is a line of action
      real(wp), dimension(lanes) :: d_rho, rho, angle !! of the line of action
      real(wp), dimension(lanes) :: rho_a0, h, h_dot, rho_a, rho_b, s, c, l_a, l_b, v_t, arm_a, arm_b, tilt, rho_dot, &
                                    omega_a, omega_b
   end type lane_contact

contains

   include "formulas/all_positive.inc"
   include "formulas/tangent_line.inc"
   include "formulas/contact_point.inc"
   include "formulas/centre_line.inc"
   include "formulas/closed_form.inc"
   include "formulas/deviating_flanks.inc"
   include "formulas/flank_branch.inc"
   include "formulas/sine_cosine.inc"
   include "formulas/lane_point.inc"

   !> The contact from the wheels' positions. Of a slot without a pair on the path the radii of curvature are all that is set.
   subroutine contact_in_lanes(mesh, mode, turns, y, at)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      integer, intent(in) :: turns                  !! whole turns of the reference wheel beside theta
      real(wp), intent(in), contiguous :: y(:, :)   !! (lanes, states)
      type(lane_contact), intent(inout) :: at       !! of no contact, or of one in the same states
      real(wp) :: rho_start, advance
      type(tracked_pair) :: pair
      integer :: l

      if (at%mesh /= mesh%mesh .or. at%flank /= mesh%flank) call line_in_lanes(mesh, y, at)
      pair = mesh%pair
      advance = pair%advance
      rho_start = mesh_nominal_start(mesh, turns, mode%teeth)
      if (mode%contact == contact_off) then
         !$omp simd
         do l = 1, lanes
            at%rho_a0(l) = rho_start + advance*at%q(l, at_theta)
            call place_radii_lane(pair, l, at)
         end do
         return
      end if
      !$omp simd
      do l = 1, lanes
         at%rho_a0(l) = rho_start + advance*at%q(l, at_theta)
         call place_lane(pair, l, at)
      end do
      if (mesh%deviates) call deviate_lanes(mesh, mode, at)
   end subroutine contact_in_lanes

   !> Local variables and line of action, for all contacts of a flank.
   subroutine line_in_lanes(mesh, y, at)
      type(contact_t), intent(in) :: mesh           !! one of them
      real(wp), intent(in), contiguous :: y(:, :)   !! (lanes, states)
      type(lane_contact), intent(inout) :: at
      real(wp) :: r, rho_0
      integer :: i, l

      at%mesh = mesh%mesh
      at%flank = mesh%flank
      at%q = 0
      do i = 1, size(mesh%links)
         associate (link => mesh%links(i))
            at%q(:, link%local) = at%q(:, link%local) + link%weight*y(1:lanes, link%state)
         end associate
      end do
      if (mesh%axles_rest) then
         call rest_in_lanes(mesh%rest_line, at)
         return
      end if
      r = mesh%pair%r_ba + mesh%pair%r_bb
      rho_0 = mesh%pair%rho_0
      !$omp simd
      do l = 1, lanes
         call tangent_line(r, rho_0, at%q(l, at_u_b) - at%q(l, at_u_a), at%q(l, at_u_b + 1) - at%q(l, at_u_a + 1), &
                           at%margin(l), at%d_rho(l), at%rho(l), at%s(l), at%c(l))
         at%angle(l) = small_angle(at%s(l))
      end do
      if (.not. all_positive(small_sine - abs(at%s))) call large_angles(at%s, at%c, at%angle)
   end subroutine line_in_lanes

   !> The line of action between fixed axles.
   pure subroutine rest_in_lanes(line, at)
      type(deviation), intent(in) :: line
      type(lane_contact), intent(inout) :: at

      at%margin = merge(1.0_wp, 0.0_wp, line%exists)
      at%d_rho = line%d_rho
      at%rho = line%rho
      at%angle = line%angle
      at%s = line%s
      at%c = line%c
   end subroutine rest_in_lanes

   !> Angles of which one is too large for the series. The vector library's arc tangent gives other bits than the scalar one.
   subroutine large_angles(s, c, angle)
      real(wp), intent(in) :: s(lanes), c(lanes)
      real(wp), intent(out) :: angle(lanes)
      integer :: l

      !GCC$ novector
      do l = 1, lanes
         angle(l) = tangent_angle(s(l), c(l))
      end do
   end subroutine large_angles

   !> One lane of a contact along its line of action.
   pure subroutine place_lane(pair, l, at)
      type(tracked_pair), intent(in) :: pair
      integer, intent(in) :: l
      type(lane_contact), intent(inout) :: at
      type(contact_point) :: point

      call lane_point(pair, l, at, point)
      call store_lane(point, l, at)
   end subroutine place_lane

   !> The radii of curvature alone: the rest of the point is computed for nobody, which the compiler sees.
   pure subroutine place_radii_lane(pair, l, at)
      type(tracked_pair), intent(in) :: pair
      integer, intent(in) :: l
      type(lane_contact), intent(inout) :: at
      type(contact_point) :: point

      call lane_point(pair, l, at, point)
      at%rho_a(l) = point%rho_a
      at%rho_b(l) = point%rho_b
   end subroutine place_radii_lane

   !> The contact of one lane.
   pure subroutine lane_point(pair, l, at, point)
      type(tracked_pair), intent(in) :: pair
      integer, intent(in) :: l
      type(lane_contact), intent(in) :: at
      type(contact_point), intent(out) :: point
      type(deviation) :: line
      real(wp) :: q(n_local)

      call lane_local(at, l, q)
      line%exists = .true.
      line%d_rho = at%d_rho(l)
      line%rho = at%rho(l)
      line%angle = at%angle(l)
      line%s = at%s(l)
      line%c = at%c(l)
      call place_contact(pair, at%rho_a0(l), q, line, point)
   end subroutine lane_point

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

   !> From the contact of perfect involutes to that of deviating flanks.
   subroutine deviate_lanes(mesh, mode, at)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(lane_contact), intent(inout) :: at
      real(wp), dimension(lanes) :: e_a, de_a, e_b, de_b
      type(tracked_pair) :: pair
      integer :: l, side

      pair = mesh%pair
      side = nint(pair%sigma)
      call deviation_in_lanes(deviation_branch(mesh%deviation_a, mesh_tooth_a(mesh, mode%teeth), side, mode%zone_a), &
                              at%rho_a, e_a, de_a)
      call deviation_in_lanes(deviation_branch(mesh%deviation_b, mesh_tooth_b(mesh, mode%teeth), side, mode%zone_b), &
                              at%rho_b, e_b, de_b)
      !$omp simd
      do l = 1, lanes
         call deviate_lane(pair, l, e_a(l), de_a(l), e_b(l), de_b(l), at)
      end do
   end subroutine deviate_lanes

   !> What one flank lacks in material.
   pure subroutine deviation_in_lanes(branch, rho, e, de)
      type(flank_branch), intent(in) :: branch
      real(wp), intent(in) :: rho(lanes)
      real(wp), intent(out) :: e(lanes), de(lanes)
      real(wp) :: d2e(lanes)
      integer :: l

      !$omp simd
      do l = 1, lanes
         call profile_deviation(branch, rho(l), e(l), de(l), d2e(l))
      end do
      if (.not. abs(branch%runout) > 0) return
      !$omp simd
      do l = 1, lanes
         call add_runout(branch, rho(l), e(l), de(l), d2e(l))
      end do
   end subroutine deviation_in_lanes

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
      if (mesh%axles_rest) then
         turn = centre_line_turn(pair, unit(at_theta, 0.0_wp))
         return
      end if
      !$omp simd
      do l = 1, lanes
         call centre_line(pair, at%q(l, at_u_b) - at%q(l, at_u_a), at%q(l, at_u_b + 1) - at%q(l, at_u_a + 1), s(l), c(l))
         turn(l) = small_angle(s(l))
      end do
      if (.not. all_positive(small_sine - abs(s))) call large_angles(s, c, turn)
   end subroutine centre_turn_in_lanes

end module evl_contact_lanes
