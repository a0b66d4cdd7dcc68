!> Stable orbits of a branch at given values of the parameter: each is foreseen between its neighbours on the branch, and found
!> by Newton's iteration at that value. Who tells of it follows it anyway, and sees how far it is one: most are foreseen well
!> enough that this is the only time they are followed.
!>
!> What the cubic between the neighbours lacks is w**2 (1 - w)**2 q(w), w from 0 to 1 between them, with a smooth q: the orbits
!> found so far between them tell q, by the polynomial through the last few, and the next orbits are foreseen the better.
module evl_branch_values
   use evl_branch_curve, only: curve_t, curve_through, orbit_on_curve, way_of_parameter, way_to
   use evl_kinds, only: wp
   use evl_orbit_model, only: orbit_model
   use evl_orbit_teller, only: orbit_teller
   use evl_places, only: places
   use evl_shooting, only: change_of, correct_orbit, correct_with, lack_of_round, move_orbit, orbit_options, orbit_t, &
                           own_multipliers
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
   subroutine find_orbits_at(model, options, values, first, last, teller, before, points)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      real(wp), intent(in) :: values(:)        !! rising
      type(orbit_t), intent(in) :: first, last !! with tangents; between them the parameter rises or falls
      class(orbit_teller), pointer, intent(in) :: teller !! may be null
      integer, intent(in) :: before            !! the number of the first one, less 1
      type(branch_point), allocatable, intent(out) :: points(:)
      real(wp), parameter :: beside = 0.1_wp   !! of the way between the two
      type(curve_t) :: curve
      type(lacks_t) :: lacks
      type(orbit_t) :: foreseen, better
      type(branch_point) :: found
      real(wp) :: longest
      integer, allocatable :: list(:)
      integer :: k, n
      logical :: is_found, is_stable

      n = 0
      allocate (list, source=places(values > min(first%parameter, last%parameter) .and. &
                                    values < max(first%parameter, last%parameter)))
      if (last%parameter < first%parameter) list = list(size(list):1:-1)
      if (.not. (may_be_stable(first) .or. may_be_stable(last))) list = [integer ::]
      allocate (points(size(list)))
      if (size(list) == 0) return
      curve = curve_through(model, options, first, last)
      longest = beside*norm2(way_to(model, options, first, last))
      is_stable = may_be_stable(first) .and. may_be_stable(last)
      do k = 1, size(list)
         call foresee(model, options, curve, lacks, first, last, values(list(k)), foreseen)
         is_found = .false.
         if (associated(teller) .and. is_stable) &
            call tell_orbit(model, options, teller, before + n + 1, foreseen, found%orbit, better, is_found)
         found%is_told = is_found
         if (.not. is_found) call solve_orbit(model, options, foreseen, found%orbit, better, is_found)
         if (.not. is_found) cycle
         if (.not. norm2(way_to(model, options, foreseen, found%orbit)) <= longest) cycle
         call learn(model, options, curve, lacks, first, better)
         if (any(abs(own_multipliers(model, found%orbit)) >= 1)) cycle
         n = n + 1
         points(n) = found
      end do
      points = points(:n)
   end subroutine find_orbits_at

   !> Let it be told, and corrected by what that says, until there is almost nothing to correct. The derivative is not found, so
   !> there are no multipliers.
   subroutine tell_orbit(model, options, teller, number, foreseen, orbit, better, is_found)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      class(orbit_teller), intent(inout) :: teller
      integer, intent(in) :: number
      type(orbit_t), intent(in) :: foreseen
      type(orbit_t), intent(out) :: orbit   !! as it was told
      type(orbit_t), intent(out) :: better  !! with the last correction
      logical, intent(out) :: is_found
      real(wp), parameter :: near = 1.0e-8_wp, slow = 0.1_wp !! in units of the scales; of the correction before
      integer, parameter :: most = 4
      type(status_t) :: refusal
      real(wp) :: change(model%n + 2), last
      integer :: i

      is_found = .false.
      better = foreseen
      last = huge(last)
      do i = 1, most
         orbit = better
         call model%set_parameter(orbit%parameter, refusal)
         if (.not. model%autonomous) orbit%period = orbit%periods*model%period
         if (.not. has_failed(refusal)) call teller%tell(number, orbit, refusal)
         if (.not. has_failed(refusal) .and. i > 1) call learn_derivative(model, change, orbit)
         if (.not. has_failed(refusal)) call change_of(model, options, orbit, change, refusal)
         if (has_failed(refusal)) return
         is_found = norm2(change) <= near .and. orbit%flow%same_modes
         better = orbit
         call move_orbit(model, options, better, change)
         if (is_found .or. .not. norm2(change) <= slow*last) exit
         last = norm2(change)
      end do
      orbit%multipliers = [complex(wp) ::]
   end subroutine tell_orbit

   !> What is left after a correction is laid to the derivative with which it was found (C. G. Broyden, Mathematics of Computation
   !> 19 (1965) 577-593).
   pure subroutine learn_derivative(model, change, orbit)
      class(orbit_model), intent(in) :: model
      real(wp), intent(in) :: change(:)      !! [n + 2] that led here, in units of the scales
      type(orbit_t), intent(inout) :: orbit  !! its flow has an end, and the derivative that gave that change
      real(wp) :: left(model%n), size_of
      integer :: j

      size_of = dot_product(change(:model%n), change(:model%n))
      if (.not. size_of > 0) return
      left = merge(lack_of_round(model, orbit), 0.0_wp, orbit%active)
      do j = 1, model%n
         orbit%flow%derivative(:, j) = orbit%flow%derivative(:, j) + left*(change(j)/(size_of*model%scale(j)))
      end do
   end subroutine learn_derivative

   !> An iteration with the derivative that is expected, which saves finding it, then as usual.
   subroutine solve_orbit(model, options, foreseen, orbit, better, is_found)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: foreseen
      type(orbit_t), intent(out) :: orbit, better !! the same
      logical, intent(out) :: is_found
      type(status_t) :: refusal

      orbit = foreseen
      call correct_with(model, options, foreseen%flow%derivative, orbit, refusal)
      if (has_failed(refusal)) orbit = foreseen
      call clear(refusal)
      call correct_orbit(model, options, orbit, refusal)
      is_found = .not. has_failed(refusal)
      better = orbit
   end subroutine solve_orbit

   !> Whether an orbit is stable, or one where stability changes. The multiplier 1 of an autonomous one is its own direction's.
   pure logical function may_be_stable(orbit)
      type(orbit_t), intent(in) :: orbit
      real(wp), parameter :: change = 1.0e-3_wp

      may_be_stable = all(abs(orbit%multipliers) < 1 + change)
   end function may_be_stable

   !> Where an orbit is expected, and with which derivative: on the curve, with what that lacks, or on the straight line between two
   !> orbits with a corner between them.
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
      orbit%flow%derivative = first%flow%derivative + share*(last%flow%derivative - first%flow%derivative)
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
