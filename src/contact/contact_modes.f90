!> Initial mode of a contact point: at the start of a gearbox, and when a tooth pair enters the path of contact.
!>
!> Modes then persist until one of their root functions crosses zero. That zero lies slightly beyond the border.
module evl_contact_modes
   use evl_contact_roots, only: find_sides
   use evl_flank, only: flank_t
   use evl_kinds, only: wp
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: contact_state, flanks_apart, flanks_loaded, flanks_open, flanks_unloaded, line_length, &
                                settle_friction, &
                                settle_zones, tooth_contact_t, tracking_closed_form, unclipped
   implicit none (type, external)
   private

   public :: mode_at, take_load

contains

   !> Mode of a tooth pair on the path. Flanks that do not overlap are open; whether they are about to touch, or whether rigid ones
   !> touch, does not follow from the point alone.
   subroutine mode_at(flank, contacts, k, first, last, at, status)
      class(flank_t), intent(in) :: flank
      type(tooth_contact_t), intent(in) :: contacts(*)
      integer, intent(in) :: first, last          !! contacts that determine the force, as from `loaded_pairs_range`
      integer, intent(in) :: k                    !! index of the contact; friction and v0 stay unchanged if it takes no load
      type(contact_state), intent(inout) :: at(*) !! with their points, by the closed form where no tracked points exist
      type(status_t), intent(inout) :: status     !! code_out_of_domain if a law is not defined

      associate (contact => contacts(k), mode => at(k)%mode, point => at(k)%point)
         mode%flanks = flanks_open
         call settle_zones(contact, line_length(contact, at(k)%q), point, mode)
         call flank%settle_overlap(contacts, k, first, last, at)
         call find_sides(flank, contact, at(k))
         if (contact%tracking /= tracking_closed_form .and. point%h < -contact%gap_apart) then
            mode%flanks = flanks_apart
         else if (at(k)%overlap > 0 .and. .not. contact%rigid) then
            mode%flanks = flanks_loaded
            mode%v0 = max(point%h_dot, 0.0_wp)
            call flank%laws(contacts, first, last, at, status)
            if (has_failed(status)) return
            call find_sides(flank, contact, at(k))
            if (unclipped(at(k)) < 0) mode%flanks = flanks_unloaded
            if (mode%flanks == flanks_loaded) call take_load(contact, at(k))
         end if
      end associate
   end subroutine mode_at

   !> Set the friction branch and the approach speed of a mode that becomes loaded.
   pure subroutine take_load(contact, at)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(inout) :: at

      at%mode%friction = settle_friction(contact, at%point)
      at%mode%v0 = max(at%point%h_dot, 0.0_wp)
   end subroutine take_load

end module evl_contact_modes
