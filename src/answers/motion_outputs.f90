!> Outputs of the gearbox as a whole, of its wheels and of its shafts.
module evl_motion_outputs
   use evl_gearbox, only: wheel_speed, wheel_t
   use evl_kinds, only: pi, wp
   use evl_local_variables, only: i_theta
   use evl_output, only: dims_none, dims_shaft, dims_wheel, in_gearbox, in_shaft_constants, in_shafts, in_wheels, needs_meshes, &
                         needs_nothing, needs_rates
   use evl_shaft, only: shaft_t
   use evl_springs_and_dampers, only: damper_power
   use evl_support, only: axle_deviation
   use evl_teller, only: begin, needs, tell, teller_t
   implicit none (type, external)
   private

   public :: wheel_motion, find_wheel_motion, tell_wheel
   public :: tell_shaft, tell_shaft_constants
   public :: tell_gearbox

   !> A wheel at a state.
   type :: wheel_motion
      real(wp) :: angle = 0.0_wp, deviation = 0.0_wp          !! [rad]
      real(wp) :: speed = 0.0_wp, acceleration = 0.0_wp       !! [rad/s], [rad/s^2]
      real(wp) :: load_torque = 0.0_wp                        !! [N m]
      !> Of the axle [m], [m/s], [m/s^2].
      real(wp) :: displacement(2) = 0.0_wp, velocity(2) = 0.0_wp, axle_acceleration(2) = 0.0_wp
      real(wp) :: damping_loss = 0.0_wp                       !! in the dampers of its support [W]
   end type wheel_motion

contains

   subroutine tell_wheel(teller, index, at)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      type(wheel_motion), intent(in) :: at

      call begin(teller, in_wheels, dims_wheel, index)
      call tell(teller, "angle", "rad", "phi", "angle since the start", at%angle)
      call tell(teller, "angle_deviation", "rad", "psi", "angle less the nominal ratio times that of the reference wheel", &
                at%deviation)
      call tell(teller, "angular_velocity", "rad s-1", "omega", "angular velocity", at%speed, rate_of="angle")
      call needs(teller, needs_rates)
      call tell(teller, "angular_acceleration", "rad s-2", "omega'", "angular acceleration", at%acceleration, &
                rate_of="angular_velocity")
      call needs(teller, needs_meshes)
      call tell(teller, "load_torque", "N m", "M", "torque of the loads", at%load_torque)
      call needs(teller, needs_nothing)
      call tell(teller, "centre_displacement", "m", "u", "displacement of the axle from its reference position", at%displacement)
      call tell(teller, "centre_velocity", "m s-1", "u'", "velocity of the axle", at%velocity, rate_of="centre_displacement")
      call needs(teller, needs_rates)
      call tell(teller, "centre_acceleration", "m s-2", "u''", "acceleration of the axle", at%axle_acceleration, &
                rate_of="centre_velocity")
      call needs(teller, needs_nothing)
      call tell(teller, "support_damping_loss", "W", "P_s", "power lost in the dampers of the support", at%damping_loss, &
                rate_of="dissipated_energy")
   end subroutine tell_wheel

   !> A wheel at a state with its rates f.
   pure subroutine find_wheel_motion(wheel, y, f, turns, load_torque, at, kinetic, potential)
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(in) :: y(:), f(:)
      integer, intent(in) :: turns                   !! whole turns of the reference wheel beside theta
      real(wp), intent(in) :: load_torque            !! of its loads [N m]
      type(wheel_motion), intent(out) :: at
      real(wp), intent(inout) :: kinetic, potential  !! energies so far [J]
      integer :: j

      if (wheel%i_psi > 0) at%deviation = y(wheel%i_psi)
      at%angle = wheel%ratio*(y(i_theta) + 2*pi*turns) + at%deviation
      at%speed = wheel_speed(wheel, y)
      at%acceleration = wheel_speed(wheel, f)
      at%load_torque = load_torque
      kinetic = kinetic + wheel%inertia*at%speed**2/2
      associate (support => wheel%support)
         if (support%n == 0) return
         at%displacement = axle_deviation(support, y, 0)
         at%velocity = axle_deviation(support, y, 1)
         at%axle_acceleration = axle_deviation(support, f, 1)
         do j = 1, support%n
            associate (i => support%i_state(j))
               kinetic = kinetic + support%mass*y(i + 1)**2/2
               potential = potential + support%stiffness(j)*y(i)**2/2
               at%damping_loss = at%damping_loss + damper_power(support%damping(j), y(i + 1))
            end associate
         end do
      end associate
   end subroutine find_wheel_motion

   subroutine tell_shaft_constants(teller, index, shaft)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      type(shaft_t), intent(in) :: shaft

      call begin(teller, in_shaft_constants, dims_shaft, index, is_static=.true.)
      call tell(teller, "shaft_wheel_first", "1", "", "index of the first wheel, from 0", shaft%wheel_a - 1)
      call tell(teller, "shaft_wheel_second", "1", "", "index of the second wheel, from 0", shaft%wheel_b - 1)
      call tell(teller, "rigid_shaft", "1", "", "1 if the shaft cannot twist", shaft%rigid)
      call tell(teller, "shaft_stiffness", "N m rad-1", "c", "torsional stiffness; 0 for a rigid shaft", shaft%stiffness)
      call tell(teller, "shaft_damping", "N m s rad-1", "d", "torsional damping; 0 for a rigid shaft", shaft%damping)
   end subroutine tell_shaft_constants

   subroutine tell_shaft(teller, index, torque, twist, loss)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      real(wp), intent(in) :: torque !! that it carries [N m]
      real(wp), intent(in) :: twist  !! [rad]
      real(wp), intent(in) :: loss   !! in its damper [W]

      call begin(teller, in_shafts, dims_shaft, index)
      call needs(teller, needs_meshes)
      call tell(teller, "shaft_torque", "N m", "T", "torque on the second wheel; on the first one its opposite", torque)
      call needs(teller, needs_nothing)
      call tell(teller, "shaft_twist", "rad", "", "angle of the first wheel less that of the second", twist)
      call tell(teller, "shaft_damping_loss", "W", "P_c", "power lost in the damping of the shaft", loss, &
                rate_of="dissipated_energy")
   end subroutine tell_shaft

   subroutine tell_gearbox(teller, theta, turns, kinetic, potential, dissipated, work)
      type(teller_t), intent(inout) :: teller
      real(wp), intent(in) :: theta                                !! [rad]
      integer, intent(in) :: turns
      real(wp), intent(in) :: kinetic, potential, dissipated, work !! [J]

      call begin(teller, in_gearbox, dims_none, 1)
      call tell(teller, "reference_angle", "rad", "theta", "angle of the reference wheel since the start, less whole turns", theta)
      call tell(teller, "reference_turns", "1", "", "whole turns of the reference wheel beside reference_angle", turns)
      call tell(teller, "kinetic_energy", "J", "T", "kinetic energy", kinetic)
      call needs(teller, needs_meshes)
      call tell(teller, "potential_energy", "J", "V", "elastic energy of contacts, supports and shafts", potential)
      call needs(teller, needs_nothing)
      call tell(teller, "dissipated_energy", "J", "D", "energy lost to damping and friction since the start", dissipated)
      call tell(teller, "load_work", "J", "W", "work of the loads since the start", work)
   end subroutine tell_gearbox

end module evl_motion_outputs
