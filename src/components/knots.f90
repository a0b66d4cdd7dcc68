!> Table over time: linear between its knots, constant before the first and after the last.
!>
!> The caller provides the segment in which a time is: the number of knots passed, which is part of a discrete state.
module evl_knots
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: knot_slope, knot_value, knot_values, knots_passed, knots_t, next_knot

   type :: knots_t
      real(wp), allocatable :: time(:)   !! [s], strictly increasing
      real(wp), allocatable :: values(:) !! there
   end type knots_t

contains

   !> Value of the table at a time.
   pure real(wp) function knot_value(knots, t, segment) result(value)
      type(knots_t), intent(in) :: knots
      real(wp), intent(in) :: t      !! [s]
      integer, intent(in) :: segment !! number of knots passed

      real(wp) :: there(1)

      call knot_values(knots, 1, [t], segment, there)
      value = there(1)
   end function knot_value

   !> Values of the table at n times of one segment.
   pure subroutine knot_values(knots, n, t, segment, values)
      type(knots_t), intent(in) :: knots
      integer, intent(in) :: n
      real(wp), intent(in) :: t(n) !! [s]
      integer, intent(in) :: segment
      real(wp), intent(out) :: values(n)
      real(wp) :: t_1, t_2, value_1, value_2, share
      integer :: l

      if (.not. varies_between(knots, segment)) then
         values = knots%values(merge(1, size(knots%time), segment < 1))
         return
      end if
      t_1 = knots%time(segment)
      t_2 = knots%time(segment + 1)
      value_1 = knots%values(segment)
      value_2 = knots%values(segment + 1)
      !$omp simd private(share)
      do l = 1, n
         share = (t(l) - t_1)/(t_2 - t_1)
         values(l) = (1 - share)*value_1 + share*value_2
      end do
   end subroutine knot_values

   !> Rate of the table [per s].
   pure real(wp) function knot_slope(knots, segment) result(slope)
      type(knots_t), intent(in) :: knots
      integer, intent(in) :: segment

      slope = 0
      if (.not. varies_between(knots, segment)) return
      slope = (knots%values(segment + 1) - knots%values(segment))/(knots%time(segment + 1) - knots%time(segment))
   end function knot_slope

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
