!> Monotone piecewise cubics with a continuous slope: they rise and fall only where the values at the knots do.
!>
!> The slope at an inner knot is 0 if the differences left and right have different signs, otherwise their harmonic mean weighted by
!> the lengths of the intervals. At an end it is that of the parabola through three knots, bounded to avoid overshoot. Beyond the
!> ends the extrapolation is linear.
!>
!> Source: Fritsch & Butland 1984.
module evl_monotone_cubic
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: cubic_at, cubic_through, cubic_t

   !> Knots, values and slopes.
   type :: cubic_t
      real(wp), allocatable :: x(:), y(:), slope(:)
   end type cubic_t

contains

   !> Cubics through values at strictly increasing knots, at least two.
   pure subroutine cubic_through(x, y, cubic)
      real(wp), intent(in) :: x(:), y(:)
      type(cubic_t), intent(out) :: cubic
      real(wp) :: h(size(x) - 1), d(size(x) - 1)
      integer :: n, i

      n = size(x)
      allocate (cubic%x, source=x)
      allocate (cubic%y, source=y)
      allocate (cubic%slope(n))
      h = x(2:) - x(:n - 1)
      d = (y(2:) - y(:n - 1))/h
      cubic%slope(:) = d(1)
      if (n == 2) return
      do i = 2, n - 1
         cubic%slope(i) = 0
         if (d(i - 1)*d(i) > 0) cubic%slope(i) = 3*(h(i - 1) + h(i))/((2*h(i) + h(i - 1))/d(i - 1) + (h(i) + 2*h(i - 1))/d(i))
      end do
      cubic%slope(1) = end_slope(h(1), h(2), d(1), d(2))
      cubic%slope(n) = end_slope(h(n - 1), h(n - 2), d(n - 1), d(n - 2))
   end subroutine cubic_through

   !> Slope at an end, from the two intervals next to it.
   elemental real(wp) function end_slope(h1, h2, d1, d2) result(slope)
      real(wp), intent(in) :: h1, h2, d1, d2 !! lengths and differences, the outer one first

      slope = ((2*h1 + h2)*d1 - h1*d2)/(h1 + h2)
      if (slope*d1 <= 0) then
         slope = 0
      else if (d1*d2 <= 0 .and. abs(slope) > 3*abs(d1)) then
         slope = 3*d1
      end if
   end function end_slope

   !> Value, slope and curvature at one position.
   pure subroutine cubic_at(cubic, x, value, slope, curvature)
      type(cubic_t), intent(in) :: cubic
      real(wp), intent(in) :: x
      real(wp), intent(out) :: value, slope, curvature
      real(wp) :: t, h, rise
      integer :: low, high, middle

      low = 1
      high = size(cubic%x)
      if (x <= cubic%x(low) .or. x >= cubic%x(high)) then
         if (x <= cubic%x(low)) high = low
         slope = cubic%slope(high)
         value = cubic%y(high) + slope*(x - cubic%x(high))
         curvature = 0
         return
      end if
      do while (high - low > 1)
         middle = (low + high)/2
         if (x < cubic%x(middle)) then
            high = middle
         else
            low = middle
         end if
      end do
      h = cubic%x(high) - cubic%x(low)
      t = (x - cubic%x(low))/h
      rise = cubic%y(high) - cubic%y(low)
      associate (a => h*cubic%slope(low), b => h*cubic%slope(high))
         associate (two => 3*rise - 2*a - b, three => a + b - 2*rise)
            value = cubic%y(low) + t*(a + t*(two + t*three))
            slope = (a + t*(2*two + t*3*three))/h
            curvature = (2*two + t*6*three)/h**2
         end associate
      end associate
   end subroutine cubic_at

end module evl_monotone_cubic
