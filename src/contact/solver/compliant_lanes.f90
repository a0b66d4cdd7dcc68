!> Effect of compliant flanks on the wheels in eight states at once; evl_compliant_flank is the version for one state.
module evl_compliant_lanes
   use evl_contact_point, only: tracked_pair
   use evl_force_lanes, only: lane_slot
   use evl_kinds, only: lanes, pi, wp
   use evl_pair_point, only: by_a, by_b, by_line
   use evl_tooth_contact, only: beyond_flank, tooth_contact_t
   implicit none (type, external)
   private

   public :: feet_in_lanes, line_in_lanes, push_sides_in_lanes

contains

   include "contact/solver/compliant_forces.inc"

   !> Roll lengths at which A and B are loaded in eight states [m].
   pure subroutine feet_in_lanes(slot, foot)
      type(lane_slot), intent(in) :: slot
      real(wp), intent(out) :: foot(lanes, 2)

      if (beyond_flank(slot%mode)) then
         foot = slot%at%edge%foot
      else
         foot(:, by_a) = slot%at%rho_a
         foot(:, by_b) = slot%at%rho_b
      end if
   end subroutine feet_in_lanes

   !> Length of the line of action in eight states [m].
   pure subroutine line_in_lanes(slot, line)
      type(lane_slot), intent(in) :: slot
      real(wp), intent(out) :: line(lanes)

      if (beyond_flank(slot%mode)) then
         line = slot%at%edge%line
      else
         line = slot%at%l_a + slot%at%l_b
      end if
   end subroutine line_in_lanes

   !> Add the effect of a_i and P on the wheels.
   pure subroutine push_sides_in_lanes(contact, slot)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(inout) :: slot !! of a touching pair, with its forces
      real(wp), dimension(lanes) :: a_a, a_b, along, line
      type(tracked_pair) :: pair
      real(wp) :: per_line
      integer :: l

      pair = contact%pair
      per_line = 2*pi*contact%e_star*contact%width
      associate (at => slot%at, force => slot%force)
         call line_in_lanes(slot, line)
         a_a = force%elastic*force%slope_a
         a_b = force%elastic*force%slope_b
         along = 0
         if (beyond_flank(slot%mode)) call feel_at_feet(at%edge%d_foot, a_a, a_b, along)
         !$omp simd
         do l = 1, lanes
            along(l) = along(l) + push_along(force%elastic(l), per_line, line(l))
            call push_sides(pair, line(l), at%s(l), at%c(l), a_a(l), a_b(l), along(l), force%torque_a(l), force%torque_b(l), &
                            force%on_a_t(l), force%on_a_e(l))
         end do
      end associate
   end subroutine push_sides_in_lanes

   !> Convert forces against the loaded positions of two wheels to forces against rho_A, rho_B and rho.
   pure subroutine feel_at_feet(d_foot, a_a, a_b, along)
      real(wp), intent(in) :: d_foot(lanes, 3, 2)
      real(wp), intent(inout), dimension(lanes) :: a_a, a_b !! in: against the positions; out: against rho_A, rho_B [N]
      real(wp), intent(out) :: along(lanes)
      real(wp) :: on_a, on_b
      integer :: l

      !$omp simd private(on_a, on_b)
      do l = 1, lanes
         on_a = a_a(l)
         on_b = a_b(l)
         a_a(l) = d_foot(l, by_a, by_a)*on_a + d_foot(l, by_a, by_b)*on_b
         a_b(l) = d_foot(l, by_b, by_a)*on_a + d_foot(l, by_b, by_b)*on_b
         along(l) = d_foot(l, by_line, by_a)*on_a + d_foot(l, by_line, by_b)*on_b
      end do
   end subroutine feel_at_feet

end module evl_compliant_lanes
