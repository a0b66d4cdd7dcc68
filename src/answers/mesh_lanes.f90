!> What the tooth contacts of a mesh add up to in eight states at once, as evl_mesh_outputs has it in one.
module evl_mesh_lanes
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use evl_closed_form, only: error_of_turns
   use evl_contact_lanes, only: contact_in_lanes, gap_in_lanes, lane_contact
   use evl_contact_point, only: tracked_pair
   use evl_discrete_state, only: leading_contact
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: lanes, wp
   use evl_line_lanes, only: centre_turn_in_lanes, lane_line, line_in_lanes, motion_in_lanes
   use evl_tooth_contact, only: contact_mode, flank_coast, flank_drive, flanks_loaded, flanks_off, flanks_open, tooth_contact_t
   implicit none (type, external)
   private

   public :: add_mesh, lane_mesh

   !> As `mesh_sum`, and of the contact that speaks for the mesh what is told of it.
   type :: lane_mesh
      real(wp), dimension(lanes) :: penetration
      real(wp), dimension(lanes) :: normal, coast, friction, torque_a, torque_b, loss, damping_loss, curvature_loss
      real(wp), dimension(lanes) :: touching        !! 1 or 0
      integer :: loaded
      real(wp), dimension(lanes) :: h, h_coast      !! largest penetrations; -huge: no pair is on the path; NaN: no such flank [m]
      real(wp), dimension(lanes) :: deviation       !! of the flanks of the first [m]
      real(wp), dimension(lanes) :: lag, curvature  !! as in `tell_mesh`
      integer :: leader                             !! the contact that speaks for the mesh
      type(contact_mode) :: mode                    !! its own
      type(lane_line) :: line                       !! its line of action; its motion alone where places are not asked for
      real(wp), dimension(lanes) :: rho_a0, v_t, l_a, l_b, h_dot, omega_a !! the same, as in `lane_contact`
   end type lane_mesh

contains

   !> A mesh in eight states.
   subroutine add_mesh(gearbox, index, y, integers, slots, aside, has_places, mesh)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      type(lane_slot), intent(in) :: slots(*) !! as the rates left them
      type(lane_slot), intent(in) :: aside(*) !! where those are that do not touch, as the root functions left them
      logical, intent(in) :: has_places       !! else nothing is asked that needs those
      type(lane_mesh), intent(out) :: mesh
      type(lane_line) :: line_coast
      real(wp), dimension(lanes) :: gap, gap_coast
      integer :: c, first, last

      call start(mesh)
      first = gearbox%first(index)
      last = gearbox%first(index + 1) - 1
      if (gearbox%contacts(last)%flank /= flank_coast) mesh%coast = ieee_value(mesh%coast, ieee_quiet_nan)
      mesh%leader = leading_contact(gearbox, index, integers)
      mesh%mode = slots(mesh%leader)%mode
      call find_lag(gearbox%contacts(mesh%leader), y, has_places, mesh%line, mesh%lag)
      if (has_places) call gap_in_lanes(gearbox%contacts(mesh%leader), mesh%line, gap)
      do c = first, last
         associate (contact => gearbox%contacts(c))
            if (slots(c)%touches) call add_force(contact%flank == flank_drive, slots(c), mesh)
            if (.not. has_places .or. slots(c)%mode%flanks == flanks_off) cycle
            if (slots(c)%touches) then
               call add_place(contact, slots(c)%at%h, gap, mesh)
            else
               call add_place(contact, aside(c)%at%h, gap, mesh)
            end if
         end associate
      end do
      if (.not. has_places) return
      mesh%curvature = gap + mesh%lag
      call lead(gearbox%contacts(mesh%leader), slots(mesh%leader), aside(mesh%leader), gap, mesh)
      if (mesh%h_coast(1) > -huge(1.0_wp)) return
      if (gearbox%contacts(last)%flank /= flank_coast) then
         mesh%h_coast = ieee_value(mesh%h_coast, ieee_quiet_nan)
         return
      end if
      call line_in_lanes(gearbox%contacts(last), y, line_coast) ! no pair of the other flank is on the path
      call gap_in_lanes(gearbox%contacts(last), line_coast, gap_coast)
      mesh%h_coast = -gap_coast
   end subroutine add_mesh

   !> Nothing yet.
   pure subroutine start(mesh)
      type(lane_mesh), intent(inout) :: mesh

      mesh%normal = 0
      mesh%coast = 0
      mesh%friction = 0
      mesh%torque_a = 0
      mesh%torque_b = 0
      mesh%loss = 0
      mesh%damping_loss = 0
      mesh%curvature_loss = 0
      mesh%touching = 0
      mesh%loaded = 0
      mesh%h = -huge(1.0_wp)
      mesh%h_coast = -huge(1.0_wp)
      mesh%deviation = 0
   end subroutine start

   !> Transmission error, by the motion of the wheels; and the line of action.
   subroutine find_lag(leader, y, has_line, line, lag)
      type(tooth_contact_t), intent(in) :: leader !! the contact that speaks for the mesh
      real(wp), intent(in) :: y(lanes, *)
      logical, intent(in) :: has_line             !! else the motion alone is needed
      type(lane_line), intent(inout) :: line
      real(wp), intent(out) :: lag(lanes)
      type(tracked_pair) :: pair
      real(wp) :: turn(lanes)

      if (has_line) then
         call line_in_lanes(leader, y, line)
      else
         call motion_in_lanes(leader, y, line)
      end if
      pair = leader%pair
      call centre_turn_in_lanes(leader, line, turn)
      lag = error_of_turns(pair, line%psi_a, line%psi_b, turn)
   end subroutine find_lag

   !> What a tooth pair that touches adds.
   pure subroutine add_force(is_drive, slot, mesh)
      logical, intent(in) :: is_drive
      type(lane_slot), intent(in) :: slot
      type(lane_mesh), intent(inout) :: mesh
      real(wp) :: friction(lanes)
      integer :: l

      associate (at => slot%at, force => slot%force)
         !$omp simd
         do l = 1, lanes
            mesh%torque_a(l) = mesh%torque_a(l) + force%torque_a(l)
            mesh%torque_b(l) = mesh%torque_b(l) + force%torque_b(l)
            mesh%curvature_loss(l) = mesh%curvature_loss(l) - (force%d_energy(l)*at%rho_dot(l) + force%excess(l)*at%h_dot(l))
         end do
         if (slot%mode%flanks /= flanks_loaded) then
            mesh%damping_loss = mesh%damping_loss - force%elastic*at%h_dot
            return
         end if
         mesh%loaded = mesh%loaded + 1
         !$omp simd
         do l = 1, lanes
            friction(l) = -force%unclipped(l)*force%factor(l)
            mesh%normal(l) = mesh%normal(l) + force%unclipped(l)
            mesh%loss(l) = mesh%loss(l) - friction(l)*at%v_t(l)
            mesh%damping_loss(l) = mesh%damping_loss(l) + force%viscous(l)*at%h_dot(l)
         end do
         if (is_drive) then
            mesh%friction = mesh%friction + friction
         else
            mesh%coast = mesh%coast + force%unclipped
         end if
      end associate
   end subroutine add_force

   !> Where a tooth pair on the path is.
   pure subroutine add_place(contact, h, gap, mesh)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: h(lanes), gap(lanes) !! penetration, gap of perfect flanks of the drive side [m]
      type(lane_mesh), intent(inout) :: mesh
      integer :: l

      mesh%touching = merge(1.0_wp, mesh%touching, h > 0)
      if (contact%flank /= flank_drive) then
         mesh%h_coast = max(mesh%h_coast, h)
         return
      end if
      if (contact%deviates) then
         do l = 1, lanes
            if (h(l) > mesh%h(l)) mesh%deviation(l) = -gap(l) - h(l)
         end do
      end if
      mesh%h = max(mesh%h, h)
   end subroutine add_place

   !> What the contact that speaks for the mesh tells; off the path it is where it would be.
   subroutine lead(contact, slot, aside, gap, mesh)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(in) :: slot, aside
      real(wp), intent(in) :: gap(lanes)
      type(lane_mesh), intent(inout) :: mesh
      type(lane_contact) :: at
      type(contact_mode) :: mode

      if (slot%touches) then
         call keep(contact, slot%at, gap, mesh)
      else if (slot%mode%flanks /= flanks_off) then
         call keep(contact, aside%at, gap, mesh)
      else
         mode = slot%mode
         mode%flanks = flanks_open ! else the radii alone would be found
         call contact_in_lanes(contact, mode, slot%rho_start, mesh%line, at)
         call keep(contact, at, gap, mesh)
      end if
   end subroutine lead

   !> What is kept of its place.
   pure subroutine keep(contact, at, gap, mesh)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_contact), intent(in) :: at
      real(wp), intent(in) :: gap(lanes)
      type(lane_mesh), intent(inout) :: mesh

      mesh%rho_a0 = at%rho_a0
      mesh%v_t = at%v_t
      mesh%l_a = at%l_a
      mesh%l_b = at%l_b
      mesh%h_dot = at%h_dot
      mesh%omega_a = at%omega_a
      mesh%penetration = merge(mesh%h, 0.0_wp, mesh%h >= 0) ! of two zeros max takes either
      if (mesh%h(1) > -huge(1.0_wp)) return ! else no pair is on the path: nothing overlaps, whatever the involutes would
      mesh%h = at%h
      if (contact%deviates) mesh%deviation = -gap - at%h
   end subroutine keep

end module evl_mesh_lanes
