!> Make the modes consistent with the state after an event; all events use this one procedure.
!>
!> An event can change more than the quantity that caused it. The slope of a flank jumps at the border of a relief, and with it the
!> rate of the penetration and the damper force. Speeds jump in an impact. Another tooth pair with other flanks takes over. A mode
!> whose root function is then past its zero would never end, because that zero is never crossed. After every event, the root
!> functions of contact, force and sliding are therefore evaluated for all tooth contacts, and modes are changed until none is past
!> its zero.
module evl_settle_modes
   use evl_contact_events, only: contact_event, parts, roots_of_contact
   use evl_contact_roots, only: by_kind, is_past
   use evl_event_log, only: moment_t
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_root_kinds, only: n_root_kinds, root_of, root_rows, settles_alone, settles_contact, settles_sliding, tie
   use evl_status, only: code_no_solution, fail, has_failed, status_t, subject_mesh
   use evl_tooth_contact, only: contact_state, flanks_open, tooth_contact_t, touches, tracking_closed_form
   implicit none (type, external)
   private

   public :: located, most_settling, settle_modes

   !> Accuracy of a located zero of a root function, in its own units.
   real(wp), parameter :: located = 1.0e-8_wp
   integer, parameter :: most_settling = 8 !! passes over all contacts; a jump of speeds needs three

contains

   !> Apply the root functions that crossed zero, and repeat until none is past its zero.
   subroutine settle_modes(gearbox, fired, now, status)
      type(gearbox_t), intent(in) :: gearbox
      type(moment_t), intent(inout) :: now !! its energies change if overlapping flanks enter or leave
      integer, intent(in) :: fired(gearbox%n_roots)  !! not 0 where a root function passed zero
      type(status_t), intent(inout) :: status        !! code_no_solution if two modes contradict each other without end
      logical :: settled, nothing, crossed(n_root_kinds, size(gearbox%contacts)), quiet(size(gearbox%contacts))
      logical :: known(size(gearbox%contacts))
      type(contact_state) :: at(size(gearbox%contacts))
      integer :: m, turn, restless

      known = .false.
      do m = 1, size(gearbox%contacts)
         crossed(:, m) = by_kind(gearbox%contacts(m), fired)
         call cross(gearbox, m, now, known, at, crossed(:, m), quiet(m), status)
         if (has_failed(status)) return
      end do
      restless = 0
      do turn = 1, most_settling
         settled = .true.
         do m = 1, size(gearbox%contacts)
            if (quiet(m)) cycle
            call settle_contact(gearbox, m, crossed(:, m), now, known, at, nothing, status)
            if (has_failed(status)) return
            quiet(m) = nothing .and. stands_alone(gearbox, m)
            if (nothing) cycle
            settled = .false.
            restless = m
         end do
         if (settled) return
      end do
      call fail(status, code_no_solution, "the contact mode of a tooth pair is undetermined: at this state each mode requires" &
                //" another", subject_mesh, gearbox%contacts(restless)%mesh, "contact")
   end subroutine settle_modes

   !> Apply the root functions of one tooth contact that crossed zero.
   subroutine cross(gearbox, m, now, known, at, crossed, quiet, status)
      type(gearbox_t), intent(in) :: gearbox
      type(moment_t), intent(inout) :: now
      integer, intent(in) :: m
      logical, intent(inout) :: known(:) !! [contacts] as in `roots_of_contact`
      type(contact_state), intent(inout) :: at(*)     !! [contacts]
      logical, intent(inout) :: crossed(n_root_kinds) !! located ones; those that cross at the same instant are added
      logical, intent(out) :: quiet                   !! no crossing, and independent of the changes of other contacts
      type(status_t), intent(inout) :: status
      logical :: passed(n_root_kinds, 1)

      quiet = .false.
      call passed_now(gearbox, m, now, known, at, [-tie], passed, status)
      if (has_failed(status)) return
      crossed = crossed .or. passed(:, 1)
      if (any(crossed)) then
         call contact_event(gearbox, m, crossed, now, known, at, status)
      else
         quiet = stands_alone(gearbox, m)
      end if
   end subroutine cross

   !> Apply the root functions of one tooth contact that have jumped past zero. A root function that has just crossed zero may be on
   !> either side of it, within the accuracy of event location; it is not reversed for that.
   subroutine settle_contact(gearbox, m, crossed, now, known, at, nothing, status)
      type(gearbox_t), intent(in) :: gearbox
      type(moment_t), intent(inout) :: now
      integer, intent(in) :: m
      logical, intent(in) :: crossed(n_root_kinds) !! root functions that crossed zero at this event
      logical, intent(inout) :: known(:) !! [contacts] as in `roots_of_contact`
      type(contact_state), intent(inout) :: at(*)  !! [contacts]
      logical, intent(out) :: nothing              !! no change required
      type(status_t), intent(inout) :: status
      integer, parameter :: at_all = 1, by_far = 2
      logical :: passed(n_root_kinds, 2), group(n_root_kinds), jumped(n_root_kinds)
      integer :: i

      nothing = .true.
      call passed_now(gearbox, m, now, known, at, [0.0_wp, located], passed, status)
      if (has_failed(status) .or. .not. any(passed)) return
      jumped = .false.
      do i = settles_contact, settles_sliding
         group = root_rows%settles == i
         where (group) jumped = passed(:, merge(by_far, at_all, any(crossed .and. group)))
      end do
      where (root_rows%settles == settles_alone) jumped = passed(:, at_all) .and. .not. crossed
      if (.not. any(jumped)) return
      nothing = .false.
      call contact_event(gearbox, m, jumped, now, known, at, status)
   end subroutine settle_contact

   !> Whether a contact is independent of changes of other contacts. Rigid contacts share a force, and tracked ones their points.
   !> With coupled pairs and without edges, a pair that enters under load opens others at once.
   pure logical function stands_alone(gearbox, m)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m

      associate (contact => gearbox%contacts(m))
         stands_alone = .not. contact%rigid .and. contact%tracking == tracking_closed_form &
                        .and. (contact%has_edges .or. .not. gearbox%flanks(contact%i_flank)%flank%couples)
      end associate
   end function stands_alone

   !> Root functions of one tooth contact that are past zero at a state and can be decided independently.
   subroutine passed_now(gearbox, m, now, known, at, by, passed, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m
      type(moment_t), intent(in) :: now
      logical, intent(inout) :: known(:) !! [contacts] as in `roots_of_contact`
      type(contact_state), intent(inout) :: at(*) !! [contacts]
      real(wp), intent(in) :: by(:) !! as in `is_past`, for a force as accurate as the reference force
      logical, intent(out) :: passed(n_root_kinds, size(by)) !! by kind, for each element of `by`; false for kinds not present
      type(status_t), intent(inout) :: status
      real(wp) :: roots(n_root_kinds), coarse
      integer :: directions(n_root_kinds)
      integer :: i

      passed = .false.
      associate (contact => gearbox%contacts(m))
         call roots_of_contact(gearbox, m, now%y, now%integers, now%reals, known, at, directions, roots, status)
         if (has_failed(status)) return
         do i = 1, contact%n_roots
            coarse = 1
            if (contact%roots(i) == root_of%force) coarse = coarseness(contact, at(m))
            passed(contact%roots(i), :) = is_past(directions(i), roots(i), merge(coarse*by, by, by > 0))
         end do
         ! rigid flanks close by impacts, and their forces are computed together
         if (contact%rigid) passed([root_of%contact, root_of%force], :) = .false.
         if (at(m)%mode%flanks == flanks_open .and. parts(gearbox%flanks(contact%i_flank)%flank, contact, at(m))) &
            passed(root_of%contact, :) = .false.
      end associate
   end subroutine passed_now

   !> Factor by which the zero of a force is less accurate than one of the size of the reference force. It is the difference of an
   !> elastic and a viscous force, which may be much larger, and has their absolute accuracy.
   pure real(wp) function coarseness(contact, at)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      real(wp), parameter :: larger = 1.0e3_wp !! forces: a zero is located to 1e-11 of them

      coarseness = 1
      if (touches(at%mode)) coarseness = max(1.0_wp, abs(at%elastic%force)/(larger*contact%force_scale))
   end function coarseness

end module evl_settle_modes
