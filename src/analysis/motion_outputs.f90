!> Outputs of the whole gearbox, of its wheels and of its shafts at eight states.
module evl_motion_outputs
   use evl_gearbox, only: gearbox_t, i_turns, wheel_t
   use evl_gearbox_lanes, only: add_row, lost_power_in_lanes
   use evl_housing_dynamics, only: ground_energies
   use evl_kinds, only: lanes, pi, wp
   use evl_line_lanes, only: turn_wheel
   use evl_local_variables, only: i_omega, i_theta
   use evl_output, only: dims_none, dims_shaft, dims_wheel, in_gearbox, in_losses, in_shaft_constants, in_shafts, in_wheels, &
                         needs_nothing, needs_rates, needs_torques
   use evl_output_registry, only: add_output, begin_section, needs, registry_t
   use evl_output_states, only: output_states
   use evl_shaft, only: shaft_t
   use evl_springs_and_dampers, only: damper_power
   use evl_support, only: support_t
   implicit none (type, external)
   private

   public :: add_gearbox_outputs, add_loss_outputs, add_shaft_constants, add_shaft_outputs, add_wheel_outputs
   public :: find_axle, find_energies, find_losses, find_shaft_motion, find_wheel_motion, gearbox_lanes, shaft_lanes, wheel_lanes

   !> The whole gearbox.
   type :: gearbox_lanes
      real(wp), dimension(lanes) :: theta            !! [rad]
      integer :: turns = 0
      real(wp), dimension(lanes) :: kinetic, potential, dissipated, work !! [J]
   end type gearbox_lanes

   !> A wheel.
   type :: wheel_lanes
      real(wp), dimension(lanes) :: angle, deviation    !! [rad]
      real(wp), dimension(lanes) :: speed, acceleration !! [rad/s], [rad/s^2]
      real(wp), dimension(lanes) :: load_torque = 0.0_wp !! [N m]
      !> Motion of the axle [m], [m/s], [m/s^2].
      real(wp), dimension(lanes, 2) :: displacement, velocity, axle_acceleration
      real(wp), dimension(lanes) :: damping_loss        !! power loss in the dampers of its support [W]
   end type wheel_lanes

   !> A shaft.
   type :: shaft_lanes
      real(wp), dimension(lanes) :: torque = 0.0_wp     !! on the second wheel [N m]
      real(wp), dimension(lanes) :: twist, loss         !! twist [rad], power loss in its damper [W]
   end type shaft_lanes

contains

   subroutine add_gearbox_outputs(registry, at)
      type(registry_t), intent(inout) :: registry
      type(gearbox_lanes), intent(in) :: at

      call begin_section(registry, in_gearbox, dims_none, 1)
      call add_output(registry, "reference_angle", "rad", "theta", &
                      "angle of the reference wheel since the start, less whole revolutions", at%theta)
      call add_output(registry, "reference_turns", "1", "", "whole revolutions of the reference wheel, in addition to" &
                      //" reference_angle", at%turns)
      call add_output(registry, "kinetic_energy", "J", "T", "kinetic energy", at%kinetic)
      call needs(registry, needs_rates)
      call add_output(registry, "potential_energy", "J", "V", "elastic energy of contacts, supports and shafts", at%potential)
      call needs(registry, needs_nothing)
      call add_output(registry, "dissipated_energy", "J", "D", "energy lost to damping and friction since the start", at%dissipated)
      call add_output(registry, "load_work", "J", "W", "work of the loads since the start", at%work)
   end subroutine add_gearbox_outputs

   subroutine add_wheel_outputs(registry, index, at)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      type(wheel_lanes), intent(in) :: at

      call begin_section(registry, in_wheels, dims_wheel, index)
      call add_output(registry, "angle", "rad", "phi", "angle since the start", at%angle)
      call add_output(registry, "angle_deviation", "rad", "psi", &
                      "angle less the nominal ratio times that of the reference wheel", at%deviation)
      call add_output(registry, "angular_velocity", "rad s-1", "omega", "angular velocity", at%speed, rate_of="angle")
      call needs(registry, needs_rates)
      call add_output(registry, "angular_acceleration", "rad s-2", "omega'", "angular acceleration", at%acceleration, &
                      rate_of="angular_velocity")
      call needs(registry, needs_torques)
      call add_output(registry, "load_torque", "N m", "M", "torque of the loads", at%load_torque)
      call needs(registry, needs_nothing)
      call add_output(registry, "centre_displacement", "m", "u", "displacement of the axle from its reference position", &
                      at%displacement)
      call add_output(registry, "centre_velocity", "m s-1", "u'", "velocity of the axle", at%velocity, &
                      rate_of="centre_displacement")
      call needs(registry, needs_rates)
      call add_output(registry, "centre_acceleration", "m s-2", "u''", "acceleration of the axle", at%axle_acceleration, &
                      rate_of="centre_velocity")
      call needs(registry, needs_nothing)
      call add_output(registry, "support_damping_loss", "W", "P_s", "power lost in the dampers of the support", at%damping_loss, &
                      rate_of="dissipated_energy")
   end subroutine add_wheel_outputs

   subroutine add_shaft_constants(registry, index, shaft)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      type(shaft_t), intent(in) :: shaft

      call begin_section(registry, in_shaft_constants, dims_shaft, index, is_static=.true.)
      call add_output(registry, "shaft_wheel_first", "1", "", "index of the first wheel, from 0", shaft%wheel_a - 1)
      call add_output(registry, "shaft_wheel_second", "1", "", "index of the second wheel, from 0", shaft%wheel_b - 1)
      call add_output(registry, "rigid_shaft", "1", "", "1 if the shaft cannot twist", shaft%rigid)
      call add_output(registry, "shaft_stiffness", "N m rad-1", "c", "torsional stiffness; 0 for a rigid shaft", shaft%stiffness)
      call add_output(registry, "shaft_damping", "N m s rad-1", "d", "torsional damping; 0 for a rigid shaft", shaft%damping)
   end subroutine add_shaft_constants

   subroutine add_shaft_outputs(registry, index, at)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      type(shaft_lanes), intent(in) :: at

      call begin_section(registry, in_shafts, dims_shaft, index)
      call needs(registry, needs_torques)
      call add_output(registry, "shaft_torque", "N m", "T", "torque on the second wheel; opposite on the first one", at%torque)
      call needs(registry, needs_nothing)
      call add_output(registry, "shaft_twist", "rad", "", "angle of the first wheel less that of the second", at%twist)
      call add_output(registry, "shaft_damping_loss", "W", "P_c", "power lost in the damping of the shaft", at%loss, &
                      rate_of="dissipated_energy")
   end subroutine add_shaft_outputs

   subroutine add_loss_outputs(registry, index, power)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      real(wp), intent(in) :: power(lanes) !! [W]

      call begin_section(registry, in_losses, dims_wheel, index)
      call add_output(registry, "load_loss", "W", "P_l", "power lost in the loads of the kind loss", power, &
                      rate_of="dissipated_energy")
   end subroutine add_loss_outputs

   !> Energies of the whole gearbox; those of a mounted housing are relative to the ground. Equations T69, T70.
   subroutine find_energies(gearbox, states, has_forces, at)
      type(gearbox_t), intent(in) :: gearbox
      type(output_states), intent(in) :: states
      logical, intent(in) :: has_forces !! otherwise the elastic energy of the contacts is omitted
      type(gearbox_lanes), intent(out) :: at
      real(wp) :: psi(lanes), rate(lanes), y(gearbox%n_states)
      integer :: i, l

      at%theta = states%y(:, i_theta)
      at%turns = states%integers(i_turns)
      at%dissipated = states%y(:, gearbox%i_dissipated)
      at%work = states%y(:, gearbox%i_work)
      at%kinetic = 0
      at%potential = 0
      do i = 1, merge(size(gearbox%flanks), 0, has_forces)
         associate (flank => gearbox%flanks(i)%flank)
            call flank%add_energy_in_lanes(gearbox%contacts, flank%first, flank%last, states%slots, at%potential)
         end associate
      end do
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            call turn_wheel(wheel%i_psi, states%y, psi, rate)
            call add_motion(wheel%inertia, wheel%ratio, states%y(:, i_omega), rate, at%kinetic)
            call add_support(wheel%support, states%y, at%kinetic, at%potential)
         end associate
      end do
      do i = 1, size(gearbox%shafts)
         call add_shaft(gearbox%shafts(i), states%y, at%potential)
      end do
      if (.not. gearbox%housing%is_mounted) return
      do l = 1, lanes
         y = states%y(l, :)
         call ground_energies(gearbox, y, states%frames(l), at%kinetic(l), at%potential(l))
      end do
   end subroutine find_energies

   !> Add the rotational energy of a wheel. Equation T69.
   pure subroutine add_motion(inertia, ratio, omega, rate, kinetic)
      real(wp), intent(in) :: inertia, ratio, omega(lanes), rate(lanes)
      real(wp), intent(inout) :: kinetic(lanes)
      integer :: l

      !$omp simd
      do l = 1, lanes
         kinetic(l) = kinetic(l) + inertia*(ratio*omega(l) + rate(l))**2/2
      end do
   end subroutine add_motion

   !> Add the energies of a support. Equations T69, T70.
   pure subroutine add_support(support, y, kinetic, potential)
      type(support_t), intent(in) :: support
      real(wp), intent(in) :: y(lanes, *)
      real(wp), intent(inout) :: kinetic(lanes), potential(lanes)
      integer :: j, l

      do j = 1, support%n
         associate (i => support%i_state(j))
            !$omp simd
            do l = 1, lanes
               kinetic(l) = kinetic(l) + support%mass*y(l, i + 1)**2/2
               potential(l) = potential(l) + support%stiffness(j)*y(l, i)**2/2
            end do
         end associate
      end do
   end subroutine add_support

   !> Add the energy of an elastic shaft. Equation T70.
   pure subroutine add_shaft(shaft, y, potential)
      type(shaft_t), intent(in) :: shaft
      real(wp), intent(in) :: y(lanes, *)
      real(wp), intent(inout) :: potential(lanes)
      type(shaft_lanes) :: at

      if (shaft%rigid) return
      call find_shaft_motion(shaft, y, at)
      potential = potential + shaft%stiffness*at%twist**2/2
   end subroutine add_shaft

   !> Motion of a wheel, without its loads.
   pure subroutine find_wheel_motion(wheel, states, has_rates, at)
      type(wheel_t), intent(in) :: wheel
      type(output_states), intent(in) :: states
      logical, intent(in) :: has_rates !! otherwise accelerations are not computed
      type(wheel_lanes), intent(inout) :: at
      real(wp), dimension(lanes) :: psi, rate
      integer :: j, turns

      turns = states%integers(i_turns)
      call turn_wheel(wheel%i_psi, states%y, at%deviation, rate)
      call find_turned(wheel%ratio, states%y(:, i_theta), 2*pi*turns, at%deviation, at%angle)
      call find_turned(wheel%ratio, states%y(:, i_omega), 0.0_wp, rate, at%speed)
      call find_axle(wheel%support, states%y, 0, at%displacement)
      call find_axle(wheel%support, states%y, 1, at%velocity)
      at%damping_loss = 0
      do j = 1, wheel%support%n
         at%damping_loss = at%damping_loss + damper_power(wheel%support%damping(j), states%y(:, wheel%support%i_state(j) + 1))
      end do
      if (.not. has_rates) return
      call turn_wheel(wheel%i_psi, states%f, psi, rate)
      call find_turned(wheel%ratio, states%f(:, i_omega), 0.0_wp, rate, at%acceleration)
      call find_axle(wheel%support, states%f, 1, at%axle_acceleration)
   end subroutine find_wheel_motion

   !> Rotation of a wheel: rotation of the gearbox times the ratio, plus the deviation of the wheel. Equation T21.
   pure subroutine find_turned(ratio, turned, whole, more, total)
      real(wp), intent(in) :: ratio, turned(lanes), whole, more(lanes)
      real(wp), intent(out) :: total(lanes)
      integer :: l

      !$omp simd
      do l = 1, lanes
         total(l) = ratio*(turned(l) + whole) + more(l)
      end do
   end subroutine find_turned

   !> Both components of the deviation of an axle, or of its rate.
   pure subroutine find_axle(support, y, order, axle)
      type(support_t), intent(in) :: support
      real(wp), intent(in) :: y(lanes, *) !! as for `axle_deviation`
      integer, intent(in) :: order
      real(wp), intent(out) :: axle(lanes, 2)
      integer :: j, k, l

      axle = 0
      do k = 1, 2
         do j = 1, support%n
            !$omp simd
            do l = 1, lanes
               axle(l, k) = axle(l, k) + y(l, support%i_state(j) + order)*support%direction(k, j)
            end do
         end do
      end do
   end subroutine find_axle

   !> Power lost in the loads of every wheel [W].
   subroutine find_losses(gearbox, states, power)
      type(gearbox_t), intent(in) :: gearbox
      type(output_states), intent(in) :: states
      real(wp), intent(out) :: power(lanes, size(gearbox%wheels))
      real(wp) :: spin(lanes), lost(lanes)
      integer :: i

      spin = 0
      if (states%has_frames) spin = states%frames%omega(3)
      power = 0
      do i = 1, size(gearbox%losses)
         associate (number => gearbox%losses(i))
            call lost_power_in_lanes(gearbox, number, states%t, states%y, states%integers, spin, lost)
            call add_row(lost, power(:, gearbox%loads(number)%load%wheel))
         end associate
      end do
   end subroutine find_losses

   !> Twist of a shaft and power loss of its damping; 0 for a rigid shaft.
   pure subroutine find_shaft_motion(shaft, y, at)
      type(shaft_t), intent(in) :: shaft
      real(wp), intent(in) :: y(lanes, *)
      type(shaft_lanes), intent(inout) :: at
      real(wp), dimension(lanes) :: psi_a, psi_b, rate_a, rate_b

      at%twist = 0
      at%loss = 0
      if (shaft%rigid) return
      call turn_wheel(shaft%i_psi_a, y, psi_a, rate_a)
      call turn_wheel(shaft%i_psi_b, y, psi_b, rate_b)
      at%twist = psi_a - psi_b
      at%loss = damper_power(shaft%damping, rate_a - rate_b)
   end subroutine find_shaft_motion

end module evl_motion_outputs
