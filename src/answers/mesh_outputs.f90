!> What the meshes of a gearbox tell: one table of outputs for meshes and one for their tooth pairs, and their values at a state.
module evl_mesh_outputs
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use evl_closed_form, only: closed_form_gap, closed_form_line, gap_along, points_along, track_closed_form, transmission_error
   use evl_contact_tracking, only: algebraic_residual, line_distance, tracked_positions
   use evl_gearbox, only: gearbox_local, gearbox_t, i_turns, leading_contact
   use evl_housing_outputs, only: add_mesh_reaction
   use evl_kinds, only: wp
   use evl_local_variables, only: at_lambda, at_track, i_theta, n_local, n_track
   use evl_output, only: dims_mesh, dims_mesh_axis, dims_mesh_pair, output_t
   use evl_tangent_line, only: tangent_line_t
   use evl_tooth_contact, only: contact_energy, contact_force, contact_mode, contact_state, flank_coast, flank_drive, &
                                flanks_apart, flanks_loaded, flanks_off, locate_contact, nominal_rho, tooth_of_a, tooth_of_b, &
                                touches, tracking_closed_form
   use evl_touching_flanks, only: contact_pressure
   implicit none (type, external)
   private

   public :: n_mesh_histories, n_pair_histories, n_coast_histories, mesh_histories, pair_histories, coast_histories
   public :: has_coast, pair_places, put_mesh

   integer, parameter :: n_mesh_histories = 26, n_pair_histories = 10, n_coast_histories = 2
   integer, parameter :: n_scalars = n_mesh_histories - 2 !! of a mesh; behind them two points

   !> What the tooth contacts of a mesh add up to.
   type :: mesh_sum
      real(wp) :: normal = 0.0_wp, coast = 0.0_wp         !! F_n of all pairs, and of those on the coast flank [N]
      real(wp) :: friction = 0.0_wp                       !! F_t of the drive flank [N]
      real(wp) :: torque_a = 0.0_wp, torque_b = 0.0_wp    !! [N m]
      real(wp) :: loss = 0.0_wp                           !! power lost to friction [W]
      integer :: loaded = 0                               !! pairs that carry load
      logical :: touching = .false.                       !! whether any flanks overlap
      real(wp) :: h(2) = -huge(1.0_wp)                    !! largest penetration on the drive flank, on the coast flank [m]
      real(wp) :: deviation(2) = 0.0_wp                   !! of the flanks there [m]
   end type mesh_sum

contains

   pure function mesh_histories() result(t)
      type(output_t) :: t(n_mesh_histories)

      t(1) = output_t("transmission_error", "m", "Delta", "dynamic transmission error along the line of action", dims_mesh)
      t(2) = output_t("penetration", "m", "h", "mutual penetration of the flanks", dims_mesh)
      t(3) = output_t("gap", "m", "kappa", "smallest gap between the flanks, negative in contact", dims_mesh)
      t(4) = output_t("separation_curvature", "m", "", "R (inv alpha - inv alpha_0)", dims_mesh)
      t(5) = output_t("normal_force", "N", "F_n", "normal force of all tooth pairs", dims_mesh)
      t(6) = output_t("friction_force", "N", "F_t", "friction force on the driving wheel along t, all pairs of the drive flank", &
                      dims_mesh)
      t(7) = output_t("sliding_velocity", "m s-1", "v_t", "sliding velocity along t", dims_mesh)
      t(8) = output_t("friction_arm_driving", "m", "l_A", "arm of the friction force about the driving axle", dims_mesh)
      t(9) = output_t("friction_arm_driven", "m", "l_B", "arm of the friction force about the driven axle", dims_mesh)
      t(10) = output_t("gradient_ratio", "1", "lambda", "ratio of the flanks' gradients", dims_mesh)
      t(11) = output_t("tracking_residual_driving", "m", "r_bA g_A", "distance of the tracked point from the driving flank", &
                       dims_mesh)
      t(12) = output_t("tracking_residual_driven", "m", "r_bB g_B", "distance of the tracked point from the driven flank", &
                       dims_mesh)
      t(13) = output_t("line_distance_driving", "m", "", "distance of the driving wheel's tracked point from the line of action", &
                       dims_mesh)
      t(14) = output_t("line_distance_driven", "m", "", "distance of the driven wheel's tracked point from the line of action", &
                       dims_mesh)
      t(15) = output_t("tooth_pair", "1", "k", "the tooth pair longest on the path: pitches since the start", dims_mesh, &
                       is_integer=.true.)
      t(16) = output_t("in_contact", "1", "", "1 if the flanks of any tooth pair overlap", dims_mesh, is_integer=.true.)
      t(17) = output_t("contact_mode", "1", "", &
                       "0 open, 1 loaded, 2 overlapping without force, 3 too far apart to track, 4 off the path", dims_mesh, &
                       is_integer=.true.)
      t(18) = output_t("gap_rate", "m s-1", "kappa'", "rate of the gap", dims_mesh)
      t(19) = output_t("flank_deviation", "m", "e", "material that the flanks lack where they are nearest to each other", dims_mesh)
      t(20) = output_t("pairs_in_contact", "1", "", "tooth pairs that carry load, on both flanks", dims_mesh, is_integer=.true.)
      t(21) = output_t("mesh_torque_driving", "N m", "T_A", "torque of the mesh on the driving wheel", dims_mesh)
      t(22) = output_t("mesh_torque_driven", "N m", "T_B", "torque of the mesh on the driven wheel", dims_mesh)
      t(23) = output_t("friction_loss", "W", "P_f", "power lost to friction", dims_mesh)
      t(24) = output_t("efficiency", "1", "eta", "1 - friction loss over the power that the driving wheel hands over", dims_mesh)
      t(25) = output_t("contact_point_driving", "m", "P_A", "contact point on the driving flank", dims_mesh_axis)
      t(26) = output_t("contact_point_driven", "m", "P_B", "contact point on the driven flank", dims_mesh_axis)
   end function mesh_histories

   pure function pair_histories() result(t)
      type(output_t) :: t(n_pair_histories)

      t(1) = output_t("pair_normal_force", "N", "F_nk", "normal force of a tooth pair", dims_mesh_pair)
      t(2) = output_t("pair_friction_force", "N", "F_tk", "friction force of a tooth pair on the driving wheel along t", &
                      dims_mesh_pair)
      t(3) = output_t("pair_position", "m", "rho_Ak", "radius of curvature of the driving flank at the contact; NaN off the path", &
                      dims_mesh_pair)
      t(4) = output_t("pair_contact_pressure", "Pa", "p_k", &
                      "largest contact pressure; NaN where a hollow flank has no Hertzian one", dims_mesh_pair)
      t(5) = output_t("pair_on_path", "1", "", "1 if the tooth pair is on the path of contact", dims_mesh_pair, is_integer=.true.)
      t(6) = output_t("pair_number", "1", "k", "the tooth pair: pitches since the start", dims_mesh_pair, is_integer=.true.)
      t(7) = output_t("pair_tooth_driving", "1", "", "its tooth of the driving wheel, from 0, counterclockwise", dims_mesh_pair, &
                      is_integer=.true.)
      t(8) = output_t("pair_tooth_driven", "1", "", "its tooth of the driven wheel, from 0, counterclockwise", dims_mesh_pair, &
                      is_integer=.true.)
      t(9) = output_t("pair_contact_mode", "1", "", &
                      "0 open, 1 loaded, 2 overlapping without force, 3 too far apart to track, 4 off the path", dims_mesh_pair, &
                      is_integer=.true.)
      t(10) = output_t("pair_penetration", "m", "h_k", "penetration of the flanks, negative for a gap; NaN off the path", &
                       dims_mesh_pair)
   end function pair_histories

   !> Only where a mesh has coast flanks.
   pure function coast_histories() result(t)
      type(output_t) :: t(n_coast_histories)

      t(1) = output_t("coast_gap", "m", "kappa_c", "smallest gap between the flanks on the coast side", dims_mesh)
      t(2) = output_t("coast_force", "N", "F_nc", "normal force of the tooth pairs on the coast side", dims_mesh)
   end function coast_histories

   !> Whether a mesh has coast flanks.
   pure logical function has_coast(gearbox)
      type(gearbox_t), intent(in) :: gearbox

      has_coast = any(gearbox%contacts%flank == flank_coast)
   end function has_coast

   !> Places for tooth pairs that every mesh has in the outputs: the slots of the drive flank, then those of the coast flank.
   pure integer function pair_places(gearbox) result(n)
      type(gearbox_t), intent(in) :: gearbox

      n = maxval(gearbox%contacts%n_slots)*merge(2, 1, has_coast(gearbox))
   end function pair_places

   !> A mesh at a state.
   subroutine put_mesh(gearbox, index, n, places, y, integers, contacts, torque, reactions, scalars, points, pairs, coast, &
                       potential)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index, n, places, integers(:)
      real(wp), intent(in) :: y(:)
      type(contact_state), intent(inout) :: contacts(:) !! as `gearbox_rates` leaves them; those of the mesh are completed
      real(wp), intent(inout) :: torque(:)  !! of the meshes on the wheels so far [N m]
      real(wp), intent(inout) :: reactions(:, :) !! on the housing so far, (6, wheel): force [N], moment [N m]
      real(wp), intent(inout) :: scalars(n, n_scalars), points(2, n, 2), pairs(places, n, n_pair_histories)
      real(wp), intent(inout) :: coast(:)   !! (n, n_coast_histories) as a vector, or of size 0
      real(wp), intent(inout) :: potential  !! energy so far [J]
      type(mesh_sum) :: total
      type(tangent_line_t) :: line
      real(wp) :: tracked(5), lag, curvature, input, q(n_local)
      integer :: m, place, leader, drive_slots

      leader = leading_contact(gearbox, index, integers)
      pairs(:, index, 1:2) = 0
      pairs(:, index, 3) = ieee_value(0.0_wp, ieee_quiet_nan)
      pairs(:, index, 4:8) = 0
      pairs(:, index, 9) = flanks_off
      pairs(:, index, 10) = ieee_value(0.0_wp, ieee_quiet_nan)
      drive_slots = maxval(gearbox%contacts%n_slots)
      do m = gearbox%first(index), gearbox%first(index + 1) - 1
         place = 1 + gearbox%contacts(m)%slot + merge(drive_slots, 0, gearbox%contacts(m)%flank == flank_coast)
         if (.not. touches(contacts(m)%mode)) call complete(gearbox, m, y, integers, contacts(m))
         call put_pair(gearbox, m, contacts(m), reactions, pairs(place, index, :), potential, total)
      end do
      associate (contact => gearbox%contacts(leader), leading => contacts(leader)%point)
         torque(contact%wheel_a) = torque(contact%wheel_a) + total%torque_a
         torque(contact%wheel_b) = torque(contact%wheel_b) + total%torque_b
         q = contacts(leader)%q
         call closed_form_line(contact%pair, q, line)
         call put_points(gearbox, leader, y, integers, contacts(leader)%mode, line, q, tracked, points(:, index, 1), &
                         points(:, index, 2))
         lag = transmission_error(contact%pair, q)
         curvature = gap_along(contact%pair, q, line) + lag
         scalars(index, 2) = max(total%h(1), 0.0_wp)
         if (.not. total%h(1) > -huge(1.0_wp)) then ! no pair is on the path: nothing overlaps, whatever the involutes would
            total%h(1) = leading%h
            if (contact%deviates) total%deviation(1) = -closed_form_gap(contact%pair, q) - leading%h
         end if
         input = abs(total%torque_a*leading%omega_a)
         scalars(index, 1) = lag
         scalars(index, 3:9) = [-total%h(1), curvature, total%normal, total%friction, leading%v_t, leading%l_a, leading%l_b]
         scalars(index, 10:14) = tracked
         scalars(index, 15:18) = [real(integers(contact%i_mode), wp), merge(1.0_wp, 0.0_wp, total%touching), &
                                  real(integers(contact%i_mode + 1), wp), -leading%h_dot]
         scalars(index, 19) = total%deviation(1)
      end associate
      scalars(index, 20:23) = [real(total%loaded, wp), total%torque_a, total%torque_b, total%loss]
      scalars(index, 24) = ieee_value(0.0_wp, ieee_quiet_nan)
      if (input > 0) scalars(index, 24) = 1 - total%loss/input
      if (size(coast) == 0) return
      coast(index) = coast_gap(gearbox, index, y)
      if (total%h(2) > -huge(1.0_wp)) coast(index) = -total%h(2)
      coast(n + index) = total%coast
   end subroutine put_mesh

   !> One tooth pair: its values, and what it adds to its mesh.
   subroutine put_pair(gearbox, m, at, reactions, values, potential, total)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m !! tooth at
      type(contact_state), intent(in) :: at
      real(wp), intent(inout) :: reactions(:, :)
      real(wp), intent(inout) :: values(n_pair_histories)
      real(wp), intent(inout) :: potential
      type(mesh_sum), intent(inout) :: total

      associate (contact => gearbox%contacts(m), mode => at%mode, point => at%point, force => at%force)
         values(6) = mode%tooth_pair
         values(7) = modulo(tooth_of_a(contact, mode%tooth_pair), gearbox%wheels(contact%wheel_a)%teeth)
         values(8) = modulo(tooth_of_b(contact, mode%tooth_pair), gearbox%wheels(contact%wheel_b)%teeth)
         values(9) = mode%flanks
         if (mode%flanks == flanks_off) return
         values(10) = point%h
         call add_mesh_reaction(gearbox, contact, force%on_a, reactions)
         potential = potential + contact_energy(contact, mode, point, force%elastic)
         values(1:3) = [force%normal, force%friction, point%rho_a]
         values(4) = contact_pressure(contact, mode, force%normal, point)
         values(5) = 1
         total%normal = total%normal + force%normal
         if (contact%flank == flank_coast) total%coast = total%coast + force%normal
         if (contact%flank == flank_drive) total%friction = total%friction + force%friction
         total%torque_a = total%torque_a + force%torque_a
         total%torque_b = total%torque_b + force%torque_b
         total%loss = total%loss - force%friction*point%v_t
         if (mode%flanks == flanks_loaded) total%loaded = total%loaded + 1
         if (point%h > total%h(1 + contact%flank)) then
            total%h(1 + contact%flank) = point%h
            if (contact%deviates) total%deviation(1 + contact%flank) = -closed_form_gap(contact%pair, at%q) - point%h
         end if
         total%touching = total%touching .or. merge(mode%flanks == flanks_loaded, point%h > 0, contact%rigid)
      end associate
   end subroutine put_pair

   !> Fill in what the rates leave out of a contact that does not touch: the point as its tracking sees it, or in closed form where
   !> tracking rests.
   pure subroutine complete(gearbox, m, y, integers, at)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m, integers(:)
      real(wp), intent(in) :: y(:)
      type(contact_state), intent(inout) :: at
      real(wp) :: rho_a0

      associate (contact => gearbox%contacts(m))
         call gearbox_local(gearbox, contact, y, at%q)
         rho_a0 = nominal_rho(contact, y(i_theta), integers(i_turns), at%mode%tooth_pair)
         if (at%mode%flanks == flanks_apart) then
            call track_closed_form(contact%pair, rho_a0, at%q, at%point)
         else
            call locate_contact(contact, at%mode, rho_a0, at%q, at%point)
         end if
         at%force = contact_force()
      end associate
   end subroutine complete

   !> The points of the contact that speaks for its mesh, and how far tracked ones are from where they belong.
   subroutine put_points(gearbox, m, y, integers, mode, line, q, tracked, driving, driven)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m !! tooth contact
      real(wp), intent(in) :: y(:)
      integer, intent(in) :: integers(:)
      type(contact_mode), intent(in) :: mode
      type(tangent_line_t), intent(in) :: line   !! of action
      real(wp), intent(inout) :: q(n_local) !! its local variables; those of the points are filled in where they are not tracked
      real(wp), intent(out) :: tracked(5), driving(2), driven(2)
      real(wp) :: rho_a0, residual(n_track), point_a(2), point_b(2)
      logical :: exists

      associate (contact => gearbox%contacts(m))
         rho_a0 = nominal_rho(contact, y(i_theta), integers(i_turns), mode%tooth_pair)
         tracked = ieee_value(tracked, ieee_quiet_nan)
         if (contact%tracking == tracking_closed_form .or. mode%flanks == flanks_apart) then
            call points_along(contact%pair, q, line, q(at_track:))
         else
            call algebraic_residual(contact%pair, rho_a0, q, residual, exists)
            tracked(1:3) = [q(at_lambda), residual(5), residual(6)]
            call line_distance(contact%pair, rho_a0, q, tracked(4), tracked(5))
         end if
         call tracked_positions(contact%pair, rho_a0, q, point_a, point_b)
         driving = contact%k_a0 + point_a(1)*contact%t_0 + point_a(2)*contact%e_0
         driven = contact%k_a0 + point_b(1)*contact%t_0 + point_b(2)*contact%e_0
      end associate
   end subroutine put_points

   !> Gap of the coast flank between two perfect flanks; NaN if there is none [m].
   real(wp) function coast_gap(gearbox, mesh, y) result(gap)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp), intent(in) :: y(:)
      real(wp) :: q(n_local)

      gap = ieee_value(gap, ieee_quiet_nan)
      associate (last => gearbox%contacts(gearbox%first(mesh + 1) - 1))
         if (last%flank == flank_drive) return
         call gearbox_local(gearbox, last, y, q)
         gap = closed_form_gap(last%pair, q)
      end associate
   end function coast_gap

end module evl_mesh_outputs
