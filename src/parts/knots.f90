!> A table over time: linear between its knots, constant before the first and after the last.
!>
!> Which two knots a time is between is said by the caller: the segment, the number of knots passed, is part of a discrete state.
module evl_knots
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: knot_slope, knot_value, knots_passed, knots_t, next_knot, varies_between

   type :: knots_t
      real(wp), allocatable :: time(:)   !! [s], strictly increasing
      real(wp), allocatable :: values(:) !! there
   end type knots_t

contains

   !> The table at a time.
   pure real(wp) function knot_value(knots, t, segment) result(value)
      type(knots_t), intent(in) :: knots
      real(wp), intent(in) :: t      !! [s]
      integer, intent(in) :: segment !! number of knots passed

      if (varies_between(knots, segment)) then
         value = between_knots(t, knots%time(segment), knots%time(segment + 1), knots%values(segment), knots%values(segment + 1))
      else
         value = knots%values(merge(1, size(knots%time), segment < 1))
      end if
   end function knot_value

   !> Its rate [per s].
   pure real(wp) function knot_slope(knots, segment) result(slope)
      type(knots_t), intent(in) :: knots
      integer, intent(in) :: segment

      slope = 0
      if (.not. varies_between(knots, segment)) return
      slope = (knots%values(segment + 1) - knots%values(segment))/(knots%time(segment + 1) - knots%time(segment))
   end function knot_slope

   include "parts/between_knots.inc"

   !> Whether the segment lies between two knots.
   pure logical function varies_between(knots, segment) result(varies)
      type(knots_t), intent(in) :: knots
      integer, intent(in) :: segment

      varies = segment >= 1 .and. segment < size(knots%time)
   end function varies_between

   !> Number of knots at or before t.
   pure integer function knots_passed(knots, t) result(segment)
      type(knots_t), intent(in) :: knots
      real(wp), intent(in) :: t

      segment = count(knots%time <= t)
   end function knots_passed

   !> Time of the next knot [s]; +huge if there is none.
   pure real(wp) function next_knot(knots, segment) result(time)
      type(knots_t), intent(in) :: knots
      integer, intent(in) :: segment

      time = huge(time)
      if (segment < size(knots%time)) time = knots%time(segment + 1)
   end function next_knot

end module evl_knots
