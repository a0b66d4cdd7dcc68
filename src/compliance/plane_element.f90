!> Stiffness of one curved spectral element of a plane body, E = 1, with its inner nodes condensed.
!>
!> Displacements and the map are polynomials of order p through the Gauss-Lobatto points, and the integral is summed at the same
!> points: at (a, b) only the nodes of row b and column a have a gradient. The sum is exact for the forces of a constant stress in
!> any such element. With inner unknowns i and those of the rim r, what is left is K_rr - K_ri K_ii^-1 K_ir.
!>
!> Source: Patera 1984; Canuto, Hussaini, Quarteroni, Zang 2007, 5.
module evl_plane_element
   use evl_condensation, only: cholesky, rows_below, subtract_products
   use evl_kinds, only: wp
   use evl_plane_mesh, only: place_of_rim
   implicit none (type, external)
   private

   public :: elasticity_t, element_stiffness, plane_strain, plane_stress

   !> Hooke's law in a plane: stresses by strains.
   type :: elasticity_t
      real(wp) :: direct = 0     !! sigma_x by epsilon_x
      real(wp) :: across = 0     !! sigma_x by epsilon_y
      real(wp) :: shear = 0      !! tau by gamma
      real(wp) :: plane_modulus = 0 !! E' over E: 1/(1 - nu^2) in plane strain, 1 in plane stress
      real(wp) :: tangential = 0 !! q E of Flamant's solution on a curved surface
   end type elasticity_t

contains

   !> Hooke's law for E = 1.
   pure type(elasticity_t) function plane_strain(nu) result(law)
      real(wp), intent(in) :: nu !! Poisson's ratio, 0 <= nu < 1/2

      law%direct = (1 - nu)/((1 + nu)*(1 - 2*nu))
      law%across = nu/((1 + nu)*(1 - 2*nu))
      law%shear = 1/(2*(1 + nu))
      law%plane_modulus = 1/(1 - nu**2)
      law%tangential = (1 - 2*nu)*(1 + nu)/2
   end function plane_strain

   pure type(elasticity_t) function plane_stress(nu) result(law)
      real(wp), intent(in) :: nu !! Poisson's ratio

      law%direct = 1/(1 - nu**2)
      law%across = nu/(1 - nu**2)
      law%shear = 1/(2*(1 + nu))
      law%plane_modulus = 1
      law%tangential = (1 - nu)/2
   end function plane_stress

   !> Condensed stiffness of the rim, unknowns (x, y) of place 1, of place 2 and so on; or that the map folds.
   subroutine element_stiffness(p, w, d, xy, law, rim, is_valid)
      integer, intent(in) :: p
      real(wp), intent(in) :: w(0:p), d(0:p, 0:p)  !! weights and derivatives of Gauss and Lobatto
      real(wp), intent(in) :: xy(2, 0:p, 0:p)      !! points
      type(elasticity_t), intent(in) :: law
      real(wp), intent(out) :: rim(8*p, 8*p)       !! all of it
      logical, intent(out) :: is_valid             !! false: the Jacobian is not positive at a point, or what follows fails
      real(wp), allocatable :: k(:, :)
      integer :: n_inner, i

      n_inner = 2*(p - 1)**2
      allocate (k(n_inner + 8*p, n_inner + 8*p), source=0.0_wp)
      call sum_points(p, w, d, xy, law, k, is_valid)
      if (.not. is_valid) return
      call cholesky(n_inner, k, size(k, 1), is_valid)
      if (.not. is_valid) return
      call rows_below(8*p, n_inner, k, size(k, 1), k(n_inner + 1, 1), size(k, 1))
      call subtract_products(8*p, n_inner, k(n_inner + 1, 1), size(k, 1), k(n_inner + 1, n_inner + 1), size(k, 1))
      do i = 1, 8*p
         rim(i:, i) = k(n_inner + i:, n_inner + i)
         rim(i, i:) = rim(i:, i)
      end do
   end subroutine element_stiffness

   !> Stiffness of all nodes, the inner ones first; the lower triangle counts.
   subroutine sum_points(p, w, d, xy, law, k, is_valid)
      integer, intent(in) :: p
      real(wp), intent(in) :: w(0:p), d(0:p, 0:p), xy(2, 0:p, 0:p)
      type(elasticity_t), intent(in) :: law
      real(wp), intent(inout) :: k(:, :)
      logical, intent(out) :: is_valid
      real(wp) :: by_xi(2), by_eta(2), jacobian, weight, g(2, 2*p + 1), xi_part, eta_part
      integer :: of(0:p, 0:p), nodes(2*p + 1), a, b, i, j, n, m

      n = 0
      do b = 0, p
         do a = 0, p
            i = place_of_rim(p, a, b)
            if (i == 0) n = n + 1
            of(a, b) = merge(2*n - 1, 2*(p - 1)**2 + 2*i - 1, i == 0)
         end do
      end do
      is_valid = .true.
      do b = 0, p
         do a = 0, p
            by_xi = matmul(xy(:, :, b), d(a, :))
            by_eta = matmul(xy(:, a, :), d(b, :))
            jacobian = by_xi(1)*by_eta(2) - by_xi(2)*by_eta(1)
            is_valid = jacobian > 0
            if (.not. is_valid) return
            weight = w(a)*w(b)*jacobian
            n = 0
            do i = 0, p
               call add(i, b, d(a, i), merge(d(b, b), 0.0_wp, i == a))
            end do
            do i = 0, p
               if (i /= b) call add(a, i, 0.0_wp, d(b, i))
            end do
            do j = 1, n
               associate (gx => weight*g(1, j), gy => weight*g(2, j), c => nodes(j))
                  do i = 1, n
                     m = nodes(i)
                     if (m < c) cycle
                     k(m, c) = k(m, c) + law%direct*g(1, i)*gx + law%shear*g(2, i)*gy
                     k(m + 1, c) = k(m + 1, c) + law%across*g(2, i)*gx + law%shear*g(1, i)*gy
                     k(m, c + 1) = k(m, c + 1) + law%across*g(1, i)*gy + law%shear*g(2, i)*gx
                     k(m + 1, c + 1) = k(m + 1, c + 1) + law%direct*g(2, i)*gy + law%shear*g(1, i)*gx
                  end do
               end associate
            end do
         end do
      end do

   contains

      !> Gradient of a node's polynomial here.
      subroutine add(at_a, at_b, xi, eta)
         integer, intent(in) :: at_a, at_b
         real(wp), intent(in) :: xi, eta !! its local derivatives

         n = n + 1
         nodes(n) = of(at_a, at_b)
         xi_part = xi/jacobian
         eta_part = eta/jacobian
         g(:, n) = [xi_part*by_eta(2) - eta_part*by_xi(2), eta_part*by_xi(1) - xi_part*by_eta(1)]
      end subroutine add

   end subroutine sum_points

end module evl_plane_element
