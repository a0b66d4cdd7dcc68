!> Event kinds with names and descriptions: events of the whole gearbox, and events of root functions that change a mode. Kinds that
!> are only logged follow these; they are in the table of root functions.
module evl_event_kinds
   implicit none (type, external)
   private

   public :: event_kind, event_rows, n_event_rows, no_event
   public :: event_apart, event_border, event_closed, event_edge_closed, event_edge_left, event_edge_opened, event_entered, &
             event_flank_reached, event_impact, event_impacts_ended, event_knot, event_left, &
             event_near, event_opened, event_returned, event_revolution, event_sliding_began, event_sliding_ended, event_switch, &
             event_switch_back, event_vanished

   !> One kind; its number is its index in the table, from 0.
   type :: event_kind
      character(len=24) :: name
      character(len=88) :: text
   end type event_kind

   integer, parameter :: no_event = -1
   integer, parameter :: event_switch = 0, event_switch_back = 1, event_closed = 2, event_opened = 3, event_vanished = 4, &
                         event_returned = 5, event_sliding_began = 6, event_sliding_ended = 7, event_knot = 8, &
                         event_revolution = 9, event_apart = 10, event_near = 11, event_impact = 12, event_impacts_ended = 13, &
                         event_entered = 14, event_left = 15, event_border = 16, event_edge_closed = 17, event_edge_opened = 18, &
                         event_flank_reached = 19, event_edge_left = 20

   !&<
   type(event_kind), parameter :: event_rows(0:*) = &
      [event_kind("tooth_switch", "the driving wheel advanced by one pitch: transfer to the next tooth pair"), &
       event_kind("tooth_switch_back", "the driving wheel turned back by one pitch: transfer to the previous pair"), &
       event_kind("contact_closed", "the gap closed"), &
       event_kind("contact_opened", "the flanks separated"), &
       event_kind("force_vanished", "elastic + viscous force decreased to 0 while the flanks still overlap"), &
       event_kind("force_returned", "elastic + viscous force increased above 0 again while the flanks overlap"), &
       event_kind("sliding_began", "friction left the linear part of its law"), &
       event_kind("sliding_ended", "friction entered the linear part of its law"), &
       event_kind("table_knot", "a table of a load has a knot here"), &
       event_kind("revolution", "the reference angle was reduced by whole revolutions"), &
       event_kind("flanks_apart", "the gap became too wide for tracked points to face each other: tracking is suspended"), &
       event_kind("flanks_near", "the gap fell below that width again: tracking restarts"), &
       event_kind("impact", "rigid flanks collided and separate again"), &
       event_kind("impacts_ended", "the approach was too slow for another impact: the rigid contact stays closed"), &
       event_kind("pair_entered", "a tooth pair entered the path of contact, or the range of its corner contact"), &
       event_kind("pair_left", "a tooth pair left the path of contact, or the range of its corner contact"), &
       event_kind("profile_border", "the contact passed the border of a relief, or the end of a relieved flank"), &
       event_kind("edge_closed", "a tip edge touched the flank of its mate, before or after the path of contact"), &
       event_kind("edge_opened", "a tip edge separated from the flank of its mate"), &
       event_kind("flank_reached", "a tooth pair entered its path: flank contact replaces corner contact"), &
       event_kind("edge_left_flank", "a tooth pair left its path of contact: corner contact begins")]
   !&>
   integer, parameter :: n_event_rows = size(event_rows)

end module evl_event_kinds
