!> Solver for the four systems (s_k I - J) x = b of an iteration, J real with a fixed pattern; kinematic rows are condensed.
!>
!> A kinematic row is an equation q' = c v: no diagonal entry and one off-diagonal entry, such as that of an angle and its
!> speed. Its unknown is q = (b_q + c v)/s_k, which leaves for the other unknowns (half as many in a mechanical model)
!>
!>     (s_k I - J_vv - K/s_k) v = b_v + J_vq b_q/s_k,   K = J_vq C
!>
!> where J_vq and K are real. A few unknowns are solved with explicit inverses, more with sparse factors.
!>
!> Source: R. J. Guyan, AIAA Journal 3 (1965) 380 (static condensation; here it is exact).
module evl_condensed_systems
   use evl_block_inverse, only: apply_first_inverse, apply_inverse, invert_blocks
   use evl_indices, only: indices
   use evl_kinds, only: wp
   use evl_radau_coefficients, only: n_systems
   use evl_sparse_lu, only: smallest_pivot, sparse_lu_analyse, sparse_lu_factor, sparse_lu_solve, sparse_lu_solve_first, sparse_lu_t
   use evl_stage_blocks, only: add_scaled, invert, matrix_entry, multiply
   implicit none (type, external)
   private

   public :: condensed_t, condensed_create, condensed_factor, condensed_solve, condensed_solve_first

   integer, parameter :: most_inverted = 8 !! number of unknowns up to which inverses are faster than factors

   !> Elimination plan from the pattern, and the factors. `_entry`: index in J; retained and kinematic rows are numbered
   !> separately from 1.
   type :: condensed_t
      integer :: n = 0                         !! unknowns
      integer, allocatable :: retained(:)          !! [n_retained] unknowns of the condensed systems, the v
      integer, allocatable :: kinematic(:)     !! [n_kinematic] unknowns of the kinematic rows, the q
      integer, allocatable :: partner(:)       !! [n_kinematic] the unknown v in that row
      integer, allocatable :: rate_entry(:)    !! [n_kinematic] its factor c
      integer, allocatable :: row(:), column(:) !! pattern of the condensed systems, with the diagonal
      integer, allocatable :: inner_entry(:), inner_index(:) !! J_vv, and its indices in that pattern
      integer, allocatable :: coupling_start(:) !! [n_retained + 1] first entry of J_vq in each row
      integer, allocatable :: coupling_entry(:), coupling_from(:) !! J_vq by rows, and the kinematic row of its column
      integer, allocatable :: coupling_index(:) !! index of its product with C
      real(wp), allocatable :: inner(:), product(:) !! [pattern] J_vv and K
      real(wp), allocatable :: coupling(:)     !! J_vq
      real(wp), allocatable :: rate(:)         !! [n_kinematic] C
      real(wp) :: inverse_shift(n_systems, 2) = 0 !! 1/s_k; 0 if no row is kinematic
      logical :: is_inverted = .false.         !! inverses are used instead of sparse factors
      real(wp), allocatable :: inverse(:, :, :, :) !! [4, 2, n_retained, n_retained] (:, :, j, i) is entry j of row i
      real(wp), allocatable :: first(:, :)     !! [n_retained, n_retained] the same for the first system, which is real
      type(sparse_lu_t) :: factors
      real(wp), allocatable :: x(:, :, :) !! [4, 2, n_retained] scratch: right-hand sides and solutions of the condensed systems
      real(wp), allocatable :: b_first(:), x_first(:) !! [n_retained] scratch of the first system
   end type condensed_t

contains

   !> Find the kinematic rows, plan the elimination, and allocate all arrays.
   subroutine condensed_create(self, n, row, column)
      type(condensed_t), intent(out) :: self
      integer, intent(in) :: n
      integer, intent(in) :: row(:), column(:) !! pattern of J
      integer :: partner(n), entry(n), start(n + 1), order(size(row)), i, m

      self%n = n
      call sort_by_rows(n, row, column, start, order)
      call find_kinematic(n, column(order), start, partner)
      self%kinematic = indices(partner > 0)
      self%partner = partner(self%kinematic)
      self%retained = indices(partner == 0)
      do i = 1, n
         if (partner(i) > 0) entry(i) = order(start(i))
      end do
      self%rate_entry = entry(self%kinematic)
      call plan_condensation(self, column, start, order)
      m = size(self%retained)
      allocate (self%inner(size(self%row)), self%product(size(self%row)), self%coupling(size(self%coupling_entry)))
      allocate (self%rate(size(self%kinematic)), self%x(n_systems, 2, m), self%b_first(m), self%x_first(m))
      self%is_inverted = m <= most_inverted
      if (self%is_inverted) then
         allocate (self%inverse(n_systems, 2, m, m), self%first(m, m))
      else
         call sparse_lu_analyse(self%factors, m, self%row, self%column)
      end if
   end subroutine condensed_create

   !> Sort the entries by rows and, within a row, by columns.
   pure subroutine sort_by_rows(n, row, column, start, order)
      integer, intent(in) :: n
      integer, intent(in) :: row(:), column(:)
      integer, intent(out) :: start(n + 1) !! first index of each row in `order`
      integer, intent(out) :: order(:)
      integer :: by_columns(size(column)), slot(n + 1), i, p

      slot = 0
      do p = 1, size(column)
         slot(column(p)) = slot(column(p)) + 1
      end do
      do i = 2, n
         slot(i) = slot(i - 1) + slot(i)
      end do
      do p = size(column), 1, -1
         by_columns(slot(column(p))) = p
         slot(column(p)) = slot(column(p)) - 1
      end do
      start = 0
      do p = 1, size(row)
         start(row(p) + 1) = start(row(p) + 1) + 1
      end do
      start(1) = 1
      do i = 1, n
         start(i + 1) = start(i) + start(i + 1)
      end do
      slot = start
      do p = 1, size(row)
         associate (next => by_columns(p))
            order(slot(row(next))) = next
            slot(row(next)) = slot(row(next)) + 1
         end associate
      end do
   end subroutine sort_by_rows

   !> Find rows that can be condensed: none of them contains the unknown of another one.
   pure subroutine find_kinematic(n, column, start, partner)
      integer, intent(in) :: n
      integer, intent(in) :: column(:), start(n + 1) !! of the entries, row after row
      integer, intent(out) :: partner(n)    !! off-diagonal unknown; 0: the row is retained
      logical :: is_partner(n)
      integer :: i, j

      partner = 0
      is_partner = .false.
      do i = 1, n
         if (start(i + 1) - start(i) /= 1 .or. is_partner(i)) cycle
         j = column(start(i))
         if (j == i .or. partner(j) > 0) cycle
         partner(i) = j
         is_partner(j) = .true.
      end do
   end subroutine find_kinematic

   !> Pattern of the condensed systems, and the indices of the entries of J in it.
   subroutine plan_condensation(self, column, start, order)
      type(condensed_t), intent(inout) :: self
      integer, intent(in) :: column(:), start(:), order(:) !! columns of J's entries; start and order from `sort_by_rows`
      integer :: position(self%n) !! index of an unknown among the retained ones; negative: among the kinematic ones
      integer :: index_of(size(self%retained)), row_start(size(self%retained) + 1), i, k, n_inner, p

      position(self%retained) = [(i, i=1, size(self%retained))]
      position(self%kinematic) = [(-i, i=1, size(self%kinematic))]
      call find_pattern(self, column, start, order, position, row_start)
      n_inner = 0
      do i = 1, size(self%retained)
         associate (row => self%retained(i))
            n_inner = n_inner + count(position(column(order(start(row):start(row + 1) - 1))) > 0)
         end associate
      end do
      k = 0
      do i = 1, size(self%retained)
         k = k + start(self%retained(i) + 1) - start(self%retained(i))
      end do
      allocate (self%inner_entry(n_inner), self%inner_index(n_inner), self%coupling_start(size(self%retained) + 1))
      allocate (self%coupling_entry(k - n_inner), self%coupling_from(k - n_inner), self%coupling_index(k - n_inner))
      n_inner = 0
      k = 0
      index_of = 0
      do i = 1, size(self%retained)
         index_of(self%column(row_start(i):row_start(i + 1) - 1)) = [(p, p=row_start(i), row_start(i + 1) - 1)]
         self%coupling_start(i) = k + 1
         do p = start(self%retained(i)), start(self%retained(i) + 1) - 1
            associate (slot => position(column(order(p))))
               if (slot > 0) then
                  n_inner = n_inner + 1
                  self%inner_entry(n_inner) = order(p)
                  self%inner_index(n_inner) = index_of(slot)
               else
                  k = k + 1
                  self%coupling_entry(k) = order(p)
                  self%coupling_from(k) = -slot
                  self%coupling_index(k) = index_of(position(self%partner(-slot)))
               end if
            end associate
         end do
      end do
      self%coupling_start(size(self%retained) + 1) = k + 1
   end subroutine plan_condensation

   !> Rows and columns of the condensed systems: the diagonal, the entries of J_vv, and those through the kinematic rows.
   subroutine find_pattern(self, column, start, order, position, row_start)
      type(condensed_t), intent(inout) :: self
      integer, intent(in) :: column(:), start(:), order(:), position(:) !! as above
      integer, intent(out) :: row_start(size(self%retained) + 1)            !! first of each row
      integer, dimension(size(self%retained) + size(column)) :: rows, columns
      integer, allocatable :: sorted(:)
      integer :: seen_in(size(self%retained)), i, j, n, p

      seen_in = 0
      n = 0
      do i = 1, size(self%retained)
         call add(i)
         do p = start(self%retained(i)), start(self%retained(i) + 1) - 1
            j = position(column(order(p)))
            if (j < 0) j = position(self%partner(-j))
            call add(j)
         end do
      end do
      allocate (sorted(n))
      call sort_by_rows(size(self%retained), rows(:n), columns(:n), row_start, sorted)
      self%row = rows(sorted)
      self%column = columns(sorted)

   contains

      !> Add an entry to row i.
      subroutine add(j)
         integer, intent(in) :: j

         if (seen_in(j) == i) return
         seen_in(j) = i
         n = n + 1
         rows(n) = i
         columns(n) = j
      end subroutine add

   end subroutine find_pattern

   !> Factor s_k I - J for the four complex shifts. Equation R2.
   pure subroutine condensed_factor(self, shift, jacobian, good)
      type(condensed_t), intent(inout) :: self
      real(wp), intent(in) :: shift(n_systems, 2) !! real and imaginary parts of the s_k
      real(wp), intent(in) :: jacobian(:)         !! entries of J
      logical, intent(out) :: good !! whether every pivot was large enough; if not, the factors are useless

      call condense(size(self%kinematic), size(self%coupling), size(self%inner_entry), size(self%inner), jacobian, &
                    self%rate_entry, self%coupling_entry, self%coupling_from, self%coupling_index, self%inner_entry, &
                    self%inner_index, self%rate, self%coupling, self%inner, self%product)
      if (size(self%kinematic) > 0) then
         good = all(shift(:, 1)**2 + shift(:, 2)**2 > (smallest_pivot*maxval(abs(self%rate)))**2)
         if (.not. good) return
         call invert(shift, self%inverse_shift)
      end if
      if (self%is_inverted) then
         call fill(size(self%retained), size(self%row), self%row, self%column, shift, self%inverse_shift, self%inner, &
                   self%product, self%inverse)
         call invert_blocks(size(self%retained), self%inverse, good)
         self%first = self%inverse(1, 1, :, :)
      else
         call sparse_lu_factor(self%factors, shift, self%inverse_shift, self%inner, self%product, good)
      end if
   end subroutine condensed_factor

   !> Collect C, J_vq, J_vv and K from the entries of J. Equation R2.
   pure subroutine condense(n_kinematic, n_coupling, n_inner, n_pattern, jacobian, rate_entry, coupling_entry, coupling_from, &
                            coupling_index, inner_entry, inner_index, rate, coupling, inner, product)
      integer, intent(in) :: n_kinematic, n_coupling, n_inner, n_pattern
      real(wp), intent(in) :: jacobian(*)
      integer, intent(in) :: rate_entry(n_kinematic), coupling_entry(n_coupling), coupling_from(n_coupling)
      integer, intent(in) :: coupling_index(n_coupling), inner_entry(n_inner), inner_index(n_inner)
      real(wp), intent(out) :: rate(n_kinematic), coupling(n_coupling), inner(n_pattern), product(n_pattern)
      integer :: p

      do p = 1, n_kinematic
         rate(p) = jacobian(rate_entry(p))
      end do
      inner = 0
      do p = 1, n_inner
         inner(inner_index(p)) = jacobian(inner_entry(p))
      end do
      product = 0
      do p = 1, n_coupling
         coupling(p) = jacobian(coupling_entry(p))
         product(coupling_index(p)) = product(coupling_index(p)) + coupling(p)*rate(coupling_from(p))
      end do
   end subroutine condense

   !> The condensed matrices, dense. Equation R2.
   pure subroutine fill(m, n_pattern, row, column, shift, inverse_shift, inner, product, matrix)
      integer, intent(in) :: m, n_pattern
      integer, intent(in) :: row(n_pattern), column(n_pattern)
      real(wp), intent(in) :: shift(n_systems, 2), inverse_shift(n_systems, 2)
      real(wp), intent(in) :: inner(n_pattern), product(n_pattern)
      real(wp), intent(out) :: matrix(n_systems, 2, m, m)
      integer :: i, p

      if (n_pattern < m*m) matrix = 0
      do p = 1, n_pattern
         call matrix_entry(inverse_shift, inner(p), product(p), matrix(:, :, column(p), row(p)))
      end do
      do i = 1, m
         matrix(:, :, i, i) = matrix(:, :, i, i) + shift
      end do
   end subroutine fill

   !> Solve the four systems; b(:, 1, i) holds the real parts of component i, b(:, 2, i) the imaginary parts; on return those of x.
   pure subroutine condensed_solve(self, b)
      type(condensed_t), intent(inout) :: self !! its scratch changes
      real(wp), intent(inout) :: b(n_systems, 2, self%n)

      call forward(self%n, size(self%kinematic), size(self%retained), self%kinematic, self%retained, self%coupling_start, &
                   self%coupling_from, self%coupling, self%inverse_shift, b, self%x)
      if (self%is_inverted) then
         call apply_inverse(size(self%retained), self%inverse, self%x, self%retained, b)
      else
         call sparse_lu_solve(self%factors, self%x)
         b(:, :, self%retained) = self%x
      end if
      call backward(self%n, size(self%kinematic), self%kinematic, self%partner, self%rate, self%inverse_shift, b)
   end subroutine condensed_solve

   !> Replace b_q by b_q/s_k and compute the right-hand sides of the condensed systems. Equation R2.
   pure subroutine forward(n, n_kinematic, m, kinematic, retained, start, from, coupling, inverse_shift, b, x)
      integer, intent(in) :: n, n_kinematic, m
      integer, intent(in) :: kinematic(n_kinematic), retained(m), start(m + 1), from(*)
      real(wp), intent(in) :: coupling(*), inverse_shift(n_systems, 2)
      real(wp), intent(inout) :: b(n_systems, 2, n)
      real(wp), intent(out) :: x(n_systems, 2, m)
      real(wp) :: block(n_systems, 2)
      integer :: i, p

      do i = 1, n_kinematic
         call multiply(inverse_shift, b(:, :, kinematic(i)), block)
         b(:, :, kinematic(i)) = block
      end do
      do i = 1, m
         block = b(:, :, retained(i))
         do p = start(i), start(i + 1) - 1
            call add_scaled(coupling(p), b(:, :, kinematic(from(p))), block)
         end do
         x(:, :, i) = block
      end do
   end subroutine forward

   !> Compute the unknowns of the kinematic rows: b_q/s_k + c v/s_k. Equation R2.
   pure subroutine backward(n, n_kinematic, kinematic, partner, rate, inverse_shift, b)
      integer, intent(in) :: n, n_kinematic
      integer, intent(in) :: kinematic(n_kinematic), partner(n_kinematic)
      real(wp), intent(in) :: rate(n_kinematic), inverse_shift(n_systems, 2)
      real(wp), intent(inout) :: b(n_systems, 2, n)
      real(wp) :: block(n_systems, 2)
      integer :: i

      do i = 1, n_kinematic
         call multiply(inverse_shift, b(:, :, partner(i)), block)
         call add_scaled(rate(i), block, b(:, :, kinematic(i)))
      end do
   end subroutine backward

   !> Solve the first system, whose shift is real.
   pure subroutine condensed_solve_first(self, b)
      type(condensed_t), intent(inout) :: self !! its scratch changes
      real(wp), intent(inout) :: b(self%n)

      call forward_first(self%n, size(self%kinematic), size(self%retained), self%kinematic, self%retained, self%coupling_start, &
                         self%coupling_from, self%coupling, self%inverse_shift(1, 1), b, self%b_first)
      if (self%is_inverted) then
         call apply_first_inverse(size(self%retained), self%first, self%b_first, self%x_first)
      else
         self%x_first = self%b_first
         call sparse_lu_solve_first(self%factors, self%x_first)
      end if
      call backward_first(self%n, size(self%kinematic), size(self%retained), self%kinematic, self%partner, self%retained, &
                          self%rate, self%inverse_shift(1, 1), self%x_first, b)
   end subroutine condensed_solve_first

   !> `forward` for the first system.
   pure subroutine forward_first(n, n_kinematic, m, kinematic, retained, start, from, coupling, inverse_shift, b, x)
      integer, intent(in) :: n, n_kinematic, m
      integer, intent(in) :: kinematic(n_kinematic), retained(m), start(m + 1), from(*)
      real(wp), intent(in) :: coupling(*), inverse_shift
      real(wp), intent(inout) :: b(n)
      real(wp), intent(out) :: x(m)
      integer :: i, p

      do i = 1, n_kinematic
         b(kinematic(i)) = inverse_shift*b(kinematic(i))
      end do
      do i = 1, m
         x(i) = b(retained(i))
         do p = start(i), start(i + 1) - 1
            x(i) = x(i) + coupling(p)*b(kinematic(from(p)))
         end do
      end do
   end subroutine forward_first

   !> Scatter the condensed solution of the first system and compute its kinematic unknowns.
   pure subroutine backward_first(n, n_kinematic, m, kinematic, partner, retained, rate, inverse_shift, x, b)
      integer, intent(in) :: n, n_kinematic, m
      integer, intent(in) :: kinematic(n_kinematic), partner(n_kinematic), retained(m)
      real(wp), intent(in) :: rate(n_kinematic), inverse_shift
      real(wp), intent(in) :: x(m)
      real(wp), intent(inout) :: b(n)
      integer :: i

      do i = 1, m
         b(retained(i)) = x(i)
      end do
      do i = 1, n_kinematic
         b(kinematic(i)) = b(kinematic(i)) + rate(i)*(inverse_shift*b(partner(i)))
      end do
   end subroutine backward_first

end module evl_condensed_systems
