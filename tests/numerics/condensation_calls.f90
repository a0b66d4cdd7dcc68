!> Elimination of unknowns as a C function, for tests; no part of the kernel's interface.
module condensation_calls
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_int
   use evl_condensation, only: cholesky, rows_below, subtract_products
   implicit none (type, external)
   private

   public :: st_condense

contains

   !> Eliminate the first n of n + m unknowns, in place in the lower triangle.
   logical(c_bool) function st_condense(n, m, a) result(good) bind(c)
      integer(c_int), value :: n, m
      real(c_double), intent(inout) :: a(n + m, n + m)
      logical :: is_definite

      call cholesky(n, a, n + m, is_definite)
      good = is_definite
      if (.not. is_definite .or. m == 0) return
      call rows_below(m, n, a, n + m, a(n + 1, 1), n + m)
      call subtract_products(m, n, a(n + 1, 1), n + m, a(n + 1, n + 1), n + m)
   end function st_condense

end module condensation_calls
