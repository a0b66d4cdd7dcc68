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

   real(wp), parameter :: rough = 1.0e-6_wp !! tolerance far from the orbit

   !> State of Newton's iteration for one orbit.
   type :: newton_t
      type(orbit_options) :: now            !! with the tolerance of the last flow
      logical :: is_exact = .true.          !! flows are computed with their derivative
      logical :: was_exact = .true.         !! this was so for the flow before the present change
      real(wp), allocatable :: phase_row(:) !! [n] phase condition of an autonomous system
      real(wp), allocatable :: change(:)    !! [n + 2] full change of this iteration, in units of the scales
      real(wp) :: share = 1                 !! of it that was taken
      real(wp) :: last_change = 0           !! length of the change before
      real(wp) :: rate = 0                  !! residual over the previous one
      real(wp) :: unsure = 0                !! residual up to which a rough flow hides a decrease
      integer :: iteration = 0
      integer :: damped = 0                 !! consecutive iterations in which a full change increased the residual
   end type newton_t

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
      type(newton_t) :: newton
      type(orbit_t) :: trial
      logical :: is_better

      newton%now = options
      if (present(predicted)) newton%is_exact = .not. predicted
      if (present(far)) newton%now%tolerance = merge(max(rough, options%tolerance), options%tolerance, far)
      call start(newton, model, orbit, status)
      do
         if (has_failed(status)) return
         orbit%iterations = newton%iteration
         if (needs_own_flow(newton, model, options, orbit)) then
            newton%is_exact = .true.
            newton%now = options
            call go_round(model, newton%now, orbit, status)
            cycle
         end if
         if (is_over(newton, model, options, orbit)) exit
         call find_change(newton, model, options, orbit, status, tangent)
         if (has_failed(status)) return
         call take_change(newton, model, options, orbit, trial, is_better, status)
         if (has_failed(status)) return
         if (is_better) call accept(newton, model, options, orbit, trial, present(tangent))
      end do
      call conclude(newton, model, options, orbit, status)
   end subroutine correct_orbit

   !> First flow, and the phase condition.
   subroutine start(newton, model, orbit, status)
      type(newton_t), intent(inout) :: newton
      class(orbit_model), intent(inout) :: model
      type(orbit_t), intent(inout) :: orbit
      type(status_t), intent(inout) :: status

      allocate (newton%phase_row(model%n), newton%change(model%n + 2))
      newton%phase_row = 0
      call go_round(model, newton%now, orbit, status, newton%is_exact)
      if (model%autonomous .and. .not. has_failed(status)) call find_phase_row(model, orbit, newton%phase_row, status)
   end subroutine start

   !> Whether the residual and the last change are small enough.
   pure logical function has_converged(newton, model, options, orbit)
      type(newton_t), intent(in) :: newton
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit
      real(wp), parameter :: settled = 1.0e-6_wp !! last change up to which a small residual is accepted

      has_converged = is_closed(model, options, orbit) .and. newton%last_change <= settled
   end function has_converged

   !> Whether the orbit needs a flow of full accuracy with its own derivative: it has converged, or converges slowly.
   pure logical function needs_own_flow(newton, model, options, orbit)
      type(newton_t), intent(in) :: newton
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit
      real(wp), parameter :: slow = 0.1_wp !! residual over the previous one, if the derivative is poor
      logical :: at_end

      at_end = has_converged(newton, model, options, orbit)
      needs_own_flow = .not. newton%is_exact .and. (at_end .or. newton%rate > slow) .or. is_rough(newton, options) .and. at_end
   end function needs_own_flow

   !> Whether the iteration has converged, or must not continue.
   pure logical function is_over(newton, model, options, orbit)
      type(newton_t), intent(in) :: newton
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit

      is_over = newton%iteration == options%most_iterations .or. newton%damped == options%most_damped
      if (.not. is_over) is_over = has_converged(newton, model, options, orbit)
   end function is_over

   !> Whether the last flow has a larger tolerance than requested.
   elemental logical function is_rough(newton, options)
      type(newton_t), intent(in) :: newton
      type(orbit_options), intent(in) :: options

      is_rough = newton%now%tolerance > options%tolerance
   end function is_rough

   !> Compute the full change of this iteration, and choose the accuracy of the next flows.
   subroutine find_change(newton, model, options, orbit, status, tangent)
      type(newton_t), intent(inout) :: newton
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit
      type(status_t), intent(inout) :: status
      real(wp), intent(in), optional :: tangent(:)
      integer, parameter :: stale = 5          !! iterations after which dP/dp is computed again
      real(wp), parameter :: small = 1.0e-3_wp !! tolerance over the residual after the next iteration
      real(wp), parameter :: noise = 100       !! of a residual, over the tolerance

      if (present(tangent) .and. (.not. allocated(orbit%by_parameter) .or. newton%iteration == stale)) &
         call differentiate_by_parameter(model, options, orbit, status)
      if (has_failed(status)) return
      newton%change = right_hand_side(model, orbit)
      call solve_system(model, options, orbit, newton%phase_row, tangent, newton%change, status)
      newton%was_exact = newton%is_exact
      newton%is_exact = newton%was_exact .or. (newton%iteration > 0 .and. newton%rate*orbit%residual <= options%residual)
      newton%unsure = 0
      if (is_rough(newton, options)) then
         newton%unsure = noise*newton%now%tolerance
         newton%now%tolerance = max(options%tolerance, min(rough, small*orbit%residual**2))
      end if
   end subroutine find_change

   !> Take the change, halved until the residual decreases; with an updated derivative only as a whole. If that is no better, the
   !> iteration continues from the same orbit with its own derivative.
   subroutine take_change(newton, model, options, orbit, trial, is_better, status)
      type(newton_t), intent(inout) :: newton
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit
      type(orbit_t), intent(out) :: trial
      logical, intent(out) :: is_better
      type(status_t), intent(inout) :: status
      type(status_t) :: refusal
      integer :: halving

      newton%share = 1
      is_better = .false.
      do halving = 0, options%most_halvings
         trial = orbit
         call clear(refusal)
         call move_orbit(model, options, trial, newton%share*newton%change)
         call go_round(model, newton%now, trial, refusal, newton%is_exact)
         is_better = .not. has_failed(refusal) .and. &
                     (trial%residual < max(orbit%residual, newton%unsure) .or. is_closed(model, options, trial))
         if (is_better .or. .not. newton%was_exact) exit
         newton%share = newton%share/2
      end do
      newton%rate = 1
      if (is_better) return
      if (.not. newton%was_exact) then
         newton%is_exact = .false.
      else if (has_failed(refusal)) then
         status = refusal
      else
         call not_found(orbit, status)
      end if
   end subroutine take_change

   !> Continue from the orbit after the change; update what was not computed there.
   pure subroutine accept(newton, model, options, orbit, trial, along_branch)
      type(newton_t), intent(inout) :: newton
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit, trial
      logical, intent(in) :: along_branch !! the parameter is unknown too

      if (orbit%residual > 0) newton%rate = trial%residual/orbit%residual
      if (.not. newton%is_exact) then
         call learn_from_change(model, options, newton%change, trial)
      else if (newton%was_exact .and. along_branch) then
         call learn_by_parameter(model, options, orbit, newton%share*newton%change, newton%share, trial)
      end if
      newton%damped = merge(newton%damped + 1, 0, newton%share < 1)
      newton%last_change = norm2(newton%share*newton%change)
      newton%iteration = newton%iteration + 1
      orbit = trial
   end subroutine accept

   !> Multipliers of the orbit, unless the iteration did not converge.
   subroutine conclude(newton, model, options, orbit, status)
      type(newton_t), intent(in) :: newton
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit
      type(status_t), intent(inout) :: status

      if (.not. is_closed(model, options, orbit) .or. is_rough(newton, options)) then
         call not_found(orbit, status)
      else if (.not. orbit%flow%same_modes) then
         call fail(status, code_no_solution, "the state repeats, but the modes do not, at "//quantity(orbit%parameter, ""), &
                   field="parameter")
      else
         call find_multipliers(scaled_derivative(model, orbit), orbit%multipliers, status)
      end if
   end subroutine conclude

   !> Whether the residual is small enough. The error of the integration is amplified by the derivative, and the state is
   !> nearer to the orbit than its end by the same factor.
   pure logical function is_closed(model, options, orbit)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit

      is_closed = orbit%residual <= options%residual
      if (.not. is_closed) is_closed = orbit%residual <= options%tolerance*norm2(scaled_derivative(model, orbit))
   end function is_closed

   subroutine not_found(orbit, status)
      type(orbit_t), intent(in) :: orbit
      type(status_t), intent(inout) :: status

      call fail(status, code_no_solution, "no orbit of "//quantity(real(orbit%periods, wp), "")//" periods was found at "// &
                quantity(orbit%parameter, "")//": after a period the state still differs by "//quantity(orbit%residual, "")// &
                " of its scales", field="parameter")
   end subroutine not_found

end module evl_shooting
