!> A gearbox: wheels on supports with loads, and the meshes between them, as one differential-algebraic system.
!>
!> State, in this order:
!>
!>    theta, omega               angle and speed of the reference wheel
!>    psi_i, psi_i'              of every other wheel: phi_i = g_i theta + psi_i, g_i the kinematic speed ratio
!>    s_j, s_j'                  of every degree of freedom of a support, from its reference position
!>    turn, zeta, dr, lambda, mu   of every mesh that tracks its contact points, see evl_contact_tracking
!>    r, p, v, Omega             of a mounted housing, see evl_housing
!>    multiplier                 of every mesh with rigid contact: its normal force
!>    dissipated energy, work of the loads
!>
!> Discrete integers: turns of the reference wheel beside theta; teeth, contact mode and friction branch of every mesh; knots
!> passed of every table. Discrete reals: the approach speed at the last closing of every mesh.
module evl_gearbox
   use evl_contact_point, only: contact_point
   use evl_flank_deviation, only: flank_deviation_t
   use evl_gear_geometry, only: gear_t
   use evl_gear_mesh, only: gear_mesh_t
   use evl_housing, only: apparent_acceleration, at_omega, frame_acceleration, frame_t, housing_frame, housing_rates, housing_t
   use evl_kinds, only: wp
   use evl_load, only: load_acceleration, load_damping, load_t, load_torque
   use evl_local_variables, only: n_local
   use evl_mesh, only: contact_loaded, mesh_contact, mesh_force, mesh_forces, mesh_mode, mesh_nominal_rho, mesh_t
   use evl_rigid_contact, only: rigid_acceleration
   use evl_spur_geometry, only: spur_pair_t
   use evl_status, only: has_failed, message_length, status_t
   implicit none (type, external)
   private

   public :: add_speed
   public :: gearbox_t, wheel_t, support_t
   public :: gearbox_rates, multiplier_row, is_closed
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
      integer :: teeth = 0
      real(wp) :: pitch_radius = 0.0_wp, base_radius = 0.0_wp, tip_radius = 0.0_wp !! [m]; base and tip 0 without a mesh
      real(wp) :: centre(2) = 0.0_wp         !! reference position of the axle [m]
      real(wp) :: mass = 0.0_wp              !! of the wheel alone [kg]
      real(wp) :: inertia = 0.0_wp           !! about the axle [kg m^2]
      real(wp) :: transverse_inertia = 0.0_wp !! about a diameter [kg m^2]
      real(wp) :: axial_position = 0.0_wp    !! z of its middle plane [m]
      real(wp) :: ratio = 0.0_wp             !! g: nominal speed over that of the reference wheel
      integer :: i_psi = 0                   !! place of psi in the state, psi' follows; 0 for the reference wheel
      integer :: i_speed = 0                 !! place of its speed's rate among the rows: i_omega or i_psi + 1
      integer :: prescribed = 0              !! load that prescribes its speed; 0: none
      type(support_t) :: support
      type(flank_deviation_t) :: deviation   !! of its flanks from the involute
   end type wheel_t

   type :: gearbox_t
      type(wheel_t), allocatable :: wheels(:)
      type(load_t), allocatable :: loads(:)
      type(mesh_t), allocatable :: meshes(:)
      type(spur_pair_t), allocatable :: pairs(:) !! geometry of each mesh
      type(gear_t), allocatable :: gears(:)           !! of each wheel, initial values if it is no real gear
      type(gear_mesh_t), allocatable :: gear_meshes(:) !! of each mesh, the same
      type(housing_t) :: housing
      character(len=message_length), allocatable :: warnings(:)
      integer :: reference = 1               !! wheel whose angle is theta
      integer :: n_states = 0, n_integers = 0, n_values = 0 !! lengths of the state, the discrete state and the outputs
      integer :: n_multipliers = 0            !! meshes with rigid contact
      integer :: i_dissipated = 0, i_work = 0 !! places of the two energies in the state
   end type gearbox_t

contains

   !> Local variables of a mesh from the state.
   pure subroutine gearbox_local(gearbox, mesh, y, q)
      type(gearbox_t), intent(in) :: gearbox
      type(mesh_t), intent(in) :: mesh
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

   !> Discrete state of a mesh.
   pure type(mesh_mode) function gearbox_mode(gearbox, index, integers, reals) result(mode)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index    !! of the mesh
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)

      associate (i => gearbox%meshes(index)%i_mode)
         mode%teeth = integers(i)
         mode%contact = integers(i + 1)
         mode%friction = integers(i + 2)
      end associate
      mode%v0 = reals(index)
   end function gearbox_mode

   !> Put the discrete state of a mesh back.
   pure subroutine gearbox_store_mode(gearbox, index, mode, integers, reals)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      type(mesh_mode), intent(in) :: mode
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)

      associate (i => gearbox%meshes(index)%i_mode)
         integers(i:i + 2) = [mode%teeth, mode%contact, mode%friction]
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

   !> Angular acceleration of a wheel under the torque of its meshes and loads, or the prescribed one [rad/s^2].
   pure real(wp) function wheel_acceleration(gearbox, index, torque, integers) result(acceleration)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: torque     !! of meshes and loads [N m]
      integer, intent(in) :: integers(:)

      associate (wheel => gearbox%wheels(index))
         if (wheel%prescribed > 0) then
            associate (load => gearbox%loads(wheel%prescribed))
               acceleration = load_acceleration(load, segment_of(load, integers))
            end associate
         else
            acceleration = torque/wheel%inertia
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
      real(wp) :: torque, dissipation, power
      integer :: i

      if (gearbox%housing%acts) call housing_frame(gearbox%housing, t, y, frame, yp)
      f = 0
      do i = 1, size(gearbox%meshes)
         call mesh_at(gearbox, i, y, integers, reals, force, status)
         if (has_failed(status)) return
         associate (mesh => gearbox%meshes(i))
            associate (a => gearbox%wheels(mesh%wheel_a), b => gearbox%wheels(mesh%wheel_b))
               f(a%i_speed) = f(a%i_speed) + force%torque_a
               f(b%i_speed) = f(b%i_speed) + force%torque_b
               call push_support(a%support, mesh, force%on_a, f)
               call push_support(b%support, mesh, -force%on_a, f)
            end associate
         end associate
         f(gearbox%i_dissipated) = f(gearbox%i_dissipated) + force%dissipation
      end do
      do i = 1, size(gearbox%wheels)
         call finish_wheel(gearbox, i, t, y, integers, f, torque)
         if (gearbox%housing%acts) call ride_along(gearbox, i, t, torque, y, integers, frame, f)
      end do
      if (gearbox%housing%is_mounted) then
         call housing_rates(gearbox%housing, frame, f, dissipation, power)
         f(gearbox%i_dissipated) = f(gearbox%i_dissipated) + dissipation
         f(gearbox%i_work) = f(gearbox%i_work) + power
      end if
      f(i_theta) = y(i_omega)
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%i_psi == 0) cycle
            f(wheel%i_psi) = y(wheel%i_psi + 1)
            f(wheel%i_speed) = f(wheel%i_speed) - wheel%ratio*f(i_omega)
         end associate
      end do
      do i = 1, size(gearbox%meshes)
         if (gearbox%meshes(i)%rigid) call multiplier_row(gearbox, i, y, integers, reals, f)
      end do
   end subroutine gearbox_rates

   !> What has to vanish in the place of a multiplier.
   pure subroutine multiplier_row(gearbox, index, y, integers, reals, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(:), reals(:)
      integer, intent(in) :: integers(:)
      real(wp), intent(inout) :: f(:)
      real(wp) :: q(n_local), rates(n_local)

      associate (mesh => gearbox%meshes(index))
         f(mesh%i_normal) = y(mesh%i_normal)
         if (.not. is_closed(gearbox, index, integers, reals)) return
         call gearbox_local(gearbox, mesh, y, q)
         call gearbox_local(gearbox, mesh, f, rates)
         f(mesh%i_normal) = rigid_acceleration(mesh%pair, q, rates)/mesh%mobility
      end associate
   end subroutine multiplier_row

   !> Whether a mesh has a rigid contact that is closed.
   pure logical function is_closed(gearbox, index, integers, reals)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      type(mesh_mode) :: mode

      mode = gearbox_mode(gearbox, index, integers, reals)
      is_closed = gearbox%meshes(index)%rigid .and. mode%contact == contact_loaded
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
      associate (mesh => gearbox%meshes(index))
         call gearbox_local(gearbox, mesh, y, q)
         rho_a0 = mesh_nominal_rho(mesh, y(i_theta), integers(i_turns), mode%teeth)
         call mesh_contact(mesh, rho_a0, q, point)
         call mesh_forces(mesh, index, mode, point, force, status)
      end associate
   end subroutine mesh_at

   !> Add a mesh's force to the rows of a support's degrees of freedom [N].
   pure subroutine push_support(support, mesh, force, f)
      type(support_t), intent(in) :: support
      type(mesh_t), intent(in) :: mesh
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

   !> From torques and forces of the meshes in f to accelerations; powers of loads and of support dampers.
   pure subroutine finish_wheel(gearbox, index, t, y, integers, f, torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(inout) :: f(gearbox%n_states)
      real(wp), intent(out) :: torque !! of the loads [N m]
      real(wp) :: omega, mesh_torque
      integer :: j

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support)
         omega = wheel_speed(wheel, y)
         mesh_torque = f(wheel%i_speed)
         torque = wheel_load_torque(gearbox, index, t, omega, integers)
         f(wheel%i_speed) = wheel_acceleration(gearbox, index, mesh_torque + torque, integers)
         if (wheel%prescribed > 0) torque = wheel%inertia*f(wheel%i_speed) - mesh_torque
         f(gearbox%i_work) = f(gearbox%i_work) + torque*omega
         do j = 1, support%n
            associate (i => support%i_state(j))
               f(i) = y(i + 1)
               f(gearbox%i_dissipated) = f(gearbox%i_dissipated) + support%damping(j)*y(i + 1)**2
               f(i + 1) = (f(i + 1) - support%stiffness(j)*y(i) - support%damping(j)*y(i + 1))/support%mass
            end associate
         end do
      end associate
   end subroutine finish_wheel

   !> What the motion of the housing and gravity add to the accelerations of a wheel and its support, and to the powers.
   pure subroutine ride_along(gearbox, index, t, torque, y, integers, frame, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t
      real(wp), intent(in) :: torque !! of the loads, as if the housing were at rest [N m]
      real(wp), intent(in) :: y(:)
      integer, intent(in) :: integers(:)
      type(frame_t), intent(in) :: frame
      real(wp), intent(inout) :: f(:)
      real(wp) :: omega, centre(3), velocity(3), apparent(3), drag, total
      integer :: j

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support, power => f(gearbox%i_work))
         omega = wheel_speed(wheel, y)
         call wheel_position(wheel, y, centre, velocity)
         drag = 0
         if (wheel%prescribed == 0) drag = wheel_spin_torque(gearbox, index, frame%omega(3))
         f(wheel%i_speed) = f(wheel%i_speed) + drag/wheel%inertia
         power = power + drag*omega
         if (wheel_follows_ground(gearbox, index)) then
            f(wheel%i_speed) = f(wheel%i_speed) - frame%alpha(3)
         else
            power = power + wheel%inertia*frame%alpha(3)*omega
         end if
         apparent = apparent_acceleration(frame, centre, velocity)
         do j = 1, support%n
            f(support%i_state(j) + 1) = f(support%i_state(j) + 1) - dot_product(support%direction(:, j), apparent(1:2))
         end do
         if (gearbox%housing%is_mounted) then
            total = torque + drag
            associate (moment => f(gearbox%housing%i_state + at_omega + 2), &
                       ground => total - wheel_housing_torque(gearbox, index, t, omega, frame%omega(3), total, integers))
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
