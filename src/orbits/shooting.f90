!> Periodic orbits by shooting: Newton's iteration for a state on the section that the flow brings back.
!>
!> Unknown are the state y, the period T of an autonomous system and, along a branch, the parameter p; all in units of their
!> scales, as u = (y, T, p). With the flow P and its derivative D the linear system of an iteration is
!>
!>     | D - 1      f(end)   dP/dp |        | P(y) - y - advance |
!>     | f(start)   0        0     | du = - | 0                  |
!>     |        tangent            |        | 0                  |
!>
!> The second row is the phase condition of an autonomous system: the change is orthogonal to the flow. The last one keeps the
!> change orthogonal to the branch (pseudo-arclength). Where a row is not wanted, or a state need not repeat, the unknown stays as
!> it is.
!> dP/dp is a difference of flows: a parameter may change all of a system.
!>
!> Sources: R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed., 7.1, 7.5; H. B. Keller, in: Applications of
!> Bifurcation Theory, Academic Press 1977 (pseudo-arclength); T. S. Parker, L. O. Chua, Practical Numerical Algorithms, 5.
module evl_shooting
   use evl_flow, only: flow_t, follow
   use evl_kinds, only: wp
   use evl_lapack, only: dgesv
   use evl_multipliers, only: find_multipliers
   use evl_orbit_model, only: must_repeat, orbit_model
   use evl_places, only: places
   use evl_status, only: clear, code_invalid_input, code_no_solution, code_singular, fail, has_failed, quantity, status_t
   implicit none (type, external)
   private

   public :: orbit_options, orbit_t
   public :: change_of, correct_orbit, differentiate_by_parameter, find_orbit, find_tangent, go_round, lack_of_round, &
             learn_from_change, move_orbit, own_multipliers, scaled_derivative, solve_along

   !> What the user chooses.
   type :: orbit_options
      real(wp) :: tolerance = 1.0e-12_wp      !! of the integration, in 1e-13 .. 0.1
      real(wp) :: residual = 1.0e-10_wp       !! largest difference after a period, in units of the scales
      integer :: most_iterations = 20         !! of Newton
      integer :: most_damped = 20             !! of these, one after the other, in which a full step made it worse
      integer :: most_halvings = 8            !! of such a step
      real(wp) :: parameter_scale = 1         !! > 0: the change of the parameter that counts as 1
      real(wp) :: parameter_change = 1.0e-6_wp !! of the difference that gives dP/dp, over that scale; P may have corners
   end type orbit_options

   !> A periodic orbit, or what is meant to become one.
   type :: orbit_t
      real(wp) :: parameter = 0
      integer :: periods = 1                  !! of what drives, until it repeats; of an autonomous orbit, those in `period`
      real(wp) :: period = 0                  !! until it repeats
      real(wp), allocatable :: y(:)           !! [n] on the section
      type(flow_t) :: flow                    !! once round
      real(wp) :: residual = huge(1.0_wp)     !! in units of the scales
      integer :: iterations = 0               !! of Newton that it took
      logical, allocatable :: active(:)       !! [n] states that are found: they repeat, and do not just rest
      complex(wp), allocatable :: multipliers(:) !! of these, by falling size
      real(wp), allocatable :: by_parameter(:) !! [n] dP/dp
      real(wp), allocatable :: tangent(:)     !! [n + 2] of the branch: y, T, p in units of their scales, of length 1
   end type orbit_t

contains

   !> Newton's iteration from a start, at one value of the parameter.
   subroutine find_orbit(model, options, parameter, periods, y, period, orbit, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      real(wp), intent(in) :: parameter
      integer, intent(in) :: periods        !! of what drives, until it repeats, >= 1
      real(wp), intent(in) :: y(:)          !! [n] near the orbit
      real(wp), intent(in) :: period        !! of an autonomous system: near that of the orbit, > 0. Else not used
      type(orbit_t), intent(out) :: orbit   !! on failure: how far it came
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

   !> Newton's iteration from an orbit that is nearly one. Where its derivative is foreseen a flow is followed without finding it,
   !> which costs a third, and the derivative learns from each change (Broyden); only the orbit that is found needs its own. If that
   !> does not get on well the derivative is found after all.
   subroutine correct_orbit(model, options, orbit, status, tangent, foreseen)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit   !! on failure: how far it came
      type(status_t), intent(inout) :: status
      real(wp), intent(in), optional :: tangent(:) !! [n + 2] the parameter is found too, orthogonal to this
      logical, intent(in), optional :: foreseen    !! its flow has a derivative, and it a dP/dp, that are expected
      real(wp), parameter :: settled = 1.0e-6_wp   !! last change after which a small residual is believed
      real(wp), parameter :: slow = 0.1_wp         !! residual over that before, if the derivative is worth little
      integer, parameter :: stale = 5
      type(orbit_t) :: trial
      type(status_t) :: refusal
      real(wp) :: matrix(model%n + 2, model%n + 2), change(model%n + 2), phase_row(model%n), last, rate, share
      integer :: damped, halving, iteration
      logical :: at_end, is_exact, is_better, was_exact

      is_exact = .true.
      if (present(foreseen)) is_exact = .not. foreseen
      call go_round(model, options, orbit, status, is_exact)
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
         at_end = orbit%residual <= options%residual .and. last <= settled
         if (.not. is_exact .and. (at_end .or. rate > slow)) then
            is_exact = .true.
            call go_round(model, options, orbit, status, is_exact)
            cycle
         end if
         if (at_end .or. iteration == options%most_iterations .or. damped == options%most_damped) exit
         if (present(tangent) .and. (.not. allocated(orbit%by_parameter) .or. iteration == stale)) &
            call differentiate_by_parameter(model, options, orbit, status)
         if (has_failed(status)) return
         call linearise(model, options, orbit, phase_row, tangent, matrix)
         change = 0
         change(:model%n) = merge(-lack_of_round(model, orbit)/model%scale, 0.0_wp, orbit%active)
         call solve(matrix, change, status)
         if (has_failed(status)) return
         was_exact = is_exact
         is_exact = was_exact .or. (iteration > 0 .and. rate*orbit%residual <= options%residual)
         share = 1
         do halving = 0, options%most_halvings
            trial = orbit
            call clear(refusal)
            call move_orbit(model, options, trial, share*change)
            call go_round(model, options, trial, refusal, is_exact)
            is_better = .not. has_failed(refusal) .and. (trial%residual < orbit%residual .or. trial%residual <= options%residual)
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
      if (.not. orbit%residual <= options%residual) then
         call not_found()
      else if (.not. orbit%flow%same_modes) then
         call fail(status, code_no_solution, "the state repeats, but the modes do not, at "//quantity(orbit%parameter, ""), &
                   field="parameter")
      else
         call find_multipliers(scaled_derivative(model, orbit), orbit%multipliers, status)
      end if

   contains

      subroutine not_found()

         call fail(status, code_no_solution, "no orbit of "//quantity(real(orbit%periods, wp), "")//" periods was found at "// &
                   quantity(orbit%parameter, "")//": after a period the state still differs by "//quantity(orbit%residual, "")// &
                   " of its scales", field="parameter")
      end subroutine not_found

   end subroutine correct_orbit

   !> The change that one iteration makes at a value of the parameter, of an orbit that was followed round: its flow has an end, a
   !> rate, and a derivative that is known about.
   subroutine change_of(model, options, orbit, change, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit     !! its `active` and `residual` are found
      real(wp), intent(out) :: change(:)        !! [n + 2] in units of the scales
      type(status_t), intent(inout) :: status
      real(wp) :: matrix(model%n + 2, model%n + 2), phase_row(model%n)

      call find_active(model, orbit)
      orbit%residual = maxval(abs(lack_of_round(model, orbit))/model%scale, orbit%active)
      phase_row = 0
      if (model%autonomous) call find_phase_row(model, orbit, phase_row, status)
      if (has_failed(status)) return
      call linearise(model, options, orbit, phase_row, matrix=matrix)
      change = 0
      change(:model%n) = merge(-lack_of_round(model, orbit)/model%scale, 0.0_wp, orbit%active)
      call solve(matrix, change, status)
   end subroutine change_of

   !> Change the unknowns of an orbit.
   pure subroutine move_orbit(model, options, orbit, change)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit
      real(wp), intent(in) :: change(:) !! [n + 2] in units of the scales

      associate (n => model%n)
         if (model%autonomous) orbit%period = orbit%period*(1 + change(n + 1))
         orbit%y = orbit%y + change(:n)*model%scale
         orbit%parameter = orbit%parameter + change(n + 2)*options%parameter_scale
      end associate
   end subroutine move_orbit

   !> Follow an orbit once round.
   subroutine go_round(model, options, orbit, status, differentiate)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit
      type(status_t), intent(inout) :: status
      logical, intent(in), optional :: differentiate !! false: the derivative stays what it was
      real(wp), allocatable :: derivative(:, :)

      call model%set_parameter(orbit%parameter, status)
      if (has_failed(status)) return
      if (.not. model%autonomous) orbit%period = orbit%periods*model%period
      if (.not. orbit%period > 0) then
         call fail(status, code_no_solution, "the period of the orbit fell to zero", field="period")
         return
      end if
      if (present(differentiate)) then
         if (.not. differentiate) derivative = orbit%flow%derivative
      end if
      call follow(model, orbit%y, orbit%periods, orbit%period, options%tolerance,.not. allocated(derivative), orbit%flow, status)
      if (has_failed(status)) return
      if (allocated(derivative)) orbit%flow%derivative = derivative
      call find_active(model, orbit)
      orbit%residual = maxval(abs(lack_of_round(model, orbit))/model%scale, orbit%active)
   end subroutine go_round

   !> States that have to repeat and are not just at rest, such as a memory that no event of the orbit sets.
   pure subroutine find_active(model, orbit)
      class(orbit_model), intent(in) :: model
      type(orbit_t), intent(inout) :: orbit
      real(wp) :: row(model%n)
      logical :: repeats(model%n)
      integer :: i

      repeats = must_repeat(model)
      if (.not. allocated(orbit%active)) allocate (orbit%active(model%n))
      do i = 1, model%n
         row = orbit%flow%derivative(i, :)
         row(i) = row(i) - 1
         orbit%active(i) = repeats(i) .and. (any(abs(row) > 0) .or. abs(orbit%flow%y(i) - orbit%y(i)) > 0)
      end do
   end subroutine find_active

   !> What the state lacks after a period.
   pure function lack_of_round(model, orbit) result(lack)
      class(orbit_model), intent(in) :: model
      type(orbit_t), intent(in) :: orbit
      real(wp) :: lack(model%n)

      lack = orbit%flow%y - orbit%y
      if (allocated(model%advance)) lack = lack - orbit%periods*model%advance
   end function lack_of_round

   !> The flow's direction at the start.
   subroutine find_phase_row(model, orbit, row, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_t), intent(in) :: orbit
      real(wp), intent(out) :: row(model%n) !! in units of the scales, of length 1
      type(status_t), intent(inout) :: status
      real(wp) :: y(model%n)

      y = orbit%y
      call model%set_parameter(orbit%parameter, status)
      if (.not. has_failed(status)) call model%settle(model%phase, y, status)
      if (.not. has_failed(status)) call model%rhs(model%phase, y, row, status)
      if (has_failed(status)) return
      row = merge(row/model%scale, 0.0_wp, orbit%active)
      if (norm2(row) > 0) then
         row = row/norm2(row)
      else
         call fail(status, code_no_solution, "the start is at rest: no orbit passes through it")
      end if
   end subroutine find_phase_row

   !> The matrix above, in units of the scales; the period in units of itself.
   pure subroutine linearise(model, options, orbit, phase_row, tangent, matrix)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit
      real(wp), intent(in) :: phase_row(:)
      real(wp), intent(in), optional :: tangent(:) !! [n + 2] the last row; else the parameter stays
      real(wp), intent(out) :: matrix(:, :)        !! [n + 2, n + 2]
      integer :: i, n

      n = model%n
      matrix = 0
      do i = 1, n
         if (orbit%active(i)) then
            matrix(i, :n) = merge(orbit%flow%derivative(i, :)*model%scale/model%scale(i), 0.0_wp, orbit%active)
            matrix(i, i) = matrix(i, i) - 1
            matrix(i, n + 1) = orbit%flow%rate(i)*orbit%period/model%scale(i)
            if (present(tangent)) matrix(i, n + 2) = orbit%by_parameter(i)*options%parameter_scale/model%scale(i)
         else
            matrix(i, i) = 1
         end if
      end do
      if (model%autonomous) then
         matrix(n + 1, :n) = phase_row
      else
         matrix(n + 1, n + 1) = 1
      end if
      if (present(tangent)) then
         matrix(n + 2, :) = tangent
      else
         matrix(n + 2, n + 2) = 1
      end if
   end subroutine linearise

   !> Solve for one right-hand side.
   subroutine solve(matrix, x, status)
      real(wp), intent(inout) :: matrix(:, :) !! destroyed
      real(wp), intent(inout) :: x(:)         !! right-hand side, then solution
      type(status_t), intent(inout) :: status
      integer :: pivots(size(x)), info

      call dgesv(size(x), 1, matrix, size(x), pivots, x, size(x), info)
      if (info /= 0 .or. .not. all(abs(x) <= huge(1.0_wp))) &
         call fail(status, code_singular, "Newton's iteration for an orbit has no solution: orbits are not isolated here")
   end subroutine solve

   !> dP/dp of an orbit that was followed round, by a difference to one side: to the other one if there is no such system, or if
   !> root functions do not fire there as in the orbit, since P may have a corner, or a root near one; else by a shorter one.
   subroutine differentiate_by_parameter(model, options, orbit, status)
      class(orbit_model), intent(inout) :: model !! with another value of the parameter on return
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit
      type(status_t), intent(inout) :: status
      real(wp), parameter :: over(6) = [1.0_wp, -1.0_wp, 0.03_wp, -0.03_wp, 0.001_wp, -0.001_wp]
      real(wp), parameter :: alike = 0.1_wp !! of the square of a rate with which a root function fires
      type(status_t) :: refusal
      type(flow_t) :: flow
      real(wp) :: change, period
      logical :: found
      integer :: i

      found = .false.
      do i = 1, size(over)
         change = over(i)*options%parameter_change*options%parameter_scale
         call clear(refusal)
         call model%set_parameter(orbit%parameter + change, refusal)
         if (has_failed(refusal)) cycle
         period = orbit%period
         if (.not. model%autonomous) period = orbit%periods*model%period
         call follow(model, orbit%y, orbit%periods, period, options%tolerance, .false., flow, refusal)
         if (has_failed(refusal)) cycle
         orbit%by_parameter = (flow%y - orbit%flow%y)/change
         found = .true.
         if (all(flow%crossings == orbit%flow%crossings .and. &
                 abs(flow%slowest - orbit%flow%slowest) <= alike*orbit%flow%slowest)) return
      end do
      if (.not. found) status = refusal
   end subroutine differentiate_by_parameter

   !> What is left after a change is laid to the derivative, and the dP/dp, with which it was found (C. G. Broyden, Mathematics of
   !> Computation 19 (1965) 577-593).
   pure subroutine learn_from_change(model, options, change, after)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      real(wp), intent(in) :: change(:)     !! [n + 2] that led there, in units of the scales
      type(orbit_t), intent(inout) :: after !! its flow has an end, and the derivative that gave that change
      real(wp) :: left(model%n), size_of
      integer :: j

      associate (n => model%n)
         size_of = dot_product(change(:n), change(:n)) + change(n + 2)**2
         if (.not. size_of > 0) return
         left = merge(lack_of_round(model, after), 0.0_wp, after%active)/size_of
         do j = 1, n
            after%flow%derivative(:, j) = after%flow%derivative(:, j) + left*(change(j)/model%scale(j))
         end do
         if (allocated(after%by_parameter)) &
            after%by_parameter = after%by_parameter + left*(change(n + 2)/options%parameter_scale)
      end associate
   end subroutine learn_from_change

   !> What a step of Newton's iteration lacks in the end is laid to dP/dp, the one part of it that is not exact (secant).
   pure subroutine learn_by_parameter(model, options, before, change, share, after)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: before
      real(wp), intent(in) :: change(:) !! [n + 2] from one to the other
      real(wp), intent(in) :: share     !! of the step that was taken
      type(orbit_t), intent(inout) :: after
      real(wp), parameter :: least = 0.01_wp !! of the change that is that of the parameter
      real(wp) :: by

      by = change(model%n + 2)
      if (.not. abs(by) > least*norm2(change)) return
      after%by_parameter = after%by_parameter + &
                           merge(lack_of_round(model, after) - (1 - share)*lack_of_round(model, before), 0.0_wp, after%active) &
                           /(by*options%parameter_scale)
   end subroutine learn_by_parameter

   !> Tangent of the branch at an orbit that was found.
   subroutine find_tangent(model, options, orbit, along, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit !! its `tangent` and `by_parameter` are set
      real(wp), intent(in) :: along(:)      !! [n + 2] it points the same way as this
      type(status_t), intent(inout) :: status
      integer :: i

      call differentiate_by_parameter(model, options, orbit, status)
      if (has_failed(status)) return
      orbit%tangent = [(0.0_wp, i=0, model%n), 1.0_wp]
      call solve_along(model, options, orbit, along, orbit%tangent, status)
      if (.not. has_failed(status)) orbit%tangent = orbit%tangent/norm2(orbit%tangent)
   end subroutine find_tangent

   !> The linear system above of an orbit whose dP/dp is known, for a last row and a right-hand side.
   subroutine solve_along(model, options, orbit, along, x, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit
      real(wp), intent(in) :: along(:)    !! [n + 2] the last row
      real(wp), intent(inout) :: x(:)     !! [n + 2] right-hand side, then solution, in units of the scales
      type(status_t), intent(inout) :: status
      real(wp) :: matrix(model%n + 2, model%n + 2), phase_row(model%n)

      phase_row = 0
      if (model%autonomous) call find_phase_row(model, orbit, phase_row, status)
      if (has_failed(status)) return
      call linearise(model, options, orbit, phase_row, along, matrix)
      call solve(matrix, x, status)
   end subroutine solve_along

   !> The derivative of the period in units of the scales, of the active states.
   pure function scaled_derivative(model, orbit) result(matrix)
      class(orbit_model), intent(in) :: model
      type(orbit_t), intent(in) :: orbit
      real(wp) :: matrix(count(orbit%active), count(orbit%active))
      integer :: list(count(orbit%active)), i, j

      list = places(orbit%active)
      do j = 1, size(list)
         do i = 1, size(list)
            matrix(i, j) = orbit%flow%derivative(list(i), list(j))*model%scale(list(j))/model%scale(list(i))
         end do
      end do
   end function scaled_derivative

   !> The multipliers without that of an autonomous orbit's own direction, which is 1.
   pure function own_multipliers(model, orbit) result(multipliers)
      class(orbit_model), intent(in) :: model
      type(orbit_t), intent(in) :: orbit
      complex(wp) :: multipliers(size(orbit%multipliers) - merge(1, 0, model%autonomous .and. size(orbit%multipliers) > 0))
      integer :: own

      own = size(orbit%multipliers) + 1
      if (size(multipliers) < size(orbit%multipliers)) own = minloc(abs(orbit%multipliers - 1), 1)
      multipliers(:own - 1) = orbit%multipliers(:own - 1)
      multipliers(own:) = orbit%multipliers(own + 1:)
   end function own_multipliers

end module evl_shooting
