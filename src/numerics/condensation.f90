!> Elimination of the first unknowns of a symmetric matrix [A, B^T; B, C] with A positive definite.
!>
!>    A = L L^T (Cholesky),   X = B L^-T,   Schur complement: C - X X^T
!>
!> Each element results from the same operations in the same order as in the reference LAPACK and BLAS (dpotrf, dtrsm and
!> dsyrk), with identical digits; here sixteen rows and four columns are processed at once.
module evl_condensation
   use evl_kinds, only: lanes, wp
   implicit none (type, external)
   private

   public :: row_start, symmetric_t

   integer, parameter, public :: height = 2*lanes !! rows of a strip
   integer, parameter :: columns = 4              !! of a tile

   !> Lower triangle of a symmetric matrix in strips of sixteen rows, which end behind the diagonal; each strip is stored by
   !> columns. Rows of a unit matrix before it pad the unknowns to be eliminated to whole strips.
   type :: symmetric_t
      integer :: n_out = 0, n = 0           !! unknowns to be eliminated, and all unknowns
      integer :: fill = 0                   !! padding rows before them
      real(wp), allocatable :: numbers(:)   !! elements; may be longer than necessary
   contains
      procedure :: create
      procedure :: element
      procedure :: set
      procedure :: add
      procedure :: eliminate
   end type symmetric_t

contains

   !> Number of elements in n strips.
   elemental integer function in_strips(n)
      integer, intent(in) :: n

      in_strips = n*(n + 1)/2*height**2
   end function in_strips

   !> Set to zero, in the allocated array if it is large enough.
   pure subroutine create(self, n_out, n)
      class(symmetric_t), intent(inout) :: self
      integer, intent(in) :: n_out, n
      integer :: length, i

      self%n_out = n_out
      self%n = n
      self%fill = modulo(-n_out, height)
      length = in_strips((self%fill + n + height - 1)/height)
      if (allocated(self%numbers)) then
         if (size(self%numbers) < length) deallocate (self%numbers)
      end if
      if (.not. allocated(self%numbers)) allocate (self%numbers(2*length)) ! fronts grow
      self%numbers(:length) = 0
      do i = 1, self%fill
         self%numbers((i - 1)*height + i) = 1
      end do
   end subroutine create

   !> Offset of row i, counted after the padding rows: element (i, j), i >= j, has the index row_start + height j.
   elemental integer function row_start(fill, i)
      integer, intent(in) :: fill, i

      row_start = in_strips((fill + i - 1)/height) + modulo(fill + i - 1, height) + 1 + (fill - 1)*height
   end function row_start

   !> Element (i, j), i >= j.
   pure real(wp) function element(self, i, j)
      class(symmetric_t), intent(in) :: self
      integer, intent(in) :: i, j

      element = self%numbers(row_start(self%fill, i) + height*j)
   end function element

   !> Set column j from row i on, i >= j.
   pure subroutine set(self, i, j, values)
      class(symmetric_t), intent(inout) :: self
      integer, intent(in) :: i, j
      real(wp), intent(in) :: values(:)
      integer :: k

      do k = 1, size(values)
         self%numbers(row_start(self%fill, i + k - 1) + height*j) = values(k)
      end do
   end subroutine set

   !> Add the Schur complement of another matrix.
   pure subroutine add(self, rest, at)
      class(symmetric_t), intent(inout) :: self
      type(symmetric_t), intent(in) :: rest
      integer, intent(in) :: at(:) !! row here of each of its rows; 0: none
      integer :: start(size(at)), first

      start = row_start(self%fill, at)
      do first = 1, size(at), height
         call add_strip(first, min(first + height - 1, size(at)), at, start, self%numbers, &
                        rest%numbers(row_start(rest%fill, rest%n_out + first) + height*(rest%n_out + 1):))
      end do
   end subroutine add

   !> Add a strip of it.
   pure subroutine add_strip(first, last, at, start, numbers, strip)
      integer, intent(in) :: first, last, at(last), start(last) !! rows of the strip; for all rows, target row and its offset
      real(wp), intent(inout) :: numbers(*)
      real(wp), intent(in) :: strip(first:first + height - 1, *)
      integer :: i, k, i_packed

      do k = 1, last
         if (at(k) == 0) cycle
         do i = max(k, first), last
            if (at(i) == 0) cycle
            i_packed = merge(start(i) + height*at(k), start(k) + height*at(i), at(i) > at(k))
            numbers(i_packed) = numbers(i_packed) + strip(i, k)
         end do
      end do
   end subroutine add_strip

   !> Eliminate: rows after the first n_out hold the Schur complement.
   pure subroutine eliminate(self, is_definite)
      class(symmetric_t), intent(inout) :: self
      logical, intent(out) :: is_definite         !! false: A is not positive definite, and the matrix is destroyed
      real(wp) :: inverse(self%fill + self%n_out) !! of the diagonal of L
      integer :: s

      is_definite = .true.
      do s = 1, (self%fill + self%n + height - 1)/height
         call finish_strip(s, self%fill/columns*columns, size(inverse), self%numbers, inverse, is_definite)
         if (.not. is_definite) return
      end do
   end subroutine eliminate

   !> Compute a strip of L, or of X and C - X X^T, from those above it.
   pure subroutine finish_strip(s, start, width, numbers, inverse, is_definite)
      integer, intent(in) :: s, start, width !! columns of the unit matrix to skip, and columns to eliminate
      real(wp), intent(inout) :: numbers(*), inverse(width)
      logical, intent(inout) :: is_definite
      real(wp) :: factor
      integer :: above, strip, rows, column, i, k, q, r

      strip = in_strips(s - 1)
      do k = start + 1, s*height, columns
         above = (k - 1)/height + 1
         rows = in_strips(above - 1) + modulo(k - 1, height) + 1
         column = strip + (k - 1)*height + 1
         if (k > width) then
            call subtract_product(width - start, numbers(strip + start*height + 1), numbers(rows + start*height), numbers(column))
            cycle
         end if
         call subtract_product(k - 1 - start, numbers(strip + start*height + 1), numbers(rows + start*height), numbers(column))
         do q = 0, columns - 1
            do r = 0, q - 1
               factor = numbers(rows + (k - 1 + r)*height + q)
               !$omp simd
               do i = 0, height - 1
                  numbers(column + q*height + i) = numbers(column + q*height + i) - factor*numbers(column + r*height + i)
               end do
            end do
            if (above == s) then
               factor = numbers(rows + (k - 1 + q)*height + q)
               is_definite = factor > 0
               if (.not. is_definite) return
               inverse(k + q) = 1/sqrt(factor)
            end if
            !$omp simd
            do i = 0, height - 1
               numbers(column + q*height + i) = inverse(k + q)*numbers(column + q*height + i)
            end do
         end do
      end do
   end subroutine finish_strip

   !> tile := tile - X Y^T, X with sixteen rows, Y with four. It has two calls: gfortran 12 would inline a single one and
   !> then keep the tile in memory (a tenth of the time of a wheel).
   pure subroutine subtract_product(n, x, y, tile)
      integer, intent(in) :: n
      real(wp), intent(in) :: x(height, *), y(height, *)
      real(wp), intent(inout) :: tile(height, columns)
      real(wp), dimension(height) :: a, b, c, d !! its columns, held in registers
      integer :: i, l

      a = tile(:, 1)
      b = tile(:, 2)
      c = tile(:, 3)
      d = tile(:, 4)
      do l = 1, n
         !$omp simd
         do i = 1, height
            a(i) = a(i) - y(1, l)*x(i, l)
            b(i) = b(i) - y(2, l)*x(i, l)
            c(i) = c(i) - y(3, l)*x(i, l)
            d(i) = d(i) - y(4, l)*x(i, l)
         end do
      end do
      tile(:, 1) = a
      tile(:, 2) = b
      tile(:, 3) = c
      tile(:, 4) = d
   end subroutine subtract_product

end module evl_condensation
