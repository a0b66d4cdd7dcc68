!> Whether the numbers that were given for a kind of load or support are those that its rows ask for.
module evl_parameter_check
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use evl_kinds, only: wp
   use evl_parameter, only: given_numbers, given_series, has_number, kind_info_t, max_parameters, parameter_range_error, &
                            parameter_t, shape_at_knots, shape_knots, shape_number, shape_pair
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t
   implicit none (type, external)
   private

   public :: check_numbers, fill_defaults

contains

   !> Put in the defaults of the parameters that were not given.
   subroutine fill_defaults(info, given)
      type(kind_info_t), intent(in) :: info
      class(given_numbers), intent(inout) :: given
      real(wp), allocatable :: numbers(:)
      integer :: added(max_parameters), k

      allocate (numbers(0))
      added = 0
      do k = 1, info%n_parameters
         associate (row => info%parameters(k))
            if (has_number(given, k)) then
               numbers = [numbers, given_series(given, k)]
            else if (.not. row%required .and. ieee_is_finite(row%default_value)) then
               added(k) = merge(2, 1, row%shape == shape_pair)
               numbers = [numbers, spread(row%default_value, 1, added(k))]
            end if
         end associate
      end do
      given%counts = given%counts + added
      given%numbers = numbers
   end subroutine fill_defaults

   !> Every number is in its range, and the times of a table increase.
   subroutine check_numbers(info, given, subject, index, block, status)
      type(kind_info_t), intent(in) :: info
      class(given_numbers), intent(in) :: given
      integer, intent(in) :: subject, index  !! what is refused
      character(len=*), intent(in) :: block  !! that has the parameters, with a dot; "" for the subject's own
      type(status_t), intent(inout) :: status
      integer :: k, i_knots

      i_knots = 0
      do k = 1, info%n_parameters
         associate (row => info%parameters(k))
            if (row%shape == shape_knots) i_knots = k
            if (.not. (row%required .or. has_number(given, k))) cycle
            select case (row%shape)
            case (shape_number)
               call check_row(row, given_series(given, k), 1, subject, index, block, status)
            case (shape_pair)
               call check_row(row, given_series(given, k), 2, subject, index, block, status)
            case (shape_knots)
               call check_knots(row, given_series(given, k), subject, index, block, status)
            case (shape_at_knots)
               if (given%counts(k) /= given%counts(i_knots)) then
                  call fail(status, code_invalid_input, "a table needs as many values as times", subject, index, &
                            block//trim(row%name))
               else if (.not. all(ieee_is_finite(given_series(given, k)))) then
                  call fail(status, code_invalid_input, "times and values of a table must be finite numbers", subject, &
                            index, block//trim(row%name))
               end if
            end select
         end associate
         if (has_failed(status)) return
      end do
   end subroutine check_numbers

   !> One number, or a pair.
   subroutine check_row(row, numbers, n, subject, index, block, status)
      type(parameter_t), intent(in) :: row
      real(wp), intent(in) :: numbers(:)
      integer, intent(in) :: n !! how many there are to be
      integer, intent(in) :: subject, index
      character(len=*), intent(in) :: block
      type(status_t), intent(inout) :: status
      integer :: i

      if (size(numbers) /= n) then
         call fail(status, code_invalid_input, trim(row%name)//" needs "//trim(merge("one number ", "two numbers", n == 1)), &
                   subject, index, block//trim(row%name))
         return
      end if
      do i = 1, n
         if (parameter_range_error(row, numbers(i)) == "" .or. has_failed(status)) cycle
         call fail(status, code_invalid_input, trim(parameter_range_error(row, numbers(i))), subject, index, &
                   block//trim(row%name))
      end do
   end subroutine check_row

   !> The times of a table.
   subroutine check_knots(row, time, subject, index, block, status)
      type(parameter_t), intent(in) :: row
      real(wp), intent(in) :: time(:) !! [s]
      integer, intent(in) :: subject, index
      character(len=*), intent(in) :: block
      type(status_t), intent(inout) :: status
      integer :: i

      if (size(time) < 2) then
         call fail(status, code_invalid_input, "a table needs at least two knots", subject, index, block//trim(row%name))
         return
      else if (.not. all(ieee_is_finite(time))) then
         call fail(status, code_invalid_input, "times and values of a table must be finite numbers", subject, index, &
                   block//trim(row%name))
         return
      end if
      do i = 2, size(time)
         if (time(i) > time(i - 1)) cycle
         call fail(status, code_invalid_input, "the times of a table must increase, but "//quantity(time(i), "s")//" follows " &
                   //quantity(time(i - 1), "s"), subject, index, block//trim(row%name))
         return
      end do
   end subroutine check_knots

end module evl_parameter_check
