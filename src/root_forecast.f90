!> Where a root function is going to cross zero in the step ahead, from its values in the last one.
!>
!> A step that ends just past the crossing need not be made anew to end there. Nothing is evaluated for it: the interpolant of
!> the last step is continued. A forecast that fails costs a step, not an event: the search inside the step decides.
module evl_root_forecast
   use evl_collocation, only: lagrange_at, polynomial_at, weighted_sum
   use evl_kinds, only: wp
   use evl_ode_model, only: lanes
   use evl_root_finder, only: root_finder_t
   implicit none (type, external)
   private

   public :: forecast_crossing

   real(wp), parameter :: farthest = 2 !! steps ahead to which an interpolant is continued

contains

   !> Place of the first crossing that counts in the next step, in units of it; huge if none is in sight.
   pure real(wp) function forecast_crossing(roots, ratio) result(place)
      type(root_finder_t), intent(in) :: roots !! as left by the last step, which had no crossing
      real(wp), intent(in) :: ratio            !! next step over the last one
      real(wp) :: basis(lanes), ahead
      integer :: i, k

      place = huge(place)
      if (ratio > farthest) return
      ahead = 1 + ratio
      call lagrange_at(ahead, basis)
      do k = 1, roots%n_near
         i = roots%near(k)
         if (roots%direction(i) == roots%sign_now(i)) cycle
         if (roots%sign_now(i)*weighted_sum(basis, roots%g(:, i)) < 0) then
            ahead = continued_zero(roots%g(:, i), 1.0_wp, ahead)
            place = (ahead - 1)/ratio
            call lagrange_at(ahead, basis) ! another function can only be first if it crosses before that
         end if
      end do
   end function forecast_crossing

   !> Zero between a and b of the polynomial with these values at the nodes, of different sign at a and b: false position
   !> (Illinois).
   pure real(wp) function continued_zero(values, a, b) result(tau)
      real(wp), intent(in) :: values(lanes)
      real(wp), intent(in) :: a, b
      integer, parameter :: most_turns = 30
      real(wp), parameter :: accuracy = 1.0e-6_wp
      real(wp) :: left, right, at_left, at_right, value
      integer :: side, turn

      left = a
      right = b
      at_left = polynomial_at(left, values)
      at_right = polynomial_at(right, values)
      side = 0
      tau = right
      do turn = 1, most_turns
         if (right - left <= accuracy*(b - a) .or. .not. abs(at_right - at_left) > 0) exit
         tau = right - at_right*((right - left)/(at_right - at_left))
         value = polynomial_at(tau, values)
         if (abs(value) <= accuracy**2*abs(at_right - at_left)) exit
         if (value*at_right > 0) then
            right = tau
            at_right = value
            if (side == 1) at_left = at_left/2
            side = 1
         else
            left = tau
            at_left = value
            if (side == -1) at_right = at_right/2
            side = -1
         end if
      end do
   end function continued_zero

end module evl_root_forecast
