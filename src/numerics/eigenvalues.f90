!> Eigenvalues of a small real matrix, without vectors and without a library: bitwise identical on every machine.
!>
!> Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., 7.4 (Hessenberg form), 7.5 (Francis's double shift, scaling).
module evl_eigenvalues
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: find_eigenvalues

   real(wp), parameter :: eps = epsilon(1.0_wp)

contains

   !> All eigenvalues; the matrix is destroyed.
   pure subroutine find_eigenvalues(n, a, re, im, found)
      integer, intent(in) :: n
      real(wp), intent(inout) :: a(n, n)
      real(wp), intent(out) :: re(n), im(n) !! pairs are adjacent
      logical, intent(out) :: found         !! false: the matrix is not finite, or the iteration did not converge
      integer, parameter :: most_steps = 60 !! for one eigenvalue
      integer :: first, last, steps

      re = 0
      im = 0
      found = all(abs(a) <= huge(1.0_wp))
      if (.not. found) return
      call balance(n, a)
      call reduce(n, a)
      last = n
      steps = 0
      do while (last > 0)
         first = start_of_block(n, a, last)
         if (first >= last - 1) then
            if (first == last) then
               re(last) = a(last, last)
            else
               call solve_two(a(first, first), a(first, last), a(last, first), a(last, last), re(first:last), im(first:last))
            end if
            last = first - 1
            steps = 0
         else
            steps = steps + 1
            found = steps <= most_steps
            if (.not. found) return
            call francis_step(n, a, first, last, mod(steps, 10) == 0)
         end if
      end do
   end subroutine find_eigenvalues

   !> Balance: scale states by powers of 2 until rows and columns have similar norms.
   pure subroutine balance(n, a)
      integer, intent(in) :: n
      real(wp), intent(inout) :: a(n, n)
      integer, parameter :: most_sweeps = 20
      real(wp) :: row, column, factor
      integer :: i, sweep
      logical :: changed

      do sweep = 1, most_sweeps
         changed = .false.
         do i = 1, n
            row = sum(abs(a(i, :))) - abs(a(i, i))
            column = sum(abs(a(:, i))) - abs(a(i, i))
            if (.not. (row > 0 .and. column > 0)) cycle
            if (row < 2*column .and. column < 2*row) cycle ! no power of 2 brings them nearer
            factor = 2.0_wp**nint(0.5_wp*(exponent(row) - exponent(column)))
            if (.not. column*factor + row/factor < 0.95_wp*(column + row)) cycle
            a(i, :) = a(i, :)/factor
            a(:, i) = a(:, i)*factor
            changed = .true.
         end do
         if (.not. changed) return
      end do
   end subroutine balance

   !> Hessenberg form, by elimination with row exchanges.
   pure subroutine reduce(n, a)
      integer, intent(in) :: n
      real(wp), intent(inout) :: a(n, n)
      real(wp) :: held, factor
      integer :: i, j, k, pivot

      do k = 1, n - 2
         pivot = k + 1
         do i = k + 2, n
            if (abs(a(i, k)) > abs(a(pivot, k))) pivot = i
         end do
         if (.not. abs(a(pivot, k)) > 0) cycle
         if (pivot /= k + 1) then
            do j = 1, n
               held = a(pivot, j)
               a(pivot, j) = a(k + 1, j)
               a(k + 1, j) = held
            end do
            do j = 1, n
               held = a(j, pivot)
               a(j, pivot) = a(j, k + 1)
               a(j, k + 1) = held
            end do
         end if
         do i = k + 2, n
            if (.not. abs(a(i, k)) > 0) cycle
            factor = a(i, k)/a(k + 1, k)
            a(i, k) = 0
            do j = k + 1, n
               a(i, j) = a(i, j) - factor*a(k + 1, j)
            end do
            do j = 1, n
               a(j, k + 1) = a(j, k + 1) + factor*a(j, i)
            end do
         end do
      end do
   end subroutine reduce

   !> First row of the block that ends at `last`: its entry below the diagonal vanishes.
   pure integer function start_of_block(n, a, last) result(first)
      integer, intent(in) :: n, last
      real(wp), intent(in) :: a(n, n)
      real(wp) :: beside

      first = last
      do while (first > 1)
         beside = abs(a(first - 1, first - 1)) + abs(a(first, first))
         if (.not. beside > 0) beside = maxval(abs(a(:last, :last)))
         if (abs(a(first, first - 1)) <= eps*beside) exit
         first = first - 1
      end do
   end function start_of_block

   !> The two eigenvalues of a block of two.
   pure subroutine solve_two(a, b, c, d, re, im)
      real(wp), intent(in) :: a, b, c, d !! by rows
      real(wp), intent(out) :: re(2), im(2)
      real(wp) :: half, square, root

      half = 0.5_wp*(a - d)
      square = half**2 + b*c
      root = sqrt(abs(square))
      if (square >= 0) then
         root = half + sign(root, half)
         re = d + root
         if (abs(root) > 0) re(2) = d - b*c/root
         im = 0
      else
         re = 0.5_wp*(a + d)
         im = [root, -root]
      end if
   end subroutine solve_two

   !> Francis step with the eigenvalues of the last two rows of a block as shifts; the block has no zeros below its diagonal.
   pure subroutine francis_step(n, a, first, last, unusual)
      integer, intent(in) :: n
      real(wp), intent(inout) :: a(n, n)
      integer, intent(in) :: first, last !! rows of the block, three or more
      logical, intent(in) :: unusual     !! exceptional shifts, when the usual ones do not converge
      real(wp) :: total, product, v(3)
      integer :: i, k, m

      total = a(last - 1, last - 1) + a(last, last)
      product = a(last - 1, last - 1)*a(last, last) - a(last - 1, last)*a(last, last - 1)
      if (unusual) then
         total = 1.5_wp*(abs(a(last, last - 1)) + abs(a(last - 1, last - 2)))
         product = (abs(a(last, last - 1)) + abs(a(last - 1, last - 2)))**2
      end if
      v(1) = a(first, first)**2 + a(first, first + 1)*a(first + 1, first) - total*a(first, first) + product
      v(2) = a(first + 1, first)*(a(first, first) + a(first + 1, first + 1) - total)
      v(3) = a(first + 1, first)*a(first + 2, first + 1)
      do k = first, last - 1
         m = min(3, last - k + 1)
         if (k > first) then
            do i = 1, m
               v(i) = a(k + i - 1, k - 1)
            end do
         end if
         call reflect(n, a, first, last, k, m, v)
      end do
   end subroutine francis_step

   !> Reflect rows and columns k .. k + m - 1 of a block so that v(1:m) becomes a multiple of the first axis.
   pure subroutine reflect(n, a, first, last, k, m, v)
      integer, intent(in) :: n, first, last, k, m
      real(wp), intent(inout) :: a(n, n), v(3)
      real(wp) :: length, factor, along
      integer :: i, third

      third = min(k + 2, last) ! for two rows: the second one again, with weight 0
      if (m < 3) v(3) = 0
      length = max(abs(v(1)), abs(v(2)), abs(v(3)))
      if (.not. length > 0) return
      v = v/length
      length = sqrt((v(1)**2 + v(2)**2) + v(3)**2)
      v(1) = v(1) + sign(length, v(1))
      factor = 2/((v(1)**2 + v(2)**2) + v(3)**2)
      do i = max(first, k - 1), last
         along = factor*((v(1)*a(k, i) + v(2)*a(k + 1, i)) + v(3)*a(third, i))
         a(k, i) = a(k, i) - along*v(1)
         a(k + 1, i) = a(k + 1, i) - along*v(2)
         a(third, i) = a(third, i) - along*v(3)
      end do
      do i = first, min(last, k + 3)
         along = factor*((v(1)*a(i, k) + v(2)*a(i, k + 1)) + v(3)*a(i, third))
         a(i, k) = a(i, k) - along*v(1)
         a(i, k + 1) = a(i, k + 1) - along*v(2)
         a(i, third) = a(i, third) - along*v(3)
      end do
      if (k > first) a(k + 1:k + m - 1, k - 1) = 0
   end subroutine reflect

end module evl_eigenvalues
