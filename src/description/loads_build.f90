!> Makes the loads of a gearbox from their description, by the rows in which their kinds describe themselves.
module evl_loads_build
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use evl_gearbox, only: load_slot
   use evl_load, only: load_input, load_t
   use evl_load_kinds, only: load_of_kind
   use evl_parameter, only: parameter_name_length
   use evl_parameter_check, only: check_numbers, fill_defaults
   use evl_status, only: code_invalid_input, fail, has_failed, message_length, status_t, subject_load
   implicit none (type, external)
   private

   public :: loads_build

contains

   !> The loads, not yet numbered in the discrete state.
   !> Errors: code_invalid_input with the load and the parameter.
   subroutine loads_build(inputs, n_wheels, loads, status)
      type(load_input), intent(in) :: inputs(:)
      integer, intent(in) :: n_wheels
      type(load_slot), allocatable, intent(out) :: loads(:)
      type(status_t), intent(inout) :: status
      integer :: i

      allocate (loads(size(inputs)))
      do i = 1, size(inputs)
         call load_build(inputs(i), n_wheels, i, loads(i)%load, status)
         if (has_failed(status)) return
         if (loads(i)%load%prescribes) call check_alone(loads(:i), status)
         if (has_failed(status)) return
      end do
   end subroutine loads_build

   !> One of them.
   subroutine load_build(input, n_wheels, index, load, status)
      type(load_input), intent(in) :: input
      integer, intent(in) :: n_wheels, index
      class(load_t), allocatable, intent(out) :: load
      type(status_t), intent(inout) :: status
      type(load_input) :: given
      character(len=message_length) :: message
      character(len=parameter_name_length) :: field

      call load_of_kind(input%kind, load)
      if (input%wheel < 1 .or. input%wheel > n_wheels) then
         call fail(status, code_invalid_input, "there is no such wheel", subject_load, index, "wheel")
      else if (.not. allocated(load)) then
         call fail(status, code_invalid_input, "there is no such kind of load", subject_load, index, "kind")
      end if
      if (has_failed(status)) return
      given = input
      call fill_defaults(load%describe(), given)
      call check_numbers(load%describe(), given, subject_load, index, "", status)
      if (has_failed(status)) return
      call load%refusal(given, message, field)
      if (message /= "") then
         call fail(status, code_invalid_input, trim(message), subject_load, index, trim(field))
         return
      end if
      call load%take(given)
      load%wheel = input%wheel
      load%against_housing = input%against_housing
   end subroutine load_build

   !> The last of the loads prescribes a speed: no other does for its wheel.
   subroutine check_alone(loads, status)
      type(load_slot), intent(in) :: loads(:)
      type(status_t), intent(inout) :: status
      integer :: i

      associate (last => loads(size(loads))%load)
         do i = 1, size(loads) - 1
            if (.not. loads(i)%load%prescribes .or. loads(i)%load%wheel /= last%wheel) cycle
            call fail(status, code_invalid_input, "a second prescribed speed for one wheel; it can have only one", subject_load, &
                      size(loads))
            return
         end do
      end associate
   end subroutine check_alone

end module evl_loads_build
