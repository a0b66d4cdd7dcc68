!> What can happen to a gearbox, and what changes when it does.
module evl_gearbox_events
   use evl_contact_point, only: contact_point
   use evl_contact_laws, only: rigid_restitution
   use evl_contact_tracking, only: points_from_closed_form, project_points
   use evl_dae_residual, only: gearbox_derivative
   use evl_gearbox, only: gearbox_local, gearbox_mode, gearbox_store_mode, gearbox_t, i_theta, i_turns
   use evl_housing, only: housing_renormalise
   use evl_kinds, only: pi, wp
   use evl_load, only: load_next_knot
   use evl_local_variables, only: at_track, n_local, n_track
   use evl_mesh, only: contact_apart, contact_loaded, contact_open, contact_unloaded, mesh_contact, mesh_mode, &
                       mesh_nominal_rho, mesh_root_directions, mesh_roots, mesh_settle_friction, mesh_unclipped_force, &
                       n_mesh_roots, root_apart, root_back, root_contact, root_force, root_forward, root_friction_high, &
                       root_friction_low
   use evl_multipliers, only: impact, set_multipliers
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: event_t, event_name, n_event_kinds
   public :: gearbox_n_roots, gearbox_roots, gearbox_root_directions, gearbox_next_time_event, gearbox_apply_event

   integer, parameter :: event_switch = 0, event_switch_back = 1, event_closed = 2, event_opened = 3, event_vanished = 4, &
                         event_returned = 5, event_sliding_began = 6, event_sliding_ended = 7, event_knot = 8, &
                         event_revolution = 9, event_apart = 10, event_near = 11, event_impact = 12, event_impacts_ended = 13
   integer, parameter :: n_event_kinds = 14 !! number of kinds
   character(len=18), parameter :: names(0:n_event_kinds - 1) = ["tooth_switch      ", "tooth_switch_back ", "contact_closed    ", &
                                                                 "contact_opened    ", "force_vanished    ", "force_returned    ", &
                                                                 "sliding_began     ", "sliding_ended     ", "table_knot        ", &
                                                                 "revolution        ", "flanks_apart      ", "flanks_near       ", &
                                                                 "impact            ", "impacts_ended     "]

   real(wp), parameter :: grazing = 1.0e-6_wp !! penetration over its scale below which a vanishing force is an opening
   integer, parameter :: most_turns = 2       !! theta is reduced at events past one turn, and at this many at the latest

   !> One thing that happened.
   type :: event_t
      integer :: kind = 0       !! one of the kinds above
      integer :: mesh = 0       !! from 1; 0 if it concerns none
      integer :: tooth_pair = -1 !! pitches since the start, after the event
   end type event_t

   !> What happens at one event, in the order in which it is applied.
   type :: event_log
      integer :: n = 0
      type(event_t), allocatable :: events(:)
   end type event_log

contains

   !> Name of an event kind; blank if there is none.
   pure function event_name(kind) result(name)
      integer, intent(in) :: kind
      character(len=len(names)) :: name

      name = ""
      if (kind >= 0 .and. kind < n_event_kinds) name = names(kind)
   end function event_name

   !> Number of root functions: those of the meshes, and the turns of the reference wheel.
   pure integer function gearbox_n_roots(gearbox) result(n)
      type(gearbox_t), intent(in) :: gearbox

      n = n_mesh_roots*size(gearbox%meshes) + 1
   end function gearbox_n_roots

   !> Root functions at a state.
   subroutine gearbox_roots(gearbox, y, integers, reals, roots, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states), reals(:)
      integer, intent(in) :: integers(:)
      real(wp), intent(out) :: roots(:)
      type(status_t), intent(inout) :: status
      type(contact_point) :: point
      type(mesh_mode) :: mode
      real(wp) :: q(n_local), rho_a0
      integer :: m

      do m = 1, size(gearbox%meshes)
         mode = gearbox_mode(gearbox, m, integers, reals)
         call mesh_point(gearbox, m, y, integers, mode, q, rho_a0, point)
         call mesh_roots(gearbox%meshes(m), m, mode, rho_a0, q, point, &
                         roots(n_mesh_roots*(m - 1) + 1:n_mesh_roots*m), status)
         if (has_failed(status)) return
      end do
      roots(n_mesh_roots*size(gearbox%meshes) + 1) = 1 - (y(i_theta)/(2*pi*most_turns))**2
   end subroutine gearbox_roots

   !> Local variables and contact of a mesh.
   pure subroutine mesh_point(gearbox, index, y, integers, mode, q, rho_a0, point)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index, integers(:)
      real(wp), intent(in) :: y(:)
      type(mesh_mode), intent(in) :: mode
      real(wp), intent(out) :: q(n_local), rho_a0
      type(contact_point), intent(out) :: point

      associate (mesh => gearbox%meshes(index))
         call gearbox_local(gearbox, mesh, y, q)
         rho_a0 = mesh_nominal_rho(mesh, y(i_theta), integers(i_turns), mode%teeth)
         call mesh_contact(mesh, rho_a0, q, point)
      end associate
   end subroutine mesh_point

   !> Directions that count in the present modes.
   pure subroutine gearbox_root_directions(gearbox, integers, directions)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: integers(:)
      integer, intent(out) :: directions(:)
      real(wp) :: no_reals(size(gearbox%meshes))
      integer :: m

      no_reals = 0
      do m = 1, size(gearbox%meshes)
         call mesh_root_directions(gearbox_mode(gearbox, m, integers, no_reals), &
                                   directions(n_mesh_roots*(m - 1) + 1:n_mesh_roots*m))
      end do
      directions(n_mesh_roots*size(gearbox%meshes) + 1) = -1
   end subroutine gearbox_root_directions

   !> Time of the next knot of a table [s]; huge if there is none.
   pure real(wp) function gearbox_next_time_event(gearbox, integers) result(time)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: integers(:)
      integer :: i

      time = huge(time)
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i))
            if (load%i_segment > 0) time = min(time, load_next_knot(load, integers(load%i_segment)))
         end associate
      end do
   end function gearbox_next_time_event

   !> Apply what happened at t and make y' consistent.
   subroutine gearbox_apply_event(gearbox, t, fired, time_event, y, yp, integers, reals, events, n_events, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      integer, intent(in) :: fired(:)        !! not 0 where a root function passed zero
      logical, intent(in) :: time_event      !! t is the time of the next knot
      real(wp), intent(inout) :: y(gearbox%n_states)
      real(wp), intent(out) :: yp(gearbox%n_states)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(event_t), intent(out) :: events(:) !! room for all roots and two more: a mesh notes fewer events than it has roots
      integer, intent(out) :: n_events
      type(status_t), intent(inout) :: status
      type(event_log) :: log
      logical :: was_open(size(gearbox%meshes))
      integer :: i, m

      allocate (log%events(size(events)))
      was_open = integers(gearbox%meshes%i_mode + 1) == contact_open
      if (time_event) then
         do i = 1, size(gearbox%loads)
            associate (load => gearbox%loads(i))
               if (load%i_segment == 0) cycle
               if (load_next_knot(load, integers(load%i_segment)) <= t) &
                  integers(load%i_segment) = integers(load%i_segment) + 1
            end associate
         end do
         call note(log, event_knot)
      end if
      do m = 1, size(gearbox%meshes)
         associate (mine => fired(n_mesh_roots*(m - 1) + 1:n_mesh_roots*m))
            if (any(mine /= 0)) call mesh_event(gearbox, m, mine /= 0, y, integers, reals, log)
         end associate
      end do
      if (abs(y(i_theta)) >= 2*pi .or. fired(n_mesh_roots*size(gearbox%meshes) + 1) /= 0) then
         i = int(y(i_theta)/(2*pi)*(1 + epsilon(pi)))
         integers(i_turns) = integers(i_turns) + i
         y(i_theta) = y(i_theta) - 2*pi*i
         call note(log, event_revolution)
      end if
      if (gearbox%n_multipliers > 0) call settle_rigid(gearbox, t, fired, was_open, y, integers, reals, log, status)
      call project_tracked(gearbox, y, integers, reals)
      call housing_renormalise(gearbox%housing, y)
      events(:log%n) = log%events(:log%n)
      n_events = log%n
      if (.not. has_failed(status)) call gearbox_derivative(gearbox, t, y, integers, reals, yp, status)
   end subroutine gearbox_apply_event

   !> Impacts of the rigid contacts that closed, then the normal forces of all; those that would have to pull open.
   subroutine settle_rigid(gearbox, t, fired, was_open, y, integers, reals, log, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      integer, intent(in) :: fired(:)
      logical, intent(in) :: was_open(:) !! [meshes] before the event
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(event_log), intent(inout) :: log
      type(status_t), intent(inout) :: status
      logical, dimension(size(gearbox%meshes)) :: closing, rebounds, opened
      type(mesh_mode) :: mode
      integer :: m

      closing = was_open .and. gearbox%meshes%rigid .and. fired(root_contact:n_mesh_roots*size(gearbox%meshes):n_mesh_roots) /= 0
      if (any(closing)) then
         call impact(gearbox, t, closing, y, integers, reals, rebounds, opened, status)
         if (has_failed(status)) return
         do m = 1, size(gearbox%meshes)
            mode = gearbox_mode(gearbox, m, integers, reals)
            if (opened(m) .and. was_open(m)) cycle
            if (opened(m)) call note(log, event_opened, m, mode%teeth)
            if (.not. closing(m)) cycle
            if (rebounds(m)) mode%contact = contact_open
            call gearbox_store_mode(gearbox, m, mode, integers, reals)
            call note(log, merge(event_impact, event_closed, rebounds(m)), m, mode%teeth)
            if (.not. rebounds(m) .and. rigid_restitution(gearbox%meshes(m)%contact) > 0) &
               call note(log, event_impacts_ended, m, mode%teeth)
         end do
         do m = 1, size(gearbox%meshes)
            call settle_speeds(gearbox, m, y, integers, reals, log, status)
         end do
         if (has_failed(status)) return
      end if
      call set_multipliers(gearbox, t, y, integers, reals, opened, status)
      do m = 1, size(gearbox%meshes)
         if (opened(m)) call note(log, event_opened, m, integers(gearbox%meshes(m)%i_mode))
      end do
   end subroutine settle_rigid

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
      real(wp) :: q(n_local), rho_a0, force

      mode = gearbox_mode(gearbox, m, integers, reals)
      if (mode%contact /= contact_loaded .and. mode%contact /= contact_unloaded) return
      call mesh_point(gearbox, m, y, integers, mode, q, rho_a0, point)
      if (.not. gearbox%meshes(m)%rigid) then
         call mesh_unclipped_force(gearbox%meshes(m), m, mode, point, force, status)
         if (has_failed(status)) return
         if (force < 0 .and. mode%contact == contact_loaded) then
            mode%contact = contact_unloaded
            call note(log, event_vanished, m, mode%teeth)
         else if (force > 0 .and. mode%contact == contact_unloaded) then
            mode%contact = contact_loaded
            call note(log, event_returned, m, mode%teeth)
         end if
      end if
      if (mode%contact == contact_loaded) mode%friction = mesh_settle_friction(gearbox%meshes(m), point)
      call gearbox_store_mode(gearbox, m, mode, integers, reals)
   end subroutine settle_speeds

   !> Restart with the tracked points exactly on their flanks; where they cannot be put, the derivative says why.
   subroutine project_tracked(gearbox, y, integers, reals)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      type(mesh_mode) :: mode
      real(wp) :: q(n_local)
      logical :: solved
      integer :: m

      do m = 1, size(gearbox%meshes)
         associate (mesh => gearbox%meshes(m))
            mode = gearbox_mode(gearbox, m, integers, reals)
            if (mesh%i_track == 0 .or. mode%contact == contact_apart) cycle
            call gearbox_local(gearbox, mesh, y, q)
            call project_points(mesh%pair, mesh_nominal_rho(mesh, y(i_theta), integers(i_turns), mode%teeth), q, solved)
            if (solved) y(mesh%i_track:mesh%i_track + n_track - 1) = q(at_track:)
         end associate
      end do
   end subroutine project_tracked

   !> Write an event down.
   pure subroutine note(log, kind, mesh, tooth_pair)
      type(event_log), intent(inout) :: log
      integer, intent(in) :: kind
      integer, intent(in), optional :: mesh, tooth_pair

      log%n = log%n + 1
      log%events(log%n) = event_t(kind)
      if (present(mesh)) log%events(log%n)%mesh = mesh
      if (present(tooth_pair)) log%events(log%n)%tooth_pair = tooth_pair
   end subroutine note

   !> What happened to one mesh.
   pure subroutine mesh_event(gearbox, m, fired, y, integers, reals, log)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m
      logical, intent(in) :: fired(n_mesh_roots)
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(event_log), intent(inout) :: log
      type(contact_point) :: point
      type(mesh_mode) :: mode
      real(wp) :: q(n_local), rho_a0
      logical :: switched

      mode = gearbox_mode(gearbox, m, integers, reals)
      switched = fired(root_forward) .or. fired(root_back)
      if (switched) then
         ! both tracked points move by one base pitch along e, and so does rho_A0: turn, zeta, dr, lambda and mu stay
         mode%teeth = mode%teeth + merge(1, -1, fired(root_forward))
         call note(log, merge(event_switch, event_switch_back, fired(root_forward)), m, mode%teeth)
      end if
      call mesh_point(gearbox, m, y, integers, mode, q, rho_a0, point)
      if (fired(root_friction_high) .or. fired(root_friction_low)) call change_friction(m, fired, mode, log)
      call change_contact(gearbox, m, fired, point, mode, log)
      ! the radii of curvature jump at a switch, and friction starts anew with a contact
      if (mode%contact == contact_loaded .and. (switched .or. fired(root_contact) .or. fired(root_force))) &
         mode%friction = mesh_settle_friction(gearbox%meshes(m), point)
      if (fired(root_apart)) call change_distance(gearbox, m, q, mode, y, log)
      call gearbox_store_mode(gearbox, m, mode, integers, reals)
   end subroutine mesh_event

   !> The sliding velocity passed an end of the linear part of the friction law.
   pure subroutine change_friction(m, fired, mode, log)
      integer, intent(in) :: m
      logical, intent(in) :: fired(n_mesh_roots)
      type(mesh_mode), intent(inout) :: mode
      type(event_log), intent(inout) :: log

      if (mode%friction /= 0) then
         mode%friction = 0
         call note(log, event_sliding_ended, m, mode%teeth)
      else
         mode%friction = merge(1, -1, fired(root_friction_high))
         call note(log, event_sliding_began, m, mode%teeth)
      end if
   end subroutine change_friction

   !> Closing, opening, and the clip of the force.
   pure subroutine change_contact(gearbox, m, fired, point, mode, log)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m
      logical, intent(in) :: fired(n_mesh_roots)
      type(contact_point), intent(in) :: point
      type(mesh_mode), intent(inout) :: mode
      type(event_log), intent(inout) :: log

      select case (mode%contact)
      case (contact_open)
         if (.not. fired(root_contact)) return
         mode%contact = contact_loaded
         mode%v0 = max(point%h_dot, 0.0_wp)
         if (.not. gearbox%meshes(m)%rigid) call note(log, event_closed, m, mode%teeth) ! else an impact decides
      case (contact_loaded)
         if (fired(root_contact) .or. (fired(root_force) .and. point%h < grazing*gearbox%meshes(m)%h_scale)) then
            mode%contact = contact_open
            call note(log, event_opened, m, mode%teeth)
         else if (fired(root_force)) then
            mode%contact = contact_unloaded
            call note(log, event_vanished, m, mode%teeth)
         end if
      case (contact_unloaded)
         if (fired(root_contact)) then
            mode%contact = contact_open
            call note(log, event_opened, m, mode%teeth)
         else if (fired(root_force)) then
            mode%contact = contact_loaded
            call note(log, event_returned, m, mode%teeth)
         end if
      end select
   end subroutine change_contact

   !> Tracking ends where the flanks are too far apart for two of their points to face each other, and begins anew when they
   !> come near.
   pure subroutine change_distance(gearbox, m, q, mode, y, log)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m
      real(wp), intent(in) :: q(n_local)
      type(mesh_mode), intent(inout) :: mode
      real(wp), intent(inout) :: y(:)
      type(event_log), intent(inout) :: log

      associate (mesh => gearbox%meshes(m))
         if (mode%contact == contact_apart) then
            mode%contact = contact_open
            call points_from_closed_form(mesh%pair, q, y(mesh%i_track:mesh%i_track + n_track - 1))
            call note(log, event_near, m, mode%teeth)
         else if (mode%contact == contact_open) then
            mode%contact = contact_apart
            call note(log, event_apart, m, mode%teeth)
         end if
      end associate
   end subroutine change_distance

end module evl_gearbox_events
