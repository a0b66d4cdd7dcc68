!> Response of a whole wheel from one half of a sector: loads on one tooth, displacements on all.
!>
!> A sector between two cuts is symmetric about its middle line. Its half is therefore condensed onto the cut twice, with the middle
!> line supported as under symmetric (s) and under antisymmetric (a) loads. Displacements on the cuts are radial and tangential: u_R
!> on the right and u_L on the left cut. M is the reflection (tangential components change sign), v_s = (u_R + M u_L)/2,
!> v_a = (u_R - M u_L)/2, and the energy of the sector is v_s S_s v_s + v_a S_a v_a. In harmonic n, u_R = exp(i n gamma) u_L. With
!> theta = n gamma/2, u_L = exp(-i theta) (x_r, -i x_t):
!>
!>    v_s = D_s x,  v_a = i D_a x,    D_s = (cos theta, sin theta),  D_a = (sin theta, -cos theta)  for (radial, tangential)
!>    S_n = 2 (D_s S_s D_s + D_a S_a D_a)      real, symmetric; clamped at the hub, positive definite
!>
!> t_s, t_a are the shares of the cut in the loads, g_s = D_s t_s, g_a = D_a t_a. The displacement at position a of tooth k (counted
!> toward the side of the loaded flank) by a unit load at position b of tooth 0 is
!>
!>    G_k(a, b) = A(a, b) delta_k0 + 1/z sum over all n of [cos(n k gamma) P - sin(n k gamma) X](a, b)
!>    P = g_s S_n^-1 g_s + g_a S_n^-1 g_a,   X(a, b) = g_a(a) S_n^-1 g_s(b) - g_s(a) S_n^-1 g_a(b)
!>
!> where A is half the sum of both compliances with the cut fixed.
module evl_cyclic_wheel
   use evl_condensation, only: symmetric_t
   use evl_kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: harmonic_products, turn_to_polar, wheel_response

contains

   !> Transform the first unknowns of a condensed matrix, all on one ray, from x and y to radial and tangential.
   pure subroutine turn_to_polar(angle, n, matrix)
      real(wp), intent(in) :: angle !! of the ray [rad]
      integer, intent(in) :: n      !! unknowns on the ray, x and y alternating
      real(wp), intent(inout) :: matrix(:, :)
      real(wp) :: radial(size(matrix, 1)), c, s
      integer :: i

      c = cos(angle)
      s = sin(angle)
      do i = 1, n, 2
         radial = c*matrix(:, i) + s*matrix(:, i + 1)
         matrix(:, i + 1) = c*matrix(:, i + 1) - s*matrix(:, i)
         matrix(:, i) = radial
      end do
      do i = 1, n, 2
         radial = c*matrix(i, :) + s*matrix(i + 1, :)
         matrix(i + 1, :) = c*matrix(i + 1, :) - s*matrix(i, :)
         matrix(i, :) = radial
      end do
   end subroutine turn_to_polar

   !> G_k(a, b) for k = 0 .. n_teeth, from both condensed matrices in polar components. Equation C2.
   subroutine wheel_response(teeth, n_cut, symmetric, antisymmetric, response, is_definite)
      integer, intent(in) :: teeth                        !! z
      integer, intent(in) :: n_cut                        !! unknowns on the cut, radial and tangential alternating; then the loads
      real(wp), intent(in) :: symmetric(:, :), antisymmetric(:, :)
      real(wp), intent(out) :: response(:, :, 0:)         !! (displaced at, loaded at, tooth)
      logical, intent(out) :: is_definite
      real(wp), allocatable :: products(:, :)
      real(wp) :: theta, turned, share
      integer :: n_loads, n, k, a, b

      n_loads = size(response, 1)
      allocate (products(2*n_loads, 2*n_loads))
      response = 0
      response(:, :, 0) = -(symmetric(n_cut + 1:, n_cut + 1:) + antisymmetric(n_cut + 1:, n_cut + 1:))/2
      do n = 0, teeth/2
         theta = pi*n/teeth
         call harmonic_products(theta, n_cut, symmetric, antisymmetric, products, is_definite)
         if (.not. is_definite) return
         share = merge(1.0_wp, 2.0_wp, n == 0 .or. 2*n == teeth)/teeth
         do k = 0, ubound(response, 3)
            turned = 2*theta*k
            do b = 1, n_loads
               do a = 1, n_loads
                  response(a, b, k) = response(a, b, k) - share*( &
                                      cos(turned)*(products(a, b) + products(n_loads + a, n_loads + b)) &
                                      - sin(turned)*(products(n_loads + a, b) - products(a, n_loads + b)))
               end do
            end do
         end do
      end do
   end subroutine wheel_response

   !> Products -(g_s, g_a) S_n^-1 (g_s, g_a) of a harmonic. Equation C2.
   subroutine harmonic_products(theta, n_cut, symmetric, antisymmetric, products, is_definite)
      real(wp), intent(in) :: theta                       !! n gamma/2 [rad]
      integer, intent(in) :: n_cut
      real(wp), intent(in) :: symmetric(:, :), antisymmetric(:, :)
      real(wp), intent(out) :: products(:, :)             !! g_s of all loads, then g_a
      logical, intent(out) :: is_definite
      type(symmetric_t) :: stiffness                      !! with the loads below; Schur complement: the products
      real(wp) :: by_s(n_cut), by_a(n_cut)
      integer :: n_loads, i, k

      n_loads = size(products, 1)/2
      by_s(1::2) = cos(theta)
      by_s(2::2) = sin(theta)
      by_a(1::2) = sin(theta)
      by_a(2::2) = -cos(theta)
      call stiffness%create(n_cut, n_cut + 2*n_loads)
      do i = 1, n_cut
         call stiffness%set(i, i, 2*(by_s(i)*by_s(i:)*symmetric(i:n_cut, i) + by_a(i)*by_a(i:)*antisymmetric(i:n_cut, i)))
         call stiffness%set(n_cut + 1, i, by_s(i)*symmetric(n_cut + 1:, i))
         call stiffness%set(n_cut + n_loads + 1, i, by_a(i)*antisymmetric(n_cut + 1:, i))
      end do
      products = 0
      call stiffness%eliminate(is_definite)
      if (.not. is_definite) return
      do i = 1, 2*n_loads
         do k = i, 2*n_loads
            products(k, i) = stiffness%element(n_cut + k, n_cut + i)
            products(i, k) = products(k, i)
         end do
      end do
   end subroutine harmonic_products

end module evl_cyclic_wheel
