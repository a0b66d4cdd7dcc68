!> Elastic energy of all tooth pairs of a flank, and its gradient, which gives all of their elastic forces.
!>
!> The energy is a function of rho_A, rho_B and rho (evl_pair_point). Pairs are whole base pitches apart, so the three quantities of
!> one pair determine those of all. With the width b:
!>
!>    U = b max over N of [sum_k N_k h_k - W(N)]
!>    dU/dq = b [sum_k N_k dh_k/dq - 1/2 N dC/dq N - sum_k N_k**2/(2 pi E* rho) drho/dq]
!>
!> since U is stationary in N. For a pair k the middle term is N_k sum_l N_l dC_kl/dfoot_k dfoot_k/dq. It acts like a deviation of
!> its flanks with the slope s_k = sum_l N_l dC_kl/dfoot_k, half of the own term.
!>
!> Second derivatives: those of the terms at constant N, and r A**-1 r, r_k = dh_k/dq - (dC/dq N)_k - N_k/(pi E* rho) drho/dq.
module evl_elastic_potential
   use evl_coupled_pairs, only: coupled_solution, energy_of_pairs, force_change_of_pairs, most_pairs, solve_pairs
   use evl_kinds, only: pi, wp
   use evl_pair_compliance, only: pair_compliance
   use evl_pair_point, only: by_a, by_b, by_line, pair_depth, pair_feet
   use evl_tangent_line, only: tangent_line_t
   implicit none (type, external)
   private

   public :: find_potential, elastic_potential, force_derivatives, gradient_of_pair, second_derivatives, wheel_forces

   !> Energy, gradient and forces of the pairs of a flank.
   type :: elastic_potential
      type(coupled_solution) :: solution
      real(wp) :: energy = 0.0_wp                  !! U [J]
      real(wp) :: gradient(3) = 0.0_wp             !! dU/d(rho_A, rho_B, rho) [N]
      real(wp) :: slope(2, most_pairs) = 0.0_wp    !! s_k on A and on B [1]
   end type elastic_potential

contains

   !> Compute energy, gradient and forces. Equations F9, F10.
   pure subroutine find_potential(n, depths, feet, compliance, e_star, width, pushes_only, potential, code)
      integer, intent(in) :: n
      type(pair_depth), intent(in) :: depths(n)
      type(pair_feet), intent(in) :: feet(n)
      type(pair_compliance), intent(in) :: compliance
      real(wp), intent(in) :: e_star, width !! effective modulus [Pa], common face width [m]
      logical, intent(in) :: pushes_only    !! as in `solve_pairs`
      type(elastic_potential), intent(out) :: potential
      integer, intent(out) :: code          !! as in `solve_pairs`
      integer :: k, w

      if (n == 0) then
         code = 0
         return
      end if
      associate (solution => potential%solution, force => potential%solution%force)
         call solve_pairs(n, depths%h, abs(feet%rho(by_line)), compliance%c, e_star, pushes_only, solution, code)
         if (code /= 0) return
         potential%energy = width*energy_of_pairs(solution, depths%h, e_star)
         do k = 1, n
            do w = by_a, by_b
               potential%slope(w, k) = dot_product(compliance%d(k, :n, w), force(:n))
            end do
            potential%gradient = potential%gradient + gradient_of_pair(k, depths(k), feet(k), e_star, width, potential)
         end do
      end associate
   end subroutine find_potential

   !> Contribution of one pair to the gradient [N]. Equation F9.
   pure function gradient_of_pair(k, depth, feet, e_star, width, potential) result(gradient)
      integer, intent(in) :: k
      type(pair_depth), intent(in) :: depth
      type(pair_feet), intent(in) :: feet
      real(wp), intent(in) :: e_star, width
      type(elastic_potential), intent(in) :: potential
      real(wp) :: gradient(3)

      associate (force => potential%solution%force(k))
         gradient = width*force*(depth%d_h - matmul(feet%d_foot, potential%slope(:, k)))
         gradient(by_line) = gradient(by_line) - width*force**2/(2*pi*e_star*feet%rho(by_line))
      end associate
   end function gradient_of_pair

   !> Derivatives of the forces per unit width with respect to rho_A, rho_B and rho: (pair, length) [N/m^2].
   pure function force_derivatives(n, depths, feet, compliance, e_star, potential) result(change)
      integer, intent(in) :: n
      type(pair_depth), intent(in) :: depths(n)
      type(pair_feet), intent(in) :: feet(n)
      type(pair_compliance), intent(in) :: compliance
      real(wp), intent(in) :: e_star
      type(elastic_potential), intent(in) :: potential
      real(wp) :: change(most_pairs, 3)
      real(wp) :: along(most_pairs)
      integer :: i

      call residual_changes(n, depths, feet, compliance, potential, change)
      do i = 1, 3
         along = merge(1.0_wp, 0.0_wp, i == by_line)
         call force_change_of_pairs(potential%solution, feet%rho(by_line), e_star, along(:n), change(:, i))
      end do
   end function force_derivatives

   !> dh_k - (dC N)_k along each of the three lengths.
   pure subroutine residual_changes(n, depths, feet, compliance, potential, change)
      integer, intent(in) :: n
      type(pair_depth), intent(in) :: depths(n)
      type(pair_feet), intent(in) :: feet(n)
      type(pair_compliance), intent(in) :: compliance
      type(elastic_potential), intent(in) :: potential
      real(wp), intent(out) :: change(most_pairs, 3)
      integer :: k, l, w

      change = 0
      do k = 1, n
         change(k, :) = depths(k)%d_h - matmul(feet(k)%d_foot, potential%slope(:, k))
         do w = by_a, by_b
            do l = 1, n
               change(k, :) = change(k, :) - compliance%d(l, k, w)*potential%solution%force(l)*feet(l)%d_foot(:, w)
            end do
         end do
      end do
   end subroutine residual_changes

   !> Second derivatives of U [N/m]: the tangent stiffness of the forces. Equation SA5.
   pure function second_derivatives(n, depths, feet, compliance, e_star, width, potential) result(second)
      integer, intent(in) :: n
      type(pair_depth), intent(in) :: depths(n)
      type(pair_feet), intent(in) :: feet(n)
      type(pair_compliance), intent(in) :: compliance
      real(wp), intent(in) :: e_star, width
      type(elastic_potential), intent(in) :: potential
      real(wp) :: second(3, 3)
      real(wp) :: right(most_pairs, 3), change(most_pairs, 3)
      integer :: i, j, k, l, w

      second = 0
      if (n == 0) return
      associate (force => potential%solution%force, line => feet(1)%rho(by_line))
         do k = 1, n
            second = second + force(k)*depths(k)%d2_h
            do w = by_a, by_b
               second = second - force(k)*potential%slope(w, k)*feet(k)%d2_foot(:, :, w)
               do l = 1, n
                  second = second - force(k)*force(l)*( &
                           compliance%d_own(k, l, w)*outer(feet(k)%d_foot(:, w), feet(k)%d_foot(:, w)) &
                           + compliance%d_both(k, l, w)*outer(feet(k)%d_foot(:, w), feet(l)%d_foot(:, w)))
               end do
            end do
         end do
         second(by_line, by_line) = second(by_line, by_line) + sum(force(:n)**2)/(2*pi*e_star*line**2)
         call residual_changes(n, depths, feet, compliance, potential, right)
         change = force_derivatives(n, depths, feet, compliance, e_star, potential)
         right(:n, by_line) = right(:n, by_line) - force(:n)/(pi*e_star*line)
         do i = 1, 3
            do j = 1, 3 ! no matmul: it allocates its result, and a failed allocation ends the program
               second(j, i) = second(j, i) + dot_product(right(:n, j), change(:n, i))
            end do
         end do
         second = width*second
      end associate
   end function second_derivatives

   !> a b
   pure function outer(a, b)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: outer(3, 3)

      integer :: i

      do i = 1, 3
         outer(:, i) = a*b(i)
      end do
   end function outer

   !> Forces on the wheels from a gradient: torques about their axles, and the force on A along (t_0, e_0), opposite to that on B.
   !> Equation F11.
   pure subroutine wheel_forces(sigma, r_ba, r_bb, line, gradient, torque_a, torque_b, on_a)
      real(wp), intent(in) :: sigma      !! sense of the flank
      real(wp), intent(in) :: r_ba, r_bb !! base radii [m]
      type(tangent_line_t), intent(in) :: line
      real(wp), intent(in) :: gradient(3)
      real(wp), intent(out) :: torque_a, torque_b !! [N m]
      real(wp), intent(out) :: on_a(2)            !! [N]
      real(wp) :: across

      torque_a = sigma*r_ba*gradient(by_a)
      torque_b = sigma*r_bb*gradient(by_b)
      across = (r_ba*(gradient(by_a) + gradient(by_line)) + r_bb*(gradient(by_b) + gradient(by_line)))/line%rho
      on_a = gradient(by_line)*[-line%s, line%c] + across*[line%c, line%s]
   end subroutine wheel_forces

end module evl_elastic_potential
