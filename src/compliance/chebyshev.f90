!> Polynomials through Chebyshev-Lobatto points, with exact derivatives.
!>
!> At x_i = -cos(pi i/n), i = 0 .. n, in [-1, 1]. With T_k the Chebyshev polynomials, f = sum of a_k T_k; derivatives by
!> T_k' = k U_k-1.
module evl_chebyshev
   use evl_kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: chebyshev_coefficients, chebyshev_points, chebyshev_values

contains

   ! Not in vectors: those cosines of the C library have other bits, on every processor others.

   !> Points from `low` to `high`.
   pure function chebyshev_points(n, low, high) result(points)
      integer, intent(in) :: n !! intervals
      real(wp), intent(in) :: low, high
      real(wp) :: points(0:n)
      integer :: i

      !GCC$ novector
      do i = 0, n
         points(i) = (low + high)/2 - (high - low)/2*cos(pi*i/n)
      end do
      points(0) = low
      points(n) = high
   end function chebyshev_points

   !> Coefficients a_0 .. a_n from values at the points.
   pure function chebyshev_coefficients(values) result(a)
      real(wp), intent(in) :: values(0:)
      real(wp) :: a(0:size(values) - 1), weight
      integer :: n, i, k

      n = size(values) - 1
      a = 0
      do k = 0, n
         !GCC$ novector
         do i = 0, n
            weight = merge(0.5_wp, 1.0_wp, i == 0 .or. i == n)
            a(k) = a(k) + weight*values(i)*cos(pi*k*(n - i)/n)
         end do
         a(k) = a(k)*merge(1.0_wp, 2.0_wp, k == 0 .or. k == n)/n
      end do
   end function chebyshev_coefficients

   !> T_k(x), T_k'(x), T_k''(x), k = 0 .. n.
   pure subroutine chebyshev_values(x, t, dt, ddt)
      real(wp), intent(in) :: x
      real(wp), intent(out) :: t(0:), dt(0:), ddt(0:) !! n >= 1
      integer :: k

      t(0) = 1
      dt(0) = 0
      ddt(0) = 0
      t(1) = x
      dt(1) = 1
      ddt(1) = 0
      do k = 2, ubound(t, 1)
         t(k) = 2*x*t(k - 1) - t(k - 2)
         dt(k) = 2*t(k - 1) + 2*x*dt(k - 1) - dt(k - 2)
         ddt(k) = 4*dt(k - 1) + 2*x*ddt(k - 1) - ddt(k - 2)
      end do
   end subroutine chebyshev_values

end module evl_chebyshev
