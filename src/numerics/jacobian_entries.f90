!> Storage of the entries of a Jacobian: a full matrix, or a list of the entries that may differ from zero, recorded beforehand.
!>
!> Code that adds to an entry passes its row and column and does not depend on the storage. In a list every row has a hash
!> table, indexed by the last bits of the column, as many as distinguish the columns of that row. Entries are thus found
!> without a search, and the tables grow in proportion to the list.
!>
!> The code that adds to the entries also records and counts them. If the buffer was too small, recording is repeated with the
!> required size.
module evl_jacobian_entries
   use evl_indices, only: indices
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: jacobian_entries, add_entry, add_row, apply_entries, clear_row, full_matrix, listed_entries
   public :: n_noted, note_entries, sort_entries, take_noted

   type :: jacobian_entries
      integer :: n = 0                    !! rows, and columns
      integer :: n_entries = 0            !! number of stored entries
      logical :: notes = .false.          !! adding to an entry only records its row and column
      ! only of a list
      integer, allocatable :: start(:)    !! [n + 1] first entry of each row in the following arrays
      integer, allocatable :: columns(:), indices(:) !! [n_entries] row after row, by columns; their indices in the list
      integer, allocatable :: before(:)   !! [n] first index of the table of each row
      integer, allocatable :: mask(:)     !! [n] mask of the bits of a column that count there
      integer, allocatable :: table(:)    !! index in the list of the entry with these bits
   end type jacobian_entries

contains

   !> Full matrix, stored column after column.
   pure subroutine full_matrix(n, entries)
      integer, intent(in) :: n !! rows
      type(jacobian_entries), intent(out) :: entries

      entries%n = n
      entries%n_entries = n**2
   end subroutine full_matrix

   !> List of some entries in a given order.
   pure subroutine listed_entries(n, rows, columns, entries)
      integer, intent(in) :: n                  !! rows of the matrix
      integer, intent(in) :: rows(:), columns(:) !! of each entry; no duplicates
      type(jacobian_entries), intent(out) :: entries
      integer, allocatable :: order(:)
      integer :: i, p

      entries%n = n
      entries%n_entries = size(rows)
      allocate (order, source=[(i, i=1, size(rows))])
      call sort_by(n, columns, order)
      call sort_by(n, rows, order)
      allocate (entries%start(n + 1), entries%before(n), entries%mask(n))
      entries%indices = order
      entries%columns = columns(order)
      entries%start(:) = 0
      do p = 1, size(rows)
         entries%start(rows(p) + 1) = entries%start(rows(p) + 1) + 1
      end do
      entries%start(1) = 1
      do i = 1, n
         entries%start(i + 1) = entries%start(i) + entries%start(i + 1)
      end do
      call make_tables(entries)
   end subroutine listed_entries

   !> Stable sort of `order` by a key in 1 .. n.
   pure subroutine sort_by(n, key, order)
      integer, intent(in) :: n, key(:)
      integer, intent(inout) :: order(:)
      integer :: sorted(size(order)), behind(0:n), i

      behind = 0
      do i = 1, size(key)
         behind(key(i)) = behind(key(i)) + 1
      end do
      do i = 1, n
         behind(i) = behind(i - 1) + behind(i)
      end do
      do i = size(order), 1, -1
         sorted(behind(key(order(i)))) = order(i)
         behind(key(order(i))) = behind(key(order(i))) - 1
      end do
      order = sorted
   end subroutine sort_by

   !> Make the tables of all rows, each as short as its columns allow.
   pure subroutine make_tables(entries)
      type(jacobian_entries), intent(inout) :: entries
      integer :: i, p, capacity

      capacity = 0
      do i = 1, entries%n
         associate (first => entries%start(i), last => entries%start(i + 1) - 1)
            entries%mask(i) = 0
            do while (entries%mask(i) < last - first .or. .not. distinguishes(entries%columns(first:last), entries%mask(i)))
               entries%mask(i) = 2*entries%mask(i) + 1
            end do
         end associate
         entries%before(i) = capacity + 1
         capacity = capacity + entries%mask(i) + 1
      end do
      allocate (entries%table(capacity), source=0)
      do i = 1, entries%n
         do p = entries%start(i), entries%start(i + 1) - 1
            entries%table(entries%before(i) + iand(entries%columns(p), entries%mask(i))) = entries%indices(p)
         end do
      end do

   contains

      !> Whether the bits of a mask distinguish the columns.
      pure logical function distinguishes(columns, mask)
         integer, intent(in) :: columns(:), mask
         logical :: seen(0:mask)
         integer :: k

         seen = .false.
         distinguishes = .true.
         do k = 1, size(columns)
            distinguishes = .not. seen(iand(columns(k), mask))
            if (.not. distinguishes) return
            seen(iand(columns(k), mask)) = .true.
         end do
      end function distinguishes

   end subroutine make_tables

   !> Record entries only, in an array of `capacity` + 1 values whose first one, the count, must be 0.
   pure subroutine note_entries(n, capacity, entries)
      integer, intent(in) :: n, capacity !! rows; capacity of the array
      type(jacobian_entries), intent(out) :: entries

      entries%n = n
      entries%n_entries = capacity + 1
      entries%notes = .true.
   end subroutine note_entries

   !> Number of recorded entries, including those beyond the capacity.
   pure integer function n_noted(notes)
      real(wp), intent(in) :: notes(:)

      n_noted = nint(notes(1))
   end function n_noted

   !> Recorded entries, column after column, without duplicates.
   pure subroutine take_noted(n, notes, rows, columns)
      integer, intent(in) :: n !! rows
      real(wp), intent(in) :: notes(:)
      integer, allocatable, intent(out) :: rows(:), columns(:)
      integer :: p

      allocate (rows(n_noted(notes)), columns(n_noted(notes)))
      do p = 1, size(rows)
         columns(p) = int((notes(p + 1) - 0.5_wp)/n) + 1
         rows(p) = nint(notes(p + 1) - real(columns(p) - 1, wp)*n)
      end do
      call sort_entries(n, rows, columns)
   end subroutine take_noted

   !> Sort entries column after column, without duplicates.
   pure subroutine sort_entries(n, rows, columns)
      integer, intent(in) :: n !! rows of the matrix
      integer, allocatable, intent(inout) :: rows(:), columns(:)
      integer, allocatable :: order(:)
      logical, allocatable :: is_new(:)
      integer :: p

      allocate (order, source=[(p, p=1, size(rows))])
      allocate (is_new(size(rows)), source=.true.)
      call sort_by(n, rows, order)
      call sort_by(n, columns, order)
      do p = 2, size(order)
         is_new(p) = rows(order(p)) /= rows(order(p - 1)) .or. columns(order(p)) /= columns(order(p - 1))
      end do
      order = order(indices(is_new))
      rows = rows(order)
      columns = columns(order)
   end subroutine sort_entries

   !> Add to a stored entry.
   pure subroutine add_entry(entries, row, column, amount, values)
      type(jacobian_entries), intent(in) :: entries
      integer, intent(in) :: row, column
      real(wp), intent(in) :: amount
      real(wp), intent(inout) :: values(entries%n_entries)
      integer :: index

      if (entries%notes) then
         values(1) = values(1) + 1
         if (nint(values(1)) < entries%n_entries) values(nint(values(1)) + 1) = row + (column - 1)*real(entries%n, wp)
         return
      end if
      if (allocated(entries%table)) then
         index = entries%table(entries%before(row) + iand(column, entries%mask(row)))
      else
         index = row + (column - 1)*entries%n
      end if
      values(index) = values(index) + amount
   end subroutine add_entry

   !> Add a multiple of one row to another, which must have the required entries.
   pure subroutine add_row(entries, from, to, factor, values)
      type(jacobian_entries), intent(in) :: entries !! not in recording mode
      integer, intent(in) :: from, to
      real(wp), intent(in) :: factor
      real(wp), intent(inout) :: values(entries%n_entries)
      integer :: j, p

      if (allocated(entries%table)) then
         do p = entries%start(from), entries%start(from + 1) - 1
            call add_entry(entries, to, entries%columns(p), factor*values(entries%indices(p)), values)
         end do
      else
         do j = 0, entries%n - 1
            values(to + j*entries%n) = values(to + j*entries%n) + factor*values(from + j*entries%n)
         end do
      end if
   end subroutine add_row

   !> Set a row to zero.
   pure subroutine clear_row(entries, row, values)
      type(jacobian_entries), intent(in) :: entries !! not in recording mode
      integer, intent(in) :: row
      real(wp), intent(inout) :: values(entries%n_entries)
      integer :: p

      if (allocated(entries%table)) then
         do p = entries%start(row), entries%start(row + 1) - 1
            values(entries%indices(p)) = 0
         end do
      else
         values(row::entries%n) = 0
      end if
   end subroutine clear_row

   !> y = J x of a list of entries; explicit-shape arrays avoid access to array descriptors.
   pure subroutine apply_entries(n, entries, row, column, jacobian, x, y)
      integer, intent(in) :: n, entries, row(entries), column(entries)
      real(wp), intent(in) :: jacobian(entries), x(n)
      real(wp), intent(out) :: y(n)
      integer :: p

      y = 0
      do p = 1, entries
         y(row(p)) = y(row(p)) + jacobian(p)*x(column(p))
      end do
   end subroutine apply_entries

end module evl_jacobian_entries
