!> Johnson's force for the tests: C calls that the kernel does not export.
module johnson_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use evl_johnson, only: johnson_force, johnson_penetration, johnson_penetration_limit
   use evl_status, only: code_ok, code_out_of_domain
   use johnson_iteration_of_paper, only: johnson_force_limit, johnson_iteration, johnson_iteration_force
   implicit none (type, external)
   private

   public :: test_johnson_force, test_johnson_iteration, test_johnson_iteration_force, test_johnson_limits
   public :: test_johnson_penetration

contains

   !> Johnson's force per unit width with its derivatives.
   subroutine test_johnson_force(n, h, rho_sum, e_star, force, d_h, d_rho, codes) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: h(n), rho_sum(n), e_star(n)
      real(c_double), intent(out) :: force(n), d_h(n), d_rho(n)
      integer(c_int), intent(out) :: codes(n)
      real(c_double) :: margin(n)

      call johnson_force(h, rho_sum, e_star, force, d_h, d_rho, margin)
      codes = merge(code_ok, code_out_of_domain, margin > 0)
   end subroutine test_johnson_force

   !> The inverse.
   subroutine test_johnson_penetration(n, force, rho_sum, e_star, h, codes) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: force(n), rho_sum(n), e_star(n)
      real(c_double), intent(out) :: h(n)
      integer(c_int), intent(out) :: codes(n)

      call johnson_penetration(force, rho_sum, e_star, h, codes)
   end subroutine test_johnson_penetration

   !> The limits (15).
   subroutine test_johnson_limits(n, rho_sum, e_star, penetration, force) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: rho_sum(n), e_star(n)
      real(c_double), intent(out) :: penetration(n), force(n)

      penetration = johnson_penetration_limit(rho_sum)
      force = johnson_force_limit(rho_sum, e_star)
   end subroutine test_johnson_limits

   !> One turn of the paper's iteration (18).
   subroutine test_johnson_iteration(n, eta, nu, next) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: eta(n), nu(n)
      real(c_double), intent(out) :: next(n)

      next = johnson_iteration(eta, nu)
   end subroutine test_johnson_iteration

   !> The force by that iteration.
   subroutine test_johnson_iteration_force(n, h, rho_sum, e_star, start, tolerance, max_turns, force, &
                                           turns, codes) bind(c)
      integer(c_int), intent(in), value :: n, max_turns
      real(c_double), intent(in), value :: tolerance
      real(c_double), intent(in) :: h(n), rho_sum(n), e_star(n), start(n)
      real(c_double), intent(out) :: force(n)
      integer(c_int), intent(out) :: turns(n), codes(n)

      call johnson_iteration_force(h, rho_sum, e_star, start, tolerance, max_turns, force, turns, codes)
   end subroutine test_johnson_iteration_force

end module johnson_calls
