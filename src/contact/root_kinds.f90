!> Table of all root functions of a tooth contact. A row gives the part of the discrete state that changes when its quantity crosses
!> a border, the events at the crossing, and texts for a quantity on the wrong side of the border.
!>
!> In evl_contact_roots, `contact_root_direction` returns when a kind is active and in which direction, and `root_quantity` returns
!> its quantity. For a kind with a side, the row also gives when it is active. A kind that is only logged has a side and a text; it
!> needs a row, a number and a quantity.
module evl_root_kinds
   use evl_event_kinds, only: event_apart, event_border, event_closed, event_edge_left, event_entered, event_flank_reached, &
                              event_left, event_near, event_opened, &
                              event_returned, event_sliding_began, event_sliding_ended, event_switch, event_switch_back, &
                              event_vanished, no_event
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: past, root_of, root_row, root_rows
   public :: moves_flanks, moves_friction, moves_pair, moves_side, moves_zone_a, moves_zone_b
   public :: n_discrete, n_held, n_root_kinds, n_sides, side_of_rate, tie
   public :: live_bends_a, live_bends_b, live_loaded, live_on_path, live_one_sided, live_touching
   public :: measures_force, measures_nothing, measures_penetration, measures_rate, measures_sliding
   public :: settles_alone, settles_contact, settles_never, settles_sliding

   !> Distance of a root from the change of mode, relative to the size of the quantity: a root function never starts at zero.
   real(wp), parameter :: past = 1.0e-10_wp

   !> A root function this close to its zero counts as crossed, so that simultaneous events are processed together despite rounding.
   !> Smaller than the distance `past` of a root from the change of mode.
   real(wp), parameter :: tie = past/2

   !> As `past`, for the side of a damping law, relative to the rate scale. The damper force on the wrong side is negligible there.
   !> The value exceeds the integration error of a rate that has decayed to zero; otherwise sides would change endlessly.
   real(wp), parameter :: standstill = 1.0e-6_wp

   ! Integer of the discrete state that a root function changes: n_held named ones, then one for each kind with a side.
   integer, parameter :: moves_pair = 1, moves_flanks = 2, moves_friction = 3, moves_zone_a = 4, moves_zone_b = 5, moves_side = 6
   integer, parameter :: n_held = 5

   ! Groups of quantities that may jump at an event. If one of a group has just crossed, the group changes back only by a large
   ! jump.
   integer, parameter :: settles_never = 0   !! position on the path: the mode ends when it is crossed
   integer, parameter :: settles_contact = 1
   integer, parameter :: settles_sliding = 2
   integer, parameter :: settles_alone = 3   !! a root function that has crossed does not change back

   ! Condition under which a kind with a side is active.
   integer, parameter :: live_touching = 1  !! flanks overlap
   integer, parameter :: live_one_sided = 2 !! as live_touching, and the damping law has two sides
   integer, parameter :: live_loaded = 3    !! a force acts
   integer, parameter :: live_on_path = 4   !! the pair is on the path of contact
   integer, parameter :: live_bends_a = 5, live_bends_b = 6 !! flanks overlap, and wheel A, or B, is compliant

   ! Quantity that replaces # in a text.
   integer, parameter :: measures_nothing = 0, measures_penetration = 1, measures_rate = 2, measures_force = 3, measures_sliding = 4

   !> Numbers of the kinds, in the order of the table; kinds with a side are last.
   type :: root_numbers
      integer :: contact = 1        !! the gap closes or opens
      integer :: force = 2          !! the unclipped force passes zero
      integer :: friction_high = 3  !! v_t passes the upper end of the linear part
      integer :: friction_low = 4   !! v_t passes the lower end
      integer :: forward = 5        !! the far end of the path is passed
      integer :: back = 6           !! the near end of the path is passed
      integer :: switch = 7         !! one pitch since the last switch, of a pair with handover
      integer :: switch_back = 8    !! one pitch back since the last switch
      integer :: apart = 9          !! the gap becomes so wide, or so narrow again, that tracking ends or begins
      integer :: tip_a = 10, root_a = 11 !! the contact passes the border of A's tip relief; of its root relief
      integer :: tip_b = 12, root_b = 13 !! the same for B
      integer :: tip_corner_a = 14, root_corner_a = 15 !! the contact leaves the corner of a relief onto the relief, or returns
      integer :: tip_corner_b = 16, root_corner_b = 17 !! the same for B
      integer :: end_a = 18, edge_a = 19 !! the contact passes the end of A's flank; A's edge contact begins
      integer :: end_b = 20, edge_b = 21 !! the same for B
      integer :: side = 22          !! the rate of the penetration passes zero, where a one-sided damping law changes
      integer :: smooth_low_a = 23, smooth_high_a = 24 !! the loaded position on A passes a jump of the curvature of its c
      integer :: smooth_low_b = 25, smooth_high_b = 26 !! the same for B
   end type root_numbers
   type(root_numbers), parameter :: root_of = root_numbers()

   !> One kind. In the texts # is the quantity with its unit, |#| its magnitude.
   type :: root_row
      character(len=24) :: name
      integer :: moves = moves_side
      integer :: settles = settles_alone
      integer :: measures = measures_nothing
      real(wp) :: border = 0.0_wp           !! of the quantity, which is of order 1
      real(wp) :: past = past               !! distance of the root from the border
      integer :: rises = no_event, falls = no_event !! events to log; further conditions may apply
      character(len=64) :: above            !! text for a tooth pair with its quantity above the border although its mode is below
      character(len=64) :: below = ""       !! text for the opposite case; blank: the same text
      integer :: live = 0                   !! condition under which a kind with a side is active
      character(len=88) :: text = ""        !! description of a kind that is logged under its own name
   end type root_row

   character(len=*), parameter :: wrong_branch = "slides at #, outside its branch of friction"
   character(len=*), parameter :: wrong_side = "moves at #, on the wrong side of its damping law"
   character(len=*), parameter :: past_border = "is past the border of a relief", past_end = "is past an end of the path of contact"
   character(len=*), parameter :: wrong_end = "is on the other side of the end of a flank"
   character(len=*), parameter :: other_end = "is loaded on the wrong side of a kink in a wheel's compliance"
   character(len=*), parameter :: on_path = "is on the path but counts as off it"

   !&<
   type(root_row), parameter :: root_rows(*) = &
      [root_row("contact", moves_flanks, settles_contact, measures_penetration, rises=event_closed, falls=event_opened, &
                above="overlaps by |#| but counts as open", below="is in contact, but its flanks are |#| apart"), &
       root_row("force", moves_flanks, settles_contact, measures_force, rises=event_returned, falls=event_vanished, &
                above="has a force of |#| but counts as unloaded", below="pulls with |#|"), &
       root_row("friction_high", moves_friction, settles_sliding, measures_sliding, border=1.0_wp, &
                rises=event_sliding_began, falls=event_sliding_ended, above=wrong_branch), &
       root_row("friction_low", moves_friction, settles_sliding, measures_sliding, border=-1.0_wp, &
                rises=event_sliding_ended, falls=event_sliding_began, above=wrong_branch), &
       root_row("forward", moves_pair, settles_never, rises=event_entered, falls=event_left, above=on_path, below=past_end), &
       root_row("back", moves_pair, settles_never, rises=event_entered, falls=event_left, above=on_path, below=past_end), &
       root_row("forward", moves_pair, settles_never, border=1.0_wp, past=0.0_wp, rises=event_switch, above=past_end), &
       root_row("back", moves_pair, settles_never, border=-1.0_wp, past=0.0_wp, falls=event_switch_back, above=past_end), &
       root_row("apart", moves_flanks, settles_never, border=1.0_wp, past=0.0_wp, rises=event_apart, falls=event_near, &
                above="is too far apart to track its points", below="is near but its points are not tracked"), &
       root_row("tip_a", moves_zone_a, settles_never, rises=event_border, falls=event_border, above=past_border), &
       root_row("root_a", moves_zone_a, settles_never, rises=event_border, falls=event_border, above=past_border), &
       root_row("tip_b", moves_zone_b, settles_never, rises=event_border, falls=event_border, above=past_border), &
       root_row("root_b", moves_zone_b, settles_never, rises=event_border, falls=event_border, above=past_border), &
       root_row("tip_corner_a", moves_zone_a, settles_never, rises=event_border, falls=event_border, above=past_border), &
       root_row("root_corner_a", moves_zone_a, settles_never, rises=event_border, falls=event_border, above=past_border), &
       root_row("tip_corner_b", moves_zone_b, settles_never, rises=event_border, falls=event_border, above=past_border), &
       root_row("root_corner_b", moves_zone_b, settles_never, rises=event_border, falls=event_border, above=past_border), &
       root_row("end_a", moves_zone_a, settles_never, rises=event_border, falls=event_border, above=wrong_end), &
       root_row("edge_a", moves_zone_a, settles_never, rises=event_edge_left, falls=event_flank_reached, above=wrong_end), &
       root_row("end_b", moves_zone_b, settles_never, rises=event_border, falls=event_border, above=wrong_end), &
       root_row("edge_b", moves_zone_b, settles_never, rises=event_edge_left, falls=event_flank_reached, above=wrong_end), &
       root_row("side", measures=measures_rate, past=standstill, above=wrong_side, live=live_one_sided), &
       root_row("smooth_low_a", above=other_end, live=live_bends_a), root_row("smooth_high_a", above=other_end, &
                                                                              live=live_bends_a), &
       root_row("smooth_low_b", above=other_end, live=live_bends_b), root_row("smooth_high_b", above=other_end, live=live_bends_b)]
   !&>

   integer, parameter :: n_root_kinds = size(root_rows)
   integer, parameter :: n_sides = count(root_rows%moves == moves_side)
   integer, parameter :: n_discrete = n_held + n_sides      !! number of integers of a tooth contact
   integer, parameter :: side_of_rate = root_of%side - (n_root_kinds - n_sides) !! index among the sides

end module evl_root_kinds
