!> C interface of the tables of outputs.
!>
!> The header's section "outputs" documents each procedure; here is only the passage from Fortran to C.
module evl_capi_outputs
   use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_double, c_int, c_ptr
   use evl_capi_types, only: answer, c_name_length, c_status, c_text_length, gearbox_of, to_c
   use evl_gearbox, only: gearbox_t
   use evl_output, only: output_t
   use evl_output_list, only: list_extremes, list_outputs
   use evl_outputs, only: gearbox_outputs
   use evl_static_outputs, only: list_static
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: c_output, evl_gearbox_constants, evl_gearbox_output_places, evl_gearbox_outputs, evl_table
   public :: output_to_c

   !> evl_output
   type, bind(c) :: c_output
      character(kind=c_char) :: name(c_name_length), units(c_name_length), symbol(c_name_length), long_name(c_text_length)
      integer(c_int) :: dims
      logical(c_bool) :: is_static, is_integer, is_largest
      integer(c_int) :: watched, n
      real(c_double) :: value(2)
      character(kind=c_char) :: rate_of(c_name_length), no_rate(c_text_length)
   end type c_output

   integer, parameter :: of_static = 1, of_extremes = 2 !! evl_table_of

contains

   integer(c_int) function evl_table(of, most, outputs) result(n) bind(c)
      integer(c_int), intent(in), value :: of, most
      type(c_output), intent(out) :: outputs(most)
      type(output_t), allocatable :: table(:)

      select case (of)
      case (of_extremes)
         call list_extremes(table)
      case (of_static)
         call list_static(table)
      case default
         call list_outputs(table)
      end select
      n = size(table)
      call output_to_c(table(:min(n, most)), outputs(:min(n, most)))
   end function evl_table

   subroutine evl_gearbox_output_places(handle, offsets, counts) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(out) :: offsets(*), counts(*)
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      offsets(:size(g%output_offsets)) = g%output_offsets
      counts(:size(g%output_counts)) = g%output_counts
   end subroutine evl_gearbox_output_places

   subroutine evl_gearbox_constants(handle, values) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(out) :: values(*)
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      values(:g%n_values) = g%constants
   end subroutine evl_gearbox_constants

   integer(c_int) function evl_gearbox_outputs(handle, t, y, integers, reals, check, values, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in), value :: t
      real(c_double), intent(in) :: y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      logical(c_bool), intent(in), value :: check
      real(c_double), intent(inout) :: values(*)
      type(c_status), intent(inout), optional :: status
      type(status_t) :: s

      call gearbox_outputs(gearbox_of(handle), t, y, integers, reals, logical(check), values, s)
      code = answer(s, status)
   end function evl_gearbox_outputs

   elemental subroutine output_to_c(entry, output)
      type(output_t), intent(in) :: entry
      type(c_output), intent(out) :: output

      call to_c(entry%name, output%name)
      call to_c(entry%units, output%units)
      call to_c(entry%symbol, output%symbol)
      call to_c(entry%long_name, output%long_name)
      output%dims = entry%dims
      output%is_static = logical(entry%is_static, c_bool)
      output%is_integer = logical(entry%is_integer, c_bool)
      output%is_largest = logical(entry%is_largest, c_bool)
      output%watched = entry%watched - 1
      output%n = entry%length
      output%value = entry%value(:2)
      call to_c(entry%rate_of, output%rate_of)
      call to_c(entry%no_rate, output%no_rate)
   end subroutine output_to_c

end module evl_capi_outputs
