!> Potential of a flank, and quasi-static mesh, with synthetic compliant wheels: C calls that the kernel does not export.
module potential_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_null_char, c_char
   use evl_coupled_pairs, only: most_pairs
   use evl_deviating_flanks, only: flank_value
   use evl_elastic_potential, only: elastic_potential, find_potential, force_derivatives, second_derivatives, wheel_forces
   use evl_flank_deviation, only: flank_branch, flank_slope
   use evl_kinds, only: wp
   use evl_pair_compliance, only: assemble_compliance, pair_compliance
   use evl_pair_point, only: by_a, by_b, find_feet, pair_depth, pair_feet, penetrate, turn_feet, zone_at
   use evl_static_mesh, only: solve_static, static_mesh_t, static_state
   use evl_status, only: code_ok, status_t
   use evl_tangent_line, only: find_tangent_line, tangent_line_t
   use evl_tip_edge, only: edge_t, end_of_flank
   use made_up_wheel, only: made_up_t, n_numbers, relieved_t
   implicit none (type, external)
   private

   public :: given_mesh, take_mesh, test_flank_potential, test_static_mesh

   !> A mesh as given by tests.
   type, bind(c) :: given_mesh
      real(c_double) :: sigma, r_b(2), ends(2), roundings(2), fillets(2)
      real(c_double) :: line, base_pitch, e_star, width, k_difference, reach
      real(c_double) :: scale, influence(n_numbers, 2), flanks(5, 2)
      integer(c_int) :: is_drive, couples
   end type given_mesh

contains

   !> The mesh of the kernel.
   subroutine take_mesh(given, mesh)
      type(given_mesh), intent(in) :: given
      type(static_mesh_t), intent(out) :: mesh
      type(made_up_t) :: wheel
      integer :: w

      do w = 1, 2
         associate (tip => mesh%tips(w))
            tip%edge = edge_t(given%r_b(w), given%r_b(3 - w), given%ends(w), given%roundings(w))
            tip%leaves = given%ends(w)
            tip%profile = flank_branch(border=given%ends(w), per_length=1.0_wp, linear=given%flanks(2, w), &
                                       offset=given%flanks(1, w))
            tip%takes_over = end_of_flank(tip%edge, tip%profile, given%line)
            tip%value = given%flanks(1, w) + given%flanks(2, w)*tip%takes_over
         end associate
      end do
      mesh%fillets = given%fillets
      mesh%line = given%line
      mesh%base_pitch = given%base_pitch
      mesh%e_star = given%e_star
      mesh%width = given%width
      mesh%k_difference = given%k_difference
      mesh%reach = given%reach
      mesh%is_drive = given%is_drive /= 0
      mesh%couples = given%couples /= 0
      wheel%scale = given%scale
      wheel%p = given%influence(:, 1)
      allocate (mesh%a, source=wheel)
      wheel%p = given%influence(:, 2)
      allocate (mesh%b, source=wheel)
      allocate (mesh%flanks, source=relieved_t(given%ends, given%flanks))
   end subroutine take_mesh

   !> Energy, forces on the wheels and all derivatives at local positions psi_A, psi_B, u_A, u_B; the code. Zones are
   !> determined where `zones` has -1, and returned.
   integer(c_int) function test_flank_potential(given, rho_a0, q, n, numbers, zones, h, force, energy, gradient, second, change, &
                                                wheels) result(code) bind(c)
      type(given_mesh), intent(in) :: given
      real(c_double), intent(in), value :: rho_a0 !! of pair 0 where all q are 0
      real(c_double), intent(in) :: q(6)
      integer(c_int), intent(in), value :: n
      integer(c_int), intent(in) :: numbers(n)
      integer(c_int), intent(inout) :: zones(n)
      real(c_double), intent(inout) :: h(n), force(n), energy, gradient(3), second(3, 3), change(n, 3)
      real(c_double), intent(inout) :: wheels(4) !! torque on A, on B, force on A along t, e
      type(static_mesh_t) :: mesh
      type(tangent_line_t) :: line
      type(pair_feet) :: feet(most_pairs)
      type(pair_depth) :: depths(most_pairs)
      type(pair_compliance) :: compliance
      type(elastic_potential) :: potential
      type(flank_value) :: flanks(2)
      type(flank_slope) :: turns(2)
      real(wp) :: rho_a, rho_b, changes(most_pairs, 3)
      integer :: k, w

      call take_mesh(given, mesh)
      call find_tangent_line(given%r_b(1) + given%r_b(2), given%line, q(5) - q(3), q(6) - q(4), line)
      do k = 1, n
         rho_a = rho_a0 - numbers(k)*given%base_pitch - given%r_b(1)*(line%angle + given%sigma*q(1))
         rho_b = given%line - rho_a0 + numbers(k)*given%base_pitch - given%r_b(2)*(line%angle + given%sigma*q(2))
         if (zones(k) < 0) zones(k) = zone_at(mesh%tips, rho_a, rho_b)
         call find_feet(mesh%tips, zones(k), rho_a, rho_b, line%rho, feet(k))
         do w = by_a, by_b
            call mesh%flanks%at(w, numbers(k), merge(feet(k)%rho(w), feet(k)%foot(w), w == feet(k)%wheel), w == feet(k)%wheel, &
                                flanks(w), turns(w))
         end do
         call turn_feet(mesh%turning_arm, turns, feet(k), flanks)
         call penetrate(feet(k), flanks, depths(k))
         h(k) = depths(k)%h
      end do
      call assemble_compliance(mesh%a, mesh%b, mesh%k_difference, mesh%is_drive, mesh%couples, n, numbers, feet(:n), compliance)
      call find_potential(n, depths(:n), feet(:n), compliance, mesh%e_star, mesh%width, .true., potential, code)
      if (code /= code_ok) return
      force = potential%solution%force(:n)
      energy = potential%energy
      gradient = potential%gradient
      second = second_derivatives(n, depths(:n), feet(:n), compliance, mesh%e_star, mesh%width, potential)
      changes = force_derivatives(n, depths(:n), feet(:n), compliance, mesh%e_star, potential)
      change = changes(:n, :)
      call wheel_forces(given%sigma, given%r_b(1), given%r_b(2), line, gradient, wheels(1), wheels(2), wheels(3:4))
   end function test_flank_potential

   !> Quasi-static mesh: numbers are h, h_0, stiffness, energy, all derivatives of U; and of up to six pairs number, zone, force per
   !> unit width, rho_A, rho_B, both feet.
   subroutine test_static_mesh(given, rho_a, force, numbers, n, pairs, code, message) bind(c)
      type(given_mesh), intent(in) :: given
      real(c_double), intent(in), value :: rho_a, force
      real(c_double), intent(inout) :: numbers(7), pairs(7, most_pairs)
      integer(c_int), intent(out) :: n, code
      character(kind=c_char), intent(out) :: message(320)
      type(static_mesh_t) :: mesh
      type(static_state) :: state
      type(status_t) :: status
      integer :: i

      call take_mesh(given, mesh)
      call solve_static(mesh, rho_a, force, state, status)
      code = status%code
      message = c_null_char
      do i = 1, len_trim(status%message)
         message(i) = status%message(i:i)
      end do
      n = state%n
      numbers = [state%h, state%h_0, state%stiffness, state%potential%energy, state%potential%gradient]
      do i = 1, n
         pairs(:, i) = [real(state%numbers(i), wp), real(state%feet(i)%zone, wp), state%potential%solution%force(i), &
                        state%feet(i)%rho(:2), state%feet(i)%foot]
      end do
   end subroutine test_static_mesh

end module potential_calls
