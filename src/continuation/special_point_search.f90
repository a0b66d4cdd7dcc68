!> Location of one special point of a branch: a zero of its test function between two neighbouring points.
!>
!> False position with halving along the branch: every value is that of a converged orbit. A false zero, at a jump of the
!> multipliers, is omitted.
module evl_special_point_search
   use evl_branch_curve, only: chord_to, curve_t, curve_through, orbit_on_curve
   use evl_branch_point, only: branch_point, kind_fold, kind_grazing
   use evl_branch_tests, only: grazing_test, is_genuine, test
   use evl_kinds, only: wp
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: move_orbit, orbit_options, orbit_t
   use evl_shooting, only: correct_orbit
   use evl_shooting_system, only: find_tangent
   use evl_status, only: clear, has_failed, status_t
   implicit none (type, external)
   private

   public :: locate, location_t

   integer, parameter :: most_turns = 60
   real(wp), parameter :: accuracy = 1.0e-10_wp !! of a position, over the way, or over 1 if that is shorter

   !> Result of the search for one special point.
   type :: location_t
      type(branch_point) :: point
      logical :: exists = .false.    !! false: the function jumps, or Newton's iteration fails
      real(wp) :: leap = 0           !! distance of the orbits beside a grazing point, over the way; huge if one between failed
      logical :: is_missed = .false. !! it was not found, but orbits on both sides are close to it: the branch continues
   end type location_t

   !> Search for one special point: the bracket, and what is known for predictions.
   type :: search_t
      integer :: kind = 0, root = 0
      integer :: fewer = 0              !! crossings of the root function on the side that has fewer, of a grazing point
      real(wp) :: arclength = 0               !! distance of the two points of the branch
      real(wp) :: enough = 0            !! value of the test function that counts as zero
      real(wp) :: a = 0, b = 0          !! ends of the bracket
      real(wp) :: at_a = 0, at_b = 0    !! the test function there
      type(orbit_t) :: left, right      !! the orbits there
      integer :: side = 0               !! the end that was replaced last: -1, 1
      real(wp) :: arclengths(3) = 0, values(3) = 0 !! positions and values of the last three orbits
      type(curve_t) :: curve
      real(wp) :: error = huge(1.0_wp)  !! of the last prediction
      type(orbit_options) :: options    !! with limits of the iteration
   end type search_t

contains

   !> Locate one special point by false position with halving (Illinois), or by a parabola where the function is smooth.
   subroutine locate(model, options, first, last, arclength, kind, root, found, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: first, last
      real(wp), intent(in) :: arclength
      integer, intent(in) :: kind, root
      type(location_t), intent(out) :: found
      type(status_t), intent(inout) :: status
      type(search_t) :: search
      type(orbit_t) :: predicted
      type(status_t) :: refusal
      real(wp) :: at, value
      integer :: turn

      call start_search(search, model, options, first, last, arclength, kind, root)
      ! always crossed, or never near: it changed with another one
      if (max(abs(search%at_a), abs(search%at_b)) > huge(1.0_wp)/2) return
      do turn = 1, most_turns
         if (is_narrow(search)) exit
         at = next_position(search, turn)
         call orbit_at(search, model, first, at, predicted, found%point%orbit, refusal)
         if (has_failed(refusal)) then
            if (kind == kind_grazing) call judge_gap(search, model, options, found)
            return
         end if
         search%error = norm2(chord_to(model, options, predicted, found%point%orbit))
         found%point%arclength = at
         value = value_of(search, model, found%point%orbit)
         if (.not. abs(value) > search%enough .or. abs(value) > huge(1.0_wp)/2) exit
         call replace_end(search, at, value, found%point%orbit)
      end do
      if (kind == kind_grazing .and. is_narrow(search)) &
         found%leap = norm2(chord_to(model, options, search%left, search%right))/arclength ! of both sides
      found%point%kind = kind
      found%point%root = root
      found%exists = is_genuine(model, kind, found%point%orbit)
      if (found%exists .and. .not. kind == kind_fold) &
         call find_tangent(model, options, found%point%orbit, first%tangent, refusal)
      if (has_failed(refusal)) status = refusal
   end subroutine locate

   !> Begin a search between two neighbouring points of a branch.
   subroutine start_search(search, model, options, first, last, arclength, kind, root)
      type(search_t), intent(out) :: search
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: first, last
      real(wp), intent(in) :: arclength
      integer, intent(in) :: kind, root
      integer, parameter :: most_iterations = 8    !! of Newton: near the orbit three are many
      integer, parameter :: most_damped = 2, most_halvings = 3 !! then it is at a corner, which the iteration does not pass

      search%kind = kind
      search%root = root
      if (kind == kind_grazing) search%fewer = min(first%flow%crossings(root), last%flow%crossings(root))
      search%curve = curve_through(model, options, first, last)
      search%options = options
      search%options%most_iterations = most_iterations
      search%options%most_damped = most_damped
      search%options%most_halvings = most_halvings
      search%arclength = arclength
      search%b = arclength
      search%left = first
      search%right = last
      search%at_a = value_of(search, model, first)
      search%at_b = value_of(search, model, last)
      if (kind /= kind_grazing) & ! otherwise orbits on both sides are required
         ! corresponds to that accuracy of the position
         search%enough = accuracy*min(1.0_wp, arclength)/arclength*abs(search%at_b - search%at_a)
      search%arclengths = [search%a, search%b, search%a]
      search%values = [search%at_a, search%at_b, search%at_a]
   end subroutine start_search

   !> Test function of the searched kind.
   real(wp) function value_of(search, model, orbit) result(value)
      type(search_t), intent(in) :: search
      class(orbit_model), intent(in) :: model
      type(orbit_t), intent(in) :: orbit

      if (search%kind == kind_grazing) then
         value = grazing_test(orbit, search%root, search%fewer)
      else
         value = test(model, search%kind, orbit)
      end if
   end function value_of

   !> Whether the bracket is as narrow as the accuracy of the position.
   pure logical function is_narrow(search)
      type(search_t), intent(in) :: search

      is_narrow = search%b - search%a <= accuracy*min(1.0_wp, search%arclength)
   end function is_narrow

   !> Position of the next orbit, inside the bracket.
   pure real(wp) function next_position(search, turn) result(at)
      type(search_t), intent(in) :: search
      integer, intent(in) :: turn
      real(wp) :: margin

      associate (a => search%a, b => search%b, at_a => search%at_a, at_b => search%at_b)
         at = b - at_b*((b - a)/(at_b - at_a))
         if (turn > 1 .and. search%kind /= kind_grazing) at = predicted_zero(search%arclengths, search%values, a, b, at)
         if (turn > most_turns/2) at = (a + b)/2 ! a function that jumps
         if (turn == 1 .and. abs(at_a) <= search%enough) at = a ! the zero is at the start
         margin = 0.3_wp*accuracy*min(1.0_wp, search%arclength)
         at = min(max(at, a + margin), b - margin)
      end associate
   end function next_position

   !> Compute the orbit at a position: from the cubic, or from the tangent.
   subroutine orbit_at(search, model, first, at, predicted, orbit, refusal)
      type(search_t), intent(inout) :: search
      class(orbit_model), intent(inout) :: model
      type(orbit_t), intent(in) :: first
      real(wp), intent(in) :: at
      type(orbit_t), intent(out) :: predicted !! on the cubic
      type(orbit_t), intent(out) :: orbit
      type(status_t), intent(out) :: refusal
      real(wp), parameter :: near = 1.0e-7_wp   !! error of the last prediction below which the next orbit converges at once
      real(wp), parameter :: little = 1.0e-4_wp !! over the way: the last one was no farther from the curve, which is accurate then

      associate (options => search%options)
         call orbit_on_curve(model, options, search%curve, first, at, predicted)
         orbit = predicted
         call correct_orbit(model, options, orbit, refusal, first%tangent, predicted=search%error > near)
         ! between two orbits with a corner between them the tangent may predict better than the cubic
         if (has_failed(refusal) .and. search%error > little*search%arclength) then
            orbit = first
            call move_orbit(model, options, orbit, at*first%tangent)
            call clear(refusal)
            call correct_orbit(model, options, orbit, refusal, first%tangent)
         end if
         if (search%kind == kind_fold .and. .not. has_failed(refusal)) &
            call find_tangent(model, options, orbit, first%tangent, refusal)
      end associate
   end subroutine orbit_at

   !> Whether the branch continues between the orbits on both sides of a grazing point, of which one between them failed.
   subroutine judge_gap(search, model, options, found)
      type(search_t), intent(in) :: search
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(location_t), intent(inout) :: found
      real(wp), parameter :: far = 2         !! distance of two orbits over the way between them, of different branches
      real(wp), parameter :: narrow = 0.2_wp !! between two orbits, over the way: the branch continues there
      logical :: are_close

      found%leap = norm2(chord_to(model, options, search%left, search%right))/search%arclength
      are_close = found%leap*search%arclength <= far*(search%b - search%a)
      found%is_missed = are_close .and. search%b - search%a <= narrow*search%arclength
      if (found%is_missed) then
         found%leap = 0
      else if (are_close) then
         found%leap = huge(found%leap)
      end if
   end subroutine judge_gap

   !> Replace one end of the bracket; halve the value at the other one if that was not replaced last time either.
   pure subroutine replace_end(search, at, value, orbit)
      type(search_t), intent(inout) :: search
      real(wp), intent(in) :: at, value
      type(orbit_t), intent(in) :: orbit

      search%arclengths = [at, search%arclengths(:2)]
      search%values = [value, search%values(:2)]
      if (value*search%at_a > 0) then
         search%a = at
         search%at_a = value
         search%left = orbit
         if (search%side == -1) search%at_b = search%at_b/2
         search%side = -1
      else
         search%b = at
         search%at_b = value
         search%right = orbit
         if (search%side == 1) search%at_a = search%at_a/2
         search%side = 1
      end if
   end subroutine replace_end

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

end module evl_special_point_search
