!> Rows of a data sheet, and the list that collects them.
module evl_datasheet_rows
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use evl_kinds, only: nan, wp
   implicit none (type, external)
   private

   public :: add_row, sheet_row_t, sheet_t

   character(len=*), parameter, public :: no_rack = "not defined: a gear without basic rack"
   character(len=*), parameter, public :: no_load = "no nominal load of this mesh"
   integer, parameter, public :: note_length = 160

   !> A row of the sheet.
   type :: sheet_row_t
      character(len=32) :: section = "", key = "", symbol = "", unit = "" !! unit: UDUNITS; "1" if dimensionless
      character(len=96) :: text = ""
      character(len=note_length) :: note = "" !! reason of a NaN, source or assumption; blank if none
      integer :: n = 1                        !! number of values: 2, one per gear; 1, of the mesh
      real(wp) :: value(2) = nan
   end type sheet_row_t

   !> The rows added so far, and the section of the next one.
   type :: sheet_t
      character(len=32) :: section = ""
      integer :: n = 0
      type(sheet_row_t), allocatable :: rows(:)
   end type sheet_t

contains

   !> Add a row. The note of a row with a NaN is the reason, if there is one.
   subroutine add_row(to, key, symbol, unit, text, value, note, reason)
      type(sheet_t), intent(inout) :: to
      character(len=*), intent(in) :: key, symbol, unit, text
      real(wp), intent(in) :: value(:)
      character(len=*), intent(in), optional :: note, reason

      to%n = to%n + 1
      associate (row => to%rows(to%n))
         row%section = to%section
         row%key = key
         row%symbol = symbol
         row%unit = unit
         row%text = text
         row%n = size(value)
         row%value(:size(value)) = value
         if (present(note)) row%note = note
         if (present(reason) .and. any(ieee_is_nan(value))) row%note = reason
      end associate
   end subroutine add_row

end module evl_datasheet_rows
