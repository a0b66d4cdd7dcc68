!> C interface of the data sheet of a mesh and of its drawing. The header documents each procedure.
module evl_capi_datasheet
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_ptr
   use evl_capi_types, only: c_name_length, c_text_length, gearbox_of, to_c
   use evl_datasheet, only: datasheet_of
   use evl_datasheet_rows, only: note_length, sheet_row_t
   use evl_mesh_picture, only: mesh_outline, mesh_picture, mesh_picture_t
   implicit none (type, external)
   private

   public :: evl_gearbox_datasheet, evl_gearbox_mesh_outline, evl_gearbox_mesh_picture

   !> evl_sheet_row
   type, bind(c) :: c_sheet_row
      character(kind=c_char) :: section(c_name_length), key(c_name_length), symbol(c_name_length), unit(c_name_length)
      character(kind=c_char) :: text(c_text_length), note(note_length) ! EVL_NOTE_LENGTH
      integer(c_int) :: n
      real(c_double) :: value(2)
   end type c_sheet_row

contains

   integer(c_int) function evl_gearbox_datasheet(handle, mesh, most, rows) result(n) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh, most
      type(c_sheet_row), intent(inout) :: rows(*)
      type(sheet_row_t), allocatable :: sheet(:)
      integer :: i

      call datasheet_of(gearbox_of(handle), mesh + 1, sheet)
      n = size(sheet)
      do i = 1, min(n, most)
         call to_c(sheet(i)%section, rows(i)%section)
         call to_c(sheet(i)%key, rows(i)%key)
         call to_c(sheet(i)%symbol, rows(i)%symbol)
         call to_c(sheet(i)%unit, rows(i)%unit)
         call to_c(sheet(i)%text, rows(i)%text)
         call to_c(sheet(i)%note, rows(i)%note)
         rows(i)%n = sheet(i)%n
         rows(i)%value = sheet(i)%value
      end do
   end function evl_gearbox_datasheet

   subroutine evl_gearbox_mesh_picture(handle, mesh, picture) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      type(mesh_picture_t), intent(out) :: picture

      picture = mesh_picture(gearbox_of(handle), mesh + 1)
   end subroutine evl_gearbox_mesh_picture

   integer(c_int) function evl_gearbox_mesh_outline(handle, mesh, driven, teeth, most, points) result(n) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh, driven, teeth, most
      real(c_double), intent(inout) :: points(2, *)
      real(c_double), allocatable :: found(:, :)

      call mesh_outline(gearbox_of(handle), mesh + 1, driven + 1, int(teeth), found)
      n = size(found, 2)
      points(:, :min(n, most)) = found(:, :min(n, most))
   end function evl_gearbox_mesh_outline

end module evl_capi_datasheet
