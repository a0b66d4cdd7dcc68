!> Whether the modes of all tooth contacts agree with a state: forces push, pairs in contact overlap, every pair is where its modes
!> say that it is.
!>
!> Between events this holds if no event was missed. A root function that comes back before the end of a step may pass unseen; a
!> state in that step then shows it.
module evl_mode_check
   use evl_contact_events, only: roots_of_contact
   use evl_contact_point, only: contact_point
   use evl_contact_roots, only: contact_root_direction, contact_root_directions, contact_roots_of_force
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_kinds, only: wp
   use evl_local_variables, only: i_theta
   use evl_root_kinds, only: measures_force, measures_penetration, measures_rate, measures_sliding, n_root_kinds, root_rows
   use evl_status, only: code_out_of_domain, fail, has_failed, message_length, quantity, status_t, subject_mesh
   use evl_tooth_contact, only: contact_mode, contact_state, flanks_apart, nominal_rho, tooth_contact_t, unclipped_force
   implicit none (type, external)
   private

   public :: check_modes

   !> How far past its zero a root function may be, in its own units: forces over the reference force, penetrations over the
   !> reference penetration, sliding over the knee of friction, places in pitches. It is far above how exactly events are located.
   real(wp), parameter :: slack = 1.0e-6_wp

contains

   !> Refuse a state that contradicts its modes, where the contacts are known.
   subroutine check_modes(gearbox, y, integers, reals, contacts, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      type(contact_state), intent(in) :: contacts(:) !! all of them, with their points and forces
      type(status_t), intent(inout) :: status        !! code_out_of_domain: an event was missed; a smaller step may find it
      real(wp) :: roots(n_root_kinds), rho_a0
      integer :: directions(n_root_kinds), m

      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m), at => contacts(m))
            if (at%mode%flanks == flanks_apart) then ! its point is not that of its tracking
               call check_contact(gearbox, m, y, integers, reals, status)
            else
               rho_a0 = 0
               if (contact%handover) rho_a0 = nominal_rho(contact, y(i_theta), integers(i_turns), at%mode%tooth_pair)
               call contact_roots_of_force(contact, at%mode, rho_a0, at%q, at%point, &
                                           at%force%elastic + at%force%viscous, directions, roots)
               call judge(contact, at%mode, directions, at%point, roots, status)
            end if
         end associate
         if (has_failed(status)) return
      end do
   end subroutine check_modes

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
      real(wp) :: roots(n_root_kinds)
      integer :: directions(n_root_kinds)

      call roots_of_contact(gearbox, m, y, integers, reals, mode, point, roots, status)
      if (has_failed(status)) return
      call contact_root_directions(gearbox%contacts(m), mode, directions)
      call judge(gearbox%contacts(m), mode, directions, point, roots, status)
   end subroutine check_contact

   !> Refuse root functions past the zeros that would have ended the modes.
   subroutine judge(contact, mode, directions, point, roots, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      integer, intent(in) :: directions(contact%n_roots)
      type(contact_point), intent(in) :: point
      real(wp), intent(in) :: roots(contact%n_roots)
      type(status_t), intent(inout) :: status
      character(len=message_length) :: message
      integer :: i

      do i = 1, contact%n_roots
         if (directions(i)*roots(i) <= slack) cycle
         call describe(contact, mode, point, contact%roots(i), message, status)
         if (.not. has_failed(status)) call fail(status, code_out_of_domain, message, subject_mesh, contact%mesh, "contact")
         return
      end do
   end subroutine judge

   !> What a root function past its zero means, in the words of its row.
   subroutine describe(contact, mode, point, kind, message, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      integer, intent(in) :: kind
      character(len=message_length), intent(out) :: message
      type(status_t), intent(inout) :: status
      character(len=12) :: pair
      character(len=24) :: number
      character(len=len(root_rows%above)) :: text

      write (pair, "(i0)") mode%tooth_pair
      text = root_rows(kind)%above
      if (contact_root_direction(contact, mode, kind) < 0 .and. root_rows(kind)%below /= "") text = root_rows(kind)%below
      call measure(contact, mode, point, kind, index(text, "|#|") > 0, number, status)
      message = "tooth pair "//trim(pair)//" "//trim(filled(text, trim(number))) &
                //": an event was missed; take a smaller max_step or tolerance"
   end subroutine describe

   !> What a root function measures, with its unit; blank if its row does not say.
   subroutine measure(contact, mode, point, kind, is_size, number, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      integer, intent(in) :: kind
      logical, intent(in) :: is_size !! without the sign
      character(len=*), intent(out) :: number
      type(status_t), intent(inout) :: status
      character(len=3) :: unit
      real(wp) :: value

      number = ""
      select case (root_rows(kind)%measures)
      case (measures_penetration)
         value = point%h
         unit = "m"
      case (measures_rate)
         value = point%h_dot
         unit = "m/s"
      case (measures_sliding)
         value = point%v_t
         unit = "m/s"
      case (measures_force)
         call unclipped_force(contact, mode, point, value, status)
         unit = "N"
      case default
         return
      end select
      number = quantity(merge(abs(value), value, is_size), trim(unit))
   end subroutine measure

   !> A text with what it measures in place of # or |#|.
   pure function filled(text, number) result(full)
      character(len=*), intent(in) :: text, number
      character(len=:), allocatable :: full
      integer :: first, last

      first = index(text, "#")
      last = first
      if (index(text, "|#|") > 0) then
         first = first - 1
         last = last + 1
      end if
      full = text
      if (first > 0) full = text(:first - 1)//number//text(last + 1:)
   end function filled

end module evl_mode_check
