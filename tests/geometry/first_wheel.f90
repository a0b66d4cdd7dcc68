!> The first wheel of a description, for calls about a single one.
module first_wheel_of
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_ptr
   use evl_given, only: description_t, given_t
   implicit none (type, external)
   private

   public :: first_wheel

contains

   !> Of a handle.
   type(given_t) function first_wheel(handle) result(wheel)
      type(c_ptr), intent(in) :: handle
      type(description_t), pointer :: d
      type(given_t) :: root
      type(given_t), allocatable :: wheels(:)

      call c_f_pointer(handle, d)
      call root%all_of(d)
      call root%elements("wheels", wheels)
      wheel = wheels(1)
   end function first_wheel

end module first_wheel_of
