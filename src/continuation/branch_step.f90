!> One step of the continuation of a branch.
!>
!> The step is halved if Newton's iteration fails or the branch turns too much in it, and grows if convergence is fast. It is
!> shortened if it jumps to another branch.
module evl_branch_step
   use evl_branch_curve, only: curve_t, curve_through, orbit_at_value, orbit_on_curve, prediction_error
   use evl_branch_point, only: branch_point, kind_grazing, orbit_recorder
   use evl_grazing_passage, only: grazing_passage, pass_grazing
   use evl_indices, only: indices
   use evl_kinds, only: wp
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: orbit_options, orbit_t
   use evl_shooting, only: correct_orbit
   use evl_shooting_system, only: find_tangent
   use evl_special_points, only: find_special_points
   use evl_status, only: clear, code_no_solution, fail, has_failed, quantity, status_t
   implicit none (type, external)
   private

   public :: branch_options, branch_step, branch_state
   public :: count_crawls, settle_step, try_step

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
   type :: branch_state
      type(branch_point) :: first, now !! ordinary points: the first one and the last one
      type(orbit_t) :: before          !! of the point before the last; without a tangent if there is none
      real(wp) :: step = 0             !! step to try next
      integer :: crawls = 0            !! consecutive steps without progress
      integer :: n_ordinary = 0        !! number of ordinary points
      logical :: is_smooth = .true.    !! the cubic through the last two points predicted the last step better than the tangent
      logical :: is_over = .false.
   end type branch_state

   !> One step of a branch.
   type :: branch_step
      type(branch_point) :: next     !! point at its end
      type(grazing_passage) :: passage !! a grazing point in it at which the branch is not smooth
      type(branch_point) :: target   !! end of its smooth part: that grazing point, else `next`
      type(branch_point), allocatable :: special(:) !! special points up to the target
      logical :: at_end = .false.    !! it ends at a bound of the parameter
   end type branch_step

contains

   !> `go_on` from the last point.
   subroutine try_step(model, options, walk, step, status)
      class(orbit_model), intent(inout) :: model
      type(branch_options), intent(in) :: options
      type(branch_state), intent(inout) :: walk
      type(branch_step), intent(inout) :: step
      type(status_t), intent(inout) :: status

      call go_on(model, options, walk%before, walk%now%orbit, step%next, walk%step, walk%is_smooth, step%passage, status)
   end subroutine try_step

   !> Count consecutive steps without progress; fail if they are too many.
   subroutine count_crawls(options, walk, next, status)
      type(branch_options), intent(in) :: options
      type(branch_state), intent(inout) :: walk
      type(branch_point), intent(in) :: next
      type(status_t), intent(inout) :: status
      real(wp), parameter :: crawling = 0.01_wp   !! step over the first one below which there is no progress
      integer, parameter :: most_crawls = 60      !! consecutive steps of that kind

      walk%crawls = merge(walk%crawls + 1, 0, next%arclength < crawling*options%first_step)
      if (walk%crawls > most_crawls) &
         call fail(status, code_no_solution, "the step of the branch decreases without limit at "// &
                   quantity(next%orbit%parameter, "")//", where events coincide", field="parameter")
   end subroutine count_crawls

   !> Find the special points in a step; shorten it until it does not jump to another branch and misses no grazing point.
   subroutine settle_step(model, options, walk, step, status)
      class(orbit_model), intent(inout) :: model
      type(branch_options), intent(in) :: options
      type(branch_state), intent(inout) :: walk
      type(branch_step), intent(inout) :: step
      type(status_t), intent(inout) :: status
      real(wp), parameter :: little = 1.0e-3_wp, same = 1.0e-8_wp !! discontinuity over the step
      logical :: is_missed
      real(wp) :: leap

      do
         call set_target(model, options, walk, step, status)
         if (has_failed(status)) return
         leap = 0
         is_missed = .false.
         if (step%passage%found .and. step%passage%from_behind) then ! multipliers jump: their test functions are meaningless
            step%special = [branch_point ::]
         else
            call find_special_points(model, options%orbits, walk%now%orbit, step%target%orbit, step%target%arclength, &
                                     step%special, leap, is_missed, status)
            if (has_failed(status)) return
         end if
         if (step%passage%found .or. (leap < little .and. .not. is_missed)) return
         ! if the orbits on both sides of a grazing point that was found coincide, there is no jump
         call look_for_grazing(model, options, walk%before, walk%now%orbit, step%target%arclength, &
                               step%special(indices(step%special%kind == kind_grazing .and. leap <= same))%root, step%passage)
         if (step%passage%found) then
            step%next = step%passage%next
            walk%step = step%next%arclength
         else if (leap >= little .and. &
                  step%target%arclength > merge(100*options%smallest_step, options%first_step, leap < huge(leap))) then
            walk%step = step%target%arclength/4 ! the two orbits belong to different branches, or more points lie between them
            call try_step(model, options, walk, step, status)
            if (has_failed(status)) return
         else
            return
         end if
      end do
   end subroutine settle_step

   !> Set the target of a step, and end it at a bound of the parameter.
   subroutine set_target(model, options, walk, step, status)
      class(orbit_model), intent(inout) :: model
      type(branch_options), intent(in) :: options
      type(branch_state), intent(in) :: walk
      type(branch_step), intent(inout) :: step
      type(status_t), intent(inout) :: status
      type(orbit_t) :: last

      step%at_end = step%next%orbit%parameter <= options%from .or. step%next%orbit%parameter >= options%to
      last = walk%now%orbit
      if (step%passage%found) then
         step%target = step%passage%grazing
         last = step%target%orbit
         last%tangent = step%passage%onward
      end if
      if (step%at_end) call stop_at_bound(model, options, last, step%next, status)
      if (.not. step%passage%found) step%target = step%next
   end subroutine set_target

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

   !> Compute the last point, where the parameter leaves its range.
   subroutine stop_at_bound(model, options, now, next, status)
      class(orbit_model), intent(inout) :: model
      type(branch_options), intent(in) :: options
      type(orbit_t), intent(in) :: now
      type(branch_point), intent(inout) :: next !! in: beyond the bound; out: on it
      type(status_t), intent(inout) :: status
      type(orbit_t) :: predicted
      real(wp) :: bound

      associate (orbit => next%orbit)
         bound = merge(options%to, options%from, orbit%parameter >= options%to)
         call orbit_at_value(model, options%orbits, curve_through(model, options%orbits, now, orbit), now, orbit, bound, &
                             predicted)
         orbit = predicted
         call correct_orbit(model, options%orbits, orbit, status)
         if (.not. has_failed(status)) call find_tangent(model, options%orbits, orbit, now%tangent, status)
         next%arclength = dot_product(now%tangent(:model%n), (orbit%y - now%y)/model%scale) &
                          + now%tangent(model%n + 2)*(orbit%parameter - now%parameter)/options%orbits%parameter_scale
         if (model%autonomous) next%arclength = next%arclength + now%tangent(model%n + 1)*(orbit%period/now%period - 1)
      end associate
   end subroutine stop_at_bound

end module evl_branch_step
