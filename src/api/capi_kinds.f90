!> C interface of supports: which way one lets its axle move.
module evl_capi_kinds
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_ptr
   use evl_gearbox, only: gearbox_t
   implicit none (type, external)
   private

   public :: evl_gearbox_support_directions

contains

   integer(c_int) function evl_gearbox_support_directions(handle, wheel, directions) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel
      real(c_double), intent(out) :: directions(4)
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      associate (support => g%wheels(wheel + 1)%support)
         directions = [support%direction(:, 1), support%direction(:, 2)]
         evl_gearbox_support_directions = support%n
      end associate
   end function evl_gearbox_support_directions

end module evl_capi_kinds
