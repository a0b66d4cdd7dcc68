!> C interface of the table of outputs.
!>
!> The header's section "outputs" documents each procedure; here is only the passage from Fortran to C.
module evl_capi_outputs
   use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_name_length, c_text_length, to_c
   use evl_gearbox, only: gearbox_t
   use evl_output, only: output_t
   use evl_outputs, only: n_outputs, output_table
   use evl_status, only: code_invalid_input, code_ok
   implicit none (type, external)
   private

   public :: evl_output_count, evl_output_describe, evl_gearbox_output_places

   !> evl_output
   type, bind(c) :: c_output
      character(kind=c_char) :: name(c_name_length), units(c_name_length), symbol(c_name_length), long_name(c_text_length)
      integer(c_int) :: dims
      logical(c_bool) :: is_static, is_integer
   end type c_output

contains

   integer(c_int) function evl_output_count() result(count) bind(c)
      count = n_outputs
   end function evl_output_count

   integer(c_int) function evl_output_describe(index, output) result(code) bind(c)
      integer(c_int), intent(in), value :: index
      type(c_output), intent(out) :: output
      type(output_t) :: table(n_outputs)

      code = code_invalid_input
      if (index < 0 .or. index >= n_outputs) return
      table = output_table()
      call output_to_c(table(index + 1), output)
      code = code_ok
   end function evl_output_describe

   subroutine evl_gearbox_output_places(handle, offsets, counts) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(out) :: offsets(n_outputs), counts(n_outputs)
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      offsets = g%output_offsets
      counts = g%output_counts
   end subroutine evl_gearbox_output_places

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
   end subroutine output_to_c

end module evl_capi_outputs
