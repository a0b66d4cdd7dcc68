!> Special points of a branch, where its stability changes: folds, crossings of branches, period doublings, Neimark-Sacker
!> points, and orbits of which a root function just touches zero (grazing).
!>
!> Each is a zero of a test function between two neighbouring points of a branch, located by false position with halving along
!> the branch: every value is that of a converged orbit. A false zero, at a jump of the multipliers, is omitted.
!>
!> Sources: R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed., 5.3, 7.4; R. I. Leine, H. Nijmeijer, Dynamics and
!> Bifurcations of Non-Smooth Mechanical Systems, ch. 8 and 9 (jumps of multipliers).
module evl_special_points
   use evl_branch_curve, only: chord_to, curve_t, curve_through
   use evl_branch_point, only: branch_point, kind_crossing, kind_doubling, kind_fold, kind_grazing, kind_neimark_sacker
   use evl_kinds, only: wp
   use evl_multipliers, only: product_over_minus_one, product_over_one, product_over_pairs
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: move_orbit, orbit_options, orbit_t, own_multipliers
   use evl_predictor_correction, only: add_sample, corrections_t, orbit_beside_curve
   use evl_shooting, only: correct_orbit
   use evl_shooting_system, only: find_tangent
   use evl_status, only: clear, has_failed, status_t
   implicit none (type, external)
   private

   public :: find_special_points, grazing_test

contains

   !> Find all special points between two neighbouring points of a branch, in their order.
   subroutine find_special_points(model, options, first, last, arclength, points, leap, is_missed, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: first, last !! with tangents
      real(wp), intent(in) :: arclength              !! distance between them along the tangent of the first
      type(branch_point), allocatable, intent(out) :: points(:) !! `arclength` is measured from `first`
      real(wp), intent(out) :: leap            !! largest distance of orbits beside a grazing point, over the way: 0 on a branch
      logical, intent(out) :: is_missed        !! a grazing point was not found, though orbits close to both sides of it were
      type(status_t), intent(inout) :: status
      type(branch_point) :: located(kind_neimark_sacker + model%n_roots)
      real(wp), parameter :: upright = 1.0e-8_wp !! a branch at a constant parameter, as of a linear system, has no folds
      real(wp), parameter :: undamped = 1.0e-8_wp !! products of pairs without damping are 1 everywhere, up to rounding
      logical :: found, is_missed_here, was_lost(model%n_roots)
      real(wp) :: leap_here
      integer :: kind, n, other, root

      n = 0
      was_lost = .false.
      leap = 0
      is_missed = .false.
      do kind = kind_fold, kind_neimark_sacker
         if (.not. test(model, kind, first)*test(model, kind, last) < 0) cycle
         if (max(abs(test(model, kind, first)), abs(test(model, kind, last))) < undamped .and. kind == kind_neimark_sacker) cycle
         if (kind == kind_fold .and. max(abs(test(model, kind, first)), abs(test(model, kind, last))) < upright) cycle
         if (kind == kind_crossing) then ! a fold is one too
            if (test(model, kind_fold, first)*test(model, kind_fold, last) < 0) cycle
         end if
         call locate(model, options, first, last, arclength, kind, 0, located(n + 1), found, leap_here, is_missed_here, status)
         if (has_failed(status)) return
         if (found) n = n + 1
      end do
      do root = 1, model%n_roots
         if (first%flow%crossings(root) == last%flow%crossings(root)) cycle
         if (is_known(located(:n), first, last, root)) cycle
         if (any(are_alike(first, last, root, [(other, other=1, root - 1)]) .and. was_lost(:root - 1))) cycle
         call locate(model, options, first, last, arclength, kind_grazing, root, located(n + 1), found, leap_here, is_missed_here, &
                     status)
         was_lost(root) = .not. found
         if (has_failed(status)) return
         leap = max(leap, leap_here)
         is_missed = is_missed .or. is_missed_here
         if (found) n = n + 1
      end do
      points = located(:n)
      call sort(points)
   end subroutine find_special_points

   !> Test function that passes zero at a special point. Equation O10.
   real(wp) function test(model, kind, orbit) result(value)
      class(orbit_model), intent(in) :: model
      integer, intent(in) :: kind
      type(orbit_t), intent(in) :: orbit

      select case (kind)
      case (kind_fold)
         value = orbit%tangent(model%n + 2)
      case (kind_crossing)
         value = product_over_one(own_multipliers(model, orbit))
      case (kind_doubling)
         value = product_over_minus_one(own_multipliers(model, orbit))
      case default
         value = product_over_pairs(own_multipliers(model, orbit))
      end select
   end function test

   !> Distance of a root function from touching zero: positive if it does not reach zero, with as many crossings as `fewer`.
   !> Equation O14.
   pure real(wp) function grazing_test(orbit, root, fewer) result(value)
      type(orbit_t), intent(in) :: orbit
      integer, intent(in) :: root, fewer

      if (orbit%flow%crossings(root) == fewer) then
         value = orbit%flow%nearest(root)
      else
         value = -orbit%flow%slowest(root)
      end if
   end function grazing_test

   !> Whether a root function touches at a known point, as those of two tooth pairs that share a load do: that is one point.
   pure logical function is_known(points, first, last, root)
      type(branch_point), intent(in) :: points(:)
      type(orbit_t), intent(in) :: first, last
      integer, intent(in) :: root
      real(wp), parameter :: near = 1.0e-6_wp
      real(wp) :: at_ends
      integer :: fewer, i

      is_known = .false.
      fewer = min(first%flow%crossings(root), last%flow%crossings(root))
      at_ends = min(abs(grazing_test(first, root, fewer)), abs(grazing_test(last, root, fewer)))
      do i = 1, size(points)
         if (points(i)%kind == kind_grazing) &
            is_known = is_known .or. abs(grazing_test(points(i)%orbit, root, fewer)) <= near*at_ends
      end do
   end function is_known

   !> Whether two root functions are equal on both sides, as those of two tooth pairs that share a load: if one was not
   !> located, the other one cannot be located either.
   elemental logical function are_alike(first, last, root, other)
      type(orbit_t), intent(in) :: first, last
      integer, intent(in) :: root, other
      real(wp), parameter :: near = 1.0e-6_wp
      integer :: fewer, more

      more = first%flow%crossings(other) - first%flow%crossings(root)
      are_alike = last%flow%crossings(other) - last%flow%crossings(root) == more
      if (.not. are_alike) return
      fewer = min(first%flow%crossings(root), last%flow%crossings(root))
      are_alike = same(grazing_test(first, root, fewer), grazing_test(first, other, fewer + more)) &
                  .and. same(grazing_test(last, root, fewer), grazing_test(last, other, fewer + more))

   contains

      elemental logical function same(a, b)
         real(wp), intent(in) :: a, b

         same = abs(a - b) <= near*abs(a)
      end function same

   end function are_alike

   !> Locate one special point by false position with halving (Illinois), or by a parabola where the function is smooth.
   subroutine locate(model, options, first, last, arclength, kind, root, point, found, leap, is_missed, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: first, last
      real(wp), intent(in) :: arclength
      integer, intent(in) :: kind, root
      type(branch_point), intent(out) :: point
      logical, intent(out) :: found !! false: the function jumps, or Newton's iteration fails
      real(wp), intent(out) :: leap !! distance of the orbits beside a grazing point, over the way; huge if one between failed
      logical, intent(out) :: is_missed    !! it was not found, but orbits on both sides are close to it: the branch continues
      type(status_t), intent(inout) :: status
      integer, parameter :: most_turns = 60
      real(wp), parameter :: accuracy = 1.0e-10_wp !! over the way, or over 1 if that is shorter
      integer, parameter :: most_iterations = 8    !! of Newton: near the orbit three are many
      integer, parameter :: most_damped = 2, most_halvings = 3 !! then it is at a corner, which the iteration does not pass
      real(wp), parameter :: little = 1.0e-4_wp !! over the way: the last one was no farther from the curve, which is accurate then
      real(wp), parameter :: far = 2               !! distance of two orbits over the way between them, of different branches
      real(wp), parameter :: narrow = 0.2_wp       !! between two orbits, over the way: the branch continues there
      real(wp), parameter :: near = 1.0e-7_wp      !! error of the last prediction below which the next orbit converges at once
      real(wp) :: a, b, at_a, at_b, at, value, enough, error, size_of
      type(orbit_t) :: left, right, predicted
      type(curve_t) :: curve
      type(corrections_t) :: prior, nothing
      logical :: forgets
      type(orbit_options) :: few
      type(status_t) :: refusal
      real(wp) :: arclengths(3), values(3) ! the last three
      integer :: fewer, side, turn

      found = .false.
      leap = 0
      is_missed = .false.
      curve = curve_through(model, options, first, last)
      fewer = 0
      if (kind == kind_grazing) fewer = min(first%flow%crossings(root), last%flow%crossings(root))
      a = 0
      b = arclength
      at_a = ask(first)
      at_b = ask(last)
      if (max(abs(at_a), abs(at_b)) > huge(1.0_wp)/2) return ! always crossed, or never near: it changed with another one
      enough = accuracy*min(1.0_wp, arclength)/arclength*abs(at_b - at_a) ! corresponds to that accuracy of the position
      if (kind == kind_grazing) enough = 0 ! orbits on both sides are required
      few = options
      few%most_iterations = most_iterations
      few%most_damped = most_damped
      few%most_halvings = most_halvings
      left = first
      right = last
      arclengths = [a, b, a]
      values = [at_a, at_b, at_a]
      side = 0
      error = huge(error)
      do turn = 1, most_turns
         if (b - a <= accuracy*min(1.0_wp, arclength)) exit
         at = b - at_b*((b - a)/(at_b - at_a))
         if (turn > 1 .and. kind /= kind_grazing) at = predicted_zero(arclengths, values, a, b, at)
         if (turn > most_turns/2) at = (a + b)/2 ! a function that jumps
         if (turn == 1 .and. abs(at_a) <= enough) at = a ! the zero is at the start
         at = min(max(at, a + 0.3_wp*accuracy*min(1.0_wp, arclength)), b - 0.3_wp*accuracy*min(1.0_wp, arclength))
         call orbit_beside_curve(model, options, curve, prior, first, at, predicted)
         point%orbit = predicted
         call clear(refusal)
         call correct_orbit(model, few, point%orbit, refusal, first%tangent, predicted=error > near)
         if (has_failed(refusal) .and. prior%n > 0) then ! at a corner, corrections known from one side mislead
            prior = nothing
            call orbit_beside_curve(model, options, curve, prior, first, at, predicted)
            point%orbit = predicted
            call clear(refusal)
            call correct_orbit(model, few, point%orbit, refusal, first%tangent)
         end if
         ! between two orbits with a corner between them the tangent may predict better than the cubic
         if (has_failed(refusal) .and. error > little*arclength) then
            point%orbit = first
            call move_orbit(model, options, point%orbit, at*first%tangent)
            call clear(refusal)
            call correct_orbit(model, few, point%orbit, refusal, first%tangent)
         end if
         if (.not. has_failed(refusal) .and. kind == kind_fold) &
            call find_tangent(model, options, point%orbit, first%tangent, refusal)
         if (has_failed(refusal)) then
            if (kind /= kind_grazing) return
            leap = norm2(chord_to(model, options, left, right))/arclength
            is_missed = leap*arclength <= far*(b - a) .and. b - a <= narrow*arclength
            if (is_missed) leap = 0
            if (.not. is_missed .and. leap*arclength <= far*(b - a)) leap = huge(leap)
            return
         end if
         error = norm2(chord_to(model, options, predicted, point%orbit))
         if (.not. curve%is_straight) call add_sample(model, options, curve, first, point%orbit, prior, size_of, forgets)
         point%arclength = at
         value = ask(point%orbit)
         arclengths = [at, arclengths(:2)]
         values = [value, values(:2)]
         if (.not. abs(value) > enough .or. abs(value) > huge(1.0_wp)/2) exit
         if (value*at_a > 0) then
            a = at
            at_a = value
            left = point%orbit
            if (side == -1) at_b = at_b/2
            side = -1
         else
            b = at
            at_b = value
            right = point%orbit
            if (side == 1) at_a = at_a/2
            side = 1
         end if
      end do
      if (kind == kind_grazing .and. b - a <= accuracy*min(1.0_wp, arclength)) &
         leap = norm2(chord_to(model, options, left, right))/arclength ! of both sides
      point%kind = kind
      point%root = root
      found = is_genuine(model, kind, point%orbit)
      if (found .and. .not. kind == kind_fold) call find_tangent(model, options, point%orbit, first%tangent, refusal)
      if (has_failed(refusal)) status = refusal

   contains

      real(wp) function ask(orbit) result(value)
         type(orbit_t), intent(in) :: orbit

         if (kind == kind_grazing) then
            value = grazing_test(orbit, root, fewer)
         else
            value = test(model, kind, orbit)
         end if
      end function ask

   end subroutine locate

   !> Zero of a function by inverse quadratic interpolation through three points, if it lies between two bounds; else `otherwise`.
   pure real(wp) function predicted_zero(arclengths, values, a, b, otherwise) result(zero)
      real(wp), intent(in) :: arclengths(3), values(3), a, b, otherwise
      integer :: i, j, k

      zero = 0
      do k = 1, 3
         i = modulo(k, 3) + 1
         j = modulo(k + 1, 3) + 1
         if (.not. abs(values(i) - values(k)) > 0) then
            zero = huge(zero)
            exit
         end if
         zero = zero + arclengths(k)*(values(i)/(values(k) - values(i)))*(values(j)/(values(k) - values(j)))
      end do
      if (.not. (zero > a .and. zero < b)) zero = otherwise
   end function predicted_zero

   !> Whether the multipliers at a zero of the test function are those of its kind.
   pure logical function is_genuine(model, kind, orbit)
      class(orbit_model), intent(in) :: model
      integer, intent(in) :: kind
      type(orbit_t), intent(in) :: orbit
      real(wp), parameter :: near = 1.0e-4_wp
      complex(wp) :: mu(size(own_multipliers(model, orbit)))

      mu = own_multipliers(model, orbit)
      select case (kind)
      case (kind_crossing)
         is_genuine = any(abs(mu - 1) < near)
      case (kind_doubling)
         is_genuine = any(abs(mu + 1) < near)
      case (kind_neimark_sacker)
         is_genuine = any(abs(abs(mu) - 1) < near .and. abs(mu%im) > 0)
      case default
         is_genuine = .true.
      end select
   end function is_genuine

   !> Sort by their position.
   subroutine sort(points)
      type(branch_point), intent(inout) :: points(:)
      type(branch_point) :: held
      integer :: i, j

      do i = 2, size(points)
         held = points(i)
         do j = i - 1, 1, -1
            if (points(j)%arclength <= held%arclength) exit
            points(j + 1) = points(j)
         end do
         points(j + 1) = held
      end do
   end subroutine sort

end module evl_special_points
