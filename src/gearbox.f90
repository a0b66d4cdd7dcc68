!> A gearbox: wheels on supports with loads, the shafts and the meshes between them, as one differential-algebraic system.
!>
!> Wheels that rigid shafts join are one rotor: they share psi and psi', their inertias and torques add. The rotor's leader, one of
!> its wheels, stands for it where something is done once a rotor.
!>
!> State, in this order:
!>
!>    theta, omega               angle and speed of the reference wheel
!>    psi_i, psi_i'              of every rotor but that of the reference wheel: phi_i = g_i theta + psi_i, g_i the kinematic speed
!>                               ratio
!>    s_j, s_j'                  of every degree of freedom of a support, from its reference position
!>    turn, zeta, dr, lambda, mu   of every mesh that tracks its contact points, see evl_contact_tracking
!>    r, p, v, Omega             of a mounted housing, see evl_housing
!>    multiplier                 of every flank with rigid contact: its normal force
!>    dissipated energy, work of the loads
!>
!> Discrete integers: turns of the reference wheel beside theta; tooth pair, contact mode and friction branch of every tooth
!> contact; knots passed of every table. Discrete reals: the approach speed at the last closing of every tooth contact.
module evl_gearbox
   use evl_contact_point, only: contact_point
   use evl_flank_deviation, only: flank_deviation_t
   use evl_gear_geometry, only: gear_t
   use evl_gear_mesh, only: gear_mesh_t
   use evl_housing, only: apparent_acceleration, at_omega, frame_acceleration, frame_t, housing_frame, housing_rates, housing_t
   use evl_kinds, only: wp
   use evl_load, only: load_acceleration, load_damping, load_t, load_torque
   use evl_local_variables, only: n_local
   use evl_mesh, only: contact_loaded, contact_off, contact_t, mesh_contact, mesh_force, mesh_forces, mesh_mode, &
                       mesh_nominal_rho, touches
   use evl_rational, only: rational_t
   use evl_output, only: output_t
   use evl_rigid_contact, only: rigid_acceleration
   use evl_shaft, only: shaft_loss, shaft_t, shaft_torque
   use evl_springs_and_dampers, only: damper_power, support_acceleration
   use evl_spur_geometry, only: spur_pair_t
   use evl_status, only: has_failed, message_length, status_t
   use evl_tooth_phase, only: tooth_phase_t
   implicit none (type, external)
   private

   public :: add_speed, segment_of
   public :: gearbox_t, wheel_t, support_t
   public :: gearbox_rates, multiplier_row, is_closed, pairs_loaded, carries_points, leading_contact
   public :: gearbox_local, gearbox_mode, gearbox_store_mode, wheel_speed, wheel_load_torque, wheel_acceleration
   public :: wheel_spin_torque, wheel_housing_torque, wheel_position, wheel_follows_ground
   public :: support_fixed, support_slider, support_bearing, i_theta, i_omega, i_turns

   integer, parameter :: support_fixed = 0   !! the axle does not move
   integer, parameter :: support_slider = 1  !! it moves in one direction
   integer, parameter :: support_bearing = 2 !! it moves in x and y

   integer, parameter :: i_theta = 1 !! place of the reference angle in the state
   integer, parameter :: i_omega = 2 !! place of the reference speed in the state
   integer, parameter :: i_turns = 1 !! place of the turns in the discrete state

   !> What carries an axle: up to two directions, each with spring and damper.
   type :: support_t
      integer :: kind = support_fixed
      integer :: n = 0                       !! degrees of freedom
      real(wp) :: direction(2, 2) = 0.0_wp   !! column j: unit vector of degree of freedom j in the housing frame
      real(wp) :: mass = 0.0_wp              !! that moves: wheel and support [kg]
      real(wp) :: stiffness(2) = 0.0_wp      !! [N/m]
      real(wp) :: damping(2) = 0.0_wp        !! [N s/m]
      integer :: i_state(2) = 0              !! place of s_j in the state; s_j' follows
   end type support_t

   type :: wheel_t
      integer :: teeth = 0                   !! 0: a disc
      real(wp) :: pitch_radius = 0.0_wp, base_radius = 0.0_wp, tip_radius = 0.0_wp !! [m]; base and tip 0 without a mesh
      real(wp) :: centre(2) = 0.0_wp         !! reference position of the axle [m]
      real(wp) :: mass = 0.0_wp              !! of the wheel alone [kg]
      real(wp) :: inertia = 0.0_wp           !! about the axle [kg m^2]
      real(wp) :: transverse_inertia = 0.0_wp !! about a diameter [kg m^2]
      real(wp) :: axial_position = 0.0_wp    !! z of its middle plane [m]
      type(rational_t) :: exact_ratio        !! g: nominal speed over that of the reference wheel
      real(wp) :: ratio = 0.0_wp             !! g as a real number
      integer :: leader = 0                  !! wheel that stands for its rotor
      real(wp) :: rotor_inertia = 0.0_wp     !! of all wheels of its rotor about the axle [kg m^2]
      integer :: i_psi = 0                   !! place of psi in the state, psi' follows; 0 in the rotor of the reference wheel
      integer :: i_speed = 0                 !! place of its speed's rate among the rows: i_omega or i_psi + 1
      integer :: prescribed = 0              !! load that prescribes the speed of its rotor; 0: none
      type(support_t) :: support
      type(flank_deviation_t) :: deviation   !! of its flanks from the involute
   end type wheel_t

   type :: gearbox_t
      type(wheel_t), allocatable :: wheels(:)
      type(load_t), allocatable :: loads(:)
      type(shaft_t), allocatable :: shafts(:)
      type(contact_t), allocatable :: contacts(:) !! tooth contacts, mesh by mesh: slots of the drive flank, then of the coast flank
      type(spur_pair_t), allocatable :: pairs(:)  !! geometry of each mesh
      type(tooth_phase_t), allocatable :: phases(:) !! first tooth pair of each mesh
      integer, allocatable :: first(:)            !! first tooth contact of each mesh; behind the last mesh, one more than all
      type(gear_t), allocatable :: gears(:)            !! of each wheel, initial values if it is no real gear
      type(gear_mesh_t), allocatable :: gear_meshes(:) !! of each mesh, the same
      type(housing_t) :: housing
      type(output_t), allocatable :: outputs(:)         !! table of what it tells
      character(len=message_length), allocatable :: warnings(:)
      integer :: reference = 1               !! wheel whose angle is theta, the leader of its rotor
      integer :: n_states = 0, n_integers = 0, n_values = 0 !! lengths of the state, the discrete state and the outputs
      integer :: n_multipliers = 0            !! flanks with rigid contact
      integer :: n_roots = 0                  !! root functions
      integer :: i_dissipated = 0, i_work = 0 !! places of the two energies in the state
   end type gearbox_t

contains

   !> Local variables of a mesh from the state.
   pure subroutine gearbox_local(gearbox, mesh, y, q)
      type(gearbox_t), intent(in) :: gearbox
      type(contact_t), intent(in) :: mesh
      real(wp), intent(in) :: y(gearbox%n_states)
      real(wp), intent(out) :: q(n_local)
      integer :: i

      q = 0
      do i = 1, size(mesh%links)
         associate (link => mesh%links(i))
            q(link%local) = q(link%local) + link%weight*y(link%state)
         end associate
      end do
   end subroutine gearbox_local

   !> Discrete state of a tooth contact.
   pure type(mesh_mode) function gearbox_mode(gearbox, index, integers, reals) result(mode)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index    !! of the tooth contact
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      integer :: n

      associate (i => gearbox%contacts(index)%i_mode)
         mode%teeth = integers(i)
         mode%contact = integers(i + 1)
         mode%friction = integers(i + 2)
         if (gearbox%contacts(index)%deviates) then
            mode%zone_a = integers(i + 3)
            mode%zone_b = integers(i + 4)
         end if
      end associate
      mode%v0 = reals(index)
      if (.not. gearbox%contacts(index)%rigid) return
      n = pairs_loaded(gearbox, index, integers)
      if (n > 1) mode%share = 1/real(n, wp)
   end function gearbox_mode

   !> How many tooth pairs of a contact's flank carry load.
   pure integer function pairs_loaded(gearbox, index, integers) result(n)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index    !! of any tooth contact of the flank
      integer, intent(in) :: integers(:)
      integer :: m

      n = 0
      associate (first => index - gearbox%contacts(index)%slot)
         do m = first, first + gearbox%contacts(index)%n_slots - 1
            if (integers(gearbox%contacts(m)%i_mode + 1) == contact_loaded) n = n + 1
         end do
      end associate
   end function pairs_loaded

   !> Whether a flank's tracked points are those of this contact's tooth pair: the first one of the flank that is on the path.
   pure logical function carries_points(gearbox, index, integers)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index    !! of the tooth contact
      integer, intent(in) :: integers(:)
      integer :: m

      carries_points = .false.
      if (gearbox%contacts(index)%i_track == 0) return
      associate (first => index - gearbox%contacts(index)%slot, n => gearbox%contacts(index)%n_slots)
         do m = first, first + n - 1
            if (integers(gearbox%contacts(m)%i_mode + 1) == contact_off) cycle
            carries_points = m == index
            return
         end do
         carries_points = first == index
      end associate
   end function carries_points

   !> The tooth contact that speaks for a mesh: the pair that has been longest on the path of the drive flank, or waits for it.
   pure integer function leading_contact(gearbox, mesh, integers) result(index)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      integer, intent(in) :: integers(:)
      logical :: on, best_on
      integer :: m

      index = gearbox%first(mesh)
      best_on = integers(gearbox%contacts(index)%i_mode + 1) /= contact_off
      do m = index + 1, gearbox%first(mesh) + gearbox%contacts(index)%n_slots - 1
         associate (mine => gearbox%contacts(m)%i_mode, best => gearbox%contacts(index)%i_mode)
            on = integers(mine + 1) /= contact_off
            if (best_on .and. .not. on) cycle
            if ((on .eqv. best_on) .and. integers(mine) > integers(best)) cycle
         end associate
         index = m
         best_on = on
      end do
   end function leading_contact

   !> Put the discrete state of a tooth contact back.
   pure subroutine gearbox_store_mode(gearbox, index, mode, integers, reals)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      type(mesh_mode), intent(in) :: mode
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)

      associate (i => gearbox%contacts(index)%i_mode)
         integers(i:i + 2) = [mode%teeth, mode%contact, mode%friction]
         if (gearbox%contacts(index)%deviates) integers(i + 3:i + 4) = [mode%zone_a, mode%zone_b]
      end associate
      reals(index) = mode%v0
   end subroutine gearbox_store_mode

   !> Angular velocity of a wheel [rad/s].
   pure real(wp) function wheel_speed(wheel, y) result(omega)
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(in) :: y(:)

      omega = wheel%ratio*y(i_omega)
      if (wheel%i_psi > 0) omega = omega + y(wheel%i_psi + 1)
   end function wheel_speed

   !> Add a multiple of a wheel's speed gradient to a row.
   pure subroutine add_speed(wheel, row, factor, jacobian)
      type(wheel_t), intent(in) :: wheel
      integer, intent(in) :: row
      real(wp), intent(in) :: factor
      real(wp), intent(inout) :: jacobian(:, :)

      jacobian(row, i_omega) = jacobian(row, i_omega) + wheel%ratio*factor
      if (wheel%i_psi > 0) jacobian(row, wheel%i_psi + 1) = jacobian(row, wheel%i_psi + 1) + factor
   end subroutine add_speed

   !> Sum of the torques that the loads of a wheel know; that of a prescribed speed is not among them [N m].
   pure real(wp) function wheel_load_torque(gearbox, index, t, omega, integers) result(torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t, omega
      integer, intent(in) :: integers(:)
      integer :: i

      torque = 0
      do i = 1, size(gearbox%loads)
         if (gearbox%loads(i)%wheel == index) &
            torque = torque + load_torque(gearbox%loads(i), t, omega, segment_of(gearbox%loads(i), integers))
      end do
   end function wheel_load_torque

   !> What the turning of the housing adds to it: torques against the ground follow the speed seen from there [N m].
   pure real(wp) function wheel_spin_torque(gearbox, index, spin) result(torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: spin !! Omega_z of the housing [rad/s]
      integer :: i

      torque = 0
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i))
            if (load%wheel == index .and. .not. load%against_housing) torque = torque - load_damping(load)*spin
         end associate
      end do
   end function wheel_spin_torque

   !> The part of the torque of a wheel's loads whose reaction goes to the housing [N m].
   pure real(wp) function wheel_housing_torque(gearbox, index, t, omega, spin, total, integers) result(torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t, omega, spin
      real(wp), intent(in) :: total !! of all loads, with that of a prescribed speed [N m]
      integer, intent(in) :: integers(:)
      logical :: follows
      integer :: i

      follows = wheel_follows_ground(gearbox, index)
      torque = merge(0.0_wp, total, follows)
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i))
            if (load%wheel /= index .or. (load%against_housing .neqv. follows)) cycle
            torque = torque + merge(1.0_wp, -1.0_wp, follows)*load_torque(load, t, omega, segment_of(load, integers))
         end associate
      end do
      if (.not. follows) torque = torque - wheel_spin_torque(gearbox, index, spin)
   end function wheel_housing_torque

   !> Whether phi'' + Omega_z', not phi'', follows from torques or a prescribed speed: all but a speed against the housing.
   pure logical function wheel_follows_ground(gearbox, index) result(follows)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index

      follows = .true.
      associate (driver => gearbox%wheels(index)%prescribed)
         if (driver > 0) follows = .not. gearbox%loads(driver)%against_housing
      end associate
   end function wheel_follows_ground

   !> Centre of a wheel in the housing frame and its velocity there [m], [m/s].
   pure subroutine wheel_position(wheel, y, centre, velocity)
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(in) :: y(:)
      real(wp), intent(out) :: centre(3), velocity(3)
      integer :: j

      centre = [wheel%centre, wheel%axial_position]
      velocity = 0
      do j = 1, wheel%support%n
         associate (i => wheel%support%i_state(j), d => wheel%support%direction(:, j))
            centre(1:2) = centre(1:2) + y(i)*d
            velocity(1:2) = velocity(1:2) + y(i + 1)*d
         end associate
      end do
   end subroutine wheel_position

   !> Knots that a load's table has passed; 0 without a table.
   pure integer function segment_of(load, integers) result(segment)
      type(load_t), intent(in) :: load
      integer, intent(in) :: integers(:)

      segment = 0
      if (load%i_segment > 0) segment = integers(load%i_segment)
   end function segment_of

   !> Angular acceleration of a rotor under the torque of its meshes, shafts and loads, or the prescribed one [rad/s^2].
   pure real(wp) function wheel_acceleration(gearbox, index, torque, integers) result(acceleration)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index       !! of one of its wheels
      real(wp), intent(in) :: torque     !! on the rotor [N m]
      integer, intent(in) :: integers(:)

      associate (wheel => gearbox%wheels(index))
         if (wheel%prescribed > 0) then
            associate (load => gearbox%loads(wheel%prescribed))
               acceleration = load_acceleration(load, segment_of(load, integers))
            end associate
         else
            acceleration = torque/wheel%rotor_inertia
         end if
      end associate
   end function wheel_acceleration

   !> Rates of all states but the tracked ones, whose places are set to zero: y' = f(t, y). In the place of a multiplier stands what
   !> has to vanish: kappa'' times the mesh's inertia in a closed rigid contact, the multiplier itself in an open one [N].
   !>
   !> With a mounted housing f depends on v' and Omega' as well, and the places of these two hold the force and the moment that
   !> act from the ground.
   subroutine gearbox_rates(gearbox, t, y, integers, reals, f, status, yp)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t                     !! [s]
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      real(wp), intent(out) :: f(gearbox%n_states)
      type(status_t), intent(inout) :: status       !! code_out_of_domain if a law has no solution there
      real(wp), intent(in), optional :: yp(:)       !! of a mounted housing; v' = Omega' = 0 if not given
      type(mesh_force) :: force
      type(frame_t) :: frame
      real(wp) :: torques(size(gearbox%wheels)), spin, alpha, dissipation, power
      integer :: i

      spin = 0
      alpha = 0
      if (gearbox%housing%acts) then
         call housing_frame(gearbox%housing, t, y, frame, yp)
         spin = frame%omega(3)
         alpha = frame%alpha(3)
      end if
      f = 0
      do i = 1, size(gearbox%contacts)
         call mesh_at(gearbox, i, y, integers, reals, force, status)
         if (has_failed(status)) return
         associate (mesh => gearbox%contacts(i))
            associate (a => gearbox%wheels(mesh%wheel_a), b => gearbox%wheels(mesh%wheel_b))
               f(a%i_speed) = f(a%i_speed) + force%torque_a
               f(b%i_speed) = f(b%i_speed) + force%torque_b
               call push_support(a%support, mesh, force%on_a, f)
               call push_support(b%support, mesh, -force%on_a, f)
            end associate
         end associate
         f(gearbox%i_dissipated) = f(gearbox%i_dissipated) + force%dissipation
      end do
      do i = 1, size(gearbox%shafts)
         call twist_shaft(gearbox, i, y, f)
      end do
      do i = 1, size(gearbox%wheels)
         call load_wheel(gearbox, i, t, y, integers, spin, f, torques(i))
      end do
      do i = 1, size(gearbox%wheels)
         if (gearbox%wheels(i)%leader == i) call accelerate_rotor(gearbox, i, y, integers, alpha, f, torques)
      end do
      if (gearbox%housing%acts) then
         do i = 1, size(gearbox%wheels)
            call ride_along(gearbox, i, t, torques(i), y, integers, frame, f)
         end do
      end if
      if (gearbox%housing%is_mounted) then
         call housing_rates(gearbox%housing, frame, f, dissipation, power)
         f(gearbox%i_dissipated) = f(gearbox%i_dissipated) + dissipation
         f(gearbox%i_work) = f(gearbox%i_work) + power
      end if
      f(i_theta) = y(i_omega)
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%i_psi == 0 .or. wheel%leader /= i) cycle
            f(wheel%i_psi) = y(wheel%i_psi + 1)
            f(wheel%i_speed) = f(wheel%i_speed) - wheel%ratio*f(i_omega)
         end associate
      end do
      do i = 1, size(gearbox%contacts)
         if (gearbox%contacts(i)%leads) call multiplier_row(gearbox, i, y, integers, f)
      end do
   end subroutine gearbox_rates

   !> What has to vanish in the place of a multiplier.
   pure subroutine multiplier_row(gearbox, index, y, integers, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(:)
      integer, intent(in) :: integers(:)
      real(wp), intent(inout) :: f(:)
      real(wp) :: q(n_local), rates(n_local)

      associate (mesh => gearbox%contacts(index))
         f(mesh%i_normal) = y(mesh%i_normal)
         if (.not. is_closed(gearbox, index, integers)) return
         call gearbox_local(gearbox, mesh, y, q)
         call gearbox_local(gearbox, mesh, f, rates)
         f(mesh%i_normal) = rigid_acceleration(mesh%pair, q, rates)/mesh%mobility
      end associate
   end subroutine multiplier_row

   !> Whether a tooth contact leads a rigid flank that is closed.
   pure logical function is_closed(gearbox, index, integers)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      integer, intent(in) :: integers(:)

      is_closed = gearbox%contacts(index)%leads
      if (is_closed) is_closed = pairs_loaded(gearbox, index, integers) > 0
   end function is_closed

   !> The force of a mesh at a state.
   subroutine mesh_at(gearbox, index, y, integers, reals, force, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(:), reals(:)
      integer, intent(in) :: integers(:)
      type(mesh_force), intent(out) :: force
      type(status_t), intent(inout) :: status
      real(wp) :: q(n_local), rho_a0
      type(contact_point) :: point
      type(mesh_mode) :: mode

      mode = gearbox_mode(gearbox, index, integers, reals)
      if (.not. touches(mode)) return
      associate (mesh => gearbox%contacts(index))
         call gearbox_local(gearbox, mesh, y, q)
         rho_a0 = mesh_nominal_rho(mesh, y(i_theta), integers(i_turns), mode%teeth)
         call mesh_contact(mesh, mode, rho_a0, q, point)
         call mesh_forces(mesh, mode, point, force, status)
      end associate
   end subroutine mesh_at

   !> Add a mesh's force to the rows of a support's degrees of freedom [N].
   pure subroutine push_support(support, mesh, force, f)
      type(support_t), intent(in) :: support
      type(contact_t), intent(in) :: mesh
      real(wp), intent(in) :: force(2) !! (t_0, e_0)
      real(wp), intent(inout) :: f(:)
      integer :: j

      do j = 1, support%n
         associate (row => support%i_state(j) + 1)
            f(row) = f(row) + force(1)*dot_product(support%direction(:, j), mesh%t_0) &
                     + force(2)*dot_product(support%direction(:, j), mesh%e_0)
         end associate
      end do
   end subroutine push_support

   !> Add an elastic shaft's torque to the rows of its two wheels, and what its damping takes.
   pure subroutine twist_shaft(gearbox, index, y, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(:)
      real(wp), intent(inout) :: f(:)
      real(wp) :: torque

      associate (shaft => gearbox%shafts(index))
         if (shaft%rigid) return
         torque = shaft_torque(shaft, y)
         associate (row_a => gearbox%wheels(shaft%wheel_a)%i_speed, row_b => gearbox%wheels(shaft%wheel_b)%i_speed)
            f(row_a) = f(row_a) - torque
            f(row_b) = f(row_b) + torque
         end associate
         f(gearbox%i_dissipated) = f(gearbox%i_dissipated) + shaft_loss(shaft, y)
      end associate
   end subroutine twist_shaft

   !> Add the torque of a wheel's loads to the row of its rotor, and its power; accelerate its support by the forces of the meshes.
   pure subroutine load_wheel(gearbox, index, t, y, integers, spin, f, torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: spin    !! Omega_z of the housing [rad/s]
      real(wp), intent(inout) :: f(gearbox%n_states)
      real(wp), intent(out) :: torque !! of the loads; that of a prescribed speed is not among them [N m]
      real(wp) :: omega
      integer :: j

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support)
         omega = wheel_speed(wheel, y)
         torque = wheel_load_torque(gearbox, index, t, omega, integers)
         if (gearbox%housing%acts) torque = torque + wheel_spin_torque(gearbox, index, spin)
         f(wheel%i_speed) = f(wheel%i_speed) + torque
         f(gearbox%i_work) = f(gearbox%i_work) + torque*omega
         do j = 1, support%n
            associate (i => support%i_state(j))
               f(i) = y(i + 1)
               f(gearbox%i_dissipated) = f(gearbox%i_dissipated) + damper_power(support%damping(j), y(i + 1))
               f(i + 1) = support_acceleration(f(i + 1), support%stiffness(j), support%damping(j), support%mass, y(i), y(i + 1))
            end associate
         end do
      end associate
   end subroutine load_wheel

   !> From the torque on a rotor to its acceleration relative to the housing; a load that prescribes its speed brings the torque
   !> that is missing.
   pure subroutine accelerate_rotor(gearbox, leader, y, integers, alpha, f, torques)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: leader
      real(wp), intent(in) :: y(:)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: alpha         !! Omega_z' of the housing [rad/s^2]
      real(wp), intent(inout) :: f(:)
      real(wp), intent(inout) :: torques(:) !! of the loads of each wheel [N m]
      real(wp) :: omega, missing

      associate (wheel => gearbox%wheels(leader))
         missing = -f(wheel%i_speed)
         f(wheel%i_speed) = wheel_acceleration(gearbox, leader, f(wheel%i_speed), integers)
         if (wheel%prescribed > 0) then
            omega = wheel_speed(wheel, y)
            missing = missing + wheel%rotor_inertia*f(wheel%i_speed)
            if (.not. wheel_follows_ground(gearbox, leader)) missing = missing + wheel%rotor_inertia*alpha
            associate (driver => gearbox%loads(wheel%prescribed)%wheel)
               torques(driver) = torques(driver) + missing
            end associate
            f(gearbox%i_work) = f(gearbox%i_work) + missing*omega
         end if
         if (gearbox%housing%acts .and. wheel_follows_ground(gearbox, leader)) f(wheel%i_speed) = f(wheel%i_speed) - alpha
      end associate
   end subroutine accelerate_rotor

   !> What the motion of the housing and gravity add to the acceleration of a wheel's support, and to the powers.
   pure subroutine ride_along(gearbox, index, t, torque, y, integers, frame, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t
      real(wp), intent(in) :: torque !! of all loads of the wheel [N m]
      real(wp), intent(in) :: y(:)
      integer, intent(in) :: integers(:)
      type(frame_t), intent(in) :: frame
      real(wp), intent(inout) :: f(:)
      real(wp) :: omega, centre(3), velocity(3), apparent(3)
      integer :: j

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support, power => f(gearbox%i_work))
         omega = wheel_speed(wheel, y)
         call wheel_position(wheel, y, centre, velocity)
         apparent = apparent_acceleration(frame, centre, velocity)
         do j = 1, support%n
            f(support%i_state(j) + 1) = f(support%i_state(j) + 1) - dot_product(support%direction(:, j), apparent(1:2))
         end do
         if (gearbox%housing%is_mounted) then
            associate (moment => f(gearbox%housing%i_state + at_omega + 2), &
                       ground => torque - wheel_housing_torque(gearbox, index, t, omega, frame%omega(3), torque, integers))
               power = power + ground*frame%omega(3)
               moment = moment + ground
            end associate
         else
            power = power - wheel%inertia*frame%alpha(3)*omega &
                    - support%mass*dot_product(velocity, frame_acceleration(frame, centre))
         end if
      end associate
   end subroutine ride_along

end module evl_gearbox
