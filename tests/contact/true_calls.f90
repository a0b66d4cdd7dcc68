!> Quasi-static mesh with wheels of finite elements: C calls that the kernel does not export.
module true_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use evl_influence_functions, only: influence_t, n_neighbours, n_other, n_own
   use evl_kinds, only: wp
   use evl_static_mesh, only: solve_static, static_mesh_t, static_state
   use evl_status, only: status_t
   use evl_wheel_compliance, only: compliance_from_influence, wheel_compliance_t
   use potential_calls, only: given_mesh, take_mesh
   implicit none (type, external)
   private

   public :: test_true_mesh

contains

   !> Quasi-static states of a mesh at positions under a force, with the samples of both wheels: h, h_0, stiffness, energy, code;
   !> force per width and zone of the pairs -1, 0, 1.
   subroutine test_true_mesh(given, rho, own, other, length, youngs, n_at, rho_a, force, numbers, forces, zones) bind(c)
      type(given_mesh), intent(in) :: given
      real(c_double), intent(in) :: rho(0:n_own, 2), own(0:n_own, 2), other(0:n_other, 0:n_other, -n_neighbours:n_neighbours, 2)
      real(c_double), intent(in), value :: length, youngs, force
      integer(c_int), intent(in), value :: n_at
      real(c_double), intent(in) :: rho_a(n_at)
      real(c_double), intent(inout) :: numbers(5, n_at), forces(3, n_at)
      integer(c_int), intent(inout) :: zones(3, n_at)
      type(static_mesh_t) :: mesh
      type(static_state) :: state
      type(status_t) :: status
      type(wheel_compliance_t) :: wheel
      type(influence_t) :: influence
      integer :: i, k, w

      call take_mesh(given, mesh)
      deallocate (mesh%a, mesh%b)
      do w = 1, 2
         influence%rho = rho(:, w)
         influence%own = own(:, w)
         influence%other = other(:, :, :, w)
         call compliance_from_influence(influence, length, youngs, wheel)
         if (w == 1) allocate (mesh%a, source=wheel)
         if (w == 2) allocate (mesh%b, source=wheel)
      end do
      do i = 1, n_at
         call solve_static(mesh, rho_a(i), force, state, status)
         numbers(:, i) = [state%h, state%h_0, state%stiffness, state%potential%energy, real(status%code, wp)]
         forces(:, i) = 0
         zones(:, i) = -1
         do k = 1, state%n ! pairs -1, 0, 1
            if (abs(state%numbers(k)) > 1) cycle
            forces(state%numbers(k) + 2, i) = state%potential%solution%force(k)
            zones(state%numbers(k) + 2, i) = state%feet(k)%zone
         end do
      end do
   end subroutine test_true_mesh

end module true_calls
