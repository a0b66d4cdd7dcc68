!> How a force law describes itself: its name, its source and its parameters with units, defaults and ranges.
module evl_law_info
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan, ieee_negative_inf, ieee_positive_inf, ieee_quiet_nan, &
                                                                               ieee_value
   use evl_kinds, only: wp
   use evl_status, only: message_length, quantity
   implicit none (type, external)
   private

   public :: is_left_open, law_info_t, law_parameter, law_parameter_t, parameter_range_error
   public :: law_name_length, law_text_length, max_law_parameters

   integer, parameter :: law_name_length = 31   !! characters of a name or a unit; EVL_NAME_LENGTH without the NUL
   integer, parameter :: law_text_length = 95   !! characters of a description; EVL_TEXT_LENGTH without the NUL
   integer, parameter :: max_law_parameters = 8 !! EVL_MAX_LAW_PARAMETERS

   !> One parameter of a law; evl_law_parameter of the C header.
   type :: law_parameter_t
      character(len=law_name_length) :: name = ""        !! as in the case file
      character(len=law_name_length) :: units = "1"      !! "1" if without
      character(len=law_text_length) :: description = "" !! one line
      logical :: required = .false.      !! there is no default
      real(wp) :: default_value = 0.0_wp !! in `units`; 0 if required, NaN if the mesh gives it
      real(wp) :: minimum = 0.0_wp       !! smallest accepted value, -infinity if unbounded
      real(wp) :: maximum = 0.0_wp       !! largest accepted value, +infinity if unbounded
      logical :: minimum_open = .false.  !! the minimum itself is refused
      logical :: maximum_open = .false.  !! the maximum itself is refused
   end type law_parameter_t

   !> One law; evl_law_info of the C header.
   type :: law_info_t
      character(len=law_name_length) :: name = ""        !! as in the case file
      character(len=law_text_length) :: description = "" !! one line
      character(len=law_text_length) :: source = ""      !! where the law comes from
      integer :: n_parameters = 0                        !! how many of `parameters` count
      type(law_parameter_t) :: parameters(max_law_parameters) !! in the order of law_choice%parameters
   end type law_info_t

contains

   !> A parameter's description; without `default_value` it is required, unless the mesh gives it; without a bound it is unbounded
   !> there.
   pure function law_parameter(name, units, description, default_value, minimum, minimum_open, maximum, maximum_open, &
                               from_mesh) result(parameter)
      character(len=*), intent(in) :: name        !! as in the case file
      character(len=*), intent(in) :: units       !! "1" if without
      character(len=*), intent(in) :: description !! one line
      real(wp), intent(in), optional :: default_value !! in `units`
      real(wp), intent(in), optional :: minimum   !! smallest value
      logical, intent(in), optional :: minimum_open !! the minimum itself is refused
      real(wp), intent(in), optional :: maximum   !! largest value
      logical, intent(in), optional :: maximum_open !! the maximum itself is refused
      logical, intent(in), optional :: from_mesh    !! its default is found when the mesh is known
      type(law_parameter_t) :: parameter

      parameter%name = name
      parameter%units = units
      parameter%description = description
      parameter%required = .not. present(default_value)
      if (present(from_mesh)) parameter%required = parameter%required .and. .not. from_mesh
      if (.not. (present(default_value) .or. parameter%required)) parameter%default_value = ieee_value(1.0_wp, ieee_quiet_nan)
      parameter%minimum = ieee_value(1.0_wp, ieee_negative_inf)
      parameter%maximum = ieee_value(1.0_wp, ieee_positive_inf)
      if (present(default_value)) parameter%default_value = default_value
      if (present(minimum)) parameter%minimum = minimum
      if (present(minimum_open)) parameter%minimum_open = minimum_open
      if (present(maximum)) parameter%maximum = maximum
      if (present(maximum_open)) parameter%maximum_open = maximum_open
   end function law_parameter

   !> Whether a value, NaN, leaves a parameter to the mesh that may be left to it.
   elemental logical function is_left_open(parameter, value)
      type(law_parameter_t), intent(in) :: parameter
      real(wp), intent(in) :: value

      is_left_open = .not. parameter%required .and. ieee_is_nan(parameter%default_value) .and. ieee_is_nan(value)
   end function is_left_open

   !> Whether a value lies in the range; NaN and infinity never do.
   pure logical function accepts(parameter, value)
      type(law_parameter_t), intent(in) :: parameter
      real(wp), intent(in) :: value !! in parameter%units

      accepts = ieee_is_finite(value) .and. value >= parameter%minimum .and. value <= parameter%maximum &
                .and. (value > parameter%minimum .or. .not. parameter%minimum_open) &
                .and. (value < parameter%maximum .or. .not. parameter%maximum_open)
   end function accepts

   !> What is wrong with a value, such as "coefficient = -1.00000 N s/m must be at least 0"; "" if it is accepted.
   pure function parameter_range_error(parameter, value) result(text)
      type(law_parameter_t), intent(in) :: parameter !! what is accepted
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

end module evl_law_info
