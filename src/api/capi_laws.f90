!> C interface of the table of the force laws, and the damping law of a mesh.
!>
!> The header documents each procedure.
module evl_capi_laws
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_law_choice, c_law_info, c_max_parameters, parameter_to_c, to_c
   use evl_gearbox, only: gearbox_t
   use evl_law_info, only: law_info_t
   use evl_law_table, only: law_count, law_describe
   implicit none (type, external)
   private

   public :: evl_gearbox_damping, evl_law_count, evl_law_describe

contains

   integer(c_int) function evl_law_count(family) bind(c)
      integer(c_int), intent(in), value :: family

      evl_law_count = law_count(family)
   end function evl_law_count

   integer(c_int) function evl_law_describe(family, index, info) bind(c)
      integer(c_int), intent(in), value :: family, index
      type(c_law_info), intent(out) :: info
      type(law_info_t) :: law
      integer :: i

      call law_describe(family, index, law, evl_law_describe)
      call to_c(law%name, info%name)
      call to_c(law%description, info%description)
      call to_c(law%source, info%source)
      info%n_parameters = law%n_parameters
      do i = 1, c_max_parameters
         call parameter_to_c(law%parameters(i), info%parameters(i))
      end do
   end function evl_law_describe

   subroutine evl_gearbox_damping(handle, mesh, choice) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      type(c_law_choice), intent(out) :: choice
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      choice = c_law_choice(g%references(mesh + 1)%law%law, g%references(mesh + 1)%law%parameters)
   end subroutine evl_gearbox_damping

end module evl_capi_laws
