!> The analytic Jacobian dF/dy + cj dF/dy' of the gearbox.
module evl_dae_jacobian
   use evl_contact_point, only: contact_gradient, contact_point
   use evl_contact_tracking, only: algebraic_jacobian, differential_jacobian
   use evl_gearbox, only: add_speed, carries_points, gearbox_local, gearbox_mode, gearbox_t, i_omega, i_theta, i_turns, &
                          is_closed, support_t, wheel_acceleration, wheel_follows_ground, wheel_load_torque, wheel_speed, &
                          wheel_t
   use evl_gearbox_rates, only: gearbox_rates
   use evl_housing, only: at_omega, frame_t, housing_frame
   use evl_housing_dynamics, only: housing_coupling
   use evl_housing_jacobian, only: housing_gradient, ride_gradient
   use evl_kinds, only: wp
   use evl_load, only: load_damping
   use evl_local_variables, only: at_psi_dot_a, at_v_b, n_local, n_track
   use evl_mesh, only: contact_apart, contact_t, mesh_contact, mesh_force, mesh_force_gradient, mesh_forces, mesh_gradient, &
                       mesh_mode, mesh_nominal_rho, touches, tracking_algebraic
   use evl_rigid_contact, only: rigid_acceleration_gradient, rigid_gradient
   use evl_shaft_jacobian, only: add_shaft
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: gearbox_jacobian

contains

   !> dF/dy + cj dF/dy'.
   subroutine gearbox_jacobian(gearbox, t, cj, y, yp, integers, reals, jacobian, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, cj
      real(wp), intent(in) :: y(gearbox%n_states), yp(gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      real(wp), intent(out) :: jacobian(gearbox%n_states, gearbox%n_states)
      type(status_t), intent(inout) :: status
      type(frame_t) :: frame
      real(wp) :: spin
      integer :: i

      spin = 0
      if (gearbox%housing%acts) then
         call housing_frame(gearbox%housing, t, y, frame, yp)
         spin = frame%omega(3)
      end if
      jacobian = 0
      do i = 1, size(gearbox%wheels)
         call add_wheel(gearbox, i, t, y, integers, jacobian)
         if (gearbox%housing%acts) call ride_gradient(gearbox, i, t, y, integers, frame, jacobian)
      end do
      do i = 1, size(gearbox%contacts)
         call add_mesh(gearbox, i, y, spin, integers, reals, jacobian, status)
         if (has_failed(status)) return
      end do
      do i = 1, size(gearbox%shafts)
         call add_shaft(gearbox, i, y, spin, jacobian)
      end do
      do i = 1, size(gearbox%wheels)
         if (gearbox%wheels(i)%leader == i) call couple_reference(gearbox%wheels(i), jacobian)
      end do
      if (gearbox%housing%is_mounted) call add_housing(gearbox, cj, y, yp, frame, jacobian)
      do i = 1, size(gearbox%contacts)
         if (gearbox%contacts(i)%leads) call add_multiplier(gearbox, i, t, y, yp, integers, reals, jacobian, status)
      end do
      associate (before => gearbox%i_dissipated - gearbox%n_multipliers - 1, behind => gearbox%i_dissipated)
         do i = 1, gearbox%n_states
            if (i <= before .or. i >= behind) jacobian(i, i) = jacobian(i, i) + cj
         end do
      end associate
      do i = 1, size(gearbox%contacts)
         if (is_closed(gearbox, i, integers)) call add_constraint(gearbox, gearbox%contacts(i), y, jacobian)
      end do
      do i = 1, size(gearbox%contacts)
         if (carries_points(gearbox, i, integers)) call add_tracking(gearbox, i, cj, y, yp, integers, reals, jacobian)
      end do
   end subroutine gearbox_jacobian

   !> The rows of a mounted housing, and what its accelerations are for the others.
   subroutine add_housing(gearbox, cj, y, yp, frame, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: cj, y(:), yp(:)
      type(frame_t), intent(in) :: frame
      real(wp), intent(inout) :: jacobian(:, :)
      real(wp) :: coupling(gearbox%n_states, gearbox%n_states)

      call housing_gradient(gearbox, y, yp, frame, jacobian)
      call housing_coupling(gearbox, frame, y, coupling)
      jacobian = jacobian + cj*coupling
   end subroutine add_housing

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
            call add_speed(wheel, wheel%i_speed, damping/wheel%rotor_inertia, jacobian)
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

   !> A mesh's derivatives in the rows of its wheels, their supports and the energies.
   subroutine add_mesh(gearbox, index, y, spin, integers, reals, jacobian, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(:), spin, reals(:)
      integer, intent(in) :: integers(:)
      real(wp), intent(inout) :: jacobian(:, :)
      type(status_t), intent(inout) :: status
      real(wp) :: q(n_local), rho_a0
      type(contact_point) :: point
      type(mesh_force) :: force
      type(mesh_force_gradient) :: gradient
      type(mesh_mode) :: mode

      mode = gearbox_mode(gearbox, index, integers, reals)
      if (.not. touches(mode)) return
      associate (mesh => gearbox%contacts(index))
         call gearbox_local(gearbox, mesh, y, q)
         rho_a0 = mesh_nominal_rho(mesh, y(i_theta), integers(i_turns), mode%teeth)
         call mesh_contact(mesh, mode, rho_a0, q, point)
         call mesh_forces(mesh, mode, point, force, status)
         if (has_failed(status)) return
         call mesh_gradient(mesh, mode, rho_a0, q, point, force, gradient, status)
         call add_torque(gearbox, mesh, mesh%wheel_a, force%torque_a, gradient%torque_a, y, spin, jacobian)
         call add_torque(gearbox, mesh, mesh%wheel_b, force%torque_b, gradient%torque_b, y, spin, jacobian)
         call add_push(mesh, gearbox%wheels(mesh%wheel_a)%support, gradient%on_a, 1.0_wp, jacobian)
         call add_push(mesh, gearbox%wheels(mesh%wheel_b)%support, gradient%on_a, -1.0_wp, jacobian)
         call scatter(mesh, -gradient%dissipation, gearbox%i_dissipated, jacobian)
      end associate
   end subroutine add_mesh

   !> A mesh's torque on a wheel: it accelerates the wheel, or, if its speed is prescribed, is carried by the load.
   pure subroutine add_torque(gearbox, mesh, index, torque, gradient, y, spin, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      type(contact_t), intent(in) :: mesh
      integer, intent(in) :: index !! of the wheel
      real(wp), intent(in) :: torque, gradient(n_local), y(:), spin
      real(wp), intent(inout) :: jacobian(:, :)

      associate (wheel => gearbox%wheels(index))
         if (wheel%prescribed == 0) then
            call scatter(mesh, -gradient/wheel%rotor_inertia, wheel%i_speed, jacobian)
            return
         end if
         call scatter(mesh, wheel_speed(wheel, y)*gradient, gearbox%i_work, jacobian)
         call add_speed(wheel, gearbox%i_work, torque, jacobian)
         if (.not. (gearbox%housing%is_mounted .and. wheel_follows_ground(gearbox, index))) return
         ! the torque of a speed prescribed against the ground balances the meshes, and acts on the housing
         associate (o => gearbox%housing%i_state + at_omega + 2)
            call scatter(mesh, spin*gradient, gearbox%i_work, jacobian)
            call scatter(mesh, gradient, o, jacobian)
            jacobian(gearbox%i_work, o) = jacobian(gearbox%i_work, o) + torque
         end associate
      end associate
   end subroutine add_torque

   !> A mesh's force on a support.
   pure subroutine add_push(mesh, support, gradient, sign, jacobian)
      type(contact_t), intent(in) :: mesh
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
      type(contact_t), intent(in) :: mesh
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

   !> Complete the row of a rotor's speed: psi'' = phi'' - g theta''.
   pure subroutine couple_reference(wheel, jacobian)
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(inout) :: jacobian(:, :)

      if (wheel%i_psi > 0) jacobian(wheel%i_speed, :) = jacobian(wheel%i_speed, :) - wheel%ratio*jacobian(i_omega, :)
   end subroutine couple_reference

   !> The row of a multiplier: kappa'' in terms of the rows of the velocities, which hold minus their derivatives.
   subroutine add_multiplier(gearbox, index, t, y, yp, integers, reals, jacobian, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index, integers(:)
      real(wp), intent(in) :: t, y(gearbox%n_states), yp(gearbox%n_states), reals(:)
      real(wp), intent(inout) :: jacobian(:, :)
      type(status_t), intent(inout) :: status
      real(wp) :: f(gearbox%n_states), q(n_local), rates(n_local), direct(n_local)
      type(contact_point) :: point
      type(contact_gradient) :: gradient
      integer :: i

      associate (mesh => gearbox%contacts(index), row => gearbox%contacts(index)%i_normal)
         jacobian(row, :) = 0
         if (.not. is_closed(gearbox, index, integers)) then
            jacobian(row, row) = 1
            return
         end if
         call gearbox_rates(gearbox, t, y, integers, reals, f, status, yp)
         call gearbox_local(gearbox, mesh, y, q)
         call gearbox_local(gearbox, mesh, f, rates)
         call rigid_gradient(mesh%pair, q, point, gradient)
         do i = 1, size(mesh%links)
            associate (link => mesh%links(i))
               if (link%local < at_psi_dot_a .or. link%local > at_v_b + 1) cycle
               jacobian(row, :) = jacobian(row, :) + gradient%h_dot(link%local)*link%weight/mesh%mobility*jacobian(link%state, :)
            end associate
         end do
         call rigid_acceleration_gradient(mesh%pair, q, rates, direct)
         call scatter(mesh, direct/mesh%mobility, row, jacobian)
      end associate
   end subroutine add_multiplier

   !> The rows of the wheel that a closed rigid contact determines: kappa and kappa'.
   pure subroutine add_constraint(gearbox, mesh, y, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      type(contact_t), intent(in) :: mesh
      real(wp), intent(in) :: y(:)
      real(wp), intent(inout) :: jacobian(:, :)
      real(wp) :: q(n_local)
      type(contact_point) :: point
      type(contact_gradient) :: gradient

      call gearbox_local(gearbox, mesh, y, q)
      call rigid_gradient(mesh%pair, q, point, gradient)
      associate (row => mesh%i_dependent)
         jacobian(row:row + 1, :) = 0
         call scatter(mesh, -gradient%h, row, jacobian)
         call scatter(mesh, -gradient%h_dot, row + 1, jacobian)
      end associate
   end subroutine add_constraint

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
      associate (mesh => gearbox%contacts(index))
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

end module evl_dae_jacobian
