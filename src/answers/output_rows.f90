!> Rows that are told to be listed, with what they are and with their values.
!>
!> They stand apart from `evl_teller`, so that no compiler takes them into its quick path.
module evl_output_rows
   use evl_kinds, only: wp
   use evl_output, only: dims_mesh, dims_mesh_axis, dims_none, dims_quaternion, dims_space, dims_wheel, dims_wheel_axis, &
                         dims_wheel_space, output_t
   implicit none (type, external)
   private

   public :: output_rows, tell_row

   type :: output_rows
      integer :: n = 0                            !! rows told
      type(output_t), allocatable :: table(:)     !! the first n of these
      integer :: section = 0, of = dims_none      !! of the next row
      logical :: is_static = .false.              !! the same
   end type output_rows

contains

   !> The next row.
   pure subroutine tell_row(rows, name, units, symbol, text, value, is_integer)
      type(output_rows), intent(inout) :: rows
      character(len=*), intent(in) :: name, units, symbol, text
      real(wp), intent(in) :: value(:)
      logical, intent(in) :: is_integer

      if (.not. allocated(rows%table)) allocate (rows%table(64))
      if (rows%n == size(rows%table)) rows%table = [rows%table, rows%table]
      rows%n = rows%n + 1
      associate (row => rows%table(rows%n))
         row = output_t(name, units, symbol, text, dims_of(rows%of, size(value)), rows%is_static, is_integer, rows%section, &
                        rows%of, size(value))
         row%value(:row%length) = value
      end associate
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
