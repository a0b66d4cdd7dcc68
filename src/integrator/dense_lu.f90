!> LU factorisation with row exchanges of the four matrices shift_k I - J, for states in which diagonal pivots are insufficient.
!>
!> Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., 3.4.
module evl_dense_lu
   use evl_kinds, only: wp
   use evl_radau_coefficients, only: n_systems
   implicit none (type, external)
   private

   public :: dense_lu_t, dense_lu_create, dense_lu_factor, dense_lu_solve, dense_lu_solve_first

   !> Factors in place; exchange(k): the row that was exchanged with row k in step k.
   type :: dense_lu_t
      integer :: n = 0
      complex(wp), allocatable :: a(:, :, :) !! [n, n, 4]
      integer, allocatable :: exchange(:, :) !! [n, 4]
      complex(wp), allocatable :: x(:)       !! [n] scratch
   end type dense_lu_t

contains

   !> Create for n unknowns. The matrices are allocated at the first factorisation, which most integrations do not need.
   subroutine dense_lu_create(lu, n)
      type(dense_lu_t), intent(out) :: lu
      integer, intent(in) :: n

      lu%n = n
      allocate (lu%exchange(n, n_systems), lu%x(n))
   end subroutine dense_lu_create

   !> Factor shift_k I - J.
   pure subroutine dense_lu_factor(lu, shift_re, shift_im, row, column, jacobian, good)
      type(dense_lu_t), intent(inout) :: lu
      real(wp), intent(in) :: shift_re(n_systems), shift_im(n_systems)
      integer, intent(in) :: row(:), column(:) !! pattern of J
      real(wp), intent(in) :: jacobian(:)      !! its entries
      logical, intent(out) :: good             !! false if a matrix is singular
      integer :: i, k, p

      if (.not. allocated(lu%a)) allocate (lu%a(lu%n, lu%n, n_systems))
      lu%a = 0
      good = .true.
      do k = 1, n_systems
         do p = 1, size(row)
            lu%a(row(p), column(p), k) = -jacobian(p)
         end do
         do i = 1, lu%n
            lu%a(i, i, k) = lu%a(i, i, k) + cmplx(shift_re(k), shift_im(k), wp)
         end do
         call factor_one(lu%n, lu%a(:, :, k), lu%exchange(:, k), good)
         if (.not. good) return
      end do
   end subroutine dense_lu_factor

   !> Factor one matrix.
   pure subroutine factor_one(n, a, exchange, good)
      integer, intent(in) :: n
      complex(wp), intent(inout) :: a(n, n)
      integer, intent(out) :: exchange(n)
      logical, intent(inout) :: good
      complex(wp) :: held
      integer :: i, j, k

      do k = 1, n
         i = k
         do j = k + 1, n
            if (abs(a(j, k)) > abs(a(i, k))) i = j
         end do
         exchange(k) = i
         if (.not. (abs(a(i, k)) > 0 .and. abs(a(i, k)) <= huge(1.0_wp))) then
            good = .false.
            return
         end if
         do j = 1, n
            held = a(k, j)
            a(k, j) = a(i, j)
            a(i, j) = held
         end do
         a(k + 1:, k) = a(k + 1:, k)/a(k, k)
         do j = k + 1, n
            associate (by => a(k, j)) ! separate parts: otherwise the compiler fuses products and sums, despite its options
               a(k + 1:, j)%re = a(k + 1:, j)%re - (a(k + 1:, k)%re*by%re - a(k + 1:, k)%im*by%im)
               a(k + 1:, j)%im = a(k + 1:, j)%im - (a(k + 1:, k)%re*by%im + a(k + 1:, k)%im*by%re)
            end associate
         end do
      end do
   end subroutine factor_one

   !> Solve the four systems; b as in the sparse solver.
   pure subroutine dense_lu_solve(lu, b)
      type(dense_lu_t), intent(inout) :: lu !! its scratch changes
      real(wp), intent(inout) :: b(2*n_systems, lu%n)
      integer :: k

      do k = 1, n_systems
         lu%x(:) = cmplx(b(k, :), b(k + n_systems, :), wp)
         call solve_one(lu, k)
         b(k, :) = real(lu%x, wp)
         b(k + n_systems, :) = aimag(lu%x)
      end do
   end subroutine dense_lu_solve

   !> Solve the first system, whose shift is real.
   pure subroutine dense_lu_solve_first(lu, b)
      type(dense_lu_t), intent(inout) :: lu !! its scratch changes
      real(wp), intent(inout) :: b(lu%n)

      lu%x(:) = b
      call solve_one(lu, 1)
      b = real(lu%x, wp)
   end subroutine dense_lu_solve_first

   !> Solve one system in the scratch.
   pure subroutine solve_one(lu, k)
      type(dense_lu_t), intent(inout) :: lu
      integer, intent(in) :: k
      complex(wp) :: held
      integer :: i, j

      do i = 1, lu%n
         j = lu%exchange(i, k)
         held = lu%x(i)
         lu%x(i) = lu%x(j)
         lu%x(j) = held
      end do
      do i = 1, lu%n
         lu%x(i + 1:) = lu%x(i + 1:) - lu%a(i + 1:, i, k)*lu%x(i)
      end do
      do i = lu%n, 1, -1
         lu%x(i) = lu%x(i)/lu%a(i, i, k)
         lu%x(:i - 1) = lu%x(:i - 1) - lu%a(:i - 1, i, k)*lu%x(i)
      end do
   end subroutine solve_one

end module evl_dense_lu
