!> Collocation polynomial of a step: values in lanes at its eight nodes; evaluation, differentiation, transfer to another step.
!>
!> A polynomial of degree 7 is defined by its values at the nodes; tau is the time since the start of the step in units of the
!> step. Sums run over fixed counts of lanes, so that the compiler vectorises them.
module evl_collocation
   use evl_kinds, only: lanes, wp
   use evl_radau_coefficients, only: barycentric, node, slope_at_node
   implicit none (type, external)
   private

   public :: combine, interpolate, lagrange_at, lagrange_matrix, polynomial_at, slopes_of, extremum_between, weighted_sum, &
             zero_between

   real(wp), parameter :: slopes_of(lanes, lanes) = slope_at_node !! columns are added lane by lane

contains

   !> to(:, i) = matrix from(:, i) for each of n components.
   pure subroutine combine(n, matrix, from, to)
      integer, intent(in) :: n
      real(wp), intent(in) :: matrix(lanes, lanes)
      real(wp), intent(in) :: from(lanes, n)
      real(wp), intent(out) :: to(lanes, n)
      real(wp) :: total(lanes)
      integer :: i, k, l

      do i = 1, n
         total = 0
         do k = 1, lanes
            !$omp simd
            do l = 1, lanes
               total(l) = total(l) + matrix(l, k)*from(k, i)
            end do
         end do
         to(:, i) = total
      end do
   end subroutine combine

   !> `combine` in the summation order of `weighted_sum`: values at eight times are bitwise equal to those at each time.
   pure subroutine interpolate(n, matrix, from, to)
      integer, intent(in) :: n
      real(wp), intent(in) :: matrix(lanes, lanes) !! as from `lagrange_matrix`
      real(wp), intent(in) :: from(lanes, n)
      real(wp), intent(out) :: to(lanes, n)
      integer, parameter :: half = lanes/2
      real(wp) :: part(lanes, half)
      integer :: i, k, l

      do i = 1, n
         do k = 1, half
            !$omp simd
            do l = 1, lanes
               part(l, k) = matrix(l, k)*from(k, i) + matrix(l, k + half)*from(k + half, i)
            end do
         end do
         !$omp simd
         do l = 1, lanes
            to(l, i) = (part(l, 1) + part(l, 3)) + (part(l, 2) + part(l, 4))
         end do
      end do
   end subroutine interpolate

   !> Values of the eight Lagrange polynomials at tau; the interpolant at tau is their sum weighted with the values at the nodes.
   !>
   !> Products accumulate from both ends, which avoids division by tau - node.
   pure subroutine lagrange_at(tau, basis)
      real(wp), intent(in) :: tau
      real(wp), intent(out) :: basis(lanes)
      real(wp) :: product
      integer :: k

      product = 1
      do k = 1, lanes
         basis(k) = product*barycentric(k)
         product = product*(tau - node(k))
      end do
      product = 1
      do k = lanes, 1, -1
         basis(k) = basis(k)*product
         product = product*(tau - node(k))
      end do
   end subroutine lagrange_at

   !> `lagrange_at` at eight times: combine(matrix, values at the nodes) gives the values at tau.
   pure subroutine lagrange_matrix(tau, matrix)
      real(wp), intent(in) :: tau(lanes)
      real(wp), intent(out) :: matrix(lanes, lanes)
      real(wp) :: product(lanes)
      integer :: k, l

      product = 1
      do k = 1, lanes
         !$omp simd
         do l = 1, lanes
            matrix(l, k) = product(l)*barycentric(k)
            product(l) = product(l)*(tau(l) - node(k))
         end do
      end do
      product = 1
      do k = lanes, 1, -1
         !$omp simd
         do l = 1, lanes
            matrix(l, k) = matrix(l, k)*product(l)
            product(l) = product(l)*(tau(l) - node(k))
         end do
      end do
   end subroutine lagrange_matrix

   !> Value at tau from the values at the nodes.
   pure real(wp) function polynomial_at(tau, values) result(value)
      real(wp), intent(in) :: tau
      real(wp), intent(in) :: values(lanes)
      real(wp) :: basis(lanes)

      call lagrange_at(tau, basis)
      value = weighted_sum(basis, values)
   end function polynomial_at

   !> Sum of weights times values, added by halves: shorter than a chain of seven dependent additions.
   pure real(wp) function weighted_sum(weights, values) result(total)
      real(wp), intent(in) :: weights(lanes), values(lanes)
      integer, parameter :: half = lanes/2
      real(wp) :: part(half)
      integer :: k

      !$omp simd
      do k = 1, half
         part(k) = weights(k)*values(k) + weights(k + half)*values(k + half)
      end do
      total = (part(1) + part(3)) + (part(2) + part(4))
   end function weighted_sum

   !> Position of an extremum, between left and right, of the polynomial with these slopes at the nodes. The slope differs in
   !> sign there; accuracy: a thousandth of the interval.
   pure real(wp) function extremum_between(left, right, slopes) result(tau)
      real(wp), intent(in) :: left, right
      real(wp), intent(in) :: slopes(lanes) !! a polynomial of degree 6, thus also defined by its values at the nodes
      real(wp), parameter :: accuracy = 1.0e-3_wp

      tau = zero_between(left, right, slopes, accuracy)
   end function extremum_between

   !> Zero, between left and right, of the polynomial with these values at the nodes, which differs in sign there: false
   !> position with halving (Illinois). Ends when the bracket is at most accuracy times the interval, or the value at most
   !> accuracy**2 times the larger value at the ends.
   pure real(wp) function zero_between(left, right, values, accuracy) result(tau)
      real(wp), intent(in) :: left, right
      real(wp), intent(in) :: values(lanes)
      real(wp), intent(in) :: accuracy !! of the time, relative to the interval
      integer, parameter :: most_turns = 40
      real(wp) :: a, b, at_a, at_b, value, small
      integer :: side, turn

      a = left
      b = right
      at_a = polynomial_at(a, values)
      at_b = polynomial_at(b, values)
      small = accuracy**2*max(abs(at_a), abs(at_b))
      side = 0
      tau = (a + b)/2
      do turn = 1, most_turns
         if (b - a <= accuracy*(right - left) .or. .not. abs(at_b - at_a) > 0) exit
         tau = b - at_b*((b - a)/(at_b - at_a))
         if (.not. (tau > a .and. tau < b)) exit
         value = polynomial_at(tau, values)
         if (abs(value) <= small) exit
         if (value*at_a > 0) then
            a = tau
            at_a = value
            if (side == -1) at_b = at_b/2
            side = -1
         else
            b = tau
            at_b = value
            if (side == 1) at_a = at_a/2
            side = 1
         end if
      end do
      tau = min(max(tau, left), right)
   end function zero_between

end module evl_collocation
