!> Start on a periodic orbit: restrictions, search from the steady start, and reasons of failure. docs/theory/orbits.md,
!> "The periodic start".
module evl_periodic_start
   use evl_dae_residual, only: gearbox_derivative
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_initial, only: gearbox_start, initial_at, initial_steady, initial_t
   use evl_gearbox_ode, only: gearbox_ode_serves
   use evl_gearbox_orbits, only: gearbox_family, gearbox_orbits, gearbox_orbits_create
   use evl_gearbox_scaling, only: gearbox_state_scales
   use evl_housing, only: housing_fixed, housing_prescribed
   use evl_kinds, only: wp
   use evl_local_variables, only: i_theta
   use evl_periodic_orbit, only: orbit_t
   use evl_periodic_search, only: counted_orbits, move_to_start, periodic_search, periodic_start_t, pitch_rate, search_orbit
   use evl_status, only: code_invalid_input, code_no_solution, fail, has_failed, quantity, status_t, subject_initial
   implicit none (type, external)
   private

   public :: begin_periodic_start, periodic_start

   integer, parameter :: most_pitches = 1000 !! limit of the common period
   character(len=*), parameter :: refused = "a periodic start is refused: "

   !> A family of one gearbox, independent of the parameter.
   type, extends(gearbox_family) :: single_gearbox
      type(gearbox_t), pointer :: gearbox => null()
      real(wp), allocatable :: scale(:)
   contains
      procedure :: take
   end type single_gearbox

contains

   subroutine take(self, value, gearbox, scale, status)
      class(single_gearbox), intent(inout) :: self
      real(wp), intent(in) :: value
      type(gearbox_t), pointer, intent(out) :: gearbox
      real(wp), allocatable, intent(out) :: scale(:)
      type(status_t), intent(inout) :: status

      gearbox => self%gearbox
      scale = self%scale
   end subroutine take

   !> Steady start from which the search begins; checks that the gearbox supports a periodic start. A housing with a prescribed
   !> motion is fixed in it.
   !> Errors: code_invalid_input; those of a steady start.
   subroutine begin_periodic_start(gearbox, initial, found, y, yp, integers, reals, status)
      type(gearbox_t), intent(in), target :: gearbox
      type(initial_t), intent(in) :: initial !! only its mesh position is used
      type(periodic_start_t), intent(inout) :: found
      real(wp), intent(out) :: y(gearbox%n_states), yp(gearbox%n_states)
      integer, intent(out) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: reals(size(gearbox%contacts))
      type(status_t), intent(inout) :: status
      type(single_gearbox), target :: family
      type(gearbox_orbits) :: model
      type(gearbox_t) :: resting

      y = 0
      yp = 0
      integers = 0
      reals = 0
      call prepare(gearbox, family, model, found, status)
      if (has_failed(status)) return
      resting = gearbox
      if (resting%housing%kind == housing_prescribed) resting%housing%kind = housing_fixed
      call gearbox_start(resting, initial_at(initial_steady, initial%mesh_position), 0.0_wp, y, yp, integers, reals, status)
      if (has_failed(status)) return
      if (.not. model%common%by_time .and. .not. pitch_rate(gearbox, y) > 0) &
         call fail(status, code_invalid_input, refused//"in the steady state the first mesh does not turn in its nominal" &
                   //" sense; start with kind: steady", subject_initial, field="kind")
   end subroutine begin_periodic_start

   !> Create the model of the orbits, or fail with the reason.
   subroutine prepare(gearbox, family, model, found, status)
      type(gearbox_t), intent(in), target :: gearbox
      type(single_gearbox), intent(inout), target :: family
      type(gearbox_orbits), intent(out) :: model
      type(periodic_start_t), intent(inout) :: found
      type(status_t), intent(inout) :: status
      real(wp) :: row(gearbox%n_states)

      family%gearbox => gearbox
      allocate (family%scale(gearbox%n_states))
      call gearbox_state_scales(gearbox, [real(wp) ::], family%scale, row)
      call gearbox_ode_serves(gearbox, status, "start with simulation.initial.kind: steady")
      if (.not. has_failed(status)) call gearbox_orbits_create(model, family, 0.0_wp, 0.0_wp, status)
      if (has_failed(status)) then
         status%message = refused//status%message(:len(status%message) - len(refused))
         return
      end if
      found%pitches = model%common%pitches
      found%time = model%common%time
      if (model%common%pitches > most_pitches) then
         call fail(status, code_invalid_input, refused//"the common period is "// &
                   quantity(real(model%common%pitches, wp), "pitches")//" of the first mesh, more than "// &
                   quantity(real(most_pitches, wp), "")//"; start with kind: steady", subject_initial, field="kind")
      else if (model%common%sense < 0) then
         call fail(status, code_invalid_input, refused//"the wheels turn against driving_rotation; give the" &
                   //" other rotation, or start with kind: steady", subject_initial, field="kind")
      end if
   end subroutine prepare

   !> Compute the complete state of the orbit at t = 0.
   !> Errors: those of begin_periodic_start; code_invalid_input for too many flows, code_no_solution if no orbit was found or the
   !> search was interrupted.
   subroutine periodic_start(gearbox, initial, search, found, y, yp, integers, reals, status)
      type(gearbox_t), intent(in), target :: gearbox
      type(initial_t), intent(in) :: initial !! only its mesh position is used
      class(periodic_search), intent(inout), target :: search
      type(periodic_start_t), intent(out) :: found
      real(wp), intent(out) :: y(gearbox%n_states), yp(gearbox%n_states)
      integer, intent(out) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: reals(size(gearbox%contacts))
      type(status_t), intent(inout) :: status
      type(single_gearbox), target :: family
      type(counted_orbits) :: model
      type(orbit_t) :: orbit
      real(wp) :: theta
      type(status_t) :: refusal

      call begin_periodic_start(gearbox, initial, found, y, yp, integers, reals, status)
      if (.not. has_failed(status)) call prepare(gearbox, family, model%gearbox_orbits, found, status)
      if (has_failed(status)) return
      model%search => search
      model%is_limited = .true.
      found%has_searched = .true.
      theta = y(i_theta)
      call search_orbit(model, y, reals, found, orbit, refusal)
      found%flows = model%flows
      found%is_interrupted = model%is_interrupted
      model%is_limited = .false.
      if (.not. has_failed(refusal)) call move_to_start(model, orbit, theta, found, y, integers, reals, refusal)
      found%is_interrupted = model%is_interrupted
      if (.not. has_failed(refusal)) call gearbox_derivative(gearbox, 0.0_wp, y, integers, reals, yp, refusal)
      if (has_failed(refusal)) call explain(model, found, refusal, status)
   end subroutine periodic_start

   !> Report the failure of the search, with cause and remedy.
   subroutine explain(model, found, reason, status)
      type(counted_orbits), intent(in) :: model
      type(periodic_start_t), intent(in) :: found
      type(status_t), intent(in) :: reason
      type(status_t), intent(inout) :: status
      character(len=:), allocatable :: left, constant

      if (found%is_interrupted) then
         call fail(status, code_no_solution, "the search for a periodic start was interrupted", subject_initial, field="kind")
         return
      end if
      if (found%residual < huge(1.0_wp)) then
         left = "after a common period the state still differs by "//quantity(found%residual, "")//" of its scales"
      else
         left = trim(reason%message)
      end if
      if (found%time_constant > 0) then
         constant = "the slowest time constant there is "//quantity(found%time_constant, "s")
      else if (found%has_multiplier) then
         constant = "a disturbance there grows by "//quantity(abs(found%multiplier), "")//" in a period"
      else
         constant = "the slowest time constant is unknown"
      end if
      if (model%flows >= model%search%most_flows) then
         call fail(status, code_invalid_input, refused//"the search needs more than "// &
                   quantity(real(model%search%most_flows, wp), "flows")//" over the common period; "//left//"; "//constant// &
                   "; start with kind: steady", subject_initial, field="kind")
      else
         call fail(status, code_no_solution, "no periodic orbit was found from the steady start: "//left//"; "//constant// &
                   "; start with kind: steady and a longer duration, or give more damping", subject_initial, field="kind")
      end if
   end subroutine explain

end module evl_periodic_start
