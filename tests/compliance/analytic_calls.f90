!> Compliance by formulas and by tables asked by itself, and how it is asked.
module analytic_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use evl_analytic_compliance, only: analytic_samples, is_in_range
   use evl_gear, only: gear_t
   use evl_influence_functions, only: influence_t, n_neighbours, n_other, n_own
   use evl_kinds, only: lanes
   use evl_plane_element, only: plane_strain
   use evl_tooth_outline, only: outline_of_gear
   use evl_wheel_compliance, only: compliance_from_influence, compliance_from_table, coupling_at_t, own_at_t, wheel_compliance_t
   implicit none (type, external)
   private

   public :: test_analytic, test_ask_polynomial, test_ask_table

contains

   !> E c by formulas at the points of a flank, in modules; whether the wheel is where they were fitted.
   integer(c_int) function test_analytic(gear, rounding, hub_radius, nu, rho, c) result(fitted) bind(c)
      type(gear_t), intent(in) :: gear
      real(c_double), intent(in), value :: rounding, hub_radius, nu
      real(c_double), intent(inout) :: rho(0:n_own), c(0:n_own)

      call analytic_samples(outline_of_gear(gear, rounding), hub_radius, plane_strain(nu), rho, c)
      fitted = merge(1, 0, is_in_range(outline_of_gear(gear, rounding), hub_radius))
   end function test_analytic

   !> Ask a compliance: c, c', c'' at each place, and c_j with its derivatives at each place here and the next one there.
   subroutine ask(compliance, j, n, positions, own, coupled, in_lanes)
      type(wheel_compliance_t), intent(in) :: compliance
      integer, intent(in) :: j, n
      real(c_double), intent(in) :: positions(n)
      real(c_double), intent(inout) :: own(3, n), coupled(6, n), in_lanes(5, lanes)
      type(own_at_t) :: at
      type(coupling_at_t) :: pair
      integer :: i

      do i = 1, n
         call compliance%own(positions(i), at)
         own(:, i) = [at%value, at%slope, at%curvature]
         call compliance%coupling(j, positions(i), positions(mod(i, n) + 1), pair)
         coupled(:, i) = [pair%value, pair%by_here, pair%by_there, pair%here_here, pair%here_there, pair%there_there]
      end do
      call compliance%own_lanes(positions(:lanes), in_lanes(1, :), in_lanes(2, :))
      call compliance%coupling_lanes(j, positions(:lanes), positions(2:lanes + 1), in_lanes(3, :), in_lanes(4, :), in_lanes(5, :))
   end subroutine ask

   !> Of samples, in metres with a module of 1 m.
   subroutine test_ask_polynomial(rho, own, other, modulus, j, n, positions, values, coupled, in_lanes) bind(c)
      real(c_double), intent(in) :: rho(0:n_own), own(0:n_own), other(0:n_other, 0:n_other, -n_neighbours:n_neighbours)
      real(c_double), intent(in), value :: modulus
      integer(c_int), intent(in), value :: j, n
      real(c_double), intent(in) :: positions(n)
      real(c_double), intent(inout) :: values(3, n), coupled(6, n), in_lanes(5, lanes)
      type(wheel_compliance_t) :: compliance
      type(influence_t) :: influence

      influence = influence_t(rho, own, other)
      call compliance_from_influence(influence, 1.0_c_double, modulus, compliance)
      call ask(compliance, j, n, positions, values, coupled, in_lanes)
   end subroutine test_ask_polynomial

   !> Of a table; with n_next = 0 without c_1.
   subroutine test_ask_table(n_rho, rho, c, n_next, next, j, n, positions, values, coupled, in_lanes) bind(c)
      integer(c_int), intent(in), value :: n_rho, n_next, j, n
      real(c_double), intent(in) :: rho(n_rho), c(n_rho), next(n_next), positions(n)
      real(c_double), intent(inout) :: values(3, n), coupled(6, n), in_lanes(5, lanes)
      type(wheel_compliance_t) :: compliance

      call compliance_from_table(rho, c, next, compliance)
      call ask(compliance, j, n, positions, values, coupled, in_lanes)
   end subroutine test_ask_table

end module analytic_calls
