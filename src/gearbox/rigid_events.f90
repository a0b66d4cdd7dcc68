!> What an event does to rigid contacts: impacts of the flanks that closed, normal forces of all, flanks that have to open.
module evl_rigid_events
   use evl_contact_laws, only: rigid_restitution
   use evl_event_kinds, only: event_closed, event_impact, event_impacts_ended, event_log, event_opened, note
   use evl_gearbox, only: gearbox_t, is_closed
   use evl_kinds, only: wp
   use evl_rigid_forces, only: impact, open_flank, set_multipliers
   use evl_settle_modes, only: settle_modes
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: flanks_off
   implicit none (type, external)
   private

   public :: closed_flanks, settle_rigid

contains

   !> Which tooth contacts lead a rigid flank that is closed.
   pure function closed_flanks(gearbox, integers) result(closed)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: integers(:)
      logical :: closed(size(gearbox%contacts))
      integer :: m

      closed = [(is_closed(gearbox, m, integers), m=1, size(closed))]
   end function closed_flanks

   !> Impacts of the flanks that closed, then the normal forces of all; those that would have to pull open.
   subroutine settle_rigid(gearbox, t, was_closed, y, integers, reals, log, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      logical, intent(in) :: was_closed(:) !! closed_flanks before the event
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(event_log), intent(inout) :: log
      type(status_t), intent(inout) :: status
      integer :: nothing(gearbox%n_roots)
      logical, dimension(size(gearbox%contacts)) :: closing, rebounds, opened
      integer :: m

      nothing = 0
      closing = closed_flanks(gearbox, integers) .and. .not. was_closed
      if (any(closing)) then
         call impact(gearbox, t, closing, y, integers, reals, rebounds, opened, status)
         if (has_failed(status)) return
         do m = 1, size(gearbox%contacts)
            if (.not. gearbox%contacts(m)%leads) cycle
            associate (contact => gearbox%contacts(m), pair => first_pair(gearbox, m, integers))
               if (opened(m) .and. .not. was_closed(m)) cycle
               if (opened(m)) call note(log, event_opened, contact, pair)
               if (.not. closing(m)) cycle
               if (rebounds(m)) call open_flank(gearbox, m, y, integers)
               call note(log, merge(event_impact, event_closed, rebounds(m)), contact, pair)
               if (.not. rebounds(m) .and. rigid_restitution(contact%elastic) > 0) call note(log, event_impacts_ended, contact, &
                                                                                             pair)
            end associate
         end do
         call settle_modes(gearbox, nothing, y, integers, reals, log, status) ! speeds have jumped
         if (has_failed(status)) return
      end if
      call set_multipliers(gearbox, t, y, integers, reals, opened, status)
      do m = 1, size(gearbox%contacts)
         if (opened(m)) call note(log, event_opened, gearbox%contacts(m), first_pair(gearbox, m, integers))
      end do
   end subroutine settle_rigid

   !> The tooth pair of a flank that has been longest on the path; that of the first slot if none is.
   pure integer function first_pair(gearbox, leader, integers) result(pair)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: leader, integers(:)
      integer :: m

      pair = huge(pair)
      do m = leader, leader + gearbox%contacts(leader)%n_slots - 1
         associate (i => gearbox%contacts(m)%i_mode)
            if (integers(i + 1) /= flanks_off) pair = min(pair, integers(i))
         end associate
      end do
      if (pair == huge(pair)) pair = integers(gearbox%contacts(leader)%i_mode)
   end function first_pair

end module evl_rigid_events
