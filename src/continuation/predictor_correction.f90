!> Correction to the cubic predictor, estimated from the last converged orbits of a branch.
!>
!> It is a polynomial through the corrections at the nearest known orbits, including those before the first orbit of the
!> cubic, as long as the branch is smooth there. The cubic contains both its orbits, so that the polynomial may be required to
!> vanish at both. The cubic also has their tangents, but these are finite differences, accurate to about 1e-6: a double zero
!> there helps if few orbits are known, and harms if many are. The number of orbits and the multiplicity of the zeros are
!> those that predict the last orbit best.
!>
!> Near an orbit with grazing (kind_grazing), at which a root function just touches zero, orbits are smooth in the square root
!> of the distance. It is then the variable of the polynomial (docs/theory/orbits.md). If the known corrections predict an orbit no
!> better than the cubic alone, the branch is not smooth: they are discarded, and so is the first orbit of the cubic.
!>
!> The derivative of the flow is corrected as well, from the last known orbit.
module evl_predictor_correction
   use evl_branch_curve, only: change_on_curve, chord_to, curve_t, orbit_on_curve
   use evl_branch_point, only: branch_point, kind_grazing
   use evl_kinds, only: wp
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: move_orbit, orbit_options, orbit_t
   implicit none (type, external)
   private

   public :: corrections_t, learn_from_before, add_sample, orbit_at_value, orbit_beside_curve

   integer, parameter :: most_used = 8

   !> Choice of the polynomial.
   type :: fit_t
      integer :: n = most_used !! largest number of known orbits used
      integer :: zeros = 2     !! multiplicity of its zeros at the orbits of the curve
   end type fit_t

   !> Known corrections. Positions are 0 at the first orbit of the curve and 1 at the second.
   type :: corrections_t
      integer :: n = 0                    !! number of known orbits
      real(wp), allocatable :: x(:)       !! [.. n] their positions
      real(wp), allocatable :: correction(:, :) !! [n_states + 2, .. n] their corrections
      real(wp), allocatable :: derivative(:, :) !! [n_states, n_states] of the flow: correction over x (1 - x), at the last one
      type(fit_t) :: fit
      integer :: n_tried = 0              !! number of orbits up to which errors are known
      real(wp) :: errors(most_used, 0:2) = 0 !! of predictions of the last orbits, by number of orbits and multiplicity
      real(wp) :: largest = 0             !! norm of the corrections
      logical :: with_ends(2) = .true.    !! the curve's orbits are used: no known one is near them, and the branch is smooth
      logical :: has_grazing(2) = .false.     !! a grazing point is before the first orbit; the second orbit is one
      real(wp) :: grazing = 0               !! position of the former, as a share of the distance: 0 or less
   end type corrections_t

contains

   !> Predict the orbit at a distance along a curve, with the correction.
   pure subroutine orbit_beside_curve(model, options, curve, prior, first, arclength, orbit)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve
      type(corrections_t), intent(in) :: prior
      type(orbit_t), intent(in) :: first
      real(wp), intent(in) :: arclength
      type(orbit_t), intent(out) :: orbit
      real(wp) :: share, x

      call orbit_on_curve(model, options, curve, first, arclength, orbit)
      if (curve%is_straight) return
      share = arclength/curve%arclength
      x = smooth_x(prior, share)
      orbit%flow%derivative = orbit%flow%derivative + (x - share)*curve%derivative
      if (prior%n == 0) return
      call move_orbit(model, options, orbit, correction_at(prior, those_near(prior, x, prior%fit%n), prior%fit%zeros, x))
      orbit%flow%derivative = orbit%flow%derivative + x*(1 - x)*prior%derivative
   end subroutine orbit_beside_curve

   !> Predict an orbit, and its derivative, at a value of the parameter: on the corrected curve, or on the straight line
   !> between two orbits with a corner between them.
   pure subroutine orbit_at_value(model, options, curve, prior, first, last, value, orbit)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve
      type(corrections_t), intent(in) :: prior
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
         call orbit_beside_curve(model, options, curve, prior, first, arclength_of_value(options, curve, prior, first, value), &
                                 orbit)
      end if
      orbit%parameter = value
      if (allocated(orbit%tangent)) deallocate (orbit%tangent) ! that of the first orbit
   end subroutine orbit_at_value

   !> Distance along a curve at which the parameter has a value between those of its two orbits.
   pure real(wp) function arclength_of_value(options, curve, prior, first, value) result(arclength)
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve       !! not straight
      type(corrections_t), intent(in) :: prior
      type(orbit_t), intent(in) :: first
      real(wp), intent(in) :: value
      real(wp) :: share

      share = share_with([integer ::])
      if (prior%n > 0) share = share_with(those_near(prior, smooth_x(prior, share), prior%fit%n))
      arclength = share*curve%arclength

   contains

      !> Bisection, since the parameter is monotonic between the two.
      pure real(wp) function share_with(near) result(middle)
         integer, intent(in) :: near(:)
         integer, parameter :: halvings = 50
         real(wp) :: below, above, change, there
         integer :: k, p

         p = size(curve%tangent)
         change = (value - first%parameter)/options%parameter_scale
         below = 0
         above = 1
         do k = 1, halvings
            middle = (below + above)/2
            there = change_on_curve(curve, middle*curve%arclength, p)
            if (size(near) > 0) &
               there = there + dot_product(weights(prior, near, prior%fit%zeros, smooth_x(prior, middle)), &
                                           prior%correction(p, near))
            if (sign(there, there*change) < abs(change)) then
               below = middle
            else
               above = middle
            end if
         end do
      end function share_with

   end function arclength_of_value

   !> Record the correction of a curve at a converged orbit.
   pure subroutine add_sample(model, options, curve, first, found, prior, size_of, forgets)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve      !! not straight
      type(orbit_t), intent(in) :: first, found
      type(corrections_t), intent(inout) :: prior
      real(wp), intent(out) :: size_of        !! its distance from the curve
      logical, intent(out) :: forgets         !! all earlier corrections are discarded
      real(wp), parameter :: worth = 0.1_wp, too_much = 10 !! error over the largest correction: for many, for few orbits
      real(wp), parameter :: nothing = 1.0e-8_wp !! an error without significance
      integer, parameter :: few = 2
      type(orbit_t) :: predicted
      real(wp) :: correction(model%n + 2), share, x, error

      call compare(model, options, curve, first, found, predicted, share, correction)
      size_of = norm2(correction)
      prior%largest = max(prior%largest, size_of)
      error = size_of
      if (prior%n > 0) then
         x = smooth_x(prior, share)
         error = norm2(correction - correction_at(prior, those_near(prior, x, prior%fit%n), prior%fit%zeros, x))
         call choose_fit(prior, x, correction)
      end if
      forgets = error > max(nothing, merge(worth, too_much, prior%n > few)*prior%largest)
      if (forgets) then
         prior%n = 0
         prior%n_tried = 0
         prior%fit = fit_t()
         prior%with_ends(1) = .false.
      end if
      call add_correction(prior, share, correction)
      call store_derivative(curve, share, predicted, found, prior)
   end subroutine add_sample

   !> Record the corrections of a curve at orbits before its first one.
   pure subroutine learn_from_before(model, options, curve, before, known, first, last, prior)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve         !! not straight
      type(orbit_t), intent(in) :: before        !! orbit before the first, with its derivative; no tangent: there is none
      type(branch_point), intent(in) :: known(:) !! before the first one, on the smooth part; the first may be a grazing point
      type(branch_point), intent(in) :: first, last
      type(corrections_t), intent(out) :: prior
      type(orbit_t) :: predicted
      real(wp) :: correction(model%n + 2), share
      integer :: i

      prior%has_grazing(2) = last%kind == kind_grazing
      do i = 1, size(known)
         call compare(model, options, curve, first%orbit, known(i)%orbit, predicted, share, correction)
         if (known(i)%kind == kind_grazing) then
            prior%has_grazing(1) = .true.
            prior%grazing = min(share, 0.0_wp)
         else
            if (i == size(known) .and. prior%n > 0) call choose_fit(prior, smooth_x(prior, share), correction)
            call add_correction(prior, share, correction)
         end if
      end do
      allocate (prior%derivative(model%n, model%n), source=0.0_wp)
      if (.not. allocated(before%tangent)) return
      if (any(before%flow%crossings /= first%orbit%flow%crossings)) return
      call compare(model, options, curve, first%orbit, before, predicted, share, correction)
      call store_derivative(curve, share, predicted, before, prior)
   end subroutine learn_from_before

   !> Correction of a curve at an orbit.
   pure subroutine compare(model, options, curve, first, found, predicted, share, correction)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve
      type(orbit_t), intent(in) :: first, found
      type(orbit_t), intent(out) :: predicted  !! prediction on the curve
      real(wp), intent(out) :: share, correction(:) !! share of the distance to its second orbit; [n + 2]
      real(wp) :: arclength

      arclength = dot_product(curve%tangent, chord_to(model, options, first, found))
      share = arclength/curve%arclength
      call orbit_on_curve(model, options, curve, first, arclength, predicted)
      correction = chord_to(model, options, predicted, found)
   end subroutine compare

   !> Add a correction to the known ones.
   pure subroutine add_correction(prior, share, correction)
      type(corrections_t), intent(inout) :: prior
      real(wp), intent(in) :: share, correction(:)
      real(wp), parameter :: apart = 0.01_wp      !! from the orbits of the curve: a nearer one replaces them
      real(wp), parameter :: distinct = 1.0e-4_wp !! from the others: of two that are nearer to each other, the later one is stored
      real(wp), allocatable :: x(:), longer(:, :)
      real(wp) :: at
      integer :: k

      if (.not. allocated(prior%x)) allocate (prior%x(2*most_used), prior%correction(size(correction), 2*most_used))
      if (prior%n == size(prior%x)) then
         allocate (x(2*prior%n), longer(size(correction), 2*prior%n))
         x(:prior%n) = prior%x
         longer(:, :prior%n) = prior%correction
         call move_alloc(x, prior%x)
         call move_alloc(longer, prior%correction)
      end if
      at = smooth_x(prior, share)
      k = findloc(abs(prior%x(:prior%n) - at) < distinct, .true., 1)
      if (k == 0) k = prior%n + 1
      prior%n = max(prior%n, k)
      prior%x(k) = at
      prior%correction(:, k) = correction
      prior%with_ends = prior%with_ends .and. abs(share - [0, 1]) > apart
   end subroutine add_correction

   !> Record the correction of the flow's derivative.
   pure subroutine store_derivative(curve, share, predicted, found, prior)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: share
      type(orbit_t), intent(in) :: predicted, found !! prediction on the curve; orbit with an approximate derivative
      type(corrections_t), intent(inout) :: prior
      real(wp) :: x

      x = smooth_x(prior, share)
      if (.not. abs(x*(1 - x)) > 0) return
      prior%derivative = (found%flow%derivative - predicted%flow%derivative - (x - share)*curve%derivative)/(x*(1 - x))
   end subroutine store_derivative

   !> Position in the variable in which the branch is smooth: 0 at the first orbit of the curve, 1 at the second.
   elemental real(wp) function smooth_x(prior, share) result(x)
      type(corrections_t), intent(in) :: prior
      real(wp), intent(in) :: share !! of the distance

      x = root_of(share)
      if (prior%grazing < 0) x = (x - root_of(0.0_wp))/(1 - root_of(0.0_wp))

   contains

      elemental real(wp) function root_of(share) result(x)
         real(wp), intent(in) :: share
         real(wp), parameter :: quarter = asin(1.0_wp)

         x = share
         if (prior%has_grazing(1)) then
            x = sqrt(min(max((share - prior%grazing)/(1 - prior%grazing), 0.0_wp), 1.0_wp))
            if (prior%has_grazing(2)) x = asin(x)/quarter
         else if (prior%has_grazing(2)) then
            x = 1 - sqrt(max(1 - share, 0.0_wp))
         end if
      end function root_of

   end function smooth_x

   !> Indices of the nearest known corrections.
   pure function those_near(prior, x, most) result(near)
      type(corrections_t), intent(in) :: prior
      real(wp), intent(in) :: x
      integer, intent(in) :: most
      integer :: near(min(prior%n, most)), k
      real(wp) :: distance(prior%n)

      if (size(near) > 0) distance = abs(prior%x(:prior%n) - x)
      do k = 1, size(near)
         near(k) = minloc(distance, 1)
         distance(near(k)) = huge(distance)
      end do
   end function those_near

   !> Choose the polynomial that predicts best the correction at one more orbit, and at the earlier ones.
   pure subroutine choose_fit(prior, x, correction)
      type(corrections_t), intent(inout) :: prior !! without that one
      real(wp), intent(in) :: x, correction(:)
      real(wp), parameter :: before = 0.1_wp !! weight of an earlier error
      real(wp) :: error, least
      integer :: near(min(prior%n, most_used)), k, zeros

      near = those_near(prior, x, most_used)
      least = huge(least)
      do zeros = ubound(prior%errors, 2), 0, -1
         do k = 1, size(near)
            error = norm2(correction - correction_at(prior, near(:k), zeros, x))
            prior%errors(k, zeros) = error + before*merge(prior%errors(k, zeros), error, k <= prior%n_tried)
            if (.not. prior%errors(k, zeros) < least) cycle
            least = prior%errors(k, zeros)
            prior%fit = fit_t(merge(most_used, k, k == size(near)), zeros)
         end do
      end do
      prior%n_tried = size(near)
   end subroutine choose_fit

   !> Correction by the polynomial through some of the known ones.
   pure function correction_at(prior, near, zeros, x) result(correction)
      type(corrections_t), intent(in) :: prior
      integer, intent(in) :: near(:), zeros
      real(wp), intent(in) :: x
      real(wp) :: correction(size(prior%correction, 1)), weight(size(near))
      integer :: k

      weight = weights(prior, near, zeros, x)
      correction = 0
      do k = 1, size(near)
         correction = correction + weight(k)*prior%correction(:, near(k))
      end do
   end function correction_at

   !> Weights of some of the known corrections.
   pure function weights(prior, near, zeros, x) result(weight)
      type(corrections_t), intent(in) :: prior
      integer, intent(in) :: near(:), zeros
      real(wp), intent(in) :: x
      real(wp) :: weight(size(near))
      integer :: i, k, powers(2)

      powers = merge(zeros, 0, prior%with_ends)
      ! in the square root of the distance, an inexact zero is double, and a double one triple
      where (powers > 0 .and. prior%has_grazing .and. [prior%grazing >= 0, .true.]) powers = powers + 1
      do k = 1, size(near)
         associate (at => prior%x(near(k)))
            weight(k) = (x/at)**powers(1)*((1 - x)/(1 - at))**powers(2)
            do i = 1, size(near)
               if (i /= k) weight(k) = weight(k)*(x - prior%x(near(i)))/(at - prior%x(near(i)))
            end do
         end associate
      end do
   end function weights

end module evl_predictor_correction
