!> Numbers as messages show them, as a C function, for tests; no part of the kernel's interface.
module number_text_calls
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int
   use evl_status, only: quantity
   implicit none (type, external)
   private

   public :: st_quantity

contains

   !> A number with the unit "N" into a text of 64 characters; its length.
   integer(c_int) function st_quantity(value, text) result(n) bind(c)
      real(c_double), value :: value
      character(kind=c_char), intent(out) :: text(64)
      character(len=64) :: words
      integer :: i

      words = quantity(value, "N")
      n = len_trim(words)
      do i = 1, n
         text(i) = words(i:i)
      end do
   end function st_quantity

end module number_text_calls
