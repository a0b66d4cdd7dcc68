!> c and c_j of finite elements as polynomials of the position on the flank: one formula for one state and for eight.
!>
!> They are in powers of x, where x is rho scaled to [-1, 1]. The coefficients are at most about 15 times the largest c, so no
!> significant digits are lost. Sums of products in short chains take less than half the time of recursions. The degrees n_own = 16
!> and n_other = 8 are written out, since a loop over lanes that contains a loop is not vectorised.
!>
!> Beyond both ends c is extrapolated linearly, so that its curvature jumps there; c_j is extrapolated by its polynomial.
module evl_flank_polynomials
   use evl_chebyshev, only: chebyshev_coefficients, power_coefficients
   use evl_influence_functions, only: n_other, n_own
   use evl_kinds, only: lanes, wp
   implicit none (type, external)
   private

   public :: double_at, double_in_lanes, double_polynomial, double_through, double_values_in_lanes
   public :: single_at, single_in_lanes, single_polynomial, single_through

   !> Polynomial c. Coefficients of x**k; those of the derivatives with respect to rho.
   type :: single_polynomial
      real(wp) :: low = 0, high = 0 !! rho at x = -1 and 1 [m]
      real(wp) :: stretch = 0       !! dx/drho [1/m]
      real(wp), dimension(0:n_own) :: a = 0, da = 0, dda = 0
   end type single_polynomial

   !> Polynomial c_j. Coefficients of x**k x'**i; those of the derivatives with respect to rho.
   type :: double_polynomial
      real(wp) :: low = 0, stretch = 0 !! as in `single_polynomial`
      real(wp), dimension(0:n_other, 0:n_other) :: a = 0, da = 0, dda = 0
   end type double_polynomial

contains

   !> Interpolate values at the Chebyshev points from low to high.
   pure subroutine single_through(low, high, values, polynomial)
      real(wp), intent(in) :: low, high, values(0:n_own)
      type(single_polynomial), intent(out) :: polynomial

      polynomial%low = low
      polynomial%high = high
      polynomial%stretch = 2/(high - low)
      polynomial%a = power_coefficients(chebyshev_coefficients(values))
      polynomial%da = derivative(polynomial%a)*polynomial%stretch
      polynomial%dda = derivative(polynomial%da)*polynomial%stretch
   end subroutine single_through

   !> Interpolate values at pairs of Chebyshev points.
   pure subroutine double_through(low, high, values, polynomial)
      real(wp), intent(in) :: low, high, values(0:n_other, 0:n_other)
      type(double_polynomial), intent(out) :: polynomial
      integer :: i

      polynomial%low = low
      polynomial%stretch = 2/(high - low)
      do i = 0, n_other
         polynomial%a(:, i) = power_coefficients(chebyshev_coefficients(values(:, i)))
      end do
      do i = 0, n_other
         polynomial%a(i, :) = power_coefficients(chebyshev_coefficients(polynomial%a(i, :)))
      end do
      do i = 0, n_other
         polynomial%da(:, i) = derivative(polynomial%a(:, i))*polynomial%stretch
         polynomial%dda(:, i) = derivative(polynomial%da(:, i))*polynomial%stretch
      end do
   end subroutine double_through

   !> Coefficients of the derivative; the last one is 0.
   pure function derivative(a) result(da)
      real(wp), intent(in) :: a(0:)
      real(wp) :: da(0:size(a) - 1)
      integer :: k

      da = 0
      do k = 1, ubound(a, 1)
         da(k - 1) = k*a(k)
      end do
   end function derivative

   !> c with its derivatives. Valid: any rho
   pure subroutine single_at(polynomial, rho, value, slope, curvature)
      type(single_polynomial), intent(in) :: polynomial
      real(wp), intent(in) :: rho !! [m]
      real(wp), intent(out) :: value, slope, curvature
      real(wp) :: inside, x

      inside = min(max(rho, polynomial%low), polynomial%high)
      x = polynomial%stretch*(inside - polynomial%low) - 1
      slope = degree_16(polynomial%da, x)
      value = degree_16(polynomial%a, x) + slope*(rho - inside)
      curvature = merge(0.0_wp, degree_16(polynomial%dda, x), rho < polynomial%low .or. rho > polynomial%high)
   end subroutine single_at

   !> c and its slope for eight states.
   pure subroutine single_in_lanes(polynomial, rho, value, slope)
      type(single_polynomial), intent(in) :: polynomial
      real(wp), intent(in) :: rho(lanes)
      real(wp), intent(out) :: value(lanes), slope(lanes)
      real(wp) :: curvature(lanes)
      integer :: l

      !$omp simd
      do l = 1, lanes
         call single_at(polynomial, rho(l), value(l), slope(l), curvature(l))
      end do
   end subroutine single_in_lanes

   !> c_j with its derivatives with respect to both positions.
   pure subroutine double_at(polynomial, here, there, value, by_here, by_there, here_here, here_there, there_there)
      type(double_polynomial), intent(in) :: polynomial
      real(wp), intent(in) :: here, there !! rho, rho' [m]
      real(wp), intent(out) :: value, by_here, by_there, here_here, here_there, there_there
      real(wp) :: x, y

      x = polynomial%stretch*(here - polynomial%low) - 1
      y = polynomial%stretch*(there - polynomial%low) - 1
      value = degree_8(polynomial%a(:, 8), x)
      by_here = degree_8(polynomial%da(:, 8), x)
      here_here = degree_8(polynomial%dda(:, 8), x)
      by_there = 0
      here_there = 0
      there_there = 0
      call add_rows(polynomial, 7, x, y, value, by_here, by_there, here_here, here_there, there_there)
      call add_rows(polynomial, 5, x, y, value, by_here, by_there, here_here, here_there, there_there)
      call add_rows(polynomial, 3, x, y, value, by_here, by_there, here_here, here_there, there_there)
      call add_rows(polynomial, 1, x, y, value, by_here, by_there, here_here, here_there, there_there)
      by_there = by_there*polynomial%stretch
      here_there = here_there*polynomial%stretch
      there_there = there_there*polynomial%stretch**2
   end subroutine double_at

   !> Add two powers of x' by Horner's scheme.
   pure subroutine add_rows(polynomial, i, x, y, value, by_here, by_there, here_here, here_there, there_there)
      type(double_polynomial), intent(in) :: polynomial
      integer, intent(in) :: i !! first power; the second is i - 1
      real(wp), intent(in) :: x, y
      real(wp), intent(inout) :: value, by_here, by_there, here_here, here_there, there_there

      call add_row(polynomial%a(:, i), polynomial%da(:, i), polynomial%dda(:, i), x, y, value, by_here, by_there, here_here, &
                   here_there, there_there)
      call add_row(polynomial%a(:, i - 1), polynomial%da(:, i - 1), polynomial%dda(:, i - 1), x, y, value, by_here, by_there, &
                   here_here, here_there, there_there)
   end subroutine add_rows

   !> Add one power.
   pure subroutine add_row(a, da, dda, x, y, value, by_here, by_there, here_here, here_there, there_there)
      real(wp), intent(in), dimension(0:n_other) :: a, da, dda
      real(wp), intent(in) :: x, y
      real(wp), intent(inout) :: value, by_here, by_there, here_here, here_there, there_there

      there_there = there_there*y + 2*by_there
      by_there = by_there*y + value
      here_there = here_there*y + by_here
      value = value*y + degree_8(a, x)
      by_here = by_here*y + degree_8(da, x)
      here_here = here_here*y + degree_8(dda, x)
   end subroutine add_row

   !> c_j and its first derivatives for eight states.
   pure subroutine double_in_lanes(polynomial, here, there, value, by_here, by_there)
      type(double_polynomial), intent(in) :: polynomial
      real(wp), intent(in) :: here(lanes), there(lanes)
      real(wp), intent(out) :: value(lanes), by_here(lanes), by_there(lanes)
      real(wp), dimension(lanes) :: here_here, here_there, there_there
      integer :: l

      !$omp simd
      do l = 1, lanes
         call double_at(polynomial, here(l), there(l), value(l), by_here(l), by_there(l), here_here(l), here_there(l), &
                        there_there(l))
      end do
   end subroutine double_in_lanes

   !> c_j alone for eight states.
   pure subroutine double_values_in_lanes(polynomial, here, there, value)
      type(double_polynomial), intent(in) :: polynomial
      real(wp), intent(in) :: here(lanes), there(lanes)
      real(wp), intent(out) :: value(lanes)
      real(wp), dimension(lanes) :: by_here, by_there, here_here, here_there, there_there
      integer :: l

      !$omp simd
      do l = 1, lanes
         call double_at(polynomial, here(l), there(l), value(l), by_here(l), by_there(l), here_here(l), here_there(l), &
                        there_there(l))
      end do
   end subroutine double_values_in_lanes

   !> Polynomial of degree 8, evaluated in short chains.
   pure real(wp) function degree_8(a, x) result(p)
      real(wp), intent(in) :: a(0:8), x
      real(wp) :: x2, x4

      x2 = x**2
      x4 = x2**2
      p = ((a(0) + x*a(1)) + x2*(a(2) + x*a(3))) + x4*(((a(4) + x*a(5)) + x2*(a(6) + x*a(7))) + x4*a(8))
   end function degree_8

   !> Polynomial of degree 16.
   pure real(wp) function degree_16(a, x) result(p)
      real(wp), intent(in) :: a(0:16), x
      real(wp) :: x2, x4, x8

      x2 = x**2
      x4 = x2**2
      x8 = x4**2
      p = (((a(0) + x*a(1)) + x2*(a(2) + x*a(3))) + x4*((a(4) + x*a(5)) + x2*(a(6) + x*a(7)))) &
          + x8*((((a(8) + x*a(9)) + x2*(a(10) + x*a(11))) + x4*((a(12) + x*a(13)) + x2*(a(14) + x*a(15)))) + x8*a(16))
   end function degree_16

end module evl_flank_polynomials
