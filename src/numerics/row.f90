!> Rows of the parameter schema: keys of a case, and the check of their numbers.
!>
!> A row is a key of a block of the case file: its type, unit, range, plausible range, default and text. Each range is defined
!> only here: the case file's schema, its errors and warnings, `evolvent show --keys` and the tables of the documentation are
!> generated from the rows.
module evl_row
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan, ieee_quiet_nan, ieee_value
   use evl_kinds, only: wp
   use evl_status, only: message_length, quantity
   implicit none (type, external)
   private

   public :: at_least, between, has_default, is_left_open, join_words, kind_t, not_negative, parameter_row, positive, read_default
   public :: is_in_range, range_error, range_t, row_t, short_length, span_t, text_length
   public :: type_at_knots, type_block, type_choice, type_integer, type_knots, type_list, type_map, type_name, type_named
   public :: type_number, type_pair, type_quaternion, type_reference, type_references, type_series, type_text, type_triple
   public :: type_size

   integer, parameter :: short_length = 31 !! characters of a key, a block or a unit; EVL_SHORT_LENGTH without the NUL
   integer, parameter :: text_length = 255 !! characters of a text; EVL_ROW_TEXT_LENGTH without the NUL

   ! evl_row_type of the C header
   integer, parameter :: type_number = 0      !! a number in the range, or one of the words
   integer, parameter :: type_integer = 1     !! a whole number in the range
   integer, parameter :: type_pair = 2        !! [x, y], both in the range
   integer, parameter :: type_triple = 3      !! [x, y, z], all in the range
   integer, parameter :: type_quaternion = 4  !! [w, x, y, z], all in the range
   integer, parameter :: type_series = 5      !! a list of numbers
   integer, parameter :: type_knots = 6       !! knots of a table, strictly increasing, at least two
   integer, parameter :: type_at_knots = 7    !! as many numbers as the block has knots
   integer, parameter :: type_named = 8       !! name: number, for each name
   integer, parameter :: type_text = 9        !! any text
   integer, parameter :: type_name = 10       !! a word that names this block in paths and references
   integer, parameter :: type_reference = 11  !! the name of an element of `holds`
   integer, parameter :: type_references = 12 !! [name, name] of two of them
   integer, parameter :: type_choice = 13     !! one of the words
   integer, parameter :: type_block = 14      !! keys of the block `holds`
   integer, parameter :: type_list = 15       !! a list of blocks `holds`; the range limits their number
   integer, parameter :: type_map = 16        !! name: block `holds`; the range limits their number

   !> Faults of a number.
   enum, bind(c)
      enumerator :: fault_none = 0, fault_infinite, fault_small, fault_large, fault_fraction
   end enum

   !> Range of accepted numbers: finite ones from minimum to maximum.
   type :: range_t
      real(wp) :: minimum = -huge(1.0_wp) !! -huge: unbounded
      real(wp) :: maximum = huge(1.0_wp)  !! +huge: unbounded
      logical :: minimum_open = .false.   !! the limit itself is refused
      logical :: maximum_open = .false.
   end type range_t

   !> Plausible magnitudes of a number: from least to most, or 0. Others are accepted with a warning, since the unit is
   !> probably wrong. least = 0: no lower limit; most = 0: the row has no plausible range.
   type :: span_t
      real(wp) :: least = 0.0_wp
      real(wp) :: most = 0.0_wp
   end type span_t

   type(range_t), parameter :: positive = range_t(minimum=0.0_wp, minimum_open=.true.)
   type(range_t), parameter :: not_negative = range_t(minimum=0.0_wp)

   !> One key of a block.
   type :: row_t
      character(len=short_length) :: key = ""
      integer :: type = type_number
      character(len=short_length) :: unit = ""         !! of the numbers in the case file; "" if there is none
      character(len=text_length) :: text = ""          !! meaning, one line
      type(range_t) :: range = range_t()
      logical :: required = .false.
      character(len=2*short_length) :: default = "" !! YAML; "" if there is none: the key stays absent. {driving}: value of that key
      character(len=text_length) :: words = ""         !! of a choice, or alternatives to a number; separated by blanks
      character(len=short_length) :: holds = ""        !! block type of a block, list or map; block type that a reference refers to
      character(len=text_length) :: variants = ""      !! values of the block's first key with which it is allowed; "" for all;
                                                       !! "+KEY": allowed only together with that key; "-KEY": not together
                                                       !! with it
      type(span_t) :: plausible = span_t()             !! in `unit`; every row with a unit states it
      ! set where all rows are collected
      character(len=short_length) :: block = ""        !! block that contains it
      integer :: first_held = 0                        !! index of the first row of the block that it holds; 0: it holds none
      real(wp) :: defaults(4) = 0.0_wp                 !! numbers of the default
      integer :: n_defaults = 0                        !! their number
   end type row_t

   !> One of the kinds of a block, such as a law, a load or a support.
   type :: kind_t
      character(len=short_length) :: name = ""   !! as in the case file
      character(len=text_length) :: text = ""    !! one line
      character(len=text_length) :: source = ""  !! reference; "" if there is none
      type(row_t), allocatable :: rows(:)        !! its own rows, in their order
   end type kind_t

contains

   !> Range with a lower limit.
   pure type(range_t) function at_least(minimum) result(range)
      real(wp), intent(in) :: minimum

      range = range_t(minimum=minimum)
   end function at_least

   pure type(range_t) function between(minimum, maximum) result(range)
      real(wp), intent(in) :: minimum, maximum

      range = range_t(minimum, maximum)
   end function between

   !> A number of a law, load or support: required unless it has a default or may be left open.
   pure type(row_t) function parameter_row(key, unit, text, range, default, left_open, type, plausible) result(row)
      character(len=*), intent(in) :: key, unit, text
      type(range_t), intent(in), optional :: range       !! any number if absent
      character(len=*), intent(in), optional :: default
      logical, intent(in), optional :: left_open         !! it may be absent, without a default
      integer, intent(in), optional :: type              !! a number if absent
      type(span_t), intent(in), optional :: plausible    !! none if absent

      row%key = key
      row%unit = unit
      row%text = text
      row%required = .not. present(default)
      if (present(range)) row%range = range
      if (present(default)) row%default = default
      if (present(left_open)) row%required = row%required .and. .not. left_open
      if (present(type)) row%type = type
      if (present(plausible)) row%plausible = plausible
   end function parameter_row

   !> Read the numbers of a default, such as 20 or [1, 0, 0, 0].
   pure subroutine read_default(row)
      type(row_t), intent(inout) :: row
      integer :: first, k, length

      row%n_defaults = merge(max(type_size(row%type), 0), 0, has_default(row))
      first = 1
      do k = 1, row%n_defaults
         first = first + verify(row%default(first:), "[], ") - 1
         length = scan(row%default(first:), "[], ") - 1
         row%defaults(k) = number_of(row%default(first:first + length - 1))
         first = first + length
      end do
   end subroutine read_default

   !> Number in the text of a default, 1.25 or 1e-9; NaN if there is none. Its digits form an integer below 2**53 and its
   !> power of ten is at most 1e22: both are exact, so that the result is rounded once. No internal read: the runtime library
   !> would allocate memory for it and, on failure, end the program with its own message.
   pure real(wp) function number_of(text) result(number)
      character(len=*), intent(in) :: text
      character(len=*), parameter :: digits = "0123456789"
      integer :: exponent, k, point, stop

      number = ieee_value(number, ieee_quiet_nan)
      stop = scan(text//"e", "eE") - 1
      if (verify(text(:stop), digits//".") > 0 .or. scan(text(:stop), digits) == 0) return
      point = index(text(:stop)//".", ".")
      exponent = 0
      do k = stop + 2, len(text)
         if (scan(text(k:k), digits) > 0) exponent = 10*exponent + index(digits, text(k:k)) - 1
      end do
      if (index(text(stop + 1:), "-") > 0) exponent = -exponent
      exponent = exponent - max(stop - point, 0)
      number = 0
      do k = 1, stop
         if (k /= point) number = 10*number + (index(digits, text(k:k)) - 1)
      end do
      number = merge(number*10.0_wp**max(exponent, 0), number/10.0_wp**max(-exponent, 0), exponent > 0)
   end function number_of

   !> Whether a row that is not given has a default value.
   elemental logical function has_default(row)
      type(row_t), intent(in) :: row

      has_default = row%default /= ""
   end function has_default

   !> Whether a value, NaN, leaves a row open that may be left open.
   elemental logical function is_left_open(row, value)
      type(row_t), intent(in) :: row
      real(wp), intent(in) :: value

      is_left_open = .not. (row%required .or. has_default(row)) .and. ieee_is_nan(value)
   end function is_left_open

   !> Number of numbers in a value of a type; 0 if none, -1 if arbitrary.
   elemental integer function type_size(type) result(n)
      integer, intent(in) :: type

      select case (type)
      case (type_number, type_integer)
         n = 1
      case (type_pair)
         n = 2
      case (type_triple)
         n = 3
      case (type_quaternion)
         n = 4
      case (type_series, type_knots, type_at_knots, type_named)
         n = -1
      case default
         n = 0
      end select
   end function type_size

   !> Join words, or texts, to one text.
   pure subroutine join_words(words, separator, all)
      character(len=*), intent(in) :: words(:), separator
      character(len=*), intent(out) :: all
      integer :: i

      all = words(1)
      do i = 2, size(words)
         all = trim(all)//separator//words(i)
      end do
   end subroutine join_words

   !> Whether a number is in the range of its key; called for up to a million numbers of a table.
   pure logical function is_in_range(row, value)
      type(row_t), intent(in) :: row
      real(wp), intent(in) :: value !! in row%unit

      is_in_range = fault_of(row, value) == fault_none
   end function is_in_range

   pure integer function fault_of(row, value) result(fault)
      type(row_t), intent(in) :: row
      real(wp), intent(in) :: value

      fault = fault_none
      associate (range => row%range)
         if (.not. ieee_is_finite(value)) then
            fault = fault_infinite
         else if (value < range%minimum .or. (range%minimum_open .and. value <= range%minimum)) then
            fault = fault_small
         else if (value > range%maximum .or. (range%maximum_open .and. value >= range%maximum)) then
            fault = fault_large
         else if (row%type == type_integer .and. abs(value - anint(value)) > 0) then
            fault = fault_fraction
         end if
      end associate
   end function fault_of

   !> Error text for a number out of its range, such as "coefficient = -1.00000 N s/m must be at least 0"; "" if it is in range.
   pure function range_error(row, value) result(text)
      type(row_t), intent(in) :: row
      real(wp), intent(in) :: value !! in row%unit
      character(len=message_length) :: text

      associate (range => row%range)
         select case (fault_of(row, value))
         case (fault_infinite)
            text = "a finite number"
         case (fault_small)
            text = trim(merge("greater than", "at least    ", range%minimum_open))//" "//quantity(range%minimum, trim(row%unit))
         case (fault_large)
            text = trim(merge("less than", "at most  ", range%maximum_open))//" "//quantity(range%maximum, trim(row%unit))
         case (fault_fraction)
            text = "a whole number"
         case default
            text = ""
            return
         end select
      end associate
      text = trim(row%key)//" = "//quantity(value, trim(row%unit))//" must be "//text
   end function range_error

end module evl_row
