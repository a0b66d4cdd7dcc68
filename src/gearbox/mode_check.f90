!> Whether the modes of all tooth contacts agree with a state: forces push, pairs in contact overlap, every pair is where its modes
!> say that it is.
!>
!> Between events this holds if no event was missed. A root function that comes back before the end of a step may pass unseen; a
!> state in that step then shows it.
module evl_mode_check
   use evl_contact_events, only: roots_of_contact
   use evl_contact_point, only: contact_point
   use evl_contact_roots, only: contact_roots_of_force, most_contact_roots, root_apart, root_back, root_contact, root_force, &
                                root_forward, root_friction_high, root_friction_low, root_side
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_kinds, only: wp
   use evl_local_variables, only: i_theta
   use evl_settle_modes, only: mark_passed
   use evl_status, only: code_out_of_domain, fail, has_failed, message_length, quantity, status_t, subject_mesh
   use evl_tooth_contact, only: contact_mode, contact_state, flanks_apart, flanks_loaded, flanks_off, flanks_open, nominal_rho, &
                                tooth_contact_t, unclipped_force
   implicit none (type, external)
   private

   public :: check_known_contacts, check_modes

   !> How far past its zero a root function may be, in its own units: forces over the reference force, penetrations over the
   !> reference penetration, sliding over the knee of friction, places in pitches. It is far above how exactly events are located.
   real(wp), parameter :: slack = 1.0e-6_wp

contains

   !> Refuse a state that contradicts its modes.
   subroutine check_modes(gearbox, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      type(status_t), intent(inout) :: status !! code_out_of_domain: an event was missed; a smaller step may find it
      integer :: m

      do m = 1, size(gearbox%contacts)
         call check_contact(gearbox, m, y, integers, reals, status)
         if (has_failed(status)) return
      end do
   end subroutine check_modes

   !> The same of a state at which the contacts are known: that costs little.
   subroutine check_known_contacts(gearbox, y, integers, reals, contacts, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      type(contact_state), intent(in) :: contacts(:) !! all of them, with their points and forces
      type(status_t), intent(inout) :: status        !! as of `check_modes`
      real(wp) :: roots(most_contact_roots), rho_a0
      integer :: m

      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m), at => contacts(m))
            if (at%mode%flanks == flanks_apart) then ! its point is not that of its tracking
               call check_contact(gearbox, m, y, integers, reals, status)
            else
               rho_a0 = 0
               if (contact%handover) rho_a0 = nominal_rho(contact, y(i_theta), integers(i_turns), at%mode%tooth_pair)
               call contact_roots_of_force(contact, at%mode, rho_a0, at%q, at%point, &
                                           at%force%elastic + at%force%viscous, roots)
               call judge(contact, at%mode, at%point, roots, status)
            end if
         end associate
         if (has_failed(status)) return
      end do
   end subroutine check_known_contacts

   !> Refuse a state that contradicts the modes of one tooth contact.
   subroutine check_contact(gearbox, m, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      type(status_t), intent(inout) :: status
      type(contact_point) :: point
      type(contact_mode) :: mode
      real(wp) :: roots(most_contact_roots)

      call roots_of_contact(gearbox, m, y, integers, reals, mode, point, roots, status)
      if (.not. has_failed(status)) call judge(gearbox%contacts(m), mode, point, roots, status)
   end subroutine check_contact

   !> Refuse root functions past the zeros that would have ended the modes.
   subroutine judge(contact, mode, point, roots, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      real(wp), intent(in) :: roots(contact%n_roots)
      type(status_t), intent(inout) :: status
      character(len=message_length) :: message
      logical :: passed(most_contact_roots)

      passed = .false.
      call mark_passed(contact, mode, roots, slack, passed)
      if (.not. any(passed)) return
      call describe(contact, mode, point, findloc(passed, .true., dim=1), message, status)
      if (.not. has_failed(status)) call fail(status, code_out_of_domain, message, subject_mesh, contact%mesh, "contact")
   end subroutine judge

   !> What a root function past its zero means.
   subroutine describe(contact, mode, point, root, message, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      integer, intent(in) :: root
      character(len=message_length), intent(out) :: message
      type(status_t), intent(inout) :: status
      character(len=12) :: pair
      real(wp) :: force

      write (pair, "(i0)") mode%tooth_pair
      message = "tooth pair "//trim(pair)
      select case (root)
      case (root_contact)
         if (mode%flanks == flanks_open) then
            message = trim(message)//" overlaps by "//quantity(point%h, "m")//" but counts as open"
         else
            message = trim(message)//" is in contact, but its flanks are "//quantity(-point%h, "m")//" apart"
         end if
      case (root_force)
         call unclipped_force(contact, mode, point, force, status)
         if (mode%flanks == flanks_loaded) then
            message = trim(message)//" pulls with "//quantity(-force, "N")
         else
            message = trim(message)//" ought to push with "//quantity(force, "N")//" but counts as unloaded"
         end if
      case (root_friction_high, root_friction_low)
         message = trim(message)//" slides at "//quantity(point%v_t, "m/s")//", which its branch of friction does not hold for"
      case (root_side)
         message = trim(message)//" moves at "//quantity(point%h_dot, "m/s")//", on the wrong side of its damping law"
      case (root_forward, root_back)
         message = trim(message)//trim(merge(" is on the path but counts as off it     ", &
                                             " is past an end of the path of contact   ", mode%flanks == flanks_off))
      case (root_apart)
         message = trim(message)//trim(merge(" is near but its points are not tracked  ", &
                                             " is too far apart to track its points    ", mode%flanks == flanks_apart))
      case default
         message = trim(message)//" is past the border of a relief"
      end select
      message = trim(message)//": an event was missed; take a smaller max_step or tolerance"
   end subroutine describe

end module evl_mode_check
