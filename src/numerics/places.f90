!> Places of what is so, and which of several things hang together. Places are not listed by `pack`, whose result gfortran's
!> library makes: where it finds no memory for that it ends the program by itself.
module evl_places
   implicit none (type, external)
   private

   public :: joined_to, places

contains

   !> Where a mask is true, in ascending order.
   pure function places(mask) result(found)
      logical, intent(in) :: mask(:)
      integer :: found(count(mask)), i, n

      n = 0
      do i = 1, size(mask)
         if (.not. mask(i)) cycle
         n = n + 1
         found(n) = i
      end do
   end function places

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

end module evl_places
