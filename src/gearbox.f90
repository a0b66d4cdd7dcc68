!> A gearbox: wheels on supports with loads, and the meshes between them, as one differential-algebraic system.
!>
!> State, in this order:
!>
!>    theta, omega               angle and speed of the reference wheel
!>    psi_i, psi_i'              of every other wheel: phi_i = g_i theta + psi_i, g_i the kinematic speed ratio
!>    s_j, s_j'                  of every degree of freedom of a support, from its reference position
!>    turn, zeta, dr, lambda, mu   of every mesh that tracks its contact points, see evl_contact_tracking
!>    dissipated energy, work of the loads
!>
!> Discrete integers: turns of the reference wheel beside theta; teeth, contact mode and friction branch of every mesh; knots
!> passed of every table. Discrete reals: the approach speed at the last closing of every mesh.
module evl_gearbox
   use evl_contact_tracking, only: algebraic_jacobian, algebraic_residual, at_omega, at_psi_a, at_psi_b, at_psi_dot_a, &
                                   at_psi_dot_b, at_theta, at_track, at_u_a, at_u_b, at_v_a, at_v_b, contact_point, &
                                   differential_jacobian, differential_rates, differential_residual, n_local, n_track
   use evl_kinds, only: wp
   use evl_load, only: load_acceleration, load_damping, load_t, load_torque
   use evl_mesh, only: contact_apart, mesh_contact, mesh_force, mesh_force_gradient, mesh_forces, mesh_gradient, mesh_mode, &
                       mesh_nominal_rho, mesh_t, tracking_algebraic, tracking_closed_form
   use evl_spur_geometry, only: spur_pair_t
   use evl_status, only: code_out_of_domain, code_singular, fail, has_failed, message_length, status_t, subject_mesh
   implicit none (type, external)
   private

   public :: gearbox_t, wheel_t, support_t
   public :: gearbox_residual, gearbox_jacobian, gearbox_derivative, gearbox_rates
   public :: gearbox_local, gearbox_mode, gearbox_store_mode, wheel_speed, wheel_load_torque, wheel_acceleration
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
      real(wp) :: ratio = 0.0_wp             !! g: nominal speed over that of the reference wheel
      integer :: i_psi = 0                   !! place of psi in the state, psi' follows; 0 for the reference wheel
      integer :: i_speed = 0                 !! place of its speed's rate among the rows: i_omega or i_psi + 1
      integer :: prescribed = 0              !! load that prescribes its speed; 0: none
      type(support_t) :: support
   end type wheel_t

   type :: gearbox_t
      type(wheel_t), allocatable :: wheels(:)
      type(load_t), allocatable :: loads(:)
      type(mesh_t), allocatable :: meshes(:)
      type(spur_pair_t), allocatable :: pairs(:) !! geometry of each mesh
      character(len=message_length), allocatable :: warnings(:)
      integer :: reference = 1               !! wheel whose angle is theta
      integer :: n_states = 0, n_integers = 0, n_values = 0 !! lengths of the state, the discrete state and the outputs
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

   !> Rates of all states but the tracked ones, whose places are set to zero: y' = f(t, y).
   subroutine gearbox_rates(gearbox, t, y, integers, reals, f, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t                     !! [s]
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      real(wp), intent(out) :: f(gearbox%n_states)
      type(status_t), intent(inout) :: status       !! code_out_of_domain if a law has no solution there
      type(mesh_force) :: force
      integer :: i

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
         call finish_wheel(gearbox, i, t, y, integers, f)
      end do
      f(i_theta) = y(i_omega)
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%i_psi == 0) cycle
            f(wheel%i_psi) = y(wheel%i_psi + 1)
            f(wheel%i_speed) = f(wheel%i_speed) - wheel%ratio*f(i_omega)
         end associate
      end do
   end subroutine gearbox_rates

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
   pure subroutine finish_wheel(gearbox, index, t, y, integers, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t, y(:)
      integer, intent(in) :: integers(:)
      real(wp), intent(inout) :: f(:)
      real(wp) :: omega, mesh_torque, torque
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

   !> Residual F(t, y, y') of the whole system.
   subroutine gearbox_residual(gearbox, t, y, yp, integers, reals, residual, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(gearbox%n_states), yp(gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      real(wp), intent(out) :: residual(gearbox%n_states)
      type(status_t), intent(inout) :: status
      real(wp) :: q(n_local), rho_a0
      type(mesh_mode) :: mode
      logical :: exists
      integer :: i

      call gearbox_rates(gearbox, t, y, integers, reals, residual, status)
      if (has_failed(status)) return
      residual = yp - residual
      do i = 1, size(gearbox%meshes)
         associate (mesh => gearbox%meshes(i))
            if (mesh%i_track == 0) cycle
            mode = gearbox_mode(gearbox, i, integers, reals)
            if (mode%contact == contact_apart) cycle ! the tracked variables rest: their rows are y' = 0
            call gearbox_local(gearbox, mesh, y, q)
            rho_a0 = mesh_nominal_rho(mesh, y(i_theta), integers(i_turns), mode%teeth)
            associate (first => mesh%i_track, last => mesh%i_track + n_track - 1)
               if (mesh%tracking == tracking_algebraic) then
                  call algebraic_residual(mesh%pair, rho_a0, q, residual(first:last), exists)
               else
                  call differential_residual(mesh%pair, rho_a0, q, yp(first:last), residual(first:last), exists)
               end if
            end associate
            if (.not. exists) then
               call lost_points(i, status)
               return
            end if
         end associate
      end do
   end subroutine gearbox_residual

   !> The tracked points have left the involutes.
   pure subroutine lost_points(index, status)
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status

      call fail(status, code_out_of_domain, "a tracked contact point lies inside its wheel's base circle: the tooth pair has" &
                //" turned back too far", subject_mesh, index, "tracking")
   end subroutine lost_points

   !> dF/dy + cj dF/dy'.
   subroutine gearbox_jacobian(gearbox, t, cj, y, yp, integers, reals, jacobian, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, cj
      real(wp), intent(in) :: y(gearbox%n_states), yp(gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      real(wp), intent(out) :: jacobian(gearbox%n_states, gearbox%n_states)
      type(status_t), intent(inout) :: status
      integer :: i

      jacobian = 0
      do i = 1, size(gearbox%wheels)
         call add_wheel(gearbox, i, t, y, integers, jacobian)
      end do
      do i = 1, size(gearbox%meshes)
         call add_mesh(gearbox, i, y, integers, reals, jacobian, status)
         if (has_failed(status)) return
      end do
      do i = 1, size(gearbox%wheels)
         call couple_reference(gearbox%wheels(i), jacobian)
      end do
      do i = 1, gearbox%n_states
         jacobian(i, i) = jacobian(i, i) + cj
      end do
      do i = 1, size(gearbox%meshes)
         if (gearbox%meshes(i)%i_track > 0) call add_tracking(gearbox, i, cj, y, yp, integers, reals, jacobian)
      end do
   end subroutine gearbox_jacobian

   !> Rows of psi' and s', supports, and the loads' torque and power.
   pure subroutine add_wheel(gearbox, index, t, y, integers, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t, y(:)
      integer, intent(in) :: integers(:)
      real(wp), intent(inout) :: jacobian(:, :)
      real(wp) :: damping, omega, torque
      integer :: i, j

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support)
         if (wheel%i_psi > 0) then
            jacobian(wheel%i_psi, wheel%i_psi + 1) = -1
         else
            jacobian(i_theta, i_omega) = -1
         end if
         damping = 0
         do i = 1, size(gearbox%loads)
            if (gearbox%loads(i)%wheel == index) damping = damping + load_damping(gearbox%loads(i))
         end do
         omega = wheel_speed(wheel, y)
         if (wheel%prescribed == 0) then
            torque = wheel_load_torque(gearbox, index, t, omega, integers)
            call add_speed(wheel, wheel%i_speed, damping/wheel%inertia, jacobian)
            call add_speed(wheel, gearbox%i_work, damping*omega - torque, jacobian)
         else
            torque = wheel%inertia*wheel_acceleration(gearbox, index, 0.0_wp, integers)
            call add_speed(wheel, gearbox%i_work, -torque, jacobian)
         end if
         do j = 1, support%n
            i = support%i_state(j)
            jacobian(i, i + 1) = -1
            jacobian(i + 1, i) = support%stiffness(j)/support%mass
            jacobian(i + 1, i + 1) = support%damping(j)/support%mass
            jacobian(gearbox%i_dissipated, i + 1) = -2*support%damping(j)*y(i + 1)
         end do
      end associate
   end subroutine add_wheel

   !> Add a multiple of a wheel's speed gradient to a row.
   pure subroutine add_speed(wheel, row, factor, jacobian)
      type(wheel_t), intent(in) :: wheel
      integer, intent(in) :: row
      real(wp), intent(in) :: factor
      real(wp), intent(inout) :: jacobian(:, :)

      jacobian(row, i_omega) = jacobian(row, i_omega) + wheel%ratio*factor
      if (wheel%i_psi > 0) jacobian(row, wheel%i_psi + 1) = jacobian(row, wheel%i_psi + 1) + factor
   end subroutine add_speed

   !> A mesh's derivatives in the rows of its wheels, their supports and the energies.
   subroutine add_mesh(gearbox, index, y, integers, reals, jacobian, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(:), reals(:)
      integer, intent(in) :: integers(:)
      real(wp), intent(inout) :: jacobian(:, :)
      type(status_t), intent(inout) :: status
      real(wp) :: q(n_local), rho_a0
      type(contact_point) :: point
      type(mesh_force) :: force
      type(mesh_force_gradient) :: gradient
      type(mesh_mode) :: mode

      mode = gearbox_mode(gearbox, index, integers, reals)
      associate (mesh => gearbox%meshes(index))
         call gearbox_local(gearbox, mesh, y, q)
         rho_a0 = mesh_nominal_rho(mesh, y(i_theta), integers(i_turns), mode%teeth)
         call mesh_contact(mesh, rho_a0, q, point)
         call mesh_forces(mesh, index, mode, point, force, status)
         if (has_failed(status)) return
         call mesh_gradient(mesh, index, mode, rho_a0, q, point, force, gradient, status)
         call add_torque(gearbox, mesh, gearbox%wheels(mesh%wheel_a), force%torque_a, gradient%torque_a, y, jacobian)
         call add_torque(gearbox, mesh, gearbox%wheels(mesh%wheel_b), force%torque_b, gradient%torque_b, y, jacobian)
         call add_push(mesh, gearbox%wheels(mesh%wheel_a)%support, gradient%on_a, 1.0_wp, jacobian)
         call add_push(mesh, gearbox%wheels(mesh%wheel_b)%support, gradient%on_a, -1.0_wp, jacobian)
         call scatter(mesh, -gradient%dissipation, gearbox%i_dissipated, jacobian)
      end associate
   end subroutine add_mesh

   !> A mesh's torque on a wheel: it accelerates the wheel, or, if its speed is prescribed, is carried by the load.
   pure subroutine add_torque(gearbox, mesh, wheel, torque, gradient, y, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      type(mesh_t), intent(in) :: mesh
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(in) :: torque, gradient(n_local), y(:)
      real(wp), intent(inout) :: jacobian(:, :)

      if (wheel%prescribed == 0) then
         call scatter(mesh, -gradient/wheel%inertia, wheel%i_speed, jacobian)
      else
         call scatter(mesh, wheel_speed(wheel, y)*gradient, gearbox%i_work, jacobian)
         call add_speed(wheel, gearbox%i_work, torque, jacobian)
      end if
   end subroutine add_torque

   !> A mesh's force on a support.
   pure subroutine add_push(mesh, support, gradient, sign, jacobian)
      type(mesh_t), intent(in) :: mesh
      type(support_t), intent(in) :: support
      real(wp), intent(in) :: gradient(n_local, 2), sign
      real(wp), intent(inout) :: jacobian(:, :)
      integer :: j

      do j = 1, support%n
         associate (d => support%direction(:, j), factor => -sign/support%mass)
            call scatter(mesh, factor*(dot_product(d, mesh%t_0)*gradient(:, 1) + dot_product(d, mesh%e_0)*gradient(:, 2)), &
                         support%i_state(j) + 1, jacobian)
         end associate
      end do
   end subroutine add_push

   !> Add derivatives with respect to local variables to a row.
   pure subroutine scatter(mesh, gradient, row, jacobian)
      type(mesh_t), intent(in) :: mesh
      real(wp), intent(in) :: gradient(n_local)
      integer, intent(in) :: row
      real(wp), intent(inout) :: jacobian(:, :)
      integer :: i

      do i = 1, size(mesh%links)
         associate (link => mesh%links(i))
            jacobian(row, link%state) = jacobian(row, link%state) + link%weight*gradient(link%local)
         end associate
      end do
   end subroutine scatter

   !> Complete the row of a wheel's speed: psi'' = phi'' - g theta''.
   pure subroutine couple_reference(wheel, jacobian)
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(inout) :: jacobian(:, :)

      if (wheel%i_psi > 0) jacobian(wheel%i_speed, :) = jacobian(wheel%i_speed, :) - wheel%ratio*jacobian(i_omega, :)
   end subroutine couple_reference

   !> The rows of a mesh's tracked variables.
   pure subroutine add_tracking(gearbox, index, cj, y, yp, integers, reals, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: cj, y(:), yp(:), reals(:)
      integer, intent(in) :: integers(:)
      real(wp), intent(inout) :: jacobian(:, :)
      real(wp) :: q(n_local), rho_a0, local(n_track, n_local)
      type(mesh_mode) :: mode
      integer :: row

      mode = gearbox_mode(gearbox, index, integers, reals)
      if (mode%contact == contact_apart) return
      associate (mesh => gearbox%meshes(index))
         call gearbox_local(gearbox, mesh, y, q)
         rho_a0 = mesh_nominal_rho(mesh, y(i_theta), integers(i_turns), mode%teeth)
         if (mesh%tracking == tracking_algebraic) then
            call algebraic_jacobian(mesh%pair, rho_a0, q, local)
         else
            call differential_jacobian(mesh%pair, rho_a0, q, yp(mesh%i_track:mesh%i_track + n_track - 1), cj, local)
         end if
         do row = 1, n_track
            jacobian(mesh%i_track + row - 1, :) = 0
            call scatter(mesh, local(row, :), mesh%i_track + row - 1, jacobian)
         end do
      end associate
   end subroutine add_tracking

   !> The y' that belongs to y; tracked variables by the differential form, solved with LAPACK.
   subroutine gearbox_derivative(gearbox, t, y, integers, reals, yp, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      real(wp), intent(out) :: yp(gearbox%n_states)
      type(status_t), intent(inout) :: status !! code_out_of_domain or code_singular
      real(wp) :: q(n_local), rho_a0
      type(mesh_mode) :: mode
      logical :: solved
      integer :: i

      call gearbox_rates(gearbox, t, y, integers, reals, yp, status)
      if (has_failed(status)) return
      do i = 1, size(gearbox%meshes)
         associate (mesh => gearbox%meshes(i))
            if (mesh%i_track == 0) cycle
            mode = gearbox_mode(gearbox, i, integers, reals)
            if (mode%contact == contact_apart) cycle
            call gearbox_local(gearbox, mesh, y, q)
            rho_a0 = mesh_nominal_rho(mesh, y(i_theta), integers(i_turns), mode%teeth)
            call differential_rates(mesh%pair, rho_a0, q, yp(mesh%i_track:mesh%i_track + n_track - 1), solved)
            if (.not. solved) then
               call fail(status, code_singular, "the contact points' velocities are not determined at this state", &
                         subject_mesh, i, "tracking")
               return
            end if
         end associate
      end do
   end subroutine gearbox_derivative

end module evl_gearbox
