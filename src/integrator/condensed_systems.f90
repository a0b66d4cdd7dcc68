!> The four systems (s_k I - J) x = b of an iteration, J real with a pattern that never changes, its kinematic rows condensed.
!>
!> A kinematic row is an equation q' = c v: no entry on the diagonal and one beside it, such as that of an angle and its speed.
!> Its unknown is q = (b_q + c v)/s_k, which leaves for the others, half as many in a mechanical model,
!>
!>     (s_k I - J_vv - K/s_k) v = b_v + J_vq b_q/s_k,   K = J_vq C
!>
!> where J_vq and K are real. A few unknowns are then found with explicit inverses, more with sparse factors.
!>
!> Source: R. J. Guyan, AIAA Journal 3 (1965) 380 (static condensation; here it is exact).
module evl_condensed_systems
   use evl_block_inverse, only: apply_first_inverse, apply_inverse, invert_blocks
   use evl_kinds, only: wp
   use evl_radau_coefficients, only: n_systems
   use evl_sparse_lu, only: smallest_pivot, sparse_lu_analyse, sparse_lu_factor, sparse_lu_solve, sparse_lu_solve_first, &
                            sparse_lu_t
   use evl_stage_blocks, only: add_scaled, invert, matrix_entry, multiply
   implicit none (type, external)
   private

   public :: condensed_t, condensed_create, condensed_factor, condensed_solve, condensed_solve_first

   integer, parameter :: most_inverted = 8 !! unknowns up to which inverses are faster than factors

   !> What the pattern tells, and the factors. `_entry`: index in J; kept and kinematic rows are counted from 1 each.
   type :: condensed_t
      integer :: n = 0                         !! unknowns
      integer, allocatable :: kept(:)          !! [n_kept] unknowns of the condensed systems, the v
      integer, allocatable :: kinematic(:)     !! [n_kinematic] unknowns of the kinematic rows, the q
      integer, allocatable :: partner(:)       !! [n_kinematic] the unknown v in that row
      integer, allocatable :: rate_entry(:)    !! [n_kinematic] its factor c
      integer, allocatable :: row(:), column(:) !! pattern of the condensed systems, with the diagonal
      integer, allocatable :: inner_entry(:), inner_place(:) !! J_vv, and where it goes in that pattern
      integer, allocatable :: coupling_start(:) !! [n_kept + 1] first entry of J_vq in each row
      integer, allocatable :: coupling_entry(:), coupling_from(:) !! J_vq by rows, and the kinematic row of its column
      integer, allocatable :: coupling_place(:) !! where its product with C goes
      real(wp), allocatable :: inner(:), product(:) !! [pattern] J_vv and K
      real(wp), allocatable :: coupling(:)     !! J_vq
      real(wp), allocatable :: rate(:)         !! [n_kinematic] C
      real(wp) :: inverse_shift(n_systems, 2) = 0 !! 1/s_k; 0 if no row is kinematic
      logical :: is_inverted = .false.         !! inverses serve, not sparse factors
      real(wp), allocatable :: inverse(:, :, :, :) !! [4, 2, n_kept, n_kept] (:, :, j, i) is entry j of row i
      real(wp), allocatable :: first(:, :)     !! [n_kept, n_kept] the same of the first system, which is real
      type(sparse_lu_t) :: factors
      real(wp), allocatable :: x(:, :, :)      !! [4, 2, n_kept] scratch: right-hand sides and solutions of the condensed systems
      real(wp), allocatable :: b_first(:), x_first(:) !! [n_kept] scratch of the first system
   end type condensed_t

contains

   !> Find the kinematic rows and plan the elimination; allocates all there is.
   subroutine condensed_create(self, n, row, column)
      type(condensed_t), intent(out) :: self
      integer, intent(in) :: n
      integer, intent(in) :: row(:), column(:) !! pattern of J
      integer :: entry_of(n, n), partner(n), i, m, p

      self%n = n
      entry_of = 0
      do p = 1, size(row)
         entry_of(row(p), column(p)) = p
      end do
      call find_kinematic(n, entry_of, partner)
      self%kinematic = pack([(i, i=1, n)], partner > 0)
      self%partner = pack(partner, partner > 0)
      self%kept = pack([(i, i=1, n)], partner == 0)
      self%rate_entry = [(entry_of(self%kinematic(i), self%partner(i)), i=1, size(self%kinematic))]
      call plan_condensation(self, entry_of)
      m = size(self%kept)
      allocate (self%inner(size(self%row)), self%product(size(self%row)), self%coupling(size(self%coupling_entry)))
      allocate (self%rate(size(self%kinematic)), self%x(n_systems, 2, m), self%b_first(m), self%x_first(m))
      self%is_inverted = m <= most_inverted
      if (self%is_inverted) then
         allocate (self%inverse(n_systems, 2, m, m), self%first(m, m))
      else
         call sparse_lu_analyse(self%factors, m, self%row, self%column)
      end if
   end subroutine condensed_create

   !> Rows that may be condensed: none of them has the unknown of another one.
   pure subroutine find_kinematic(n, entry_of, partner)
      integer, intent(in) :: n
      integer, intent(in) :: entry_of(n, n) !! index of each entry in J, 0 if there is none
      integer, intent(out) :: partner(n)    !! unknown beside the diagonal, 0 in a row that is kept
      integer :: i, j

      partner = 0
      do i = 1, n
         if (entry_of(i, i) > 0 .or. count(entry_of(i, :) > 0) /= 1 .or. any(partner == i)) cycle
         j = maxloc(entry_of(i, :), dim=1)
         if (partner(j) == 0) partner(i) = j
      end do
   end subroutine find_kinematic

   !> Pattern of the condensed systems, and where the entries of J go in it.
   pure subroutine plan_condensation(self, entry_of)
      type(condensed_t), intent(inout) :: self
      integer, intent(in) :: entry_of(:, :)
      integer :: place_of(size(self%kept), size(self%kept)), position(self%n), i, j, k, p

      associate (kept => self%kept, kinematic => self%kinematic, m => size(self%kept))
         position = 0
         position(kept) = [(i, i=1, m)]
         place_of = 0
         do i = 1, m
            place_of(i, i) = 1
            do j = 1, m
               if (entry_of(kept(i), kept(j)) > 0) place_of(i, j) = 1
            end do
            do k = 1, size(kinematic)
               if (entry_of(kept(i), kinematic(k)) > 0) place_of(i, position(self%partner(k))) = 1
            end do
         end do
         allocate (self%row(count(place_of > 0)), self%column(count(place_of > 0)), self%coupling_start(m + 1))
         allocate (self%inner_entry(0), self%inner_place(0), self%coupling_entry(0), self%coupling_from(0), self%coupling_place(0))
         p = 0
         do i = 1, m
            do j = 1, m
               if (place_of(i, j) == 0) cycle
               p = p + 1
               self%row(p) = i
               self%column(p) = j
               place_of(i, j) = p
               if (entry_of(kept(i), kept(j)) == 0) cycle
               self%inner_entry = [self%inner_entry, entry_of(kept(i), kept(j))]
               self%inner_place = [self%inner_place, p]
            end do
            self%coupling_start(i) = size(self%coupling_entry) + 1
            do k = 1, size(kinematic)
               if (entry_of(kept(i), kinematic(k)) == 0) cycle
               self%coupling_entry = [self%coupling_entry, entry_of(kept(i), kinematic(k))]
               self%coupling_from = [self%coupling_from, k]
               self%coupling_place = [self%coupling_place, place_of(i, position(self%partner(k)))]
            end do
         end do
         self%coupling_start(m + 1) = size(self%coupling_entry) + 1
      end associate
   end subroutine plan_condensation

   !> Factor s_k I - J for the four complex shifts.
   pure subroutine condensed_factor(self, shift, jacobian, good)
      type(condensed_t), intent(inout) :: self
      real(wp), intent(in) :: shift(n_systems, 2) !! real and imaginary parts of the s_k
      real(wp), intent(in) :: jacobian(:)         !! entries of J
      logical, intent(out) :: good !! whether every pivot was large enough; if not, the factors are useless

      call condense(size(self%kinematic), size(self%coupling), size(self%inner_entry), size(self%inner), jacobian, &
                    self%rate_entry, self%coupling_entry, self%coupling_from, self%coupling_place, self%inner_entry, &
                    self%inner_place, self%rate, self%coupling, self%inner, self%product)
      if (size(self%kinematic) > 0) then
         good = all(shift(:, 1)**2 + shift(:, 2)**2 > (smallest_pivot*maxval(abs(self%rate)))**2)
         if (.not. good) return
         call invert(shift, self%inverse_shift)
      end if
      if (self%is_inverted) then
         call fill(size(self%kept), size(self%row), self%row, self%column, shift, self%inverse_shift, self%inner, self%product, &
                   self%inverse)
         call invert_blocks(size(self%kept), self%inverse, good)
         self%first = self%inverse(1, 1, :, :)
      else
         call sparse_lu_factor(self%factors, shift, self%inverse_shift, self%inner, self%product, good)
      end if
   end subroutine condensed_factor

   !> Collect C, J_vq, J_vv and K from the entries of J.
   pure subroutine condense(n_kinematic, n_coupling, n_inner, n_pattern, jacobian, rate_entry, coupling_entry, coupling_from, &
                            coupling_place, inner_entry, inner_place, rate, coupling, inner, product)
      integer, intent(in) :: n_kinematic, n_coupling, n_inner, n_pattern
      real(wp), intent(in) :: jacobian(*)
      integer, intent(in) :: rate_entry(n_kinematic), coupling_entry(n_coupling), coupling_from(n_coupling)
      integer, intent(in) :: coupling_place(n_coupling), inner_entry(n_inner), inner_place(n_inner)
      real(wp), intent(out) :: rate(n_kinematic), coupling(n_coupling), inner(n_pattern), product(n_pattern)
      integer :: p

      do p = 1, n_kinematic
         rate(p) = jacobian(rate_entry(p))
      end do
      inner = 0
      do p = 1, n_inner
         inner(inner_place(p)) = jacobian(inner_entry(p))
      end do
      product = 0
      do p = 1, n_coupling
         coupling(p) = jacobian(coupling_entry(p))
         product(coupling_place(p)) = product(coupling_place(p)) + coupling(p)*rate(coupling_from(p))
      end do
   end subroutine condense

   !> The condensed matrices, dense.
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

   !> Solve the four systems; b(:, 1, i) holds the real parts of component i, b(:, 2, i) the imaginary ones, then of x.
   pure subroutine condensed_solve(self, b)
      type(condensed_t), intent(inout) :: self !! its scratch changes
      real(wp), intent(inout) :: b(n_systems, 2, self%n)

      call forward(self%n, size(self%kinematic), size(self%kept), self%kinematic, self%kept, self%coupling_start, &
                   self%coupling_from, self%coupling, self%inverse_shift, b, self%x)
      if (self%is_inverted) then
         call apply_inverse(size(self%kept), self%inverse, self%x, self%kept, b)
      else
         call sparse_lu_solve(self%factors, self%x)
         b(:, :, self%kept) = self%x
      end if
      call backward(self%n, size(self%kinematic), self%kinematic, self%partner, self%rate, self%inverse_shift, b)
   end subroutine condensed_solve

   !> b_q/s_k in the place of b_q, and the right-hand sides of the condensed systems.
   pure subroutine forward(n, n_kinematic, m, kinematic, kept, start, from, coupling, inverse_shift, b, x)
      integer, intent(in) :: n, n_kinematic, m
      integer, intent(in) :: kinematic(n_kinematic), kept(m), start(m + 1), from(*)
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
         block = b(:, :, kept(i))
         do p = start(i), start(i + 1) - 1
            call add_scaled(coupling(p), b(:, :, kinematic(from(p))), block)
         end do
         x(:, :, i) = block
      end do
   end subroutine forward

   !> Unknowns of the kinematic rows: b_q/s_k + c v/s_k.
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

      call forward_first(self%n, size(self%kinematic), size(self%kept), self%kinematic, self%kept, self%coupling_start, &
                         self%coupling_from, self%coupling, self%inverse_shift(1, 1), b, self%b_first)
      if (self%is_inverted) then
         call apply_first_inverse(size(self%kept), self%first, self%b_first, self%x_first)
      else
         self%x_first = self%b_first
         call sparse_lu_solve_first(self%factors, self%x_first)
      end if
      call backward_first(self%n, size(self%kinematic), size(self%kept), self%kinematic, self%partner, self%kept, self%rate, &
                          self%inverse_shift(1, 1), self%x_first, b)
   end subroutine condensed_solve_first

   !> The same as `forward` for the first system.
   pure subroutine forward_first(n, n_kinematic, m, kinematic, kept, start, from, coupling, inverse_shift, b, x)
      integer, intent(in) :: n, n_kinematic, m
      integer, intent(in) :: kinematic(n_kinematic), kept(m), start(m + 1), from(*)
      real(wp), intent(in) :: coupling(*), inverse_shift
      real(wp), intent(inout) :: b(n)
      real(wp), intent(out) :: x(m)
      integer :: i, p

      do i = 1, n_kinematic
         b(kinematic(i)) = inverse_shift*b(kinematic(i))
      end do
      do i = 1, m
         x(i) = b(kept(i))
         do p = start(i), start(i + 1) - 1
            x(i) = x(i) + coupling(p)*b(kinematic(from(p)))
         end do
      end do
   end subroutine forward_first

   !> The condensed solution of the first system and what follows from it.
   pure subroutine backward_first(n, n_kinematic, m, kinematic, partner, kept, rate, inverse_shift, x, b)
      integer, intent(in) :: n, n_kinematic, m
      integer, intent(in) :: kinematic(n_kinematic), partner(n_kinematic), kept(m)
      real(wp), intent(in) :: rate(n_kinematic), inverse_shift
      real(wp), intent(in) :: x(m)
      real(wp), intent(inout) :: b(n)
      integer :: i

      do i = 1, m
         b(kept(i)) = x(i)
      end do
      do i = 1, n_kinematic
         b(kinematic(i)) = b(kinematic(i)) + rate(i)*(inverse_shift*b(partner(i)))
      end do
   end subroutine backward_first

end module evl_condensed_systems
