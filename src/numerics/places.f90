!> Places of what is so. They are not listed by `pack`, whose result gfortran's library makes: where it finds no memory for that
!> it ends the program by itself.
module evl_places
   implicit none (type, external)
   private

   public :: places

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

end module evl_places
