!> Vibrations that grow: how long a step may be to follow them.
!>
!> Radau IIA is L-stable: of a mode with eigenvalue lambda a step of h leaves R(h lambda), and |R| falls to 0 in long steps even
!> where Re lambda > 0 and the mode grows. As long as it was not excited it stays below any tolerance in that way, and error
!> control cannot know that it should have grown. Up to |h lambda| = 5.5 its growth ln|R(h lambda)| is h Re lambda but for
!> 2e-5 |h lambda|, where Re lambda is small (docs/radau.md): no step is longer than that for a mode that grows faster.
!>
!> Eigenvalues are sought only where one could be out of reach, by a bound from the entries of J, and where J differs from those
!> of which it is known that nothing grows.
module evl_growth
   use evl_eigenvalues, only: find_eigenvalues
   use evl_jacobian_entries, only: apply_entries
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: growth_t, growth_create, growth_forget, limit_step, may_be_out_of_reach, judge_growth, follows_growth

   real(wp), parameter :: reach = 5.5_wp           !! |h lambda| up to which the method follows a mode that grows
   real(wp), parameter :: aim = 5                  !! what a step is cut to: the frequency changes a little along the motion
   real(wp), parameter :: least_growth = 1.0e-4_wp !! Re lambda/|lambda| of a mode that counts as growing
   integer, parameter :: never_looked = 1000
   integer, parameter :: n_known = 4               !! matrices that are kept

   type :: growth_t
      real(wp) :: longest = huge(1.0_wp)       !! step that follows the modes that grow; huge: none does
      real(wp) :: re = 0, im = 0               !! the eigenvalue that asks for it [1/time]
      integer :: steps = never_looked          !! since eigenvalues were looked at
      logical :: shortens = .false.            !! steps are shorter for a mode that grows
      logical :: wants_jacobian = .false.      !! that mode will grow as the Jacobian of the next step says
      integer :: jacobians = 0                 !! that the integrator had made by then
      real(wp), private :: bound = 0           !! of the eigenvalues
      integer, private :: bound_jacobians = 0  !! that had been made when it was found
      integer, private :: n = 0                !! states that depend on each other
      integer, allocatable, private :: row(:), column(:), entry(:) !! entries of J in them: places, numbers among all entries
      real(wp), allocatable, private :: scale(:)    !! [n] of the states
      real(wp), allocatable, private :: x(:)        !! [n] sizes of the states that make the bound a close one
      real(wp), allocatable, private :: product(:)  !! [n] scratch
      real(wp), allocatable, private :: matrix(:, :), eigenvalue_re(:), eigenvalue_im(:) !! [n, n], [n] scratch
      real(wp), allocatable, private :: difference(:) !! [entries] scratch: absolute values
      real(wp), allocatable, private :: known(:, :) !! [entries, n_known] matrices of which no mode grows
      real(wp), private :: known_change(n_known) = -1 !! how far J may be from them
      real(wp), private :: known_step(n_known) = 0 !! for steps up to this one
      integer, private :: next = 1             !! which of them goes first
      real(wp), allocatable :: jacobian(:)     !! [nnz] room for df/dy where the integrator asks for one
   end type growth_t

contains

   !> Allocate for the pattern of J in its first n states.
   pure subroutine growth_create(self, n, row, column, scale)
      type(growth_t), intent(out) :: self
      integer, intent(in) :: n
      integer, intent(in) :: row(:), column(:) !! of all entries
      real(wp), intent(in) :: scale(:)         !! of the states, > 0
      integer :: p, n_entries

      self%n = n
      n_entries = count(row <= n)
      allocate (self%entry(n_entries), self%row(n_entries), self%column(n_entries), self%scale(n), self%x(n))
      self%entry(:) = pack([(p, p=1, size(row))], row <= n)
      self%row(:) = row(self%entry)
      self%column(:) = column(self%entry)
      self%scale(:) = scale(:n)
      self%x(:) = scale(:n)
      allocate (self%product(n), self%matrix(n, n), self%eigenvalue_re(n), self%eigenvalue_im(n))
      allocate (self%difference(size(self%entry)), self%known(size(self%entry), n_known), self%jacobian(size(row)))
   end subroutine growth_create

   !> Be as after creation: what is known belongs to one integration.
   pure subroutine growth_forget(self)
      type(growth_t), intent(inout) :: self

      self%longest = huge(self%longest)
      self%steps = never_looked
      self%shortens = .false.
      self%wants_jacobian = .false.
      self%jacobians = 0
      self%bound_jacobians = 0
      self%known_change = -1
      self%next = 1
      self%x(:) = self%scale
   end subroutine growth_forget

   !> Make a step no longer than the modes that grow allow.
   pure subroutine limit_step(self, h)
      type(growth_t), intent(inout) :: self
      real(wp), intent(inout) :: h

      if (.not. self%longest < h) return
      h = self%longest
      self%shortens = .true.
   end subroutine limit_step

   !> Whether a step of h could be too long for some mode: no eigenvalue is larger than max (|J| x)_i/x_i, for any x > 0.
   !>
   !> Source: L. Collatz, Einschliessungssatz fuer die charakteristischen Zahlen von Matrizen, Math. Z. 48 (1942) 221.
   pure subroutine may_be_out_of_reach(self, jacobian, n_jacobians, h, it_may)
      type(growth_t), intent(inout) :: self
      real(wp), intent(in) :: jacobian(:) !! [nnz]
      integer, intent(in) :: n_jacobians  !! its number, from 1: of the same one the bound is known
      real(wp), intent(in) :: h
      logical, intent(out) :: it_may
      integer, parameter :: most_turns = 3 ! x stays, and so becomes better from step to step
      real(wp), parameter :: least = 1.0e-9_wp !! of a state's scale: x stays positive
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
   end subroutine may_be_out_of_reach

   !> Find the longest step that follows all modes that grow, and the eigenvalue that asks for it; a step of h is wanted.
   pure subroutine judge_growth(self, jacobian, h)
      type(growth_t), intent(inout) :: self
      real(wp), intent(in) :: jacobian(:) !! [nnz]
      real(wp), intent(in) :: h
      real(wp) :: length, least_decay
      integer :: i, p
      logical :: found

      self%longest = huge(self%longest)
      call compare(self, jacobian, h, found)
      if (found) return
      self%matrix = 0
      do p = 1, size(self%entry)
         self%matrix(self%row(p), self%column(p)) = jacobian(self%entry(p))
      end do
      call find_eigenvalues(self%n, self%matrix, self%eigenvalue_re, self%eigenvalue_im, found)
      if (.not. found) return
      least_decay = reach/h
      do i = 1, self%n
         length = hypot(self%eigenvalue_re(i), self%eigenvalue_im(i))
         if (2*h*length > reach) least_decay = min(least_decay, -self%eigenvalue_re(i))
         if (.not. self%eigenvalue_re(i) > least_growth*length .or. .not. length*self%longest > aim) cycle
         self%longest = aim/length
         self%re = self%eigenvalue_re(i)
         self%im = abs(self%eigenvalue_im(i))
      end do
      if (self%longest < huge(h) .or. .not. least_decay > 0) return
      call remember(self, jacobian, 2*h, least_decay)
   end subroutine judge_growth

   !> Whether a step of h follows the modes that grow.
   pure logical function follows_growth(self, h)
      type(growth_t), intent(in) :: self
      real(wp), intent(in) :: h

      follows_growth = h <= reach/aim*self%longest
   end function follows_growth

   !> Whether J is near one of which it is known that nothing grows that a step of h would not follow.
   pure subroutine compare(self, jacobian, h, is_known)
      type(growth_t), intent(inout) :: self !! its scratch changes
      real(wp), intent(in) :: jacobian(:)
      real(wp), intent(in) :: h
      logical, intent(out) :: is_known
      integer :: k, p

      is_known = .false.
      do k = 1, n_known
         if (.not. h <= self%known_step(k) .or. self%known_change(k) < 0) cycle
         do p = 1, size(self%entry)
            self%difference(p) = abs(jacobian(self%entry(p)) - self%known(p, k))
         end do
         call apply_entries(self%n, size(self%entry), self%row, self%column, self%difference, self%x, self%product)
         is_known = maxval(self%product/self%x) <= self%known_change(k)
         if (is_known) return
      end do
   end subroutine compare

   !> Keep a matrix: up to steps of `step` all modes decay, the slowest by `decay`.
   pure subroutine remember(self, jacobian, step, decay)
      type(growth_t), intent(inout) :: self
      real(wp), intent(in) :: jacobian(:), step, decay
      real(wp), parameter :: share = 0.25_wp !! of the decay: how much of it a change of J may take away
      integer :: p

      do p = 1, size(self%entry)
         self%known(p, self%next) = jacobian(self%entry(p))
      end do
      self%known_step(self%next) = step
      self%known_change(self%next) = share*decay
      self%next = mod(self%next, n_known) + 1
   end subroutine remember

end module evl_growth
