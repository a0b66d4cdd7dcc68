!> Segment of a branch between two of its orbits: the cubic through both, with their tangents.
!>
!> Its parameter w is the distance along the tangent of the first orbit; the projection of the cubic on this tangent equals w.
!> The cubic is also evaluated beyond its end: it predicts the next orbit from the last two.
!>
!> Sources: R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed., 4.4 (predictors); E. L. Allgower, K. Georg, Numerical
!> Continuation Methods, Springer 1990, 6.1-6.3 (higher order).
module evl_branch_curve
   use evl_kinds, only: wp
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: move_orbit, orbit_options, orbit_t
   implicit none (type, external)
   private

   public :: chord_to, curve_t, curve_through, orbit_at_value, orbit_on_curve, prediction_error

   !> All components are relative to the first orbit, in units of the scales.
   type :: curve_t
      logical :: is_straight = .true.      !! there is no second orbit, or the branch turns too much before it
      real(wp) :: arclength = 0                  !! w of the second orbit, negative behind the first one
      real(wp), allocatable :: tangent(:)  !! [n + 2] at the first
      real(wp), allocatable :: bend(:, :)  !! [n + 2, 2] coefficients of (w/arclength)**2 and (w/arclength)**3
      real(wp), allocatable :: by_parameter(:) !! [n] dP/dp at the second orbit minus that at the first
      real(wp), allocatable :: derivative(:, :) !! [n, n] of the flow, at the second orbit minus that at the first
   end type curve_t

contains

   !> Vector from an orbit to another one of the same branch.
   pure function chord_to(model, options, from, to) result(chord)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: from, to
      real(wp) :: chord(model%n + 2) !! in units of the scales

      chord = 0
      chord(:model%n) = merge((to%y - from%y)/model%scale, 0.0_wp, from%active)
      if (model%autonomous) chord(model%n + 1) = to%period/from%period - 1
      chord(model%n + 2) = (to%parameter - from%parameter)/options%parameter_scale
   end function chord_to

   !> Curve from an orbit through another one.
   pure function curve_through(model, options, from, to) result(curve)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: from, to !! with tangents; without, the curve is straight
      type(curve_t) :: curve
      real(wp), parameter :: little_turn = 0.9_wp !! cosine of the angle between tangents
      real(wp) :: distance(model%n + 2), slope(model%n + 2), straight

      allocate (curve%tangent, source=from%tangent)
      if (.not. allocated(to%tangent)) return
      straight = dot_product(from%tangent, to%tangent)
      distance = chord_to(model, options, from, to)
      curve%arclength = dot_product(from%tangent, distance)
      curve%is_straight = straight < little_turn .or. .not. abs(curve%arclength) > 0
      if (curve%is_straight) return
      distance = distance - curve%arclength*from%tangent
      slope = curve%arclength*(to%tangent/straight - from%tangent)
      allocate (curve%bend(model%n + 2, 2))
      curve%bend(:, 1) = 3*distance - slope
      curve%bend(:, 2) = slope - 2*distance
      allocate (curve%by_parameter, source=to%by_parameter - from%by_parameter)
      allocate (curve%derivative, source=to%flow%derivative - from%flow%derivative)
   end function curve_through

   !> Predict an orbit at a distance along a curve from its first orbit.
   pure subroutine orbit_on_curve(model, options, curve, from, arclength, orbit)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve
      type(orbit_t), intent(in) :: from
      real(wp), intent(in) :: arclength
      type(orbit_t), intent(out) :: orbit
      real(wp) :: change(model%n + 2), share
      integer :: i

      orbit = from
      do i = 1, size(change)
         change(i) = change_on_curve(curve, arclength, i)
      end do
      if (.not. curve%is_straight) then
         share = arclength/curve%arclength
         orbit%by_parameter = orbit%by_parameter + share*curve%by_parameter
         orbit%flow%derivative = orbit%flow%derivative + share*curve%derivative
      end if
      call move_orbit(model, options, orbit, change)
   end subroutine orbit_on_curve

   !> Predict an orbit, and its derivative, at a value of the parameter: on the curve, or on the straight line between two orbits
   !> with a corner between them.
   pure subroutine orbit_at_value(model, options, curve, first, last, value, orbit)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve
      type(orbit_t), intent(in) :: first, last
      real(wp), intent(in) :: value
      type(orbit_t), intent(out) :: orbit
      real(wp) :: share

      if (curve%is_straight) then
         share = (value - first%parameter)/(last%parameter - first%parameter)
         orbit = first
         orbit%y = first%y + share*(last%y - first%y)
         orbit%period = first%period + share*(last%period - first%period)
         orbit%flow%derivative = first%flow%derivative + share*(last%flow%derivative - first%flow%derivative)
      else
         call orbit_on_curve(model, options, curve, first, &
                             arclength_of_change(curve, (value - first%parameter)/options%parameter_scale), orbit)
      end if
      orbit%parameter = value
      if (allocated(orbit%tangent)) deallocate (orbit%tangent) ! that of the first orbit
   end subroutine orbit_at_value

   !> Distance along a curve at which the parameter has changed by an amount less than that of its second orbit, by bisection.
   pure real(wp) function arclength_of_change(curve, change) result(arclength)
      type(curve_t), intent(in) :: curve !! not straight, the parameter monotonic on it
      real(wp), intent(in) :: change     !! in units of the scale
      integer, parameter :: halvings = 50
      real(wp) :: below, above
      integer :: k

      below = 0
      above = curve%arclength
      do k = 1, halvings
         arclength = (below + above)/2
         if (sign(1.0_wp, change)*change_on_curve(curve, arclength, size(curve%tangent)) < abs(change)) then
            below = arclength
         else
            above = arclength
         end if
      end do
   end function arclength_of_change

   !> Change of one of the unknowns from the first orbit, in units of its scale.
   elemental real(wp) function change_on_curve(curve, arclength, i) result(change)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: arclength
      integer, intent(in) :: i !! 1 .. n + 2

      change = arclength*curve%tangent(i)
      if (.not. curve%is_straight) &
         change = change + (arclength/curve%arclength)**2*(curve%bend(i, 1) + (arclength/curve%arclength)*curve%bend(i, 2))
   end function change_on_curve

   !> Distance of an orbit from its prediction by a curve.
   pure real(wp) function prediction_error(model, options, curve, from, found, arclength) result(error)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve
      type(orbit_t), intent(in) :: from, found
      real(wp), intent(in) :: arclength
      type(orbit_t) :: predicted

      call orbit_on_curve(model, options, curve, from, arclength, predicted)
      error = norm2(chord_to(model, options, predicted, found))
   end function prediction_error

end module evl_branch_curve
