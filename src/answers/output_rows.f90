!> Rows of outputs where not all values are wanted, or none: some values, or entries of the table.
!>
!> They stand apart from `evl_teller`, so that no compiler takes them into its quick path.
module evl_output_rows
   use evl_kinds, only: wp
   use evl_output, only: dims_mesh, dims_mesh_axis, dims_none, dims_quaternion, dims_space, dims_wheel, dims_wheel_axis, &
                         dims_wheel_space, needs_nothing, output_t
   implicit none (type, external)
   private

   public :: output_rows, tell_row

   type :: output_rows
      integer :: row = 0     !! told last
      integer :: element = 0 !! of its section, from 0
      real(wp), pointer, contiguous :: values(:) => null() !! none: rows are listed
      integer, pointer, contiguous :: indices(:) => null()  !! [rows] of outputs among these, from 0; -1: not wanted
      type(output_t), pointer, contiguous :: table(:) => null() !! listed rows
      integer :: section = 0, of = dims_none, needs = needs_nothing !! of the next row
      logical :: is_static = .false.                                !! the same
   end type output_rows

contains

   !> The next row: its value if it is wanted, or its entry of the table.
   pure subroutine tell_row(rows, name, units, symbol, text, value, is_integer)
      type(output_rows), intent(inout) :: rows
      character(len=*), intent(in) :: name, units, symbol, text
      real(wp), intent(in) :: value(:)
      logical, intent(in) :: is_integer
      integer :: at

      rows%row = rows%row + 1
      if (associated(rows%values)) then
         if (rows%indices(rows%row) < 0) return
         at = rows%indices(rows%row) + size(value)*rows%element
         rows%values(at + 1:at + size(value)) = value
         return
      end if
      if (rows%row > size(rows%table)) return
      rows%table(rows%row) = output_t(name, units, symbol, text, dims_of(rows%of, size(value)), rows%is_static, is_integer, &
                                      rows%section, rows%needs, rows%of, size(value))
   end subroutine tell_row

   !> The dimensions of vectors where numbers have these; -1 if there are none.
   pure integer function dims_of(of, length) result(dims)
      integer, intent(in) :: of, length

      dims = -1
      if (length == 1) dims = of
      if (length == 2 .and. of == dims_wheel) dims = dims_wheel_axis
      if (length == 2 .and. of == dims_mesh) dims = dims_mesh_axis
      if (length == 3 .and. of == dims_wheel) dims = dims_wheel_space
      if (length == 3 .and. of == dims_none) dims = dims_space
      if (length == 4 .and. of == dims_none) dims = dims_quaternion
   end function dims_of

end module evl_output_rows
