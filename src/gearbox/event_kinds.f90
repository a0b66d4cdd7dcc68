!> What can happen to a gearbox, by name, and the list of what happened at one event.
module evl_event_kinds
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: event_t, event_log, note, event_name, n_event_kinds
   public :: event_switch, event_switch_back, event_closed, event_opened, event_vanished, event_returned, event_sliding_began, &
             event_sliding_ended, event_knot, event_revolution, event_apart, event_near, event_impact, event_impacts_ended, &
             event_entered, event_left, event_border

   integer, parameter :: event_switch = 0, event_switch_back = 1, event_closed = 2, event_opened = 3, event_vanished = 4, &
                         event_returned = 5, event_sliding_began = 6, event_sliding_ended = 7, event_knot = 8, &
                         event_revolution = 9, event_apart = 10, event_near = 11, event_impact = 12, event_impacts_ended = 13, &
                         event_entered = 14, event_left = 15, event_border = 16
   integer, parameter :: n_event_kinds = 17 !! number of kinds
   character(len=18), parameter :: names(0:n_event_kinds - 1) = ["tooth_switch      ", "tooth_switch_back ", "contact_closed    ", &
                                                                 "contact_opened    ", "force_vanished    ", "force_returned    ", &
                                                                 "sliding_began     ", "sliding_ended     ", "table_knot        ", &
                                                                 "revolution        ", "flanks_apart      ", "flanks_near       ", &
                                                                 "impact            ", "impacts_ended     ", "pair_entered      ", &
                                                                 "pair_left         ", "profile_border    "]

   !> One thing that happened.
   type :: event_t
      integer :: kind = 0        !! one of the kinds above
      integer :: mesh = 0        !! from 1; 0 if it concerns none
      integer :: flank = -1      !! drive or coast; -1 if it concerns none
      integer :: tooth_pair = -1 !! pitches since the start; -1 if it concerns none
   end type event_t

   !> What happens at one event, in the order in which it is applied.
   type :: event_log
      integer :: n = 0
      logical :: once = .false. !! what is noted again stands only where it happened last
      type(event_t), allocatable :: events(:)
   end type event_log

contains

   !> Name of an event kind; blank if there is none.
   pure function event_name(kind) result(name)
      integer, intent(in) :: kind
      character(len=len(names)) :: name

      name = ""
      if (kind >= 0 .and. kind < n_event_kinds) name = names(kind)
   end function event_name

   !> Write an event down.
   pure subroutine note(log, kind, contact, tooth_pair)
      type(event_log), intent(inout) :: log
      integer, intent(in) :: kind
      type(tooth_contact_t), intent(in), optional :: contact
      integer, intent(in), optional :: tooth_pair
      type(event_t) :: event
      integer :: i, kept

      event = event_t(kind)
      if (present(contact)) event%mesh = contact%mesh
      if (present(contact)) event%flank = contact%flank
      if (present(tooth_pair)) event%tooth_pair = tooth_pair
      kept = 0
      do i = 1, log%n
         if (log%once .and. same(log%events(i), event)) cycle
         kept = kept + 1
         log%events(kept) = log%events(i)
      end do
      log%n = kept + 1
      log%events(log%n) = event
   end subroutine note

   !> Whether two events are of one kind and of one tooth pair.
   elemental logical function same(a, b)
      type(event_t), intent(in) :: a, b

      same = a%kind == b%kind .and. a%mesh == b%mesh .and. a%flank == b%flank .and. a%tooth_pair == b%tooth_pair
   end function same

end module evl_event_kinds
