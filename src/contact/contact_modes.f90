!> The mode that belongs to a contact point: where a gearbox starts, and where a tooth pair comes onto the path.
!>
!> Between such points modes live on: they end where their root functions pass zero, which lies a little past the border.
module evl_contact_modes
   use evl_contact_point, only: contact_point
   use evl_contact_roots, only: find_sides
   use evl_kinds, only: wp
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: contact_mode, flanks_apart, flanks_loaded, flanks_open, flanks_unloaded, settle_friction, &
                                settle_zones, tooth_contact_t, tracking_closed_form, unclipped_force
   implicit none (type, external)
   private

   public :: mode_at, take_load

contains

   !> The mode of a tooth pair on the path. Flanks that do not overlap are open; whether they are about to touch, and whether rigid
   !> ones do, is said by more than the point.
   subroutine mode_at(contact, point, mode, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_point), intent(in) :: point  !! by the closed form where tracked points are not known
      type(contact_mode), intent(inout) :: mode !! with its tooth pair; where no load is taken friction and v0 stay
      type(status_t), intent(inout) :: status   !! code_out_of_domain if a law has no answer
      real(wp) :: force

      mode%flanks = flanks_open
      call settle_zones(contact, point, mode)
      call find_sides(contact, point, 0.0_wp, mode)
      if (contact%tracking /= tracking_closed_form .and. point%h < -contact%gap_apart) then
         mode%flanks = flanks_apart
      else if (point%h > 0 .and. .not. contact%rigid) then
         mode%flanks = flanks_loaded
         mode%v0 = max(point%h_dot, 0.0_wp)
         call unclipped_force(contact, mode, point, force, status)
         if (has_failed(status)) return
         call find_sides(contact, point, force, mode)
         if (force < 0) mode%flanks = flanks_unloaded
         if (mode%flanks == flanks_loaded) call take_load(contact, point, mode)
      end if
   end subroutine mode_at

   !> What a mode has that is loaded from now on: its branch of friction, and the approach speed.
   pure subroutine take_load(contact, point, mode)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_point), intent(in) :: point
      type(contact_mode), intent(inout) :: mode

      mode%friction = settle_friction(contact, point)
      mode%v0 = max(point%h_dot, 0.0_wp)
   end subroutine take_load

end module evl_contact_modes
