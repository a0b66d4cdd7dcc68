!> The watched outputs of a gearbox at a state, without all that its other outputs need.
!>
!> They come in channels: each watched output of each mesh is one. That of an output of tooth pairs is the largest of the pairs:
!> where one pair takes over from another it has a kink, but such a kink is no maximum.
module evl_gearbox_watch
   use evl_closed_form, only: track_closed_form, transmission_error
   use evl_contact_events, only: point_of_contact
   use evl_contact_point, only: contact_point
   use evl_contact_roots, only: contact_roots
   use evl_discrete_state, only: gearbox_mode, leading_contact
   use evl_extremes, only: n_watched_outputs, watch_error, watch_friction, watch_normal, watch_pair_normal, watch_pair_pressure, &
                           watch_penetration, watch_sliding
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_events, only: turns_root
   use evl_kinds, only: wp
   use evl_local_variables, only: i_theta, n_local
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: contact_mode, flank_drive, flanks_apart, flanks_loaded, flanks_off, locate_contact, &
                                tooth_contact_t, touches, unclipped_force
   use evl_touching_flanks, only: contact_pressure, pressure_at, touching_curvature
   implicit none (type, external)
   private

   public :: channel_of, n_channels, n_kept, watched_at

   integer, parameter :: n_kept = 3 !! reals that are kept of each tooth contact

contains

   !> How many channels there are.
   pure integer function n_channels(gearbox) result(n)
      type(gearbox_t), intent(in) :: gearbox

      n = n_watched_outputs*size(gearbox%pairs)
   end function n_channels

   !> The channel of an output of a mesh.
   pure integer function channel_of(mesh, watched) result(channel)
      integer, intent(in) :: mesh, watched

      channel = n_watched_outputs*(mesh - 1) + watched
   end function channel_of

   !> All channels at a state, what only flanks that touch have is 0 without; and, since they know most of it, its root functions.
   !> Then the pressure of a tooth pair that is far below the largest so far may be an estimate.
   subroutine watched_at(gearbox, y, integers, reals, values, status, roots, near, highest, kept)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: values(n_channels(gearbox))
      type(status_t), intent(inout) :: status
      real(wp), intent(out), optional :: roots(gearbox%n_roots) !! as of `gearbox_roots`; with it come the others
      real(wp), intent(in), optional :: near                    !! above this part of the largest so far all is exact
      real(wp), intent(in), optional :: highest(n_channels(gearbox)) !! the largest so far
      real(wp), intent(inout), optional :: kept(n_kept, size(gearbox%contacts)) !! as of `estimate_curvature`
      type(contact_point) :: point
      type(contact_mode) :: mode
      real(wp) :: q(n_local), rho_a0, unclipped
      integer :: c, leader, m
      logical :: is_watched

      values = 0
      do m = 1, size(gearbox%pairs)
         leader = leading_contact(gearbox, m, integers)
         do c = gearbox%first(m), gearbox%first(m + 1) - 1
            mode = gearbox_mode(gearbox, c, integers, reals)
            is_watched = c == leader .or. touches(mode)
            if (.not. (is_watched .or. present(roots))) cycle
            call point_of_contact(gearbox, c, y, integers, mode, q, rho_a0, point)
            unclipped = 0
            if (present(roots)) then
               associate (first => gearbox%contacts(c)%i_root + 1, n => gearbox%contacts(c)%n_roots)
                  call contact_roots(gearbox%contacts(c), mode, rho_a0, q, point, roots(first:first + n - 1), status, unclipped)
               end associate
            else if (touches(mode)) then
               call unclipped_force(gearbox%contacts(c), mode, point, unclipped, status)
            end if
            if (has_failed(status)) return
            if (c == leader) call watch_leader(gearbox%contacts(c), mode, rho_a0, q, point, values)
            if (.not. touches(mode)) cycle
            call watch_pair(gearbox%contacts(c), mode, point, unclipped, values)
            if (mode%flanks /= flanks_loaded) cycle
            associate (contact => gearbox%contacts(c), channel => channel_of(m, watch_pair_pressure))
               if (.not. unclipped > 0) cycle
               if (present(kept) .and. contact%deviates) then
                  call raise_pressure(contact, mode, unclipped, point, near*highest(channel), kept(:, c), values(channel))
               else if (contact%deviates) then
                  call raise(contact_pressure(contact, mode, unclipped, point), values(channel))
               else
                  call raise(pressure_at(contact, unclipped, 1/point%rho_a + 1/point%rho_b), values(channel))
               end if
            end associate
         end do
      end do
      if (present(roots)) roots(gearbox%n_roots) = turns_root(y(i_theta))
   end subroutine watched_at

   !> The channels of what a mesh has whether it touches or not.
   pure subroutine watch_leader(contact, mode, rho_a0, q, point, values)
      type(tooth_contact_t), intent(in) :: contact !! the one that speaks for its mesh
      type(contact_mode), intent(in) :: mode
      real(wp), intent(in) :: rho_a0, q(n_local)
      type(contact_point), intent(in) :: point
      real(wp), intent(inout) :: values(:)
      type(contact_point) :: far

      values(channel_of(contact%mesh, watch_error)) = transmission_error(contact%pair, contact%axles_rest, q)
      associate (sliding => values(channel_of(contact%mesh, watch_sliding)))
         sliding = point%v_t
         if (mode%flanks /= flanks_apart .and. mode%flanks /= flanks_off) return
         ! no pair's point is known
         if (mode%flanks == flanks_apart) call track_closed_form(contact%pair, rho_a0, q, far)
         if (mode%flanks == flanks_off) call locate_contact(contact, mode, rho_a0, q, far)
         sliding = far%v_t
      end associate
   end subroutine watch_leader

   !> What a tooth contact that touches adds to the channels, but for its pressure.
   pure subroutine watch_pair(contact, mode, point, unclipped, values)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      real(wp), intent(in) :: unclipped !! elastic + viscous force [N]
      real(wp), intent(inout) :: values(:)
      real(wp) :: factor, d_v
      integer :: before

      before = channel_of(contact%mesh, 0)
      if (contact%flank == flank_drive) call raise(point%h, values(before + watch_penetration))
      if (mode%flanks /= flanks_loaded) return
      call raise(unclipped, values(before + watch_pair_normal))
      values(before + watch_normal) = values(before + watch_normal) + unclipped
      if (contact%flank /= flank_drive .or. contact%friction%is_none()) return
      call contact%friction%factor(mode%friction, point%v_t, factor, d_v)
      values(before + watch_friction) = values(before + watch_friction) - unclipped*factor
   end subroutine watch_pair

   !> Raise the pressure of a mesh to that of a tooth pair; one that a limit is far above is estimated.
   pure subroutine raise_pressure(contact, mode, normal, point, limit, kept, pressure)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      real(wp), intent(in) :: normal !! F_n > 0 [N]
      type(contact_point), intent(in) :: point
      real(wp), intent(in) :: limit  !! of estimates [Pa]
      real(wp), intent(inout) :: kept(n_kept)
      real(wp), intent(inout) :: pressure
      real(wp) :: estimate

      call estimate_curvature(contact, mode, point, kept, estimate)
      estimate = pressure_at(contact, normal, max(estimate, 0.0_wp))
      if (.not. estimate <= limit) estimate = contact_pressure(contact, mode, normal, point)
      call raise(estimate, pressure)
   end subroutine raise_pressure

   !> About the curvature of both flanks of a tooth pair together: along its slope from where it was found last.
   pure subroutine estimate_curvature(contact, mode, point, kept, curvature)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      real(wp), intent(inout) :: kept(n_kept) !! rho_A, curvature and slope there; zeros: nothing is known
      real(wp), intent(out) :: curvature
      real(wp), parameter :: reach = 1.0e-2_wp  !! of the radii of curvature: so far a slope holds; without one a tenth of that
      real(wp) :: way, far, slope, found

      way = point%rho_a - kept(1)
      far = reach*min(point%rho_a, point%rho_b)
      if (.not. (kept(2) > 0 .and. abs(way) <= merge(far, far/10, abs(kept(3)) > 0))) then
         found = touching_curvature(contact, mode, point)
         slope = 0
         if (kept(2) > 0 .and. abs(way) > 0 .and. abs(way) < 2*far) slope = (found - kept(2))/way
         kept = [point%rho_a, found, slope]
         way = 0
      end if
      curvature = kept(2) + kept(3)*way
   end subroutine estimate_curvature

   !> The larger of two; what is no number, as the pressure of flanks too hollow to touch in one place, raises nothing.
   elemental subroutine raise(value, largest)
      real(wp), intent(in) :: value
      real(wp), intent(inout) :: largest

      if (value > largest) largest = value
   end subroutine raise

end module evl_gearbox_watch
