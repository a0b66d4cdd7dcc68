!> Initial state: rest, given speeds, or steady state.
module evl_gearbox_initial
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use evl_closed_form, only: closed_form_gap, points_from_closed_form
   use evl_contact_modes, only: take_load
   use evl_contact_point, only: base_arc, contact_point
   use evl_dae_residual, only: gearbox_derivative
   use evl_discrete_state, only: gearbox_store_mode, take_mode
   use evl_gearbox, only: gearbox_local, gearbox_t, i_turns
   use evl_housing, only: frame_t, housing_frame, n_housing_states
   use evl_housing_dynamics, only: coupled_rates
   use evl_kinds, only: wp
   use evl_knots, only: knots_passed
   use evl_local_variables, only: at_psi_dot_a, at_psi_dot_b, at_v_a, at_v_b, i_omega, n_local, n_track
   use evl_rigid_forces, only: set_multipliers
   use evl_row, only: range_t, row_t, span_t, type_choice, type_named, type_number
   use evl_start_positions, only: assign_pairs, closed_form_point, find_coupled_modes, find_mode, gearbox_state, prescribed_speed, &
                                  set_gaps
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t, subject_initial, subject_load, subject_mesh, &
                         subject_wheel
   use evl_steady_start, only: find_equilibrium, find_steady_start
   use evl_tooth_contact, only: contact_mode, contact_state, flank_coast, flanks_loaded, flanks_off, flanks_open, tooth_contact_t
   implicit none (type, external)
   private

   public :: initial_at, initial_t, gearbox_start, gearbox_initial_speeds, settle_start
   public :: initial_equilibrium, initial_rest, initial_steady, initial_speeds

   integer, parameter :: initial_rest = 0   !! all speeds 0
   integer, parameter :: initial_steady = 1 !! steady motion under the loads
   integer, parameter :: initial_speeds = 2 !! initial speeds given
   integer, parameter :: initial_equilibrium = -1 !! no acceleration at a position of the first mesh; not available in a case

   real(wp), parameter :: rounding = 1.0e-14_wp  !! relative: smaller differences of speeds count as 0
   real(wp), parameter :: touching = 1.0e-9_wp   !! gap over the penetration scale below which rigid flanks are in contact
   real(wp), parameter :: speed_agreement = 1.0e-12_wp !! relative tolerance between an initial and a prescribed speed

   real(wp), parameter :: most_pitches = 1.0e6_wp !! maximum position of a steady start

   ! rows of the initial condition
   type(row_t), parameter, public :: initial_rows(*) = [ &
                                  row_t("kind", type_choice, "", "all speeds zero; steady motion under the loads; given speeds; a" &
                                           //" periodic orbit", default="rest", words="rest steady speeds periodic"), &
               row_t("speeds", type_named, "rad/s", "angular velocity of every wheel by name", required=.true., variants="speeds", &
                                           plausible=span_t(0.0_wp, 15000.0_wp)), &
                 row_t("gaps", type_named, "m", "gap between the flanks of a mesh by name, 0 if not given; negative: penetration", &
                                           default="{}", variants="rest speeds", &
                                           plausible=span_t(0.0_wp, 0.01_wp)), &
                          row_t("position", type_number, "", "position in pitches of the first mesh from the start of contact; if" &
                            //" not given, inside a contact zone", range=range_t(0.0_wp, most_pitches), variants="steady periodic")]

   type :: initial_t
      integer :: kind = initial_rest       !! one of the kinds above
      real(wp), allocatable :: speeds(:)   !! of the wheels [rad/s], for initial_speeds; else size 0
      real(wp), allocatable :: gaps(:)     !! of the meshes [m]; size 0: all in contact
      real(wp) :: mesh_position = 0.0_wp   !! of a steady start: pitches from the start of contact; NaN: a position within a zone
   end type initial_t

contains

   !> Start in steady motion or equilibrium at a position of the first mesh.
   pure type(initial_t) function initial_at(kind, mesh_position) result(initial)
      integer, intent(in) :: kind           !! initial_steady, initial_equilibrium
      real(wp), intent(in) :: mesh_position !! pitches from the start of contact

      initial%kind = kind
      initial%mesh_position = mesh_position
      allocate (initial%speeds(0), initial%gaps(0)) ! gfortran 12 leaves an empty array in a structure constructor unallocated
   end function initial_at

   !> Initial speeds of the wheels [rad/s] if given; size 0 for a steady start.
   pure function gearbox_initial_speeds(gearbox, initial) result(speeds)
      type(gearbox_t), intent(in) :: gearbox
      type(initial_t), intent(in) :: initial
      real(wp), allocatable :: speeds(:)

      select case (initial%kind)
      case (initial_speeds)
         speeds = initial%speeds
      case (initial_rest)
         allocate (speeds(size(gearbox%wheels)), source=0.0_wp)
      case default
         allocate (speeds(0))
      end select
   end function gearbox_initial_speeds

   !> Compute the complete initial state at time t.
   !> Errors: code_invalid_input, code_no_solution (steady), code_out_of_domain.
   subroutine gearbox_start(gearbox, initial, t, y, yp, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      type(initial_t), intent(in) :: initial
      real(wp), intent(in) :: t
      real(wp), intent(out) :: y(gearbox%n_states), yp(gearbox%n_states)
      integer, intent(out) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: reals(size(gearbox%contacts))
      type(status_t), intent(inout) :: status
      logical :: opened(size(gearbox%contacts))
      integer :: i

      y = 0
      yp = 0
      integers = 0
      reals = 0
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i)%load)
            if (load%i_segment > 0) integers(load%i_segment) = knots_passed(load%knots, t)
         end associate
      end do
      associate (housing => gearbox%housing, first => gearbox%housing%i_state)
         if (housing%is_mounted) &
            y(first:first + n_housing_states - 1) = [housing%position, housing%orientation, housing%velocity, housing%omega]
      end associate
      status = gearbox%start_refusal
      if (.not. has_failed(status)) call check_initial(gearbox, initial, status)
      if (has_failed(status)) return
      if (any(initial%kind == [initial_steady, initial_equilibrium])) then
         call find_at_position()
      else
         call set_speeds(gearbox, gearbox_initial_speeds(gearbox, initial), t, y, integers, status)
         if (has_failed(status)) return
         if (size(initial%gaps) > 0) call set_gaps(gearbox, -initial%gaps, y)
         call check_gaps(gearbox, initial, y, status)
      end if
      if (has_failed(status)) return
      call set_tracked(gearbox, y)
      call assign_pairs(gearbox, y, integers)
      call settle_start(gearbox, t, y, integers, reals, status)
      if (has_failed(status)) return
      if (any(initial%kind == [initial_steady, initial_equilibrium])) reals = 0 ! no approach precedes the start
      call set_multipliers(gearbox, t, y, integers, reals, opened, status)
      if (.not. has_failed(status)) call gearbox_derivative(gearbox, t, y, integers, reals, yp, status)

   contains

      !> Steady state or equilibrium; a NaN position means not given.
      subroutine find_at_position()
         real(wp), allocatable :: position
         type(gearbox_state) :: state

         state = gearbox_state(t, y, integers, reals)
         if (.not. ieee_is_nan(initial%mesh_position)) position = initial%mesh_position
         if (initial%kind == initial_steady) then
            call find_steady_start(gearbox, position, state, status)
         else
            call find_equilibrium(gearbox, position, state, status)
         end if
         y = state%y
         integers = state%integers
         reals = state%reals
      end subroutine find_at_position

   end subroutine gearbox_start

   !> Check the parameters of the initial condition.
   subroutine check_initial(gearbox, initial, status)
      type(gearbox_t), intent(in) :: gearbox
      type(initial_t), intent(in) :: initial
      type(status_t), intent(inout) :: status

      if (all(initial%kind /= [initial_rest, initial_steady, initial_speeds, initial_equilibrium])) then
         call fail(status, code_invalid_input, "there is no such kind of start", subject_initial, field="kind")
      else if (initial%kind == initial_speeds .and. size(initial%speeds) /= size(gearbox%wheels)) then
         call fail(status, code_invalid_input, "a start with given speeds needs one for each wheel", subject_initial, &
                   field="speeds")
      else if (.not. (all(ieee_is_finite(initial%speeds)) .and. all(ieee_is_finite(initial%gaps)))) then
         call fail(status, code_invalid_input, "initial speeds and gaps must be finite numbers", subject_initial)
      else if (size(initial%gaps) /= 0 .and. size(initial%gaps) /= size(gearbox%pairs)) then
         call fail(status, code_invalid_input, "initial gaps need one for each mesh", subject_initial, field="gaps")
      else if (initial%kind == initial_steady .and. any(abs(initial%gaps) > 0)) then
         call fail(status, code_invalid_input, "a steady start has no gaps: its penetrations follow from the loads", &
                   subject_initial, field="gaps")
      else if (initial%mesh_position < 0 .or. abs(initial%mesh_position) > most_pitches) then
         call fail(status, code_invalid_input, "the position of a steady start is a number of pitches from 0 to 1e6", &
                   subject_initial, field="position")
      end if
   end subroutine check_initial

   !> Set the speeds of the wheels; a prescribed speed must equal the initial speed.
   subroutine set_speeds(gearbox, speeds, t, y, integers, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: speeds(:), t
      real(wp), intent(inout) :: y(:)
      integer, intent(in) :: integers(:)
      type(status_t), intent(inout) :: status
      real(wp) :: prescribed, spin
      type(frame_t) :: frame
      integer :: i

      call housing_frame(gearbox%housing, t, y, frame)
      y(i_omega) = speeds(gearbox%reference)
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%i_psi > 0) y(wheel%i_psi + 1) = speeds(i) - wheel%ratio*y(i_omega)
            if (abs(speeds(i) - speeds(wheel%leader)) > speed_agreement*abs(speeds(i))) then
               call fail(status, code_invalid_input, "its initial speed "//quantity(speeds(i), "rad/s")//" does not agree with " &
                         //quantity(speeds(wheel%leader), "rad/s")//", that of another wheel on the same rigid shaft", &
                         subject_wheel, i, "speeds")
               return
            end if
            if (wheel%prescribed == 0) cycle
            spin = merge(0.0_wp, frame%omega(3), gearbox%loads(wheel%prescribed)%load%against_housing)
            prescribed = prescribed_speed(gearbox, wheel%prescribed, t, integers) - spin
            if (abs(prescribed - speeds(i)) <= speed_agreement*(abs(prescribed) + abs(spin))) cycle
            call fail(status, code_invalid_input, "the prescribed speed "//quantity(prescribed, "rad/s")//" does not agree" &
                      //" with the initial speed "//quantity(speeds(i), "rad/s")//" of its wheel; start with given speeds," &
                      //" or from a steady state", subject_load, wheel%prescribed, "value")
            return
         end associate
      end do
   end subroutine set_speeds

   !> Check initial gaps: the coast flanks must not overlap. In a closed loop of wheels the last gap follows from the others and
   !> must equal the given one. Gaps are those of flanks without deviations.
   subroutine check_gaps(gearbox, initial, y, status)
      type(gearbox_t), intent(in) :: gearbox
      type(initial_t), intent(in) :: initial
      real(wp), intent(in) :: y(:)
      type(status_t), intent(inout) :: status
      real(wp) :: q(n_local), gap
      integer :: m

      if (.not. any(abs(initial%gaps) > 0)) return ! all flanks that can be in contact are
      do m = 1, size(gearbox%pairs)
         associate (contact => gearbox%contacts(gearbox%first(m)))
            if (initial%gaps(m) <= contact%base_pitch/2) cycle
            if (.not. any(gearbox%contacts%mesh == contact%mesh .and. gearbox%contacts%flank == flank_coast)) cycle
            call fail(status, code_invalid_input, "its initial gap "//quantity(initial%gaps(m), "m")//" is more than half a base" &
                      //" pitch, "//quantity(contact%base_pitch/2, "m")//": the coast flanks would penetrate each other; give" &
                      //" one within the backlash", subject_mesh, m, "gaps")
            return
         end associate
      end do
      do m = 1, size(gearbox%pairs)
         associate (contact => gearbox%contacts(gearbox%first(m)))
            call gearbox_local(gearbox, contact, y, q)
            gap = closed_form_gap(contact%pair, q)
         end associate
         if (abs(gap - initial%gaps(m)) <= 1.0e-9_wp*maxval(abs(initial%gaps))) cycle
         call fail(status, code_invalid_input, "its initial gap "//quantity(initial%gaps(m), "m")//" does not agree with " &
                   //quantity(gap, "m")//", which the gaps of the other meshes in its ring leave", subject_mesh, m, "gaps")
         return
      end do
   end subroutine check_gaps

   !> Set tracked variables from the positions of the wheels.
   subroutine set_tracked(gearbox, y)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(inout) :: y(gearbox%n_states)
      real(wp) :: q(n_local)
      integer :: m

      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m))
            if (contact%i_track == 0 .or. contact%slot > 0) cycle
            call gearbox_local(gearbox, contact, y, q)
            call points_from_closed_form(contact%pair, q, y(contact%i_track:contact%i_track + n_track - 1))
         end associate
      end do
   end subroutine set_tracked

   !> A rigid contact is closed if the flanks touch without relative motion along the line of action. If they approach, the contact
   !> counts as open, and the first step finds the impact.
   subroutine settle_rigid(contact, point, mode, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_point), intent(in) :: point
      type(contact_mode), intent(inout) :: mode
      type(status_t), intent(inout) :: status

      if (abs(point%h_dot) <= rounding*(abs(contact%pair%r_ba*point%omega_a) + abs(contact%pair%r_bb*point%omega_b)) &
          .and. abs(point%h) <= touching*contact%h_scale) then
         mode%flanks = flanks_loaded
      else if (point%h > touching*contact%h_scale) then
         call fail(status, code_invalid_input, "a rigid contact cannot start with the penetration "//quantity(point%h, "m") &
                   //"; give a gap of at least 0", subject_mesh, contact%mesh, "gaps")
      end if
   end subroutine settle_rigid

   !> Set contact modes and friction branches from positions and speeds. Flanks that barely touch count as loaded unless they
   !> separate or would be accelerated apart.
   subroutine settle_start(gearbox, t, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(status_t), intent(inout) :: status
      type(contact_state) :: at(size(gearbox%contacts))
      real(wp) :: free(gearbox%n_states), q(n_local), parting
      integer :: m

      call coupled_rates(gearbox, t, y, integers, reals, free, status)
      if (has_failed(status)) return
      do m = 1, size(gearbox%contacts)
         call take_mode(gearbox, m, integers, reals, at(m)%mode)
         if (at(m)%mode%flanks /= flanks_off) call closed_form_point(gearbox, m, y, integers(i_turns), at(m)%mode%tooth_pair, at(m))
      end do
      call find_coupled_modes(gearbox, at, status)
      if (has_failed(status)) return
      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m), mode => at(m)%mode, point => at(m)%point)
            if (mode%flanks == flanks_off) cycle
            call find_mode(gearbox, m, at, status)
            if (has_failed(status)) return
            if (mode%flanks == flanks_open .and. contact%rigid) then
               call settle_rigid(contact, point, mode, status)
               if (has_failed(status)) return
            else if (mode%flanks == flanks_open .and. .not. at(m)%overlap < 0) then
               call gearbox_local(gearbox, contact, free, q)
               parting = contact%pair%sigma*base_arc(contact%pair, q(at_psi_dot_a), q(at_psi_dot_b)) + q(at_v_b + 1) - q(at_v_a + 1)
               if (point%h_dot > 0 .or. (.not. point%h_dot < 0 .and. parting <= 0)) mode%flanks = flanks_loaded
            end if
            if (mode%flanks == flanks_loaded) call take_load(contact, at(m))
            call gearbox_store_mode(gearbox, m, mode, integers, reals)
         end associate
      end do
   end subroutine settle_start

end module evl_gearbox_initial
