!> Where the entries of a Jacobian are kept: in a full matrix, or in a list of those that may differ from zero.
!>
!> Who adds to an entry names its row and column and need not know which.
module evl_jacobian_places
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: jacobian_places, full_matrix, listed_entries, entry_place, add_entry

   type :: jacobian_places
      integer :: n = 0                    !! rows, and columns
      integer :: n_entries = 0            !! how many are kept
      integer, allocatable :: list(:, :)  !! [n, n] (column, row): place in the list, 0 of what is zero; a full matrix has none
   end type jacobian_places

contains

   !> All entries, column after column.
   pure subroutine full_matrix(n, places)
      integer, intent(in) :: n !! rows
      type(jacobian_places), intent(out) :: places

      places%n = n
      places%n_entries = n**2
   end subroutine full_matrix

   !> Some entries in a given order.
   pure subroutine listed_entries(n, rows, columns, places)
      integer, intent(in) :: n                  !! rows of the matrix
      integer, intent(in) :: rows(:), columns(:) !! of each entry; none is there twice
      type(jacobian_places), intent(out) :: places
      integer :: i

      places%n = n
      places%n_entries = size(rows)
      allocate (places%list(n, n), source=0)
      do i = 1, size(rows)
         places%list(columns(i), rows(i)) = i
      end do
   end subroutine listed_entries

   !> Place of an entry; 0 if it is zero and not kept.
   pure integer function entry_place(places, row, column) result(place)
      type(jacobian_places), intent(in) :: places
      integer, intent(in) :: row, column

      if (allocated(places%list)) then
         place = places%list(column, row)
      else
         place = row + (column - 1)*places%n
      end if
   end function entry_place

   !> Add to an entry that is kept.
   pure subroutine add_entry(places, row, column, amount, values)
      type(jacobian_places), intent(in) :: places
      integer, intent(in) :: row, column
      real(wp), intent(in) :: amount
      real(wp), intent(inout) :: values(places%n_entries)
      integer :: place

      place = entry_place(places, row, column)
      values(place) = values(place) + amount
   end subroutine add_entry

end module evl_jacobian_places
