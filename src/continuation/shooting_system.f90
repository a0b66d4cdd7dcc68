!> Linear system of a Newton iteration for a periodic orbit, and its solutions: changes, and tangents of a branch.
!>
!> With the flow P and its derivative D it is
!>
!>     | D - 1      f(end)   dP/dp |        | P(y) - y - advance |
!>     | f(start)   0        0     | du = - | 0                  |
!>     |        tangent            |        | 0                  |
!>
!> The second row is the phase condition of an autonomous system: the change is orthogonal to the flow. The last row makes the
!> change orthogonal to the branch (pseudo-arclength). Without one of these rows, or if a state need not repeat, the unknown
!> is not changed. dP/dp is a difference of flows: a parameter may change all of a system. It, and a derivative that is only
!> predicted, are updated by the residual after a change.
!>
!> Sources: R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed., 7.1, 7.5; H. B. Keller, in: Applications of
!> Bifurcation Theory, Academic Press 1977 (pseudo-arclength); T. S. Parker, L. O. Chua, Practical Numerical Algorithms, 5.
module evl_shooting_system
   use evl_flow, only: flow_t, follow
   use evl_kinds, only: wp
   use evl_lapack, only: dgesv
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: closure_defect, compare_ends, orbit_options, orbit_t
   use evl_status, only: clear, code_no_solution, code_singular, fail, has_failed, status_t
   implicit none (type, external)
   private

   public :: change_of, differentiate_by_parameter, find_phase_row, find_tangent, learn_by_parameter, learn_from_change, &
             solve_along, solve_system, right_hand_side

contains

   !> Change by one iteration, at constant parameter, of an orbit that was integrated over one round: its flow has an end, a
   !> rate, and an approximate derivative.
   subroutine change_of(model, options, orbit, change, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit     !! its `active` and `residual` are set
      real(wp), intent(out) :: change(:)        !! [n + 2] in units of the scales
      type(status_t), intent(inout) :: status
      real(wp) :: phase_row(model%n)

      call compare_ends(model, orbit)
      phase_row = 0
      if (model%autonomous) call find_phase_row(model, orbit, phase_row, status)
      if (has_failed(status)) return
      change = right_hand_side(model, orbit)
      call solve_system(model, options, orbit, phase_row, x=change, status=status)
   end subroutine change_of

   !> Tangent of the branch at a converged orbit.
   subroutine find_tangent(model, options, orbit, along, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit !! its `tangent` and `by_parameter` are set
      real(wp), intent(in) :: along(:)      !! [n + 2] it points in the same direction as this
      type(status_t), intent(inout) :: status
      integer :: i

      call differentiate_by_parameter(model, options, orbit, status)
      if (has_failed(status)) return
      orbit%tangent = [(0.0_wp, i=0, model%n), 1.0_wp]
      call solve_along(model, options, orbit, along, orbit%tangent, status)
      if (.not. has_failed(status)) orbit%tangent = orbit%tangent/norm2(orbit%tangent)
   end subroutine find_tangent

   !> Solve the linear system above for an orbit with known dP/dp, a last row and a right-hand side.
   subroutine solve_along(model, options, orbit, along, x, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit
      real(wp), intent(in) :: along(:)    !! [n + 2] the last row
      real(wp), intent(inout) :: x(:)     !! [n + 2] in: right-hand side; out: solution, in units of the scales
      type(status_t), intent(inout) :: status
      real(wp) :: phase_row(model%n)

      phase_row = 0
      if (model%autonomous) call find_phase_row(model, orbit, phase_row, status)
      if (.not. has_failed(status)) call solve_system(model, options, orbit, phase_row, along, x, status)
   end subroutine solve_along

   !> Direction of the flow at the start.
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
         call fail(status, code_no_solution, "the speed at the start is zero: no orbit passes through it")
      end if
   end subroutine find_phase_row

   !> Matrix of the system above, in units of the scales; the period in units of itself. Equation O5.
   pure subroutine linearise(model, options, orbit, phase_row, tangent, matrix)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit
      real(wp), intent(in) :: phase_row(:)
      real(wp), intent(in), optional :: tangent(:) !! [n + 2] the last row; else the parameter is constant
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

   !> Right-hand side of the system above: minus the residual of the state. Equation O5.
   pure function right_hand_side(model, orbit) result(x)
      class(orbit_model), intent(in) :: model
      type(orbit_t), intent(in) :: orbit
      real(wp) :: x(model%n + 2) !! in units of the scales

      x = 0
      x(:model%n) = merge(-closure_defect(model, orbit)/model%scale, 0.0_wp, orbit%active)
   end function right_hand_side

   !> Solve the system for one right-hand side.
   subroutine solve_system(model, options, orbit, phase_row, tangent, x, status)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit
      real(wp), intent(in) :: phase_row(:)         !! [n] of an autonomous system
      real(wp), intent(in), optional :: tangent(:) !! [n + 2] the last row; else the parameter is constant
      real(wp), intent(inout) :: x(:)              !! [n + 2] in: right-hand side; out: solution, in units of the scales
      type(status_t), intent(inout) :: status
      real(wp) :: matrix(model%n + 2, model%n + 2)
      integer :: pivots(size(x)), info

      call linearise(model, options, orbit, phase_row, tangent, matrix)
      call dgesv(size(x), 1, matrix, size(x), pivots, x, size(x), info)
      if (info /= 0 .or. .not. all(abs(x) <= huge(1.0_wp))) &
         call fail(status, code_singular, "Newton's iteration for an orbit has no solution: orbits are not isolated here")
   end subroutine solve_system

   !> dP/dp of an orbit that was integrated over one round, by a one-sided difference. The other side is used if there is no
   !> such system, or if root functions do not fire there as in the orbit: P may have a corner, or a square root near one.
   !> Shorter differences follow.
   subroutine differentiate_by_parameter(model, options, orbit, status)
      class(orbit_model), intent(inout) :: model !! has another value of the parameter on return
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit
      type(status_t), intent(inout) :: status
      real(wp), parameter :: over(6) = [1.0_wp, -1.0_wp, 0.03_wp, -0.03_wp, 0.001_wp, -0.001_wp]
      real(wp), parameter :: alike = 0.1_wp !! of the square of the rate at which a root function fires
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

   !> Update the derivative, and the dP/dp, with which a change was computed by the residual after it (C. G. Broyden,
   !> Mathematics of Computation 19 (1965) 577-593).
   pure subroutine learn_from_change(model, options, change, after)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      real(wp), intent(in) :: change(:)     !! [n + 2] that change, in units of the scales
      type(orbit_t), intent(inout) :: after !! its flow has an end, and the derivative used for the change
      real(wp) :: left(model%n), size_of
      integer :: j

      associate (n => model%n)
         size_of = dot_product(change(:n), change(:n)) + change(n + 2)**2
         if (.not. size_of > 0) return
         left = merge(closure_defect(model, after), 0.0_wp, after%active)/size_of
         do j = 1, n
            after%flow%derivative(:, j) = after%flow%derivative(:, j) + left*(change(j)/model%scale(j))
         end do
         if (allocated(after%by_parameter)) after%by_parameter = after%by_parameter + left*(change(n + 2)/options%parameter_scale)
      end associate
   end subroutine learn_from_change

   !> Update dP/dp, the only inexact part of a Newton step, by the residual after the step (secant).
   pure subroutine learn_by_parameter(model, options, before, change, share, after)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: before
      real(wp), intent(in) :: change(:) !! [n + 2] from `before` to `after`
      real(wp), intent(in) :: share     !! of the step that was taken
      type(orbit_t), intent(inout) :: after
      real(wp), parameter :: least = 0.01_wp !! share of the parameter in the change
      real(wp) :: by

      by = change(model%n + 2)
      if (.not. abs(by) > least*norm2(change)) return
      after%by_parameter = after%by_parameter + merge(closure_defect(model, after) - (1 - share)*closure_defect(model, before), &
                                                      0.0_wp, after%active)/(by*options%parameter_scale)
   end subroutine learn_by_parameter

end module evl_shooting_system
