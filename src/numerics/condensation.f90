!> Elimination of the first unknowns of a symmetric matrix [A, B^T; B, C], positive definite in A.
!>
!>    A = L L^T (Cholesky),   B := B L^-T,   C := C - B B^T
!>
!> Each element sees the same operations in the same order as in the reference LAPACK and BLAS (dpotrf, dtrsm and dsyrk), so that
!> its digits are the same; here they are made for eight rows and four columns at once.
module evl_condensation
   use evl_kinds, only: lanes, wp
   implicit none (type, external)
   private

   public :: cholesky, rows_below, subtract_products

   integer, parameter :: columns = 4 !! of a tile

contains

   !> A := L in the lower triangle; the upper one stays.
   pure subroutine cholesky(n, a, lda, is_definite)
      integer, intent(in) :: n, lda
      real(wp), intent(inout) :: a(lda, *)
      logical, intent(out) :: is_definite !! false: A is not positive definite, and is destroyed
      real(wp) :: above(2*lanes, n), block(2*lanes, 2*lanes)
      integer :: first, k, m

      is_definite = .true.
      do first = 1, n, size(block, 1)
         m = min(size(block, 1), n - first + 1)
         above(:m, :first - 1) = a(first:first + m - 1, :first - 1)
         block(:m, :m) = a(first:first + m - 1, first:first + m - 1)
         call rows_below(m, first - 1, a, lda, above, size(above, 1))
         call subtract_products(m, first - 1, above, size(above, 1), block, size(block, 1))
         call factorise_block(m, block, is_definite)
         if (.not. is_definite) return
         a(first:first + m - 1, :first - 1) = above(:m, :first - 1)
         do k = 1, m
            a(first + k - 1:first + m - 1, first + k - 1) = block(k:m, k)
         end do
      end do
   end subroutine cholesky

   !> The same of a small matrix, one column after the other.
   pure subroutine factorise_block(n, a, is_definite)
      integer, intent(in) :: n
      real(wp), intent(inout) :: a(2*lanes, 2*lanes)
      logical, intent(out) :: is_definite
      integer :: j, k

      do k = 1, n
         is_definite = a(k, k) > 0
         if (.not. is_definite) return
         a(k, k) = sqrt(a(k, k))
         a(k + 1:n, k) = (1/a(k, k))*a(k + 1:n, k)
         do j = k + 1, n
            a(j:n, j) = a(j:n, j) - a(j, k)*a(j:n, k)
         end do
      end do
   end subroutine factorise_block

   !> B := B L^-T.
   pure subroutine rows_below(m, n, l, ldl, b, ldb)
      integer, intent(in) :: m, n, ldl, ldb  !! B is m by n
      real(wp), intent(in) :: l(ldl, *)      !! lower triangle
      real(wp), intent(inout) :: b(ldb, *)
      real(wp) :: x(lanes, n), inverse(n), tile(lanes, columns)
      integer :: first, last, i, j, k, q

      do k = 1, n
         inverse(k) = 1/l(k, k)
      end do
      do first = 1, m, lanes
         last = min(first + lanes - 1, m)
         do k = 1, n
            x(:last - first + 1, k) = b(first:last, k)
            x(last - first + 2:, k) = 0
         end do
         do k = 1, n - columns + 1, columns
            tile = x(:, k:k + columns - 1)
            do j = 1, k - 1
               do i = 1, lanes
                  tile(i, 1) = tile(i, 1) - l(k, j)*x(i, j)
                  tile(i, 2) = tile(i, 2) - l(k + 1, j)*x(i, j)
                  tile(i, 3) = tile(i, 3) - l(k + 2, j)*x(i, j)
                  tile(i, 4) = tile(i, 4) - l(k + 3, j)*x(i, j)
               end do
            end do
            x(:, k:k + columns - 1) = tile
            do q = k, k + columns - 1
               call finish_column(n, k, q, l, ldl, inverse(q), x)
            end do
         end do
         do q = n - mod(n, columns) + 1, n
            call finish_column(n, 1, q, l, ldl, inverse(q), x)
         end do
         do k = 1, n
            b(first:last, k) = x(:last - first + 1, k)
         end do
      end do
   end subroutine rows_below

   !> Of one column of eight rows: what the columns from `from` on make of it, then the division by the pivot.
   pure subroutine finish_column(n, from, column, l, ldl, inverse, x)
      integer, intent(in) :: n, from, column, ldl
      real(wp), intent(in) :: l(ldl, *), inverse
      real(wp), intent(inout) :: x(lanes, n)
      real(wp) :: done(lanes)
      integer :: before

      done = x(:, column)
      do before = from, column - 1
         done = done - l(column, before)*x(:, before)
      end do
      x(:, column) = inverse*done
   end subroutine finish_column

   !> C := C - B B^T, its lower triangle.
   pure subroutine subtract_products(n, k, b, ldb, c, ldc)
      integer, intent(in) :: n, k, ldb, ldc !! C is n by n, B is n by k
      real(wp), intent(in) :: b(ldb, *)
      real(wp), intent(inout) :: c(ldc, *)
      real(wp), allocatable :: strips(:, :, :) !! rows of B, eight at a time
      real(wp) :: tile(lanes, columns)
      integer :: strip, first, last, from, i, j, l, p, q

      allocate (strips(lanes, k, (n + lanes - 1)/lanes), source=0.0_wp)
      do strip = 1, size(strips, 3)
         first = (strip - 1)*lanes + 1
         last = min(first + lanes - 1, n)
         do l = 1, k
            strips(:last - first + 1, l, strip) = b(first:last, l)
         end do
      end do
      do strip = 1, size(strips, 3)
         first = (strip - 1)*lanes + 1
         last = min(first + lanes - 1, n)
         do j = 1, last, columns
            tile = 0
            do q = 1, min(columns, last - j + 1)
               from = max(first, j + q - 1)
               tile(from - first + 1:last - first + 1, q) = c(from:last, j + q - 1)
            end do
            p = mod(j - 1, lanes)
            associate (x => strips(:, :, strip), y => strips(:, :, (j - 1)/lanes + 1))
               do l = 1, k
                  do i = 1, lanes
                     tile(i, 1) = tile(i, 1) - y(p + 1, l)*x(i, l)
                     tile(i, 2) = tile(i, 2) - y(p + 2, l)*x(i, l)
                     tile(i, 3) = tile(i, 3) - y(p + 3, l)*x(i, l)
                     tile(i, 4) = tile(i, 4) - y(p + 4, l)*x(i, l)
                  end do
               end do
            end associate
            do q = 1, min(columns, last - j + 1)
               from = max(first, j + q - 1)
               c(from:last, j + q - 1) = tile(from - first + 1:last - first + 1, q)
            end do
         end do
      end do
   end subroutine subtract_products

end module evl_condensation
