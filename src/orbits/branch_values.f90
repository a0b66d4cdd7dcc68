!> Stable orbits of a branch at given values of the parameter: each is foreseen between its neighbours on the branch, and found
!> by Newton's iteration at that value.
!>
!> What the cubic between the neighbours lacks is w**2 (1 - w)**2 q(w), w from 0 to 1 between them, with a smooth q: the orbits
!> found so far between them tell q, by the polynomial through the last few, and the next orbits are foreseen the better.
module evl_branch_values
   use evl_branch_curve, only: curve_t, curve_through, orbit_on_curve, way_of_parameter, way_to
   use evl_kinds, only: wp
   use evl_orbit_model, only: orbit_model
   use evl_places, only: places
   use evl_shooting, only: correct_orbit, correct_with, move_orbit, orbit_options, orbit_t, own_multipliers
   use evl_special_points, only: branch_point
   use evl_status, only: clear, has_failed, status_t
   implicit none (type, external)
   private

   public :: find_orbits_at

   integer, parameter :: most_known = 4

   !> What a curve lacks at orbits that were found, over w**2 (1 - w)**2: the last few.
   type :: lacks_t
      integer :: n = 0
      real(wp) :: w(most_known) = 0
      real(wp), allocatable :: q(:, :) !! [n + 2, most_known]
   end type lacks_t

contains

   !> Those between two neighbouring points of a branch, in their order, where one of these is stable: what loses its stability
   !> between them is a point itself. One that Newton's iteration does not find beside where it was foreseen is left out.
   subroutine find_orbits_at(model, options, values, first, last, points)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      real(wp), intent(in) :: values(:)        !! rising
      type(orbit_t), intent(in) :: first, last !! with tangents; between them the parameter rises or falls
      type(branch_point), allocatable, intent(out) :: points(:)
      real(wp), parameter :: beside = 0.1_wp   !! of the way between the two
      type(curve_t) :: curve
      type(lacks_t) :: lacks
      type(orbit_t) :: before, foreseen
      type(status_t) :: refusal
      type(branch_point) :: found
      real(wp) :: longest, share
      integer, allocatable :: list(:)
      integer :: k, n

      n = 0
      allocate (list, source=places(values > min(first%parameter, last%parameter) .and. &
                                    values < max(first%parameter, last%parameter)))
      if (last%parameter < first%parameter) list = list(size(list):1:-1)
      if (.not. (may_be_stable(first) .or. may_be_stable(last))) list = [integer ::]
      allocate (points(size(list)))
      if (size(list) == 0) return
      curve = curve_through(model, options, first, last)
      longest = beside*norm2(way_to(model, options, first, last))
      before = first
      do k = 1, size(list)
         associate (value => values(list(k)))
            call foresee(model, options, curve, lacks, first, last, value, foreseen)
            found%orbit = foreseen
            call clear(refusal)
            share = (value - before%parameter)/(last%parameter - before%parameter)
            call correct_with(model, options, before%flow%derivative + share*(last%flow%derivative - before%flow%derivative), &
                              found%orbit, refusal)
            if (has_failed(refusal)) found%orbit = foreseen
            call clear(refusal)
            call correct_orbit(model, options, found%orbit, refusal)
            if (has_failed(refusal)) cycle
            if (.not. norm2(way_to(model, options, foreseen, found%orbit)) <= longest) cycle
            before = found%orbit
            call learn(model, options, curve, lacks, first, found%orbit)
            if (any(abs(own_multipliers(model, found%orbit)) >= 1)) cycle
            n = n + 1
            points(n) = found
         end associate
      end do
      points = points(:n)
   end subroutine find_orbits_at

   !> Whether an orbit is stable, or one where stability changes. The multiplier 1 of an autonomous one is its own direction's.
   pure logical function may_be_stable(orbit)
      type(orbit_t), intent(in) :: orbit
      real(wp), parameter :: change = 1.0e-3_wp

      may_be_stable = all(abs(orbit%multipliers) < 1 + change)
   end function may_be_stable

   !> Where an orbit is expected: on the curve, with what that lacks, or on the straight line between two orbits with a corner
   !> between them.
   pure subroutine foresee(model, options, curve, lacks, first, last, value, orbit)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve
      type(lacks_t), intent(in) :: lacks
      type(orbit_t), intent(in) :: first, last
      real(wp), intent(in) :: value
      type(orbit_t), intent(out) :: orbit
      real(wp) :: basis, lack(model%n + 2), share, way
      integer :: i, k

      if (curve%is_straight) then
         share = (value - first%parameter)/(last%parameter - first%parameter)
         orbit = first
         orbit%y = first%y + share*(last%y - first%y)
         orbit%period = first%period + share*(last%period - first%period)
      else
         way = way_of_parameter(curve, (value - first%parameter)/options%parameter_scale)
         call orbit_on_curve(model, options, curve, first, way, orbit)
         share = way/curve%way
         lack = 0
         do k = 1, lacks%n
            basis = 1
            do i = 1, lacks%n
               if (i /= k) basis = basis*(share - lacks%w(i))/(lacks%w(k) - lacks%w(i))
            end do
            lack = lack + basis*lacks%q(:, k)
         end do
         call move_orbit(model, options, orbit, (share*(1 - share))**2*lack)
      end if
      orbit%parameter = value
      if (allocated(orbit%tangent)) deallocate (orbit%tangent) ! that of the first
   end subroutine foresee

   !> Remember what a curve lacks at an orbit that was found.
   pure subroutine learn(model, options, curve, lacks, first, found)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve
      type(lacks_t), intent(inout) :: lacks
      type(orbit_t), intent(in) :: first, found
      type(orbit_t) :: foreseen
      real(wp) :: share, way

      if (curve%is_straight) return
      if (.not. allocated(lacks%q)) allocate (lacks%q(model%n + 2, most_known))
      way = way_of_parameter(curve, (found%parameter - first%parameter)/options%parameter_scale)
      call orbit_on_curve(model, options, curve, first, way, foreseen)
      share = way/curve%way
      if (lacks%n == most_known) then
         lacks%w(:most_known - 1) = lacks%w(2:)
         lacks%q(:, :most_known - 1) = lacks%q(:, 2:)
         lacks%n = most_known - 1
      end if
      lacks%n = lacks%n + 1
      lacks%w(lacks%n) = share
      lacks%q(:, lacks%n) = way_to(model, options, foreseen, found)/(share*(1 - share))**2
   end subroutine learn

end module evl_branch_values
