!> A tooth contact and its forces in eight states at once; as for one state, the flank computes the forces.
!>
!> The loop over the lanes is in the file of each law; a law without such a loop is evaluated state by state.
module evl_force_lanes
   use evl_contact_friction, only: rolling_sum
   use evl_contact_lanes, only: lane_contact, store_lane
   use evl_contact_context, only: lane_context
   use evl_contact_point, only: contact_point, is_internal, rho_of_ring
   use evl_elastic_law, only: elastic_result
   use evl_friction_law, only: by_curvature, by_load, by_rolling, by_sliding, sliding_t
   use evl_kinds, only: lanes, wp
   use evl_pair_point, only: by_a, by_b, by_line
   use evl_root_kinds, only: n_root_kinds, side_of_rate
   use evl_tooth_contact, only: beyond_flank, contact_force, contact_mode, contact_state, flanks_off, flanks_unloaded, &
                                tooth_contact_t, unclipped
   implicit none (type, external)
   private

   public :: lane_force, lane_slot, ring_context, laws_of_pair, lift_in_lanes, put_force, put_position, resolve_in_lanes

   !> Forces of a tooth contact in eight states; components have the same meaning as in `elastic_result` and `contact_force`.
   type :: lane_force
      real(wp), dimension(lanes) :: elastic, viscous, d_energy, excess
      real(wp), dimension(lanes) :: slope_a, slope_b !! as in `pair_compliant_data`; of compliant flanks only
      real(wp), dimension(lanes) :: unclipped !! elastic + viscous [N]
      real(wp), dimension(lanes) :: factor    !! phi of the friction law, if there is a force
      real(wp), dimension(lanes) :: torque_a, torque_b, on_a_t, on_a_e, dissipation
   end type lane_force

   !> A tooth contact in eight states, the counterpart of `contact_state`: scratch of the caller. Between evaluations it retains the
   !> data of the last one.
   type :: lane_slot
      type(contact_mode) :: mode
      logical :: touches = .false.            !! according to the mode
      integer :: directions(n_root_kinds) = 0 !! of its root functions
      real(wp) :: rho_start = 0               !! nominal radius of curvature on A at theta = 0 [m]
      type(lane_contact) :: at                !! position, if it touches
      type(lane_force) :: force               !! forces
      real(wp) :: rho_seen = 0                !! rho_A of the last curvature computed for deviating flanks; 0: none yet [m]
      real(wp) :: curvature_seen = 0          !! that curvature [1/m]
   end type lane_slot

contains

   include "numerics/all_positive.inc"
   include "contact/lanes/lane_point.inc"
   include "contact/contact_forces.inc"

   !> Forces of a single pair by its own laws, for overlapping flanks.
   subroutine laws_of_pair(contact, at, force, is_defined)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(inout) :: force
      logical, intent(out) :: is_defined !! false if the laws or the involutes are not defined in one of the lanes

      if (is_internal(contact%pair)) then
         call elastic_lanes_of_ring(contact, at, force, is_defined)
         if (.not. is_defined) return
      else
         is_defined = all_positive(at%rho_a) .and. all_positive(at%rho_b)
         if (.not. is_defined) return
         call contact%elastic%force_lanes(at%lane_context, force%elastic, force%d_energy, force%excess, is_defined)
      end if
      call contact%damping%force_lanes(at%lane_context, force%elastic, force%viscous)
      force%unclipped = force%elastic + force%viscous
   end subroutine laws_of_pair

   !> Elastic force of an internal pair.
   subroutine elastic_lanes_of_ring(contact, at, force, is_defined)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(inout) :: force
      logical, intent(out) :: is_defined !! as in `laws_of_pair`

      is_defined = all_positive(contact%side(by_a)*at%rho_a) .and. all_positive(contact%side(by_b)*at%rho_b)
      if (.not. is_defined) return
      call contact%elastic%force_lanes(ring_context(at), force%elastic, force%d_energy, force%excess, is_defined)
      force%d_energy = -force%d_energy
   end subroutine elastic_lanes_of_ring

   !> Quantities of an internal pair that are available to the laws, as `context_of` for one state.
   pure type(lane_context) function ring_context(at) result(context)
      type(lane_contact), intent(in) :: at

      context = at%lane_context
      context%rho_a = rho_of_ring(at%rho_a, at%h)
      context%rho_b = rho_of_ring(at%rho_b, at%h)
   end function ring_context

   !> Forces on the wheels and power loss, from the elastic and viscous forces.
   subroutine resolve_in_lanes(contact, mode, at, force)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(inout) :: force
      real(wp) :: sigma
      type(sliding_t) :: rubs
      integer :: l

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
      rubs%x(:, by_sliding) = at%v_t
      if (contact%friction%is_local()) then
         rubs%x(:, by_rolling) = rolling_sum(sigma, at%omega_a, at%omega_b, at%l_a, at%l_b)
         rubs%x(:, by_load) = force%unclipped/contact%width
         rubs%x(:, by_curvature) = 1/at%rho_a + 1/at%rho_b
         rubs%e_star = contact%e_star
      end if
      call contact%friction%factor_lanes(mode%friction, rubs, force%factor)
      !$omp simd
      do l = 1, lanes
         call resolve_lane(sigma, at, l, force)
      end do
   end subroutine resolve_in_lanes

   !> Add the component of edge forces against e that exceeds the normal force, in eight states.
   pure subroutine lift_in_lanes(at, force)
      type(lane_contact), intent(in) :: at
      type(lane_force), intent(inout) :: force
      real(wp) :: lift
      integer :: l

      !$omp simd private(lift)
      do l = 1, lanes
         lift = -(1 + at%edge%d_h(l, by_line))
         force%on_a_t(l) = force%on_a_t(l) + force%unclipped(l)*lift*at%s(l)
         force%on_a_e(l) = force%on_a_e(l) - force%unclipped(l)*lift*at%c(l)
      end do
   end subroutine lift_in_lanes

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

      elastic%force = force%elastic(l)
      elastic%d_energy = force%d_energy(l)
      elastic%excess = force%excess(l)
   end function elastic_of_lane

   !> Store the position of a contact that was computed for one state in a lane.
   pure subroutine put_position(contact, at_state, l, slot)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at_state
      integer, intent(in) :: l
      type(lane_slot), intent(inout) :: slot

      associate (at => slot%at)
         at%e_star = contact%e_star
         at%width = contact%width
         at%v0 = at_state%mode%v0
         at%side = at_state%mode%sides(side_of_rate)
         at%rho_a0(l) = at_state%rho_a0
         at%overlap(l) = at_state%overlap
         call store_lane(at_state%point, l, at)
         if (slot%mode%flanks /= flanks_off .and. beyond_flank(slot%mode)) at%edge%foot(l, :) = at_state%edge%foot
      end associate
   end subroutine put_position

   !> Store its forces in the same lane.
   pure subroutine put_force(at_state, l, slot)
      type(contact_state), intent(in) :: at_state
      integer, intent(in) :: l
      type(lane_slot), intent(inout) :: slot

      associate (to => slot%force, force => at_state%force)
         to%elastic(l) = at_state%elastic%force
         to%d_energy(l) = at_state%elastic%d_energy
         to%excess(l) = at_state%elastic%excess
         to%viscous(l) = at_state%viscous%force
         to%unclipped(l) = unclipped(at_state)
         to%factor(l) = at_state%factor
         to%torque_a(l) = force%torque_a
         to%torque_b(l) = force%torque_b
         to%on_a_t(l) = force%on_a(1)
         to%on_a_e(l) = force%on_a(2)
         to%dissipation(l) = force%dissipation
      end associate
   end subroutine put_force

end module evl_force_lanes
