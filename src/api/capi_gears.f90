!> C interface of the real gears of a gearbox.
!>
!> The header documents each procedure; its structs are the kernel's types.
module evl_capi_gears
   use, intrinsic :: iso_c_binding, only: c_bool, c_f_pointer, c_int, c_ptr
   use evl_gear, only: gear_t
   use evl_gearbox, only: gearbox_t
   use evl_gears_in_mesh, only: gear_mesh_t
   use evl_mesh_stiffness, only: mesh_stiffness, mesh_stiffness_t
   implicit none (type, external)
   private

   public :: evl_gearbox_gear, evl_gearbox_gear_mesh, evl_gearbox_mesh_stiffness

contains

   logical(c_bool) function evl_gearbox_gear(handle, wheel, geometry) result(is_gear) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel
      type(gear_t), intent(out) :: geometry
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      geometry = g%gears(wheel + 1)
      is_gear = geometry%teeth > 0
   end function evl_gearbox_gear

   logical(c_bool) function evl_gearbox_gear_mesh(handle, mesh, geometry) result(is_mesh) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      type(gear_mesh_t), intent(out) :: geometry
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      geometry = g%gear_meshes(mesh + 1)
      is_mesh = geometry%exists
   end function evl_gearbox_gear_mesh

   logical(c_bool) function evl_gearbox_mesh_stiffness(handle, mesh, stiffness) result(gives_way) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      type(mesh_stiffness_t), intent(out) :: stiffness
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      call mesh_stiffness(g, mesh + 1, stiffness)
      gives_way = stiffness%line_load > 0
   end function evl_gearbox_mesh_stiffness

end module evl_capi_gears
