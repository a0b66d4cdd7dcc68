!> Where the entries of a Jacobian are kept: in a full matrix, or in a list of those that may differ from zero. Who adds to them
!> has marked these before.
!>
!> Who adds to an entry names its row and column and need not know which.
module evl_jacobian_entries
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: jacobian_entries, add_entry, apply_entries, entry_index, full_matrix, listed_entries

   type :: jacobian_entries
      integer :: n = 0                    !! rows, and columns
      integer :: n_entries = 0            !! how many are kept
      logical :: marks = .false.          !! whether adding to an entry only marks it
      integer, allocatable :: list(:, :)  !! [n, n] (column, row): index in the list, 0 of what is zero; a full matrix has none
   end type jacobian_entries

contains

   !> All entries, column after column.
   pure subroutine full_matrix(n, entries)
      integer, intent(in) :: n !! rows
      type(jacobian_entries), intent(out) :: entries

      entries%n = n
      entries%n_entries = n**2
   end subroutine full_matrix

   !> Some entries in a given order.
   pure subroutine listed_entries(n, rows, columns, entries)
      integer, intent(in) :: n                  !! rows of the matrix
      integer, intent(in) :: rows(:), columns(:) !! of each entry; none is there twice
      type(jacobian_entries), intent(out) :: entries
      integer :: i

      entries%n = n
      entries%n_entries = size(rows)
      allocate (entries%list(n, n), source=0)
      do i = 1, size(rows)
         entries%list(columns(i), rows(i)) = i
      end do
   end subroutine listed_entries

   !> Index of an entry; 0 if it is zero and not kept.
   pure integer function entry_index(entries, row, column) result(index)
      type(jacobian_entries), intent(in) :: entries
      integer, intent(in) :: row, column

      if (allocated(entries%list)) then
         index = entries%list(column, row)
      else
         index = row + (column - 1)*entries%n
      end if
   end function entry_index

   !> Add to an entry that is kept.
   pure subroutine add_entry(entries, row, column, amount, values)
      type(jacobian_entries), intent(in) :: entries
      integer, intent(in) :: row, column
      real(wp), intent(in) :: amount
      real(wp), intent(inout) :: values(entries%n_entries)
      integer :: index

      index = entry_index(entries, row, column)
      if (entries%marks) then
         values(index) = 1
      else
         values(index) = values(index) + amount
      end if
   end subroutine add_entry

   !> y = J x of a list of entries; arrays of known shape, so that no descriptor is looked at.
   pure subroutine apply_entries(n, entries, row, column, jacobian, x, y)
      integer, intent(in) :: n, entries
      integer, intent(in) :: row(entries), column(entries)
      real(wp), intent(in) :: jacobian(entries)
      real(wp), intent(in) :: x(n)
      real(wp), intent(out) :: y(n)
      integer :: p

      y = 0
      do p = 1, entries
         y(row(p)) = y(row(p)) + jacobian(p)*x(column(p))
      end do
   end subroutine apply_entries

end module evl_jacobian_entries
