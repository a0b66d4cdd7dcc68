!> What a gearbox tells about itself: one table of outputs, and their values at a state.
module evl_outputs
   use evl_constant_outputs, only: constant_outputs, n_constant_outputs
   use evl_gearbox, only: gearbox_t, i_turns, wheel_speed
   use evl_housing, only: frame_t, housing_fixed, housing_frame
   use evl_housing_dynamics, only: coupled_rates, ground_energies
   use evl_housing_outputs, only: housing_outputs, n_housing_outputs, put_housing
   use evl_kinds, only: pi, wp
   use evl_local_variables, only: i_theta
   use evl_mesh_outputs, only: coast_histories, has_coast, mesh_histories, n_coast_histories, n_mesh_histories, &
                               n_pair_histories, pair_histories, pair_places, put_mesh
   use evl_mode_check, only: check_known_contacts
   use evl_output, only: dims_mesh, dims_mesh_axis, dims_mesh_pair, dims_none, dims_quaternion, dims_shaft, dims_space, &
                         dims_wheel, dims_wheel_axis, dims_wheel_space, output_t
   use evl_outside_torques, only: load_torques
   use evl_shaft, only: shaft_energy
   use evl_shaft_outputs, only: n_shaft_outputs, put_shafts, shaft_outputs
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: contact_state
   implicit none (type, external)
   private

   public :: n_outputs, output_table, gearbox_output_places, gearbox_outputs

   integer, parameter :: n_gearbox_histories = 6, n_wheel_histories = 7
   integer, parameter :: first_coast = n_constant_outputs + n_gearbox_histories + n_wheel_histories + n_mesh_histories &
                         + n_pair_histories + 1
   integer, parameter :: n_outputs = first_coast - 1 + n_coast_histories + n_housing_outputs + n_shaft_outputs !! of the table

contains

   !> The table, in the order in which the values are filled.
   pure function output_table() result(table)
      type(output_t) :: table(n_outputs)

      table = [constant_outputs(), gearbox_histories(), wheel_histories(), mesh_histories(), pair_histories(), coast_histories(), &
               housing_outputs(), shaft_outputs()]
   end function output_table

   !> Where the outputs of a gearbox stand among the values.
   pure subroutine gearbox_output_places(gearbox, offset, count)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(out) :: offset(n_outputs) !! from 0
      integer, intent(out) :: count(n_outputs)  !! 0: it is not there
      type(output_t) :: table(n_outputs)
      integer :: i

      table = output_table()
      do i = 1, n_outputs
         count(i) = count_of(gearbox, table(i)%dims)
      end do
      if (.not. has_coast(gearbox)) count(first_coast:first_coast + n_coast_histories - 1) = 0
      offset(1) = 0
      do i = 2, n_outputs
         offset(i) = offset(i - 1) + count(i - 1)
      end do
   end subroutine gearbox_output_places

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
   subroutine gearbox_outputs(gearbox, t, y, integers, reals, check, values, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), reals(:)
      integer, intent(in) :: integers(:)
      logical, intent(in) :: check !! whether to refuse a state that contradicts its modes, as `check_modes` does
      real(wp), intent(out) :: values(gearbox%n_values)
      type(status_t), intent(inout) :: status
      real(wp) :: f(gearbox%n_states), reactions(6, size(gearbox%wheels))
      real(wp), dimension(size(gearbox%wheels)) :: torque, load_torque
      type(frame_t) :: frame
      type(contact_state) :: contacts(size(gearbox%contacts))
      integer :: nw, nm, places, i, at_time, at_wheels, at_meshes, at_pairs, at_coast, at_housing, at_shafts

      call coupled_rates(gearbox, t, y, integers, reals, f, status, contacts)
      if (has_failed(status)) return
      call housing_frame(gearbox%housing, t, y, frame, f)
      nw = size(gearbox%wheels)
      nm = size(gearbox%pairs)
      at_time = size(gearbox%constants)
      values(:at_time) = gearbox%constants
      at_wheels = at_time + n_gearbox_histories
      at_meshes = at_wheels + nw*(n_wheel_histories + 2)
      at_pairs = at_meshes + nm*(n_mesh_histories + 2)
      places = pair_places(gearbox)
      at_coast = at_pairs + nm*places*n_pair_histories
      at_housing = at_coast + merge(nm*n_coast_histories, 0, has_coast(gearbox))
      at_shafts = gearbox%n_values - size(gearbox%shafts)*n_shaft_outputs
      associate (kinetic => values(at_time + 3), potential => values(at_time + 4))
         kinetic = 0
         potential = 0
         torque = 0
         reactions = 0
         do i = 1, nm
            call put_mesh(gearbox, i, nm, places, y, integers, contacts, torque, reactions, values(at_meshes + 1), &
                          values(at_meshes + nm*(n_mesh_histories - 2) + 1), values(at_pairs + 1), &
                          values(at_coast + 1:at_housing), potential)
         end do
         if (check) call check_known_contacts(gearbox, y, integers, reals, contacts, status)
         if (has_failed(status)) return
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

end module evl_outputs
