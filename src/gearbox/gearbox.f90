!> A gearbox: wheels on supports with loads, and the shafts and meshes between them, as one differential-algebraic system.
!>
!> Wheels joined by rigid shafts are one rotor: they share psi and psi', and their inertias and torques add. One of its wheels, the
!> leader, represents the rotor in operations that are done once per rotor.
!>
!> State, in this order:
!>
!>    theta, omega               angle and speed of the reference wheel
!>    psi_i, psi_i'              of every rotor except that of the reference wheel: phi_i = g_i theta + psi_i, g_i the kinematic
!>                               speed ratio
!>    s_j, s_j'                  of every degree of freedom of a support, from its reference position
!>    turn, zeta, dr, lambda, mu   of every mesh that tracks its contact points, see evl_contact_tracking
!>    r, p, v, Omega             of a mounted housing, see evl_housing
!>    multiplier                 of every flank with rigid contact: its normal force
!>    dissipated energy, work of the loads
!>
!> Discrete integers: revolutions of the reference wheel in addition to theta; those of every tooth contact, see evl_discrete_state;
!> number of knots passed in every table. Discrete reals: the approach speed at the last closing of every tooth contact.
module evl_gearbox
   use evl_first_tooth_pair, only: tooth_phase_t
   use evl_flank, only: flank_slot
   use evl_flank_deviation, only: flank_deviation_t
   use evl_flash_temperature, only: mesh_thermal_t
   use evl_gear, only: gear_t
   use evl_gears_in_mesh, only: gear_mesh_t
   use evl_housing, only: apparent_acceleration, frame_t, housing_t
   use evl_jacobian_entries, only: add_entry, jacobian_entries
   use evl_kinds, only: wp
   use evl_load, only: load_t
   use evl_local_variables, only: i_omega, i_theta, n_local
   use evl_mesh_geometry, only: spur_pair_t
   use evl_mesh_reference, only: mesh_reference_t
   use evl_rational, only: rational_t
   use evl_root_stress, only: root_stress_t
   use evl_shaft, only: shaft_t
   use evl_status, only: status_t
   use evl_support, only: axle_deviation, axle_motion, support_t
   use evl_tooth_contact, only: tooth_contact_t
   use evl_wheel_compliance, only: wheel_compliance_t
   implicit none (type, external)
   private

   public :: add_turn, of_angle, of_speed
   public :: gearbox_t, load_slot, nominal_point_t, wheel_t
   public :: axle_acceleration, transport_acceleration, gearbox_local, wheel_position, wheel_reference, wheel_speed
   public :: i_turns

   integer, parameter :: i_turns = 1 !! index of the turns in the discrete state
   integer, parameter :: of_angle = 0, of_speed = i_omega - i_theta !! offsets from the index of the angle

   type :: wheel_t
      integer :: teeth = 0                   !! 0: a disc
      logical :: has_radius = .true.         !! false: a disc of given mass and inertia, whose pitch radius follows from these
      real(wp) :: pitch_radius = 0.0_wp, base_radius = 0.0_wp, tip_radius = 0.0_wp !! [m]; base and tip 0 without a mesh
      real(wp) :: centre(2) = 0.0_wp         !! reference position of the axle [m]
      real(wp) :: mass = 0.0_wp              !! of the wheel alone [kg]
      real(wp) :: inertia = 0.0_wp           !! about the axle [kg m^2]
      real(wp) :: transverse_inertia = 0.0_wp !! about a diameter [kg m^2]
      real(wp) :: axial_position = 0.0_wp    !! z of its middle plane [m]
      type(rational_t) :: exact_ratio        !! g: nominal speed over that of the reference wheel
      real(wp) :: ratio = 0.0_wp             !! g as a real number
      integer :: leader = 0                  !! wheel that represents its rotor
      real(wp) :: rotor_inertia = 0.0_wp     !! of all wheels of its rotor about the axle [kg m^2]
      real(wp) :: per_inertia = 0.0_wp       !! its inverse
      integer, allocatable :: loads(:)       !! loads of the gearbox that act on it
      integer :: i_psi = 0                   !! index of psi in the state, psi' follows; 0 in the rotor of the reference wheel
      integer :: i_speed = 0                 !! row of the rate of its speed: i_omega or i_psi + 1
      integer :: prescribed = 0              !! load that prescribes the speed of its rotor; 0: none
      type(support_t) :: support
      type(flank_deviation_t) :: deviation   !! of its flanks from the involute
      integer :: tolerance_class = 0         !! flank tolerance class of ISO 1328-1; 0: none
      real(wp) :: width = 0.0_wp             !! face width [m]
      real(wp) :: density = 0.0_wp           !! of its material [kg/m^3]
   end type wheel_t

   !> A load of any kind.
   type :: load_slot
      class(load_t), allocatable :: load
   end type load_slot

   !> Nominal operating point, see evl_nominal_point.
   type :: nominal_point_t
      logical :: is_balanced = .true.       !! whether the loads balance at some speed; otherwise they accelerate the wheels
      real(wp) :: speed = 0.0_wp            !! of the reference wheel, counterclockwise positive [rad/s]
      real(wp) :: speed_scale = 0.0_wp      !! its magnitude, or that after 1 s under harmonic torques; 0: at standstill [rad/s]
      real(wp), allocatable :: force(:)     !! of each mesh: normal force, > 0 on the drive flanks, < 0 on the coast flanks [N]
      real(wp), allocatable :: torque(:)    !! of each shaft, on its second wheel [N m]; 0 for a rigid one
      real(wp) :: torque_scale = 0.0_wp     !! torque that the loads transmit through the train, at the reference wheel [N m]
      real(wp), allocatable :: mesh_load(:) !! of each mesh: |force|, or the amplitude under harmonic torques; 0: unloaded [N]
      real(wp), allocatable :: mesh_scale(:), shaft_scale(:) !! |force| and |torque|, or torque_scale referred to mesh and shaft
   end type nominal_point_t

   type :: gearbox_t
      type(wheel_t), allocatable :: wheels(:)
      type(load_slot), allocatable :: loads(:)
      integer, allocatable :: losses(:)           !! loads whose power is dissipated
      type(shaft_t), allocatable :: shafts(:)
      type(tooth_contact_t), allocatable :: contacts(:) !! by mesh: slots of the drive flank, then of the coast flank
      type(flank_slot), allocatable :: flanks(:)  !! in the order of their contacts
      type(spur_pair_t), allocatable :: pairs(:)  !! geometry of each mesh
      type(tooth_phase_t), allocatable :: phases(:) !! first tooth pair of each mesh
      integer, allocatable :: first(:)            !! first tooth contact of each mesh; after the last mesh, the total number + 1
      type(gear_t), allocatable :: gears(:)            !! of each wheel; default values for a wheel without a basic rack
      type(wheel_compliance_t), allocatable :: compliances(:) !! of each wheel
      type(root_stress_t), allocatable :: root_stresses(:) !! of each wheel; only on request
      type(gear_mesh_t), allocatable :: gear_meshes(:) !! of each mesh; default values without a basic rack
      type(mesh_thermal_t), allocatable :: thermal(:)  !! of each mesh; only on request
      logical :: has_root_outputs = .false.            !! the root stress is among the outputs
      type(nominal_point_t) :: nominal            !! nominal operating point
      type(mesh_reference_t), allocatable :: references(:) !! each mesh at its nominal load
      type(housing_t) :: housing
      integer, allocatable :: output_offsets(:), output_counts(:) !! position of each output in the values: offset from 0, count
      integer, allocatable :: rows_before(:)      !! rows before each section of the output table
      integer, allocatable :: output_needs(:)     !! computations required by each output
      logical, allocatable :: output_is_constant(:)
      real(wp), allocatable :: constants(:)       !! [n_values] constant values; 0 for all others
      integer :: n_pair_slots = 0, n_drive_slots = 0 !! slots for tooth pairs of a mesh in the outputs: all, drive flank
      type(status_t), allocatable :: warnings(:) !! from the creation
      type(status_t) :: start_refusal            !! error if no simulation can start: a damping law requires a load
      integer :: reference = 1               !! wheel whose angle is theta, the leader of its rotor
      integer :: n_states = 0, n_integers = 0, n_values = 0 !! lengths of the state, the discrete state and the outputs
      integer :: n_multipliers = 0            !! number of flanks with rigid contact
      integer :: n_roots = 0                  !! number of root functions
      integer :: i_dissipated = 0, i_work = 0 !! indices of the two energies in the state
   end type gearbox_t

contains

   !> Local variables of a mesh from the state.
   pure subroutine gearbox_local(gearbox, contact, y, q)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: y(gearbox%n_states)
      real(wp), intent(out) :: q(n_local)
      integer :: i

      q = 0
      do i = 1, size(contact%links)
         associate (link => contact%links(i))
            q(link%local) = q(link%local) + link%weight*y(link%state)
         end associate
      end do
   end subroutine gearbox_local

   !> Angular velocity of a wheel [rad/s]. Equation T21.
   pure real(wp) function wheel_speed(wheel, y) result(omega)
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(in) :: y(*)

      omega = wheel%ratio*y(i_omega)
      if (wheel%i_psi > 0) omega = omega + y(wheel%i_psi + 1)
   end function wheel_speed

   !> Add a multiple of the gradient of a wheel's angle or speed to a row.
   pure subroutine add_turn(wheel, order, row, factor, entries, values)
      type(wheel_t), intent(in) :: wheel
      integer, intent(in) :: order !! of_angle or of_speed
      integer, intent(in) :: row   !! of a Jacobian
      real(wp), intent(in) :: factor
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)

      call add_entry(entries, row, i_theta + order, wheel%ratio*factor, values)
      if (wheel%i_psi > 0) call add_entry(entries, row, wheel%i_psi + order, factor, values)
   end subroutine add_turn

   !> Reference motion of a wheel's centre in the housing frame, from which its deviation is measured.
   pure type(axle_motion) function wheel_reference(wheel, t) result(motion)
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(in) :: t

      motion = wheel%support%kind%reference(wheel%centre, t)
   end function wheel_reference

   !> Centre of a wheel in the housing frame and its velocity there [m], [m/s].
   pure subroutine wheel_position(wheel, t, y, centre, velocity)
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(in) :: t, y(*)
      real(wp), intent(out) :: centre(3), velocity(3)
      type(axle_motion) :: reference

      reference = wheel_reference(wheel, t)
      centre = [reference%centre + axle_deviation(wheel%support, y, 0), wheel%axial_position]
      velocity = [reference%velocity + axle_deviation(wheel%support, y, 1), 0.0_wp]
   end subroutine wheel_position

   !> Acceleration of a wheel's centre relative to the housing [m/s^2].
   pure function axle_acceleration(wheel, t, yp) result(acceleration)
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(in) :: t, yp(*)    !! yp: rates of the states
      real(wp) :: acceleration(3)
      type(axle_motion) :: reference

      reference = wheel_reference(wheel, t)
      acceleration = [reference%acceleration + axle_deviation(wheel%support, yp, 1), 0.0_wp]
   end function axle_acceleration

   !> Acceleration, less gravity, of a wheel with a constant deviation from the reference motion [m/s^2].
   pure function transport_acceleration(wheel, frame, centre) result(acceleration)
      type(wheel_t), intent(in) :: wheel
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: centre(3) !! position of the wheel [m]
      real(wp) :: acceleration(3)
      type(axle_motion) :: reference

      reference = wheel_reference(wheel, frame%t)
      acceleration = apparent_acceleration(frame, centre, [reference%velocity, 0.0_wp]) + [reference%acceleration, 0.0_wp]
   end function transport_acceleration

end module evl_gearbox
