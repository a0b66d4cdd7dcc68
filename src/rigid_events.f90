!> What an event does to rigid contacts: impacts of the flanks that closed, normal forces of all, flanks that have to open.
module evl_rigid_events
   use evl_contact_events, only: mesh_point, settle_clip
   use evl_contact_laws, only: rigid_restitution
   use evl_contact_point, only: contact_point
   use evl_event_log, only: event_closed, event_impact, event_impacts_ended, event_log, event_opened, event_returned, &
                            event_vanished, note
   use evl_gearbox, only: gearbox_mode, gearbox_store_mode, gearbox_t, is_closed
   use evl_kinds, only: wp
   use evl_local_variables, only: n_local
   use evl_mesh, only: contact_loaded, contact_off, mesh_mode, mesh_settle_friction, touches
   use evl_multipliers, only: impact, open_flank, set_multipliers
   use evl_status, only: has_failed, status_t
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
      logical, dimension(size(gearbox%contacts)) :: closing, rebounds, opened
      integer :: m

      closing = closed_flanks(gearbox, integers) .and. .not. was_closed
      if (any(closing)) then
         call impact(gearbox, t, closing, y, integers, reals, rebounds, opened, status)
         if (has_failed(status)) return
         do m = 1, size(gearbox%contacts)
            if (.not. gearbox%contacts(m)%leads) cycle
            associate (mesh => gearbox%contacts(m), pair => first_pair(gearbox, m, integers))
               if (opened(m) .and. .not. was_closed(m)) cycle
               if (opened(m)) call note(log, event_opened, mesh, pair)
               if (.not. closing(m)) cycle
               if (rebounds(m)) call open_flank(gearbox, m, y, integers)
               call note(log, merge(event_impact, event_closed, rebounds(m)), mesh, pair)
               if (.not. rebounds(m) .and. rigid_restitution(mesh%contact) > 0) call note(log, event_impacts_ended, mesh, pair)
            end associate
         end do
         do m = 1, size(gearbox%contacts)
            call settle_speeds(gearbox, m, y, integers, reals, log, status)
         end do
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
            if (integers(i + 1) /= contact_off) pair = min(pair, integers(i))
         end associate
      end do
      if (pair == huge(pair)) pair = integers(gearbox%contacts(leader)%i_mode)
   end function first_pair

   !> Speeds have jumped: the branches of friction, and the clip of an elastic contact's force, that belong to the new ones.
   subroutine settle_speeds(gearbox, m, y, integers, reals, log, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(event_log), intent(inout) :: log
      type(status_t), intent(inout) :: status
      type(contact_point) :: point
      type(mesh_mode) :: mode
      real(wp) :: q(n_local), rho_a0
      integer :: before

      mode = gearbox_mode(gearbox, m, integers, reals)
      if (.not. touches(mode)) return
      associate (mesh => gearbox%contacts(m))
         call mesh_point(gearbox, m, y, integers, mode, q, rho_a0, point)
         if (.not. mesh%rigid) then
            before = mode%contact
            call settle_clip(mesh, point, mode, status)
            if (has_failed(status)) return
            if (mode%contact /= before) &
               call note(log, merge(event_returned, event_vanished, mode%contact == contact_loaded), mesh, mode%teeth)
         end if
         if (mode%contact == contact_loaded) mode%friction = mesh_settle_friction(mesh, point)
      end associate
      call gearbox_store_mode(gearbox, m, mode, integers, reals)
   end subroutine settle_speeds

end module evl_rigid_events
