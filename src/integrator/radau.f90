!> Integrator for y' = f(t, y) with event location: Radau IIA with seven stages, order 13, stages in SIMD lanes.
!>
!>     call radau_create(solver, model, options, status)
!>     call radau_start(solver, model, t, y, status)
!>     do: call radau_advance(solver, model, t_stop, outcome, status)
!>         radau_interpolate gives the state anywhere in the step just made, in solver%t_before .. solver%t
!>         outcome_event: change the model's discrete state and y as solver%fired says, then call radau_restart
!>
!> All variable data are in `radau_t` and in the model: integrations may be interleaved, or run in threads, with results
!> bitwise equal to those of single ones. `radau_create` allocates all memory, except the full matrices for the first step
!> with insufficient diagonal pivots.
!>
!> Error control: a step is accepted if its error estimate, in units of the model's scales, is at most 0.0022 tolerance^(4/7)
!> in root mean square. The exponent converts between the order 7 of the estimate and the order 13 of the result. A separate
!> estimate limits the error of the dense output to 5 tolerance. Errors thus stay within 10 times the tolerance, at the steps
!> and between them, unless the problem amplifies them (docs/theory/radau.md).
!>
!> Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., IV.8 (step control, predictor).
module evl_radau
   use evl_archive, only: archive_t
   use evl_elementary, only: real_power
   use evl_extreme_finder, only: candidate_t, extreme_finder_create, extreme_finder_t
   use evl_growth, only: growth_create, growth_forget, growth_t
   use evl_indices, only: indices
   use evl_kinds, only: lanes, wp
   use evl_ode_model, only: growth_never, ode_model
   use evl_root_finder, only: root_finder_create, root_finder_restart, root_finder_t
   use evl_stage_solver, only: factor_systems, forget, forget_start, move_start, newton_converged, predict_from, set_weights, &
                               solve_stages, stage_counts, stage_solver_create, stage_solver_t
   use evl_status, only: clear, code_invalid_input, code_no_solution, code_out_of_domain, fail, has_failed, quantity, status_t
   use evl_step_control, only: step_control_t
   implicit none (type, external)
   private

   public :: radau_t, radau_options, radau_counts, radau_growth
   public :: radau_create, radau_start, radau_advance, radau_restart, radau_redo, radau_interpolate, radau_get_counts, &
             radau_get_growth, radau_interpolate_lanes, radau_interpolate_some, radau_look, radau_step, serialize_radau
   public :: outcome_step, outcome_event, outcome_stop

   integer, parameter :: outcome_step = 0  !! a step was made
   integer, parameter :: outcome_event = 1 !! a step was made that ends at an event
   integer, parameter :: outcome_stop = 2  !! a step was made that ends at t_stop

   real(wp), parameter :: eps = epsilon(1.0_wp)
   real(wp), parameter :: share = 0.0022_wp     !! internal tolerance over tolerance^(4/7)
   real(wp), parameter :: smallest_step = 16*eps !! relative to the present time

   !> User options.
   type :: radau_options
      real(wp) :: tolerance = 1.0e-9_wp       !! error of a step in units of the scales, in 1e-13 .. 0.1
      real(wp) :: max_step = huge(1.0_wp)     !! > 0
      real(wp) :: first_step = 0              !! 0: chosen from f
   end type radau_options

   !> Cost counters.
   type, extends(stage_counts) :: radau_counts
      integer :: steps = 0                    !! accepted
      integer :: rejections = 0               !! steps repeated because of their error or a failure of Newton's iteration
      integer :: jacobians = 0
      integer :: root_evaluations = 0         !! scalar evaluations of the root functions; lane-wise: once a step
      integer :: events = 0                   !! located
      integer :: growth_cuts = 0              !! rejections of steps that do not follow a growing mode
   end type radau_counts

   !> A growing mode.
   type :: radau_growth
      real(wp) :: t = 0                       !! time at which it was found
      real(wp) :: re = 0, im = 0              !! its eigenvalue; re = 0: there is none
   end type radau_growth

   !> An integration in progress.
   type :: radau_t
      real(wp) :: t = 0                       !! present time
      real(wp), allocatable :: y(:)           !! [n] present state
      real(wp) :: t_before = 0                !! start of the last step
      integer, allocatable :: fired(:)        !! [n_roots] zero crossings at the event: +1 rising, -1 falling, 0 none
      type(radau_options), private :: options
      type(stage_solver_t), private :: stages
      type(root_finder_t), private :: roots
      type(extreme_finder_t), private :: monitored
      real(wp), allocatable, private :: y_before(:) !! [n] state at the start of the last step
      real(wp), allocatable, private :: old_z(:, :) !! [8, n] increments of the last step
      real(wp), private :: old_h = 0          !! step of its polynomial; 0: there is none
      real(wp), private :: h = 0              !! step to try next
      integer, allocatable, private :: came_from(:) !! [n_roots] `fired` at the event of the last restart
      real(wp), allocatable, private :: step_after(:, :) !! [-1:1, n_roots] first step after the last such event; huge: none
      type(step_control_t), private :: control
      integer, allocatable, private :: limited(:) !! indices of the states that have a reach
      type(growth_t), private :: growth
      type(radau_growth), private :: fastest_growth !! found so far
      logical, private :: jacobian_is_new = .false. !! evaluated at the present state
      logical, private :: jacobian_is_ahead = .false. !! evaluated a little ahead of it, within the next step
      logical, private :: jacobian_may_stay = .false. !! the one of an earlier step is good enough for the next step
      logical, private :: matrix_may_stay = .false. !! and so are the factors, if the step size is the same
      logical, private :: restarted = .true.  !! no step size history from here on
      logical, private :: rejected = .true.   !! the step is repeated, or is the first one
      type(status_t), private :: refusal      !! last trial step that the model refused; making its message takes long
      real(wp), private :: refused_t(lanes) = 0            !! stages of that trial step
      real(wp), allocatable, private :: refused_y(:, :)    !! [8, n]
      type(radau_counts), private :: counts
   end type radau_t

   interface
      !> Make one step, at most to t_stop and at most to the next event.
      module subroutine radau_advance(self, model, t_stop, outcome, status)
         implicit none (type, external)
         type(radau_t), intent(inout) :: self
         class(ode_model), intent(inout) :: model
         real(wp), intent(in) :: t_stop          !! later than the present time
         integer, intent(out) :: outcome         !! one of the outcomes above; undefined on failure
         type(status_t), intent(inout) :: status !! `code_out_of_domain`: the model refuses every step, with its message;
                                                 !! `code_no_solution`: the step became too small; else the model's
      end subroutine radau_advance

      !> State at time t in the last step: the collocation polynomial, of order 8 inside the step.
      pure module subroutine radau_interpolate(self, t, y)
         implicit none (type, external)
         type(radau_t), intent(in) :: self
         real(wp), intent(in) :: t   !! t_before <= t <= self%t
         real(wp), intent(out) :: y(:) !! [n]
      end subroutine radau_interpolate

      !> `radau_interpolate` for some of the states.
      pure module subroutine radau_interpolate_some(self, t, n, states, y)
         implicit none (type, external)
         type(radau_t), intent(in) :: self
         real(wp), intent(in) :: t         !! as above
         integer, intent(in) :: n
         integer, intent(in) :: states(n)  !! their indices, from 0
         real(wp), intent(inout) :: y(0:*) !! all states; the others remain unchanged
      end subroutine radau_interpolate_some

      !> `radau_interpolate` at eight times, bitwise equal.
      pure module subroutine radau_interpolate_lanes(self, t, y)
         implicit none (type, external)
         type(radau_t), intent(in) :: self
         real(wp), intent(in) :: t(lanes)                    !! t_before <= t <= self%t
         real(wp), intent(out) :: y(lanes, size(self%y))
      end subroutine radau_interpolate_lanes

      !> Check that the step just solved follows the growing modes; if not, set the step to try next.
      module subroutine follow_growth(self, model, h, followed, status)
         implicit none (type, external)
         type(radau_t), intent(inout) :: self
         class(ode_model), intent(in) :: model
         real(wp), intent(in) :: h
         logical, intent(out) :: followed
         type(status_t), intent(inout) :: status
      end subroutine follow_growth

      !> Longest step from here in which eight nodes are expected to resolve the model.
      pure module function step_limit(self, model) result(h)
         implicit none (type, external)
         type(radau_t), intent(in) :: self
         class(ode_model), intent(in) :: model
         real(wp) :: h
      end function step_limit

      !> Check that they resolve it in the step just solved; if not, set the step to try next.
      pure module subroutine check_resolution(self, model, h, is_resolved)
         implicit none (type, external)
         type(radau_t), intent(inout) :: self
         class(ode_model), intent(in) :: model
         real(wp), intent(in) :: h
         logical, intent(out) :: is_resolved
      end subroutine check_resolution

      !> Try a step of h; if Newton's iteration fails, error is huge and the step to try next is set.
      module subroutine attempt(self, model, h, error, status)
         implicit none (type, external)
         type(radau_t), intent(inout) :: self
         class(ode_model), intent(inout) :: model
         real(wp), intent(in) :: h
         real(wp), intent(out) :: error !! weighted estimate; the step is accepted below 1
         type(status_t), intent(inout) :: status
      end subroutine attempt

      !> Accept the step just solved, or the part of it before the first event.
      module subroutine finish(self, model, h, to_stop, t_stop, done, outcome, status)
         implicit none (type, external)
         type(radau_t), intent(inout) :: self
         class(ode_model), intent(inout) :: model
         real(wp), intent(in) :: h       !! the step
         logical, intent(in) :: to_stop  !! it ends at t_stop
         real(wp), intent(in) :: t_stop
         logical, intent(out) :: done    !! false: the step has to be repeated
         integer, intent(out) :: outcome !! one of the outcomes above
         type(status_t), intent(inout) :: status
      end subroutine finish

      !> First step that moves the state by about a hundredth of its scales, from f and its change along an Euler step.
      module subroutine choose_first_step(self, model, status)
         implicit none (type, external)
         type(radau_t), intent(inout) :: self
         class(ode_model), intent(in) :: model
         type(status_t), intent(inout) :: status
      end subroutine choose_first_step

      !> Step to try after a start or an event, from f and J. The step before the event limits it, since J does not contain
      !> everything.
      module subroutine choose_step(self, model, status)
         implicit none (type, external)
         type(radau_t), intent(inout) :: self
         class(ode_model), intent(in) :: model
         type(status_t), intent(inout) :: status
      end subroutine choose_step

      !> df/dy at the present state.
      module subroutine refresh_jacobian(self, model, status)
         implicit none (type, external)
         type(radau_t), intent(inout) :: self
         class(ode_model), intent(in) :: model
         type(status_t), intent(inout) :: status
      end subroutine refresh_jacobian

      !> Candidates for new extremes of the monitored channels in the last step; call before `radau_restart`.
      module subroutine radau_look(self, model, high, low, n, found)
         implicit none (type, external)
         type(radau_t), intent(inout) :: self
         class(ode_model), intent(inout) :: model
         real(wp), intent(in) :: high(:), low(:)      !! [n_monitored] extremes so far; +huge and -huge: not requested
         integer, intent(out) :: n
         type(candidate_t), intent(inout) :: found(:) !! [most_candidates n_rows] times in units of `radau_step`
      end subroutine radau_look

      !> Store a suitable first step after an event, for the next event of the same kind.
      pure module subroutine remember_step(self, h, error)
         implicit none (type, external)
         type(radau_t), intent(inout) :: self
         real(wp), intent(in) :: h, error !! the step and its error, < 1
      end subroutine remember_step

      !> Write an integration to an archive, or read it into one that was created for the same model and options.
      module subroutine serialize_radau(archive, self)
         implicit none (type, external)
         type(archive_t), intent(inout) :: archive
         type(radau_t), intent(inout) :: self
      end subroutine serialize_radau
   end interface

contains

   !> Check model and options, allocate all arrays. Equation R9.
   subroutine radau_create(self, model, options, status)
      type(radau_t), intent(out) :: self
      class(ode_model), intent(in) :: model
      type(radau_options), intent(in) :: options
      type(status_t), intent(inout) :: status

      if (.not. (options%tolerance >= 1.0e-13_wp .and. options%tolerance <= 0.1_wp)) then
         call fail(status, code_invalid_input, "tolerance "//quantity(options%tolerance, "")//" is not in 1e-13 .. 0.1", &
                   field="tolerance")
      else if (.not. options%max_step > 0) then
         call fail(status, code_invalid_input, "largest step "//quantity(options%max_step, "")//" is not positive", &
                   field="max_step")
      else if (.not. (options%first_step >= 0 .and. options%first_step <= huge(1.0_wp))) then
         call fail(status, code_invalid_input, "first step "//quantity(options%first_step, "")//" is negative", &
                   field="first_step")
      end if
      if (has_failed(status)) return
      self%options = options
      allocate (self%y(model%n), self%y_before(model%n), self%old_z(lanes, model%n), self%fired(model%n_roots))
      allocate (self%refused_y(lanes, model%n))
      allocate (self%came_from(model%n_roots), self%step_after(-1:1, model%n_roots))
      self%old_z = 0
      allocate (self%limited(0))
      if (allocated(model%reach)) self%limited = indices(model%reach < huge(1.0_wp))
      call stage_solver_create(self%stages, model, share*real_power(options%tolerance, 4.0_wp/7), options%tolerance)
      call root_finder_create(self%roots, model)
      if (model%growth /= growth_never) call growth_create(self%growth, self%stages%integrals%n_coupled, model%jacobian_row, &
                                                           model%jacobian_column, model%scale)
      call extreme_finder_create(self%monitored, model)
   end subroutine radau_create

   !> Start an integration at (t, y).
   subroutine radau_start(self, model, t, y, status)
      type(radau_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:) !! [n]
      type(status_t), intent(inout) :: status

      self%fired = 0
      self%step_after = huge(t)
      call radau_restart(self, model, t, y)
      self%came_from = 0
      self%counts = radau_counts()
      self%roots%evaluations = 0
      call forget(self%stages)
      self%fastest_growth = radau_growth()
      if (model%growth /= growth_never) call growth_forget(self%growth)
      self%h = self%options%first_step
      self%restarted = .not. self%h > 0
      if (self%h > 0) return
      call choose_first_step(self, model, status)
   end subroutine radau_start

   !> Restart from (t, y) after an event: f or y may have jumped there, so no history is used.
   subroutine radau_restart(self, model, t, y)
      type(radau_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:) !! [n]

      self%t = t
      self%y = y
      self%t_before = t
      self%y_before = y
      self%old_z = 0
      self%old_h = 0
      self%control = step_control_t()
      self%jacobian_is_new = .false.
      self%jacobian_is_ahead = .false.
      self%jacobian_may_stay = .false.
      self%matrix_may_stay = .false.
      self%rejected = .true.
      self%restarted = .true.
      call forget_start(self%stages)
      call root_finder_restart(self%roots, model, self%fired)
      self%came_from = self%fired
      self%fired = 0
   end subroutine radau_restart

   !> Reject the last step, which missed an event, and continue from its start with smaller steps. Each call takes a smaller
   !> step, until a step is accepted.
   subroutine radau_redo(self, model)
      type(radau_t), intent(inout) :: self
      class(ode_model), intent(in) :: model
      real(wp), parameter :: part = 0.25_wp !! of the step
      real(wp) :: t, y(model%n), h

      h = part*(self%t - self%t_before)
      t = self%t_before
      y = self%y_before
      self%fired = 0
      call radau_restart(self, model, t, y)
      self%h = h
      self%restarted = .false.
      self%counts%rejections = self%counts%rejections + 1
   end subroutine radau_redo

   !> Length of the last step's polynomial: the length of the step or, before an event, slightly more.
   pure real(wp) function radau_step(self) result(h)
      type(radau_t), intent(in) :: self

      h = self%old_h
   end function radau_step

   !> Cost counters since `radau_start`.
   pure type(radau_counts) function radau_get_counts(self) result(counts)
      type(radau_t), intent(in) :: self

      counts = self%counts
      counts%stage_counts = self%stages%counts
      counts%root_evaluations = self%roots%evaluations
   end function radau_get_counts

   !> Fastest growing mode since `radau_start` if steps were shortened for one. Oscillatory modes take precedence.
   pure type(radau_growth) function radau_get_growth(self) result(growth)
      type(radau_t), intent(in) :: self

      growth = radau_growth()
      if (self%counts%growth_cuts > 0) growth = self%fastest_growth
   end function radau_get_growth

end module evl_radau
