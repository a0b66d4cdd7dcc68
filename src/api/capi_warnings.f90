!> C interface of the warnings.
!>
!> The header documents each procedure; here is only the passage from C to Fortran.
module evl_capi_warnings
   use, intrinsic :: iso_c_binding, only: c_bool, c_int, c_ptr
   use evl_capi_description, only: c_initial, initial_from_c
   use evl_capi_types, only: c_status, gearbox_of, status_to_c
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_initial, only: gearbox_initial_speeds
   use evl_gearbox_warnings, only: warn_of_speeds
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: evl_gearbox_speed_warning, evl_gearbox_warning

contains

   logical(c_bool) function evl_gearbox_warning(handle, index, warning) result(exists) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: index
      type(c_status), intent(out) :: warning
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      exists = logical(index >= 0 .and. index < size(g%warnings), c_bool)
      if (exists) then
         call status_to_c(g%warnings(index + 1), warning)
      else
         call status_to_c(status_t(), warning)
      end if
   end function evl_gearbox_warning

   logical(c_bool) function evl_gearbox_speed_warning(handle, initial, warning) result(exists) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(c_initial), intent(in) :: initial
      type(c_status), intent(out) :: warning
      type(gearbox_t), pointer :: g
      type(status_t), allocatable :: warnings(:)

      g => gearbox_of(handle)
      allocate (warnings(0))
      call warn_of_speeds(g, gearbox_initial_speeds(g, initial_from_c(initial, size(g%wheels), size(g%pairs))), warnings)
      exists = logical(size(warnings) > 0, c_bool)
      call status_to_c(status_t(), warning)
      if (exists) call status_to_c(warnings(1), warning)
   end function evl_gearbox_speed_warning

end module evl_capi_warnings
