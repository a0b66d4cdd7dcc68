!> Outputs of the flash temperature of the tooth pairs of a mesh at eight states. Only gearboxes with thermal data have them.
!>
!> An edge contact has no flash temperature: the heat source stays on the edge, where Blok's source that moves over both surfaces is
!> no model.
module evl_temperature_outputs
   use evl_contact_friction, only: rolling_speed_a, rolling_speed_b
   use evl_flash_temperature, only: flash_temperature, hertz_half_width, mesh_thermal_t
   use evl_force_lanes, only: lane_slot
   use evl_kinds, only: lanes, nan, wp
   use evl_output, only: dims_mesh_pair, in_temperatures, needs_temperatures
   use evl_output_registry, only: add_output, begin_section, needs, registry_t
   use evl_tooth_contact, only: beyond_flank, flanks_loaded, tooth_contact_t
   implicit none (type, external)
   private

   public :: add_temperature_outputs, add_temperatures, find_flash

contains

   !> Rows of a tooth pair.
   subroutine add_temperature_outputs(registry, pair_slot, flash, contact)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: pair_slot !! index of the slot, counted over all meshes
      real(wp), intent(in), dimension(lanes) :: flash, contact !! [K]

      call begin_section(registry, in_temperatures, dims_mesh_pair, pair_slot)
      call needs(registry, needs_temperatures)
      call add_output(registry, "pair_flash_temperature", "K", "theta_fl", &
                      "flash temperature, rise above the bulk temperature; NaN on tip edges and at standstill", flash)
      call add_output(registry, "pair_contact_temperature", "K", "theta_c", &
                      "contact temperature: bulk plus flash temperature, absolute; NaN where that is", contact)
   end subroutine add_temperature_outputs

   !> Add the temperatures of a tooth pair. Equation FT4.
   subroutine add_temperatures(registry, pair_slot, thermal, flash)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: pair_slot !! as in `add_temperature_outputs`
      type(mesh_thermal_t), intent(in) :: thermal
      real(wp), intent(in) :: flash(lanes) !! [K]

      call add_temperature_outputs(registry, pair_slot, flash, thermal%bulk_temperature + flash)
   end subroutine add_temperatures

   !> Flash temperature of a tooth pair [K]; 0 without force. Equation FT3.
   pure subroutine find_flash(thermal, contact, slot, n, pressure, flash)
      type(mesh_thermal_t), intent(in) :: thermal
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(in) :: slot
      integer, intent(in) :: n                !! number of states in use
      real(wp), intent(in) :: pressure(lanes) !! its contact pressure [Pa]
      real(wp), intent(out) :: flash(lanes)
      real(wp) :: line_load
      integer :: l

      flash = 0
      if (slot%mode%flanks /= flanks_loaded) return
      do l = 1, n
         line_load = slot%force%unclipped(l)/contact%width
         if (.not. line_load > 0) cycle
         flash(l) = nan
         if (beyond_flank(slot%mode)) cycle
         associate (at => slot%at)
            flash(l) = flash_temperature(thermal, abs(slot%force%factor(l)*at%v_t(l))*line_load, &
                                         rolling_speed_a(contact%pair%sigma, at%omega_a(l), at%l_a(l)), &
                                         rolling_speed_b(contact%pair%sigma, at%omega_b(l), at%l_b(l)), &
                                         hertz_half_width(line_load, pressure(l)))
         end associate
      end do
   end subroutine find_flash

end module evl_temperature_outputs
