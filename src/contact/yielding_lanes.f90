!> What flanks that yield do to the wheels in eight states at once, as evl_yielding_flank has it in one.
module evl_yielding_lanes
   use evl_contact_lanes, only: lane_contact
   use evl_contact_point, only: tracked_pair
   use evl_force_lanes, only: lane_force, lane_slot
   use evl_kinds, only: lanes, pi, wp
   use evl_pair_place, only: by_a, by_b, by_line
   use evl_tooth_contact, only: beyond_flank, tooth_contact_t
   implicit none (type, external)
   private

   public :: feet_in_lanes, push_sides_in_lanes

contains

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

   !> Add what P and a_i do to the wheels.
   pure subroutine push_sides_in_lanes(contact, slot)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(inout) :: slot !! of a pair that touches, with its forces
      real(wp) :: a(lanes, 3), lever(lanes), line(lanes), p(lanes), per_line, on_a, on_b
      integer :: i, l

      associate (at => slot%at, force => slot%force)
         line = at%rho_a + at%rho_b - at%h
         lever = at%l_a + at%l_b
         per_line = 2*pi*contact%e_star*contact%width
         !$omp simd
         do l = 1, lanes
            p(l) = force%elastic(l)**2/(per_line*line(l))
         end do
         if (beyond_flank(slot%mode)) then
            lever = at%edge%line
            do i = by_a, by_line
               !$omp simd private(on_a, on_b)
               do l = 1, lanes
                  on_a = at%edge%d_foot(l, i, by_a)*(force%elastic(l)*force%slope_a(l))
                  on_b = at%edge%d_foot(l, i, by_b)*(force%elastic(l)*force%slope_b(l))
                  a(l, i) = on_a + on_b
               end do
            end do
         else
            a(:, by_a) = force%elastic*force%slope_a
            a(:, by_b) = force%elastic*force%slope_b
         end if
         a(:, by_a) = a(:, by_a) + p
         a(:, by_b) = a(:, by_b) + p
         call add_sides(contact%pair, at, p, a(:, by_a), a(:, by_b), lever, force)
         if (beyond_flank(slot%mode)) call lift_in_lanes(contact%pair, at, p, a(:, by_line), force)
      end associate
   end subroutine push_sides_in_lanes

   !> The parts of it on every flank.
   pure subroutine add_sides(pair, at, p, a_a, a_b, lever, force)
      type(tracked_pair), intent(in) :: pair
      type(lane_contact), intent(in) :: at
      real(wp), intent(in), dimension(lanes) :: p, a_a, a_b, lever
      type(lane_force), intent(inout) :: force
      real(wp) :: r_ba, r_bb, sigma, tangential
      integer :: l

      r_ba = pair%r_ba
      r_bb = pair%r_bb
      sigma = pair%sigma
      !$omp simd private(tangential)
      do l = 1, lanes
         force%torque_a(l) = force%torque_a(l) + sigma*(p(l)*at%arm_a(l) - r_ba*a_a(l))
         force%torque_b(l) = force%torque_b(l) + sigma*(p(l)*at%arm_b(l) - r_bb*a_b(l))
         tangential = p(l)*at%tilt(l) - (r_ba*a_a(l) + r_bb*a_b(l))/lever(l)
         force%on_a_t(l) = force%on_a_t(l) + p(l)*at%s(l) + tangential*at%c(l)
         force%on_a_e(l) = force%on_a_e(l) - p(l)*at%c(l) + tangential*at%s(l)
      end do
   end subroutine add_sides

   !> `lift_by_edge` in eight states.
   pure subroutine lift_in_lanes(pair, at, p, a_line, force)
      type(tracked_pair), intent(in) :: pair
      type(lane_contact), intent(in) :: at
      real(wp), intent(in), dimension(lanes) :: p, a_line
      type(lane_force), intent(inout) :: force
      real(wp) :: against, along, r_b
      integer :: l

      r_b = pair%r_b
      !$omp simd private(against, along)
      do l = 1, lanes
         against = -p(l)*(1 + at%edge%d_h(l, by_line)) + a_line(l)
         along = r_b/at%edge%line(l)*a_line(l)
         force%on_a_t(l) = force%on_a_t(l) + against*at%s(l) - along*at%c(l)
         force%on_a_e(l) = force%on_a_e(l) - against*at%c(l) - along*at%s(l)
      end do
   end subroutine lift_in_lanes

end module evl_yielding_lanes
