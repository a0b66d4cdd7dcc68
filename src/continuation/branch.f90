!> Continuation of branches of periodic orbits in a parameter, through folds.
!>
!> Pseudo-arclength continuation: a step along the tangent from a point, then Newton's iteration orthogonal to it.
!>
!> Sources: H. B. Keller, in: Applications of Bifurcation Theory, Academic Press 1977; R. Seydel, Practical Bifurcation and
!> Stability Analysis, 3rd ed., ch. 4 and 7.
module evl_branch
   use evl_branch_curve, only: chord_to
   use evl_branch_doubling, only: repeats_sooner
   use evl_branch_point, only: branch_point, kind_fold, kind_grazing, kind_ordinary
   use evl_branch_step, only: branch_options, branch_step, branch_state, count_crawls, settle_step, try_step
   use evl_branch_values, only: find_orbits_at
   use evl_kinds, only: wp
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: orbit_t
   use evl_shooting_system, only: find_tangent
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t
   implicit none (type, external)
   private

   public :: branch_options, branch_state
   public :: advance_branch, begin_branch, follow_branch, append_point

contains

   !> Continue the branch of an orbit until the parameter leaves its range, the branch closes, or the number of points is
   !> reached. A branch of doubled period ends where the two halves of its orbits coincide.
   subroutine follow_branch(model, options, orbit, points, status)
      class(orbit_model), intent(inout) :: model
      type(branch_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit     !! converged; its tangent, if it has one, is the direction
      type(branch_point), allocatable, intent(out) :: points(:) !! on failure: those found before
      type(status_t), intent(inout) :: status
      type(branch_state) :: walk
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
      type(branch_state), intent(out) :: walk
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
      walk%step = options%first_step
      walk%n_ordinary = 1
      walk%is_over = walk%n_ordinary >= options%most_points
   end subroutine begin_branch

   !> Compute the next point of a branch, with the special points before it.
   subroutine advance_branch(model, options, walk, points, status)
      class(orbit_model), intent(inout) :: model
      type(branch_options), intent(in) :: options
      type(branch_state), intent(inout) :: walk
      type(branch_point), allocatable, intent(out) :: points(:) !! on failure: those found before
      type(status_t), intent(inout) :: status
      type(branch_step) :: step
      logical :: closes

      allocate (points(0))
      call try_step(model, options, walk, step, status)
      if (has_failed(status)) return
      call count_crawls(options, walk, step%next, status)
      if (has_failed(status)) return
      call settle_step(model, options, walk, step, status)
      if (has_failed(status)) return
      call collect_points(model, options, walk, step, points, closes, status)
      walk%is_over = closes ! only the same orbits, half a period later, would follow
      if (has_failed(status) .or. closes) return
      walk%is_over = step%at_end .or. walk%n_ordinary > 2 .and. comes_by(model, options, walk%now, step%target%arclength, &
                                                                         walk%first)
      walk%before = walk%now%orbit
      if (step%passage%found) deallocate (walk%before%tangent) ! the curve restarts
      walk%now = step%next
      walk%n_ordinary = walk%n_ordinary + 1
      walk%is_over = walk%is_over .or. walk%n_ordinary >= options%most_points
   end subroutine advance_branch

   !> List the points of a step in their order, with the orbits at the requested values between them.
   subroutine collect_points(model, options, walk, step, points, closes, status)
      class(orbit_model), intent(inout) :: model
      type(branch_options), intent(in) :: options
      type(branch_state), intent(in) :: walk
      type(branch_step), intent(inout) :: step
      type(branch_point), allocatable, intent(inout) :: points(:)
      logical, intent(out) :: closes !! the halves of the orbits coincide at a fold, where the points end
      type(status_t), intent(inout) :: status
      type(branch_point) :: last ! last point
      integer :: i, n_used

      n_used = 0
      last = walk%now
      closes = .false.
      do i = 1, size(step%special)
         call add_up_to(step%special(i))
         if (step%special(i)%kind /= kind_fold) cycle
         call repeats_sooner(model, options%orbits, step%special(i)%orbit, closes, status)
         if (closes .or. has_failed(status)) return
      end do
      call add_up_to(step%target)
      if (step%passage%found) then
         last%orbit%tangent = step%passage%onward
         call add_up_to(step%next)
      end if

   contains

      !> Add a point, and before it the orbits at the requested values.
      subroutine add_up_to(point)
         type(branch_point), intent(in) :: point
         type(branch_point), allocatable :: between(:)

         if (allocated(options%values)) then
            call find_orbits_at(model, options%orbits, options%values, last, point, options%recorder, n_used, between)
            points = [points, between]
         end if
         points = [points, point]
         last = point
      end subroutine add_up_to

   end subroutine collect_points

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

end module evl_branch
