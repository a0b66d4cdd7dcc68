!> Outputs of individual tooth pairs of a mesh at eight states. Every mesh has the same slots for them: those of the drive flank,
!> then those of the coast flank. In a slot without a tooth pair on the path the force is 0 and the point is NaN.
module evl_pair_outputs
   use evl_contact_curvature, only: contact_pressure
   use evl_contact_lanes, only: lane_contact
   use evl_contact_point, only: contact_point
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: lanes, nan, wp
   use evl_output, only: dims_mesh_pair, in_pairs, needs_pairs, needs_positions, needs_pressures
   use evl_output_registry, only: add_output, begin_section, needs, registry_t
   use evl_output_states, only: output_states
   use evl_temperature_outputs, only: add_temperatures, find_flash
   use evl_tooth_contact, only: beyond_flank, contact_mode, edge_wheel, flank_coast, flanks_loaded, flanks_off, no_mode, &
                                tooth_contact_t, tooth_of_a, tooth_of_b
   implicit none (type, external)
   private

   public :: add_pair_outputs, add_pairs, pair_lanes

   !> A tooth pair; by default off the path.
   type :: pair_lanes
      type(contact_mode) :: mode = no_mode
      integer :: tooth_a = 0, tooth_b = 0                !! tooth indices, from 0
      real(wp) :: normal(lanes) = 0.0_wp, friction(lanes) = 0.0_wp !! [N]
      real(wp) :: pressure(lanes) = 0.0_wp               !! [Pa]
      real(wp) :: rho_a(lanes) = nan, h(lanes) = nan, v_t(lanes) = nan !! as in `lane_contact`
   end type pair_lanes

contains

   include "contact/lanes/lane_point.inc"

   !> Rows of a tooth pair.
   subroutine add_pair_outputs(registry, pair_slot, pair)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: pair_slot !! index of the slot, counted over all meshes
      type(pair_lanes), intent(in) :: pair

      call begin_section(registry, in_pairs, dims_mesh_pair, pair_slot)
      call needs(registry, needs_pairs)
      call add_output(registry, "pair_normal_force", "N", "F_nk", "normal force of a tooth pair", pair%normal)
      call add_output(registry, "pair_friction_force", "N", "F_tk", &
                      "friction force of a tooth pair on the driving wheel along t", pair%friction)
      call needs(registry, ior(needs_pairs, needs_positions))
      call add_output(registry, "pair_position", "m", "rho_Ak", &
                      "radius of curvature of the driving flank at the contact; NaN off the path", pair%rho_a)
      call needs(registry, needs_pressures)
      call add_output(registry, "pair_contact_pressure", "Pa", "p_k", &
                      "largest contact pressure; NaN on a concave flank without one, and on a sharp tip edge", &
                      pair%pressure)
      call needs(registry, needs_pairs)
      call add_output(registry, "pair_on_path", "1", "", &
                      "1 if the tooth pair is on the path of contact, or within reach of its edges", pair%mode%flanks /= flanks_off)
      call add_output(registry, "pair_number", "1", "k", "the tooth pair: pitches since the start", pair%mode%tooth_pair)
      call add_output(registry, "pair_tooth_driving", "1", "", "its tooth of the driving wheel, from 0, counterclockwise", &
                      pair%tooth_a)
      call add_output(registry, "pair_tooth_driven", "1", "", "its tooth of the driven wheel, from 0, counterclockwise", &
                      pair%tooth_b)
      call add_output(registry, "pair_contact_mode", "1", "", &
                      "0 open, 1 loaded, 2 overlapping without force, 3 too far apart to track, 4 off the path", pair%mode%flanks)
      call add_output(registry, "pair_contact_kind", "1", "", &
                      "0 flank on flank, or possible; 1 tip edge of the driving wheel; 2 tip edge of the driven wheel", &
                      edge_wheel(pair%mode))
      call needs(registry, ior(needs_pairs, needs_positions))
      call add_output(registry, "pair_penetration", "m", "h_k", &
                      "penetration of the flanks, negative for a gap; NaN off the path", pair%h)
      call add_output(registry, "pair_sliding_velocity", "m s-1", "v_tk", &
                      "sliding velocity of a tooth pair along t; NaN off the path", pair%v_t, &
                      no_rate="difference of the velocities of two flanks: no output has its integral")
   end subroutine add_pair_outputs

   !> Add all tooth pairs of a mesh.
   subroutine add_pairs(registry, gearbox, mesh, states, has_pressure, has_temperature)
      type(registry_t), intent(inout) :: registry
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(output_states), intent(in) :: states
      logical, intent(in) :: has_pressure !! contact pressures are requested; they are expensive
      logical, intent(in) :: has_temperature !! flash temperatures are requested, and so are the pressures
      type(pair_lanes) :: pair
      real(wp) :: flash(lanes)
      integer :: before, c, pair_slot

      before = (mesh - 1)*gearbox%n_pair_slots
      if (gearbox%first(mesh + 1) - gearbox%first(mesh) < gearbox%n_pair_slots) then
         pair%mode%flanks = flanks_off
         flash = 0
         do pair_slot = before + 1, before + gearbox%n_pair_slots
            call add_pair_outputs(registry, pair_slot, pair)
            if (has_temperature) call add_temperatures(registry, pair_slot, gearbox%thermal(mesh), flash)
         end do
      end if
      do c = gearbox%first(mesh), gearbox%first(mesh + 1) - 1
         associate (contact => gearbox%contacts(c))
            call find_pair(gearbox, contact, states%slots(c), states%aside(c), pair)
            if (has_pressure) call find_pressure(contact, states%slots(c), states%n, pair)
            pair_slot = before + 1 + contact%slot + merge(gearbox%n_drive_slots, 0, contact%flank == flank_coast)
            call add_pair_outputs(registry, pair_slot, pair)
            if (.not. has_temperature) cycle
            call find_flash(gearbox%thermal(mesh), contact, states%slots(c), states%n, pair%pressure, flash)
            call add_temperatures(registry, pair_slot, gearbox%thermal(mesh), flash)
         end associate
      end do
   end subroutine add_pairs

   !> Data of a tooth contact; off the path without point and force.
   pure subroutine find_pair(gearbox, contact, slot, aside, pair)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(in) :: slot, aside
      type(pair_lanes), intent(out) :: pair

      pair%mode = slot%mode
      pair%tooth_a = modulo(tooth_of_a(contact, slot%mode%tooth_pair), gearbox%wheels(contact%wheel_a)%teeth)
      pair%tooth_b = modulo(tooth_of_b(contact, slot%mode%tooth_pair), gearbox%wheels(contact%wheel_b)%teeth)
      if (slot%touches) then
         call take_position(slot%at, pair)
      else if (slot%mode%flanks /= flanks_off) then
         call take_position(aside%at, pair)
      end if
      if (slot%mode%flanks /= flanks_loaded) return
      pair%normal = slot%force%unclipped
      pair%friction = -slot%force%unclipped*slot%force%factor
   end subroutine find_pair

   !> Copy its position.
   pure subroutine take_position(at, pair)
      type(lane_contact), intent(in) :: at
      type(pair_lanes), intent(inout) :: pair

      pair%rho_a = at%rho_a
      pair%h = at%h
      pair%v_t = at%v_t
   end subroutine take_position

   !> Contact pressure of a loaded pair, one state after the other.
   pure subroutine find_pressure(contact, slot, n, pair)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(in) :: slot
      integer, intent(in) :: n !! number of states in use
      type(pair_lanes), intent(inout) :: pair
      type(contact_point) :: point
      real(wp) :: foot(2)
      integer :: l

      if (slot%mode%flanks /= flanks_loaded) return
      do l = 1, n
         call take_lane(slot%at, l, point)
         foot = [point%rho_a, point%rho_b]
         if (beyond_flank(slot%mode)) foot = slot%at%edge%foot(l, :)
         pair%pressure(l) = contact_pressure(contact, slot%mode, slot%force%unclipped(l), point, foot)
      end do
   end subroutine find_pressure

end module evl_pair_outputs
