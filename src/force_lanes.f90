!> The forces of a tooth contact for eight states at once.
!>
!> The formulas are included as in evl_contact_lanes. Which law acts is decided outside the loops; laws without a loop of their own
!> are asked lane by lane.
module evl_force_lanes
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_contact_lanes, only: lane_contact
   use evl_contact_laws, only: contact_johnson, contact_radzimovsky, damping_hunt_crossley, damping_lee_wang, damping_linear, &
                               damping_none, elastic_force, elastic_result, friction_coulomb, friction_factor, friction_none, &
                               impact_share, viscous_force, viscous_result
   use evl_contact_point, only: contact_point
   use evl_johnson, only: exp_minus_2, smallest_ratio
   use evl_kinds, only: pi, wp
   use evl_mesh, only: contact_t, contact_unloaded, context_of, mesh_force, mesh_mode
   use evl_ode_model, only: lanes
   use evl_radzimovsky, only: enlarged
   use evl_status, only: code_ok, code_out_of_domain
   implicit none (type, external)
   private

   public :: lane_force, forces_in_lanes, laws_in_lanes

   !> Forces of a tooth contact in eight states; the components mean what those of `mesh_force` mean.
   type :: lane_force
      real(wp), dimension(lanes) :: elastic, viscous, d_energy, factor
      real(wp), dimension(lanes) :: torque_a, torque_b, on_a_t, on_a_e, dissipation
   end type lane_force

contains

   include "formulas/lane_point.inc"
   include "formulas/logarithm.inc"
   include "formulas/johnson.inc"
   include "formulas/radzimovsky.inc"
   include "formulas/spread_over_width.inc"
   include "formulas/damping.inc"
   include "formulas/coulomb.inc"
   include "formulas/contact_forces.inc"

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

end module evl_force_lanes
