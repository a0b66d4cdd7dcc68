!> The forces of a tooth contact for eight states at once.
!>
!> The formulas are included as in evl_contact_lanes. Which law acts is decided outside the loops. A law without a loop here is not
!> among those of `laws_have_lanes`, and its gearboxes are asked state by state.
module evl_force_lanes
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_contact_lanes, only: lane_contact
   use evl_contact_laws, only: contact_johnson, contact_linear, contact_power, contact_radzimovsky, contact_yang_lin, &
                               damping_flores, damping_gonthier, damping_hunt_crossley, damping_lankarani_nikravesh, &
                               damping_lee_wang, damping_linear, damping_none, damping_one_sided, elastic_result, &
                               friction_coulomb, friction_none, friction_stribeck, friction_tanh, impact_share, linear_stiffness
   use evl_contact_point, only: contact_point
   use evl_damping, only: damping_share
   use evl_johnson, only: exp_minus_2, smallest_ratio
   use evl_kinds, only: lanes, pi, wp
   use evl_mesh_damping, only: is_impact_damping
   use evl_radzimovsky, only: enlarged
   use evl_status, only: code_ok, code_out_of_domain
   use evl_tooth_contact, only: contact_force, contact_mode, flanks_unloaded, tooth_contact_t
   implicit none (type, external)
   private

   public :: lane_force, forces_in_lanes, laws_have_lanes, laws_in_lanes

   !> Forces of a tooth contact in eight states; the components mean what those of `contact_force` mean.
   type :: lane_force
      real(wp), dimension(lanes) :: elastic, viscous, d_energy, excess, factor
      real(wp), dimension(lanes) :: torque_a, torque_b, on_a_t, on_a_e, dissipation
   end type lane_force

contains

   include "numerics/all_positive.inc"
   include "contact/lane_point.inc"
   include "numerics/logarithm.inc"
   include "laws/johnson.inc"
   include "laws/radzimovsky.inc"
   include "numerics/exponential.inc"
   include "numerics/power.inc"
   include "laws/springs.inc"
   include "laws/spread_over_width.inc"
   include "laws/damping.inc"
   include "laws/friction.inc"
   include "contact/contact_forces.inc"

   !> Whether each law of a contact has its loop below.
   pure logical function laws_have_lanes(contact)
      type(tooth_contact_t), intent(in) :: contact

      laws_have_lanes = contact%elastic%law >= contact_johnson .and. contact%elastic%law <= contact_power &
                        .and. (any(contact%damping%law == [damping_none, damping_linear, damping_one_sided]) &
                               .or. is_impact_damping(contact%damping)) &
                        .and. contact%friction%law >= friction_none .and. contact%friction%law <= friction_stribeck
   end function laws_have_lanes

   !> Forces of flanks that overlap.
   subroutine forces_in_lanes(contact, mode, margin, at, force, answered)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      real(wp), intent(in) :: margin(lanes) !! of the line of action
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(out) :: force
      logical, intent(out) :: answered !! false if the laws or the involutes have no answer in one of the lanes
      real(wp) :: sigma
      integer :: l

      call laws_in_lanes(contact, mode, margin, at, force, answered)
      if (.not. answered) return
      sigma = contact%pair%sigma
      if (mode%flanks == flanks_unloaded) then
         force%torque_a = 0
         force%torque_b = 0
         force%on_a_t = 0
         force%on_a_e = 0
         do l = 1, lanes
            call lose_lane(at, l, force)
         end do
         return
      end if
      call friction_in_lanes(contact, mode, at, force)
      !$omp simd
      do l = 1, lanes
         call resolve_lane(sigma, at, l, force)
      end do
   end subroutine forces_in_lanes

   !> Elastic and viscous force.
   subroutine laws_in_lanes(contact, mode, margin, at, force, answered)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      real(wp), intent(in) :: margin(lanes) !! of the line of action
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(inout) :: force
      logical, intent(out) :: answered

      answered = all_positive(margin) .and. all_positive(at%rho_a) .and. all_positive(at%rho_b)
      if (.not. answered) return
      call elastic_in_lanes(contact, at, force, answered)
      call viscous_in_lanes(contact, mode, at, force)
   end subroutine laws_in_lanes

   !> Elastic force.
   subroutine elastic_in_lanes(contact, at, force, answered)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(inout) :: force
      logical, intent(out) :: answered
      real(wp) :: answers(lanes)
      real(wp) :: e_star, width, exponent, stiffness
      integer :: l

      answers = 1
      e_star = contact%e_star
      width = contact%width
      select case (contact%elastic%law)
      case (contact_johnson)
         !$omp simd
         do l = 1, lanes
            call johnson_lane(at%h(l), at%rho_a(l) + at%rho_b(l), e_star, width, force%elastic(l), &
                              force%d_energy(l), force%excess(l), answers(l))
         end do
      case (contact_radzimovsky)
         !$omp simd
         do l = 1, lanes
            call radzimovsky_lane(at%h(l), at%rho_a(l) + at%rho_b(l), e_star, width, force%elastic(l), &
                                  force%d_energy(l), force%excess(l), answers(l))
         end do
      case (contact_linear, contact_yang_lin)
         stiffness = linear_stiffness(contact%elastic, e_star, width)
         force%d_energy = 0
         force%excess = 0
         !$omp simd
         do l = 1, lanes
            force%elastic(l) = linear_spring_lane(at%h(l), stiffness)
         end do
      case (contact_power)
         stiffness = contact%elastic%parameters(1)
         exponent = contact%elastic%parameters(2)
         force%d_energy = 0
         force%excess = 0
         !$omp simd
         do l = 1, lanes
            force%elastic(l) = power_spring_lane(at%h(l), stiffness, exponent)
         end do
      end select
      answered = all_positive(answers)
   end subroutine elastic_in_lanes

   !> Johnson's force in one lane.
   elemental subroutine johnson_lane(h, rho_sum, e_star, width, force, d_energy, excess, answer)
      real(wp), intent(in) :: h, rho_sum, e_star, width
      real(wp), intent(out) :: force, d_energy, excess
      real(wp), intent(out) :: answer !! 1, or 0 outside the law's domain: integers are shorter, and vectors would be too
      type(elastic_result) :: elastic
      integer :: code

      call johnson_force(h, rho_sum, e_star, elastic%force, elastic%d_h, elastic%d_rho, code)
      call spread_over_width(width, e_star, h, rho_sum, elastic)
      force = elastic%force
      d_energy = elastic%d_energy
      excess = elastic%excess
      answer = merge(1.0_wp, 0.0_wp, code == code_ok)
   end subroutine johnson_lane

   !> Radzimovsky's force in one lane.
   elemental subroutine radzimovsky_lane(h, rho_sum, e_star, width, force, d_energy, excess, answer)
      real(wp), intent(in) :: h, rho_sum, e_star, width
      real(wp), intent(out) :: force, d_energy, excess
      real(wp), intent(out) :: answer !! 1, or 0 outside the law's domain: integers are shorter, and vectors would be too
      type(elastic_result) :: elastic
      integer :: code

      call radzimovsky_force(h, rho_sum, e_star, elastic%force, elastic%d_h, elastic%d_rho, code)
      call spread_over_width(width, e_star, h, rho_sum, elastic)
      force = elastic%force
      d_energy = elastic%d_energy
      excess = elastic%excess
      answer = merge(1.0_wp, 0.0_wp, code == code_ok)
   end subroutine radzimovsky_lane

   !> The force of a linear spring in one lane.
   elemental real(wp) function linear_spring_lane(h, stiffness) result(force)
      real(wp), intent(in) :: h, stiffness
      real(wp) :: d_h, potential

      call linear_spring(h, stiffness, force, d_h, potential)
   end function linear_spring_lane

   !> The force of a power spring in one lane.
   elemental real(wp) function power_spring_lane(h, coefficient, exponent) result(force)
      real(wp), intent(in) :: h, coefficient, exponent
      real(wp) :: d_h, potential

      call power_spring(h, coefficient, exponent, force, d_h, potential)
   end function power_spring_lane

   !> Viscous force.
   subroutine viscous_in_lanes(contact, mode, at, force)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(inout) :: force
      real(wp) :: coefficient, share, d_h, d_h_dot
      integer :: l

      select case (contact%damping%law)
      case (damping_none)
         force%viscous = 0
      case (damping_linear)
         coefficient = contact%damping%parameters(1)
         !$omp simd private(d_h_dot)
         do l = 1, lanes
            call linear_damping(at%h_dot(l), coefficient, force%viscous(l), d_h_dot)
         end do
      case (damping_one_sided)
         coefficient = contact%damping%parameters(1)
         share = damping_share(mode%side, 0.0_wp)
         !$omp simd private(d_h, d_h_dot)
         do l = 1, lanes
            call one_sided_damping(at%h(l), at%h_dot(l), coefficient, share, force%viscous(l), d_h, d_h_dot)
         end do
      case (damping_hunt_crossley, damping_lankarani_nikravesh, damping_flores, damping_gonthier, damping_lee_wang)
         coefficient = impact_share(contact%damping, mode%v0)
         force%viscous = impact_damping(coefficient, force%elastic, at%h_dot)
      end select
   end subroutine viscous_in_lanes

   !> The friction law's factor of the normal force.
   subroutine friction_in_lanes(contact, mode, at, force)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(inout) :: force
      real(wp), dimension(size(contact%friction%parameters)) :: p
      real(wp) :: d_v
      integer :: branch, l

      p = contact%friction%parameters
      select case (contact%friction%law)
      case (friction_none)
         force%factor = 0
      case (friction_coulomb)
         branch = mode%friction
         !$omp simd private(d_v)
         do l = 1, lanes
            call coulomb_factor(branch, at%v_t(l), p(1), p(2), force%factor(l), d_v)
         end do
      case (friction_tanh)
         !$omp simd private(d_v)
         do l = 1, lanes
            call tanh_factor(at%v_t(l), p(1), p(2), force%factor(l), d_v)
         end do
      case (friction_stribeck)
         !$omp simd private(d_v)
         do l = 1, lanes
            call stribeck_factor(at%v_t(l), p(1), p(2), p(3), p(4), force%factor(l), d_v)
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
      type(contact_force) :: resolved

      call take_lane(at, l, point)
      call resolve_forces(sigma, point, elastic_of_lane(l, force), force%viscous(l), force%factor(l), resolved)
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
      force%dissipation(l) = unloaded_loss(point, elastic_of_lane(l, force))
   end subroutine lose_lane

   !> One lane of the elastic force.
   pure type(elastic_result) function elastic_of_lane(l, force) result(elastic)
      integer, intent(in) :: l
      type(lane_force), intent(in) :: force

      elastic = elastic_result(force=force%elastic(l), d_energy=force%d_energy(l), excess=force%excess(l))
   end function elastic_of_lane

end module evl_force_lanes
