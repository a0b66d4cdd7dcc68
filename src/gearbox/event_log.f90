!> Log of events in the order in which they are applied, and the names of all event kinds.
module evl_event_log
   use evl_event_kinds, only: event_rows, n_event_rows
   use evl_indices, only: indices
   use evl_kinds, only: wp
   use evl_root_kinds, only: root_rows
   use evl_row, only: kind_t
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: event_log, event_of_root, event_t, list_event_kinds, moment_t, n_event_kinds, note

   !> One event.
   type :: event_t
      integer :: kind = 0        !! index in the table of event kinds, from 0
      integer :: mesh = 0        !! from 1; 0 if none
      integer :: flank = -1      !! drive or coast; -1 if none
      integer :: tooth_pair = -1 !! pitches since the start; -1 if none
   end type event_t

   !> Events in the order in which they are applied.
   type :: event_log
      integer :: n = 0
      logical :: once = .false. !! a repeated event is listed only at its last occurrence
      type(event_t), allocatable :: events(:)
   end type event_log

   !> State during the handling of an event.
   type :: moment_t
      real(wp) :: t                         !! [s]
      real(wp), allocatable :: y(:)
      integer, allocatable :: integers(:)   !! discrete state
      real(wp), allocatable :: reals(:)     !! discrete state
      type(event_log) :: log
   end type moment_t

contains

   !> Number of event kinds: those of their table, then the root functions that are logged under their own names.
   pure integer function n_event_kinds() result(n)

      n = n_event_rows + count(root_rows%text /= "")
   end function n_event_kinds

   !> Event kind of a root function that is logged under its own name.
   pure integer function event_of_root(kind) result(event)
      integer, intent(in) :: kind !! one with a text

      event = n_event_rows - 1 + count(root_rows(:kind)%text /= "")
   end function event_of_root

   !> Names and descriptions of all event kinds.
   pure subroutine list_event_kinds(kinds)
      type(kind_t), allocatable, intent(out) :: kinds(:)

      allocate (kinds(n_event_kinds()))
      kinds(:n_event_rows)%name = event_rows%name
      kinds(:n_event_rows)%text = event_rows%text
      kinds(n_event_rows + 1:)%name = root_rows(indices(root_rows%text /= ""))%name
      kinds(n_event_rows + 1:)%text = root_rows(indices(root_rows%text /= ""))%text
   end subroutine list_event_kinds

   !> Add an event to the log.
   pure subroutine note(log, kind, contact, tooth_pair)
      type(event_log), intent(inout) :: log
      integer, intent(in) :: kind
      type(tooth_contact_t), intent(in), optional :: contact
      integer, intent(in), optional :: tooth_pair
      type(event_t) :: event
      integer :: i, n_retained

      event = event_t(kind)
      if (present(contact)) event%mesh = contact%mesh
      if (present(contact)) event%flank = contact%flank
      if (present(tooth_pair)) event%tooth_pair = tooth_pair
      n_retained = 0
      do i = 1, log%n
         if (log%once .and. same(log%events(i), event)) cycle
         n_retained = n_retained + 1
         log%events(n_retained) = log%events(i)
      end do
      log%n = n_retained + 1
      if (log%n > size(log%events)) log%events = [log%events, event] ! grow the array
      log%events(log%n) = event
   end subroutine note

   !> Whether two events are of one kind and of one tooth pair.
   elemental logical function same(a, b)
      type(event_t), intent(in) :: a, b

      same = a%kind == b%kind .and. a%mesh == b%mesh .and. a%flank == b%flank .and. a%tooth_pair == b%tooth_pair
   end function same

end module evl_event_log
