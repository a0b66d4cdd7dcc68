!> Correction to the cubic predictor, estimated from the last converged orbits of a branch.
!>
!> It is a polynomial through the corrections at the nearest known orbits, including those before the first orbit of the
!> cubic, as long as the branch is smooth there. The cubic contains both its orbits, so that the polynomial may be required to
!> vanish at both. The cubic also has their tangents, but these are finite differences, accurate to about 1e-6: a double zero
!> there helps if few orbits are known, and harms if many are. The number of orbits and the multiplicity of the zeros are
!> those that predict the last orbit best.
!>
!> Near an orbit with grazing (kind_touch), at which a root function just touches zero, orbits are smooth in the square root
!> of the distance. It is then the variable of the polynomial (docs/theory/orbits.md). If the known corrections predict an orbit no
!> better than the cubic alone, the branch is not smooth: they are discarded, and so is the first orbit of the cubic.
!>
!> The derivative of the flow is corrected as well, from the last known orbit.
module evl_branch_lacks
   use evl_branch_curve, only: change_on_curve, curve_t, orbit_on_curve, way_to
   use evl_branch_point, only: branch_point, kind_touch
   use evl_kinds, only: wp
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: move_orbit, orbit_options, orbit_t
   implicit none (type, external)
   private

   public :: lacks_t, learn_from_before, learn_lack, orbit_at_value, orbit_beside_curve

   integer, parameter :: most_used = 8

   !> Choice of the polynomial.
   type :: fit_t
      integer :: n = most_used !! largest number of known orbits used
      integer :: zeros = 2     !! multiplicity of its zeros at the orbits of the curve
   end type fit_t

   !> Known corrections. Positions are 0 at the first orbit of the curve and 1 at the second.
   type :: lacks_t
      integer :: n = 0                    !! number of known orbits
      real(wp), allocatable :: x(:)       !! [.. n] their positions
      real(wp), allocatable :: lack(:, :) !! [n_states + 2, .. n] their corrections
      real(wp), allocatable :: derivative(:, :) !! [n_states, n_states] of the flow: correction over x (1 - x), at the last one
      type(fit_t) :: fit
      integer :: n_tried = 0              !! number of orbits up to which errors are known
      real(wp) :: errors(most_used, 0:2) = 0 !! of predictions of the last orbits, by number of orbits and multiplicity
      real(wp) :: largest = 0             !! norm of the corrections
      logical :: with_ends(2) = .true.    !! the curve's orbits are used: no known one is near them, and the branch is smooth
      logical :: touches(2) = .false.     !! a grazing point is before the first orbit; the second orbit is one
      real(wp) :: touch = 0               !! position of the former, as a share of the distance: 0 or less
   end type lacks_t

contains

   !> Predict the orbit at a distance along a curve, with the correction.
   pure subroutine orbit_beside_curve(model, options, curve, lacks, first, way, orbit)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve
      type(lacks_t), intent(in) :: lacks
      type(orbit_t), intent(in) :: first
      real(wp), intent(in) :: way
      type(orbit_t), intent(out) :: orbit
      real(wp) :: share, x

      call orbit_on_curve(model, options, curve, first, way, orbit)
      if (curve%is_straight) return
      share = way/curve%way
      x = place(lacks, share)
      orbit%flow%derivative = orbit%flow%derivative + (x - share)*curve%derivative
      if (lacks%n == 0) return
      call move_orbit(model, options, orbit, lack_at(lacks, those_near(lacks, x, lacks%fit%n), lacks%fit%zeros, x))
      orbit%flow%derivative = orbit%flow%derivative + x*(1 - x)*lacks%derivative
   end subroutine orbit_beside_curve

   !> Predict an orbit, and its derivative, at a value of the parameter: on the corrected curve, or on the straight line
   !> between two orbits with a corner between them.
   pure subroutine orbit_at_value(model, options, curve, lacks, first, last, value, orbit)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve
      type(lacks_t), intent(in) :: lacks
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
         call orbit_beside_curve(model, options, curve, lacks, first, way_of_value(options, curve, lacks, first, value), orbit)
      end if
      orbit%parameter = value
      if (allocated(orbit%tangent)) deallocate (orbit%tangent) ! that of the first orbit
   end subroutine orbit_at_value

   !> Distance along a curve at which the parameter has a value between those of its two orbits.
   pure real(wp) function way_of_value(options, curve, lacks, first, value) result(way)
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve       !! not straight
      type(lacks_t), intent(in) :: lacks
      type(orbit_t), intent(in) :: first
      real(wp), intent(in) :: value
      real(wp) :: share

      share = share_with([integer ::])
      if (lacks%n > 0) share = share_with(those_near(lacks, place(lacks, share), lacks%fit%n))
      way = share*curve%way

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
            there = change_on_curve(curve, middle*curve%way, p)
            if (size(near) > 0) &
               there = there + dot_product(weights(lacks, near, lacks%fit%zeros, place(lacks, middle)), lacks%lack(p, near))
            if (sign(there, there*change) < abs(change)) then
               below = middle
            else
               above = middle
            end if
         end do
      end function share_with

   end function way_of_value

   !> Record the correction of a curve at a converged orbit.
   pure subroutine learn_lack(model, options, curve, first, found, lacks, size_of, forgets)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve      !! not straight
      type(orbit_t), intent(in) :: first, found
      type(lacks_t), intent(inout) :: lacks
      real(wp), intent(out) :: size_of        !! its distance from the curve
      logical, intent(out) :: forgets         !! all earlier corrections are discarded
      real(wp), parameter :: worth = 0.1_wp, too_much = 10 !! error over the largest correction: for many, for few orbits
      real(wp), parameter :: nothing = 1.0e-8_wp !! an error without significance
      integer, parameter :: few = 2
      type(orbit_t) :: foreseen
      real(wp) :: lack(model%n + 2), share, x, error

      call compare(model, options, curve, first, found, foreseen, share, lack)
      size_of = norm2(lack)
      lacks%largest = max(lacks%largest, size_of)
      error = size_of
      if (lacks%n > 0) then
         x = place(lacks, share)
         error = norm2(lack - lack_at(lacks, those_near(lacks, x, lacks%fit%n), lacks%fit%zeros, x))
         call choose_fit(lacks, x, lack)
      end if
      forgets = error > max(nothing, merge(worth, too_much, lacks%n > few)*lacks%largest)
      if (forgets) then
         lacks%n = 0
         lacks%n_tried = 0
         lacks%fit = fit_t()
         lacks%with_ends(1) = .false.
      end if
      call keep(lacks, share, lack)
      call keep_derivative(curve, share, foreseen, found, lacks)
   end subroutine learn_lack

   !> Record the corrections of a curve at orbits before its first one.
   pure subroutine learn_from_before(model, options, curve, before, known, first, last, lacks)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve         !! not straight
      type(orbit_t), intent(in) :: before        !! orbit before the first, with its derivative; no tangent: there is none
      type(branch_point), intent(in) :: known(:) !! before the first one, on the smooth part; the first may be a grazing point
      type(branch_point), intent(in) :: first, last
      type(lacks_t), intent(out) :: lacks
      type(orbit_t) :: foreseen
      real(wp) :: lack(model%n + 2), share
      integer :: i

      lacks%touches(2) = last%kind == kind_touch
      do i = 1, size(known)
         call compare(model, options, curve, first%orbit, known(i)%orbit, foreseen, share, lack)
         if (known(i)%kind == kind_touch) then
            lacks%touches(1) = .true.
            lacks%touch = min(share, 0.0_wp)
         else
            if (i == size(known) .and. lacks%n > 0) call choose_fit(lacks, place(lacks, share), lack)
            call keep(lacks, share, lack)
         end if
      end do
      allocate (lacks%derivative(model%n, model%n), source=0.0_wp)
      if (.not. allocated(before%tangent)) return
      if (any(before%flow%crossings /= first%orbit%flow%crossings)) return
      call compare(model, options, curve, first%orbit, before, foreseen, share, lack)
      call keep_derivative(curve, share, foreseen, before, lacks)
   end subroutine learn_from_before

   !> Correction of a curve at an orbit.
   pure subroutine compare(model, options, curve, first, found, foreseen, share, lack)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve
      type(orbit_t), intent(in) :: first, found
      type(orbit_t), intent(out) :: foreseen  !! prediction on the curve
      real(wp), intent(out) :: share, lack(:) !! share of the distance to its second orbit; [n + 2]
      real(wp) :: way

      way = dot_product(curve%tangent, way_to(model, options, first, found))
      share = way/curve%way
      call orbit_on_curve(model, options, curve, first, way, foreseen)
      lack = way_to(model, options, foreseen, found)
   end subroutine compare

   !> Add a correction to the known ones.
   pure subroutine keep(lacks, share, lack)
      type(lacks_t), intent(inout) :: lacks
      real(wp), intent(in) :: share, lack(:)
      real(wp), parameter :: apart = 0.01_wp      !! from the orbits of the curve: a nearer one replaces them
      real(wp), parameter :: distinct = 1.0e-4_wp !! from the others: of two that are nearer to each other, the later one is stored
      real(wp), allocatable :: x(:), longer(:, :)
      real(wp) :: at
      integer :: k

      if (.not. allocated(lacks%x)) allocate (lacks%x(2*most_used), lacks%lack(size(lack), 2*most_used))
      if (lacks%n == size(lacks%x)) then
         allocate (x(2*lacks%n), longer(size(lack), 2*lacks%n))
         x(:lacks%n) = lacks%x
         longer(:, :lacks%n) = lacks%lack
         call move_alloc(x, lacks%x)
         call move_alloc(longer, lacks%lack)
      end if
      at = place(lacks, share)
      k = findloc(abs(lacks%x(:lacks%n) - at) < distinct, .true., 1)
      if (k == 0) k = lacks%n + 1
      lacks%n = max(lacks%n, k)
      lacks%x(k) = at
      lacks%lack(:, k) = lack
      lacks%with_ends = lacks%with_ends .and. abs(share - [0, 1]) > apart
   end subroutine keep

   !> Record the correction of the flow's derivative.
   pure subroutine keep_derivative(curve, share, foreseen, found, lacks)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: share
      type(orbit_t), intent(in) :: foreseen, found !! prediction on the curve; orbit with an approximate derivative
      type(lacks_t), intent(inout) :: lacks
      real(wp) :: x

      x = place(lacks, share)
      if (.not. abs(x*(1 - x)) > 0) return
      lacks%derivative = (found%flow%derivative - foreseen%flow%derivative - (x - share)*curve%derivative)/(x*(1 - x))
   end subroutine keep_derivative

   !> Position in the variable in which the branch is smooth: 0 at the first orbit of the curve, 1 at the second.
   elemental real(wp) function place(lacks, share) result(x)
      type(lacks_t), intent(in) :: lacks
      real(wp), intent(in) :: share !! of the distance

      x = root_of(share)
      if (lacks%touch < 0) x = (x - root_of(0.0_wp))/(1 - root_of(0.0_wp))

   contains

      elemental real(wp) function root_of(share) result(x)
         real(wp), intent(in) :: share
         real(wp), parameter :: quarter = asin(1.0_wp)

         x = share
         if (lacks%touches(1)) then
            x = sqrt(min(max((share - lacks%touch)/(1 - lacks%touch), 0.0_wp), 1.0_wp))
            if (lacks%touches(2)) x = asin(x)/quarter
         else if (lacks%touches(2)) then
            x = 1 - sqrt(max(1 - share, 0.0_wp))
         end if
      end function root_of

   end function place

   !> Indices of the nearest known corrections.
   pure function those_near(lacks, x, most) result(near)
      type(lacks_t), intent(in) :: lacks
      real(wp), intent(in) :: x
      integer, intent(in) :: most
      integer :: near(min(lacks%n, most)), k
      real(wp) :: distance(lacks%n)

      if (size(near) > 0) distance = abs(lacks%x(:lacks%n) - x)
      do k = 1, size(near)
         near(k) = minloc(distance, 1)
         distance(near(k)) = huge(distance)
      end do
   end function those_near

   !> Choose the polynomial that predicts best the correction at one more orbit, and at the earlier ones.
   pure subroutine choose_fit(lacks, x, lack)
      type(lacks_t), intent(inout) :: lacks !! without that one
      real(wp), intent(in) :: x, lack(:)
      real(wp), parameter :: before = 0.1_wp !! weight of an earlier error
      real(wp) :: error, least
      integer :: near(min(lacks%n, most_used)), k, zeros

      near = those_near(lacks, x, most_used)
      least = huge(least)
      do zeros = ubound(lacks%errors, 2), 0, -1
         do k = 1, size(near)
            error = norm2(lack - lack_at(lacks, near(:k), zeros, x))
            lacks%errors(k, zeros) = error + before*merge(lacks%errors(k, zeros), error, k <= lacks%n_tried)
            if (.not. lacks%errors(k, zeros) < least) cycle
            least = lacks%errors(k, zeros)
            lacks%fit = fit_t(merge(most_used, k, k == size(near)), zeros)
         end do
      end do
      lacks%n_tried = size(near)
   end subroutine choose_fit

   !> Correction by the polynomial through some of the known ones.
   pure function lack_at(lacks, near, zeros, x) result(lack)
      type(lacks_t), intent(in) :: lacks
      integer, intent(in) :: near(:), zeros
      real(wp), intent(in) :: x
      real(wp) :: lack(size(lacks%lack, 1)), weight(size(near))
      integer :: k

      weight = weights(lacks, near, zeros, x)
      lack = 0
      do k = 1, size(near)
         lack = lack + weight(k)*lacks%lack(:, near(k))
      end do
   end function lack_at

   !> Weights of some of the known corrections.
   pure function weights(lacks, near, zeros, x) result(weight)
      type(lacks_t), intent(in) :: lacks
      integer, intent(in) :: near(:), zeros
      real(wp), intent(in) :: x
      real(wp) :: weight(size(near))
      integer :: i, k, powers(2)

      powers = merge(zeros, 0, lacks%with_ends)
      ! in the square root of the distance, an inexact zero is double, and a double one triple
      where (powers > 0 .and. lacks%touches .and. [lacks%touch >= 0, .true.]) powers = powers + 1
      do k = 1, size(near)
         associate (at => lacks%x(near(k)))
            weight(k) = (x/at)**powers(1)*((1 - x)/(1 - at))**powers(2)
            do i = 1, size(near)
               if (i /= k) weight(k) = weight(k)*(x - lacks%x(near(i)))/(at - lacks%x(near(i)))
            end do
         end associate
      end do
   end function weights

end module evl_branch_lacks
