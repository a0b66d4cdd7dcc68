!> What one output of a gearbox is.
module evl_output
   implicit none (type, external)
   private

   public :: output_t
   public :: dims_none, dims_wheel, dims_mesh, dims_wheel_axis, dims_mesh_axis, dims_space, dims_quaternion, dims_wheel_space
   public :: dims_mesh_pair, dims_shaft

   integer, parameter :: dims_none = 0, dims_wheel = 1, dims_mesh = 2, dims_wheel_axis = 3, dims_mesh_axis = 4
   integer, parameter :: dims_space = 5       !! x, y, z
   integer, parameter :: dims_quaternion = 6  !! w, x, y, z
   integer, parameter :: dims_wheel_space = 7 !! x, y, z of every wheel
   integer, parameter :: dims_mesh_pair = 8   !! every place for a tooth pair of every mesh
   integer, parameter :: dims_shaft = 9       !! every shaft

   !> One output; see `evl_output` in the C header.
   type :: output_t
      character(len=31) :: name = "", units = "", symbol = ""
      character(len=95) :: long_name = ""
      integer :: dims = dims_none
      logical :: is_static = .false., is_integer = .false.
   end type output_t

end module evl_output
