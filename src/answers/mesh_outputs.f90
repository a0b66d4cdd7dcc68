!> What the meshes of a gearbox tell.
module evl_mesh_outputs
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_closed_form, only: closed_form_gap, closed_form_line, gap_along, points_along, transmission_error
   use evl_contact_tracking, only: algebraic_residual, line_distance, tracked_positions
   use evl_contacts_at_state, only: flank_place, place_contact
   use evl_discrete_state, only: leading_contact, take_mode
   use evl_flank, only: energy_gap
   use evl_gearbox, only: gearbox_local, gearbox_t, wheel_reference
   use evl_housing_outputs, only: add_mesh_reaction
   use evl_kinds, only: wp
   use evl_local_variables, only: at_lambda, at_track, n_local, n_track
   use evl_output, only: dims_mesh, in_coast, in_meshes, needs_meshes, needs_pairs, needs_points, needs_reactions
   use evl_pair_outputs, only: tell_pairs
   use evl_support, only: axle_motion
   use evl_tangent_line, only: tangent_line_t
   use evl_teller, only: begin, needs, tell, teller_t
   use evl_tooth_contact, only: contact_state, flank_coast, flank_drive, flanks_apart, flanks_loaded, flanks_off, &
                                locate_anywhere, no_force, tooth_contact_t, touches, tracking_closed_form
   implicit none (type, external)
   private

   public :: mesh_points, mesh_sum, place_points, put_mesh, tell_coast, tell_mesh

   real(wp), parameter :: nan = transfer(int(z"7FF8000000000000", int64), 1.0_wp)

   !> What the tooth contacts of a mesh add up to.
   type :: mesh_sum
      real(wp) :: normal = 0.0_wp, coast = 0.0_wp         !! F_n of all pairs, and of those on the coast flank [N]
      real(wp) :: friction = 0.0_wp                       !! F_t of the drive flank [N]
      real(wp) :: torque_a = 0.0_wp, torque_b = 0.0_wp    !! [N m]
      real(wp) :: loss = 0.0_wp                           !! power lost to friction [W]
      real(wp) :: damping_loss = 0.0_wp                   !! that the dampers take [W]
      real(wp) :: curvature_loss = 0.0_wp                 !! that the elastic energy loses by itself [W]
      integer :: loaded = 0                               !! pairs that carry load
      logical :: touching = .false.                       !! whether any flanks overlap
      real(wp) :: h(2) = -huge(1.0_wp)                    !! largest penetration on the drive flank, on the coast flank [m]
      real(wp) :: deviation(2) = 0.0_wp                   !! of the flanks there [m]
   end type mesh_sum

   !> The points of the contact that speaks for its mesh, and how far tracked ones are from where they belong.
   type :: mesh_points
      real(wp) :: driving(2) = nan, driven(2) = nan               !! housing frame [m]
      real(wp) :: gradient_ratio = nan                            !! lambda; as the rest NaN where points are not tracked
      real(wp) :: residual(2) = nan, line_distance(2) = nan       !! of the driving and of the driven flank [m]
   end type mesh_points

contains

   subroutine tell_mesh(teller, index, at, lag, curvature, penetration, total, points)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      type(contact_state), intent(in) :: at    !! the one that speaks for the mesh
      real(wp), intent(in) :: lag              !! transmission error [m]
      real(wp), intent(in) :: curvature        !! by how much it is more than the penetration [m]
      real(wp), intent(in) :: penetration      !! of flanks that overlap, else 0 [m]
      type(mesh_sum), intent(in) :: total
      type(mesh_points), intent(in) :: points

      call begin(teller, in_meshes, dims_mesh, index)
      call needs(teller, needs_meshes)
      call tell(teller, "transmission_error", "m", "Delta", "dynamic transmission error along the line of action", lag)
      call tell(teller, "penetration", "m", "h", "mutual penetration of the flanks", penetration)
      call tell(teller, "gap", "m", "kappa", "smallest gap between the flanks, negative in contact", -total%h(1))
      call tell(teller, "separation_curvature", "m", "", "R (inv alpha - inv alpha_0)", curvature)
      call tell(teller, "normal_force", "N", "F_n", "normal force of all tooth pairs", total%normal)
      call tell(teller, "friction_force", "N", "F_t", "friction force on the driving wheel along t, all pairs of the drive flank", &
                total%friction)
      call tell(teller, "sliding_velocity", "m s-1", "v_t", "sliding velocity along t", at%point%v_t, &
                no_rate="difference of the velocities of two flanks: no output has its integral")
      call tell(teller, "friction_arm_driving", "m", "l_A", "arm of the friction force about the driving axle", at%point%l_a)
      call tell(teller, "friction_arm_driven", "m", "l_B", "arm of the friction force about the driven axle", at%point%l_b)
      call needs(teller, needs_points)
      call tell(teller, "gradient_ratio", "1", "lambda", "ratio of the flanks' gradients", points%gradient_ratio)
      call tell(teller, "tracking_residual_driving", "m", "r_bA g_A", "distance of the tracked point from the driving flank", &
                points%residual(1))
      call tell(teller, "tracking_residual_driven", "m", "r_bB g_B", "distance of the tracked point from the driven flank", &
                points%residual(2))
      call tell(teller, "line_distance_driving", "m", "", "distance of the driving wheel's tracked point from the line of action", &
                points%line_distance(1))
      call tell(teller, "line_distance_driven", "m", "", "distance of the driven wheel's tracked point from the line of action", &
                points%line_distance(2))
      call needs(teller, needs_meshes)
      call tell(teller, "tooth_pair", "1", "k", "the tooth pair longest on the path: pitches since the start", at%mode%tooth_pair)
      call tell(teller, "in_contact", "1", "", "1 if the flanks of any tooth pair overlap", total%touching)
      call tell(teller, "contact_mode", "1", "", &
                "0 open, 1 loaded, 2 overlapping without force, 3 too far apart to track, 4 off the path", at%mode%flanks)
      call tell(teller, "gap_rate", "m s-1", "kappa'", "rate of the gap", 0 - at%point%h_dot, & ! never -0
                no_rate="of the tooth pair longest on the path; gap is that of the nearest flanks")
      call tell(teller, "flank_deviation", "m", "e", "material that the flanks lack where they are nearest to each other", &
                total%deviation(1))
      call tell(teller, "pairs_in_contact", "1", "", "tooth pairs that carry load, on both flanks", total%loaded)
      call tell(teller, "mesh_torque_driving", "N m", "T_A", "torque of the mesh on the driving wheel", total%torque_a)
      call tell(teller, "mesh_torque_driven", "N m", "T_B", "torque of the mesh on the driven wheel", total%torque_b)
      call tell(teller, "friction_loss", "W", "P_f", "power lost to friction", total%loss, rate_of="dissipated_energy")
      call tell(teller, "contact_damping_loss", "W", "P_d", "power lost in the dampers of the tooth pairs", total%damping_loss, &
                rate_of="dissipated_energy")
      call tell(teller, "curvature_loss", "W", "P_rho", &
                "power that the elastic energy loses as radii of curvature change; negative where it gains", total%curvature_loss, &
                rate_of="dissipated_energy")
      call tell(teller, "efficiency", "1", "eta", "1 - friction loss over the power that the driving wheel hands over", &
                efficiency(total, at%point%omega_a))
      call needs(teller, needs_points)
      call tell(teller, "contact_point_driving", "m", "P_A", "contact point on the driving flank", points%driving)
      call tell(teller, "contact_point_driven", "m", "P_B", "contact point on the driven flank", points%driven)
   end subroutine tell_mesh

   !> Only where a mesh has coast flanks.
   subroutine tell_coast(teller, index, gap, force)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      real(wp), intent(in) :: gap   !! [m]
      real(wp), intent(in) :: force !! [N]

      call begin(teller, in_coast, dims_mesh, index)
      call needs(teller, needs_meshes)
      call tell(teller, "coast_gap", "m", "kappa_c", "smallest gap between the flanks on the coast side", gap)
      call tell(teller, "coast_force", "N", "F_nc", "normal force of the tooth pairs on the coast side", force)
   end subroutine tell_coast

   !> A mesh at a state.
   subroutine put_mesh(teller, wanted, gearbox, index, t, y, integers, reals, contacts, torque, reactions, potential)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: wanted         !! what wanted outputs need
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index, integers(:)
      real(wp), intent(in) :: t, y(:), reals(:)
      !> As `gearbox_rates` leaves them; those of the mesh are completed.
      type(contact_state), intent(inout) :: contacts(size(gearbox%contacts))
      real(wp), intent(inout) :: torque(:)  !! of the meshes on the wheels so far [N m]
      real(wp), intent(inout) :: reactions(:, :) !! on the housing so far, (6, wheel): force [N], moment [N m]
      real(wp), intent(inout) :: potential  !! energy so far [J]
      type(mesh_sum) :: total
      type(mesh_points) :: points
      type(tangent_line_t) :: line
      real(wp) :: lag, penetration
      type(flank_place) :: place
      integer :: i, leader, m

      leader = leading_contact(gearbox, index, integers)
      do i = gearbox%contacts(gearbox%first(index))%i_flank, gearbox%contacts(gearbox%first(index + 1) - 1)%i_flank
         associate (flank => gearbox%flanks(i)%flank, first => gearbox%flanks(i)%flank%first, last => gearbox%flanks(i)%flank%last)
            place%of = 0
            do m = first, last
               if (touches(contacts(m)%mode)) cycle
               call take_mode(gearbox, m, integers, reals, contacts(m)%mode)
               call place_contact(gearbox, m, y, integers, place, contacts)
            end do
            call flank%find_overlaps(gearbox%contacts, first, last, contacts)
            call flank%add_energy(gearbox%contacts, first, last, contacts, potential)
            do m = first, last
               if (.not. touches(contacts(m)%mode)) contacts(m)%force = no_force
               if (contacts(m)%mode%flanks == flanks_off) cycle
               call add_contact(gearbox%contacts(m), contacts(m), total)
               if (touches(contacts(m)%mode) .and. iand(wanted, needs_reactions) == needs_reactions) &
                  call add_mesh_reaction(gearbox, gearbox%contacts(m), contacts(m)%force%on_a, reactions)
            end do
         end associate
      end do
      if (iand(wanted, needs_pairs) == needs_pairs) call tell_pairs(teller, gearbox, index, contacts)
      associate (contact => gearbox%contacts(leader), at => contacts(leader))
         if (at%mode%flanks == flanks_off .and. contact%tracking == tracking_closed_form) call locate_anywhere(contact, .false., at)
         torque(contact%wheel_a) = torque(contact%wheel_a) + total%torque_a
         torque(contact%wheel_b) = torque(contact%wheel_b) + total%torque_b
         lag = transmission_error(contact%pair, contact%axles_rest, at%q)
         call closed_form_line(contact%pair, at%q, line)
         if (iand(wanted, needs_points) == needs_points) call find_points(gearbox, contact, t, at, line, points)
         penetration = merge(total%h(1), 0.0_wp, total%h(1) >= 0) ! of two zeros max takes either
         if (.not. total%h(1) > -huge(1.0_wp)) then ! no pair is on the path: nothing overlaps, whatever the involutes would
            total%h(1) = at%point%h
            if (contact%deviates) total%deviation(1) = -closed_form_gap(contact%pair, at%q) - at%point%h
         end if
         call tell_mesh(teller, index, at, lag, gap_along(contact%pair, at%q, line) + lag, penetration, total, points)
      end associate
      if (gearbox%n_pair_places > gearbox%n_drive_places) call put_coast(teller, gearbox, index, y, total)
   end subroutine put_mesh

   !> What a tooth pair adds to its mesh.
   pure subroutine add_contact(contact, at, total)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      type(mesh_sum), intent(inout) :: total

      associate (mode => at%mode, point => at%point, force => at%force)
         total%normal = total%normal + force%normal
         if (contact%flank == flank_coast) total%coast = total%coast + force%normal
         if (contact%flank == flank_drive) total%friction = total%friction + force%friction
         total%torque_a = total%torque_a + force%torque_a
         total%torque_b = total%torque_b + force%torque_b
         total%loss = total%loss - force%friction*point%v_t
         if (touches(mode)) call add_losses(at, total)
         if (mode%flanks == flanks_loaded) total%loaded = total%loaded + 1
         if (point%h > total%h(1 + contact%flank)) then
            total%h(1 + contact%flank) = point%h
            if (contact%deviates) total%deviation(1 + contact%flank) = -closed_form_gap(contact%pair, at%q) - point%h
         end if
         total%touching = total%touching .or. merge(mode%flanks == flanks_loaded, point%h > 0, contact%rigid)
      end associate
   end subroutine add_contact

   !> What the damper of a pair that touches takes, up to all of the elastic force where it would pull; and what its elastic energy
   !> loses without the work of a force.
   pure subroutine add_losses(at, total)
      type(contact_state), intent(in) :: at
      type(mesh_sum), intent(inout) :: total

      total%damping_loss = total%damping_loss &
                           + merge(at%viscous%force, -at%elastic%force, at%mode%flanks == flanks_loaded)*at%point%h_dot
      total%curvature_loss = total%curvature_loss - energy_gap(at%point, at%elastic)
   end subroutine add_losses

   !> 1 - friction loss over the power that the driving wheel hands over; NaN without power.
   elemental real(wp) function efficiency(total, omega_a)
      type(mesh_sum), intent(in) :: total
      real(wp), intent(in) :: omega_a !! [rad/s]
      real(wp) :: input

      efficiency = ieee_value(efficiency, ieee_quiet_nan)
      input = abs(total%torque_a*omega_a)
      if (input > 0) efficiency = 1 - total%loss/input
   end function efficiency

   !> The points of the contact that speaks for its mesh.
   subroutine find_points(gearbox, contact, t, at, line, points)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: t
      type(contact_state), intent(in) :: at
      type(tangent_line_t), intent(in) :: line !! of action
      type(mesh_points), intent(out) :: points
      real(wp) :: q(n_local), residual(n_track)
      logical :: exists

      q = at%q
      associate (rho_a0 => at%rho_a0, distance => points%line_distance)
         if (contact%tracking == tracking_closed_form .or. at%mode%flanks == flanks_apart) then
            points%gradient_ratio = ieee_value(points%gradient_ratio, ieee_quiet_nan)
            points%residual = points%gradient_ratio
            distance = points%gradient_ratio
            call points_along(contact%pair, q, line, q(at_track:))
         else
            call algebraic_residual(contact%pair, rho_a0, q, residual, exists)
            points%gradient_ratio = q(at_lambda)
            points%residual = residual(5:6)
            call line_distance(contact%pair, rho_a0, q, distance(1), distance(2))
         end if
         call place_points(gearbox, contact, t, rho_a0, q, points%driving, points%driven)
      end associate
   end subroutine find_points

   !> Where tracked points are in the housing.
   pure subroutine place_points(gearbox, contact, t, rho_a0, q, driving, driven)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: t, rho_a0, q(n_local)    !! as of `tracked_positions`
      real(wp), intent(out) :: driving(2), driven(2)   !! [m]
      type(axle_motion) :: reference
      real(wp) :: point_a(2), point_b(2), origin(2)

      call tracked_positions(contact%pair, rho_a0, q, point_a, point_b)
      reference = wheel_reference(gearbox%wheels(contact%wheel_a), t)
      origin = contact%k_a0 + (reference%centre - gearbox%wheels(contact%wheel_a)%centre)
      driving = origin + point_a(1)*contact%t_0 + point_a(2)*contact%e_0
      driven = origin + point_b(1)*contact%t_0 + point_b(2)*contact%e_0
   end subroutine place_points

   !> The coast flanks of a mesh; without a pair on the path the gap between two perfect flanks. NaN if the mesh has none.
   subroutine put_coast(teller, gearbox, index, y, total)
      type(teller_t), intent(inout) :: teller
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(:)
      type(mesh_sum), intent(in) :: total
      real(wp) :: gap, q(n_local)

      associate (last => gearbox%contacts(gearbox%first(index + 1) - 1))
         if (last%flank /= flank_coast) then
            call tell_coast(teller, index, nan, nan)
            return
         end if
         gap = -total%h(2)
         if (.not. total%h(2) > -huge(1.0_wp)) then
            call gearbox_local(gearbox, last, y, q)
            gap = closed_form_gap(last%pair, q)
         end if
      end associate
      call tell_coast(teller, index, gap, total%coast)
   end subroutine put_coast

end module evl_mesh_outputs
