!> Equilibrium of a gearbox at one mesh position: no acceleration, with speeds of the wheels that follow from the slopes of the
!> equilibrium along the path.
!>
!> Source: docs/theory/theory.md, section 9.
module evl_steady_state
   use evl_gearbox, only: gearbox_t
   use evl_housing, only: at_omega, at_position, at_velocity
   use evl_indices, only: indices
   use evl_kinds, only: wp
   use evl_local_variables, only: i_omega
   use evl_no_damping, only: no_damping_t
   use evl_no_friction, only: no_friction_t
   use evl_nominal_point, only: speed_in_balance
   use evl_start_positions, only: gearbox_state, prescribed_speed
   use evl_status, only: clear, code_out_of_domain, has_failed, status_t
   use evl_steady_contacts, only: load_all, press_flanks
   use evl_steady_newton, only: find_slopes, follow, relax_steady, solve_steady, steady_system
   use evl_steady_position, only: angle_constraint
   use evl_steady_refusals, only: check_pressed, check_steady, refuse_alternation, refuse_slope
   use evl_wheel_loads, only: hold_still
   implicit none (type, external)
   private

   public :: equilibrium_models, find_balance, find_models, find_steady_state, list_unknowns, settle_steady

   integer, parameter :: max_modes = 30     !! maximum number of sets of loaded pairs and friction branches
   integer, parameter :: max_relaxed = 400  !! maximum number of relaxation steps
   real(wp), parameter :: relaxed = 1.0e-6_wp !! length of a converged relaxation step, in units of the scales
   real(wp), parameter :: faster = 0.5_wp, slower = 4.0_wp !! factors of the inverse step size: if the force decreases, else

   !> Three variants of the gearbox with constant loads and closed-form contacts.
   type :: equilibrium_models
      type(gearbox_t) :: whole  !! with all laws
      type(gearbox_t) :: static !! without damping of the contacts
      type(gearbox_t) :: smooth !! without damping and friction of the contacts
   end type equilibrium_models

contains

   !> Create the variants.
   subroutine find_models(gearbox, models)
      type(gearbox_t), intent(in) :: gearbox
      type(equilibrium_models), intent(out) :: models
      integer :: i

      models%whole = gearbox
      call hold_still(models%whole)
      models%static = models%whole
      do i = 1, size(gearbox%contacts)
         models%static%contacts(i)%damping = no_damping_t()
      end do
      models%smooth = models%static
      do i = 1, size(gearbox%contacts)
         models%smooth%contacts(i)%friction = no_friction_t()
      end do
   end subroutine find_models

   !> Positions and speeds without acceleration, by Newton's method on the closed form. Approach speeds are 0. A speed that is not
   !> prescribed is unknown. Its initial guess is the speed at which the loads balance, then 0: friction may hardly depend on the
   !> former.
   !> Errors: code_no_solution, code_out_of_domain.
   subroutine find_steady_state(gearbox, models, constraint, state, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(equilibrium_models), intent(in) :: models
      type(angle_constraint), intent(in) :: constraint
      type(status_t), intent(inout) :: status
      type(steady_system) :: system
      type(status_t) :: refusal
      type(gearbox_state) :: begin

      call check_steady(gearbox, state%integers, status)
      if (has_failed(status)) return
      begin = state
      associate (driver => gearbox%wheels(gearbox%reference)%prescribed)
         call list_unknowns(gearbox, constraint, driver == 0, system)
         if (driver > 0) then
            state%y(i_omega) = prescribed_speed(gearbox, driver, state%t, state%integers)
         else
            state%y(i_omega) = speed_in_balance(models%whole, state%t, state%integers)
         end if
         call find_from(gearbox, models, system, state, status)
         if (driver > 0 .or. .not. has_failed(status)) return
      end associate
      refusal = status
      call clear(status)
      state = begin
      state%y(i_omega) = 0
      call find_from(gearbox, models, system, state, status)
      if (has_failed(status)) status = refusal
   end subroutine find_steady_state

   !> The same from an initial speed.
   subroutine find_from(gearbox, models, system, state, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(equilibrium_models), intent(in) :: models
      type(steady_system), intent(inout) :: system
      type(status_t), intent(inout) :: status

      state%reals = 0
      system%slopes = 0
      call follow(system, state%y)
      call press_flanks(gearbox, state)
      call settle_steady(models%static, system, state, status)
      if (.not. has_failed(status)) call check_pressed(models%static, state, status)
      if (has_failed(status) .or. any(gearbox%contacts%rigid)) return
      call find_slopes(models%smooth, system, state, status)
      if (.not. has_failed(status)) call find_balance(models, system, state, status)
   end subroutine find_from

   !> From the static equilibrium to the equilibrium with all dampers, at the speeds from the system's slopes. If there is none, the
   !> dampers of the contacts are omitted.
   subroutine find_balance(models, system, state, status)
      type(equilibrium_models), intent(in) :: models
      type(gearbox_state), intent(inout) :: state
      type(steady_system), intent(in) :: system
      type(status_t), intent(inout) :: status
      type(gearbox_state) :: static

      static = state
      call settle_steady(models%whole, system, state, status)
      if (.not. has_failed(status)) call check_pressed(models%whole, state, status)
      if (.not. has_failed(status)) return
      call clear(status)
      state = static
      call settle_steady(models%static, system, state, status)
   end subroutine find_balance

   !> Unknowns and equations. The pose of a mounted housing is unknown; its velocity is 0.
   subroutine list_unknowns(gearbox, constraint, speed_is_unknown, system)
      type(gearbox_t), intent(in) :: gearbox
      type(angle_constraint), intent(in) :: constraint
      logical, intent(in) :: speed_is_unknown
      type(steady_system), intent(out) :: system
      integer, allocatable :: unknown(:), row(:), speed(:), leaders(:)
      integer :: i

      leaders = indices([(gearbox%wheels(i)%leader == i .and. i /= gearbox%reference, i=1, size(gearbox%wheels))])
      unknown = gearbox%wheels(leaders)%i_psi
      row = unknown + 1
      do i = 1, size(gearbox%contacts)
         ! a rigid contact determines a position by kappa = 0, and its multiplier is unknown instead
         if (gearbox%contacts(i)%leads) row = merge(unknown, row, unknown == gearbox%contacts(i)%i_dependent)
      end do
      speed = unknown + 1
      do i = 1, size(gearbox%wheels)
         associate (support => gearbox%wheels(i)%support)
            unknown = [unknown, support%i_state(:support%n)]
            row = [row, support%i_state(:support%n) + 1]
            speed = [speed, support%i_state(:support%n) + 1]
         end associate
      end do
      unknown = [unknown, gearbox%contacts(indices(gearbox%contacts%leads))%i_normal]
      row = [row, gearbox%contacts(indices(gearbox%contacts%leads))%i_normal]
      speed = [speed, (0, i=1, count(gearbox%contacts%leads))]
      allocate (system%speed, source=speed)
      allocate (system%slopes(size(speed)), source=0.0_wp)
      if (speed_is_unknown) then
         unknown = [unknown, i_omega]
         row = [row, i_omega]
      end if
      if (gearbox%housing%is_mounted) then
         ! rotations of the pose use the indices of Omega, which is 0
         unknown = [unknown, (gearbox%housing%i_state + at_position + i, i=0, 2), (gearbox%housing%i_state + at_omega + i, i=0, 2)]
         row = [row, (gearbox%housing%i_state + at_velocity + i, i=0, 5)]
      end if
      allocate (system%unknown, source=unknown)
      allocate (system%row, source=row)
      if (constraint%wheel == 0) return
      system%i_anchor = gearbox%wheels(constraint%wheel)%i_psi
      system%anchor_ratio = gearbox%wheels(constraint%wheel)%ratio
      system%target = constraint%angle
   end subroutine list_unknowns

   !> Consistent positions, speeds and modes, from nearby ones: modes depend on positions and speeds, and these on the modes. If
   !> alternating between them does not converge, the flow to the equilibrium is integrated, with the modes updated in every step.
   subroutine settle_steady(gearbox, system, state, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(steady_system), intent(in) :: system
      type(status_t), intent(inout) :: status
      type(status_t) :: refusal
      type(gearbox_state) :: begin
      logical :: found

      begin = state
      call alternate(gearbox, system, state, found, refusal)
      if (found) return
      if (.not. any(gearbox%contacts%rigid)) then
         state = begin
         call relax(gearbox, system, state, found)
         if (found) return
      end if
      status = refusal
      if (.not. has_failed(status)) call refuse_slope(gearbox, state, status)
   end subroutine settle_steady

   !> Newton's method in the modes of the last solution, repeated until the modes do not change.
   subroutine alternate(gearbox, system, state, found, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(steady_system), intent(in) :: system
      logical, intent(out) :: found
      type(status_t), intent(inout) :: status !! the cause, if known
      integer :: before(gearbox%n_integers), turn
      type(status_t) :: refusal
      logical :: solved

      found = .false.
      solved = .false.
      do turn = 1, max_modes
         before = state%integers
         call load_all(gearbox, state, status)
         if (has_failed(status)) exit
         found = solved .and. all(state%integers == before)
         if (found) return
         call solve_steady(gearbox, system, state, solved, status)
         if (status%code == code_out_of_domain) then ! for example if a soft shaft twists beyond the range of these pairs
            if (.not. has_failed(refusal)) refusal = status
            call clear(status)
         else if (has_failed(status)) then
            return
         else if (.not. solved) then
            exit
         end if
      end do
      if (.not. solved .and. has_failed(refusal)) status = refusal
      if (has_failed(status)) return
      if (solved) call refuse_alternation(gearbox, before, state%integers, status)
   end subroutine alternate

   !> Integrate the flow q' = a(q) to its fixed point, then finish with Newton's method.
   subroutine relax(gearbox, system, state, found)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(steady_system), intent(in) :: system
      logical, intent(out) :: found
      type(status_t) :: status
      type(gearbox_state) :: before
      real(wp) :: rate, force, distance, last
      integer :: step

      found = .false.
      rate = 0
      last = huge(last)
      do step = 1, max_relaxed
         before = state
         call load_all(gearbox, state, status)
         if (.not. has_failed(status)) call relax_steady(gearbox, system, state, rate, force, distance, status)
         if (has_failed(status)) then
            if (.not. rate > 0) return
            call clear(status)
            state = before
            rate = slower*rate
            cycle
         end if
         if (distance < relaxed) then
            call load_all(gearbox, state, status)
            if (.not. has_failed(status)) call solve_steady(gearbox, system, state, found, status)
            before = state
            if (found .and. .not. has_failed(status)) call load_all(gearbox, state, status)
            found = found .and. .not. has_failed(status)
            if (found) found = all(state%integers == before%integers)
            if (found) return
            call clear(status)
         end if
         rate = merge(faster, slower, force <= last)*rate
         last = force
      end do
   end subroutine relax

end module evl_steady_state
