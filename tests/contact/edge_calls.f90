!> Tip edges, for the tests: C calls that the kernel does not export.
module edge_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use evl_flank_deviation, only: flank_branch
   use evl_tip_edge, only: edge_geometry, edge_t, end_of_flank, evaluate_edge
   implicit none (type, external)
   private

   public :: test_edge_end, test_edge_place

contains

   !> S and the foot with their derivatives, arm and rotation, in the order of `edge_geometry`; the last is 1 if there is a tangent.
   subroutine test_edge_place(n, edge, x, rho, values) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: edge(4), x(n), rho(n)
      real(c_double), intent(out) :: values(15, n)
      type(edge_geometry) :: at
      integer :: i

      do i = 1, n
         call evaluate_edge(edge_t(edge(1), edge(2), edge(3), edge(4)), x(i), rho(i), at)
         values(:, i) = [at%gap, at%d_x, at%d_rho, at%d_xx, at%d_x_rho, at%d_rho_rho, at%foot, at%foot_x, at%foot_rho, &
                         at%foot_xx, at%foot_x_rho, at%foot_rho_rho, at%arm, at%turn, merge(1.0_c_double, 0.0_c_double, at%exists)]
      end do
   end subroutine test_edge_place

   !> End of a relieved flank, from which the edge is in contact.
   real(c_double) function test_edge_end(edge, slope, rho) result(x) bind(c)
      real(c_double), intent(in) :: edge(4)
      real(c_double), intent(in), value :: slope, rho

      x = end_of_flank(edge_t(edge(1), edge(2), edge(3), edge(4)), &
                       flank_branch(border=edge(3), per_length=1.0_c_double, linear=slope), rho)
   end function test_edge_end

end module edge_calls
