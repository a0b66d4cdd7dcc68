!> The look at modes that grow, for tests, as a C function.
module growth_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use evl_growth, only: growth_create, growth_forget, growth_t, judge_growth, step_may_be_too_long
   implicit none (type, external)
   private

   public :: rt_look_at_growth

contains

   !> Look at one Jacobian after the other, each for a step: may an eigenvalue be out of reach, how long a step follows those that
   !> grow, and the eigenvalue that asks for it. Where `anew` is not 0, another integration begins before it.
   subroutine rt_look_at_growth(n, nnz, row, column, scale, n_looks, jacobians, steps, anew, may_be, longest, re, im) bind(c)
      integer(c_int), value :: n, nnz, n_looks
      integer(c_int), intent(in) :: row(nnz), column(nnz), anew(n_looks)
      real(c_double), intent(in) :: scale(n), jacobians(nnz, n_looks), steps(n_looks)
      integer(c_int), intent(out) :: may_be(n_looks)
      real(c_double), intent(out) :: longest(n_looks), re(n_looks), im(n_looks)
      type(growth_t) :: growth
      integer :: i, number
      logical :: it_may

      call growth_create(growth, n, row + 1, column + 1, scale)
      number = 0
      do i = 1, n_looks
         if (anew(i) /= 0) then
            call growth_forget(growth)
            number = 0
         end if
         number = number + 1
         call step_may_be_too_long(growth, jacobians(:, i), number, steps(i), it_may)
         may_be(i) = merge(1, 0, it_may)
         call judge_growth(growth, jacobians(:, i), steps(i))
         longest(i) = growth%longest
         re(i) = growth%re
         im(i) = growth%im
      end do
   end subroutine rt_look_at_growth

end module growth_calls
