!> Grazing orbit ahead on a branch, at which a root function just touches zero, computed from before it, where the flow is smooth.
!>
!> theta, which passes zero at grazing, is an additional equation. A branch that comes from behind the grazing point is
!> extrapolated to the zero of theta, and the iteration begins a little before it.
!>
!> The iteration was derived here.
module evl_grazing_orbit
   use evl_branch_curve, only: curve_t, orbit_on_curve
   use evl_branch_tests, only: grazing_test
   use evl_kinds, only: wp
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: go_round, move_orbit, orbit_options, orbit_t
   use evl_shooting, only: correct_orbit
   use evl_shooting_system, only: differentiate_by_parameter, right_hand_side, solve_along
   use evl_status, only: clear, has_failed, status_t
   implicit none (type, external)
   private

   public :: find_grazing_orbit, theta_of, grazing_t

   !> A grazing point under consideration.
   type :: grazing_t
      integer :: root = 0
      integer :: fewer = 0           !! crossings of the root function where it does not reach zero
      real(wp) :: arclength = 0            !! estimated way to it
      logical :: from_behind = .false. !! the branch comes from where the root function is crossed
      real(wp), allocatable :: gradient(:) !! [n + 2] of theta by the unknowns in units of their scales
   end type grazing_t

contains

   !> Search for a grazing point ahead, and for its orbit.
   subroutine find_grazing_orbit(model, options, now, curve, reach, smooth, grazing, grazing_orbit, found)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: now         !! with a tangent
      type(curve_t), intent(in) :: curve       !! predicted branch ahead
      real(wp), intent(in) :: reach            !! length of the search
      integer, intent(in) :: smooth(:)         !! root functions whose grazing is known to be without a jump
      type(grazing_t), intent(out) :: grazing      !! root = 0: there is none ahead
      type(orbit_t), intent(out) :: grazing_orbit
      logical, intent(out) :: found
      type(orbit_t) :: start

      found = .false.
      call look_ahead(model, options, now, reach, grazing)
      if (grazing%root == 0 .or. any(smooth == grazing%root)) return
      call find_gradient(model, options, now, grazing, found)
      if (found) call find_start(model, options, now, curve, grazing, start, found)
      if (found) call close_in(model, options, start, grazing, grazing_orbit, found)
   end subroutine find_grazing_orbit

   !> Root function that touches zero next along the tangent: theta falls linearly before grazing, its square root behind it.
   subroutine look_ahead(model, options, now, reach, grazing)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: now
      real(wp), intent(in) :: reach
      type(grazing_t), intent(out) :: grazing
      real(wp), parameter :: share = 0.02_wp !! of the length of the search
      type(orbit_t) :: further
      type(status_t) :: refusal
      real(wp) :: arclength
      integer :: root

      further = now
      call move_orbit(model, options, further, share*reach*now%tangent)
      call clear(refusal)
      call go_round(model, options, further, refusal)
      if (has_failed(refusal)) return
      grazing%arclength = reach
      do root = 1, model%n_roots
         if (further%flow%crossings(root) /= now%flow%crossings(root)) cycle
         arclength = arclength_to_zero(now%flow%nearest(root), further%flow%nearest(root))
         if (arclength < grazing%arclength) call take(.false.)
         arclength = arclength_to_zero(sqrt(now%flow%slowest(root)), sqrt(further%flow%slowest(root)))
         if (arclength < grazing%arclength) call take(.true.)
      end do

   contains

      subroutine take(from_behind)
         logical, intent(in) :: from_behind

         grazing%root = root
         grazing%arclength = arclength
         grazing%from_behind = from_behind
         grazing%fewer = now%flow%crossings(root) - merge(1, 0, from_behind)
      end subroutine take

      pure real(wp) function arclength_to_zero(here, there) result(zero)
         real(wp), intent(in) :: here, there

         zero = huge(zero)
         if (here < sqrt(huge(here))/2 .and. here > there) zero = share*reach*here/(here - there)
      end function arclength_to_zero

   end subroutine look_ahead

   !> Gradient of theta at an orbit, by differences towards larger |theta|, or with little change.
   subroutine find_gradient(model, options, orbit, grazing, found)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit
      type(grazing_t), intent(inout) :: grazing
      logical, intent(out) :: found
      real(wp), parameter :: sizes(6) = [1.0e-6_wp, -1.0e-6_wp, 1.0e-7_wp, -1.0e-7_wp, 1.0e-8_wp, -1.0e-8_wp]
      real(wp), parameter :: little = 0.1_wp
      type(orbit_t) :: moved
      type(status_t) :: refusal
      real(wp) :: change(model%n + 2), here, there
      integer :: i, k

      grazing%gradient = [(0.0_wp, i=1, model%n + 2)]
      here = theta_of(grazing, orbit)
      there = here
      do k = 1, model%n + 2
         if (k <= model%n) then
            if (.not. orbit%active(k)) cycle
         end if
         if (k == model%n + 1) cycle ! the end of an orbit does not affect the events on it
         found = .false.
         do i = 1, size(sizes)
            moved = orbit
            change = 0
            change(k) = sizes(i)
            call move_orbit(model, options, moved, change)
            call clear(refusal)
            call go_round(model, options, moved, refusal)
            if (has_failed(refusal)) cycle
            if (any(moved%flow%crossings /= orbit%flow%crossings)) cycle
            there = theta_of(grazing, moved)
            found = abs(there) > abs(here) .or. abs(there - here) < little*abs(here)
            if (found) exit
         end do
         if (.not. found) return
         grazing%gradient(k) = (there - here)/sizes(i)
      end do
      found = norm2(grazing%gradient) > 0
   end subroutine find_gradient

   !> Flow near the grazing orbit, before grazing.
   subroutine find_start(model, options, now, curve, grazing, start, found)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: now
      type(curve_t), intent(in) :: curve
      type(grazing_t), intent(inout) :: grazing
      type(orbit_t), intent(out) :: start
      logical, intent(out) :: found
      integer, parameter :: most_pushes = 20
      type(status_t) :: refusal
      real(wp) :: beyond, margin
      integer :: i

      start = now
      found = .true.
      if (.not. grazing%from_behind) return
      found = .false.
      call orbit_on_curve(model, options, curve, now, grazing%arclength, start)
      margin = 0.01_wp*now%flow%slowest(grazing%root)
      do i = 1, most_pushes
         call clear(refusal)
         call go_round(model, options, start, refusal)
         if (has_failed(refusal)) return
         beyond = 0
         if (start%flow%crossings(grazing%root) >= now%flow%crossings(grazing%root)) then
            beyond = start%flow%slowest(grazing%root)
         else if (start%flow%nearest(grazing%root) < huge(beyond)) then
            found = .true.
            exit
         end if
         call move_orbit(model, options, start, (beyond + margin)*grazing%gradient/sum(grazing%gradient**2))
         margin = 2*margin
      end do
      grazing%fewer = start%flow%crossings(grazing%root)
   end subroutine find_start

   !> Grazing orbit by Newton's iteration with theta as the last row: theta falls to a tenth in each step, so that the
   !> iteration remains before grazing.
   subroutine close_in(model, options, start, grazing, grazing_orbit, found)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: start
      type(grazing_t), intent(inout) :: grazing
      type(orbit_t), intent(out) :: grazing_orbit
      logical, intent(out) :: found
      integer, parameter :: most_iterations = 40, most_halvings = 8
      real(wp), parameter :: near = 1.0e-10_wp   !! distance from grazing, in units of the scales
      type(orbit_t) :: trial
      type(status_t) :: refusal
      real(wp) :: change(model%n + 2), theta, last_theta, share
      integer :: halving, iteration

      found = .false.
      grazing_orbit = start
      if (allocated(grazing_orbit%tangent)) deallocate (grazing_orbit%tangent)
      do iteration = 1, most_iterations
         last_theta = near*norm2(grazing%gradient)
         theta = theta_of(grazing, grazing_orbit)
         if (grazing_orbit%residual <= options%residual .and. theta <= 2*last_theta) exit
         if (iteration == most_iterations) return
         call clear(refusal)
         call differentiate_by_parameter(model, options, grazing_orbit, refusal)
         change = right_hand_side(model, grazing_orbit)
         change(model%n + 2) = max(0.1_wp*theta, last_theta) - theta
         if (.not. has_failed(refusal)) call solve_along(model, options, grazing_orbit, grazing%gradient, change, refusal)
         if (has_failed(refusal)) return
         share = 1
         do halving = 0, most_halvings
            trial = grazing_orbit
            call clear(refusal)
            call move_orbit(model, options, trial, share*change)
            call go_round(model, options, trial, refusal)
            if (.not. has_failed(refusal)) then
               if (trial%flow%crossings(grazing%root) == grazing%fewer .and. trial%flow%nearest(grazing%root) < huge(theta)) exit
            end if
            if (halving == most_halvings) return
            share = share/2
         end do
         grazing%gradient = grazing%gradient + (theta_of(grazing, trial) - theta - share*dot_product(grazing%gradient, change)) &
                            *change/(share*sum(change**2)) ! secant
         grazing_orbit = trial
      end do
      call clear(refusal)
      call correct_orbit(model, options, grazing_orbit, refusal) ! for its multipliers; no correction remains
      found = .not. has_failed(refusal) .and. grazing_orbit%flow%crossings(grazing%root) == grazing%fewer
   end subroutine close_in

   !> Test function theta of an orbit: distance of the root function from touching zero.
   pure real(wp) function theta_of(grazing, orbit) result(theta)
      type(grazing_t), intent(in) :: grazing
      type(orbit_t), intent(in) :: orbit

      theta = grazing_test(orbit, grazing%root, grazing%fewer)
   end function theta_of

end module evl_grazing_orbit
