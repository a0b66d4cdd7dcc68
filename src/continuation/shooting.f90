!> Periodic orbits by shooting: Newton's iteration for a state on the section that the flow maps to itself.
!>
!> Source: R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed., 7.1.
module evl_shooting
   use evl_kinds, only: wp
   use evl_multipliers, only: find_multipliers
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: go_round, move_orbit, orbit_options, orbit_t, scaled_derivative
   use evl_shooting_system, only: differentiate_by_parameter, find_phase_row, learn_by_parameter, learn_from_change, &
                                  right_hand_side, solve_system
   use evl_status, only: clear, code_invalid_input, code_no_solution, fail, has_failed, quantity, status_t
   implicit none (type, external)
   private

   public :: correct_orbit, find_orbit

contains

   !> Find an orbit by Newton's iteration from a start, at one value of the parameter.
   subroutine find_orbit(model, options, parameter, periods, y, period, orbit, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      real(wp), intent(in) :: parameter
      integer, intent(in) :: periods        !! of the excitation, until it repeats, >= 1
      real(wp), intent(in) :: y(:)          !! [n] near the orbit
      real(wp), intent(in) :: period        !! of an autonomous system: near that of the orbit, > 0. Otherwise not used
      type(orbit_t), intent(out) :: orbit   !! on failure: the last iterate
      type(status_t), intent(inout) :: status

      if (periods < 1) then
         call fail(status, code_invalid_input, "an orbit of no period", field="periods")
      else if (model%autonomous .and. .not. (period > 0 .and. period <= huge(period))) then
         call fail(status, code_invalid_input, "period "//quantity(period, "")//" is not positive", field="period")
      else if (.not. all(abs(y) <= huge(1.0_wp))) then
         call fail(status, code_invalid_input, "the start of an orbit is not finite", field="y")
      end if
      if (has_failed(status)) return
      orbit%parameter = parameter
      orbit%periods = periods
      orbit%period = period
      orbit%y = y
      call correct_orbit(model, options, orbit, status)
   end subroutine find_orbit

   !> Newton's iteration from an approximate orbit. If its derivative is predicted, flows are computed without it, which costs a
   !> third, and the derivative is updated by each change (Broyden); only the converged orbit needs its own. If convergence is
   !> slow, the derivative is computed after all. Far from the orbit flows need not be accurate: the error of the integration
   !> only has to be small beside the residual after the next iteration, which is about the square of the present one.
   subroutine correct_orbit(model, options, orbit, status, tangent, predicted, far)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit   !! on failure: the last iterate
      type(status_t), intent(inout) :: status
      real(wp), intent(in), optional :: tangent(:) !! [n + 2] the parameter is unknown too; the change is orthogonal to this
      logical, intent(in), optional :: predicted    !! its flow has a predicted derivative, and it a predicted dP/dp
      logical, intent(in), optional :: far         !! it is not so near that the first iteration might converge
      real(wp), parameter :: settled = 1.0e-6_wp   !! last change up to which a small residual is accepted
      real(wp), parameter :: slow = 0.1_wp         !! residual over the previous one, if the derivative is poor
      integer, parameter :: stale = 5
      real(wp), parameter :: rough = 1.0e-6_wp     !! tolerance far from the orbit
      real(wp), parameter :: small = 1.0e-3_wp     !! tolerance over the residual after the next iteration
      real(wp), parameter :: noise = 100           !! of a residual, over the tolerance
      type(orbit_options) :: now   !! with the tolerance of the last flow
      type(orbit_t) :: trial
      type(status_t) :: refusal
      real(wp) :: change(model%n + 2), phase_row(model%n), last, rate, share, unsure
      integer :: damped, halving, iteration
      logical :: at_end, is_exact, is_better, was_exact

      is_exact = .true.
      if (present(predicted)) is_exact = .not. predicted
      now = options
      if (present(far)) now%tolerance = merge(max(rough, options%tolerance), options%tolerance, far)
      call go_round(model, now, orbit, status, is_exact)
      if (has_failed(status)) return
      phase_row = 0
      if (model%autonomous) call find_phase_row(model, orbit, phase_row, status)
      last = 0
      rate = 0
      damped = 0
      iteration = 0
      do
         orbit%iterations = iteration
         if (has_failed(status)) return
         at_end = is_closed(orbit) .and. last <= settled
         if (.not. is_exact .and. (at_end .or. rate > slow) .or. now%tolerance > options%tolerance .and. at_end) then
            is_exact = .true.
            now = options
            call go_round(model, now, orbit, status, is_exact)
            cycle
         end if
         if (at_end .or. iteration == options%most_iterations .or. damped == options%most_damped) exit
         if (present(tangent) .and. (.not. allocated(orbit%by_parameter) .or. iteration == stale)) &
            call differentiate_by_parameter(model, options, orbit, status)
         if (has_failed(status)) return
         change = right_hand_side(model, orbit)
         call solve_system(model, options, orbit, phase_row, tangent, change, status)
         if (has_failed(status)) return
         was_exact = is_exact
         is_exact = was_exact .or. (iteration > 0 .and. rate*orbit%residual <= options%residual)
         unsure = 0
         if (now%tolerance > options%tolerance) then
            unsure = noise*now%tolerance
            now%tolerance = max(options%tolerance, min(rough, small*orbit%residual**2))
         end if
         share = 1
         is_better = .false.
         do halving = 0, options%most_halvings
            trial = orbit
            call clear(refusal)
            call move_orbit(model, options, trial, share*change)
            call go_round(model, now, trial, refusal, is_exact)
            is_better = .not. has_failed(refusal) .and. (trial%residual < max(orbit%residual, unsure) .or. is_closed(trial))
            if (is_better .or. .not. was_exact) exit
            share = share/2
         end do
         if (.not. is_better .and. was_exact) then
            if (has_failed(refusal)) status = refusal
            if (.not. has_failed(refusal)) call not_found()
            return
         end if
         rate = 1
         if (.not. is_better) then
            is_exact = .false.
            cycle
         end if
         if (orbit%residual > 0) rate = trial%residual/orbit%residual
         if (.not. is_exact) then
            call learn_from_change(model, options, change, trial)
         else if (was_exact .and. present(tangent)) then
            call learn_by_parameter(model, options, orbit, share*change, share, trial)
         end if
         damped = merge(damped + 1, 0, share < 1)
         last = norm2(share*change)
         orbit = trial
         iteration = iteration + 1
      end do
      if (.not. is_closed(orbit) .or. now%tolerance > options%tolerance) then
         call not_found()
      else if (.not. orbit%flow%same_modes) then
         call fail(status, code_no_solution, "the state repeats, but the modes do not, at "//quantity(orbit%parameter, ""), &
                   field="parameter")
      else
         call find_multipliers(scaled_derivative(model, orbit), orbit%multipliers, status)
      end if

   contains

      !> Whether the residual is small enough. The error of the integration is amplified by the derivative, and the state is
      !> nearer to the orbit than its end by the same factor.
      pure logical function is_closed(orbit)
         type(orbit_t), intent(in) :: orbit

         is_closed = orbit%residual <= options%residual
         if (.not. is_closed) is_closed = orbit%residual <= options%tolerance*norm2(scaled_derivative(model, orbit))
      end function is_closed

      subroutine not_found()

         call fail(status, code_no_solution, "no orbit of "//quantity(real(orbit%periods, wp), "")//" periods was found at "// &
                   quantity(orbit%parameter, "")//": after a period the state still differs by "//quantity(orbit%residual, "")// &
                   " of its scales", field="parameter")
      end subroutine not_found

   end subroutine correct_orbit

end module evl_shooting
