!> Elements, meshes and their condensation asked by themselves, of bodies that are no wheels.
module element_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use evl_cyclic_wheel, only: wheel_response
   use evl_front, only: condense
   use evl_influence_functions, only: finish_own_tooth
   use evl_kinds, only: wp
   use evl_lobatto, only: lobatto_rule
   use evl_plane_element, only: elasticity_t, plane_strain, plane_stress
   use evl_plane_mesh, only: mesh_create, number_nodes, plane_mesh_t
   implicit none (type, external)
   private

   public :: test_condense, test_finish, test_lobatto, test_number_nodes, test_wheel_response

contains

   !> Points and weights of Gauss and Lobatto, and derivatives at the points by the values there.
   subroutine test_lobatto(p, x, w, d) bind(c)
      integer(c_int), intent(in), value :: p
      real(c_double), intent(inout) :: x(0:p), w(0:p), d(0:p, 0:p)

      call lobatto_rule(x, w, d)
   end subroutine test_lobatto

   !> Numbers of the nodes on the rims of elements between vertices; how many there are.
   integer(c_int) function test_number_nodes(p, n, corner, node) result(n_nodes) bind(c)
      integer(c_int), intent(in), value :: p, n
      integer(c_int), intent(in) :: corner(4, n)
      integer(c_int), intent(inout) :: node(4*p, n)
      type(plane_mesh_t) :: mesh

      call mesh_create(p, n, mesh)
      mesh%corner(:, :) = corner
      call number_nodes(mesh)
      node = mesh%node
      n_nodes = mesh%n_nodes
   end function test_number_nodes

   !> A body condensed onto unknowns and loads; 0, or the number of an element that folds, or -1 if something moves freely.
   integer(c_int) function test_condense(p, n, corner, group, side, nu, is_stress, n_unknowns, is_fixed, n_kept, kept, n_loads, &
                                         loads, condensed) result(failed) bind(c)
      integer(c_int), intent(in), value :: p, n, is_stress, n_unknowns, n_kept, n_loads
      integer(c_int), intent(in) :: corner(4, n), group(n), is_fixed(n_unknowns), kept(n_kept)
      real(c_double), intent(in) :: side(2, 0:p, 4, n), loads(n_unknowns, n_loads)
      real(c_double), intent(in), value :: nu
      real(c_double), intent(inout) :: condensed(n_kept + n_loads, n_kept + n_loads)
      type(plane_mesh_t) :: mesh
      type(elasticity_t) :: law
      real(wp) :: answer(n_kept + n_loads, n_kept + n_loads, 1)

      law = plane_strain(nu)
      if (is_stress /= 0) law = plane_stress(nu)
      call mesh_create(p, n, mesh)
      mesh%corner(:, :) = corner
      mesh%group(:) = group
      mesh%side(:, :, :, :) = side
      call number_nodes(mesh)
      call condense(mesh, law, reshape(is_fixed /= 0, [n_unknowns, 1]), kept, loads, answer, failed)
      if (failed == 0) condensed = answer(:, :, 1)
   end function test_condense

   !> E c from the mean displacements under two widths of the load.
   real(c_double) function test_finish(wide, narrow, w, rho, nu) bind(c)
      real(c_double), intent(in), value :: wide, narrow, w, rho, nu

      test_finish = finish_own_tooth(wide, narrow, w, rho, plane_strain(nu))
   end function test_finish

   !> A wheel from condensed halves of a sector; 0 if it is held.
   integer(c_int) function test_wheel_response(teeth, n_cut, n_loads, symmetric, antisymmetric, last, response) result(failed) &
      bind(c)
      integer(c_int), intent(in), value :: teeth, n_cut, n_loads, last
      real(c_double), intent(in), dimension(n_cut + n_loads, n_cut + n_loads) :: symmetric, antisymmetric
      real(c_double), intent(inout) :: response(n_loads, n_loads, 0:last)
      logical :: is_definite

      call wheel_response(teeth, n_cut, symmetric, antisymmetric, response, is_definite)
      failed = merge(0, 1, is_definite)
   end function test_wheel_response

end module element_calls
