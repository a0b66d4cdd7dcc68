!> Derivative of the flow with respect to its start: variational equations along the integrator's steps, saltation at events.
!>
!> Along a step D' = J(t, y(t)) D is solved by the same method, Radau IIA with seven stages, on the polynomial of the step. A
!> piece as long as the step has the step's own stages and gives the exact derivative of the step (internal differentiation).
!> Modes that are hardly visible in the state, such as one without motion, are present in D: pieces are as short as D requires.
!>
!> Error of a piece: the end has order 13, the polynomial through the stages order 7. With p the pair of its last two
!> Chebyshev coefficients and q the next pair, p q decreases with the fourteenth power of the piece, as the error at its end
!> does; for D' = z D the error is below 20 p q (docs/theory/orbits.md). If q is not much smaller than p, q itself is the estimate.
!>
!> Sources: P. C. Mueller, Calculation of Lyapunov exponents for dynamic systems with discontinuities, Chaos, Solitons & Fractals 5
!> (1995) 1671-1681 (events); R. I. Leine, H. Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, Springer 2004,
!> ch. 7 (saltation matrix); H. G. Bock, 1981 (internal differentiation).
module evl_flow_derivative
   use evl_indices, only: indices
   use evl_kinds, only: lanes, wp
   use evl_orbit_model, only: must_repeat, orbit_model
   use evl_radau, only: radau_interpolate_lanes, radau_t
   use evl_radau_coefficients, only: from_stage, integral_to_node, n_stages, n_systems, node, shift_im, shift_re, to_chebyshev, &
                                     to_stage
   use evl_small_system, only: solve_small
   use evl_status, only: code_no_solution, code_singular, fail, has_failed, quantity, status_t
   implicit none (type, external)
   private

   public :: derivative_along_step, derivative_at_event, moving_states, moving_states_t

   integer, parameter :: order = 2*n_stages

   !> States of a model to which the derivative refers, and work arrays of a piece.
   type :: moving_states_t
      private
      integer, allocatable :: periodic(:), moving(:)      !! states that repeat; those with a nonzero rate, unlike a memory
      integer, allocatable :: moving_index(:)                !! [n] index of a state among the moving ones, else 0
      integer, allocatable :: entries(:)              !! entries of the Jacobian that are used
      real(wp), allocatable :: jacobians(:, :)        !! [all entries, n_stages]
      real(wp), allocatable :: matrix(:, :), z(:, :)  !! of a piece, stage by stage
   end type moving_states_t

contains

   !> Select the states of a model to which the derivative refers.
   pure function moving_states(model) result(states)
      class(orbit_model), intent(in) :: model
      type(moving_states_t) :: states
      logical :: moves(model%n), repeats(model%n)
      integer :: i, n

      repeats = must_repeat(model)
      moves = .false.
      moves(model%jacobian_row) = .true.
      moves = moves .and. repeats
      allocate (states%periodic, source=indices(repeats))
      allocate (states%moving, source=indices(moves))
      n = size(states%moving)
      allocate (states%moving_index(model%n), source=0)
      states%moving_index(states%moving) = [(i, i=1, n)]
      allocate (states%entries, source=indices(moves(model%jacobian_row) .and. repeats(model%jacobian_column)))
      allocate (states%jacobians(size(model%jacobian_row), n_stages), states%matrix(n_stages*n, n_stages*n), &
                states%z(n_stages*n, size(states%periodic)))
   end function moving_states

   !> Advance the derivative from t to the end of the last step, or to the event at which it ended.
   subroutine derivative_along_step(model, states, solver, t_from, tolerance, derivative, status)
      class(orbit_model), intent(in) :: model
      type(moving_states_t), intent(inout) :: states
      type(radau_t), intent(in) :: solver
      real(wp), intent(in) :: t_from                !! within the step
      real(wp), intent(in) :: tolerance             !! of a piece, over the size of the derivative in units of the scales
      real(wp), intent(inout) :: derivative(:, :)   !! [n, n]
      type(status_t), intent(inout) :: status
      real(wp), parameter :: shortest = 1.0e-12_wp  !! piece over the step
      real(wp) :: t, h, error, factor

      t = t_from
      h = solver%t - t
      do while (t < solver%t)
         call try_piece(model, states, solver, t, h, derivative, error, status)
         if (has_failed(status)) return
         factor = 0.8_wp*(tolerance/max(error, tolerance*1.0e-14_wp))**(1.0_wp/order)
         if (error <= tolerance) then
            call take_piece(states, derivative)
            if (t + h >= solver%t .or. solver%t - (t + h) <= shortest*h) return
            t = t + h
            h = min(h*min(factor, 4.0_wp), solver%t - t)
         else
            h = h*max(0.2_wp, min(factor, 0.9_wp))
            if (h < shortest*(solver%t - t_from)) then
               call fail(status, code_no_solution, "the derivative of the flow cannot be followed at time "//quantity(t, "")// &
                         ": the Jacobian jumps where there is no event")
               return
            end if
         end if
      end do
   end subroutine derivative_along_step

   !> Solve one piece: (I - h A x J) Z = h (A x J) (1 x D), with the Jacobians of the seven stages, for the moving states.
   !> Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., IV.8, also for the decoupling of the
   !> system. Equation O2.
   subroutine try_piece(model, states, solver, t, h, derivative, error, status)
      class(orbit_model), intent(in) :: model
      type(moving_states_t), intent(inout) :: states !! returns Z
      type(radau_t), intent(in) :: solver
      real(wp), intent(in) :: t, h, derivative(:, :)
      real(wp), intent(out) :: error                 !! relative to the size of the derivative
      type(status_t), intent(inout) :: status
      logical :: good, is_constant

      error = 0
      if (size(states%moving) == 0) return
      error = huge(error)
      call find_jacobians(model, solver, t, h, states%entries, states%jacobians, is_constant, status)
      if (has_failed(status)) return
      if (is_constant) then
         call solve_apart(model, states, h, derivative, good)
      else
         call solve_whole(model, states, h, derivative, good)
      end if
      if (.not. good) then
         call fail(status, code_singular, "the variational equations have no solution at time "//quantity(t, ""))
         return
      end if
      call estimate(model, states%periodic, states%moving, derivative, states%z, error)
   end subroutine try_piece

   !> Solve the system of a piece as a whole. Equation O2.
   subroutine solve_whole(model, states, h, derivative, good)
      class(orbit_model), intent(in) :: model
      type(moving_states_t), intent(inout) :: states
      real(wp), intent(in) :: h, derivative(:, :)
      logical, intent(out) :: good
      real(wp) :: factor
      integer :: i, j, k, l, n, row, column

      n = size(states%moving)
      states%matrix = 0
      states%z = 0
      associate (matrix => states%matrix, z => states%z, periodic => states%periodic)
         do k = 1, n_stages
            do j = 1, size(states%entries)
               row = states%moving_index(model%jacobian_row(states%entries(j)))
               column = model%jacobian_column(states%entries(j))
               do i = 1, n_stages
                  factor = h*integral_to_node(i, k)*states%jacobians(states%entries(j), k)
                  if (states%moving_index(column) > 0) matrix((i - 1)*n + row, (k - 1)*n + states%moving_index(column)) = -factor
                  do l = 1, size(periodic)
                     z((i - 1)*n + row, l) = z((i - 1)*n + row, l) + factor*derivative(column, periodic(l))
                  end do
               end do
            end do
         end do
         do i = 1, n_stages*n
            matrix(i, i) = matrix(i, i) + 1
         end do
         call solve_small(matrix, z, good)
      end associate
   end subroutine solve_whole

   !> Solve it for a constant Jacobian: with A^-1 T = T Lambda and Z = (T x I) W it is (Lambda/h - J) W = (T^-1 1) x (J D).
   !> These are one real system and three complex ones, each with as many unknowns as there are moving states. Equation O2.
   subroutine solve_apart(model, states, h, derivative, good)
      class(orbit_model), intent(in) :: model
      type(moving_states_t), intent(inout) :: states
      real(wp), intent(in) :: h, derivative(:, :)
      logical, intent(out) :: good
      integer :: i, j, k, l, n, row, column
      real(wp), parameter :: ones(lanes) = [(sum(from_stage(i, :n_stages)), i=1, lanes)] ! T^-1 1
      real(wp), dimension(size(states%moving), size(states%moving)) :: shifted, minus_j
      real(wp), dimension(size(states%moving), size(states%periodic)) :: by_start, w
      real(wp) :: pair(2*size(states%moving), 2*size(states%moving)), w_pair(2*size(states%moving), size(states%periodic))

      n = size(states%moving)
      minus_j = 0
      by_start = 0
      do j = 1, size(states%entries)
         row = states%moving_index(model%jacobian_row(states%entries(j)))
         column = model%jacobian_column(states%entries(j))
         associate (entry => states%jacobians(states%entries(j), 1))
            if (states%moving_index(column) > 0) minus_j(row, states%moving_index(column)) = -entry
            do l = 1, size(states%periodic)
               by_start(row, l) = by_start(row, l) + entry*derivative(column, states%periodic(l))
            end do
         end associate
      end do
      shifted = minus_j
      do i = 1, n
         shifted(i, i) = shifted(i, i) + shift_re(1)/h
      end do
      w = ones(1)*by_start
      call solve_small(shifted, w, good)
      do i = 1, n_stages
         states%z((i - 1)*n + 1:i*n, :) = to_stage(i, 1)*w
      end do
      do k = 2, n_systems
         if (.not. good) return
         pair(:n, :n) = minus_j
         pair(n + 1:, n + 1:) = minus_j
         pair(n + 1:, :n) = 0
         pair(:n, n + 1:) = 0
         do i = 1, n
            pair(i, i) = pair(i, i) + shift_re(k)/h
            pair(n + i, n + i) = pair(i, i)
            pair(n + i, i) = shift_im(k)/h
            pair(i, n + i) = -shift_im(k)/h
         end do
         w_pair(:n, :) = ones(k)*by_start
         w_pair(n + 1:, :) = ones(n_systems + k)*by_start
         call solve_small(pair, w_pair, good)
         do i = 1, n_stages
            associate (z => states%z((i - 1)*n + 1:i*n, :))
               z = z + (to_stage(i, k)*w_pair(:n, :) + to_stage(i, n_systems + k)*w_pair(n + 1:, :))
            end associate
         end do
      end do
   end subroutine solve_apart

   !> Update the derivative to the end of a piece.
   pure subroutine take_piece(states, derivative)
      type(moving_states_t), intent(in) :: states
      real(wp), intent(inout) :: derivative(:, :)
      integer :: i, j, n

      n = size(states%moving)
      do j = 1, size(states%periodic)
         do i = 1, n
            associate (d => derivative(states%moving(i), states%periodic(j)))
               d = d + states%z((n_stages - 1)*n + i, j)
            end associate
         end do
      end do
   end subroutine take_piece

   !> Jacobians of the stages. If the relevant entries of the first, the last and the middle one are identical to the last
   !> digit, as for linear forces, the Jacobian is constant.
   subroutine find_jacobians(model, solver, t, h, entries, jacobians, is_constant, status)
      class(orbit_model), intent(in) :: model
      type(radau_t), intent(in) :: solver
      real(wp), intent(in) :: t, h
      integer, intent(in) :: entries(:)        !! relevant ones
      real(wp), intent(inout) :: jacobians(:, :) !! [all entries, n_stages]; if constant, use the first
      logical, intent(out) :: is_constant
      type(status_t), intent(inout) :: status
      integer, parameter :: order_of(n_stages) = [1, n_stages, (n_stages + 1)/2, 2, 3, 5, 6], few = 3
      real(wp) :: times(lanes), states(lanes, model%n), y(model%n)
      integer :: i, j, k

      is_constant = .false.
      times = t + h*node
      call radau_interpolate_lanes(solver, times, states)
      do i = 1, n_stages
         k = order_of(i)
         y = states(k, :)
         call model%jacobian(times(k), y, jacobians(:, k), status)
         if (has_failed(status)) return
         if (i /= few) cycle
         is_constant = .true.
         do j = 1, size(entries)
            associate (a => jacobians(entries(j), :))
               is_constant = is_constant .and. .not. (abs(a(order_of(1)) - a(order_of(2))) > 0 .or. &
                                                      abs(a(order_of(1)) - a(order_of(3))) > 0)
            end associate
         end do
         if (is_constant) return
      end do
   end subroutine find_jacobians

   !> Error of a piece, over the largest entry of the derivative, both in units of the scales.
   !> Equation O3.
   pure subroutine estimate(model, periodic, moving, derivative, z, error)
      class(orbit_model), intent(in) :: model
      integer, intent(in) :: periodic(:), moving(:)
      real(wp), intent(in) :: derivative(:, :), z(:, :)
      real(wp), intent(out) :: error
      real(wp), parameter :: end_over_pairs = 20, smooth = 0.1_wp
      real(wp) :: at_nodes(lanes), c(lanes), unit, largest, last, before, ratio, next
      integer :: i, j

      largest = 0
      do j = 1, size(periodic)
         do i = 1, size(periodic)
            largest = max(largest, abs(derivative(periodic(i), periodic(j)))/model%scale(periodic(i))*model%scale(periodic(j)))
         end do
      end do
      error = 0
      if (.not. largest > 0) return
      at_nodes(lanes) = 0
      do j = 1, size(periodic)
         do i = 1, size(moving)
            unit = model%scale(periodic(j))/(model%scale(moving(i))*largest)
            at_nodes(:n_stages) = z(i::size(moving), j)*unit
            c = matmul(to_chebyshev, at_nodes)
            last = norm2(c(lanes - 1:))
            before = norm2(c(lanes - 3:lanes - 2))
            if (.not. last > 0) cycle
            ratio = min(1.0_wp, last/max(before, tiny(before)))
            next = last*ratio
            error = max(error, merge(end_over_pairs*last*next, next, ratio < smooth))
         end do
      end do
   end subroutine estimate

   !> Jump of the derivative at an event, and the event itself: on return, state and modes are those after it. Equation O4.
   !>
   !> With y+ = r(t, y-) where g(t, y-) = 0,
   !>
   !>     D+ = (r_y + (f+ - r_y f- - r_t) g_y / (g_t + g_y f-)) D-
   !>
   !> At a time event, the time does not depend on the state: D+ = r_y D-.
   subroutine derivative_at_event(model, t, fired, time_event, y, derivative, rate, status)
      class(orbit_model), intent(inout) :: model
      real(wp), intent(in) :: t
      integer, intent(in) :: fired(:)
      logical, intent(in) :: time_event
      real(wp), intent(inout) :: y(:), derivative(:, :)
      real(wp), intent(inout) :: rate(:)            !! [n_roots] g_t + g_y f- of the functions that fired
      type(status_t), intent(inout) :: status
      real(wp) :: before(model%n), after(model%n), by_state(model%n, model%n), by_time(model%n)
      real(wp) :: gradient(model%n), first_gradient(model%n), drift, first_drift
      logical :: repeats(model%n)
      integer :: first, i

      call model%rhs(t, y, before, status)
      first = 0
      first_drift = 0
      first_gradient = 0
      do i = 1, model%n_roots
         if (fired(i) == 0 .or. has_failed(status)) cycle
         call model%root_gradient(t, y, i, gradient, drift, status)
         rate(i) = drift + dot_product(gradient, before)
         if (first /= 0) cycle
         first = i
         first_gradient = gradient
         first_drift = rate(i)
      end do
      if (.not. has_failed(status)) call model%apply_event(t, fired, time_event, y, by_state, by_time, status)
      if (.not. has_failed(status)) call model%rhs(t, y, after, status)
      if (has_failed(status)) return
      if (first /= 0 .and. .not. time_event) then
         if (.not. abs(first_drift) > 0) then
            call fail(status, code_singular, "a root function touches zero at time "//quantity(t, "")// &
                      " without crossing it: the flow has no derivative there", index=first)
            return
         end if
         after = (after - matmul(by_state, before) - by_time)/first_drift
         do i = 1, model%n
            by_state(:, i) = by_state(:, i) + after*first_gradient(i)
         end do
      end if
      repeats = must_repeat(model)
      do i = 1, model%n ! states that need not repeat affect no others
         if (repeats(i)) cycle
         by_state(i, :) = 0
         by_state(:, i) = 0
         by_state(i, i) = 1
      end do
      derivative = matmul(by_state, derivative)
   end subroutine derivative_at_event

end module evl_flow_derivative
