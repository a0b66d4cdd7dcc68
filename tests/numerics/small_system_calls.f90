!> Small linear systems as a C function, for tests; no part of the kernel's interface.
module small_system_calls
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_int
   use evl_small_system, only: solve_small
   implicit none (type, external)
   private

   public :: st_solve

contains

   logical(c_bool) function st_solve(n, m, a, b) result(good) bind(c)
      integer(c_int), value :: n, m
      real(c_double), intent(inout) :: a(n, n), b(n, m)
      logical :: is_good

      call solve_small(a, b, is_good)
      good = is_good
   end function st_solve

end module small_system_calls
