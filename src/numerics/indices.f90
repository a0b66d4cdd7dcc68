!> Indices of the true elements of a mask, and connected items. `pack` is not used: gfortran's library allocates its result
!> and, on failure, ends the program.
module evl_indices
   implicit none (type, external)
   private

   public :: joined_to, indices

contains

   !> Indices of the true elements of a mask, ascending.
   pure function indices(mask) result(found)
      logical, intent(in) :: mask(:)
      integer :: found(count(mask)), i, n

      n = 0
      do i = 1, size(mask)
         if (.not. mask(i)) cycle
         n = n + 1
         found(n) = i
      end do
   end function indices

   !> Mask of the items, out of n, that links connect to a given one, including itself.
   pure function joined_to(first, a, b, counts, n) result(joined)
      integer, intent(in) :: first     !! index of the given item
      integer, intent(in) :: a(:), b(:) !! the two ends of each link
      logical, intent(in) :: counts(:) !! whether a link is considered
      integer, intent(in) :: n
      logical :: joined(n)
      integer :: before, i

      joined = .false.
      joined(first) = .true.
      do
         before = count(joined)
         do i = 1, size(a)
            if (counts(i) .and. (joined(a(i)) .or. joined(b(i)))) joined([a(i), b(i)]) = .true.
         end do
         if (count(joined) == before) exit
      end do
   end function joined_to

end module evl_indices
