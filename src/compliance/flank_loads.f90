!> Unit loads on a narrow arc of the involute, along its normals, and the equivalent nodal loads of the mesh.
!>
!> The load is p(s) = 35/(32 w) (1 - (s/w)^2)^3 on |s| < w, smooth enough for the elements. The same weights give the mean
!> displacement under it.
module evl_flank_loads
   use evl_kinds, only: wp
   use evl_lobatto, only: lagrange
   implicit none (type, external)
   private

   public :: load_part, load_shape, put_load

   integer, parameter, public :: n_gauss = 14 !! points of the part of a load on one side

contains

   !> p(s), with s from the middle of the load. Equation C6.
   elemental real(wp) function load_shape(s, w) result(load)
      real(wp), intent(in) :: s, w

      load = 35/(32*w)*max(0.0_wp, 1 - (s/w)**2)**3
   end function load_shape

   !> Part of a load on one side of an element: Gauss points and the load of each.
   pure subroutine load_part(x, weights, from, to, middle, w, s, weight)
      real(wp), intent(in) :: x(n_gauss), weights(n_gauss) !! Gauss' rule
      real(wp), intent(in) :: from, to    !! arc at the ends of the side
      real(wp), intent(in) :: middle, w   !! position and half width of the load
      real(wp), intent(out) :: s(n_gauss), weight(n_gauss)
      real(wp) :: low, high

      low = max(min(from, to), middle - w)
      high = max(low, min(max(from, to), middle + w))
      s = low + (high - low)*(1 + x)/2
      weight = load_shape(s - middle, w)*weights*(high - low)/2
   end subroutine load_part

   !> Add the part of a load to the loads of the unknowns.
   pure subroutine put_load(x, nodes, from, to, s, force, load)
      real(wp), intent(in) :: x(:)             !! Gauss-Lobatto points
      integer, intent(in) :: nodes(:)          !! of the side; their spacing in arc is that of the points x
      real(wp), intent(in) :: from, to         !! arc at its ends
      real(wp), intent(in) :: s(n_gauss)
      real(wp), intent(in) :: force(2, n_gauss) !! x and y at the points
      real(wp), intent(inout) :: load(:)       !! of each unknown
      real(wp) :: values(size(x))
      integer :: k

      do k = 1, n_gauss
         values = lagrange(x, 2*(s(k) - from)/(to - from) - 1)
         load(2*nodes - 1) = load(2*nodes - 1) + values*force(1, k)
         load(2*nodes) = load(2*nodes) + values*force(2, k)
      end do
   end subroutine put_load

end module evl_flank_loads
