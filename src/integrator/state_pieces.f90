!> Pieces of a large system: overlapping groups of neighbouring states for separate eigenvalue analyses.
!>
!> A small system is one piece. In a larger one the states are ordered by their dependencies, breadth first from one end of a
!> chain to the other. A piece has `span` of them, and the next piece begins in its middle. States on which very many others
!> depend belong to every piece. A kinematic row, q' = c v, belongs to the piece of its v.
!>
!> Source: E. Cuthill, J. McKee, Proc. 24th Nat. Conf. ACM (1969) 157 (the order).
module evl_state_pieces
   use evl_indices, only: indices
   implicit none (type, external)
   private

   public :: find_pieces, piece_t

   integer, parameter :: most_whole = 150 !! states of a system that is one piece
   integer, parameter :: span = 48        !! states of a piece, without those common to all
   integer, parameter :: hub_share = 4    !! a state is a hub if more than this part of all states, 1/4, depends on it

   type :: piece_t
      integer, allocatable :: states(:)   !! indices, ascending
   end type piece_t

contains

   !> Pieces of a system; a single piece with all states if the system is small enough.
   subroutine find_pieces(n, row, column, pieces)
      integer, intent(in) :: n
      integer, intent(in) :: row(:), column(:) !! pattern of its Jacobian
      type(piece_t), allocatable, intent(out) :: pieces(:)
      integer, allocatable :: chain(:)
      logical :: is_hub(n), belongs(n)
      integer :: partner(n), i, k, first

      call find_hubs(n, row, column, is_hub)
      if (n <= most_whole .or. count(is_hub) > span) then
         allocate (pieces(1))
         pieces(1)%states = [(i, i=1, n)]
         return
      end if
      call find_partners(n, row, column, partner)
      call find_chain(n, row, column, is_hub, chain)
      allocate (pieces(max(1, (size(chain) - 1)/(span/2))))
      do k = 1, size(pieces)
         first = (k - 1)*(span/2) + 1
         belongs = is_hub
         belongs(chain(first:min(first + span - 1, size(chain)))) = .true.
         if (k == size(pieces)) belongs(chain(first:)) = .true.
         do i = 1, n
            if (partner(i) == 0) cycle
            if (belongs(i) .or. belongs(partner(i))) belongs([i, partner(i)]) = .true.
         end do
         pieces(k)%states = indices(belongs)
      end do
   end subroutine find_pieces

   !> Hubs: states on which very many others depend.
   pure subroutine find_hubs(n, row, column, is_hub)
      integer, intent(in) :: n, row(:), column(:)
      logical, intent(out) :: is_hub(n)
      integer :: dependent(n), p

      dependent = 0
      do p = 1, size(row)
         if (row(p) /= column(p)) dependent(column(p)) = dependent(column(p)) + 1
      end do
      is_hub = hub_share*dependent > n
   end subroutine find_hubs

   !> The v of each kinematic row; 0 for other rows.
   pure subroutine find_partners(n, row, column, partner)
      integer, intent(in) :: n, row(:), column(:)
      integer, intent(out) :: partner(n)
      integer :: in_row(n), p

      in_row = 0
      do p = 1, size(row)
         in_row(row(p)) = in_row(row(p)) + 1
      end do
      partner = 0
      do p = 1, size(row)
         if (in_row(row(p)) == 1 .and. row(p) /= column(p)) partner(row(p)) = column(p)
      end do
   end subroutine find_partners

   !> All states except the hubs, with neighbours near each other; separate components follow one another.
   pure subroutine find_chain(n, row, column, is_hub, chain)
      integer, intent(in) :: n, row(:), column(:)
      logical, intent(in) :: is_hub(n)
      integer, allocatable, intent(out) :: chain(:)
      integer, allocatable :: neighbours(:)
      logical :: seen(n), visited(n)
      integer :: start(n + 1), begin, i, last

      call find_neighbours(n, row, column, is_hub, start, neighbours)
      allocate (chain(count(.not. is_hub)))
      seen = is_hub
      begin = 1
      last = 0
      do i = 1, n
         if (seen(i)) cycle
         visited = seen
         call walk(n, start, neighbours, i, begin, visited, chain, last)
         call walk(n, start, neighbours, chain(last), begin, seen, chain, last) ! again, from an end
         begin = last + 1
      end do
   end subroutine find_chain

   !> Neighbours of each state: those that it depends on, or that depend on it.
   pure subroutine find_neighbours(n, row, column, is_hub, start, neighbours)
      integer, intent(in) :: n, row(:), column(:)
      logical, intent(in) :: is_hub(n)
      integer, intent(out) :: start(n + 1) !! index of each state's first neighbour
      integer, allocatable, intent(out) :: neighbours(:)
      integer :: next(n), i, p

      next = 0
      do p = 1, size(row)
         if (is_hub(row(p)) .or. is_hub(column(p)) .or. row(p) == column(p)) cycle
         next(row(p)) = next(row(p)) + 1
         next(column(p)) = next(column(p)) + 1
      end do
      start(1) = 1
      do i = 1, n
         start(i + 1) = start(i) + next(i)
      end do
      next = start(:n)
      allocate (neighbours(start(n + 1) - 1))
      do p = 1, size(row)
         if (is_hub(row(p)) .or. is_hub(column(p)) .or. row(p) == column(p)) cycle
         neighbours(next(row(p))) = column(p)
         neighbours(next(column(p))) = row(p)
         next(row(p)) = next(row(p)) + 1
         next(column(p)) = next(column(p)) + 1
      end do
   end subroutine find_neighbours

   !> Breadth-first search of all states connected with one state.
   pure subroutine walk(n, start, neighbours, from, begin, seen, chain, last)
      integer, intent(in) :: n, start(n + 1), neighbours(:)
      integer, intent(in) :: from, begin !! first state, and its index in the chain
      logical, intent(inout) :: seen(n)
      integer, intent(inout) :: chain(:)
      integer, intent(inout) :: last     !! index of the last one; not intent(out), for which GCC 12 would warn where it inlines
      integer :: at, p

      chain(begin) = from
      seen(from) = .true.
      at = begin
      last = begin
      do while (at <= last)
         do p = start(chain(at)), start(chain(at) + 1) - 1
            if (seen(neighbours(p))) cycle
            last = last + 1
            chain(last) = neighbours(p)
            seen(neighbours(p)) = .true.
         end do
         at = at + 1
      end do
   end subroutine walk

end module evl_state_pieces
