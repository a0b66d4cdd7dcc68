!> Tooth pairs one by one in eight states at once, as evl_pair_outputs has them in one.
module evl_pair_lanes
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_contact_lanes, only: lane_contact
   use evl_contact_point, only: contact_point
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: lanes, wp
   use evl_lane_columns, only: none, of_pair_friction, of_pair_kind, of_pair_mode, of_pair_normal, of_pair_number, &
                               of_pair_on_path, of_pair_penetration, of_pair_position, of_pair_pressure, of_pair_sliding, &
                               of_pair_tooth_a, of_pair_tooth_b, put, put_same, put_whole
   use evl_tooth_contact, only: beyond_flank, contact_mode, edge_wheel, flank_coast, flanks_loaded, flanks_off, no_mode, &
                                tooth_contact_t, tooth_of_a, tooth_of_b
   use evl_touching_flanks, only: contact_pressure
   implicit none (type, external)
   private

   public :: tell_pairs

   real(wp), parameter :: nan = transfer(int(z"7FF8000000000000", int64), 1.0_wp)

contains

   include "contact/lane_point.inc"

   !> The places of a mesh's tooth pairs.
   subroutine tell_pairs(gearbox, n, m, columns, slots, aside, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: n !! the first n states count
      integer, intent(in) :: m, columns(:)
      type(lane_slot), intent(in) :: slots(*), aside(*)
      real(wp), intent(inout) :: values(lanes, *)
      type(contact_mode) :: nothing
      integer :: before, c, place, tooth_a, tooth_b

      before = (m - 1)*gearbox%n_pair_places
      nothing = no_mode
      nothing%flanks = flanks_off
      if (gearbox%first(m + 1) - gearbox%first(m) < gearbox%n_pair_places) then
         do place = before + 1, before + gearbox%n_pair_places
            call tell_mode(columns, place, nothing, 0, 0, values)
            call tell_no_point(columns, place, values)
         end do
      end if
      do c = gearbox%first(m), gearbox%first(m + 1) - 1
         associate (contact => gearbox%contacts(c), mode => slots(c)%mode)
            place = before + 1 + contact%slot + merge(gearbox%n_drive_places, 0, contact%flank == flank_coast)
            tooth_a = modulo(tooth_of_a(contact, mode%tooth_pair), gearbox%wheels(contact%wheel_a)%teeth)
            tooth_b = modulo(tooth_of_b(contact, mode%tooth_pair), gearbox%wheels(contact%wheel_b)%teeth)
            call tell_mode(columns, place, mode, tooth_a, tooth_b, values)
            call tell_no_point(columns, place, values)
            if (slots(c)%touches) then
               call tell_point(columns, place, slots(c)%at, values)
            else if (mode%flanks /= flanks_off) then
               call tell_point(columns, place, aside(c)%at, values)
            end if
            if (mode%flanks /= flanks_loaded) cycle
            associate (force => slots(c)%force)
               call put(columns(of_pair_normal), place, force%unclipped, values)
               call put(columns(of_pair_friction), place, -force%unclipped*force%factor, values)
            end associate
          if (columns(of_pair_pressure) /= none) call tell_pressure(contact, slots(c), n, columns(of_pair_pressure) + place, values)
         end associate
      end do
   end subroutine tell_pairs

   !> The whole numbers of a place.
   pure subroutine tell_mode(columns, place, mode, tooth_a, tooth_b, values)
      integer, intent(in) :: columns(:), place
      type(contact_mode), intent(in) :: mode
      integer, intent(in) :: tooth_a, tooth_b
      real(wp), intent(inout) :: values(lanes, *)

      call put_whole(columns(of_pair_on_path), place, merge(1, 0, mode%flanks /= flanks_off), values)
      call put_whole(columns(of_pair_number), place, mode%tooth_pair, values)
      call put_whole(columns(of_pair_tooth_a), place, tooth_a, values)
      call put_whole(columns(of_pair_tooth_b), place, tooth_b, values)
      call put_whole(columns(of_pair_mode), place, mode%flanks, values)
      call put_whole(columns(of_pair_kind), place, edge_wheel(mode), values)
   end subroutine tell_mode

   !> Contact pressure of a pair under load.
   pure subroutine tell_pressure(contact, slot, n, to, values)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(in) :: slot
      integer, intent(in) :: n, to
      real(wp), intent(inout) :: values(lanes, *)
      type(contact_point) :: point
      real(wp) :: foot(2)
      integer :: l

      do l = 1, n
         call take_lane(slot%at, l, point)
         foot = [point%rho_a, point%rho_b]
         if (beyond_flank(slot%mode)) foot = slot%at%edge%foot(l, :)
         values(l, to) = contact_pressure(contact, slot%mode, slot%force%unclipped(l), point, foot)
      end do
   end subroutine tell_pressure

   !> Where no tooth pair is on the path: no force, and no point.
   pure subroutine tell_no_point(columns, place, values)
      integer, intent(in) :: columns(:), place
      real(wp), intent(inout) :: values(lanes, *)

      call put_same(columns(of_pair_normal), place, 0.0_wp, values)
      call put_same(columns(of_pair_friction), place, 0.0_wp, values)
      call put_same(columns(of_pair_pressure), place, 0.0_wp, values)
      call put_same(columns(of_pair_position), place, nan, values)
      call put_same(columns(of_pair_penetration), place, nan, values)
      call put_same(columns(of_pair_sliding), place, nan, values)
   end subroutine tell_no_point

   !> Where one is.
   pure subroutine tell_point(columns, place, at, values)
      integer, intent(in) :: columns(:), place
      type(lane_contact), intent(in) :: at
      real(wp), intent(inout) :: values(lanes, *)

      call put(columns(of_pair_position), place, at%rho_a, values)
      call put(columns(of_pair_penetration), place, at%h, values)
      call put(columns(of_pair_sliding), place, at%v_t, values)
   end subroutine tell_point

end module evl_pair_lanes
