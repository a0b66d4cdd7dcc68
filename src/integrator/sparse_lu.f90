!> LU factors of four complex matrices s_k I - J - K/s_k at once, J and K real and sparse with a pattern that never changes.
!>
!> Order and fill are found once (Markowitz: the diagonal pivot with the least (row count - 1)(column count - 1), on the
!> pattern alone, since the values change); the elimination is then a list of indices. An entry is two vectors of 4 reals:
!> the real parts of the four systems, and the imaginary ones.
!>
!> Pivots stay on the diagonal. `factor` reports a pivot that is too small beside the rest of its row of U: the growth of
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

   real(wp), parameter :: smallest_pivot = 1.0e-6_wp !! over the largest entry beside it in its row of U

   !> Places and values of the factors, in the order of elimination.
   type :: sparse_lu_t
      integer :: n = 0
      integer, allocatable :: component(:) !! [n] which row and column of J is eliminated i-th
      integer, allocatable :: row_start(:) !! [n + 1] first index of row i
      integer, allocatable :: diagonal(:)  !! [n] index of the pivot; before it L, behind it U
      integer, allocatable :: column(:)    !! [nnz] position of the entry's column in the order of elimination
      integer, allocatable :: unknown(:)   !! [nnz] its column in J
      integer, allocatable :: index(:)     !! [entries of J] where an entry of J goes
      integer, allocatable :: target(:)    !! indices of what elimination changes, in the order in which it does
      real(wp), allocatable :: value(:, :, :) !! [4, 2, nnz] L without its unit diagonal, inverse pivots, U
      real(wp), allocatable :: first(:)    !! [nnz] those of the first system, which is real
   end type sparse_lu_t

contains

   !> Find order, fill and the plan of the elimination; allocates all there is.
   subroutine sparse_lu_analyse(lu, n, row, column)
      type(sparse_lu_t), intent(out) :: lu
      integer, intent(in) :: n
      integer, intent(in) :: row(:), column(:) !! pattern of J; the diagonal is added
      logical, allocatable :: filled(:, :)
      integer, allocatable :: position(:), index_of(:, :)
      integer :: i, j, p

      lu%n = n
      allocate (filled(n, n), index_of(n, n), position(n), lu%component(n), lu%row_start(n + 1), lu%diagonal(n))
      filled = .false.
      do p = 1, size(row)
         filled(row(p), column(p)) = .true.
      end do
      do i = 1, n
         filled(i, i) = .true.
      end do
      call order_by_markowitz(n, filled, lu%component)
      do i = 1, n
         position(lu%component(i)) = i
      end do
      allocate (lu%column(count(filled)), lu%unknown(count(filled)), lu%value(n_systems, 2, count(filled)), &
                lu%first(count(filled)), lu%index(size(row)))
      lu%value = 0
      index_of = 0
      p = 0
      do i = 1, n
         lu%row_start(i) = p + 1
         do j = 1, n
            if (.not. filled(lu%component(i), lu%component(j))) cycle
            p = p + 1
            lu%column(p) = j
            lu%unknown(p) = lu%component(j)
            index_of(i, j) = p
            if (i == j) lu%diagonal(i) = p
         end do
      end do
      lu%row_start(n + 1) = p + 1
      do p = 1, size(row)
         lu%index(p) = index_of(position(row(p)), position(column(p)))
      end do
      call plan_elimination(lu, index_of)
   end subroutine sparse_lu_analyse

   !> Order of the pivots; on return `filled` includes the fill. Of equal ones the first is that which waits for the fewest others,
   !> one after the other: so a chain is eliminated from both ends, and substitutions in it overlap.
   subroutine order_by_markowitz(n, filled, component)
      integer, intent(in) :: n
      logical, intent(inout) :: filled(n, n)
      integer, intent(out) :: component(n)
      logical :: waiting(n)
      integer :: depth(n), i, j, k, best, cost, least

      waiting = .true.
      depth = 0
      do k = 1, n
         best = 0
         least = huge(least)
         do i = 1, n
            if (.not. waiting(i)) cycle
            cost = (count(filled(i, :) .and. waiting) - 1)*(count(filled(:, i) .and. waiting) - 1)
            if (best > 0) then
               if (cost > least .or. (cost == least .and. depth(i) >= depth(best))) cycle
            end if
            least = cost
            best = i
         end do
         component(k) = best
         waiting(best) = .false.
         where (waiting .and. (filled(best, :) .or. filled(:, best))) depth = max(depth, depth(best) + 1)
         do j = 1, n
            if (.not. (waiting(j) .and. filled(best, j))) cycle
            where (waiting .and. filled(:, best)) filled(:, j) = .true.
         end do
      end do
   end subroutine order_by_markowitz

   !> List what changes when the rows are eliminated one after the other.
   subroutine plan_elimination(lu, index_of)
      type(sparse_lu_t), intent(inout) :: lu
      integer, intent(in) :: index_of(:, :) !! index of each entry, 0 if there is none
      integer :: i, m, p, q, pass

      do pass = 1, 2
         m = 0
         do i = 1, lu%n
            do p = lu%row_start(i), lu%diagonal(i) - 1
               do q = lu%diagonal(lu%column(p)) + 1, lu%row_start(lu%column(p) + 1) - 1
                  m = m + 1
                  if (pass == 2) lu%target(m) = index_of(i, lu%column(q))
               end do
            end do
         end do
         if (pass == 1) allocate (lu%target(m))
      end do
   end subroutine plan_elimination

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

   !> Eliminate row by row; arrays of known shape, so that a row costs no look at a descriptor.
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

   !> Solve the four systems; b(:, 1, i) holds the real parts of component i, b(:, 2, i) the imaginary ones, then of x.
   pure subroutine sparse_lu_solve(lu, b)
      type(sparse_lu_t), intent(in) :: lu
      real(wp), intent(inout) :: b(n_systems, 2, lu%n)

      call substitute(lu%n, lu%component, lu%row_start, lu%diagonal, lu%unknown, lu%value, b)
   end subroutine sparse_lu_solve

   !> Forward and backward substitution; arrays of known shape, so that a row costs no look at a descriptor.
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
