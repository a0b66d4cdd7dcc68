!> Outputs of the meshes of a gearbox at eight states: sums over the tooth contacts of a mesh.
module evl_mesh_outputs
   use evl_closed_form, only: error_of_turns, points_along
   use evl_contact_lanes, only: contact_in_lanes, gap_in_lanes, lane_contact
   use evl_contact_point, only: tracked_pair
   use evl_contact_tracking, only: algebraic_residual, line_distance, tracked_positions
   use evl_discrete_state, only: leading_contact
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_local, gearbox_t, wheel_reference
   use evl_kinds, only: lanes, nan, wp
   use evl_line_lanes, only: centre_turn_in_lanes, lane_line, line_in_lanes, motion_in_lanes
   use evl_local_variables, only: at_lambda, at_track, n_local, n_track
   use evl_output, only: dims_mesh, in_coast, in_meshes, needs_meshes, needs_points, needs_positions
   use evl_output_registry, only: add_output, begin_section, needs, registry_t
   use evl_output_states, only: output_states
   use evl_support, only: axle_motion
   use evl_tangent_line, only: tangent_line_t
   use evl_tooth_contact, only: contact_mode, flank_coast, flank_drive, flanks_apart, flanks_loaded, flanks_off, flanks_open, &
                                no_mode, tooth_contact_t, tracking_closed_form
   implicit none (type, external)
   private

   public :: add_coast_outputs, add_mesh_outputs, evaluate_mesh, find_points, mesh_lanes, mesh_points

   !> A mesh, and the position of its leading contact.
   type :: mesh_lanes
      real(wp), dimension(lanes) :: penetration
      !> Normal force F_n of all pairs, and of those on the coast flank; friction force F_t of the drive flank [N].
      real(wp), dimension(lanes) :: normal = 0.0_wp, coast = 0.0_wp, friction = 0.0_wp
      real(wp), dimension(lanes) :: torque_a = 0.0_wp, torque_b = 0.0_wp !! [N m]
      !> Power lost to friction, to damping, and from the elastic energy as radii of curvature change [W].
      real(wp), dimension(lanes) :: loss = 0.0_wp, damping_loss = 0.0_wp, curvature_loss = 0.0_wp
      real(wp), dimension(lanes) :: touching = 0.0_wp      !! 1 if any flanks overlap, else 0
      integer :: loaded = 0                                !! number of loaded pairs
      !> Maximum penetrations of drive and coast flank; -huge: no pair is on the path; NaN: no such flank [m].
      real(wp), dimension(lanes) :: h = -huge(1.0_wp), h_coast = -huge(1.0_wp)
      real(wp), dimension(lanes) :: deviation = 0.0_wp     !! flank deviation of the pair with penetration h [m]
      real(wp), dimension(lanes) :: lag                    !! transmission error [m]
      real(wp), dimension(lanes) :: curvature              !! transmission error minus penetration [m]
      integer :: leader = 0                                !! index of the leading contact
      type(contact_mode) :: mode = no_mode                 !! of the leading contact
      type(lane_line) :: line                              !! its line of action; only its motion if positions are not needed
      real(wp), dimension(lanes) :: rho_a0, v_t, l_a, l_b, h_dot, omega_a = 0.0_wp !! of the leading contact, as in `lane_contact`
   end type mesh_lanes

   !> Contact points of the leading contact, and the errors of tracked points.
   type :: mesh_points
      real(wp), dimension(lanes, 2) :: driving = nan, driven = nan !! housing frame [m]
      real(wp) :: gradient_ratio(lanes) = nan                     !! lambda; NaN if points are not tracked, as the rest
      real(wp), dimension(lanes, 2) :: residual = nan, line_distance = nan !! of the driving and the driven flank [m]
   end type mesh_points

contains

   !> Rows of a mesh, and of its coast flanks, which only some gearboxes have.
   subroutine add_mesh_outputs(registry, index, mesh, points)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      type(mesh_lanes), intent(in) :: mesh
      type(mesh_points), intent(in) :: points

      call begin_section(registry, in_meshes, dims_mesh, index)
      call needs(registry, needs_meshes)
      call add_output(registry, "transmission_error", "m", "Delta", "dynamic transmission error along the line of action", mesh%lag)
      call needs(registry, needs_positions)
      call add_output(registry, "penetration", "m", "h", "mutual penetration of the flanks", mesh%penetration)
      call add_output(registry, "gap", "m", "kappa", "smallest gap between the flanks, negative in contact", -mesh%h)
      call add_output(registry, "separation_curvature", "m", "", "R (inv alpha - inv alpha_0)", mesh%curvature)
      call needs(registry, needs_meshes)
      call add_output(registry, "normal_force", "N", "F_n", "normal force of all tooth pairs", mesh%normal)
      call add_output(registry, "friction_force", "N", "F_t", &
                      "friction force on the driving wheel along t, all pairs of the drive flank", mesh%friction)
      call needs(registry, needs_positions)
      call add_output(registry, "sliding_velocity", "m s-1", "v_t", "sliding velocity along t", mesh%v_t, &
                      no_rate="difference of the velocities of two flanks: no output has its integral")
      call add_output(registry, "friction_arm_driving", "m", "l_A", "arm of the friction force about the driving axle", mesh%l_a)
      call add_output(registry, "friction_arm_driven", "m", "l_B", "arm of the friction force about the driven axle", mesh%l_b)
      call needs(registry, needs_points)
      call add_output(registry, "gradient_ratio", "1", "lambda", "ratio of the flanks' gradients", points%gradient_ratio)
      call add_output(registry, "tracking_residual_driving", "m", "r_bA g_A", &
                      "distance of the tracked point from the driving flank", points%residual(:, 1))
      call add_output(registry, "tracking_residual_driven", "m", "r_bB g_B", &
                      "distance of the tracked point from the driven flank", points%residual(:, 2))
      call add_output(registry, "line_distance_driving", "m", "", &
                      "distance of the driving wheel's tracked point from the line of action", points%line_distance(:, 1))
      call add_output(registry, "line_distance_driven", "m", "", &
                      "distance of the driven wheel's tracked point from the line of action", points%line_distance(:, 2))
      call needs(registry, needs_meshes)
      call add_output(registry, "tooth_pair", "1", "k", "the first tooth pair on the path: pitches since the start", &
                      mesh%mode%tooth_pair)
      call needs(registry, needs_positions)
      call add_output(registry, "in_contact", "1", "", "1 if the flanks of any tooth pair overlap", mesh%touching, &
                      is_integer=.true.)
      call needs(registry, needs_meshes)
      call add_output(registry, "contact_mode", "1", "", &
                      "0 open, 1 loaded, 2 overlapping without force, 3 too far apart to track, 4 off the path", mesh%mode%flanks)
      call needs(registry, needs_positions)
      call add_output(registry, "gap_rate", "m s-1", "kappa'", "rate of the gap", 0 - mesh%h_dot, & ! never -0
                      no_rate="of the first tooth pair on the path; gap is that of the nearest flanks")
      call add_output(registry, "flank_deviation", "m", "e", "deviation of the flanks (material removed) at their nearest points", &
                      mesh%deviation)
      call needs(registry, needs_meshes)
      call add_output(registry, "pairs_in_contact", "1", "", "number of loaded tooth pairs, on both flanks", mesh%loaded)
      call add_output(registry, "mesh_torque_driving", "N m", "T_A", "torque of the mesh on the driving wheel", mesh%torque_a)
      call add_output(registry, "mesh_torque_driven", "N m", "T_B", "torque of the mesh on the driven wheel", mesh%torque_b)
      call add_output(registry, "friction_loss", "W", "P_f", "power lost to friction", mesh%loss, rate_of="dissipated_energy")
      call add_output(registry, "contact_damping_loss", "W", "P_d", "power lost in the dampers of the tooth pairs", &
                      mesh%damping_loss, rate_of="dissipated_energy")
      call add_output(registry, "curvature_loss", "W", "P_rho", &
                      "loss of elastic energy by changing radii of curvature; negative for a gain", &
                      mesh%curvature_loss, rate_of="dissipated_energy")
      call needs(registry, needs_positions)
      call add_output(registry, "efficiency", "1", "eta", "1 - friction loss over the power of the driving wheel", &
                      efficiency(mesh%loss, mesh%torque_a, mesh%omega_a))
      call needs(registry, needs_points)
      call add_output(registry, "contact_point_driving", "m", "P_A", "contact point on the driving flank", points%driving)
      call add_output(registry, "contact_point_driven", "m", "P_B", "contact point on the driven flank", points%driven)
   end subroutine add_mesh_outputs

   !> Rows of the coast flank; only if a mesh has coast flanks.
   subroutine add_coast_outputs(registry, index, mesh)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      type(mesh_lanes), intent(in) :: mesh

      call begin_section(registry, in_coast, dims_mesh, index)
      call needs(registry, needs_positions)
      call add_output(registry, "coast_gap", "m", "kappa_c", "smallest gap between the flanks on the coast side", &
                      0 - mesh%h_coast) ! avoids a NaN of the opposite sign
      call needs(registry, needs_meshes)
      call add_output(registry, "coast_force", "N", "F_nc", "normal force of the tooth pairs on the coast side", mesh%coast)
   end subroutine add_coast_outputs

   !> 1 - friction loss over the power transmitted by the driving wheel; NaN without power.
   elemental real(wp) function efficiency(loss, torque_a, omega_a)
      real(wp), intent(in) :: loss     !! [W]
      real(wp), intent(in) :: torque_a !! [N m]
      real(wp), intent(in) :: omega_a  !! [rad/s]
      real(wp) :: input

      efficiency = nan
      input = abs(torque_a*omega_a)
      if (input > 0) efficiency = 1 - loss/input
   end function efficiency

   !> Contact points of the leading contact, one state after the other.
   subroutine find_points(gearbox, mesh, states, points)
      type(gearbox_t), intent(in) :: gearbox
      type(mesh_lanes), intent(in) :: mesh
      type(output_states), intent(in) :: states
      type(mesh_points), intent(out) :: points !! NaN if the contact is not tracked
      type(tangent_line_t) :: line
      real(wp) :: q(n_local), residual(n_track), y(gearbox%n_states)
      logical :: exists, tracks
      integer :: l

      associate (contact => gearbox%contacts(mesh%leader))
         tracks = contact%tracking /= tracking_closed_form .and. mesh%mode%flanks /= flanks_apart
         do l = 1, states%n
            y = states%y(l, :)
            call gearbox_local(gearbox, contact, y, q)
            if (tracks) then
               call algebraic_residual(contact%pair, mesh%rho_a0(l), q, residual, exists)
               points%gradient_ratio(l) = q(at_lambda)
               points%residual(l, :) = residual(5:6)
               call line_distance(contact%pair, mesh%rho_a0(l), q, points%line_distance(l, 1), points%line_distance(l, 2))
            else
               associate (along => mesh%line)
                  line = tangent_line_t(.true., along%d_rho(l), along%rho(l), along%angle(l), along%s(l), along%c(l))
               end associate
               call points_along(contact%pair, q, line, q(at_track:))
            end if
            call locate_points(gearbox, contact, states%t(l), mesh%rho_a0(l), q, points%driving(l, :), points%driven(l, :))
         end do
      end associate
   end subroutine find_points

   !> Positions of tracked points in the housing.
   pure subroutine locate_points(gearbox, contact, t, rho_a0, q, driving, driven)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: t, rho_a0, q(n_local)    !! as for `tracked_positions`
      real(wp), intent(out) :: driving(2), driven(2)   !! [m]
      type(axle_motion) :: reference
      real(wp) :: point_a(2), point_b(2), origin(2)

      call tracked_positions(contact%pair, rho_a0, q, point_a, point_b)
      reference = wheel_reference(gearbox%wheels(contact%wheel_a), t)
      origin = contact%k_a0 + (reference%centre - gearbox%wheels(contact%wheel_a)%centre)
      driving = origin + point_a(1)*contact%t_0 + point_a(2)*contact%e_0
      driven = origin + point_b(1)*contact%t_0 + point_b(2)*contact%e_0
   end subroutine locate_points

   !> Evaluate a mesh at eight states.
   subroutine evaluate_mesh(gearbox, index, states, has_positions, mesh)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      type(output_states), intent(in) :: states
      logical, intent(in) :: has_positions !! otherwise positions of contacts that do not touch are not needed
      type(mesh_lanes), intent(out) :: mesh
      type(lane_line) :: line_coast
      type(tracked_pair) :: pair
      real(wp), dimension(lanes) :: gap, gap_coast, turn
      integer :: c, first, last

      first = gearbox%first(index)
      last = gearbox%first(index + 1) - 1
      if (gearbox%contacts(last)%flank /= flank_coast) mesh%coast = nan
      mesh%leader = leading_contact(gearbox, index, states%integers)
      mesh%mode = states%slots(mesh%leader)%mode
      associate (leader => gearbox%contacts(mesh%leader))
         if (has_positions) then
            call line_in_lanes(leader, states%y, mesh%line)
         else
            call motion_in_lanes(leader, states%y, mesh%line)
         end if
         pair = leader%pair
         call centre_turn_in_lanes(leader, mesh%line, turn)
         mesh%lag = error_of_turns(pair, mesh%line%psi_a, mesh%line%psi_b, turn)
      end associate
      if (has_positions) call gap_in_lanes(gearbox%contacts(mesh%leader), mesh%line, gap)
      do c = first, last
         associate (contact => gearbox%contacts(c), slot => states%slots(c))
            if (slot%touches) call add_force(contact%flank == flank_drive, slot, mesh)
            if (.not. has_positions .or. slot%mode%flanks == flanks_off) cycle
            if (slot%touches) then
               call add_position(contact, slot%mode, slot%at%h, gap, mesh)
            else
               call add_position(contact, slot%mode, states%aside(c)%at%h, gap, mesh)
            end if
         end associate
      end do
      if (.not. has_positions) return
      mesh%curvature = gap + mesh%lag
      call lead(gearbox%contacts(mesh%leader), states%slots(mesh%leader), states%aside(mesh%leader), gap, mesh)
      if (mesh%h_coast(1) > -huge(1.0_wp)) return
      if (gearbox%contacts(last)%flank /= flank_coast) then
         mesh%h_coast = nan
         return
      end if
      call line_in_lanes(gearbox%contacts(last), states%y, line_coast) ! no pair of the coast flank is on the path
      call gap_in_lanes(gearbox%contacts(last), line_coast, gap_coast)
      mesh%h_coast = -gap_coast
   end subroutine evaluate_mesh

   !> Add the contribution of a touching tooth pair.
   pure subroutine add_force(is_drive, slot, mesh)
      logical, intent(in) :: is_drive
      type(lane_slot), intent(in) :: slot
      type(mesh_lanes), intent(inout) :: mesh
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

   !> Add the position of a tooth pair on the path.
   pure subroutine add_position(contact, mode, h, gap, mesh)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      real(wp), intent(in) :: h(lanes), gap(lanes) !! penetration; gap of the drive flanks without deviations [m]
      type(mesh_lanes), intent(inout) :: mesh
      integer :: l

      if (contact%rigid) then ! rigid flanks never overlap
         if (mode%flanks == flanks_loaded) mesh%touching = 1
      else
         mesh%touching = merge(1.0_wp, mesh%touching, h > 0)
      end if
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
   end subroutine add_position

   !> Position of the leading contact; off the path, its position on the continued path.
   subroutine lead(contact, slot, aside, gap, mesh)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(in) :: slot, aside
      real(wp), intent(in) :: gap(lanes)
      type(mesh_lanes), intent(inout) :: mesh
      type(lane_contact) :: at
      type(contact_mode) :: mode

      if (slot%touches) then
         call copy_lead(contact, slot%at, gap, mesh)
      else if (slot%mode%flanks /= flanks_off .or. contact%tracking /= tracking_closed_form) then
         call copy_lead(contact, aside%at, gap, mesh)
      else
         mode = slot%mode
         mode%flanks = flanks_open ! otherwise only the radii would be computed
         call contact_in_lanes(contact, mode, slot%rho_start, mesh%line, at)
         call copy_lead(contact, at, gap, mesh)
      end if
   end subroutine lead

   !> Copy the position of the leading contact.
   pure subroutine copy_lead(contact, at, gap, mesh)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_contact), intent(in) :: at
      real(wp), intent(in) :: gap(lanes)
      type(mesh_lanes), intent(inout) :: mesh

      mesh%rho_a0 = at%rho_a0
      mesh%v_t = at%v_t
      mesh%l_a = at%l_a
      mesh%l_b = at%l_b
      mesh%h_dot = at%h_dot
      mesh%omega_a = at%omega_a
      mesh%penetration = merge(mesh%h, 0.0_wp, mesh%h >= 0) ! the sign of max of two zeros is arbitrary
      if (mesh%h(1) > -huge(1.0_wp)) return ! otherwise no pair is on the path: no overlap of flanks, even if the involutes overlap
      mesh%h = at%h
      if (contact%deviates) mesh%deviation = -gap - at%h
   end subroutine copy_lead

end module evl_mesh_outputs
