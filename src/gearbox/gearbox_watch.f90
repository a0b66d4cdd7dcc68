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
   use evl_tooth_contact, only: contact_mode, flank_drive, flanks_apart, flanks_loaded, flanks_off, locate_contact, touches, &
                                unclipped_force
   use evl_touching_flanks, only: contact_pressure
   implicit none (type, external)
   private

   public :: channel_of, n_channels, watched_at

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
   subroutine watched_at(gearbox, y, integers, reals, values, status, roots)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states), reals(:)
      integer, intent(in) :: integers(:)
      real(wp), intent(out) :: values(:) !! [n_channels]
      type(status_t), intent(inout) :: status
      real(wp), intent(out), optional :: roots(gearbox%n_roots) !! as of `gearbox_roots`
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
            if (is_watched) call watch_contact(gearbox, c, mode, rho_a0, q, point, unclipped, c == leader, values)
         end do
      end do
      if (present(roots)) roots(gearbox%n_roots) = turns_root(y(i_theta))
   end subroutine watched_at

   !> What a tooth contact adds to the channels.
   pure subroutine watch_contact(gearbox, c, mode, rho_a0, q, point, unclipped, leads, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: c
      type(contact_mode), intent(in) :: mode
      real(wp), intent(in) :: rho_a0, q(n_local)
      type(contact_point), intent(in) :: point
      real(wp), intent(in) :: unclipped !! elastic + viscous force [N]
      logical, intent(in) :: leads      !! whether it speaks for its mesh
      real(wp), intent(inout) :: values(:)
      type(contact_point) :: far
      real(wp) :: factor, d_v
      integer :: before

      before = channel_of(gearbox%contacts(c)%mesh, 0)
      associate (contact => gearbox%contacts(c))
         if (leads) then
            values(before + watch_error) = transmission_error(contact%pair, contact%axles_rest, q)
            values(before + watch_sliding) = point%v_t
            if (mode%flanks == flanks_apart .or. mode%flanks == flanks_off) then ! no pair's point is known
               if (mode%flanks == flanks_apart) call track_closed_form(contact%pair, rho_a0, q, far)
               if (mode%flanks == flanks_off) call locate_contact(contact, mode, rho_a0, q, far)
               values(before + watch_sliding) = far%v_t
            end if
         end if
         if (contact%flank == flank_drive .and. touches(mode)) &
            call raise(point%h, values(before + watch_penetration))
         if (mode%flanks /= flanks_loaded) return
         call raise(unclipped, values(before + watch_pair_normal))
         call raise(contact_pressure(contact, mode, unclipped, point), values(before + watch_pair_pressure))
         values(before + watch_normal) = values(before + watch_normal) + unclipped
         if (contact%flank /= flank_drive .or. contact%friction%is_none()) return
         call contact%friction%factor(mode%friction, point%v_t, factor, d_v)
         values(before + watch_friction) = values(before + watch_friction) - unclipped*factor
      end associate
   end subroutine watch_contact

   !> The larger of two; what is no number, as the pressure of flanks too hollow to touch in one place, raises nothing.
   elemental subroutine raise(value, largest)
      real(wp), intent(in) :: value
      real(wp), intent(inout) :: largest

      if (value > largest) largest = value
   end subroutine raise

end module evl_gearbox_watch
