!> Stable orbits of a branch at given values of the parameter. Each is predicted between its neighbours on the branch and
!> converged by Newton's iteration at that value. The output recorder integrates it anyway and yields its residual: most
!> predictions are so good that no other integration is necessary.
module evl_branch_values
   use evl_branch_curve, only: chord_to, curve_t, curve_through, orbit_at_value
   use evl_branch_point, only: branch_point, kind_grazing, kind_grazing_fold, kind_ordinary, orbit_recorder
   use evl_indices, only: indices
   use evl_kinds, only: wp
   use evl_multipliers, only: are_inside
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: move_orbit, orbit_options, orbit_t, own_multipliers
   use evl_shooting, only: correct_orbit
   use evl_shooting_system, only: change_of, learn_from_change
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: find_orbits_at

contains

   !> Find the orbits between two neighbouring points of a branch, in their order, where it is stable. An orbit is omitted if
   !> Newton's iteration does not find it near its prediction.
   subroutine find_orbits_at(model, options, values, first, last, recorder, n_recorded, points)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      real(wp), intent(in) :: values(:)        !! ascending
      type(branch_point), intent(in) :: first, last !! with tangents; the parameter is monotonic between them
      class(orbit_recorder), pointer, intent(in) :: recorder !! may be null
      integer, intent(inout) :: n_recorded         !! numbers given to the teller so far
      type(branch_point), allocatable, intent(out) :: points(:)
      real(wp), parameter :: beside = 0.1_wp   !! of the distance between the two
      type(curve_t) :: curve
      type(orbit_t) :: predicted, better
      type(branch_point), allocatable :: found(:)
      real(wp) :: longest
      integer, allocatable :: list(:)
      logical, allocatable :: is_accepted(:)
      integer :: i
      logical :: is_found, is_stable, is_unstable

      call predict_stability(model, first, last, is_stable, is_unstable)
      allocate (list, source=indices(values > min(first%orbit%parameter, last%orbit%parameter) .and. &
                                     values < max(first%orbit%parameter, last%orbit%parameter)))
      if (last%orbit%parameter < first%orbit%parameter) list = list(size(list):1:-1)
      if (is_unstable) list = [integer ::]
      allocate (points(0))
      if (size(list) == 0) return
      allocate (found(size(list)), is_accepted(size(list)))
      curve = curve_through(model, options, first%orbit, last%orbit)
      longest = beside*norm2(chord_to(model, options, first%orbit, last%orbit))
      is_accepted = .false.
      do i = 1, size(list)
         call orbit_at_value(model, options, curve, first%orbit, last%orbit, values(list(i)), predicted)
         is_found = .false.
         if (associated(recorder) .and. is_stable) &
            call record_orbit(model, options, recorder, n_recorded + i, predicted, found(i)%orbit, better, is_found)
         found(i)%recorded = merge(n_recorded + i, 0, is_found)
         if (.not. is_found) call solve_orbit(model, options, predicted, found(i)%orbit, better, is_found)
         if (.not. is_found) cycle
         found(i)%orbit%y = better%y
         found(i)%orbit%period = better%period
         if (.not. norm2(chord_to(model, options, predicted, better)) <= longest) cycle
         is_accepted(i) = are_inside(own_multipliers(model, found(i)%orbit))
      end do
      n_recorded = n_recorded + size(list)
      points = found(indices(is_accepted))
   end subroutine find_orbits_at

   !> Whether all orbits between two points are stable, or all unstable: stability changes only at special points. If the two
   !> disagree, such as beside a grazing point at which multipliers jump, or if both are such points, neither is known.
   pure subroutine predict_stability(model, first, last, is_stable, is_unstable)
      class(orbit_model), intent(in) :: model
      type(branch_point), intent(in) :: first, last
      logical, intent(out) :: is_stable, is_unstable

      is_stable = (changes(first) .or. stable(first)) .and. (changes(last) .or. stable(last))
      is_unstable = (changes(first) .or. .not. stable(first)) .and. (changes(last) .or. .not. stable(last))
      if (.not. (changes(first) .and. changes(last))) return
      is_stable = .false.
      is_unstable = .false.

   contains

      pure logical function changes(point)
         type(branch_point), intent(in) :: point

         changes = all(point%kind /= [kind_ordinary, kind_grazing, kind_grazing_fold])
      end function changes

      pure logical function stable(point)
         type(branch_point), intent(in) :: point

         stable = are_inside(own_multipliers(model, point%orbit))
      end function stable

   end subroutine predict_stability

   !> Record the orbit and correct it by its residual until the correction is negligible. The derivative is not computed, so
   !> that there are no multipliers.
   subroutine record_orbit(model, options, recorder, number, predicted, orbit, better, is_found)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      class(orbit_recorder), intent(inout) :: recorder
      integer, intent(in) :: number
      type(orbit_t), intent(in) :: predicted
      type(orbit_t), intent(out) :: orbit   !! as recorded
      type(orbit_t), intent(out) :: better  !! with the last correction
      logical, intent(out) :: is_found
      real(wp), parameter :: near = 1.0e-8_wp, slow = 0.5_wp !! in units of the scales; of the previous correction
      integer, parameter :: most = 5
      type(status_t) :: refusal
      real(wp) :: change(model%n + 2), last
      integer :: i

      is_found = .false.
      better = predicted
      last = huge(last)
      do i = 1, most
         orbit = better
         call model%set_parameter(orbit%parameter, refusal)
         if (.not. model%autonomous) orbit%period = orbit%periods*model%period
         if (.not. has_failed(refusal)) call recorder%record(number, orbit, refusal)
         if (.not. has_failed(refusal) .and. i > 1) call learn_from_change(model, options, change, orbit)
         if (.not. has_failed(refusal)) call change_of(model, options, orbit, change, refusal)
         if (has_failed(refusal)) return
         is_found = norm2(change) <= near .and. orbit%flow%same_modes
         better = orbit
         call move_orbit(model, options, better, change)
         if (is_found .or. .not. norm2(change) <= slow*last) exit
         last = norm2(change)
      end do
      orbit%multipliers = [complex(wp) ::]
   end subroutine record_orbit

   !> Converge the orbit by Newton's iteration.
   subroutine solve_orbit(model, options, predicted, orbit, better, is_found)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: predicted
      type(orbit_t), intent(out) :: orbit, better !! identical
      logical, intent(out) :: is_found
      type(status_t) :: refusal

      orbit = predicted
      call correct_orbit(model, options, orbit, refusal, predicted=.true.)
      is_found = .not. has_failed(refusal)
      better = orbit
   end subroutine solve_orbit

end module evl_branch_values
