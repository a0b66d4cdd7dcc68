!> C interface of the damping law of a mesh.
!>
!> The header documents each procedure.
module evl_capi_laws
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_law_choice
   use evl_gearbox, only: gearbox_t
   implicit none (type, external)
   private

   public :: evl_gearbox_damping

contains

   subroutine evl_gearbox_damping(handle, mesh, choice) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      type(c_law_choice), intent(out) :: choice
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      choice = c_law_choice(g%references(mesh + 1)%law%law, g%references(mesh + 1)%law%parameters)
   end subroutine evl_gearbox_damping

end module evl_capi_laws
