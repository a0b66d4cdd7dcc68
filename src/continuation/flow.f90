!> Flow of a system over a time: end state, derivative, and events on the way.
module evl_flow
   use evl_collocation, only: combine, polynomial_at, zero_between
   use evl_flow_derivative, only: derivative_along_step, derivative_at_event, moving_states, moving_states_t
   use evl_kinds, only: lanes, wp
   use evl_ode_model, only: never
   use evl_orbit_model, only: must_repeat, orbit_model
   use evl_radau, only: outcome_event, radau_advance, radau_create, radau_interpolate_lanes, radau_options, radau_restart, &
                        radau_start, radau_step, radau_t
   use evl_radau_coefficients, only: n_stages, node, slope_at_node
   use evl_status, only: code_no_solution, fail, has_failed, quantity, status_t
   implicit none (type, external)
   private

   public :: flow_t, follow

   integer, parameter :: in_time(0:n_stages) = [lanes, 1, 2, 3, 4, 5, 6, 7] !! nodes from left to right

   integer, parameter :: most_steps = 100000     !! of one flow
   real(wp), parameter :: farthest = 1.0e6_wp    !! scales from the start: a state farther away than this diverges

   !> Result of a flow.
   type :: flow_t
      real(wp), allocatable :: y(:)             !! [n] state at the end
      real(wp), allocatable :: rate(:)          !! [n] f there
      real(wp), allocatable :: derivative(:, :) !! [n, n] of the end with respect to the start
      integer, allocatable :: crossings(:)      !! [n_roots] how often each root function fired
      !> [n_roots] `nearest`: least c a of a root function that comes near zero and turns back with value c and curvature a.
      !> `slowest`: least v**2/2 of one that fires with the rate v. Both tend to zero where the function just touches zero.
      !> huge: there is none
      real(wp), allocatable :: nearest(:), slowest(:)
      integer, allocatable :: others(:)         !! [n_roots] number of other contacts that are closed at the least of both
      logical :: same_modes = .false.           !! the modes at the end are those at the start
      integer :: steps = 0
      integer :: ties = 0                       !! simultaneous events: the derivative accounts for the first one only
   end type flow_t

contains

   !> Integrate a system from y on the section.
   subroutine follow(model, y, periods, duration, tolerance, differentiate, flow, status)
      class(orbit_model), intent(inout) :: model !! its modes are those at the end on return
      real(wp), intent(in) :: y(:)               !! [n]
      integer, intent(in) :: periods             !! number of these: the end is expressed as a state on the section
      real(wp), intent(in) :: duration           !! > 0
      real(wp), intent(in) :: tolerance          !! of the integration, and of the derivative
      logical, intent(in) :: differentiate       !! compute the derivative, and how near root functions come to zero
      type(flow_t), intent(out) :: flow
      type(status_t), intent(inout) :: status
      type(radau_t) :: solver
      type(moving_states_t) :: moving
      integer, allocatable :: modes(:)
      real(wp) :: t_end, t_event, t_known, start(model%n), state(model%n), crossing(model%n_roots)
      integer :: outcome, i, others(model%n_roots)

      start = y
      call model%begin_flow(status)
      if (.not. has_failed(status)) call radau_create(solver, model, radau_options(tolerance=tolerance), status)
      if (.not. has_failed(status)) call model%settle(model%phase, start, status)
      if (has_failed(status)) return
      modes = model%modes
      if (differentiate) moving = moving_states(model)
      t_end = model%phase + duration
      t_known = model%phase
      allocate (flow%derivative(model%n, model%n), source=0.0_wp)
      do i = 1, model%n
         flow%derivative(i, i) = 1
      end do
      allocate (flow%crossings(model%n_roots), source=0)
      allocate (flow%nearest(model%n_roots), source=huge(1.0_wp))
      allocate (flow%slowest(model%n_roots), source=huge(1.0_wp))
      allocate (flow%others(model%n_roots), source=0)
      allocate (flow%rate(model%n))
      call radau_start(solver, model, model%phase, start, status)
      do while (solver%t < t_end .and. .not. has_failed(status))
         t_event = model%next_time_event(solver%t)
         if (t_event > solver%t) then
            call radau_advance(solver, model, min(t_end, t_event), outcome, status)
            if (has_failed(status)) return
            flow%steps = flow%steps + 1
            call check_progress(model, solver, start, flow%steps, status)
            if (has_failed(status)) return
            if (solver%t > t_known .and. differentiate) then
               call look_around(model, solver, flow, status)
               if (.not. has_failed(status)) &
                  call derivative_along_step(model, moving, solver, t_known, tolerance, flow%derivative, status)
               if (has_failed(status)) return
            end if
            t_known = solver%t
            if (outcome /= outcome_event .and. solver%t < min(t_end, t_event)) cycle
            if (outcome /= outcome_event .and. solver%t < t_event) exit
         else
            solver%fired = 0
         end if
         state = solver%y
         crossing = huge(1.0_wp)
         others = [(model%other_contacts(i), i=1, model%n_roots)]
         call derivative_at_event(model, solver%t, solver%fired, solver%t >= t_event, state, flow%derivative, crossing, status)
         if (has_failed(status)) return
         where (solver%fired /= 0)
            flow%crossings = flow%crossings + 1
            flow%others = merge(others, flow%others, crossing**2/2 < min(flow%nearest, flow%slowest))
            flow%slowest = min(flow%slowest, crossing**2/2)
         end where
         if (count(solver%fired /= 0) + merge(1, 0, solver%t >= t_event) > 1) flow%ties = flow%ties + 1
         call radau_restart(solver, model, solver%t, state)
      end do
      if (has_failed(status)) return
      flow%y = solver%y
      call model%rhs(t_end, flow%y, flow%rate, status)
      call model%come_back(periods, flow%y, flow%derivative)
      flow%same_modes = all(model%modes == modes)
   end subroutine follow

   !> Fail if a flow diverges or does not progress.
   subroutine check_progress(model, solver, y, steps, status)
      class(orbit_model), intent(in) :: model
      type(radau_t), intent(in) :: solver
      real(wp), intent(in) :: y(:) !! at the start
      integer, intent(in) :: steps
      type(status_t), intent(inout) :: status
      logical :: stays(model%n)

      stays = abs(solver%y - y) <= farthest*model%scale .or. .not. must_repeat(model)
      if (allocated(model%reach)) stays = stays .or. model%reach < huge(1.0_wp) ! an angle
      if (.not. all(stays)) then
         call fail(status, code_no_solution, "the state diverges at time "//quantity(solver%t, ""), &
                   index=findloc(stays, .false., 1))
      else if (steps > most_steps) then
         call fail(status, code_no_solution, "a period takes more than "//quantity(real(most_steps, wp), "")// &
                   " steps: time "//quantity(solver%t, "")//" was reached")
      end if
   end subroutine check_progress

   !> Find where root functions come near zero and turn back in the last step.
   subroutine look_around(model, solver, flow, status)
      class(orbit_model), intent(inout) :: model
      type(radau_t), intent(in) :: solver
      type(flow_t), intent(inout) :: flow
      type(status_t), intent(inout) :: status
      real(wp), parameter :: accuracy = 1.0e-6_wp !! of the time of an extremum, over the interval between nodes
      real(wp) :: times(lanes), states(lanes, model%n), values(lanes, model%n_roots), slope(lanes), bend(lanes), h, tau, left, least
      integer :: direction(model%n_roots), i, k, s
      logical :: exact

      if (model%n_roots == 0) return
      h = radau_step(solver)
      times = solver%t_before + h*node
      call radau_interpolate_lanes(solver, times, states)
      exact = .false.
      values = 0 ! remains 0 in slots without a tooth pair
      call model%roots_lanes(times, states, exact, values, status)
      if (has_failed(status)) return
      if (.not. exact) then
         exact = .true.
         call model%roots_lanes(times, states, exact, values, status) ! values of the first evaluation are not all recomputed
         if (has_failed(status)) return
      end if
      call model%root_directions(direction)
      do i = 1, model%n_roots
         if (direction(i) == never) cycle
         call combine(1, slope_at_node, values(:, i), slope)
         do k = 1, n_stages
            associate (l => in_time(k - 1), r => in_time(k))
               s = merge(1, -1, values(l, i) > 0)
               if (direction(i) == s .or. .not. (s*slope(l) < 0 .and. s*slope(r) > 0)) cycle
               tau = zero_between(node(l), node(r), slope, accuracy)
               left = s*polynomial_at(tau, values(:, i))
               if (left < 0 .or. solver%t_before + tau*h > solver%t) cycle
               call combine(1, slope_at_node, slope, bend)
               least = left*s*polynomial_at(tau, bend)/h**2
               if (least < min(flow%nearest(i), flow%slowest(i))) flow%others(i) = model%other_contacts(i)
               flow%nearest(i) = min(flow%nearest(i), least)
            end associate
         end do
      end do
   end subroutine look_around

end module evl_flow
