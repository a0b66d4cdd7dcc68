!> The first wheel of a description, for calls about a single one.
module first_wheel_of
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_ptr
   use evl_parameter_view, only: description_t, parameter_view_t
   implicit none (type, external)
   private

   public :: first_wheel

contains

   !> Of a handle.
   type(parameter_view_t) function first_wheel(handle) result(wheel)
      type(c_ptr), intent(in) :: handle
      type(description_t), pointer :: d
      type(parameter_view_t) :: root
      type(parameter_view_t), allocatable :: wheels(:)

      call c_f_pointer(handle, d)
      call root%all_of(d)
      call root%elements("wheels", wheels)
      wheel = wheels(1)
   end function first_wheel

end module first_wheel_of
