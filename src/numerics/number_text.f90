!> Text of numbers in messages.
module evl_number_text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: number_length, quantity_length, write_integer, write_number

   integer, parameter :: number_length = 32 !! largest number of characters of a number

contains

   !> Length of the text of a quantity.
   pure integer function quantity_length(value, unit) result(length)
      real(wp), intent(in) :: value
      character(len=*), intent(in) :: unit
      character(len=number_length) :: number

      call write_number(value, number, length)
      if (len(unit) > 0) length = length + 1 + len(unit)
   end function quantity_length

   !> Digits of an integer >= 0, left-aligned in a text that is long enough. No internal write: the runtime library would
   !> allocate memory for it and, on failure, end the program with its own message.
   pure subroutine write_integer(number, text)
      integer, intent(in) :: number
      character(len=*), intent(out) :: text
      integer :: rest

      text = ""
      rest = number
      do
         text = achar(iachar("0") + mod(rest, 10))//text(:len(text) - 1)
         rest = rest/10
         if (rest == 0) exit
      end do
   end subroutine write_integer

   !> Write a number with six significant digits, without trailing zeros.
   pure subroutine write_number(value, number, length)
      real(wp), intent(in) :: value
      character(len=number_length), intent(out) :: number
      integer, intent(out) :: length
      character(len=number_length) :: form
      integer :: decimals, last, e

      if (.not. abs(value) > 0 .and. .not. abs(value) < 0) then
         number = "0"
         if (ieee_is_nan(value)) number = "NaN"
      else if (abs(value) >= 1.0e-3_wp .and. abs(value) < 1.0e6_wp) then
         decimals = max(0, 5 - floor(log10(abs(value))))
         write (form, "(a, i0, a)") "(f32.", decimals, ")"
         write (number, form) value
      else
         write (number, "(es32.5e3)") value
      end if
      number = adjustl(number)
      e = index(number, "E")
      if (e == 0) then
         e = len_trim(number) + 1
      else if (number(e + 2:e + 2) == "0") then ! two digits where these are sufficient
         number = number(:e + 1)//number(e + 3:)
      end if
      if (index(number(:e - 1), ".") > 0) then
         last = verify(number(:e - 1), "0", back=.true.)
         if (number(last:last) == ".") last = last - 1
         number = number(:last)//number(e:)
      end if
      length = len_trim(number)
   end subroutine write_number

end module evl_number_text
