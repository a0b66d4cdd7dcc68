!> The forces of a tooth contact for eight states at once.
!>
!> The loop of a law stands in the law's own file; a law without one is asked state by state.
module evl_force_lanes
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_contact_lanes, only: lane_contact
   use evl_contact_point, only: contact_point
   use evl_elastic_law, only: elastic_result
   use evl_kinds, only: lanes, wp
   use evl_tooth_contact, only: contact_force, contact_mode, flanks_unloaded, tooth_contact_t
   implicit none (type, external)
   private

   public :: lane_force, forces_in_lanes, laws_in_lanes

   !> Forces of a tooth contact in eight states; the components mean what those of `contact_force` mean.
   type :: lane_force
      real(wp), dimension(lanes) :: elastic, viscous, d_energy, excess, factor
      real(wp), dimension(lanes) :: torque_a, torque_b, on_a_t, on_a_e, dissipation
   end type lane_force

contains

   include "numerics/all_positive.inc"
   include "contact/lane_point.inc"
   include "contact/contact_forces.inc"

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

      call laws_in_lanes(contact, margin, at, force, answered)
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
      call contact%friction%factor_lanes(mode%friction, at%v_t, force%factor)
      !$omp simd
      do l = 1, lanes
         call resolve_lane(sigma, at, l, force)
      end do
   end subroutine forces_in_lanes

   !> Elastic and viscous force.
   subroutine laws_in_lanes(contact, margin, at, force, answered)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: margin(lanes) !! of the line of action
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(inout) :: force
      logical, intent(out) :: answered

      answered = all_positive(margin) .and. all_positive(at%rho_a) .and. all_positive(at%rho_b)
      if (.not. answered) return
      call contact%elastic%force_lanes(at%lane_context, force%elastic, force%d_energy, force%excess, answered)
      call contact%damping%force_lanes(at%lane_context, force%elastic, force%viscous)
   end subroutine laws_in_lanes

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
