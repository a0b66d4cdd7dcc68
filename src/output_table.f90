!> What a gearbox tells about itself: one table of outputs, and their values at a state.
module evl_output_table
   use evl_gearbox, only: gearbox_t, i_theta, i_turns, wheel_speed
   use evl_housing, only: frame_t, housing_fixed, housing_frame
   use evl_housing_dynamics, only: coupled_rates
   use evl_housing_outputs, only: ground_energies, housing_outputs, n_housing_outputs, put_housing
   use evl_kinds, only: pi, wp
   use evl_mesh_outputs, only: coast_histories, has_coast, mesh_histories, n_coast_histories, n_mesh_histories, &
                               n_pair_histories, pair_histories, pair_places, put_mesh
   use evl_output, only: dims_mesh, dims_mesh_axis, dims_mesh_pair, dims_none, dims_quaternion, dims_shaft, dims_space, &
                         dims_wheel, dims_wheel_axis, dims_wheel_space, output_t
   use evl_shaft, only: shaft_energy
   use evl_shaft_outputs, only: n_shaft_outputs, put_shafts, shaft_outputs
   use evl_status, only: has_failed, status_t
   use evl_tooth_outputs, only: n_mesh_teeth, n_wheel_teeth, put_mesh_teeth, put_wheel_teeth, tooth_outputs
   use evl_torques, only: load_torques
   implicit none (type, external)
   private

   public :: n_outputs, gearbox_output_table, gearbox_outputs

   integer, parameter :: n_wheel_constants = 7, n_mesh_constants = 16, n_gearbox_histories = 6, n_wheel_histories = 7
   integer, parameter :: n_outputs = n_wheel_constants + n_mesh_constants + n_wheel_teeth + n_mesh_teeth &
                         + n_gearbox_histories + n_wheel_histories + n_mesh_histories + n_pair_histories &
                         + n_coast_histories + n_housing_outputs + n_shaft_outputs !! entries of the table

contains

   !> The table, in the order in which the values are filled.
   pure subroutine gearbox_output_table(gearbox, table)
      type(gearbox_t), intent(in) :: gearbox
      type(output_t), intent(out) :: table(n_outputs)
      type(output_t) :: coast(n_coast_histories)
      integer :: i, offset

      coast = coast_histories()
      table = [wheel_constants(), mesh_constants(), tooth_outputs(), gearbox_histories(), wheel_histories(), mesh_histories(), &
               pair_histories(), coast_histories(), housing_outputs(), shaft_outputs()]
      offset = 0
      do i = 1, size(table)
         table(i)%offset = offset
         table(i)%count = count_of(gearbox, table(i)%dims)
         if (.not. has_coast(gearbox) .and. any(table(i)%name == coast%name)) table(i)%count = 0
         offset = offset + table(i)%count
      end do
   end subroutine gearbox_output_table

   !> Number of values that outputs of these dimensions have.
   pure integer function count_of(gearbox, dims) result(n)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: dims

      select case (dims)
      case (dims_wheel)
         n = size(gearbox%wheels)
      case (dims_wheel_axis)
         n = 2*size(gearbox%wheels)
      case (dims_mesh)
         n = size(gearbox%pairs)
      case (dims_mesh_axis)
         n = 2*size(gearbox%pairs)
      case (dims_mesh_pair)
         n = size(gearbox%pairs)*pair_places(gearbox)
      case (dims_wheel_space)
         n = 3*size(gearbox%wheels)
      case (dims_space)
         n = merge(0, 3, gearbox%housing%kind == housing_fixed)
      case (dims_quaternion)
         n = merge(0, 4, gearbox%housing%kind == housing_fixed)
      case (dims_shaft)
         n = size(gearbox%shafts)
      case default
         n = 1
      end select
   end function count_of

   pure function wheel_constants() result(t)
      type(output_t) :: t(n_wheel_constants)

      t(1) = output_t("teeth", "1", "z", "number of teeth", dims_wheel, .true., .true.)
      t(2) = output_t("pitch_radius", "m", "r", "pitch radius; of a real gear its reference radius", dims_wheel, .true.)
      t(3) = output_t("base_radius", "m", "r_b", "base radius", dims_wheel, .true.)
      t(4) = output_t("tip_radius", "m", "r_a", "tip radius", dims_wheel, .true.)
      t(5) = output_t("mass", "kg", "m", "mass of the wheel", dims_wheel, .true.)
      t(6) = output_t("inertia", "kg m2", "J", "moment of inertia about the axle", dims_wheel, .true.)
      t(7) = output_t("centre", "m", "O", "reference position of the axle", dims_wheel_axis, .true.)
   end function wheel_constants

   pure function mesh_constants() result(t)
      type(output_t) :: t(n_mesh_constants)

      t(1) = output_t("driving_wheel", "1", "", "index of the driving wheel, from 0", dims_mesh, .true., .true.)
      t(2) = output_t("driven_wheel", "1", "", "index of the driven wheel, from 0", dims_mesh, .true., .true.)
      t(3) = output_t("flank", "1", "sigma", "+1: driving wheel nominally clockwise, -1: counterclockwise", dims_mesh, .true., &
                      .true.)
      t(4) = output_t("tracking", "1", "", "contact tracking: 0 closed form, 1 algebraic, 2 differential", dims_mesh, .true., &
                      .true.)
      t(5) = output_t("centre_line_angle", "rad", "chi", "direction from the driving to the driven axle", dims_mesh, .true.)
      t(6) = output_t("working_pressure_angle", "rad", "alpha_w", "working pressure angle", dims_mesh, .true.)
      t(7) = output_t("base_pitch", "m", "p_b", "base pitch", dims_mesh, .true.)
      t(8) = output_t("line_of_action_length", "m", "rho", "length of the line of action between the base circles", dims_mesh, &
                      .true.)
      t(9) = output_t("rho_start_driving", "m", "rho_A", "radius of curvature of the driving flank at the start of contact", &
                      dims_mesh, .true.)
      t(10) = output_t("rho_start_driven", "m", "rho_B", "radius of curvature of the driven flank at the start of contact", &
                       dims_mesh, .true.)
      t(11) = output_t("common_width", "m", "b", "common face width", dims_mesh, .true.)
      t(12) = output_t("effective_modulus", "Pa", "E_star", "effective modulus of elasticity", dims_mesh, .true.)
      t(13) = output_t("elastic_share_driving", "1", "w_A", "share of the driving wheel in the elastic compliance", dims_mesh, &
                       .true.)
      t(14) = output_t("reference_force", "N", "F_0", "normal force that the loads suggest", dims_mesh, .true.)
      t(15) = output_t("reference_penetration", "m", "h_0", "penetration under the reference force", dims_mesh, .true.)
      t(16) = output_t("rigid_contact", "1", "", "1 if the contact is rigid: a constraint without penetration", dims_mesh, &
                       .true., .true.)
   end function mesh_constants

   pure function gearbox_histories() result(t)
      type(output_t) :: t(n_gearbox_histories)

      t(1) = output_t("reference_angle", "rad", "theta", "angle of the reference wheel since the start, less whole turns")
      t(2) = output_t("reference_turns", "1", "", "whole turns of the reference wheel beside reference_angle", &
                      is_integer=.true.)
      t(3) = output_t("kinetic_energy", "J", "T", "kinetic energy")
      t(4) = output_t("potential_energy", "J", "V", "elastic energy of contacts, supports and shafts")
      t(5) = output_t("dissipated_energy", "J", "D", "energy lost to damping and friction since the start")
      t(6) = output_t("load_work", "J", "W", "work of the loads since the start")
   end function gearbox_histories

   pure function wheel_histories() result(t)
      type(output_t) :: t(n_wheel_histories)

      t(1) = output_t("angle", "rad", "phi", "angle since the start", dims_wheel)
      t(2) = output_t("angle_deviation", "rad", "psi", "angle less the nominal ratio times that of the reference wheel", &
                      dims_wheel)
      t(3) = output_t("angular_velocity", "rad s-1", "omega", "angular velocity", dims_wheel)
      t(4) = output_t("angular_acceleration", "rad s-2", "omega'", "angular acceleration", dims_wheel)
      t(5) = output_t("load_torque", "N m", "M", "torque of the loads", dims_wheel)
      t(6) = output_t("centre_displacement", "m", "u", "displacement of the axle from its reference position", dims_wheel_axis)
      t(7) = output_t("centre_velocity", "m s-1", "u'", "velocity of the axle", dims_wheel_axis)
   end function wheel_histories

   !> All values at a state, in the order of the table.
   subroutine gearbox_outputs(gearbox, t, y, integers, reals, values, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), reals(:)
      integer, intent(in) :: integers(:)
      real(wp), intent(out) :: values(gearbox%n_values)
      type(status_t), intent(inout) :: status
      real(wp) :: f(gearbox%n_states), reactions(6, size(gearbox%wheels))
      real(wp), dimension(size(gearbox%wheels)) :: torque, load_torque
      type(frame_t) :: frame
      integer :: nw, nm, i, at_teeth, at_time, at_wheels, at_meshes, at_pairs, at_coast, at_housing, at_shafts

      call coupled_rates(gearbox, t, y, integers, reals, f, status)
      if (has_failed(status)) return
      call housing_frame(gearbox%housing, t, y, frame, f)
      nw = size(gearbox%wheels)
      nm = size(gearbox%pairs)
      call put_wheel_constants(gearbox, nw, values)
      call put_mesh_constants(gearbox, nm, values(nw*(n_wheel_constants + 1) + 1))
      at_teeth = nw*(n_wheel_constants + 1) + nm*n_mesh_constants
      call put_wheel_teeth(gearbox, nw, values(at_teeth + 1))
      call put_mesh_teeth(gearbox, nm, values(at_teeth + nw*n_wheel_teeth + 1))
      at_time = at_teeth + nw*n_wheel_teeth + nm*n_mesh_teeth
      at_wheels = at_time + n_gearbox_histories
      at_meshes = at_wheels + nw*(n_wheel_histories + 2)
      at_pairs = at_meshes + nm*(n_mesh_histories + 2)
      at_coast = at_pairs + nm*pair_places(gearbox)*n_pair_histories
      at_housing = at_coast + merge(nm*n_coast_histories, 0, has_coast(gearbox))
      at_shafts = gearbox%n_values - size(gearbox%shafts)*n_shaft_outputs
      associate (kinetic => values(at_time + 3), potential => values(at_time + 4))
         kinetic = 0
         potential = 0
         torque = 0
         reactions = 0
         do i = 1, nm
            call put_mesh(gearbox, i, nm, pair_places(gearbox), y, integers, reals, torque, reactions, values(at_meshes + 1), &
                          values(at_meshes + nm*(n_mesh_histories - 2) + 1), values(at_pairs + 1), &
                          values(at_coast + 1:at_housing), potential, status)
         end do
         call load_torques(gearbox, t, y, f, frame, integers, torque, load_torque)
         do i = 1, nw
            call put_wheel(gearbox, i, nw, y, f, load_torque(i), integers, values(at_wheels + 1), &
                           values(at_wheels + nw*(n_wheel_histories - 2) + 1), kinetic, potential)
         end do
         do i = 1, size(gearbox%shafts)
            potential = potential + shaft_energy(gearbox%shafts(i), y)
         end do
         if (gearbox%housing%is_mounted) call ground_energies(gearbox, y, frame, kinetic, potential)
      end associate
      call put_housing(gearbox, t, y, f, integers, frame, load_torque, reactions, values(at_housing + 1:at_shafts))
      if (size(gearbox%shafts) > 0) &
         call put_shafts(gearbox, y, f, frame, torque + load_torque, size(gearbox%shafts), values(at_shafts + 1))
      values(at_time + 1) = y(i_theta)
      values(at_time + 2) = integers(i_turns)
      values(at_time + 5) = y(gearbox%i_dissipated)
      values(at_time + 6) = y(gearbox%i_work)
   end subroutine gearbox_outputs

   !> What does not change of the wheels.
   pure subroutine put_wheel_constants(gearbox, n, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: n !! wheels
      real(wp), intent(inout) :: values(n, n_wheel_constants + 1)
      integer :: i

      do i = 1, n
         associate (wheel => gearbox%wheels(i))
            values(i, :6) = [real(wheel%teeth, wp), wheel%pitch_radius, wheel%base_radius, wheel%tip_radius, wheel%mass, &
                             wheel%inertia]
            call put_pair(wheel%centre, i, n, values(1, 7))
         end associate
      end do
   end subroutine put_wheel_constants

   !> Components x and y of wheel or mesh i.
   pure subroutine put_pair(pair, i, n, values)
      real(wp), intent(in) :: pair(2)
      integer, intent(in) :: i, n
      real(wp), intent(inout) :: values(2, n)

      values(:, i) = pair
   end subroutine put_pair

   !> What does not change of the meshes.
   pure subroutine put_mesh_constants(gearbox, n, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: n !! meshes
      real(wp), intent(inout) :: values(n, n_mesh_constants)
      integer :: i

      do i = 1, n
         associate (mesh => gearbox%contacts(gearbox%first(i)), pair => gearbox%pairs(i))
            values(i, :) = [real(mesh%wheel_a - 1, wp), real(mesh%wheel_b - 1, wp), mesh%pair%sigma, real(mesh%tracking, wp), &
                            pair%chi, pair%alpha_w, mesh%base_pitch, mesh%pair%rho_0, pair%rho_start_a, pair%rho_start_b, &
                            mesh%width, mesh%e_star, mesh%pair%share_a, mesh%force_scale, mesh%h_scale, &
                            merge(1.0_wp, 0.0_wp, mesh%rigid)]
         end associate
      end do
   end subroutine put_mesh_constants

   !> A wheel at a state with its rates f.
   pure subroutine put_wheel(gearbox, index, n, y, f, torque, integers, scalars, pairs, kinetic, potential)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index, n, integers(:)
      real(wp), intent(in) :: y(:), f(:)
      real(wp), intent(in) :: torque                 !! of its loads [N m]
      real(wp), intent(inout) :: scalars(n, n_wheel_histories - 2), pairs(2, n, 2)
      real(wp), intent(inout) :: kinetic, potential  !! energies so far [J]
      real(wp) :: deviation, speed
      integer :: j

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support)
         deviation = 0
         if (wheel%i_psi > 0) deviation = y(wheel%i_psi)
         speed = wheel_speed(wheel, y)
         scalars(index, :) = [wheel%ratio*(y(i_theta) + 2*pi*integers(i_turns)) + deviation, deviation, speed, &
                              wheel_speed(wheel, f), torque]
         kinetic = kinetic + wheel%inertia*speed**2/2
         pairs(:, index, :) = 0
         do j = 1, support%n
            associate (i => support%i_state(j))
               pairs(:, index, 1) = pairs(:, index, 1) + y(i)*support%direction(:, j)
               pairs(:, index, 2) = pairs(:, index, 2) + y(i + 1)*support%direction(:, j)
               kinetic = kinetic + support%mass*y(i + 1)**2/2
               potential = potential + support%stiffness(j)*y(i)**2/2
            end associate
         end do
      end associate
   end subroutine put_wheel

end module evl_output_table
