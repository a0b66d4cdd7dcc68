!> Points, weights and derivatives of Gauss-Lobatto interpolation, and Gauss' quadrature.
!>
!> Gauss-Lobatto points are -1, 1 and the roots of P_p'; the weights 2/(p (p+1) P_p(x)^2) integrate degree 2p-1 exactly. With
!> L_p = P_p, the derivative of the polynomial through values at the points is d_ij = L_p(x_i)/(L_p(x_j) (x_i - x_j)),
!> d_00 = -p (p+1)/4 = -d_pp, other d_ii = 0.
!>
!> Source: Canuto, Hussaini, Quarteroni, Zang 2006, Spectral Methods, 2.3.
module evl_lobatto
   use evl_kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: gauss_rule, lagrange, lobatto_rule

   integer, parameter :: newton_turns = 50

contains

   !> P_n, P_n-1 at x.
   pure subroutine legendre(n, x, value, before)
      integer, intent(in) :: n
      real(wp), intent(in) :: x
      real(wp), intent(out) :: value, before
      real(wp) :: next
      integer :: k

      before = 0
      value = 1
      do k = 1, n
         next = ((2*k - 1)*x*value - (k - 1)*before)/k
         before = value
         value = next
      end do
   end subroutine legendre

   !> Points ascending from -1 to 1, weights, and the matrix of derivatives at the points from the values at the points.
   pure subroutine lobatto_rule(x, w, d)
      real(wp), intent(out) :: x(0:), w(0:)   !! p+1 each
      real(wp), intent(out) :: d(0:, 0:)      !! (derivative at, value at)
      real(wp) :: value(0:size(x) - 1), before, step
      integer :: p, i, j, turn

      p = size(x) - 1
      do i = 0, p
         x(i) = -cos(pi*i/p)
         do turn = 1, newton_turns
            ! the roots of (1 - x^2) P_p' = p (P_p-1 - x P_p)
            call legendre(p, x(i), value(i), before)
            step = (x(i)*value(i) - before)/((p + 1)*value(i))
            x(i) = x(i) - step
            if (abs(step) < epsilon(1.0_wp)) exit
         end do
         call legendre(p, x(i), value(i), before)
         w(i) = 2/(p*(p + 1)*value(i)**2)
      end do
      d = 0
      do j = 0, p
         do i = 0, p
            if (i /= j) d(i, j) = value(i)/(value(j)*(x(i) - x(j)))
         end do
      end do
      d(0, 0) = -p*(p + 1)/4.0_wp
      d(p, p) = -d(0, 0)
   end subroutine lobatto_rule

   !> Gauss' points in (-1, 1) and weights; exact to degree 2n-1.
   pure subroutine gauss_rule(x, w)
      real(wp), intent(out) :: x(:), w(:)
      real(wp) :: value, before, step
      integer :: n, i, turn

      n = size(x)
      do i = 1, n
         x(i) = -cos(pi*(i - 0.25_wp)/(n + 0.5_wp))
         do turn = 1, newton_turns
            call legendre(n, x(i), value, before)
            step = value*(1 - x(i)**2)/(n*(before - x(i)*value))
            x(i) = x(i) - step
            if (abs(step) < epsilon(1.0_wp)) exit
         end do
         call legendre(n, x(i), value, before)
         w(i) = 2*(1 - x(i)**2)/(n*before)**2
      end do
   end subroutine gauss_rule

   !> Lagrange polynomials of the points (1 at one point and 0 at the others), evaluated at one position.
   pure function lagrange(points, at) result(values)
      real(wp), intent(in) :: points(:), at
      real(wp) :: values(size(points)), below
      integer :: i, k

      values = 1
      do i = 1, size(points)
         below = 1
         do k = 1, size(points)
            if (k == i) cycle
            values(i) = values(i)*(at - points(k))
            below = below*(points(i) - points(k))
         end do
         values(i) = values(i)/below
      end do
   end function lagrange

end module evl_lobatto
