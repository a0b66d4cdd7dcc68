!> Stiffness of one curved spectral element of a plane body, E = 1, with its inner nodes condensed.
!>
!> Displacements and the map are polynomials of order p through the Gauss-Lobatto points. The integral is summed at the same points:
!> at (a, b) only the nodes of row b and column a have a gradient. The sum is exact for the forces of a constant stress in any such
!> element. With inner unknowns i and those of the rim r, the result is K_rr - K_ri K_ii^-1 K_ir.
!>
!> Source: Patera 1984; Canuto, Hussaini, Quarteroni, Zang 2007, 5.
module evl_plane_element
   use evl_condensation, only: height, row_start, symmetric_t
   use evl_kinds, only: wp
   use evl_plane_mesh, only: rim_index
   implicit none (type, external)
   private

   public :: elasticity_t, element_stiffness, plane_strain, plane_stress

   !> Hooke's law in a plane: stresses from strains.
   type :: elasticity_t
      real(wp) :: direct = 0     !! sigma_x per epsilon_x
      real(wp) :: across = 0     !! sigma_x per epsilon_y
      real(wp) :: shear = 0      !! tau per gamma
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

   !> Stiffness after elimination of the inner unknowns; Schur complement: (x, y) of rim node 1, of rim node 2 and so on.
   subroutine element_stiffness(p, w, d, xy, law, stiffness, is_valid)
      integer, intent(in) :: p
      real(wp), intent(in) :: w(0:p), d(0:p, 0:p)  !! weights and derivatives of the Gauss-Lobatto rule
      real(wp), intent(in) :: xy(2, 0:p, 0:p)      !! points
      type(elasticity_t), intent(in) :: law
      type(symmetric_t), intent(inout) :: stiffness !! may contain another element of this order; is overwritten completely
      logical, intent(out) :: is_valid             !! false: the Jacobian is not positive at a point, or the elimination fails

      if (.not. allocated(stiffness%numbers)) call stiffness%create(2*(p - 1)**2, 2*(p + 1)**2)
      call sum_points(p, w, d, xy, law, stiffness, is_valid)
      if (is_valid) call stiffness%eliminate(is_valid)
   end subroutine element_stiffness

   !> Stiffness of all nodes, the inner ones first.
   !>
   !> At a point (a, b) the gradients are d_ai grad xi of node (i, b) and d_bj grad eta of node (a, j). The points of a row or
   !> column therefore couple its nodes, and the points (k, j) and (i, l) couple nodes (i, j) and (k, l).
   subroutine sum_points(p, w, d, xy, law, stiffness, is_valid)
      integer, intent(in) :: p
      real(wp), intent(in) :: w(0:p), d(0:p, 0:p), xy(2, 0:p, 0:p)
      type(elasticity_t), intent(in) :: law
      type(symmetric_t), intent(inout) :: stiffness
      logical, intent(out) :: is_valid
      real(wp), dimension(2, 2, 0:p, 0:p) :: along_xi, along_eta, mixed !! by the components of both gradients, weighted
      real(wp) :: across(2, 2), down(2, 2, 0:p)
      real(wp) :: of_point((p/height + 1)*height, 0:p) !! d transposed, padded with 0
      integer, dimension(0:p, 0:p) :: at, row !! row of a node's x, and its row_start
      integer :: a, b, i, j

      call weigh_points(p, w, d, xy, law, along_xi, along_eta, mixed, is_valid)
      if (.not. is_valid) return
      of_point = 0
      of_point(:p + 1, :) = transpose(d)
      at = rows_of_nodes(p)
      row = row_start(stiffness%fill, at)
      do b = 0, p
         do a = 0, p
            do i = 0, p
               down(:, :, i) = d(i, a)*mixed(:, :, i, b)
            end do
            do j = 0, p
               across = d(j, b)*mixed(:, :, a, j)
               do i = 0, p
                  if (at(i, j) < at(a, b)) cycle
                  associate (m => row(i, j) + height*at(a, b), k => stiffness%numbers)
                     k(m) = d(a, i)*across(1, 1) + d(b, j)*down(1, 1, i)
                     k(m + 1) = d(a, i)*across(2, 1) + d(b, j)*down(1, 2, i)
                     k(m + height) = d(a, i)*across(1, 2) + d(b, j)*down(2, 1, i)
                     k(m + height + 1) = d(a, i)*across(2, 2) + d(b, j)*down(2, 2, i)
                  end associate
               end do
            end do
         end do
      end do
      do i = 0, p
         call add_line(at(:, i), row(:, i), along_xi(:, :, :, i))
         call add_line(at(i, :), row(i, :), along_eta(:, :, i, :))
      end do

   contains

      !> Add the points of a row or column, which couple its nodes. Products of two elements of d are avoided: their rounding error
      !> would be the same in all elements, and c would be four times less accurate.
      subroutine add_line(line, row, c)
         integer, intent(in) :: line(0:p), row(0:p) !! its part of `at` and `row`
         real(wp), intent(in) :: c(2, 2, 0:p)     !! symmetric
         real(wp) :: xx(height), xy(height), yy(height), by_n(3)
         integer :: from, n, q, i

         do n = 0, p
            do from = 0, p, height
               xx = 0
               xy = 0
               yy = 0
               do q = 0, p
                  by_n = d(q, n)*[c(1, 1, q), c(2, 1, q), c(2, 2, q)]
                  !$omp simd
                  do i = 1, height
                     xx(i) = xx(i) + of_point(from + i, q)*by_n(1)
                     xy(i) = xy(i) + of_point(from + i, q)*by_n(2)
                     yy(i) = yy(i) + of_point(from + i, q)*by_n(3)
                  end do
               end do
               do i = 1, min(height, p - from + 1)
                  if (line(from + i - 1) < line(n)) cycle
                  associate (m => row(from + i - 1) + height*line(n), k => stiffness%numbers)
                     k(m) = k(m) + xx(i)
                     k(m + 1) = k(m + 1) + xy(i)
                     k(m + height) = k(m + height) + xy(i)
                     k(m + height + 1) = k(m + height + 1) + yy(i)
                  end associate
               end do
            end do
         end do
      end subroutine add_line

   end subroutine sum_points

   !> Stiffness of each point between the directions of the element, weighted.
   pure subroutine weigh_points(p, w, d, xy, law, along_xi, along_eta, mixed, is_valid)
      integer, intent(in) :: p
      real(wp), intent(in) :: w(0:p), d(0:p, 0:p), xy(2, 0:p, 0:p)
      type(elasticity_t), intent(in) :: law
      real(wp), dimension(2, 2, 0:p, 0:p), intent(out) :: along_xi, along_eta, mixed
      logical, intent(out) :: is_valid
      real(wp) :: by_xi(2), by_eta(2), jacobian, xi(2), eta(2)
      integer :: a, b

      do b = 0, p
         do a = 0, p
            by_xi = matmul(xy(:, :, b), d(a, :))
            by_eta = matmul(xy(:, a, :), d(b, :))
            jacobian = by_xi(1)*by_eta(2) - by_xi(2)*by_eta(1)
            is_valid = jacobian > 0
            if (.not. is_valid) return
            xi = [by_eta(2), -by_eta(1)]/jacobian
            eta = [-by_xi(2), by_xi(1)]/jacobian
            along_xi(:, :, a, b) = w(a)*w(b)*jacobian*by_gradients(law, xi, xi)
            along_eta(:, :, a, b) = w(a)*w(b)*jacobian*by_gradients(law, eta, eta)
            mixed(:, :, a, b) = w(a)*w(b)*jacobian*by_gradients(law, xi, eta)
         end do
      end do
   end subroutine weigh_points

   !> Stress per strain, between two gradients.
   pure function by_gradients(law, g, h) result(c)
      type(elasticity_t), intent(in) :: law
      real(wp), intent(in) :: g(2), h(2)
      real(wp) :: c(2, 2)

      c(1, 1) = law%direct*g(1)*h(1) + law%shear*g(2)*h(2)
      c(2, 1) = law%across*g(2)*h(1) + law%shear*g(1)*h(2)
      c(1, 2) = law%across*g(1)*h(2) + law%shear*g(2)*h(1)
      c(2, 2) = law%direct*g(2)*h(2) + law%shear*g(1)*h(1)
   end function by_gradients

   !> Row of the x of each node: inner nodes first, then those of the rim in their order.
   pure function rows_of_nodes(p) result(at)
      integer, intent(in) :: p
      integer :: at(0:p, 0:p)
      integer :: a, b, i, n

      n = 0
      do b = 0, p
         do a = 0, p
            i = rim_index(p, a, b)
            if (i == 0) n = n + 1
            at(a, b) = merge(2*n - 1, 2*(p - 1)**2 + 2*i - 1, i == 0)
         end do
      end do
   end function rows_of_nodes

end module evl_plane_element
