!> C interface of the table of outputs.
!>
!> The header's section "outputs" documents each procedure; here is only the passage from Fortran to C.
module evl_capi_outputs
   use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_name_length, c_text_length, to_c
   use evl_gearbox, only: gearbox_t
   use evl_output, only: output_t
   use evl_status, only: code_invalid_input, code_ok
   implicit none (type, external)
   private

   public :: evl_gearbox_output

   !> evl_output
   type, bind(c) :: c_output
      character(kind=c_char) :: name(c_name_length), units(c_name_length), symbol(c_name_length), long_name(c_text_length)
      integer(c_int) :: dims
      logical(c_bool) :: is_static, is_integer
      integer(c_int) :: offset, count
   end type c_output

contains

   integer(c_int) function evl_gearbox_output(handle, index, output) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: index
      type(c_output), intent(out) :: output
      type(gearbox_t), pointer :: g

      code = code_invalid_input
      call c_f_pointer(handle, g)
      if (index < 0 .or. index >= size(g%outputs)) return
      call output_to_c(g%outputs(index + 1), output)
      code = code_ok
   end function evl_gearbox_output

   pure subroutine output_to_c(entry, output)
      type(output_t), intent(in) :: entry
      type(c_output), intent(out) :: output

      call to_c(entry%name, output%name)
      call to_c(entry%units, output%units)
      call to_c(entry%symbol, output%symbol)
      call to_c(entry%long_name, output%long_name)
      output%dims = entry%dims
      output%is_static = logical(entry%is_static, c_bool)
      output%is_integer = logical(entry%is_integer, c_bool)
      output%offset = entry%offset
      output%count = entry%count
   end subroutine output_to_c

end module evl_capi_outputs
