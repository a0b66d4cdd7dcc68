!> Closed form of a tooth contact for eight states at once.
!>
!> The formulas are those of the scalar kernel. They are included here again so that the compiler can inline them into the loops
!> over the lanes and vectorise these. Each loop calls a procedure with its own scalars and contains no branch.
module evl_contact_lanes
   use evl_contact_context, only: lane_context
   use evl_contact_point, only: contact_point, tracked_pair
   use evl_deviating_flanks, only: flank_value, radius_rates
   use evl_deviation_lanes, only: deviation_in_lanes, slope_in_lanes, turned_in_lanes
   use evl_edge_lanes, only: find_feet_in_lanes, lane_edge, lane_gap, slopes_in_lanes
   use evl_flank_deviation, only: flank_branch, zone_edge
   use evl_kinds, only: lanes, wp
   use evl_line_lanes, only: lane_line
   use evl_local_variables, only: at_normal, at_omega, at_psi_a, at_psi_b, at_psi_dot_a, at_psi_dot_b, at_v_a, at_v_b, n_local
   use evl_pair_point, only: by_a, by_b, by_line
   use evl_root_kinds, only: side_of_rate
   use evl_tangent_line, only: tangent_line_t
   use evl_tooth_contact, only: beyond_flank, contact_mode, ended_wheel, flank_branches, flanks_off, tooth_contact_t
   implicit none (type, external)
   private

   public :: lane_contact, contact_in_lanes, gap_in_lanes, store_lane

   !> A tooth contact in eight states. Components have the same meaning as in `contact_point`; those that laws may use are in the
   !> parent type.
   type, extends(lane_context) :: lane_contact
      real(wp), dimension(lanes) :: rho_a0 !! nominal radius of curvature on A [m]
      real(wp), dimension(lanes) :: overlap !! as in `contact_state`
      real(wp), dimension(lanes) :: s, c, l_a, l_b, v_t, arm_a, arm_b, tilt, rho_dot, omega_a, omega_b
      type(lane_edge) :: edge              !! past the end of a flank only
   end type lane_contact

contains

   include "contact/contact_point.inc"
   include "contact/closed_form.inc"
   include "contact/deviating_flanks.inc"
   include "contact/edge/edge_point.inc"
   include "contact/lanes/lane_point.inc"

   !> Contact along its line of action. For a slot without a pair on the path only the radii of curvature are set.
   subroutine contact_in_lanes(contact, mode, rho_start, line, at)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      real(wp), intent(in) :: rho_start             !! nominal radius of curvature on A at theta = 0 [m]
      type(lane_line), intent(in) :: line
      type(lane_contact), intent(out) :: at
      real(wp) :: advance
      type(tracked_pair) :: pair
      integer :: l

      at%e_star = contact%e_star
      at%width = contact%width
      at%v0 = mode%v0
      at%side = mode%sides(side_of_rate)
      pair = contact%pair
      advance = pair%advance
      if (mode%flanks == flanks_off) then
         !$omp simd
         do l = 1, lanes
            at%rho_a0(l) = rho_start + advance*line%theta(l)
            call evaluate_radii_lane(pair, line, l, at)
         end do
         return
      end if
      !$omp simd
      do l = 1, lanes
         at%rho_a0(l) = rho_start + advance*line%theta(l)
         call evaluate_lane(pair, line, l, at)
      end do
      if (beyond_flank(mode)) then
         call put_lanes_on_edge(contact, mode, line, at)
      else if (contact%deviates) then
         call deviate_lanes(contact, mode, line, at)
      end if
      at%overlap = at%h
   end subroutine contact_in_lanes

   !> Gap of perfect flanks along their line of action [m].
   pure subroutine gap_in_lanes(contact, line, gap)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_line), intent(in) :: line
      real(wp), intent(out) :: gap(lanes)
      type(tracked_pair) :: pair
      integer :: l

      pair = contact%pair
      !$omp simd
      do l = 1, lanes
         call gap_lane(pair, line, l, gap(l))
      end do
   end subroutine gap_in_lanes

   !> One lane of `gap_in_lanes`.
   pure subroutine gap_lane(pair, line, l, gap)
      type(tracked_pair), intent(in) :: pair
      type(lane_line), intent(in) :: line
      integer, intent(in) :: l
      real(wp), intent(out) :: gap
      real(wp) :: q(n_local)

      call lane_local(line, l, q)
      gap = gap_along(pair, q, tangent_line_t(.true., line%d_rho(l), line%rho(l), line%angle(l), line%s(l), line%c(l)))
   end subroutine gap_lane

   !> One lane of a contact along its line of action.
   pure subroutine evaluate_lane(pair, line, l, at)
      type(tracked_pair), intent(in) :: pair
      type(lane_line), intent(in) :: line
      integer, intent(in) :: l
      type(lane_contact), intent(inout) :: at
      type(contact_point) :: point

      call lane_point(pair, line, l, at%rho_a0(l), point)
      call store_lane(point, l, at)
   end subroutine evaluate_lane

   !> Radii of curvature alone; the compiler removes the unused rest of the point.
   pure subroutine evaluate_radii_lane(pair, line, l, at)
      type(tracked_pair), intent(in) :: pair
      type(lane_line), intent(in) :: line
      integer, intent(in) :: l
      type(lane_contact), intent(inout) :: at
      type(contact_point) :: point

      call lane_point(pair, line, l, at%rho_a0(l), point)
      at%rho_a(l) = point%rho_a
      at%rho_b(l) = point%rho_b
   end subroutine evaluate_radii_lane

   !> Contact point of one lane.
   pure subroutine lane_point(pair, line, l, rho_a0, point)
      type(tracked_pair), intent(in) :: pair
      type(lane_line), intent(in) :: line
      integer, intent(in) :: l
      real(wp), intent(in) :: rho_a0
      type(contact_point), intent(out) :: point
      real(wp) :: q(n_local)

      call lane_local(line, l, q)
      call point_on_line(pair, rho_a0, q, tangent_line_t(.true., line%d_rho(l), line%rho(l), line%angle(l), line%s(l), line%c(l)), &
                         point)
   end subroutine lane_point

   !> Local variables of one lane. Only the motion of B relative to A enters, so the velocity of axle A is set to 0.
   pure subroutine lane_local(line, l, q)
      type(lane_line), intent(in) :: line
      integer, intent(in) :: l
      real(wp), intent(out) :: q(n_local)

      q(at_psi_a) = line%psi_a(l)
      q(at_psi_b) = line%psi_b(l)
      q(at_omega) = line%omega(l)
      q(at_psi_dot_a) = line%psi_dot_a(l)
      q(at_psi_dot_b) = line%psi_dot_b(l)
      q(at_v_a) = 0
      q(at_v_a + 1) = 0
      q(at_v_b) = line%v_t(l)
      q(at_v_b + 1) = line%v_e(l)
      q(at_normal) = 0
   end subroutine lane_local

   !> Store a contact point in its lane.
   pure subroutine store_lane(point, l, at)
      type(contact_point), intent(in) :: point
      integer, intent(in) :: l
      type(lane_contact), intent(inout) :: at

      at%h(l) = point%h
      at%h_dot(l) = point%h_dot
      at%rho_a(l) = point%rho_a
      at%rho_b(l) = point%rho_b
      at%s(l) = point%s
      at%c(l) = point%c
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

   !> Correct the contact of perfect involutes for the deviations of the flanks.
   subroutine deviate_lanes(contact, mode, line, at)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(lane_line), intent(in) :: line
      type(lane_contact), intent(inout) :: at
      real(wp), dimension(lanes) :: e_a, de_a, e_b, de_b
      type(tracked_pair) :: pair
      type(flank_branch) :: branch_a, branch_b
      integer :: l

      pair = contact%pair
      call flank_branches(contact, mode, branch_a, branch_b)
      if (branch_a%slopes .and. branch_b%slopes) then
         call turn_lanes(contact, mode, branch_a, branch_b, at, e_a, de_a, e_b, de_b)
      else
         call deviation_in_lanes(branch_a, at%rho_a, e_a, de_a)
         call deviation_in_lanes(branch_b, at%rho_b, e_b, de_b)
      end if
      !$omp simd
      do l = 1, lanes
         call deviate_lane(pair, line, l, e_a(l), de_a(l), e_b(l), de_b(l), at)
      end do
   end subroutine deviate_lanes

   !> Deviations of two flanks that both have a slope, in eight states, with the coupling term of `turn_together`.
   subroutine turn_lanes(contact, mode, branch_a, branch_b, at, e_a, de_a, e_b, de_b)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(flank_branch), intent(in) :: branch_a, branch_b
      type(lane_contact), intent(in) :: at
      real(wp), intent(out), dimension(lanes) :: e_a, de_a, e_b, de_b
      real(wp), dimension(lanes) :: s_a, ds_a, s_b, ds_b
      real(wp) :: arm
      integer :: l

      arm = turning_arm(contact%pair)
      call turned_in_lanes(contact%deviation_a, mode%zone_a, branch_a, at%rho_a, e_a, de_a, s_a, ds_a)
      call turned_in_lanes(contact%deviation_b, mode%zone_b, branch_b, at%rho_b, e_b, de_b, s_b, ds_b)
      !$omp simd
      do l = 1, lanes
         call turn_together(arm, s_a(l), ds_a(l), s_b(l), ds_b(l), e_a(l), de_a(l), e_b(l), de_b(l))
      end do
   end subroutine turn_lanes

   !> The same past the end of a flank: `turn_feet` in eight states.
   subroutine turn_feet_in_lanes(contact, mode, own, branch, foot, past, de)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      integer, intent(in) :: own                 !! wheel whose flank end is passed
      type(flank_branch), intent(in) :: branch   !! of the mate
      real(wp), intent(in) :: foot(lanes)        !! on the mate [m]
      type(lane_gap), intent(inout) :: past
      real(wp), intent(inout) :: de(lanes)       !! of the mate
      real(wp), dimension(lanes, 2) :: s, ds
      real(wp) :: arm
      integer :: l, mate

      arm = turning_arm(contact%pair)
      mate = by_a + by_b - own
      s(:, own) = past%slope
      ds(:, own) = past%d_slope
      if (mate == by_a) then
         call slope_in_lanes(contact%deviation_a, mode%zone_a, branch, foot, s(:, mate), ds(:, mate))
      else
         call slope_in_lanes(contact%deviation_b, mode%zone_b, branch, foot, s(:, mate), ds(:, mate))
      end if
      !$omp simd
      do l = 1, lanes
         past%gap(l) = past%gap(l) + arm*s(l, by_a)*s(l, by_b)
         past%by_own(l) = past%by_own(l) + arm*ds(l, own)*s(l, mate)
         de(l) = de(l) + arm*ds(l, mate)*s(l, own)
      end do
   end subroutine turn_feet_in_lanes

   !> Correct the contact of perfect involutes for a pair past the end of a flank.
   subroutine put_lanes_on_edge(contact, mode, line, at)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(lane_line), intent(in) :: line
      type(lane_contact), intent(inout) :: at
      type(tracked_pair) :: pair
      type(flank_branch) :: branches(2)
      type(lane_gap) :: past
      real(wp), dimension(lanes, 2) :: arms, de, e, rho
      integer :: l, mate, own

      pair = contact%pair
      own = ended_wheel(mode)
      mate = by_a + by_b - own
      call flank_branches(contact, mode, branches(by_a), branches(by_b))
      rho(:, by_a) = at%rho_a
      rho(:, by_b) = at%rho_b
      at%edge%line = at%rho_a + at%rho_b - at%h
      call find_feet_in_lanes(contact%tips(own), own, merge(mode%zone_a, mode%zone_b, own == by_a) == zone_edge, rho(:, own), &
                              rho(:, mate), at%edge, past)
      call deviation_in_lanes(branches(own), rho(:, own), e(:, own), de(:, own))
      call deviation_in_lanes(branches(mate), at%edge%foot(:, mate), e(:, mate), de(:, mate))
      arms(:, own) = past%arm - past%gap - e(:, own)
      arms(:, mate) = at%edge%foot(:, mate) - e(:, mate)
      if (contact%tips(own)%profile%slopes .and. branches(mate)%slopes) &
         call turn_feet_in_lanes(contact, mode, own, branches(mate), at%edge%foot(:, mate), past, de(:, mate))
      call slopes_in_lanes(own, past, de, at%edge)
      !$omp simd
      do l = 1, lanes
         call put_lane_on_edge(pair, line, l, at%edge%margin(l), past%x(l), past%gap(l), e(l, by_a), &
                               e(l, by_b), at%edge%d_h(l, by_a), at%edge%d_h(l, by_b), at%edge%d_h(l, by_line), arms(l, by_a), &
                               arms(l, by_b), at)
      end do
   end subroutine put_lanes_on_edge

   !> One lane of `put_lanes_on_edge`.
   pure subroutine put_lane_on_edge(pair, line, l, margin, x, gap, e_a, e_b, by_rho_a, by_rho_b, by_rho, arm_a, arm_b, at)
      type(tracked_pair), intent(in) :: pair
      type(lane_line), intent(in) :: line
      integer, intent(in) :: l
      real(wp), intent(in) :: margin, x, gap, e_a, e_b !! as in `lane_edge` and `lane_gap`
      real(wp), intent(in) :: by_rho_a, by_rho_b, by_rho       !! derivatives of the penetration
      real(wp), intent(in) :: arm_a, arm_b                     !! of the friction force without penetration [m]
      type(lane_contact), intent(inout) :: at
      type(contact_point) :: point
      type(radius_rates) :: rate
      real(wp) :: q(n_local)

      call lane_local(line, l, q)
      call take_lane(at, l, point)
      rate = rates_of(pair, q, point)
      call correct_for_edge(pair, rate, margin, x, gap, e_a + e_b, by_rho_a, by_rho_b, by_rho, arm_a, arm_b, point)
      call store_lane(point, l, at)
   end subroutine put_lane_on_edge

   !> One lane of `deviate_lanes`.
   pure subroutine deviate_lane(pair, line, l, e_a, de_a, e_b, de_b, at)
      type(tracked_pair), intent(in) :: pair
      type(lane_line), intent(in) :: line
      integer, intent(in) :: l
      real(wp), intent(in) :: e_a, de_a, e_b, de_b
      type(lane_contact), intent(inout) :: at
      type(contact_point) :: point
      real(wp) :: q(n_local)

      call lane_local(line, l, q)
      call take_lane(at, l, point)
      call deviate(pair, flank_value(e_a, de_a, 0.0_wp), flank_value(e_b, de_b, 0.0_wp), q, point)
      call store_lane(point, l, at)
   end subroutine deviate_lane

end module evl_contact_lanes
