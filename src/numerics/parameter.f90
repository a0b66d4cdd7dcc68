!> How a law or a load describes a parameter: name, unit, shape, range, default, text; and whether a value is accepted.
module evl_parameter
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan, ieee_negative_inf, ieee_positive_inf, ieee_quiet_nan, &
                                                                               ieee_value
   use evl_kinds, only: wp
   use evl_status, only: message_length, quantity
   implicit none (type, external)
   private

   public :: given_number, given_numbers, given_series, has_number, is_left_open, kind_info_t, max_parameters
   public :: parameter_name_length, parameter_range_error, parameter_row, parameter_t, parameter_text_length
   public :: shape_at_knots, shape_knots, shape_number, shape_pair

   integer, parameter :: parameter_name_length = 31 !! characters of a name or a unit; EVL_NAME_LENGTH without the NUL
   integer, parameter :: parameter_text_length = 95 !! characters of a description; EVL_TEXT_LENGTH without the NUL
   integer, parameter :: max_parameters = 8         !! of one law or load; EVL_MAX_PARAMETERS

   integer, parameter :: shape_number = 0   !! one number; evl_shape of the C header
   integer, parameter :: shape_knots = 1    !! times of a table, strictly increasing, at least two
   integer, parameter :: shape_at_knots = 2 !! numbers at these times
   integer, parameter :: shape_pair = 3     !! two numbers, x and y

   !> One parameter; evl_parameter of the C header.
   type :: parameter_t
      character(len=parameter_name_length) :: name = ""        !! as in the case file
      character(len=parameter_name_length) :: units = "1"      !! "1" if without
      character(len=parameter_text_length) :: description = "" !! one line
      integer :: shape = shape_number    !! one of the shapes above
      logical :: required = .false.      !! there is no default
      real(wp) :: default_value = 0.0_wp !! in `units`; 0 if required, NaN if it may be left open
      real(wp) :: minimum = 0.0_wp       !! smallest accepted value, -infinity if unbounded
      real(wp) :: maximum = 0.0_wp       !! largest accepted value, +infinity if unbounded
      logical :: minimum_open = .false.  !! the minimum itself is refused
      logical :: maximum_open = .false.  !! the maximum itself is refused
   end type parameter_t

   !> A kind of load or support; evl_kind_info of the C header.
   type :: kind_info_t
      character(len=parameter_name_length) :: name = ""        !! as in the case file
      character(len=parameter_text_length) :: description = "" !! one line
      integer :: n_parameters = 0                              !! how many of `parameters` count
      type(parameter_t) :: parameters(max_parameters)
   end type kind_info_t

   !> The parameters of one: numbers one after the other, in the order of its kind's rows.
   type :: given_numbers
      integer :: counts(max_parameters) = 0 !! how many numbers each parameter has; 0: not given
      real(wp), allocatable :: numbers(:)   !! in the units of the rows
   end type given_numbers

contains

   !> A parameter's description; without `default_value` it is required, unless it may be left open; without a bound it is unbounded
   !> there.
   pure function parameter_row(name, units, description, default_value, minimum, minimum_open, maximum, maximum_open, &
                               left_open, shape) result(parameter)
      character(len=*), intent(in) :: name        !! as in the case file
      character(len=*), intent(in) :: units       !! "1" if without
      character(len=*), intent(in) :: description !! one line
      real(wp), intent(in), optional :: default_value !! in `units`
      real(wp), intent(in), optional :: minimum   !! smallest value
      logical, intent(in), optional :: minimum_open !! the minimum itself is refused
      real(wp), intent(in), optional :: maximum   !! largest value
      logical, intent(in), optional :: maximum_open !! the maximum itself is refused
      logical, intent(in), optional :: left_open    !! it may be missing, without a default
      integer, intent(in), optional :: shape        !! a number if not given
      type(parameter_t) :: parameter

      parameter%name = name
      parameter%units = units
      parameter%description = description
      if (present(shape)) parameter%shape = shape
      parameter%required = .not. present(default_value)
      if (present(left_open)) parameter%required = parameter%required .and. .not. left_open
      if (.not. (present(default_value) .or. parameter%required)) parameter%default_value = ieee_value(1.0_wp, ieee_quiet_nan)
      parameter%minimum = ieee_value(1.0_wp, ieee_negative_inf)
      parameter%maximum = ieee_value(1.0_wp, ieee_positive_inf)
      if (present(default_value)) parameter%default_value = default_value
      if (present(minimum)) parameter%minimum = minimum
      if (present(minimum_open)) parameter%minimum_open = minimum_open
      if (present(maximum)) parameter%maximum = maximum
      if (present(maximum_open)) parameter%maximum_open = maximum_open
   end function parameter_row

   !> Whether a value, NaN, leaves a parameter open that may be.
   elemental logical function is_left_open(parameter, value)
      type(parameter_t), intent(in) :: parameter
      real(wp), intent(in) :: value

      is_left_open = .not. parameter%required .and. ieee_is_nan(parameter%default_value) .and. ieee_is_nan(value)
   end function is_left_open

   !> Whether a value lies in the range; NaN and infinity never do.
   pure logical function accepts(parameter, value)
      type(parameter_t), intent(in) :: parameter
      real(wp), intent(in) :: value !! in parameter%units

      accepts = ieee_is_finite(value) .and. value >= parameter%minimum .and. value <= parameter%maximum &
                .and. (value > parameter%minimum .or. .not. parameter%minimum_open) &
                .and. (value < parameter%maximum .or. .not. parameter%maximum_open)
   end function accepts

   !> What is wrong with a value, such as "coefficient = -1.00000 N s/m must be at least 0"; "" if it is accepted.
   pure function parameter_range_error(parameter, value) result(text)
      type(parameter_t), intent(in) :: parameter !! what is accepted
      real(wp), intent(in) :: value                  !! in parameter%units
      character(len=message_length) :: text
      character(len=len_trim(parameter%units)) :: unit
      character(len=message_length) :: given

      text = ""
      if (accepts(parameter, value)) return
      unit = parameter%units
      if (unit == "1") unit = ""
      given = trim(parameter%name)//" = "//quantity(value, trim(unit))
      if (.not. ieee_is_finite(value)) then
         text = trim(given)//" must be a finite number"
      else if (value < parameter%minimum) then
         text = trim(given)//" must be "//trim(merge("greater than", "at least    ", parameter%minimum_open)) &
                //" "//quantity(parameter%minimum, trim(unit))
      else if (value <= parameter%minimum) then
         text = trim(given)//" must be greater than "//quantity(parameter%minimum, trim(unit))
      else if (value > parameter%maximum) then
         text = trim(given)//" must be "//trim(merge("less than", "at most  ", parameter%maximum_open)) &
                //" "//quantity(parameter%maximum, trim(unit))
      else
         text = trim(given)//" must be less than "//quantity(parameter%maximum, trim(unit))
      end if
   end function parameter_range_error

   !> Whether a parameter was given.
   pure logical function has_number(given, parameter)
      class(given_numbers), intent(in) :: given
      integer, intent(in) :: parameter !! its index among the rows

      has_number = given%counts(parameter) > 0
   end function has_number

   !> The number of a parameter; NaN if it was not given.
   pure real(wp) function given_number(given, parameter) result(number)
      class(given_numbers), intent(in) :: given
      integer, intent(in) :: parameter

      number = ieee_value(number, ieee_quiet_nan)
      if (has_number(given, parameter)) number = given%numbers(sum(given%counts(:parameter - 1)) + 1)
   end function given_number

   !> The numbers of a parameter.
   pure function given_series(given, parameter) result(series)
      class(given_numbers), intent(in) :: given
      integer, intent(in) :: parameter
      real(wp), allocatable :: series(:)

      associate (before => sum(given%counts(:parameter - 1)))
         series = given%numbers(before + 1:before + given%counts(parameter))
      end associate
   end function given_series

end module evl_parameter
