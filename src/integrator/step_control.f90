!> Step size control: from the error estimate, of order 7, and from the convergence of Newton's iteration.
!>
!> Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., IV.8 (8.19-8.21), after K. Gustafsson.
module evl_step_control
   use evl_elementary, only: natural_logarithm, real_power
   use evl_kinds, only: wp
   use evl_stage_solver, only: most_iterations
   implicit none (type, external)
   private

   public :: step_control_t, fit_step, next_step, step_after_error

   real(wp), parameter :: safety = 0.9_wp       !! factor on the step that the estimate allows
   real(wp), parameter :: largest_growth = 8, largest_cut = 5 !! of the step, per change
   real(wp), parameter :: min_growth = 1.2_wp  !! a step that may grow by less is unchanged, and so are the factors
   real(wp), parameter :: good_rate = 0.01_wp !! Newton's rate up to which Jacobian and factors are reused if the step is unchanged
   real(wp), parameter :: best_rate = 5.0e-4_wp !! and up to which the Jacobian is reused if the step changes

   !> Data of the last accepted step for the choice of the next one.
   type :: step_control_t
      real(wp) :: h = 0     !! 0: there is none
      real(wp) :: error = 1
   end type step_control_t

contains

   !> Step size to try: not past the stop. Steps that do not reach the stop do not depend on it.
   pure subroutine fit_step(remaining, proposed, h, to_stop)
      real(wp), intent(in) :: remaining     !! time to the stop
      real(wp), intent(in) :: proposed
      real(wp), intent(out) :: h
      logical, intent(out) :: to_stop !! the step ends at the stop

      to_stop = proposed >= remaining*(1 - 1.0e-6_wp)
      h = proposed
      if (to_stop) h = remaining
   end subroutine fit_step

   !> Step to try after one whose error was too large. Two such steps from the same state give the order in which the error
   !> falls. Where f is not smooth it is far below 8, and a step chosen for 8 would fail many times.
   pure subroutine step_after_error(failed, h, error, h_next)
      type(step_control_t), intent(inout) :: failed !! in: the last such step from this state, or none; out: this one
      real(wp), intent(in) :: h
      real(wp), intent(in) :: error                 !! >= 1
      real(wp), intent(out) :: h_next
      real(wp), parameter :: largest_cut_again = 20
      real(wp) :: order

      if (failed%h > h .and. failed%error > error) then
         order = max(1.0_wp, min(8.0_wp, natural_logarithm(failed%error/error)/natural_logarithm(failed%h/h)))
         h_next = h*max(1/largest_cut_again, safety/real_power(error, 1/order))
      else
         h_next = h*max(1/largest_cut, safety/eighth_root(error))
      end if
      failed%h = h
      failed%error = error
   end subroutine step_after_error

   !> The step to try after an accepted one.
   pure subroutine next_step(control, h, h_proposed, error, rate, iterations, h_next, jacobian_may_stay, matrix_may_stay)
      type(step_control_t), intent(inout) :: control
      real(wp), intent(in) :: h         !! the step made
      real(wp), intent(in) :: h_proposed  !! the step without a stop
      real(wp), intent(in) :: error     !! its error, < 1
      real(wp), intent(in) :: rate      !! of convergence of Newton's iteration
      integer, intent(in) :: iterations !! number of its iterations
      real(wp), intent(out) :: h_next
      logical, intent(out) :: jacobian_may_stay !! the Jacobian is good enough for any step
      logical, intent(out) :: matrix_may_stay !! Jacobian and factors are good enough for a step of h_next
      real(wp) :: slack, cut_8 ! the eighth power of the cut: most steps are unchanged, and need no root
      logical :: one

      slack = safety*(1 + 2*most_iterations)/(iterations + 2*most_iterations)
      cut_8 = error/slack**8
      if (control%h > 0) cut_8 = max(cut_8, (control%h/(h*safety))**8*error**2/control%error)
      control%h = h
      control%error = max(1.0e-2_wp, error)
      one = iterations == 1 ! what needs one iteration is good enough, and the rate is that of an earlier step
      jacobian_may_stay = one .or. rate <= best_rate
      matrix_may_stay = (one .or. rate <= good_rate) .and. cut_8 <= 1 .and. cut_8*min_growth**8 >= 1
      h_next = h
      if (.not. matrix_may_stay) h_next = h/max(1/largest_growth, min(largest_cut, eighth_root(cut_8)))
      if (h < h_proposed) h_next = max(h_next, h_proposed) ! it was shortened for the stop: the previous proposal still holds
   end subroutine next_step

   !> x^(1/8)
   pure real(wp) function eighth_root(x)
      real(wp), intent(in) :: x

      eighth_root = sqrt(sqrt(sqrt(x)))
   end function eighth_root

end module evl_step_control
