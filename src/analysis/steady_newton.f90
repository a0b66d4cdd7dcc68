!> Newton's method for the steady state: positions without acceleration, with speeds that follow from the slopes of the flanks.
!>
!> With q the positions that the contacts determine (psi of the rotors, s of the supports, multipliers of rigid contacts), the
!> static equilibrium a(theta, omega, q) = 0 varies along theta by
!>
!>    da/dtheta + da/dq dq/dtheta = 0
!>
!> and the speeds are q' = omega dq/dtheta.
!>
!> If the angle of the driving wheel of a mesh is given, theta follows from its deviation: theta = target - psi/g.
!>
!> Source: docs/theory/theory.md, section 9.
module evl_steady_newton
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use evl_dae_jacobian, only: gearbox_jacobian
   use evl_dae_residual, only: gearbox_residual
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_scaling, only: gearbox_state_scales
   use evl_housing, only: housing_take_turn, housing_turn_columns
   use evl_kinds, only: wp
   use evl_lapack, only: dgesv
   use evl_local_variables, only: i_omega, i_theta
   use evl_start_positions, only: gearbox_state
   use evl_status, only: clear, code_no_solution, fail, has_failed, status_t, subject_initial
   implicit none (type, external)
   private

   public :: find_slopes, follow, relax_steady, solve_steady, steady_residual, steady_system

   integer, parameter :: max_newton = 60               !! maximum number of corrections; a start from rest needs about five
   real(wp), parameter :: newton_tolerance = 1.0e-13_wp !! last correction, relative to the scales of the states
   real(wp), parameter :: few = 16      !! rounding errors of a sum of forces, in units of epsilon

   !> Unknowns and equations.
   type :: steady_system
      integer, allocatable :: unknown(:)   !! state indices; those of q come first
      integer, allocatable :: row(:)       !! equations to be satisfied, of the same number
      integer, allocatable :: speed(:)     !! state index of the rate of each q; 0 if none
      real(wp), allocatable :: slopes(:)   !! dq/dtheta
      integer :: i_anchor = 0              !! state index of psi of the wheel whose angle is given; 0: theta is given
      real(wp) :: anchor_ratio = 1.0_wp    !! g of that wheel
      real(wp) :: target = 0.0_wp          !! its angle over g [rad]
   end type steady_system

contains

   !> Solve F(row) = 0 for y(unknown) with q' = omega dq/dtheta. A correction is accepted if it reduces the scaled residual; if that
   !> does not converge, also if it reduces the next (simplified Newton) correction.
   !> Errors: code_no_solution, code_out_of_domain.
   subroutine solve_steady(gearbox, system, state, found, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(steady_system), intent(in) :: system
      logical, intent(out) :: found !! false: not converged
      type(status_t), intent(inout) :: status
      real(wp) :: begin(gearbox%n_states)

      begin = state%y
      call iterate(gearbox, system, state, .false., found, status)
      if (found .or. has_failed(status)) return
      state%y = begin
      call iterate(gearbox, system, state, .true., found, status)
   end subroutine solve_steady

   !> The same with one of the two criteria. Corrections that leave the domain or are not accepted are halved. If even tiny ones
   !> leave the domain, y is set to the full correction: beyond the border other modes may apply.
   subroutine iterate(gearbox, system, state, by_corrections, found, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(steady_system), intent(in) :: system
      logical, intent(in) :: by_corrections !! accept also those that reduce the next correction
      logical, intent(out) :: found         !! false: not converged
      type(status_t), intent(inout) :: status
      real(wp), dimension(gearbox%n_states) :: f, y, scale, row_scale
      real(wp), dimension(size(system%row), size(system%row)) :: matrix, before
      real(wp) :: step(size(system%row), 1), positions(size(system%row)), size_now, size_trial, share, last
      integer :: pivots(size(system%row)), info, turn

      found = .false.
      call gearbox_state_scales(gearbox, [real(wp) ::], scale, row_scale)
      last = huge(last)
      call follow(system, state%y)
      call steady_residual(gearbox, state, f, status)
      associate (row => system%row, unknown => system%unknown)
         do turn = 1, max_newton
            if (has_failed(status)) return
            size_now = norm2(f(row)/row_scale(row))
            call steady_matrix(gearbox, system, state, scale, row_scale, matrix, status)
            if (has_failed(status)) return
            before = matrix
            step(:, 1) = -f(row)/row_scale(row)
            call dgesv(size(row), 1, matrix, size(row), pivots, step, size(row), info)
            if (info /= 0 .or. .not. all(ieee_is_finite(step))) then
               call undetermined(gearbox, status)
               return
            end if
            y = state%y
            share = 1
            do
               state%y = y
               state%y(unknown) = y(unknown) + share*step(:, 1)*scale(unknown)
               if (gearbox%housing%is_mounted) call housing_take_turn(gearbox%housing, state%y)
               call follow(system, state%y)
               call clear(status)
               call steady_residual(gearbox, state, f, status)
               size_trial = norm2(f(row)/row_scale(row))
               if (.not. has_failed(status)) then
                  if (size_trial < size_now .or. norm2(step) < 1.0e-6_wp) exit
                  if (by_corrections) then
                     if (norm2(corrections(before, f(row)/row_scale(row))) < norm2(step)) exit
                  end if
               end if
               share = share/2
               if (share < 1.0e-6_wp) exit
            end do
            if (has_failed(status)) then
               state%y = y
               state%y(unknown) = y(unknown) + step(:, 1)*scale(unknown)
               if (gearbox%housing%is_mounted) call housing_take_turn(gearbox%housing, state%y)
               call follow(system, state%y)
               return
            end if
            found = norm2(step) < newton_tolerance
            if (.not. found .and. norm2(step) >= last) then
               positions = merge(state%y(unknown)/scale(unknown), 0.0_wp, unknown /= i_omega)
               found = norm2(step) < at_rounding(positions) .or. (abs(state%y(i_omega)) <= scale(i_omega) .and. &
                                                                  is_balanced(before, positions, f(row)/row_scale(row)))
            end if
            if (found) return
            last = norm2(step)
         end do
      end associate
   end subroutine iterate

   !> Simplified Newton correction for a residual, in units of the scales of the states. Unlike the residual it does not depend on
   !> the scales of rows: for a very small speed the residual grows with the square of a correction.
   function corrections(matrix, residual) result(step)
      real(wp), intent(in) :: matrix(:, :), residual(:)
      real(wp) :: step(size(residual)), factors(size(residual), size(residual)), column(size(residual), 1)
      integer :: pivots(size(residual)), info

      factors = matrix
      column(:, 1) = -residual
      call dgesv(size(residual), 1, factors, size(residual), pivots, column, size(residual), info)
      step = column(:, 1)
      if (info /= 0) step = sqrt(huge(1.0_wp))/size(step)
   end function corrections

   !> Limit below which corrections that no longer decrease are rounding error. With heavy axles and little load, one digit of a
   !> position exceeds 1e-9 of the penetration. The speed is excluded: relative to a runaway speed, any correction would count as
   !> rounding.
   pure real(wp) function at_rounding(x) result(least)
      real(wp), intent(in) :: x(:) !! unknown positions, in units of their scales

      least = max(1.0e-9_wp, few*epsilon(x)*norm2(x))
   end function at_rounding

   !> Whether the residual of every sum of forces is rounding error of its terms. Then the correction is rounding error too, however
   !> large: friction of small balanced torques determines a speed that is negligible compared with the speed that the torques would
   !> produce in a second. Not applicable to a speed that has run away beyond the latter.
   pure logical function is_balanced(matrix, x, residual)
      real(wp), intent(in) :: matrix(:, :), x(:), residual(:) !! of Newton's method; x as in at_rounding
      integer :: i

      is_balanced = .false.
      do i = 1, size(residual)
         if (.not. abs(residual(i)) <= few*epsilon(x)*dot_product(abs(matrix(i, :)), abs(x))) return
      end do
      is_balanced = .true.
   end function is_balanced

   !> One implicit Euler step of the flow q' = a(q), whose fixed point is the equilibrium: (rate + M) dq = a, in units of the
   !> scales.
   !> Errors: code_no_solution, code_out_of_domain.
   subroutine relax_steady(gearbox, system, state, rate, force, distance, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(steady_system), intent(in) :: system
      real(wp), intent(inout) :: rate    !! inverse of the step size; 0: use the largest diagonal element of M [1/s]
      real(wp), intent(out) :: force     !! norm of a before the step, in units of the scales
      real(wp), intent(out) :: distance  !! length of the step, in units of the scales
      type(status_t), intent(inout) :: status
      real(wp), dimension(gearbox%n_states) :: f, scale, row_scale
      real(wp) :: matrix(size(system%row), size(system%row)), step(size(system%row), 1)
      integer :: pivots(size(system%row)), info, i

      force = huge(force)
      distance = huge(distance)
      call gearbox_state_scales(gearbox, [real(wp) ::], scale, row_scale)
      call follow(system, state%y)
      call steady_residual(gearbox, state, f, status)
      if (.not. has_failed(status)) call steady_matrix(gearbox, system, state, scale, row_scale, matrix, status)
      if (has_failed(status)) return
      if (.not. rate > 0) rate = maxval([(abs(matrix(i, i)), i=1, size(system%row))])
      do i = 1, size(system%row)
         matrix(i, i) = matrix(i, i) + rate
      end do
      step(:, 1) = -f(system%row)/row_scale(system%row)
      force = norm2(step)
      call dgesv(size(step), 1, matrix, size(step), pivots, step, size(step), info)
      if (info /= 0 .or. .not. all(ieee_is_finite(step))) then
         call undetermined(gearbox, status)
         return
      end if
      distance = norm2(step)
      state%y(system%unknown) = state%y(system%unknown) + step(:, 1)*scale(system%unknown)
      if (gearbox%housing%is_mounted) call housing_take_turn(gearbox%housing, state%y)
      call follow(system, state%y)
   end subroutine relax_steady

   !> Slopes dq/dtheta of the equilibrium at y. Equation T63.
   subroutine find_slopes(gearbox, system, state, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(in) :: state
      type(steady_system), intent(inout) :: system
      type(status_t), intent(inout) :: status
      real(wp), dimension(gearbox%n_states) :: zero, scale, row_scale
      real(wp) :: jacobian(gearbox%n_states, gearbox%n_states)
      real(wp) :: matrix(size(system%speed), size(system%speed)), slopes(size(system%speed), 1)
      integer :: pivots(size(system%speed)), i, info

      zero = 0
      call gearbox_jacobian(gearbox, state%t, 0.0_wp, state%y, zero, state%integers, state%reals, jacobian, status)
      if (has_failed(status)) return
      call gearbox_state_scales(gearbox, [real(wp) ::], scale, row_scale)
      associate (n => size(system%speed))
         associate (row => system%row(:n), q => system%unknown(:n))
            do i = 1, n
               matrix(:, i) = jacobian(row, q(i))*scale(q(i))/row_scale(row)
            end do
            slopes(:, 1) = -jacobian(row, i_theta)/row_scale(row)
            call dgesv(n, 1, matrix, n, pivots, slopes, n, info)
            if (info /= 0 .or. .not. all(ieee_is_finite(slopes))) then
               call undetermined(gearbox, status)
               return
            end if
            system%slopes = slopes(:, 1)*scale(q)
         end associate
      end associate
   end subroutine find_slopes

   !> Set the speeds from omega, and theta from the given wheel angle.
   pure subroutine follow(system, y)
      type(steady_system), intent(in) :: system
      real(wp), intent(inout) :: y(:)
      integer :: i

      do i = 1, size(system%speed)
         if (system%speed(i) > 0) y(system%speed(i)) = system%slopes(i)*y(i_omega)
      end do
      if (system%i_anchor > 0) y(i_theta) = system%target - y(system%i_anchor)/system%anchor_ratio
   end subroutine follow

   !> Matrix of Newton's method in units of the scales.
   subroutine steady_matrix(gearbox, system, state, scale, row_scale, matrix, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(in) :: state
      type(steady_system), intent(in) :: system
      real(wp), intent(in) :: scale(:), row_scale(:)
      real(wp), intent(out) :: matrix(:, :)
      type(status_t), intent(inout) :: status
      real(wp) :: jacobian(gearbox%n_states, gearbox%n_states), zero(gearbox%n_states)
      integer :: i

      zero = 0
      call gearbox_jacobian(gearbox, state%t, 0.0_wp, state%y, zero, state%integers, state%reals, jacobian, status)
      if (has_failed(status)) return
      do i = 1, size(system%speed)
         if (system%speed(i) > 0) jacobian(:, i_omega) = jacobian(:, i_omega) + system%slopes(i)*jacobian(:, system%speed(i))
      end do
      associate (anchor => system%i_anchor)
         if (anchor > 0) jacobian(:, anchor) = jacobian(:, anchor) - jacobian(:, i_theta)/system%anchor_ratio
      end associate
      if (gearbox%housing%is_mounted) call housing_turn_columns(gearbox%housing, state%y, jacobian)
      associate (row => system%row, unknown => system%unknown)
         do i = 1, size(row)
            matrix(:, i) = jacobian(row, unknown(i))*scale(unknown(i))/row_scale(row)
         end do
      end associate
   end subroutine steady_matrix

   !> Residual at constant speeds.
   subroutine steady_residual(gearbox, state, residual, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(in) :: state
      real(wp), intent(out) :: residual(gearbox%n_states)
      type(status_t), intent(inout) :: status
      real(wp) :: yp(gearbox%n_states)

      yp = 0
      yp(i_theta) = state%y(i_omega)
      call gearbox_residual(gearbox, state%t, state%y, yp, state%integers, state%reals, residual, status)
   end subroutine steady_residual

   !> Report that the linear system of Newton's method is singular.
   subroutine undetermined(gearbox, status)
      type(gearbox_t), intent(in) :: gearbox
      type(status_t), intent(inout) :: status
      logical :: by_speed(size(gearbox%loads))
      integer :: i

      by_speed = [(gearbox%loads(i)%load%by_speed, i=1, size(gearbox%loads))]

      if (gearbox%housing%is_mounted) then
         call fail(status, code_no_solution, "the steady state is not determined: no load depends on the speed, and none is" &
                   //" prescribed; or the mount leaves the housing free to move", subject_initial, field="kind")
      else if (gearbox%wheels(gearbox%reference)%prescribed > 0 .or. any(by_speed)) then
         call fail(status, code_no_solution, "the steady state is not determined: no load presses the flanks of a mesh together," &
                   //" or a support holds its axle by no spring; start from rest or with given speeds", subject_initial, &
                   field="kind")
      else
         call fail(status, code_no_solution, "the steady speed is not determined: no load depends on the speed, and none is" &
                   //" prescribed", subject_initial, field="kind")
      end if
   end subroutine undetermined

end module evl_steady_newton
