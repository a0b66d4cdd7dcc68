!> Continuation of branches of periodic orbits in a parameter, through folds.
!>
!> Pseudo-arclength continuation: a step along the tangent from a point, then Newton's iteration orthogonal to it. The step is
!> halved if the iteration fails or the branch turns too much in a step, and grows if convergence is fast.
!>
!> Sources: H. B. Keller, in: Applications of Bifurcation Theory, Academic Press 1977; R. Seydel, Practical Bifurcation and
!> Stability Analysis, 3rd ed., ch. 4 and 7.
module evl_branch
   use evl_branch_curve, only: chord_to, curve_t, curve_through, orbit_on_curve, prediction_error
   use evl_branch_doubling, only: repeats_sooner
   use evl_branch_point, only: branch_point, kind_fold, kind_grazing, kind_ordinary, orbit_recorder
   use evl_branch_values, only: find_orbits_at
   use evl_grazing_passage, only: grazing_passage, pass_grazing
   use evl_indices, only: indices
   use evl_kinds, only: wp
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: orbit_options, orbit_t
   use evl_predictor_correction, only: corrections_t, orbit_at_value
   use evl_shooting, only: correct_orbit
   use evl_shooting_system, only: find_tangent
   use evl_special_points, only: find_special_points
   use evl_status, only: clear, code_invalid_input, code_no_solution, fail, has_failed, quantity, status_t
   implicit none (type, external)
   private

   public :: branch_options, branch_walk
   public :: advance_branch, begin_branch, follow_branch, append_point, before_end

   !> User options of a branch. Steps are in units of the scales.
   type :: branch_options
      type(orbit_options) :: orbits             !! options of each orbit
      real(wp) :: from = -huge(1.0_wp), to = huge(1.0_wp) !! limits of the parameter
      logical :: rising = .true.                !! the parameter rises at the start
      real(wp) :: first_step = 0.01_wp, smallest_step = 1.0e-6_wp, largest_step = 0.1_wp
      real(wp) :: straight_step = 0             !! largest step where the branch is straight, if that is larger
      real(wp) :: largest_change = huge(1.0_wp) !! of the parameter in a step, over its scale
      integer :: most_points = 1000             !! special points, and those at values, are not counted
      real(wp), allocatable :: values(:)        !! of the parameter, ascending, at which orbits are computed as well
      class(orbit_recorder), pointer :: recorder => null() !! output recorder of these; its numbers restart in each step
   end type branch_options

   !> State of a continuation: all data that determine its next point.
   type :: branch_walk
      type(branch_point) :: first, now !! ordinary points: the first one and the last one
      type(orbit_t) :: before          !! of the point before the last; without a tangent if there is none
      type(branch_point), allocatable :: past(:) !! last few points, from before_end
      real(wp) :: step = 0             !! step to try next
      integer :: crawls = 0            !! consecutive steps without progress
      integer :: n_ordinary = 0        !! number of ordinary points
      logical :: is_smooth = .true.    !! the cubic through the last two points predicted the last step better than the tangent
      logical :: is_over = .false.
   end type branch_walk

contains

   !> Continue the branch of an orbit until the parameter leaves its range, the branch closes, or the number of points is
   !> reached. A branch of doubled period ends where the two halves of its orbits coincide.
   subroutine follow_branch(model, options, orbit, points, status)
      class(orbit_model), intent(inout) :: model
      type(branch_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit     !! converged; its tangent, if it has one, is the direction
      type(branch_point), allocatable, intent(out) :: points(:) !! on failure: those found before
      type(status_t), intent(inout) :: status
      type(branch_walk) :: walk
      type(branch_point), allocatable :: more(:)
      integer :: i, n

      n = 0
      allocate (points(64))
      call begin_branch(model, options, orbit, walk, status)
      if (.not. has_failed(status)) call append_point(points, n, walk%first)
      do while (.not. (has_failed(status) .or. walk%is_over))
         call advance_branch(model, options, walk, more, status)
         do i = 1, size(more)
            call append_point(points, n, more(i))
         end do
      end do
      points = points(:n)
   end subroutine follow_branch

   !> Start at the first point of a branch.
   subroutine begin_branch(model, options, orbit, walk, status)
      class(orbit_model), intent(inout) :: model
      type(branch_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit !! converged; its tangent, if it has one, is the direction
      type(branch_walk), intent(out) :: walk
      type(status_t), intent(inout) :: status
      real(wp) :: along(model%n + 2)

      if (.not. (options%from < options%to .and. orbit%parameter >= options%from .and. orbit%parameter <= options%to)) &
         call fail(status, code_invalid_input, "the branch begins at "//quantity(orbit%parameter, "")//", not between "// &
                   quantity(options%from, "")//" and "//quantity(options%to, ""), field="parameter")
      walk%now%orbit = orbit
      along = 0
      along(model%n + 2) = merge(1, -1, options%rising)
      if (allocated(orbit%tangent)) along = orbit%tangent
      if (.not. has_failed(status)) call find_tangent(model, options%orbits, walk%now%orbit, along, status)
      walk%first = walk%now
      allocate (walk%past(0))
      walk%step = options%first_step
      walk%n_ordinary = 1
      walk%is_over = walk%n_ordinary >= options%most_points
   end subroutine begin_branch

   !> Compute the next point of a branch, with the special points before it.
   subroutine advance_branch(model, options, walk, points, status)
      class(orbit_model), intent(inout) :: model
      type(branch_options), intent(in) :: options
      type(branch_walk), intent(inout) :: walk
      type(branch_point), allocatable, intent(out) :: points(:) !! on failure: those found before
      type(status_t), intent(inout) :: status
      type(branch_point), allocatable :: special(:), past(:)
      type(branch_point) :: last ! last point
      type(orbit_t) :: before    ! orbit before the last point
      type(branch_point) :: next, target
      type(grazing_passage) :: passage
      real(wp), parameter :: crawling = 0.01_wp   !! step over the first one below which there is no progress
      real(wp), parameter :: little = 1.0e-3_wp, same = 1.0e-8_wp !! discontinuity over the step
      integer, parameter :: most_crawls = 60      !! consecutive steps of that kind
      logical :: at_end, closes, is_missed
      real(wp) :: leap
      integer :: i, n_used

      n_used = 0
      allocate (points(0))
      call go_on(model, options, walk%before, walk%now%orbit, next, walk%step, walk%is_smooth, passage, status)
      if (has_failed(status)) return
      walk%crawls = merge(walk%crawls + 1, 0, next%arclength < crawling*options%first_step)
      if (walk%crawls > most_crawls) then
         call fail(status, code_no_solution, "the step of the branch decreases without limit at "// &
                   quantity(next%orbit%parameter, "")//", where events coincide", field="parameter")
         return
      end if
      do
         at_end = next%orbit%parameter <= options%from .or. next%orbit%parameter >= options%to
         last = walk%now
         if (passage%found) then
            target = passage%grazing
            last = target
            last%orbit%tangent = passage%onward
         end if
         if (at_end) call stop_at_bound(model, options, last%orbit, next, status)
         if (.not. passage%found) target = next
         if (has_failed(status)) return
         leap = 0
         is_missed = .false.
         if (passage%found .and. passage%from_behind) then ! multipliers jump: their test functions are meaningless
            special = [branch_point ::]
         else
            call find_special_points(model, options%orbits, walk%now%orbit, target%orbit, target%arclength, special, leap, &
                                     is_missed, status)
            if (has_failed(status)) return
         end if
         if (passage%found .or. (leap < little .and. .not. is_missed)) exit
         ! if the orbits on both sides of a grazing point that was found coincide, there is no jump
         call look_for_grazing(model, options, walk%before, walk%now%orbit, target%arclength, &
                               special(indices(special%kind == kind_grazing .and. leap <= same))%root, passage)
         if (passage%found) then
            next = passage%next
            walk%step = next%arclength
         else if (leap >= little .and. target%arclength > merge(100*options%smallest_step, options%first_step, &
                                                                leap < huge(leap))) then
            walk%step = target%arclength/4 ! the two orbits belong to different branches, or more points lie between them
            call go_on(model, options, walk%before, walk%now%orbit, next, walk%step, walk%is_smooth, passage, status)
            if (has_failed(status)) return
         else
            exit
         end if
      end do
      last = walk%now
      before = walk%before
      past = walk%past
      do i = 1, size(special)
         call add_up_to(special(i))
         closes = special(i)%kind == kind_fold
         if (closes) call repeats_sooner(model, options%orbits, special(i)%orbit, closes, status)
         if (.not. closes .and. .not. has_failed(status)) cycle
         walk%is_over = closes ! only the same orbits, half a period later, would follow
         return
      end do
      call add_up_to(target)
      if (passage%found) then
         last%orbit%tangent = passage%onward
         call add_up_to(next)
      end if
      walk%is_over = at_end .or. walk%n_ordinary > 2 .and. comes_by(model, options, walk%now, target%arclength, walk%first)
      walk%before = walk%now%orbit
      walk%past = before_end(walk%past, points)
      if (passage%found) deallocate (walk%before%tangent) ! the curve restarts
      walk%now = next
      walk%n_ordinary = walk%n_ordinary + 1
      walk%is_over = walk%is_over .or. walk%n_ordinary >= options%most_points

   contains

      !> Add a point, and before it the orbits at the requested values.
      subroutine add_up_to(point)
         type(branch_point), intent(in) :: point
         type(branch_point), allocatable :: between(:)

         if (allocated(options%values)) then
            call find_orbits_at(model, options%orbits, options%values, before, past, last, point, options%recorder, n_used, between)
            points = [points, between]
         end if
         points = [points, point]
         if (allocated(before%tangent)) deallocate (before%tangent) ! a special point may be a corner
         past = [branch_point ::]
         if (point%kind == kind_grazing) past = [point]
         last = point
      end subroutine add_up_to

   end subroutine advance_branch

   !> Last few points of a branch before its end, on the smooth part, and the grazing point (touch) before these, if there is one.
   pure function before_end(known, points) result(last)
      type(branch_point), intent(in) :: known(:)  !! points before the first one of `points`
      type(branch_point), intent(in) :: points(:) !! the last one is the end
      type(branch_point), allocatable :: last(:)
      integer, parameter :: most = 8
      integer :: first, n

      last = [known, points(:size(points) - 1)]
      n = size(last)
      first = max(findloc(last%kind /= kind_ordinary, .true., 1, back=.true.), findloc(last%begins_anew, .true., 1, back=.true.), 1)
      associate (begin => max(first, n - most + 1))
         if (n == 0) return
         if (last(first)%kind == kind_grazing) then
            last = [last(first), last(max(first + 1, begin):)]
         else if (last(first)%kind == kind_ordinary) then
            last = last(begin:)
         else
            last = last(max(first + 1, begin):)
         end if
      end associate
   end function before_end

   !> Whether a step passes the first point of the branch again.
   pure logical function comes_by(model, options, now, arclength, first)
      class(orbit_model), intent(in) :: model
      type(branch_options), intent(in) :: options
      type(branch_point), intent(in) :: now, first
      real(wp), intent(in) :: arclength
      real(wp), parameter :: beside = 0.1_wp, alike = 0.9_wp !! relative to the step; cosine of the angle between tangents
      real(wp) :: to_first(model%n + 2), along

      to_first = chord_to(model, options%orbits, now%orbit, first%orbit)
      along = dot_product(to_first, now%orbit%tangent)
      comes_by = along > 0 .and. along <= arclength .and. norm2(to_first - along*now%orbit%tangent) <= beside*arclength &
                 .and. dot_product(now%orbit%tangent, first%orbit%tangent) > alike
   end function comes_by

   !> Compute the next point of a branch, at most a step ahead, or behind a grazing point at which the branch is not smooth.
   subroutine go_on(model, options, before, now, next, step, is_smooth, passage, status)
      class(orbit_model), intent(inout) :: model
      type(branch_options), intent(in) :: options
      type(orbit_t), intent(in) :: before, now !! with tangents; `before` has none if there is no such orbit
      type(branch_point), intent(out) :: next
      real(wp), intent(inout) :: step          !! in: step to try; out: step to try next
      logical, intent(inout) :: is_smooth      !! the cubic through the last orbits predicted the last step better than the tangent
      type(grazing_passage), intent(out) :: passage
      type(status_t), intent(inout) :: status
      real(wp), parameter :: ahead = 16 !! failed steps: range of the search for a grazing point, behind which steps are short
      integer, parameter :: easy = 3, hard = 8 !! iterations
      integer, parameter :: most_damped = 2    !! beyond these, the predicted orbit is behind a corner, or there is none
      real(wp), parameter :: turn = 0.95_wp, little_turn = 0.99_wp, no_turn = 0.9999_wp !! cosine of the angle between tangents
      type(status_t) :: refusal
      type(orbit_options) :: few
      type(curve_t) :: cubic, straight_on
      type(orbit_t) :: nothing
      real(wp) :: longest, straight

      few = options%orbits
      few%most_iterations = hard
      few%most_damped = most_damped
      longest = max(options%largest_step, options%straight_step)
      associate (change => abs(now%tangent(model%n + 2)))
         if (change*longest > options%largest_change) longest = options%largest_change/change
      end associate
      step = min(step, longest)
      cubic = curve_through(model, options%orbits, now, before)
      straight_on = curve_through(model, options%orbits, now, nothing)
      do
         if (is_smooth) then
            call orbit_on_curve(model, options%orbits, cubic, now, step, next%orbit)
         else
            call orbit_on_curve(model, options%orbits, straight_on, now, step, next%orbit)
         end if
         if (step < 2*options%smallest_step) few = options%orbits
         call clear(refusal)
         call correct_orbit(model, few, next%orbit, refusal, now%tangent, far=now%iterations >= easy)
         if (.not. has_failed(refusal)) call find_tangent(model, options%orbits, next%orbit, now%tangent, refusal)
         straight = -1
         if (.not. has_failed(refusal)) straight = dot_product(now%tangent, next%orbit%tangent)
         if (straight >= turn .and. next%orbit%iterations <= hard) exit
         if (.not. passage%looked) call look_for_grazing(model, options, before, now, min(ahead*step, options%largest_step), &
                                                         [integer ::], passage)
         if (passage%found) then
            next = passage%next
            step = next%arclength
            is_smooth = .true.
            return
         end if
         if (step < 2*options%smallest_step) then
            if (straight > 0) exit ! a corner, such as where two events change their order
            status = refusal
            return
         end if
         step = step/2
         is_smooth = .false.
      end do
      next%arclength = step
      is_smooth = prediction_error(model, options%orbits, cubic, now, next%orbit, step) &
                  < prediction_error(model, options%orbits, straight_on, now, next%orbit, step)
      if (straight < no_turn) longest = min(longest, options%largest_step)
      if (next%orbit%iterations <= easy .and. straight >= little_turn) step = 1.5_wp*step
      step = min(step, longest)
   end subroutine go_on

   !> Search for a grazing point ahead, within the parameter range, and continue behind it.
   subroutine look_for_grazing(model, options, before, now, reach, smooth, passage)
      class(orbit_model), intent(inout) :: model
      type(branch_options), intent(in) :: options
      type(orbit_t), intent(in) :: before, now !! as in go_on
      real(wp), intent(in) :: reach
      integer, intent(in) :: smooth(:)         !! as in pass_grazing
      type(grazing_passage), intent(out) :: passage

      call pass_grazing(model, options%orbits, now, curve_through(model, options%orbits, now, before), reach, &
                        [10*options%smallest_step, options%first_step], smooth, passage)
      if (.not. passage%found) return
      associate (p => passage%grazing%orbit%parameter)
         passage%found = p >= options%from .and. p <= options%to
      end associate
   end subroutine look_for_grazing

   !> Append a point to a list with spare capacity.
   subroutine append_point(points, n, point)
      type(branch_point), allocatable, intent(inout) :: points(:)
      integer, intent(inout) :: n
      type(branch_point), intent(in) :: point
      type(branch_point), allocatable :: longer(:)

      if (n == size(points)) then
         allocate (longer(2*n))
         longer(:n) = points
         call move_alloc(longer, points)
      end if
      n = n + 1
      points(n) = point
   end subroutine append_point

   !> Compute the last point, where the parameter leaves its range.
   subroutine stop_at_bound(model, options, now, next, status)
      class(orbit_model), intent(inout) :: model
      type(branch_options), intent(in) :: options
      type(orbit_t), intent(in) :: now
      type(branch_point), intent(inout) :: next !! in: beyond the bound; out: on it
      type(status_t), intent(inout) :: status
      type(corrections_t) :: nothing
      type(orbit_t) :: predicted
      real(wp) :: bound

      associate (orbit => next%orbit)
         bound = merge(options%to, options%from, orbit%parameter >= options%to)
         call orbit_at_value(model, options%orbits, curve_through(model, options%orbits, now, orbit), nothing, now, orbit, bound, &
                             predicted)
         orbit = predicted
         call correct_orbit(model, options%orbits, orbit, status)
         if (.not. has_failed(status)) call find_tangent(model, options%orbits, orbit, now%tangent, status)
         next%arclength = dot_product(now%tangent(:model%n), (orbit%y - now%y)/model%scale) &
                          + now%tangent(model%n + 2)*(orbit%parameter - now%parameter)/options%orbits%parameter_scale
         if (model%autonomous) next%arclength = next%arclength + now%tangent(model%n + 1)*(orbit%period/now%period - 1)
      end associate
   end subroutine stop_at_bound

end module evl_branch
