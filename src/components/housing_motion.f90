!> Prescribed motion of the housing: six coordinates, each a sum of terms that are twice continuously differentiable in time.
module evl_housing_motion
   use evl_kinds, only: pi, wp
   use evl_parameter_view, only: parameter_view_t
   use evl_rotation, only: turn_from_vector
   use evl_row, only: not_negative, row_t, span_t, type_at_knots, type_choice, type_knots, type_number
   implicit none (type, external)
   private

   public :: motion_term, motion_curve, n_coordinates
   public :: motion_at, resolved_motion_time, motion_rows, motion_take
   public :: term_constant, term_harmonic

   integer, parameter :: term_constant = 0 !! value
   integer, parameter :: term_rate = 1     !! value t
   integer, parameter :: term_harmonic = 2 !! value sin(2 pi frequency t + phase)
   integer, parameter :: term_table = 3    !! natural cubic spline, linear outside the knots
   integer, parameter :: n_coordinates = 6 !! position x, y, z in the ground frame, then the rotation vector

   type :: motion_term
      integer :: coordinate = 0          !! index of the coordinate
      integer :: kind = term_constant    !! one of the kinds above
      real(wp) :: value = 0.0_wp         !! constant or amplitude [m or rad], or rate [m/s or rad/s]
      real(wp) :: frequency = 0.0_wp     !! [Hz]
      real(wp) :: phase = 0.0_wp         !! [rad]
      real(wp), allocatable :: time(:)   !! knots [s], strictly increasing; size 0 without a table
      real(wp), allocatable :: values(:) !! [m or rad] there
      real(wp), allocatable :: bend(:)   !! second derivatives there, from motion_prepare
   end type motion_term

   !> Position and motion of the housing.
   type :: motion_curve
      real(wp) :: position(3), velocity(3) !! r, v of the origin: ground [m], [m/s]
      real(wp) :: orientation(4)           !! p, unit quaternion
      real(wp) :: omega(3), alpha(3)       !! Omega, Omega' in the housing frame [rad/s], [rad/s^2]
   end type motion_curve

contains

   !> Parameters of a term: of a translation, or of a rotation.
   pure function motion_rows(unit, of, rate_unit, rate, most, rate_most) result(rows)
      character(len=*), intent(in) :: unit, of        !! of the coordinate
      character(len=*), intent(in) :: rate_unit, rate !! of its rate
      real(wp), intent(in) :: most, rate_most         !! largest plausible magnitudes of both
      type(row_t) :: rows(9)

      rows(1) = row_t("kind", type_choice, "", "value; value t; amplitude sin(2 pi frequency t + phase); a spline through knots", &
                      required=.true., words="constant rate harmonic table")
      rows(2) = row_t("axis", type_choice, "", "component of the term", required=.true., words="x y z")
      rows(3) = row_t("value", type_number, unit, of, required=.true., variants="constant", &
                      plausible=span_t(0.0_wp, most))
      rows(4) = row_t("value", type_number, rate_unit, rate, required=.true., variants="rate", &
                      plausible=span_t(0.0_wp, rate_most))
      rows(5) = row_t("amplitude", type_number, unit, "amplitude", required=.true., variants="harmonic", &
                      plausible=span_t(0.0_wp, most))
      rows(6) = row_t("frequency", type_number, "Hz", "frequency", range=not_negative, required=.true., variants="harmonic", &
                      plausible=span_t(1.0e-4_wp, 1.0e6_wp))
      rows(7) = row_t("phase", type_number, "deg", "phase at time 0", default="0", variants="harmonic", &
                      plausible=span_t(0.0_wp, 360.0_wp))
      rows(8) = row_t("time", type_knots, "s", "knots of the table, strictly increasing, at least two", required=.true., &
                      variants="table", plausible=span_t(0.0_wp, 1.0e5_wp))
      rows(9) = row_t("value", type_at_knots, unit, of//" at the knots; natural cubic spline, linear outside", &
                      required=.true., variants="table", plausible=span_t(0.0_wp, most))
   end function motion_rows

   !> Set a term from checked parameters.
   subroutine motion_take(input, first, term)
      type(parameter_view_t), intent(in) :: input
      integer, intent(in) :: first !! coordinate along or about x
      type(motion_term), intent(out) :: term

      term%coordinate = first + index("xyz", trim(input%word("axis"))) - 1
      select case (input%word("kind"))
      case ("constant")
         term%kind = term_constant
         term%value = input%number("value")
      case ("rate")
         term%kind = term_rate
         term%value = input%number("value")
      case ("harmonic")
         term%kind = term_harmonic
         term%value = input%number("amplitude")
         term%frequency = input%number("frequency")
         term%phase = input%number("phase")
      case default
         term%kind = term_table
         term%time = input%numbers("time")
         term%values = input%numbers("value")
         call motion_prepare(term)
      end select
   end subroutine motion_take

   !> Compute the second derivatives of a table's natural cubic spline: 0 at both ends.
   !>
   !> Source: continuity of the first derivative at the inner knots, a tridiagonal diagonally dominant system.
   pure subroutine motion_prepare(term)
      type(motion_term), intent(inout) :: term !! with at least two knots
      real(wp) :: diagonal(size(term%time)), slope(size(term%time) - 1), step(size(term%time) - 1), share
      integer :: i, n

      n = size(term%time)
      step = term%time(2:) - term%time(:n - 1)
      slope = (term%values(2:) - term%values(:n - 1))/step
      if (allocated(term%bend)) deallocate (term%bend)
      allocate (term%bend(n), source=0.0_wp)
      do i = 2, n - 1
         diagonal(i) = 2*(step(i - 1) + step(i))
         term%bend(i) = 6*(slope(i) - slope(i - 1))
         if (i == 2) cycle
         share = step(i - 1)/diagonal(i - 1)
         diagonal(i) = diagonal(i) - share*step(i - 1)
         term%bend(i) = term%bend(i) - share*term%bend(i - 1)
      end do
      do i = n - 1, 2, -1
         term%bend(i) = (term%bend(i) - step(i)*term%bend(i + 1))/diagonal(i)
      end do
   end subroutine motion_prepare

   !> Motion at time t.
   pure subroutine motion_at(terms, t, curve, acceleration)
      type(motion_term), intent(in) :: terms(:) !! of all coordinates, in any order
      real(wp), intent(in) :: t                 !! [s]
      type(motion_curve), intent(out) :: curve
      real(wp), intent(out) :: acceleration(3)  !! v' [m/s^2]
      real(wp) :: x(n_coordinates, 3) ! with first and second derivative
      integer :: i

      x = 0
      do i = 1, size(terms)
         x(terms(i)%coordinate, :) = x(terms(i)%coordinate, :) + term_at(terms(i), t)
      end do
      curve%position = x(1:3, 1)
      curve%velocity = x(1:3, 2)
      acceleration = x(1:3, 3)
      call turn_from_vector(x(4:6, 1), x(4:6, 2), x(4:6, 3), curve%orientation, curve%omega, curve%alpha)
   end subroutine motion_at

   !> A term with its first and second derivative.
   pure function term_at(term, t) result(value)
      type(motion_term), intent(in) :: term
      real(wp), intent(in) :: t
      real(wp) :: value(3), w, angle

      select case (term%kind)
      case (term_constant)
         value = [term%value, 0.0_wp, 0.0_wp]
      case (term_rate)
         value = [term%value*t, term%value, 0.0_wp]
      case (term_harmonic)
         w = 2*pi*term%frequency
         angle = w*t + term%phase
         value = term%value*[sin(angle), w*cos(angle), -w**2*sin(angle)]
      case default
         value = table_at(term, t)
      end select
   end function term_at

   !> Longest step from t that resolves the motion: a cycle of each term; in a table up to the next knot, or several knots
   !> further if these are as close.
   pure real(wp) function resolved_motion_time(terms, t) result(longest)
      type(motion_term), intent(in) :: terms(:)
      real(wp), intent(in) :: t !! [s]
      integer :: i

      longest = huge(t)
      do i = 1, size(terms)
         if (terms(i)%kind == term_table) then
            longest = min(longest, resolved_knot_time(terms(i)%time, t))
         else if (terms(i)%kind == term_harmonic .and. abs(terms(i)%value) > 0 .and. terms(i)%frequency > 0) then
            longest = min(longest, 1/terms(i)%frequency)
         else if (terms(i)%kind == term_rate .and. terms(i)%coordinate > n_coordinates/2 .and. abs(terms(i)%value) > 0) then
            longest = min(longest, 2*pi/abs(terms(i)%value))
         end if
      end do
   end function resolved_motion_time

   !> Time to the next knot, or to a later one within `most` times the shortest interval of the knots behind the next one.
   pure real(wp) function resolved_knot_time(time, t) result(longest)
      real(wp), intent(in) :: time(:), t
      real(wp), parameter :: most = 4.001_wp, here = 8*epsilon(t) !! here: tolerance, of the time, for knots reached
      real(wp) :: shortest
      integer :: i, next

      longest = huge(t)
      next = count(time <= t + here*abs(t)) + 1
      if (next > size(time)) return
      longest = time(next) - t
      shortest = huge(t)
      do i = next + 1, size(time)
         shortest = min(shortest, time(i) - time(i - 1))
         if (time(i) - t > most*shortest) return
         longest = time(i) - t
      end do
   end function resolved_knot_time

   !> A table's spline with its first and second derivative.
   pure function table_at(term, t) result(value)
      type(motion_term), intent(in) :: term
      real(wp), intent(in) :: t
      real(wp) :: value(3), h, a, b, inside
      integer :: i

      i = min(max(count(term%time <= t), 1), size(term%time) - 1)
      h = term%time(i + 1) - term%time(i)
      inside = min(max(t, term%time(1)), term%time(size(term%time)))
      b = (inside - term%time(i))/h
      a = 1 - b
      associate (left => term%values(i), right => term%values(i + 1), bend_left => term%bend(i), bend_right => term%bend(i + 1))
         value(1) = a*left + b*right - h**2/6*a*b*((1 + a)*bend_left + (1 + b)*bend_right)
         value(2) = (right - left)/h + h/6*((1 - 3*a**2)*bend_left + (3*b**2 - 1)*bend_right)
         value(3) = a*bend_left + b*bend_right
      end associate
      value(1) = value(1) + value(2)*(t - inside)
   end function table_at

end module evl_housing_motion
