!> Which of several things hang together.
module evl_joined
   implicit none (type, external)
   private

   public :: joined_to

contains

   !> Which of n things links join to one of them, itself among them.
   pure function joined_to(first, a, b, counts, n) result(joined)
      integer, intent(in) :: first     !! the one
      integer, intent(in) :: a(:), b(:) !! the two ends of each link
      logical, intent(in) :: counts(:) !! whether a link is looked at
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

end module evl_joined
