!> Prediction of a zero crossing of a root function in the next step, from its values in the last one.
!>
!> A step that ends just past the crossing need not be repeated to end there. The interpolant of the last step is
!> extrapolated, without evaluations. A wrong prediction costs a step, not an event: the search within the step decides.
module evl_root_forecast
   use evl_collocation, only: lagrange_at, weighted_sum, zero_between
   use evl_kinds, only: lanes, wp
   use evl_root_finder, only: root_finder_t
   implicit none (type, external)
   private

   public :: forecast_crossing

   real(wp), parameter :: farthest = 2 !! longest extrapolation of an interpolant, in units of its step
   real(wp), parameter :: accuracy = 1.0e-6_wp !! of tau, in units of the extrapolated interval

contains

   !> Position of the first crossing that counts in the next step, in units of it; huge if none is predicted.
   pure real(wp) function forecast_crossing(roots, ratio) result(tau)
      type(root_finder_t), intent(in) :: roots !! as left by the last step, which had no crossing
      real(wp), intent(in) :: ratio            !! next step over the last one
      real(wp) :: basis(lanes), ahead
      integer :: i, k

      tau = huge(tau)
      if (roots%n_near == 0 .or. ratio > farthest) return
      ahead = 1 + ratio
      call lagrange_at(ahead, basis)
      do k = 1, roots%n_near
         i = roots%near(k)
         if (roots%direction(i) == roots%sign_now(i)) cycle
         if (roots%sign_now(i)*weighted_sum(basis, roots%g(:, i)) < 0) then
            ahead = zero_between(1.0_wp, ahead, roots%g(:, i), accuracy)
            tau = (ahead - 1)/ratio
            call lagrange_at(ahead, basis) ! another function is first only if it crosses before that
         end if
      end do
   end function forecast_crossing

end module evl_root_forecast
