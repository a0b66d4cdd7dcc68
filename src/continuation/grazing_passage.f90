!> Continuation past a grazing orbit, at which a root function just touches zero, if a force jumps or has a corner there.
!>
!> The mode behind the grazing point lasts for s. Its effect on the flow is that of a force times s, and s is the square root
!> of how far the root function passes zero. With theta, which passes zero at grazing, its gradient g, and s = sqrt(-theta),
!>
!>     theta > 0:    (D - 1) dy + dP/dp dp          = 0    orbits on one side: tangent t
!>     theta < 0:    (D - 1) dy + dP/dp dp + c s    = 0
!>                   g_y dy + g_p dp                = 0    on the other side: du = b s
!>
!> with D and dP/dp of the grazing orbit, without the mode behind. s and the orbit are smooth along the branch, so that each half
!> has a tangent; the derivative of the flow behind the grazing point grows as 1/s. Newton's iteration for the grazing orbit
!> therefore uses orbits before it, where the flow is smooth. If b turns back in the parameter, the grazing point is a fold.
!>
!> If a force begins without a jump, and acts only while flanks approach, as that of a damper that does not pull, its effect
!> is proportional to s**2 = -theta: the flow has a corner, with the derivative D - c g behind it, and
!>
!>     theta < 0:    (D - 1) dy + dP/dp dp + c s**2 = 0
!>                   g_y dy + g_p dp                = -s**2
!>
!> Newton's iteration may not pass such a corner: from each side it leads to the other one.
!>
!> The second line is the leading order of the square-root map: A. B. Nordmark, J. Sound Vib. 145 (1991) 279-297;
!> M. di Bernardo, C. J. Budd, A. R. Champneys, P. Kowalczyk, Piecewise-smooth Dynamical Systems, Springer 2008, ch. 6 and 7.
!> The iteration was derived here.
module evl_grazing_passage
   use evl_branch_curve, only: chord_to, curve_t
   use evl_branch_point, only: branch_point, kind_grazing, kind_grazing_fold
   use evl_grazing_orbit, only: find_grazing_orbit, grazing_t, theta_of
   use evl_kinds, only: wp
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: closure_defect, go_round, move_orbit, orbit_options, orbit_t
   use evl_shooting, only: correct_orbit
   use evl_shooting_system, only: find_tangent, solve_along
   use evl_status, only: clear, has_failed, status_t
   implicit none (type, external)
   private

   public :: pass_grazing, grazing_passage

   !> Branch at a grazing point.
   type :: grazing_passage
      logical :: looked = .false.         !! a grazing point was detected ahead
      logical :: found = .false.
      logical :: from_behind = .false.    !! the branch comes from where the root function is crossed
      type(branch_point) :: grazing         !! with the tangent of the incoming branch
      real(wp), allocatable :: onward(:)  !! [n + 2] tangent of the outgoing branch
      type(branch_point) :: next          !! first ordinary point behind it; its way is that from the grazing point
   end type grazing_passage

contains

   !> Search for a grazing point ahead, and for the branch behind it.
   subroutine pass_grazing(model, options, now, curve, reach, steps, smooth, passage)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: now            !! with a tangent
      type(curve_t), intent(in) :: curve          !! predicted branch ahead
      real(wp), intent(in) :: reach               !! length of the search
      real(wp), intent(in) :: steps(2)            !! shortest and longest step from the grazing point to the next point
      integer, intent(in) :: smooth(:)            !! root functions whose grazing is known to be without a jump
      type(grazing_passage), intent(out) :: passage !! not found: there is none, or the branch is smooth there
      type(grazing_t) :: grazing
      type(orbit_t) :: grazing_orbit
      real(wp) :: before_it(model%n + 2), behind_it(model%n + 2), s_per_arclength
      integer :: power
      logical :: found

      call find_grazing_orbit(model, options, now, curve, reach, smooth, grazing, grazing_orbit, found)
      passage%looked = grazing%root > 0
      if (found) call find_halves(model, options, grazing, grazing_orbit, before_it, behind_it, power, s_per_arclength, found)
      if (.not. found) return
      passage%from_behind = grazing%from_behind
      if (grazing%from_behind) then
         grazing_orbit%tangent = -behind_it
         passage%onward = before_it
      else
         grazing_orbit%tangent = -before_it
         passage%onward = behind_it
      end if
      if (.not. leads_to(model, options, now, grazing_orbit, grazing%arclength)) return
      call step_off(model, options, grazing, grazing_orbit, passage%onward, power, s_per_arclength, steps, passage%next, found)
      passage%grazing%orbit = grazing_orbit
      passage%grazing%root = grazing%root
      passage%grazing%kind = kind_grazing
      if (grazing_orbit%tangent(model%n + 2)*passage%onward(model%n + 2) < 0) passage%grazing%kind = kind_grazing_fold
      passage%grazing%arclength = dot_product(now%tangent, chord_to(model, options, now, grazing_orbit))
      passage%found = found
   end subroutine pass_grazing

   !> Tangents of both halves, away from the grazing point; c is estimated from flows a little beyond it. Equations O6, O7.
   subroutine find_halves(model, options, grazing, grazing_orbit, before_it, behind_it, power, s_per_arclength, found)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(grazing_t), intent(in) :: grazing
      type(orbit_t), intent(inout) :: grazing_orbit
      real(wp), intent(out) :: before_it(:), behind_it(:) !! [n + 2]
      integer, intent(out) :: power                       !! of s, with which the flow and the way behind the grazing point grow
      real(wp), intent(out) :: s_per_arclength            !! that power of s over the way along the tangent behind the grazing point
      logical, intent(out) :: found                       !! false: there is no jump
      real(wp), parameter :: beyond(2) = [4.0e-7_wp, 1.0e-7_wp]
      real(wp), parameter :: most_growth(2) = [3, 6] !! from one to the other: 2 for s, 4 for its square, 8 for smooth parts
      type(status_t) :: refusal
      real(wp) :: part(model%n, 2), smooth(model%n), depth, beyond_it
      integer :: i

      found = .false.
      before_it = 0
      behind_it = 0
      s_per_arclength = 0
      power = 1
      call clear(refusal)
      call find_tangent(model, options, grazing_orbit, grazing%gradient, refusal)
      if (has_failed(refusal)) return
      before_it = grazing_orbit%tangent
      do i = 1, 2
         call look_behind(beyond(i), part(:, i), smooth, depth, refusal)
         if (has_failed(refusal) .or. .not. depth > 0) return
      end do
      if (norm2(part(:, 2)) < norm2(smooth)) return
      if (norm2(part(:, 1)) > most_growth(1)*norm2(part(:, 2))) power = 2
      if (norm2(part(:, 1)) > most_growth(power)*norm2(part(:, 2))) return
      beyond_it = merge(1.0_wp, norm2(grazing%gradient), power == 1)
      behind_it(:model%n) = -part(:, 2)*(beyond_it/depth**power)
      if (power == 2) behind_it(model%n + 2) = -beyond_it
      call solve_along(model, options, grazing_orbit, grazing%gradient, behind_it, refusal)
      if (has_failed(refusal)) return
      s_per_arclength = beyond_it/norm2(behind_it)
      behind_it = behind_it/norm2(behind_it)
      found = .true.

   contains

      !> Part of a flow behind the grazing point that is not smooth.
      subroutine look_behind(distance, part, smooth, depth, status)
         real(wp), intent(in) :: distance
         real(wp), intent(out) :: part(:), smooth(:) !! in units of the scales
         real(wp), intent(out) :: depth              !! s; 0: the function does not reach zero
         type(status_t), intent(inout) :: status
         type(orbit_t) :: behind
         real(wp) :: change(model%n + 2)

         depth = 0
         behind = grazing_orbit
         change = -distance*grazing%gradient/norm2(grazing%gradient)
         call move_orbit(model, options, behind, change)
         call go_round(model, options, behind, status)
         if (has_failed(status)) return
         if (behind%flow%crossings(grazing%root) > grazing%fewer) &
            ! event times are less accurate
            depth = sqrt(max(0.0_wp, distance*norm2(grazing%gradient) - theta_of(grazing, grazing_orbit)))
         associate (n => model%n)
            smooth = matmul(grazing_orbit%flow%derivative, change(:n)*model%scale) - change(:n)*model%scale &
                     + grazing_orbit%by_parameter*change(n + 2)*options%parameter_scale
            part = closure_defect(model, behind) - closure_defect(model, grazing_orbit) - smooth
         end associate
         smooth = merge(smooth/model%scale, 0.0_wp, grazing_orbit%active)
         part = merge(part/model%scale, 0.0_wp, grazing_orbit%active)
      end subroutine look_behind

   end subroutine find_halves

   !> Whether a grazing orbit lies ahead, where it was detected.
   pure logical function leads_to(model, options, now, grazing_orbit, seen)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: now, grazing_orbit
      real(wp), intent(in) :: seen              !! estimated way to it
      real(wp), parameter :: ahead = 0.5_wp     !! cosine of an angle
      real(wp) :: chord(model%n + 2)

      chord = chord_to(model, options, now, grazing_orbit)
      leads_to = dot_product(now%tangent, grazing_orbit%tangent) > 0 .and. & ! a branch turns fast behind a grazing point
                 now%tangent(model%n + 2)*grazing_orbit%tangent(model%n + 2) > 0 .and. & ! but a fold must be found first
                 norm2(chord) <= 2*seen .and. dot_product(chord, now%tangent) > ahead*norm2(chord)
   end function leads_to

   !> First point behind a grazing point, as far away as the branch is nearly straight: multipliers grow towards the grazing point.
   subroutine step_off(model, options, grazing, grazing_orbit, onward, power, s_per_arclength, steps, next, found)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(grazing_t), intent(in) :: grazing
      type(orbit_t), intent(in) :: grazing_orbit
      integer, intent(in) :: power
      real(wp), intent(in) :: onward(:), s_per_arclength, steps(2)
      type(branch_point), intent(out) :: next
      logical, intent(out) :: found
      real(wp), parameter :: alike = 0.9_wp, beside = 0.5_wp
      type(status_t) :: refusal
      type(orbit_t) :: start
      real(wp) :: arclength

      found = .false.
      arclength = steps(2)
      do while (arclength >= steps(1))
         start = grazing_orbit
         call move_orbit(model, options, start, arclength*onward)
         call clear(refusal)
         if (.not. grazing%from_behind) then
            call push_behind(model, options, grazing, (arclength*s_per_arclength)**(2/power), start, refusal)
            if (allocated(start%by_parameter)) deallocate (start%by_parameter) ! that before the grazing point
         end if
         next%orbit = start
         if (.not. has_failed(refusal)) call correct_orbit(model, options, next%orbit, refusal, onward)
         if (.not. has_failed(refusal)) call find_tangent(model, options, next%orbit, onward, refusal)
         if (.not. has_failed(refusal)) then
            next%arclength = dot_product(onward, chord_to(model, options, grazing_orbit, next%orbit))
            found = (next%orbit%flow%crossings(grazing%root) == grazing%fewer .eqv. grazing%from_behind) .and. &
                    dot_product(onward, next%orbit%tangent) > alike .and. &
                    norm2(chord_to(model, options, start, next%orbit)) < beside*arclength
         end if
         if (found) return
         arclength = arclength/2
      end do
   end subroutine step_off

   !> Move the start of an orbit across the grazing point until theta has its value on the branch there.
   subroutine push_behind(model, options, grazing, depth, start, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(grazing_t), intent(in) :: grazing
      real(wp), intent(in) :: depth        !! -theta
      type(orbit_t), intent(inout) :: start
      type(status_t), intent(inout) :: status
      integer, parameter :: most_pushes = 6
      real(wp), parameter :: near = 0.1_wp
      real(wp) :: theta
      integer :: i

      do i = 1, most_pushes
         call go_round(model, options, start, status)
         if (has_failed(status)) return
         theta = theta_of(grazing, start)
         if (abs(theta) > huge(theta)/2 .or. abs(theta + depth) < near*depth) return
         call move_orbit(model, options, start, -(theta + depth)*grazing%gradient/sum(grazing%gradient**2))
      end do
   end subroutine push_behind

end module evl_grazing_passage
