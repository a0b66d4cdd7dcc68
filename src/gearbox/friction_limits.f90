!> Check of the arguments of local friction laws at a state: a law holds them at its limits.
module evl_friction_limits
   use evl_contact_friction, only: sliding_of
   use evl_contacts_at_state, only: look_at
   use evl_friction_law, only: sliding_t
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_local_friction, only: local_friction_t
   use evl_status, only: code_out_of_domain, fail, has_failed, message_length, status_t, subject_mesh
   use evl_tooth_contact, only: contact_state, flanks_loaded, unclipped
   implicit none (type, external)
   private

   public :: check_friction_limits, has_local_friction

contains

   !> Whether a mesh has a local friction law.
   pure logical function has_local_friction(gearbox) result(has)
      type(gearbox_t), intent(in) :: gearbox
      integer :: m

      has = .false.
      do m = 1, size(gearbox%pairs)
         has = has .or. gearbox%contacts(gearbox%first(m))%friction%is_local()
      end do
   end function has_local_friction

   !> Check all loaded tooth pairs.
   !> Errors: code_out_of_domain with the first argument that is held.
   subroutine check_friction_limits(gearbox, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      type(status_t), intent(inout) :: status
      type(contact_state) :: at(size(gearbox%contacts))
      type(sliding_t) :: sliding
      type(status_t) :: undefined
      character(len=message_length) :: message
      real(wp) :: normal
      integer :: i, m

      do i = 1, size(gearbox%flanks)
         associate (first => gearbox%flanks(i)%flank%first, last => gearbox%flanks(i)%flank%last)
            call look_at(gearbox, first, last, y, integers, reals, at, undefined)
            if (has_failed(undefined)) return
            do m = first, last
               if (at(m)%mode%flanks /= flanks_loaded) cycle
               normal = unclipped(at(m))
               if (.not. normal > 0) cycle
               select type (law => gearbox%contacts(m)%friction)
               class is (local_friction_t)
                  call sliding_of(gearbox%contacts(m), at(m)%point, normal, sliding)
                  call law%held(sliding, "of a tooth pair", message)
                  if (message /= "") then
                     call fail(status, code_out_of_domain, trim(message), subject_mesh, gearbox%contacts(m)%mesh, "friction.law")
                     return
                  end if
               end select
            end do
         end associate
      end do
   end subroutine check_friction_limits

end module evl_friction_limits
