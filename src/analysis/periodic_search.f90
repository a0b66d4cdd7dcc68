!> Search for the periodic orbit of a start: alternate settling and Newton's method. docs/theory/orbits.md, "The periodic start".
!>
!> The motion from the steady start settles over some common periods. Newton's method then finds the orbit of one common period.
!> A stable orbit is accepted once the motion follows the linearised flow around it: then the motion from the steady start converges
!> to it. The state of the orbit is moved to the mesh position of the steady start.
!>
!> A flow is one integration over a common period or a part of it. The search is limited by the number of flows, so its result does
!> not depend on the computer.
module evl_periodic_search
   use evl_flow, only: flow_t, follow
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_orbits, only: gearbox_orbits, gearbox_orbits_start, gearbox_orbits_state
   use evl_kinds, only: wp
   use evl_local_variables, only: i_omega, i_theta
   use evl_multipliers, only: find_multipliers
   use evl_orbit_model, only: must_repeat
   use evl_periodic_orbit, only: orbit_options, orbit_t, own_multipliers, scaled_derivative
   use evl_shooting, only: find_orbit
   use evl_status, only: clear, code_no_solution, fail, has_failed, status_t, subject_initial
   implicit none (type, external)
   private

   public :: counted_orbits, move_to_start, periodic_search, periodic_start_t, pitch_rate, search_orbit

   integer, parameter :: settling_pitches = 16 !! in the first round; doubled in each further one
   integer, parameter :: most_rounds = 3     !! of settling and Newton's method
   integer, parameter :: most_sections = 4   !! maximum number of positions of the section
   integer, parameter :: most_corrections = 8 !! maximum corrections of the time at an angle

   type(orbit_options), parameter :: search_options = orbit_options(most_iterations=16, most_damped=8, most_halvings=4)
   real(wp), parameter :: golden = 0.381966011250105_wp !! shift of the section [pitches]
   real(wp), parameter :: settled = 1.0e-4_wp   !! change per period below which settling ends [scales]
   real(wp), parameter :: rough = 1.0e-9_wp     !! tolerance during settling
   real(wp), parameter :: linear = 0.5_wp       !! maximum error of the linearised flow, relative to the distance to the orbit
   real(wp), parameter :: there = 1.0e-6_wp     !! distance to the orbit that counts as converged [scales]
   real(wp), parameter :: repeats_to = 1.0e-9_wp !! tolerance of the start after a period [scales]
   real(wp), parameter :: smallest_multiplier = 1.0e-10_wp !! smaller ones are integration errors
   real(wp), parameter :: on_angle = 1.0e-13_wp !! [pitches]

   !> Result of the search.
   type :: periodic_start_t
      integer :: pitches = 0          !! common period in pitches of the first mesh; 0: unknown
      integer :: flows = 0            !! integrations made by the search
      integer :: periods = 0          !! common periods over which the motion settled
      integer :: ties = 0             !! coinciding events of the orbit: multipliers are those of one order of events
      real(wp) :: time = 0            !! period [s]
      real(wp) :: residual = huge(1.0_wp)    !! largest difference after a period [scales]
      complex(wp) :: multiplier = 0   !! the one of largest magnitude
      real(wp) :: time_constant = 0   !! of the slowest decay [s]; 0: not defined
      logical :: has_multiplier = .false.
      logical :: is_stable = .false.
      logical :: is_reached = .false. !! the motion from the steady start converges to the orbit
      logical :: is_interrupted = .false.
      logical :: has_searched = .false. !! the case was not rejected before the first flow
   end type periodic_start_t

   !> Limits of a search; extended by callers that can interrupt it.
   type, abstract :: periodic_search
      integer :: most_flows = 200
   contains
      procedure(stop_interface), deferred :: is_interrupted
   end type periodic_search

   abstract interface
      !> Whether the search must stop.
      logical function stop_interface(self)
         import :: periodic_search
         implicit none (type, external)
         class(periodic_search), intent(in) :: self
      end function stop_interface
   end interface

   !> A gearbox that counts its flows.
   type, extends(gearbox_orbits) :: counted_orbits
      class(periodic_search), pointer :: search => null()
      integer :: flows = 0
      logical :: is_limited = .false.
      logical :: is_interrupted = .false.
   contains
      procedure :: begin_flow
   end type counted_orbits

contains

   !> Count a flow, or fail if the search must stop.
   subroutine begin_flow(self, status)
      class(counted_orbits), intent(inout) :: self
      type(status_t), intent(inout) :: status

      if (self%search%is_interrupted()) self%is_interrupted = .true.
      if (self%is_interrupted) then
         call fail(status, code_no_solution, "the search for a periodic start was interrupted", subject_initial, field="kind")
      else if (self%is_limited .and. self%flows == self%search%most_flows) then
         call fail(status, code_no_solution, "too many flows", subject_initial, field="kind")
      else
         self%flows = self%flows + 1
      end if
   end subroutine begin_flow

   !> Alternate settling and Newton's method. Equation O8.
   subroutine search_orbit(model, y_steady, reals, found, orbit, status)
      type(counted_orbits), intent(inout) :: model
      real(wp), intent(in) :: y_steady(:), reals(:)
      type(periodic_start_t), intent(inout) :: found
      type(orbit_t), intent(out) :: orbit
      type(status_t), intent(inout) :: status !! fails if no orbit was found
      type(orbit_t) :: trial
      type(status_t) :: refusal
      real(wp) :: before(model%n), now(model%n), period
      integer :: n, round, section
      logical :: is_found

      call gearbox_orbits_start(model%gearbox_orbits, y_steady, 0, reals, now)
      model%phase = 0
      period = model%common%pitches/pitch_rate(model%gearbox, y_steady)
      n = max(1, settling_pitches/model%common%pitches)
      is_found = .false.
      round = 1
      section = 1
      call shift_section(model, now, status)
      do while (.not. has_failed(status))
         call settle_motion(model, n, found, before, now, period, status)
         if (has_failed(status)) exit
         call clear(refusal)
         call find_orbit(model, search_options, 0.0_wp, 1, now, period, trial, refusal)
         if (.not. is_found) call describe(model, trial, found)
         if (.not. has_failed(refusal)) then
            found%is_reached = is_stable(model, trial) .and. follows_linear_flow(model, trial, before, now)
            if (.not. is_found .or. found%is_reached) then
               orbit = trial
               call describe(model, orbit, found)
            end if
            is_found = .true.
            if (found%is_reached) exit
         else if (has_other_modes(trial) .and. section < most_sections) then
            section = section + 1
            call shift_section(model, now, status)
            cycle
         end if
         if (round == most_rounds .or. model%flows == model%search%most_flows .or. model%is_interrupted) exit
         round = round + 1
         n = 2*n
      end do
      if (is_found .and. .not. model%is_interrupted) then
         call clear(status)
      else if (.not. has_failed(status)) then
         status = refusal
      end if
   end subroutine search_orbit

   !> Shift the section, and a state on it, by a fraction of a pitch that is unlikely to separate events.
   subroutine shift_section(model, y, status)
      type(counted_orbits), intent(inout) :: model
      real(wp), intent(inout) :: y(:)
      type(status_t), intent(inout) :: status
      type(flow_t) :: flow
      real(wp) :: time

      time = golden/pitch_rate(model%gearbox, y)
      call follow(model, y, 0, time, rough, .false., flow, status)
      if (has_failed(status)) return
      y = flow%y
      if (model%common%by_time) model%phase = model%phase + time
   end subroutine shift_section

   !> Let the motion settle for n periods, or until it changes little.
   subroutine settle_motion(model, n, found, before, now, period, status)
      type(counted_orbits), intent(inout) :: model
      integer, intent(in) :: n
      type(periodic_start_t), intent(inout) :: found
      real(wp), intent(inout) :: before(:), now(:) !! the last two states on the section
      real(wp), intent(inout) :: period            !! estimated period of the orbit [s]
      type(status_t), intent(inout) :: status
      type(flow_t) :: flow
      real(wp) :: turned
      integer :: i

      do i = 1, n
         before = now
         call follow(model, before, 1, period, rough, .false., flow, status)
         if (has_failed(status)) return
         now = flow%y
         found%periods = found%periods + 1
         if (.not. model%common%by_time) then
            turned = model%common%pitches + pitches_of(model%gearbox, now(i_theta) - before(i_theta))
            if (turned > 0.5_wp*model%common%pitches) period = period*model%common%pitches/turned
         end if
         if (maxval(abs(now - before)/model%scale, must_repeat(model)) <= settled) return
      end do
   end subroutine settle_motion

   !> Data of the orbit found, or of the last iterate.
   subroutine describe(model, orbit, found)
      type(counted_orbits), intent(in) :: model
      type(orbit_t), intent(in) :: orbit
      type(periodic_start_t), intent(inout) :: found
      type(orbit_t) :: own
      type(status_t) :: status

      if (.not. allocated(orbit%flow%derivative) .or. .not. allocated(orbit%active)) return
      found%residual = orbit%residual
      found%time = orbit%period
      found%ties = orbit%flow%ties
      own = orbit
      if (.not. allocated(own%multipliers)) call find_multipliers(scaled_derivative(model, own), own%multipliers, status)
      if (has_failed(status)) return
      associate (mu => own_multipliers(model, own))
         found%is_stable = all(abs(mu) < 1)
         found%has_multiplier = size(mu) > 0
         found%multiplier = 0
         if (size(mu) > 0) found%multiplier = mu(maxloc(abs(mu), 1))
         if (abs(found%multiplier) <= smallest_multiplier) found%multiplier = 0
      end associate
      found%time_constant = 0
      if (found%is_stable .and. abs(found%multiplier) > smallest_multiplier) &
         found%time_constant = -found%time/log(abs(found%multiplier))
   end subroutine describe

   pure logical function is_stable(model, orbit)
      type(counted_orbits), intent(in) :: model
      type(orbit_t), intent(in) :: orbit

      is_stable = all(abs(own_multipliers(model, orbit)) < 1)
   end function is_stable

   !> Whether Newton's method closed the orbit, but an event at the section makes the modes at its ends differ.
   pure logical function has_other_modes(orbit)
      type(orbit_t), intent(in) :: orbit
      real(wp), parameter :: closed = 1.0e-6_wp

      has_other_modes = allocated(orbit%flow%y) .and. orbit%residual <= closed .and. .not. orbit%flow%same_modes
   end function has_other_modes

   !> Whether the motion between two states agrees with the linearised flow around the orbit. Equation O9.
   pure logical function follows_linear_flow(model, orbit, before, now) result(follows)
      type(counted_orbits), intent(in) :: model
      type(orbit_t), intent(in) :: orbit
      real(wp), intent(in) :: before(:), now(:) !! one period apart
      real(wp) :: first(model%n), second(model%n), along(model%n)

      along = 0
      if (model%autonomous) along = merge(orbit%flow%rate/model%scale, 0.0_wp, orbit%active)
      if (norm2(along) > 0) along = along/norm2(along)
      first = across(merge((before - orbit%y)/model%scale, 0.0_wp, orbit%active), along)
      second = across(merge((now - orbit%y)/model%scale, 0.0_wp, orbit%active), along)
      follows = norm2(second) <= there
      if (follows) return
      first = merge(matmul(orbit%flow%derivative, first*model%scale)/model%scale, 0.0_wp, orbit%active)
      first = across(first, along)
      follows = norm2(second - first) <= linear*norm2(second)
   end function follows_linear_flow

   !> Component of a vector orthogonal to a direction of length 1 or 0.
   pure function across(x, direction)
      real(wp), intent(in) :: x(:), direction(:)
      real(wp) :: across(size(x))

      across = x - dot_product(x, direction)*direction
   end function across

   !> Integrate the orbit to the mesh position of the steady start, and check there that it repeats after a period. Equation O8.
   subroutine move_to_start(model, orbit, theta, found, y, integers, reals, status)
      type(counted_orbits), intent(inout) :: model
      type(orbit_t), intent(in) :: orbit
      real(wp), intent(in) :: theta !! of the steady start [rad]
      type(periodic_start_t), intent(inout) :: found
      real(wp), intent(out) :: y(:), reals(:)
      integer, intent(out) :: integers(:)
      type(status_t), intent(inout) :: status
      type(orbit_options) :: options
      type(flow_t) :: flow
      real(wp) :: left, start(model%n), time
      integer :: i, periods
      logical :: repeats(model%n)

      y = 0
      integers = 0
      reals = 0
      if (model%common%by_time) then
         periods = ceiling(model%phase/found%time)
         time = periods*found%time - model%phase
         call follow(model, orbit%y, periods, time, options%tolerance, .false., flow, status)
      else
         left = pitches_of(model%gearbox, theta - orbit%y(i_theta))
         periods = ceiling(-left/model%common%pitches)
         left = left + periods*model%common%pitches
         time = left/pitch_rate(model%gearbox, orbit%y)
         do i = 1, most_corrections
            call follow(model, orbit%y, periods, time, options%tolerance, .false., flow, status)
            if (has_failed(status)) return
            left = pitches_of(model%gearbox, theta - flow%y(i_theta))
            if (abs(left) <= on_angle*model%common%pitches) exit
            time = time + left/pitch_rate(model%gearbox, flow%y)
         end do
      end if
      if (has_failed(status)) return
      start = flow%y
      start(i_theta) = theta
      model%phase = 0
      call gearbox_orbits_state(model%gearbox_orbits, start, y, integers, reals, status)
      if (.not. has_failed(status)) call follow(model, start, 1, found%time, options%tolerance, .false., flow, status)
      if (has_failed(status)) return
      repeats = must_repeat(model)
      found%residual = maxval(abs(flow%y - start)/model%scale, repeats)
      if (.not. found%residual <= max(repeats_to, 100*options%tolerance*norm2(scaled_derivative(model, orbit)))) &
         call fail(status, code_no_solution, "the orbit does not repeat from the mesh position of the start", subject_initial)
   end subroutine move_to_start

   !> Rate at which pitches of the first mesh pass, > 0 in its nominal sense of rotation [1/s].
   pure real(wp) function pitch_rate(gearbox, y) result(rate)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(:)

      rate = pitches_of(gearbox, y(i_omega))
   end function pitch_rate

   !> Pitches of the first mesh per angle of the reference wheel.
   pure real(wp) function pitches_of(gearbox, angle) result(pitches)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: angle !! [rad]

      associate (contact => gearbox%contacts(1))
         pitches = angle*contact%pair%advance/contact%base_pitch
      end associate
   end function pitches_of

end module evl_periodic_search
