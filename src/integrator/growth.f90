!> Step size limit for growing modes.
!>
!> Radau IIA is L-stable: a step of h multiplies a mode with eigenvalue lambda by R(h lambda). For long steps |R| tends to 0
!> even if Re lambda > 0 and the mode grows. A mode that is not yet excited then stays below any tolerance, and error control
!> cannot detect the missing growth. Up to |h lambda| = 5.5 and for small Re lambda, the growth ln|R(h lambda)| equals h Re
!> lambda within 2e-5 |h lambda| (docs/theory/radau.md). For modes that grow faster than this deviation, no step exceeds that limit.
!>
!> Eigenvalues are computed only if a bound from the entries of J admits one beyond the limit, and if J differs from matrices
!> known to be without growth. In a large system they are computed for pieces of neighbouring states with all others fixed,
!> which takes time in proportion to its size.
module evl_growth
   use evl_archive, only: archive_t, serialize, serialize_reals
   use evl_eigenvalues, only: find_eigenvalues
   use evl_indices, only: indices
   use evl_jacobian_entries, only: apply_entries
   use evl_kinds, only: wp
   use evl_state_pieces, only: find_pieces, piece_t
   implicit none (type, external)
   private

   public :: follows_growth, growth_create, growth_forget, growth_t, judge_growth, limit_step, serialize_growth
   public :: step_may_be_too_long

   real(wp), parameter :: reach = 5.5_wp           !! |h lambda| up to which the method follows a growing mode
   real(wp), parameter :: aim = 5                  !! target for a shortened step: the frequency changes a little along the motion
   real(wp), parameter :: least_growth = 1.0e-4_wp !! Re lambda/|lambda| above which a mode counts as growing
   integer, parameter :: never_looked = 1000
   integer, parameter :: n_known = 4               !! number of stored matrices

   !> Matrices with known eigenvalues for some of the states, a piece.
   type, extends(piece_t) :: known_piece_t
      integer, allocatable :: entry(:)          !! indices of their entries in J
      integer, allocatable :: row(:), column(:) !! indices of these among the states of the piece
      real(wp), allocatable :: known(:, :)      !! [entries, n_known] matrices whose eigenvalues are known
      real(wp), allocatable :: re(:, :), length(:, :) !! [states, n_known] real parts and absolute values of their eigenvalues
      integer :: n_filled = 0                   !! number of stored matrices
      integer :: next = 1                       !! index of the matrix to overwrite next
   end type known_piece_t

   type :: growth_t
      real(wp) :: longest = huge(1.0_wp)       !! step that follows the growing modes; huge: none grows
      real(wp) :: re = 0, im = 0               !! the eigenvalue that limits it [1/time]
      integer :: steps = never_looked          !! since the last eigenvalue analysis
      logical :: shortens = .false.            !! steps are shortened for a growing mode
      logical :: wants_jacobian = .false.      !! the next step needs a new Jacobian, which determines the growth of that mode
      integer :: jacobians = 0                 !! number of Jacobians evaluated by the integrator at that time
      real(wp), private :: bound = 0           !! upper bound of the eigenvalues
      integer, private :: bound_jacobians = 0  !! number of Jacobians when it was computed
      integer, private :: n = 0                !! coupled states
      integer, allocatable, private :: row(:), column(:), entry(:) !! entries of J in them: row, column, index among all entries
      real(wp), allocatable, private :: scale(:)    !! [n] scales of the states
      real(wp), allocatable, private :: x(:)        !! [n] magnitudes of the states that give a close bound
      real(wp), allocatable, private :: product(:), x_piece(:) !! [n] scratch
      real(wp), allocatable, private :: matrix(:), eigenvalue_re(:), eigenvalue_im(:), length(:) !! scratch of the largest piece
      real(wp), allocatable, private :: difference(:) !! [entries] scratch: absolute values
      type(known_piece_t), allocatable, private :: pieces(:)
      real(wp), allocatable :: jacobian(:)     !! [nnz] buffer for df/dy at other points of a step
   end type growth_t

contains

   !> Allocate for the pattern of J in its first n states.
   subroutine growth_create(self, n, row, column, scale)
      type(growth_t), intent(out) :: self
      integer, intent(in) :: n
      integer, intent(in) :: row(:), column(:) !! of all entries
      real(wp), intent(in) :: scale(:)         !! of the states, > 0
      type(piece_t), allocatable :: pieces(:)
      integer :: i, largest, n_entries

      self%n = n
      n_entries = count(row <= n)
      allocate (self%entry(n_entries), self%row(n_entries), self%column(n_entries), self%scale(n), self%x(n))
      self%entry(:) = indices(row <= n)
      self%row(:) = row(self%entry)
      self%column(:) = column(self%entry)
      self%scale(:) = scale(:n)
      self%x(:) = scale(:n)
      call find_pieces(n, self%row, self%column, pieces)
      allocate (self%pieces(size(pieces)))
      largest = 0
      do i = 1, size(pieces)
         call take_piece(self, pieces(i)%states, self%pieces(i))
         largest = max(largest, size(pieces(i)%states))
      end do
      allocate (self%product(n), self%x_piece(largest), self%matrix(largest**2))
      allocate (self%eigenvalue_re(largest), self%eigenvalue_im(largest), self%length(largest))
      allocate (self%difference(size(self%entry)), self%jacobian(size(row)))
   end subroutine growth_create

   !> Collect the entries of J within a piece of states.
   pure subroutine take_piece(self, states, piece)
      type(growth_t), intent(in) :: self
      integer, intent(in) :: states(:)
      type(known_piece_t), intent(out) :: piece
      integer, allocatable :: inside(:)
      integer :: local_index(self%n), i

      local_index = 0
      do i = 1, size(states)
         local_index(states(i)) = i
      end do
      piece%states = states
      inside = indices(local_index(self%row) > 0 .and. local_index(self%column) > 0)
      piece%entry = self%entry(inside)
      piece%row = local_index(self%row(inside))
      piece%column = local_index(self%column(inside))
      allocate (piece%known(size(piece%entry), n_known), piece%re(size(states), n_known), piece%length(size(states), n_known))
   end subroutine take_piece

   !> Reset to the state after creation: stored matrices belong to one integration.
   pure subroutine growth_forget(self)
      type(growth_t), intent(inout) :: self
      integer :: i

      self%longest = huge(self%longest)
      self%steps = never_looked
      self%shortens = .false.
      self%wants_jacobian = .false.
      self%jacobians = 0
      self%bound_jacobians = 0
      do i = 1, size(self%pieces)
         self%pieces(i)%n_filled = 0
         self%pieces(i)%next = 1
      end do
      self%x(:) = self%scale
   end subroutine growth_forget

   !> Limit a step to the length that follows the growing modes.
   pure subroutine limit_step(self, h)
      type(growth_t), intent(inout) :: self
      real(wp), intent(inout) :: h

      if (.not. self%longest < h) return
      h = self%longest
      self%shortens = .true.
   end subroutine limit_step

   !> Check whether a step of h may be too long for some mode: no eigenvalue exceeds max (|J| x)_i/x_i, for any x > 0. Equation R10.
   !>
   !> Source: L. Collatz, Einschliessungssatz fuer die charakteristischen Zahlen von Matrizen, Math. Z. 48 (1942) 221.
   pure subroutine step_may_be_too_long(self, jacobian, n_jacobians, h, it_may)
      type(growth_t), intent(inout) :: self
      real(wp), intent(in) :: jacobian(:) !! [nnz]
      integer, intent(in) :: n_jacobians  !! its number, from 1: the bound of the same Jacobian is reused
      real(wp), intent(in) :: h
      logical, intent(out) :: it_may
      integer, parameter :: most_turns = 3 ! x is stored and so improves from step to step
      real(wp), parameter :: least = 1.0e-9_wp !! of a state's scale: x remains positive
      integer :: p, turn

      it_may = .not. h*self%bound <= reach
      if (n_jacobians == self%bound_jacobians) return
      self%bound_jacobians = n_jacobians
      do p = 1, size(self%entry)
         self%difference(p) = abs(jacobian(self%entry(p)))
      end do
      do turn = 1, most_turns
         call apply_entries(self%n, size(self%entry), self%row, self%column, self%difference, self%x, self%product)
         self%bound = maxval(self%product/self%x)
         it_may = .not. h*self%bound <= reach
         if (.not. it_may .or. .not. self%bound <= huge(h)) return
         self%x(:) = sqrt(self%x*max(self%product/self%bound, least*self%scale))
      end do
   end subroutine step_may_be_too_long

   !> Find the longest step that follows all growing modes, and the eigenvalue that limits it; h is the step to check.
   pure subroutine judge_growth(self, jacobian, h)
      type(growth_t), intent(inout) :: self
      real(wp), intent(in) :: jacobian(:) !! [nnz]
      real(wp), intent(in) :: h
      integer :: i

      self%longest = huge(self%longest)
      do i = 1, size(self%pieces)
         call judge_piece(self, i, size(self%pieces(i)%states), jacobian, h)
      end do
   end subroutine judge_growth

   !> `judge_growth` for one piece.
   pure subroutine judge_piece(self, index, n, jacobian, h)
      type(growth_t), intent(inout) :: self
      integer, intent(in) :: index, n !! index of the piece, and its number of states
      real(wp), intent(in) :: jacobian(:)
      real(wp), intent(in) :: h
      real(wp) :: length
      integer :: i, p
      logical :: found

      do i = 1, n
         self%x_piece(i) = self%x(self%pieces(index)%states(i))
      end do
      call compare(n, self%x_piece, jacobian, h, self%pieces(index), self%difference, self%product, found)
      if (found) return
      self%matrix(:n**2) = 0
      associate (piece => self%pieces(index))
         do p = 1, size(piece%entry)
            self%matrix(piece%row(p) + (piece%column(p) - 1)*n) = jacobian(piece%entry(p))
         end do
      end associate
      call find_eigenvalues(n, self%matrix, self%eigenvalue_re, self%eigenvalue_im, found)
      if (.not. found) return
      do i = 1, n
         length = hypot(self%eigenvalue_re(i), self%eigenvalue_im(i))
         self%length(i) = length
         if (.not. self%eigenvalue_re(i) > least_growth*length) cycle
         if (.not. length*self%longest > aim) cycle
         self%longest = aim/length
         self%re = self%eigenvalue_re(i)
         self%im = abs(self%eigenvalue_im(i))
      end do
      call remember(n, jacobian, self%eigenvalue_re, self%length, self%pieces(index))
   end subroutine judge_piece

   !> Whether a step of h follows the growing modes.
   pure logical function follows_growth(self, h)
      type(growth_t), intent(in) :: self
      real(wp), intent(in) :: h

      follows_growth = h <= reach/aim*self%longest
   end function follows_growth

   !> Check whether J is near a stored matrix without growth that a step of h would not follow.
   pure subroutine compare(n, x, jacobian, h, piece, difference, product, is_known)
      integer, intent(in) :: n                    !! states of the piece
      real(wp), intent(in) :: x(n)                !! their magnitudes
      real(wp), intent(in) :: jacobian(:)
      real(wp), intent(in) :: h
      type(known_piece_t), intent(in) :: piece
      real(wp), intent(inout) :: difference(*), product(n) !! scratch
      logical, intent(out) :: is_known
      real(wp) :: change
      integer :: k, p

      is_known = .false.
      do k = 1, piece%n_filled
         change = known_change(n, piece%re(:, k), piece%length(:, k), h)
         if (.not. change > 0) cycle
         do p = 1, size(piece%entry)
            difference(p) = abs(jacobian(piece%entry(p)) - piece%known(p, k))
         end do
         call apply_entries(n, size(piece%entry), piece%row, piece%column, difference, x, product)
         is_known = maxval(product/x) <= change
         if (is_known) return
      end do
   end subroutine compare

   !> Allowed distance of J from a matrix with these eigenvalues such that a step of h, or the next one, follows any growth; 0
   !> or less: there is growth that it does not follow.
   pure real(wp) function known_change(n, re, length, h) result(change)
      integer, intent(in) :: n
      real(wp), intent(in) :: re(n), length(n) !! of the eigenvalues: real parts and absolute values
      real(wp), intent(in) :: h
      real(wp), parameter :: share = 0.25_wp   !! fraction of the slowest decay that a change of J may remove
      real(wp), parameter :: ahead = 16        !! a step may be eight times as long as the previous one; twice that is safe
      integer :: i

      change = share*reach/h
      do i = 1, n
         if (2*h*length(i) > reach) change = min(change, -share*re(i))
         if (re(i) > least_growth*length(i) .and. ahead*h*length(i) > reach) change = 0
      end do
   end function known_change

   !> Store a matrix and its eigenvalues.
   pure subroutine remember(n, jacobian, re, length, piece)
      integer, intent(in) :: n
      real(wp), intent(in) :: jacobian(:), re(n), length(n)
      type(known_piece_t), intent(inout) :: piece
      integer :: p

      do p = 1, size(piece%entry)
         piece%known(p, piece%next) = jacobian(piece%entry(p))
      end do
      piece%re(:, piece%next) = re
      piece%length(:, piece%next) = length
      piece%n_filled = max(piece%n_filled, piece%next)
      piece%next = mod(piece%next, n_known) + 1
   end subroutine remember

   !> Serialise the data of growing modes.
   subroutine serialize_growth(archive, self)
      type(archive_t), intent(inout) :: archive
      type(growth_t), intent(inout) :: self
      integer :: i

      call serialize(archive, self%longest)
      call serialize(archive, self%re)
      call serialize(archive, self%im)
      call serialize(archive, self%steps)
      call serialize(archive, self%shortens)
      call serialize(archive, self%wants_jacobian)
      call serialize(archive, self%jacobians)
      call serialize(archive, self%bound)
      call serialize(archive, self%bound_jacobians)
      if (.not. allocated(self%pieces)) return ! a model without growing modes
      call serialize_reals(archive, size(self%x), self%x)
      do i = 1, size(self%pieces)
         call serialize_piece(archive, self%pieces(i))
      end do
   end subroutine serialize_growth

   !> Serialise the matrices of a piece.
   subroutine serialize_piece(archive, self)
      type(archive_t), intent(inout) :: archive
      type(known_piece_t), intent(inout) :: self

      call serialize_reals(archive, size(self%known), self%known)
      call serialize_reals(archive, size(self%re), self%re)
      call serialize_reals(archive, size(self%length), self%length)
      call serialize(archive, self%n_filled)
      call serialize(archive, self%next)
   end subroutine serialize_piece

end module evl_growth
