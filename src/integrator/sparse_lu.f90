!> LU factorisation of four complex matrices s_k I - J - K/s_k at once, J and K real and sparse with a fixed pattern.
!>
!> Order and fill are determined once (Markowitz: the diagonal pivot with the least (row count - 1)(column count - 1), from
!> the pattern alone, since the values change); the elimination is then a list of indices. An entry is two vectors of 4 reals:
!> the real parts and the imaginary parts of the four systems.
!>
!> Pivots stay on the diagonal. `factor` reports a pivot that is too small relative to the rest of its row of U: the growth of
!> rounding errors in one elimination step is at most the inverse of that ratio.
!>
!> Source: H. M. Markowitz, Management Science 3 (1957) 255-269; I. S. Duff, A. M. Erisman, J. K. Reid, Direct Methods for
!> Sparse Matrices, 2nd ed. (2017), 5.2 and 7.
module evl_sparse_lu
   use evl_kinds, only: wp
   use evl_radau_coefficients, only: n_systems
   use evl_stage_blocks, only: matrix_entry, multiply, subtract_product
   implicit none (type, external)
   private

   public :: sparse_lu_t, sparse_lu_analyse, sparse_lu_factor, sparse_lu_solve, sparse_lu_solve_first
   public :: smallest_pivot

   real(wp), parameter :: smallest_pivot = 1.0e-6_wp !! relative to the largest other entry of its row of U

   !> Indices and values of the factors, in the order of elimination.
   type :: sparse_lu_t
      integer :: n = 0
      integer, allocatable :: component(:) !! [n] row and column of J that are eliminated i-th
      integer, allocatable :: row_start(:) !! [n + 1] first index of row i
      integer, allocatable :: diagonal(:)  !! [n] index of the pivot; before it L, behind it U
      integer, allocatable :: column(:)    !! [nnz] position of the entry's column in the order of elimination
      integer, allocatable :: unknown(:)   !! [nnz] its column in J
      integer, allocatable :: index(:)     !! [entries of J] index of each entry of J here
      integer, allocatable :: target(:)    !! indices of the entries that elimination changes, in the order of the changes
      real(wp), allocatable :: value(:, :, :) !! [4, 2, nnz] L without its unit diagonal, inverse pivots, U
      real(wp), allocatable :: first(:)    !! [nnz] the same of the first system, which is real
   end type sparse_lu_t

   !> A growing list.
   type :: list_t
      integer :: n = 0
      integer, allocatable :: of(:) !! the first n of these
   end type list_t

   !> A pattern that receives fill.
   type :: elimination_t
      type(list_t), allocatable :: rows(:)    !! [n] columns of each row
      type(list_t), allocatable :: columns(:) !! [n] rows of each column
   end type elimination_t

contains

   !> Determine order, fill and the elimination plan; allocate all arrays.
   subroutine sparse_lu_analyse(lu, n, row, column)
      type(sparse_lu_t), intent(out) :: lu
      integer, intent(in) :: n
      integer, intent(in) :: row(:), column(:) !! pattern of J; the diagonal is added
      type(elimination_t) :: by
      integer :: position(n), n_filled, i

      lu%n = n
      allocate (lu%component(n), lu%row_start(n + 1), lu%diagonal(n))
      call find_elimination(by, n, row, column)
      call order_by_markowitz(by, lu%component)
      do i = 1, n
         position(lu%component(i)) = i
      end do
      n_filled = 0
      do i = 1, n
         lu%row_start(i) = n_filled + 1
         n_filled = n_filled + by%rows(lu%component(i))%n
      end do
      lu%row_start(n + 1) = n_filled + 1
      allocate (lu%column(n_filled), lu%unknown(n_filled), lu%value(n_systems, 2, n_filled), lu%first(n_filled), &
                lu%index(size(row)))
      lu%value = 0
      call list_rows(by, position, lu)
      call list_targets(lu)
      call find_indices(lu, position, row, column)
   end subroutine sparse_lu_analyse

   !> Rows and columns of a pattern with its diagonal.
   subroutine find_elimination(by, n, row, column)
      type(elimination_t), intent(out) :: by
      integer, intent(in) :: n, row(:), column(:)
      integer :: i, p

      allocate (by%rows(n), by%columns(n))
      do i = 1, n
         call append(by%rows(i), i)
         call append(by%columns(i), i)
      end do
      do p = 1, size(row)
         if (row(p) == column(p)) cycle
         call append(by%rows(row(p)), column(p))
         call append(by%columns(column(p)), row(p))
      end do
   end subroutine find_elimination

   !> Append a number to a list.
   pure subroutine append(list, number)
      type(list_t), intent(inout) :: list
      integer, intent(in) :: number
      integer, allocatable :: longer(:)

      if (.not. allocated(list%of)) allocate (list%of(8))
      if (list%n == size(list%of)) then
         allocate (longer(2*list%n))
         longer(:list%n) = list%of
         call move_alloc(longer, list%of)
      end if
      list%n = list%n + 1
      list%of(list%n) = number
   end subroutine append

   !> Order of the pivots; on return rows and columns include the fill. Among pivots of equal cost, the first one is that with
   !> the shortest chain of preceding pivots: a chain is thus eliminated from both ends, and its substitutions overlap.
   subroutine order_by_markowitz(by, component)
      type(elimination_t), intent(inout) :: by
      integer, intent(out) :: component(:)
      logical :: waiting(size(component))
      integer, dimension(size(component)) :: depth, in_row, in_column
      integer :: i, j, k, best, cost, least

      waiting = .true.
      depth = 0
      in_row = by%rows%n
      in_column = by%columns%n
      do k = 1, size(component)
         best = 0
         least = huge(least)
         do i = 1, size(component)
            if (.not. waiting(i)) cycle
            cost = (in_row(i) - 1)*(in_column(i) - 1)
            if (best > 0) then
               if (cost > least .or. (cost == least .and. depth(i) >= depth(best))) cycle
            end if
            least = cost
            best = i
         end do
         component(k) = best
         waiting(best) = .false.
         associate (row => by%rows(best), column => by%columns(best))
            do i = 1, column%n ! their entry in the pivot's column no longer counts
               in_row(column%of(i)) = in_row(column%of(i)) - 1
               if (waiting(column%of(i))) depth(column%of(i)) = max(depth(column%of(i)), depth(best) + 1)
            end do
            do j = 1, row%n
               in_column(row%of(j)) = in_column(row%of(j)) - 1
               if (waiting(row%of(j))) depth(row%of(j)) = max(depth(row%of(j)), depth(best) + 1)
            end do
         end associate
         call fill(by, best, waiting, in_row, in_column)
      end do
   end subroutine order_by_markowitz

   !> Fill by the elimination of a pivot: the remaining rows of its column receive the remaining columns of its row.
   subroutine fill(by, pivot, waiting, in_row, in_column)
      type(elimination_t), intent(inout) :: by
      integer, intent(in) :: pivot
      logical, intent(in) :: waiting(:)
      integer, intent(inout) :: in_row(:), in_column(:) !! number of remaining entries
      logical :: has(size(waiting))
      integer :: rows(by%columns(pivot)%n), columns(by%rows(pivot)%n) !! remaining ones
      integer :: i, j, n_rows, n_columns

      n_rows = 0
      do i = 1, size(rows)
         if (.not. waiting(by%columns(pivot)%of(i))) cycle
         n_rows = n_rows + 1
         rows(n_rows) = by%columns(pivot)%of(i)
      end do
      n_columns = 0
      do j = 1, size(columns)
         if (.not. waiting(by%rows(pivot)%of(j))) cycle
         n_columns = n_columns + 1
         columns(n_columns) = by%rows(pivot)%of(j)
      end do
      has = .false.
      do i = 1, n_rows
         associate (row => by%rows(rows(i)))
            has(row%of(:row%n)) = .true.
            do j = 1, n_columns
               if (has(columns(j))) cycle
               call append(by%rows(rows(i)), columns(j))
               call append(by%columns(columns(j)), rows(i))
               in_row(rows(i)) = in_row(rows(i)) + 1
               in_column(columns(j)) = in_column(columns(j)) + 1
            end do
            has(by%rows(rows(i))%of(:by%rows(rows(i))%n)) = .false.
         end associate
      end do
   end subroutine fill

   !> List the rows of the factors in the order of elimination, each with its columns in that order.
   subroutine list_rows(by, position, lu)
      type(elimination_t), intent(in) :: by
      integer, intent(in) :: position(:) !! of each component in that order
      type(sparse_lu_t), intent(inout) :: lu
      integer :: next(lu%n), i, j, k

      next = lu%row_start(:lu%n)
      do j = 1, lu%n ! column after column, so that each row is filled in their order
         associate (column => by%columns(lu%component(j)))
            do k = 1, column%n
               i = position(column%of(k))
               lu%column(next(i)) = j
               lu%unknown(next(i)) = lu%component(j)
               if (i == j) lu%diagonal(i) = next(i)
               next(i) = next(i) + 1
            end do
         end associate
      end do
   end subroutine list_rows

   !> List the entries that change when the rows are eliminated one after the other.
   subroutine list_targets(lu)
      type(sparse_lu_t), intent(inout) :: lu
      integer :: entry_index(lu%n) !! index of each column's entry in a row
      integer :: i, m, p, q

      m = 0
      do i = 1, lu%n
         do p = lu%row_start(i), lu%diagonal(i) - 1
            m = m + lu%row_start(lu%column(p) + 1) - lu%diagonal(lu%column(p)) - 1
         end do
      end do
      allocate (lu%target(m))
      m = 0
      entry_index = 0
      do i = 1, lu%n
         do p = lu%row_start(i), lu%row_start(i + 1) - 1
            entry_index(lu%column(p)) = p
         end do
         do p = lu%row_start(i), lu%diagonal(i) - 1
            do q = lu%diagonal(lu%column(p)) + 1, lu%row_start(lu%column(p) + 1) - 1
               m = m + 1
               lu%target(m) = entry_index(lu%column(q))
            end do
         end do
      end do
   end subroutine list_targets

   !> Find the index of each entry of J.
   subroutine find_indices(lu, position, row, column)
      type(sparse_lu_t), intent(inout) :: lu
      integer, intent(in) :: position(:), row(:), column(:)
      integer :: i, p

      do p = 1, size(row)
         i = position(row(p))
         associate (columns => lu%unknown(lu%row_start(i):lu%row_start(i + 1) - 1))
            lu%index(p) = lu%row_start(i) - 1 + findloc(columns, column(p), dim=1)
         end associate
      end do
   end subroutine find_indices

   !> Factor s_k I - J - K/s_k for the four complex shifts.
   pure subroutine sparse_lu_factor(lu, shift, inverse_shift, j, k, good)
      type(sparse_lu_t), intent(inout) :: lu
      real(wp), intent(in) :: shift(n_systems, 2), inverse_shift(n_systems, 2) !! s_k and 1/s_k
      real(wp), intent(in) :: j(:), k(:) !! entries of J and K
      logical, intent(out) :: good       !! whether every pivot was large enough; if not, the factors are useless
      integer :: i, p

      lu%value = 0
      do p = 1, size(lu%index)
         call matrix_entry(inverse_shift, j(p), k(p), lu%value(:, :, lu%index(p)))
      end do
      do i = 1, lu%n
         lu%value(:, :, lu%diagonal(i)) = lu%value(:, :, lu%diagonal(i)) + shift
      end do
      call eliminate(lu%n, lu%row_start, lu%diagonal, lu%column, lu%target, lu%value, good)
      lu%first = lu%value(1, 1, :)
   end subroutine sparse_lu_factor

   !> Eliminate row by row; explicit-shape arrays avoid access to array descriptors.
   pure subroutine eliminate(n, row_start, diagonal, column, target, value, good)
      integer, intent(in) :: n
      integer, intent(in) :: row_start(n + 1), diagonal(n), column(*), target(*)
      real(wp), intent(inout) :: value(n_systems, 2, *)
      logical, intent(out) :: good
      real(wp) :: factor(n_systems, 2), pivot(n_systems), beside(n_systems)
      integer :: d, i, m, p, q

      good = .true.
      m = 0
      do i = 1, n
         d = diagonal(i)
         do p = row_start(i), d - 1
            q = diagonal(column(p))
            call multiply(value(:, :, q), value(:, :, p), factor)
            value(:, :, p) = factor
            do q = diagonal(column(p)) + 1, row_start(column(p) + 1) - 1
               m = m + 1
               call subtract_product(factor, value(:, :, q), value(:, :, target(m)))
            end do
         end do
         pivot = value(:, 1, d)**2 + value(:, 2, d)**2
         beside = tiny(1.0_wp)/smallest_pivot**2
         do q = d + 1, row_start(i + 1) - 1
            beside = max(beside, value(:, 1, q)**2 + value(:, 2, q)**2)
         end do
         if (.not. all(pivot > smallest_pivot**2*beside .and. pivot <= huge(1.0_wp))) then
            good = .false.
            return
         end if
         value(:, 1, d) = value(:, 1, d)/pivot
         value(:, 2, d) = -value(:, 2, d)/pivot
      end do
   end subroutine eliminate

   !> Solve the four systems; b(:, 1, i) holds the real parts of component i, b(:, 2, i) the imaginary parts; on return those of x.
   pure subroutine sparse_lu_solve(lu, b)
      type(sparse_lu_t), intent(in) :: lu
      real(wp), intent(inout) :: b(n_systems, 2, lu%n)

      call substitute(lu%n, lu%component, lu%row_start, lu%diagonal, lu%unknown, lu%value, b)
   end subroutine sparse_lu_solve

   !> Forward and backward substitution; explicit-shape arrays avoid access to array descriptors.
   pure subroutine substitute(n, component, row_start, diagonal, unknown, value, b)
      integer, intent(in) :: n
      integer, intent(in) :: component(n), row_start(n + 1), diagonal(n), unknown(*)
      real(wp), intent(in) :: value(n_systems, 2, *)
      real(wp), intent(inout) :: b(n_systems, 2, n)
      real(wp) :: x(n_systems, 2)
      integer :: i, p

      do i = 2, n
         if (row_start(i) == diagonal(i)) cycle
         x = b(:, :, component(i))
         do p = row_start(i), diagonal(i) - 1
            call subtract_product(value(:, :, p), b(:, :, unknown(p)), x)
         end do
         b(:, :, component(i)) = x
      end do
      do i = n, 1, -1
         x = b(:, :, component(i))
         do p = diagonal(i) + 1, row_start(i + 1) - 1
            call subtract_product(value(:, :, p), b(:, :, unknown(p)), x)
         end do
         call multiply(value(:, :, diagonal(i)), x, b(:, :, component(i)))
      end do
   end subroutine substitute

   !> Solve the first system, whose shift is real.
   pure subroutine sparse_lu_solve_first(lu, b)
      type(sparse_lu_t), intent(in) :: lu
      real(wp), intent(inout) :: b(lu%n)
      real(wp) :: x
      integer :: i, p

      do i = 2, lu%n
         x = b(lu%component(i))
         do p = lu%row_start(i), lu%diagonal(i) - 1
            x = x - lu%first(p)*b(lu%unknown(p))
         end do
         b(lu%component(i)) = x
      end do
      do i = lu%n, 1, -1
         x = b(lu%component(i))
         do p = lu%diagonal(i) + 1, lu%row_start(i + 1) - 1
            x = x - lu%first(p)*b(lu%unknown(p))
         end do
         b(lu%component(i)) = x*lu%first(lu%diagonal(i))
      end do
   end subroutine sparse_lu_solve_first

end module evl_sparse_lu
