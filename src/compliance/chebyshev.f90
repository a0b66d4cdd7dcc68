!> Polynomials through Chebyshev-Lobatto points.
!>
!> Points x_i = -cos(pi i/n), i = 0 .. n, in [-1, 1]. With T_k the Chebyshev polynomials, f = sum of a_k T_k.
module evl_chebyshev
   use evl_kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: chebyshev_coefficients, chebyshev_points, power_coefficients

contains

   ! Not vectorised: vector cosines of the C library differ in the last bits, and between processors.

   !> Chebyshev-Lobatto points from `low` to `high`.
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

   !> Convert a_k to coefficients b_k of powers, f = sum of b_k x**k, by T_k = 2 x T_k-1 - T_k-2.
   !>
   !> Valid: few coefficients, or rapidly decreasing ones: the coefficients of T_k reach 2**k
   pure function power_coefficients(a) result(b)
      real(wp), intent(in) :: a(0:) !! two or more
      real(wp) :: b(0:size(a) - 1)
      real(wp), dimension(0:size(a) - 1) :: before, last, next
      integer :: k

      before = 0
      before(0) = 1
      last = 0
      last(1) = 1
      b = a(0)*before + a(1)*last
      do k = 2, ubound(a, 1)
         next = 2*[0.0_wp, last(:ubound(last, 1) - 1)] - before
         b = b + a(k)*next
         before = last
         last = next
      end do
   end function power_coefficients

end module evl_chebyshev
