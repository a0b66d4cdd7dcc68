!> Elimination of unknowns as a C function, for tests; no part of the kernel's interface.
module condensation_calls
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_int
   use evl_condensation, only: symmetric_t
   implicit none (type, external)
   private

   public :: st_condense

contains

   !> Eliminate the first n of n + m unknowns; the lower triangle of what is left takes its place.
   logical(c_bool) function st_condense(n, m, a) result(good) bind(c)
      integer(c_int), value :: n, m
      real(c_double), intent(inout) :: a(n + m, n + m)
      type(symmetric_t) :: matrix
      logical :: is_definite
      integer :: i, k

      call matrix%create(n, n + m)
      do k = 1, n + m
         call matrix%set(k, k, a(k:, k))
      end do
      call matrix%eliminate(is_definite)
      good = is_definite
      do k = n + 1, n + m
         do i = k, n + m
            a(i, k) = matrix%element(i, k)
         end do
      end do
   end function st_condense

end module condensation_calls
