!> Coupled tooth pairs, for the tests: C calls that the kernel does not export.
module coupled_calls
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_int
   use evl_coupled_pairs, only: coupled_solution, energy_of_pairs, force_change_of_pairs, most_pairs, overlaps, solve_pairs
   implicit none (type, external)
   private

   public :: test_coupled_pairs

contains

   !> Forces, overlaps, energy and derivatives of the forces along n_ways of (dh - dC N, dLambda); the code.
   integer(c_int) function test_coupled_pairs(n, h, length, c, e_star, pushes_only, n_ways, ways, d_length, force, g, energy, &
                                              change, turns) result(code) bind(c)
      integer(c_int), intent(in), value :: n, n_ways
      real(c_double), intent(in), value :: length, e_star
      logical(c_bool), intent(in), value :: pushes_only
      real(c_double), intent(in) :: h(n), c(n, n), ways(n, n_ways), d_length(n_ways)
      real(c_double), intent(inout) :: force(n), g(n), energy, change(n, n_ways)
      integer(c_int), intent(inout) :: turns
      type(coupled_solution) :: solution
      real(c_double) :: compliance(most_pairs, most_pairs)
      integer :: i

      compliance(:n, :n) = c
      call solve_pairs(n, h, spread(length, 1, n), compliance, e_star, logical(pushes_only), solution, code)
      if (code /= 0) return
      force = solution%force(:n)
      turns = solution%turns
      call overlaps(n, h, compliance, solution, g)
      energy = energy_of_pairs(solution, h, e_star)
      change = ways
      do i = 1, n_ways
         call force_change_of_pairs(solution, spread(length, 1, n), e_star, spread(d_length(i), 1, n), change(:, i))
      end do
   end function test_coupled_pairs

end module coupled_calls
