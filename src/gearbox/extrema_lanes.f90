!> Watched outputs of a gearbox for eight states at once; `monitored_at` is the version for one state. They use the contact data of
!> the last rates in lanes at low cost, and are therefore approximate.
module evl_extrema_lanes
   use evl_contact_curvature, only: contact_curvature, edge_curvature
   use evl_contact_lanes, only: contact_in_lanes, lane_contact
   use evl_contact_point, only: contact_point, tracked_pair
   use evl_discrete_state, only: leading_contact
   use evl_extrema_monitor, only: channel_of, monitor_error, monitor_friction, monitor_normal, monitor_pair_normal, &
                                  monitor_pair_pressure, monitor_penetration, monitor_sliding, n_channels
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: lanes, pi, wp
   use evl_line_lanes, only: centre_turn_in_lanes, lane_line, line_in_lanes, motion_in_lanes
   use evl_pair_point, only: by_a, by_b
   use evl_radau_coefficients, only: n_stages
   use evl_tooth_contact, only: contact_mode, edge_wheel, flank_drive, flanks_loaded, flanks_off, flanks_open, tooth_contact_t, &
                                touches
   implicit none (type, external)
   private

   public :: most_rows, rough_channels, monitored_in_lanes

contains

   include "laws/hertz_pressure.inc"
   include "contact/lanes/lane_point.inc"
   include "contact/transmission_error.inc"

   !> Largest number of rows.
   pure integer function most_rows(gearbox) result(n)
      type(gearbox_t), intent(in) :: gearbox

      n = 4*size(gearbox%pairs) + 3*size(gearbox%contacts)
   end function most_rows

   !> Channels whose rows are estimates: the curvature of deviating flanks is not computed at all states.
   pure function rough_channels(gearbox) result(is_rough)
      type(gearbox_t), intent(in) :: gearbox
      logical, allocatable :: is_rough(:)
      integer :: c

      allocate (is_rough(n_channels(gearbox)), source=.false.)
      do c = 1, size(gearbox%contacts)
         if (gearbox%contacts(c)%deviates) is_rough(channel_of(gearbox%contacts(c)%mesh, monitor_pair_pressure)) = .true.
      end do
   end function rough_channels

   !> Rows of channels that are not 0 in the present discrete state, except those represented by others; each pair has its own rows,
   !> smooth between events.
   subroutine monitored_in_lanes(gearbox, y, integers, slots, n, channels, values)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      !> [tooth contacts] from the last rates; curvatures are stored there
      type(lane_slot), intent(inout) :: slots(size(gearbox%contacts))
      integer, intent(out) :: n
      integer, intent(inout) :: channels(:)      !! the first n: channel of each row
      real(wp), intent(inout) :: values(lanes, *) !! values of these rows
      real(wp), dimension(lanes) :: normal, friction
      integer :: c, leader, loaded, m

      n = 0
      do m = 1, size(gearbox%pairs)
         normal = 0
         friction = 0
         loaded = 0
         do c = gearbox%first(m), gearbox%first(m + 1) - 1
            if (.not. slots(c)%touches) cycle
            if (slots(c)%mode%flanks == flanks_loaded) loaded = loaded + 1
            call monitor_pair(gearbox, c, slots(c), n, channels, values, normal, friction)
         end do
         ! the force of a single pair exceeds that of its mesh only where it exceeds that of all pairs
         if (loaded > 1) call put(channel_of(m, monitor_normal), normal, n, channels, values)
         if (loaded > 0 .and. .not. gearbox%contacts(gearbox%first(m))%friction%is_none()) &
            call put(channel_of(m, monitor_friction), friction, n, channels, values)
         leader = leading_contact(gearbox, m, integers)
         call monitor_mesh(gearbox, m, y, slots(leader), gearbox%contacts(leader), n, channels, values)
      end do
   end subroutine monitored_in_lanes

   !> Add a row.
   pure subroutine put(channel, of_lanes, n, channels, values)
      integer, intent(in) :: channel
      real(wp), intent(in) :: of_lanes(lanes)
      integer, intent(inout) :: n
      integer, intent(inout) :: channels(:)
      real(wp), intent(inout) :: values(lanes, *)

      n = n + 1
      channels(n) = channel
      values(:, n) = of_lanes
   end subroutine put

   !> Rows of a touching contact, and its contribution to its mesh.
   subroutine monitor_pair(gearbox, c, slot, n, channels, values, normal, friction)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: c
      type(lane_slot), intent(inout) :: slot
      integer, intent(inout) :: n
      integer, intent(inout) :: channels(:)
      real(wp), intent(inout) :: values(lanes, *)
      real(wp), dimension(lanes), intent(inout) :: normal, friction
      real(wp) :: pressure(lanes), curvature(lanes), e_star, width
      integer :: l

      associate (contact => gearbox%contacts(c))
         if (contact%flank == flank_drive) call put(channel_of(contact%mesh, monitor_penetration), slot%at%h, n, channels, values)
         if (slot%mode%flanks /= flanks_loaded) return
         call put(channel_of(contact%mesh, monitor_pair_normal), slot%force%unclipped, n, channels, values)
         width = contact%width
         e_star = contact%e_star
         call curvature_in_lanes(contact, slot, curvature)
         !$omp simd
         do l = 1, lanes
            normal(l) = normal(l) + slot%force%unclipped(l)
            pressure(l) = hertz_pressure(max(slot%force%unclipped(l), 0.0_wp), width, e_star, curvature(l))
         end do
         call put(channel_of(contact%mesh, monitor_pair_pressure), pressure, n, channels, values)
         if (contact%flank == flank_drive) friction = friction - slot%force%unclipped*slot%force%factor
      end associate
   end subroutine monitor_pair

   !> Sum of the curvatures of both flanks; for deviating flanks an estimate slightly above it. The exact value is expensive. It is
   !> computed at the end of each step, which is the start of the next, with linear interpolation between. Possible extremes are
   !> evaluated exactly elsewhere.
   pure subroutine curvature_in_lanes(contact, slot, curvature)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(inout) :: slot
      real(wp), intent(out) :: curvature(lanes)
      real(wp), parameter :: margin = 2.0e-3_wp
      real(wp), parameter :: same = 1.0e-6_wp !! relative to rho: the curvature at such a distance is the same, well within margin
      type(contact_point) :: point
      real(wp) :: from, to, travel
      integer :: l, wheel

      associate (rho_a => slot%at%rho_a, rho_b => slot%at%rho_b)
         curvature = (rho_a + rho_b)/(rho_a*rho_b)
         if (.not. contact%deviates) return
         wheel = edge_wheel(slot%mode)
         if (wheel > 0) then
            slot%rho_seen = 0 ! no curvature of a flank is stored
            if (.not. contact%tips(wheel)%edge%rounding > 0) return
            do l = 1, lanes
               curvature(l) = edge_curvature(contact%tips(wheel)%edge%rounding, slot%at%edge%foot(l, by_a + by_b - wheel))
            end do
            return
         end if
         from = slot%curvature_seen
         if (abs(slot%rho_seen - rho_a(lanes)) > same*abs(rho_a(lanes))) then
            call take_lane(slot%at, lanes, point)
            from = contact_curvature(contact, slot%mode, point, [point%rho_a, point%rho_b])
         end if
         call take_lane(slot%at, n_stages, point)
         to = contact_curvature(contact, slot%mode, point, [point%rho_a, point%rho_b])
         slot%rho_seen = rho_a(n_stages)
         slot%curvature_seen = to
         travel = rho_a(n_stages) - rho_a(lanes)
         if (.not. (abs(travel) > 0 .and. from > 0 .and. to > 0)) return
         curvature = (1 + margin)*(from + (to - from)*((rho_a - rho_a(lanes))/travel))
      end associate
   end subroutine curvature_in_lanes

   !> Rows of a mesh that exist whether it touches or not.
   subroutine monitor_mesh(gearbox, m, y, slot, leader, n, channels, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      type(lane_slot), intent(in) :: slot      !! of the leading contact
      type(tooth_contact_t), intent(in) :: leader
      integer, intent(inout) :: n
      integer, intent(inout) :: channels(:)
      real(wp), intent(inout) :: values(lanes, *)
      type(lane_line) :: line
      type(lane_contact) :: at
      type(tracked_pair) :: pair
      type(contact_mode) :: mode
      real(wp), dimension(lanes) :: lag, turn

      pair = leader%pair
      if (slot%touches) then
         call put(channel_of(m, monitor_sliding), slot%at%v_t, n, channels, values)
         call motion_in_lanes(leader, y, line)
      else
         call line_in_lanes(leader, y, line)
         mode = slot%mode
         if (mode%flanks == flanks_off) mode%flanks = flanks_open ! otherwise only the radii would be computed
         call contact_in_lanes(leader, mode, slot%rho_start, line, at)
         call put(channel_of(m, monitor_sliding), at%v_t, n, channels, values)
      end if
      call centre_turn_in_lanes(leader, line, turn)
      lag = error_of_turns(pair, line%psi_a, line%psi_b, turn)
      call put(channel_of(m, monitor_error), lag, n, channels, values)
   end subroutine monitor_mesh

end module evl_extrema_lanes
