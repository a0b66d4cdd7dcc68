!> Outputs of the root stress of the wheels: extremes over the teeth of a wheel under the loads of all its meshes and both flanks.
!> Only gearboxes to which they are added have them.
module evl_root_outputs
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: lanes, nan, wp
   use evl_output, only: dims_wheel, in_roots, needs_roots
   use evl_output_registry, only: add_output, begin_section, needs, registry_t
   use evl_output_states, only: output_states
   use evl_pair_point, only: by_a, by_b
   use evl_tooth_contact, only: beyond_flank, flanks_loaded, tooth_of_a, tooth_of_b
   use evl_tooth_root, only: loaded_flank, root_extremes, root_extremes_t, root_load_t
   implicit none (type, external)
   private

   public :: add_root_outputs, add_root_stresses, find_loads

contains

   !> Rows of a wheel.
   subroutine add_root_outputs(registry, index, largest, least)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      real(wp), intent(in), dimension(lanes) :: largest, least !! [Pa]

      call begin_section(registry, in_roots, dims_wheel, index)
      call needs(registry, needs_roots)
      call add_output(registry, "root_stress_max", "Pa", "sigma_F", &
                      "largest root stress of all teeth; NaN without finite elements", largest)
      call add_output(registry, "root_stress_min", "Pa", "sigma_F-", &
                      "least root stress of all teeth; NaN without finite elements", least)
   end subroutine add_root_outputs

   !> Add the root stress of all wheels, one state after the other. Equation RS3.
   subroutine add_root_stresses(registry, gearbox, states)
      type(registry_t), intent(inout) :: registry
      type(gearbox_t), intent(in) :: gearbox
      type(output_states), intent(in) :: states
      real(wp), dimension(lanes) :: largest, least
      type(root_load_t) :: loads(size(gearbox%contacts))
      type(root_extremes_t) :: extremes
      integer :: i, l, n

      do i = 1, size(gearbox%wheels)
         largest = nan
         least = nan
         do l = 1, merge(states%n, 0, gearbox%root_stresses(i)%exists)
            call find_loads(gearbox, states%slots, i, l, loads, n)
            call root_extremes(gearbox%root_stresses(i), loads(:n), extremes)
            largest(l) = extremes%largest
            least(l) = extremes%least
         end do
         call add_root_outputs(registry, i, largest, least)
      end do
   end subroutine add_root_stresses

   !> Loads of all tooth pairs of a wheel.
   pure subroutine find_loads(gearbox, slots, wheel, l, loads, n)
      type(gearbox_t), intent(in) :: gearbox
      type(lane_slot), intent(in) :: slots(:)
      integer, intent(in) :: wheel, l !! l: lane
      type(root_load_t), intent(inout) :: loads(:)
      integer, intent(out) :: n
      real(wp) :: rho(2)
      integer :: c

      n = 0
      do c = 1, size(slots)
         associate (contact => gearbox%contacts(c), slot => slots(c))
            if (contact%wheel_a /= wheel .and. contact%wheel_b /= wheel) cycle
            if (slot%mode%flanks /= flanks_loaded) cycle
            if (.not. slot%force%unclipped(l) > 0) cycle
            rho = [slot%at%rho_a(l), slot%at%rho_b(l)]
            if (beyond_flank(slot%mode)) rho = slot%at%edge%foot(l, :)
            n = n + 1
            loads(n)%flank = loaded_flank(contact)
            loads(n)%line_load = slot%force%unclipped(l)/contact%width
            if (contact%wheel_a == wheel) then
               loads(n)%tooth = tooth_of_a(contact, slot%mode%tooth_pair)
               loads(n)%rho = rho(by_a)
            else
               loads(n)%tooth = tooth_of_b(contact, slot%mode%tooth_pair)
               loads(n)%rho = rho(by_b)
            end if
         end associate
      end do
   end subroutine find_loads

end module evl_root_outputs
