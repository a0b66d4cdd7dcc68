!> Steady start: slow modes have the mean of the quasi-static path, fast modes follow it.
!>
!> Source: docs/theory/theory.md, section 9.
module evl_steady_start
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_common_period, only: whole_pitches
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_scaling, only: gearbox_state_scales
   use evl_housing, only: at_orientation, housing_renormalise, small_turns
   use evl_indices, only: indices
   use evl_kinds, only: pi, wp
   use evl_local_variables, only: i_omega, i_theta
   use evl_modes, only: free_states, hold_driving_wheel, still_matrix
   use evl_start_positions, only: gearbox_state
   use evl_status, only: clear, has_failed, status_t
   use evl_steady_newton, only: find_slopes, follow, steady_residual, steady_system
   use evl_steady_position, only: angle_constraint, constraint_at, default_position, first_mesh
   use evl_steady_split, only: retain_fast_modes
   use evl_steady_state, only: equilibrium_models, find_balance, find_models, find_steady_state, list_unknowns, settle_steady
   implicit none (type, external)
   private

   public :: find_equilibrium, find_steady_start

   integer, parameter :: sample_numbers(5) = [61, 31, 17, 11, 7] !! numbers of positions of the path; primes
   integer, parameter :: sample_sizes(5) = [24, 48, 96, 192, huge(1)] !! maximum number of states for each of them
   integer, parameter :: other_positions = 8            !! positions per pitch, tried if the default one has no equilibrium
   integer, parameter :: most_passes = 8                !! maximum number of corrections of the mean speed
   real(wp), parameter :: agreement = 1.0e-14_wp        !! relative correction of the speed at convergence
   real(wp), parameter :: speed_step = 1.0e-4_wp        !! relative change of the speed for the derivative of the mean acceleration

   !> States of the quasi-static path over the common period.
   type :: path_t
      real(wp), allocatable :: positions(:)             !! of the first mesh [pitches]
      type(gearbox_state), allocatable :: states(:)
      logical, allocatable :: found(:)                  !! whether an equilibrium was found
      real(wp) :: acceleration = 0.0_wp                 !! mean of omega' [rad/s^2]
   end type path_t

contains

   !> Equilibrium at a position of the first mesh: no acceleration. Errors: code_no_solution, code_out_of_domain.
   subroutine find_equilibrium(gearbox, position, state, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      real(wp), intent(in), optional :: position !! [pitches]; absent: a position within a zone
      type(status_t), intent(inout) :: status
      type(equilibrium_models) :: models
      type(angle_constraint) :: constraint
      real(wp) :: x

      call find_start(gearbox, position, state, models, x, constraint, status)
   end subroutine find_equilibrium

   !> Steady start at a position of the first mesh. Errors: code_no_solution, code_out_of_domain.
   subroutine find_steady_start(gearbox, position, state, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      real(wp), intent(in), optional :: position !! [pitches]; absent: a position within a zone
      type(status_t), intent(inout) :: status
      type(equilibrium_models) :: models
      type(angle_constraint) :: constraint
      type(path_t) :: path
      real(wp) :: x

      call find_start(gearbox, position, state, models, x, constraint, status)
      if (has_failed(status) .or. any(gearbox%contacts%rigid)) return
      call find_path(gearbox, models, x, constraint, state, path)
      if (2*count(path%found) <= size(path%found)) return
      call split(gearbox, models, constraint, path, state, status)
   end subroutine find_steady_start

   !> Equilibrium at the start position, with the speed of the balance there.
   subroutine find_start(gearbox, preset, state, models, position, constraint, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      real(wp), intent(in), optional :: preset  !! position [pitches]; absent: one within a zone
      type(equilibrium_models), intent(out) :: models
      real(wp), intent(out) :: position        !! of the start [pitches]
      type(angle_constraint), intent(out) :: constraint
      type(status_t), intent(inout) :: status
      type(status_t) :: refusal
      type(gearbox_state) :: begin
      real(wp) :: better
      integer :: k

      call find_models(gearbox, models)
      position = default_position(gearbox)
      if (present(preset)) position = preset
      begin = state
      call find_there()
      if (present(preset)) return
      refusal = status
      do k = 1, other_positions ! if no equilibrium exists at the default position
         if (.not. has_failed(status)) exit
         call clear(status)
         position = (k - 0.5_wp)/other_positions
         call find_there()
      end do
      if (has_failed(status)) status = refusal
      if (has_failed(status)) return
      better = default_position(gearbox, state%y)
      if (has_failed(refusal) .or. .not. abs(better - position) > 0) return
      position = better
      call find_there()

   contains

      subroutine find_there()

         constraint = constraint_at(gearbox, position)
         state = begin
         state%y(i_theta) = constraint%angle
         call find_steady_state(gearbox, models, constraint, state, status)
      end subroutine find_there

   end subroutine find_start

   !> Static equilibria over the common period, at the speed with zero mean acceleration. `state` is the initial guess, and gets
   !> this speed. Equation T62.
   subroutine find_path(gearbox, models, position, constraint, state, path)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(equilibrium_models), intent(in) :: models
      real(wp), intent(in) :: position !! of the start [pitches]
      type(angle_constraint), intent(in) :: constraint
      type(path_t), intent(out) :: path
      real(wp) :: slope, speed, last_speed, last_acceleration, change
      integer(int64) :: pitches
      integer :: k, n, pass

      pitches = whole_pitches(gearbox, first_mesh(gearbox))
      n = sample_numbers(findloc(gearbox%n_states <= sample_sizes, .true., dim=1))
      if (modulo(pitches, int(n, int64)) == 0) n = n - 2
      path%positions = aint(position) + [((k - 0.5_wp)/n*real(pitches, wp), k=1, n)]
      allocate (path%states(n))
      allocate (path%found(n), source=.false.)
      speed = state%y(i_omega)
      call walk(models, speed, state, path)
      if (gearbox%wheels(gearbox%reference)%prescribed > 0 .or. .not. any(path%found)) return
      slope = speed_slope(models, constraint, state)
      do pass = 1, most_passes
         if (.not. slope < 0) exit
         change = -path%acceleration/slope
         if (abs(change) <= agreement*abs(speed)) exit
         last_speed = speed
         last_acceleration = path%acceleration
         speed = speed + change
         call walk(models, speed, state, path)
         if (abs(speed - last_speed) > 1.0e-8_wp*abs(speed)) slope = (path%acceleration - last_acceleration)/(speed - last_speed)
      end do
      state%y(i_omega) = speed
   end subroutine find_path

   !> Compute all equilibria of the path at a speed, each from the previous one, or from its own at another speed. Equation T62.
   subroutine walk(models, speed, guess, path)
      type(equilibrium_models), intent(in) :: models
      real(wp), intent(in) :: speed
      type(gearbox_state), intent(in) :: guess
      type(path_t), intent(inout) :: path
      type(steady_system) :: system
      type(angle_constraint) :: there
      type(status_t) :: status
      type(gearbox_state) :: state
      integer :: k

      state = guess
      path%acceleration = 0
      do k = 1, size(path%positions)
         if (path%found(k)) state = path%states(k)
         there = constraint_at(models%static, path%positions(k))
         call list_unknowns(models%static, there, .false., system)
         state%y(i_theta) = there%angle
         state%y(i_omega) = speed
         call follow(system, state%y)
         call clear(status)
         call settle_steady(models%static, system, state, status)
         path%found(k) = .not. has_failed(status)
         if (.not. path%found(k)) then
            state = guess
            cycle
         end if
         path%states(k) = state
         path%acceleration = path%acceleration + acceleration(models%static, state)
      end do
      path%acceleration = path%acceleration/max(count(path%found), 1)
   end subroutine walk

   !> Acceleration of the reference wheel with all deviations in equilibrium [rad/s^2].
   real(wp) function acceleration(gearbox, state)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(in) :: state
      real(wp) :: residual(gearbox%n_states)
      type(status_t) :: status

      call steady_residual(gearbox, state, residual, status)
      acceleration = merge(0.0_wp, -residual(i_omega), has_failed(status))
   end function acceleration

   !> Derivative of the acceleration with respect to the speed at the start position [1/s]; 0 if unknown.
   real(wp) function speed_slope(models, constraint, start) result(slope)
      type(equilibrium_models), intent(in) :: models
      type(angle_constraint), intent(in) :: constraint
      type(gearbox_state), intent(in) :: start
      type(steady_system) :: system
      type(status_t) :: status
      type(gearbox_state) :: state
      real(wp) :: at(2)
      integer :: i

      slope = 0
      call list_unknowns(models%static, constraint, .false., system)
      do i = 1, 2
         state = start
         state%y(i_omega) = start%y(i_omega)*(1 + (i - 1)*speed_step)
         call settle_steady(models%static, system, state, status)
         if (has_failed(status)) return
         at(i) = acceleration(models%static, state)
      end do
      if (abs(start%y(i_omega)) > 0) slope = (at(2) - at(1))/(speed_step*start%y(i_omega))
   end function speed_slope

   !> From the equilibrium to the steady start: slow modes get the mean of the path, fast modes the local equilibrium and its
   !> slopes. Equation T64.
   subroutine split(gearbox, models, constraint, path, state, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(equilibrium_models), intent(in) :: models
      type(angle_constraint), intent(in) :: constraint
      type(path_t), intent(in) :: path
      type(status_t), intent(inout) :: status
      integer, allocatable :: speeds(:), positions(:)
      real(wp), allocatable :: vectors(:, :), mean(:), stiffness(:, :), damping(:, :)
      real(wp) :: matrix(gearbox%n_states, gearbox%n_states), slopes(gearbox%n_states), y_start(gearbox%n_states), mean_speed
      type(steady_system) :: system
      type(status_t) :: refusal
      integer :: k, n

      call list_unknowns(gearbox, constraint, .false., system)
      call settle_steady(models%static, system, state, status)
      if (.not. has_failed(status)) call find_slopes(models%smooth, system, state, status)
      if (has_failed(status)) return
      mean_speed = state%y(i_omega)
      slopes = 0
      slopes(system%unknown(:size(system%slopes))) = system%slopes
      state%y(i_omega) = mean_speed/(1 + whole_turn(gearbox, slopes))
      call find_balance(models, system, state, status)
      if (has_failed(status)) return
      y_start = state%y
      call free_states(gearbox, speeds, positions)
      speeds = speeds(indices(speeds /= i_omega))
      n = size(positions)
      allocate (vectors(n, 2), mean(n), stiffness(n, n), damping(n, n))
      mean = 0
      stiffness = 0
      do k = 1, size(path%found)
         if (.not. path%found(k)) cycle
         mean = mean + coordinates(gearbox, positions, path%states(k)%y, y_start)
         associate (there => path%states(k))
            call still_matrix(models%smooth, there%t, there%y, there%integers, there%reals, matrix, refusal)
         end associate
         if (has_failed(refusal)) return
         call hold_anchor(gearbox, system, matrix)
         stiffness = stiffness + matrix(speeds, positions)
      end do
      mean = mean/count(path%found)
      stiffness = stiffness/count(path%found)
      call still_matrix(models%whole, state%t, y_start, state%integers, state%reals, matrix, refusal)
      if (has_failed(refusal)) return
      call hold_anchor(gearbox, system, matrix)
      damping = matrix(speeds, speeds)
      vectors(:, 1) = coordinates(gearbox, positions, y_start, y_start) - mean
      vectors(:, 2) = slopes(positions)/(1 + whole_turn(gearbox, slopes))
      call scale_and_retain(gearbox, positions, stiffness, damping, mesh_frequency(gearbox, mean_speed), vectors)
      slopes = 0
      slopes(positions) = vectors(:, 2)
      state%y(i_omega) = mean_speed*(1 - whole_turn(gearbox, slopes))
      state%y(speeds) = vectors(:, 2)*mean_speed
      call put(gearbox, system, positions, mean + vectors(:, 1), state%y)
   end subroutine split

   !> Derivatives at constant angle and speed of the driving wheel of the first mesh.
   pure subroutine hold_anchor(gearbox, system, matrix)
      type(gearbox_t), intent(in) :: gearbox
      type(steady_system), intent(in) :: system
      real(wp), intent(inout) :: matrix(:, :) !! from `still_matrix`

      call hold_driving_wheel(gearbox, matrix)
      associate (anchor => system%i_anchor)
         if (anchor == 0 .or. gearbox%wheels(gearbox%reference)%prescribed > 0) return
         matrix(:, anchor + 1) = matrix(:, anchor + 1) - matrix(:, i_omega)/system%anchor_ratio
      end associate
   end subroutine hold_anchor

   !> Retain the fast modes of vectors, in units of the scales of the positions.
   subroutine scale_and_retain(gearbox, positions, stiffness, damping, frequency, vectors)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: positions(:)
      real(wp), intent(inout) :: stiffness(:, :), damping(:, :), vectors(:, :)
      real(wp), intent(in) :: frequency
      real(wp), dimension(gearbox%n_states) :: scale, row_scale
      real(wp) :: unit(size(positions)), scaled(size(vectors, 1), size(vectors, 2))
      integer :: i

      call gearbox_state_scales(gearbox, [real(wp) ::], scale, row_scale)
      unit = scale(positions)
      do i = 1, size(unit)
         stiffness(:, i) = stiffness(:, i)*unit(i)/unit
         damping(:, i) = damping(:, i)*unit(i)/unit
      end do
      do i = 1, size(vectors, 2)
         scaled(:, i) = vectors(:, i)/unit
      end do
      call retain_fast_modes(stiffness, damping, frequency, scaled)
      do i = 1, size(vectors, 2)
         vectors(:, i) = scaled(:, i)*unit
      end do
   end subroutine scale_and_retain

   !> Highest mesh frequency [rad/s].
   pure real(wp) function mesh_frequency(gearbox, speed) result(frequency)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: speed !! of the reference wheel [rad/s]

      associate (contact => gearbox%contacts(gearbox%first(first_mesh(gearbox))))
         frequency = 2*pi*abs(contact%pair%advance/contact%base_pitch*speed)
      end associate
   end function mesh_frequency

   !> Position coordinates of a state; the orientation of a housing as small rotations from that of a reference state.
   function coordinates(gearbox, positions, y, y_reference) result(values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: positions(:)
      real(wp), intent(in) :: y(:), y_reference(:)
      real(wp) :: values(size(positions))
      integer :: p, n

      values = y(positions)
      if (.not. gearbox%housing%is_mounted) return
      p = gearbox%housing%i_state + at_orientation
      n = size(positions)
      values(n - 2:) = 4*matmul(y(p:p + 3) - y_reference(p:p + 3), small_turns(y_reference(p:p + 3)))
   end function coordinates

   !> Part of slopes along theta that rotates the whole gearbox: sum of J_i g_i psi_i over sum of J_i g_i^2; 0 if a speed is
   !> prescribed. The inertias rotate with the mean speed, so this part is subtracted from the speed of the reference wheel.
   pure real(wp) function whole_turn(gearbox, slopes) result(part)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: slopes(:) !! of the states
      real(wp) :: turned, inertia
      integer :: i

      part = 0
      if (gearbox%wheels(gearbox%reference)%prescribed > 0) return
      turned = 0
      inertia = 0
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%leader /= i) cycle
            inertia = inertia + wheel%rotor_inertia*wheel%ratio**2
            if (wheel%i_psi > 0) turned = turned + wheel%rotor_inertia*wheel%ratio*slopes(wheel%i_psi)
         end associate
      end do
      part = turned/inertia
   end function whole_turn

   !> Set the positions in the state. The angle of the driving wheel of the first mesh is unchanged.
   subroutine put(gearbox, system, positions, values, y)
      type(gearbox_t), intent(in) :: gearbox
      type(steady_system), intent(in) :: system
      integer, intent(in) :: positions(:)
      real(wp), intent(in) :: values(:)
      real(wp), intent(inout) :: y(:) !! input: the equilibrium at the start position
      integer :: n, p

      n = size(positions)
      if (gearbox%housing%is_mounted) then
         p = gearbox%housing%i_state + at_orientation
         y(p:p + 3) = y(p:p + 3) + matmul(small_turns(y(p:p + 3)), values(n - 2:))
         y(positions(:n - 3)) = values(:n - 3)
         call housing_renormalise(gearbox%housing, y)
      else
         y(positions) = values
      end if
      if (system%i_anchor > 0) y(i_theta) = system%target - y(system%i_anchor)/system%anchor_ratio
   end subroutine put

end module evl_steady_start
