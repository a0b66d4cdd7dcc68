!> Check that the modes of all tooth contacts agree with a state: forces push, pairs in contact overlap, and every pair is in the
!> position given by its modes.
!>
!> Between events this holds if no event was missed. A root function that crosses zero and returns within a step may be missed; a
!> state in that step then fails the check.
module evl_mode_check
   use evl_contact_roots, only: contact_root_direction, contact_roots
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: lanes, wp
   use evl_root_kinds, only: measures_force, measures_penetration, measures_rate, measures_sliding, n_root_kinds, root_rows
   use evl_status, only: code_out_of_domain, fail, has_failed, message_length, quantity, status_t, subject_mesh
   use evl_tooth_contact, only: contact_state, tooth_contact_t, unclipped
   implicit none (type, external)
   private

   public :: check_modes, modes_agree

   !> Permitted distance of a root function past its zero, in its own units: forces over the reference force, penetrations over the
   !> reference penetration, sliding over the knee of friction, positions in pitches. It is far above the accuracy of event
   !> location.
   real(wp), parameter :: slack = 1.0e-6_wp

contains

   include "numerics/all_positive.inc"

   !> Fail if a state contradicts its modes; the contacts must be evaluated.
   subroutine check_modes(gearbox, contacts, status)
      type(gearbox_t), intent(in) :: gearbox
      type(contact_state), intent(in) :: contacts(*) !! all contacts, with the results of the laws
      type(status_t), intent(inout) :: status        !! code_out_of_domain: an event was missed; a smaller step may find it
      real(wp) :: roots(n_root_kinds)
      integer :: directions(n_root_kinds), m

      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m))
            call contact_roots(gearbox%flanks(contact%i_flank)%flank, contact, contacts(m), directions, roots)
            call judge(contact, contacts(m), directions, roots, status)
         end associate
         if (has_failed(status)) return
      end do
   end subroutine check_modes

   !> Whether eight states agree with their modes, from the root functions in lanes.
   pure logical function modes_agree(gearbox, slots, roots)
      type(gearbox_t), intent(in) :: gearbox
      type(lane_slot), intent(in) :: slots(*) !! [tooth contacts] with their discrete state
      real(wp), intent(in) :: roots(lanes, gearbox%n_roots)
      real(wp) :: least(lanes), x
      integer :: c, i, l

      least = 1
      do c = 1, size(gearbox%contacts)
         do i = 1, gearbox%contacts(c)%n_roots
            associate (direction => slots(c)%directions(i), at => roots(:, gearbox%contacts(c)%i_root + i))
               if (direction == 0) cycle
               !$omp simd private(x)
               do l = 1, lanes
                  x = slack - direction*at(l)
                  least(l) = min(least(l), merge(x, 0.0_wp, x > 0)) ! NaN does not agree
               end do
            end associate
         end do
      end do
      modes_agree = all_positive(least)
   end function modes_agree

   !> Fail if root functions are past the zeros that should have ended the modes.
   subroutine judge(contact, at, directions, roots, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      integer, intent(in) :: directions(contact%n_roots)
      real(wp), intent(in) :: roots(contact%n_roots)
      type(status_t), intent(inout) :: status
      character(len=message_length) :: message
      integer :: i

      do i = 1, contact%n_roots
         if (directions(i)*roots(i) <= slack) cycle
         call describe(contact, at, contact%roots(i), message)
         call fail(status, code_out_of_domain, message, subject_mesh, contact%mesh, "contact")
         return
      end do
   end subroutine judge

   !> Message for a root function past its zero, from the text of its row.
   subroutine describe(contact, at, kind, message)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      integer, intent(in) :: kind
      character(len=message_length), intent(out) :: message
      character(len=12) :: pair
      character(len=24) :: number
      character(len=len(root_rows%above)) :: text

      write (pair, "(i0)") at%mode%tooth_pair
      text = root_rows(kind)%above
      if (contact_root_direction(contact, at%mode, kind) < 0 .and. root_rows(kind)%below /= "") text = root_rows(kind)%below
      call measure(at, kind, index(text, "|#|") > 0, number)
      message = "tooth pair "//trim(pair)//" "//trim(filled(text, trim(number))) &
                //": an event was missed; choose a smaller max_step or tolerance"
   end subroutine describe

   !> Quantity of a root function, with its unit; blank if its row has none.
   subroutine measure(at, kind, is_size, number)
      type(contact_state), intent(in) :: at
      integer, intent(in) :: kind
      logical, intent(in) :: is_size !! without the sign
      character(len=*), intent(out) :: number
      character(len=3) :: unit
      real(wp) :: value

      number = ""
      select case (root_rows(kind)%measures)
      case (measures_penetration)
         value = at%overlap
         unit = "m"
      case (measures_rate)
         value = at%point%h_dot
         unit = "m/s"
      case (measures_sliding)
         value = at%point%v_t
         unit = "m/s"
      case (measures_force)
         value = unclipped(at)
         unit = "N"
      case default
         return
      end select
      number = quantity(merge(abs(value), value, is_size), trim(unit))
   end subroutine measure

   !> Text with the quantity inserted for # or |#|, padded with blanks.
   pure function filled(text, number) result(full)
      character(len=*), intent(in) :: text, number
      character(len=len(text) + len(number)) :: full
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
