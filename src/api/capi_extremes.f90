!> C interface of the watched outputs and of the table of their extremes.
!>
!> The header's section "extremes" documents each procedure; here is only the passage from Fortran to C.
module evl_capi_extremes
   use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_double, c_int, c_ptr
   use evl_capi_types, only: answer, c_name_length, c_status, c_text_length, gearbox_of, to_c
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_watch, only: extremes_table, n_kept, n_watched_outputs, watched_at
   use evl_output, only: output_t
   use evl_output_list, only: list_outputs
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: evl_extreme_count, evl_extremes_describe, evl_gearbox_roots_and_watched, evl_gearbox_watch_room, &
             evl_gearbox_watched, evl_watched_count

   !> evl_extreme
   type, bind(c) :: c_extreme
      character(kind=c_char) :: output(c_name_length), units(c_name_length), symbol(c_name_length), long_name(c_text_length)
      integer(c_int) :: watched
      logical(c_bool) :: is_largest
   end type c_extreme

contains

   integer(c_int) function evl_extreme_count() result(count) bind(c)
      count = size(extremes_table)
   end function evl_extreme_count

   subroutine evl_extremes_describe(extremes) bind(c)
      type(c_extreme), intent(out) :: extremes(*)
      type(output_t), allocatable :: outputs(:)
      integer :: i

      call list_outputs(outputs)
      do i = 1, size(extremes_table)
         associate (entry => extremes_table(i), extreme => extremes(i), &
                    output => outputs(findloc(outputs%name, extremes_table(i)%output, dim=1)))
            call to_c(entry%output, extreme%output)
            call to_c(output%units, extreme%units)
            call to_c(output%symbol, extreme%symbol)
            call to_c(entry%long_name, extreme%long_name)
            extreme%watched = entry%watched - 1
            extreme%is_largest = logical(entry%is_largest, c_bool)
         end associate
      end do
   end subroutine evl_extremes_describe

   integer(c_int) function evl_watched_count() result(count) bind(c)
      count = n_watched_outputs
   end function evl_watched_count

   integer(c_int) function evl_gearbox_watched(handle, y, integers, reals, values, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(inout) :: values(*)
      type(c_status), intent(inout), optional :: status
      type(status_t) :: s

      call watched_at(gearbox_of(handle), y, integers, reals, values, s)
      code = answer(s, status)
   end function evl_gearbox_watched

   integer(c_int) function evl_gearbox_watch_room(handle) result(n) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      n = n_kept*size(g%contacts)
   end function evl_gearbox_watch_room

   integer(c_int) function evl_gearbox_roots_and_watched(handle, y, integers, reals, near, highest, kept, roots, values, status) &
      result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: y(*), reals(*), highest(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(in), value :: near
      real(c_double), intent(inout) :: kept(n_kept, *), roots(*), values(*)
      type(c_status), intent(inout), optional :: status
      type(status_t) :: s

      call watched_at(gearbox_of(handle), y, integers, reals, values, s, roots, near, highest, kept)
      code = answer(s, status)
   end function evl_gearbox_roots_and_watched

end module evl_capi_extremes
