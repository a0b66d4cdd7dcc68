!> Stresses in fillets by elements, and their polynomials.
module stress_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use evl_capi_types, only: c_status, status_to_c
   use evl_fillet_stress, only: edge_stress, fillet_angle, fillet_arc, flank_range, stress_of_elements
   use evl_gear, only: gear_t
   use evl_influence_functions, only: compute_influence, influence_t
   use evl_influence_store, only: influence_by_store, influence_store_t
   use evl_kinds, only: wp
   use evl_lobatto, only: lobatto_rule
   use evl_nominal_root_stress, only: nominal_root_stress, nominal_root_t
   use evl_plane_element, only: elasticity_t, plane_strain, plane_stress
   use evl_root_stress, only: fillet_extremes, fillet_extremes_t, root_stress, root_stress_from_samples, root_stress_t, &
                              stress_at_arc
   use evl_status, only: has_failed, status_t
   use evl_stress_samples, only: compute_stress_samples, n_arcs, pack_stress_samples, stress_samples_t
   use evl_stress_store, only: stress_by_store
   use evl_tooth_outline, only: fillet_point, outline_of_gear, tooth_outline_t
   implicit none (type, external)
   private

   public :: test_common_store, test_edge_stress, test_fillet, test_flank_range, test_nominal_root, test_root_stress, &
             test_stress_of_elements

contains

   !> Arc of the whole fillet, and points (xy) at arcs of it, in modules.
   real(c_double) function test_fillet(gear, rounding, n, arcs, points) result(length) bind(c)
      type(gear_t), intent(in) :: gear
      real(c_double), intent(in), value :: rounding
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: arcs(n)
      real(c_double), intent(inout) :: points(2, n)
      type(tooth_outline_t) :: outline
      integer :: i

      outline = outline_of_gear(gear, rounding)
      length = fillet_arc(outline, 0.0_wp)
      do i = 1, n
         points(:, i) = fillet_point(outline, fillet_angle(outline, arcs(i)))
      end do
   end function test_fillet

   !> Radii of curvature between which loads are supported, in modules.
   subroutine test_flank_range(gear, rounding, hub_radius, order, low, high) bind(c)
      type(gear_t), intent(in) :: gear
      real(c_double), intent(in), value :: rounding, hub_radius
      integer(c_int), intent(in), value :: order
      real(c_double), intent(inout) :: low, high

      call flank_range(outline_of_gear(gear, rounding), hub_radius, order, low, high)
   end subroutine test_flank_range

   !> Sigma of tooth 0 at arcs of both fillets, under loads at rho of teeth -last .. last.
   subroutine test_stress_of_elements(gear, rounding, hub_radius, order, nu, is_stress, n_arcs, arcs, n_rho, rho, last, right, &
                                      left, outcome) bind(c)
      type(gear_t), intent(in) :: gear
      real(c_double), intent(in), value :: rounding, hub_radius, nu
      integer(c_int), intent(in), value :: order, is_stress, n_arcs, n_rho, last
      real(c_double), intent(in) :: arcs(n_arcs), rho(n_rho)
      real(c_double), intent(inout), dimension(n_arcs, n_rho, -last:last) :: right, left
      type(c_status), intent(inout) :: outcome
      type(status_t) :: status

      call stress_of_elements(outline_of_gear(gear, rounding), hub_radius, order, law_of(nu, is_stress), arcs, rho, last, right, &
                              left, status)
      call status_to_c(status, outcome)
   end subroutine test_stress_of_elements

   !> Stress at a position of a side with p + 1 nodes, from their displacements.
   real(c_double) function test_edge_stress(p, points, displacements, local, nu, is_stress) result(stress) bind(c)
      integer(c_int), intent(in), value :: p, is_stress
      real(c_double), intent(in) :: points(2, 0:p), displacements(2, 0:p)
      real(c_double), intent(in), value :: local, nu
      real(wp) :: x(0:p), w(0:p), d(0:p, 0:p)

      call lobatto_rule(x, w, d)
      stress = sum(edge_stress(x, d, points, local, law_of(nu, is_stress))*displacements)
   end function test_edge_stress

   !> Root stress by polynomials, twice from one store: sums of loads of unit sets.
   !>
   !> For each set of loads: values at all arcs of both fillets, their extremes (largest, least and the arcs of both; fillet), and
   !> the values of both fillets at an arc. Lengths in metres.
   subroutine test_root_stress(gear, rounding, hub_radius, order, nu, is_stress, n_loads, n_sets, flank, rho, j, force, arc, arcs, &
                               values, extremes, at_arc, outcome) bind(c)
      type(gear_t), intent(in) :: gear
      real(c_double), intent(in), value :: rounding, hub_radius, nu, arc
      integer(c_int), intent(in), value :: order, is_stress, n_loads, n_sets
      integer(c_int), intent(in) :: flank(n_loads, n_sets), j(n_loads, n_sets)
      real(c_double), intent(in) :: rho(n_loads, n_sets), force(n_loads, n_sets)
      real(c_double), intent(inout) :: arcs(0:n_arcs), values(0:n_arcs, 2, n_sets), extremes(4, 2, n_sets), at_arc(2, n_sets)
      type(c_status), intent(inout) :: outcome
      type(influence_store_t) :: store
      type(stress_samples_t) :: samples
      type(root_stress_t) :: wheel
      type(tooth_outline_t) :: outline
      type(fillet_extremes_t) :: extreme
      type(status_t) :: status
      real(wp) :: right(0:n_arcs), left(0:n_arcs)
      integer :: set, k, time

      outline = outline_of_gear(gear, rounding)
      do time = 1, 2
         call stress_by_store(store, outline, hub_radius, order, law_of(nu, is_stress), samples, status)
      end do
      call status_to_c(status, outcome)
      if (has_failed(status)) return
      call root_stress_from_samples(samples, outline, gear%normal_module, wheel)
      arcs = wheel%arcs
      values = 0
      do set = 1, n_sets
         do k = 1, n_loads
            call root_stress(wheel, flank(k, set), rho(k, set), j(k, set), right, left)
            values(:, 1, set) = values(:, 1, set) + force(k, set)*right
            values(:, 2, set) = values(:, 2, set) + force(k, set)*left
         end do
         do k = 1, 2
            extreme = fillet_extremes(wheel, values(:, k, set))
            extremes(:, k, set) = [extreme%largest, extreme%least, extreme%at_largest, extreme%at_least]
            at_arc(k, set) = stress_at_arc(wheel, values(:, k, set), arc)
         end do
      end do
   end subroutine test_root_stress

   !> Number of values that differ if one store serves compliance and root stress, each computed and then stored.
   integer(c_int) function test_common_store(gear, rounding, hub_radius, order, nu) result(n) bind(c)
      type(gear_t), intent(in) :: gear
      real(c_double), intent(in), value :: rounding, hub_radius, nu
      integer(c_int), intent(in), value :: order
      type(influence_store_t) :: store
      type(stress_samples_t) :: stress, exact_stress
      type(influence_t) :: influence, exact
      type(tooth_outline_t) :: outline
      type(status_t) :: status
      integer :: time

      outline = outline_of_gear(gear, rounding)
      call compute_influence(outline, hub_radius, order, plane_strain(nu), exact, status)
      call compute_stress_samples(outline, hub_radius, order, plane_strain(nu), exact_stress, status)
      n = 0
      do time = 1, 2
         call influence_by_store(store, outline, hub_radius, order, plane_strain(nu), influence, status)
         call stress_by_store(store, outline, hub_radius, order, plane_strain(nu), stress, status)
         if (has_failed(status)) then
            n = -1
            return
         end if
         n = n + count(abs(influence%own - exact%own) > 0) + count(abs(influence%other - exact%other) > 0) &
             + count(abs(pack_stress_samples(stress) - pack_stress_samples(exact_stress)) > 0)
      end do
   end function test_common_store

   !> Y_F, Y_S, q_s and Y_F Y_S cos(alpha) under a load at rho [modules]; 1 if they are valid.
   integer(c_int) function test_nominal_root(gear, rounding, rho, factors) result(is_valid) bind(c)
      type(gear_t), intent(in) :: gear
      real(c_double), intent(in), value :: rounding, rho
      real(c_double), intent(inout) :: factors(4)
      type(nominal_root_t) :: root

      root = nominal_root_stress(outline_of_gear(gear, rounding), rho)
      factors = [root%form_factor, root%stress_correction, root%notch_parameter, root%stress]
      is_valid = merge(1, 0, root%is_valid)
   end function test_nominal_root

   !> Hooke's law for E = 1.
   type(elasticity_t) function law_of(nu, is_stress) result(law)
      real(wp), intent(in) :: nu
      integer, intent(in) :: is_stress

      law = plane_strain(nu)
      if (is_stress /= 0) law = plane_stress(nu)
   end function law_of

end module stress_calls
