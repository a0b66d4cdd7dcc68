!> Influence functions and the mesh of a wheel asked by themselves.
module influence_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use evl_capi_types, only: c_status, status_to_c
   use evl_gear, only: gear_t
   use evl_influence_functions, only: compute_influence, influence_t, n_neighbours, n_other, n_own
   use evl_kinds, only: wp
   use evl_lobatto, only: lobatto_rule
   use evl_plane_element, only: elasticity_t, plane_strain, plane_stress
   use evl_plane_mesh, only: element_points
   use evl_sector_mesh, only: sector_mesh, sector_mesh_t
   use evl_status, only: has_failed, status_t
   use evl_tooth_outline, only: outline_of_gear
   implicit none (type, external)
   private

   public :: test_influence, test_sector_elements, test_sector_points

contains

   !> Samples of c and c_j for E = 1, in modules.
   subroutine test_influence(gear, rounding, hub_radius, order, nu, is_stress, rho, own, other, c_answer) bind(c)
      type(gear_t), intent(in) :: gear
      real(c_double), intent(in), value :: rounding, hub_radius, nu !! in modules
      integer(c_int), intent(in), value :: order, is_stress
      real(c_double), intent(inout) :: rho(0:n_own), own(0:n_own)
      real(c_double), intent(inout) :: other(0:n_other, 0:n_other, -n_neighbours:n_neighbours)
      type(c_status), intent(inout) :: c_answer
      type(influence_t) :: influence
      type(status_t) :: status
      type(elasticity_t) :: law

      law = plane_strain(nu)
      if (is_stress /= 0) law = plane_stress(nu)
      call compute_influence(outline_of_gear(gear, rounding), hub_radius, order, law, influence, status)
      call status_to_c(status, c_answer)
      if (has_failed(status)) return
      rho = influence%rho
      own = influence%own
      other = influence%other
   end subroutine test_influence

   !> Number of elements of half a sector.
   integer(c_int) function test_sector_elements(gear, rounding, hub_radius, order) result(n) bind(c)
      type(gear_t), intent(in) :: gear
      real(c_double), intent(in), value :: rounding, hub_radius
      integer(c_int), intent(in), value :: order
      type(sector_mesh_t) :: sector

      call sector_mesh(outline_of_gear(gear, rounding), hub_radius, order, sector)
      n = size(sector%row)
   end function test_sector_elements

   !> Their points (xy, along xi, along eta, element).
   subroutine test_sector_points(gear, rounding, hub_radius, order, n, xy) bind(c)
      type(gear_t), intent(in) :: gear
      real(c_double), intent(in), value :: rounding, hub_radius
      integer(c_int), intent(in), value :: order, n
      real(c_double), intent(inout) :: xy(2, 0:order, 0:order, n)
      type(sector_mesh_t) :: sector
      real(wp) :: x(0:order), w(0:order), d(0:order, 0:order)
      integer :: e

      call sector_mesh(outline_of_gear(gear, rounding), hub_radius, order, sector)
      call lobatto_rule(x, w, d)
      do e = 1, n
         call element_points(sector%mesh, e, x, xy(:, :, :, e))
      end do
   end subroutine test_sector_points

end module influence_calls
