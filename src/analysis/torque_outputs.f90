!> Torques of loads and shafts, and reactions of the wheels on the housing, at eight states.
!>
!> Source of the terms of a moving housing: docs/theory/housing.md, sections 2 and 4.
module evl_torque_outputs
   use evl_force_lanes, only: lane_force
   use evl_gearbox, only: gearbox_t, wheel_position, wheel_reference, wheel_speed, wheel_t
   use evl_gearbox_lanes, only: add_row, housing_torque_in_lanes, loads_in_lanes
   use evl_housing, only: apparent_acceleration, wheel_moment
   use evl_kinds, only: lanes, wp
   use evl_line_lanes, only: turn_wheel
   use evl_local_variables, only: i_omega
   use evl_motion_outputs, only: find_axle
   use evl_output, only: dims_wheel, in_bearings, needs_reactions
   use evl_output_registry, only: add_output, begin_section, needs, registry_t
   use evl_output_states, only: output_states
   use evl_shaft, only: shaft_t
   use evl_springs_and_dampers, only: spring_damper
   use evl_support, only: axle_motion
   use evl_tooth_contact, only: tooth_contact_t
   use evl_wheel_loads, only: wheel_follows_ground, wheel_spin_torque
   implicit none (type, external)
   private

   public :: add_bearing_outputs, find_load_torques, find_reactions, find_shaft_torque

contains

   subroutine add_bearing_outputs(registry, index, reaction)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      real(wp), intent(in), contiguous :: reaction(:, :) !! (lanes, 6): force [N], moment [N m]

      call begin_section(registry, in_bearings, dims_wheel, index)
      call needs(registry, needs_reactions)
      call add_output(registry, "bearing_force", "N", "", "force of the wheel on the housing, housing frame", reaction(:, 1:3))
      call add_output(registry, "bearing_moment", "N m", "", &
                      "moment of the wheel and its loads on the housing about the wheel's centre", reaction(:, 4:6))
   end subroutine add_bearing_outputs

   !> Load torque of every wheel, where a load with prescribed speed supplies the torque that its rotor requires; and the torque
   !> that every wheel requires for its motion beyond those of its meshes, loads and elastic shafts.
   subroutine find_load_torques(gearbox, states, mesh, load, needed)
      type(gearbox_t), intent(in) :: gearbox
      type(output_states), intent(in) :: states
      real(wp), intent(in) :: mesh(lanes, size(gearbox%wheels)) !! torque of the meshes; 0 if no result depends on it [N m]
      real(wp), intent(out), dimension(lanes, size(gearbox%wheels)) :: load, needed !! [N m]
      real(wp) :: omega(lanes), spin(lanes)
      integer :: i

      do i = 1, size(gearbox%wheels)
         load(:, i) = 0
         if (size(gearbox%wheels(i)%loads) == 0) cycle
         call loads_in_lanes(gearbox, i, states%t, states%y, states%integers, omega, load(:, i))
         if (.not. gearbox%housing%acts) cycle
         call find_spin_torque(gearbox, i, states, spin)
         call add_row(spin, load(:, i))
      end do
      if (any(gearbox%wheels%prescribed > 0)) then
         call find_needed(gearbox, states, mesh, load, needed)
         call add_prescribed(gearbox, needed, load)
      end if
      call find_needed(gearbox, states, mesh, load, needed)
   end subroutine find_load_torques

   !> Torque that the rotation of the housing adds to the loads of a wheel, one state after the other.
   subroutine find_spin_torque(gearbox, index, states, torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      type(output_states), intent(in) :: states
      real(wp), intent(out) :: torque(lanes) !! [N m]
      real(wp) :: y(gearbox%n_states)
      integer :: l

      do l = 1, lanes
         y = states%y(l, :)
         torque(l) = wheel_spin_torque(gearbox, index, states%frames(l)%omega(3), states%t(l), y, states%integers)
      end do
   end subroutine find_spin_torque

   !> Torque required by every wheel for its motion.
   subroutine find_needed(gearbox, states, mesh, load, needed)
      type(gearbox_t), intent(in) :: gearbox
      type(output_states), intent(in) :: states
      real(wp), intent(in), dimension(lanes, size(gearbox%wheels)) :: mesh, load
      real(wp), intent(out) :: needed(lanes, size(gearbox%wheels))
      real(wp), dimension(lanes) :: psi, rate, transmitted, alpha
      integer :: i

      alpha = 0
      if (states%has_frames) alpha = states%frames%alpha(3)
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            call turn_wheel(wheel%i_psi, states%f, psi, rate)
            call need(wheel%inertia, wheel%ratio, states%f(:, i_omega), rate, alpha, mesh(:, i), load(:, i), needed(:, i))
         end associate
      end do
      do i = 1, size(gearbox%shafts)
         associate (shaft => gearbox%shafts(i))
            if (shaft%rigid) cycle
            call carry(shaft, states%y, transmitted)
            call add_row(transmitted, needed(:, shaft%wheel_a))
            call add_row(-transmitted, needed(:, shaft%wheel_b))
         end associate
      end do
   end subroutine find_needed

   !> Torque required by one wheel beyond those of its meshes and loads. Equation TR2.
   pure subroutine need(inertia, ratio, spin, rate, alpha, mesh, load, needed)
      real(wp), intent(in) :: inertia, ratio, spin(lanes), rate(lanes)
      real(wp), intent(in) :: alpha(lanes) !! Omega_z' of the housing [rad/s^2]
      real(wp), intent(in) :: mesh(lanes), load(lanes)
      real(wp), intent(out) :: needed(lanes)
      integer :: l

      !$omp simd
      do l = 1, lanes
         needed(l) = inertia*(ratio*spin(l) + rate(l) + alpha(l)) - (mesh(l) + load(l))
      end do
   end subroutine need

   !> Torque of an elastic shaft on its second wheel. Equation TR1.
   pure subroutine carry(shaft, y, torque)
      type(shaft_t), intent(in) :: shaft
      real(wp), intent(in) :: y(lanes, *)
      real(wp), intent(out) :: torque(lanes)
      real(wp), dimension(lanes) :: psi_a, psi_b, rate_a, rate_b

      call turn_wheel(shaft%i_psi_a, y, psi_a, rate_a)
      call turn_wheel(shaft%i_psi_b, y, psi_b, rate_b)
      torque = spring_damper(shaft%stiffness, shaft%damping, psi_a - psi_b, rate_a - rate_b)
   end subroutine carry

   !> Add the torque of loads with prescribed speed: the torque required by the rotor.
   pure subroutine add_prescribed(gearbox, needed, load)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: needed(lanes, size(gearbox%wheels))
      real(wp), intent(inout) :: load(lanes, size(gearbox%wheels))
      real(wp) :: total(lanes)
      integer :: i, k

      do i = 1, size(gearbox%wheels)
         if (gearbox%wheels(i)%prescribed == 0 .or. gearbox%wheels(i)%leader /= i) cycle
         total = 0
         do k = 1, size(gearbox%wheels)
            if (gearbox%wheels(k)%leader == i) call add_row(needed(:, k), total)
         end do
         call add_row(total, load(:, gearbox%loads(gearbox%wheels(i)%prescribed)%load%wheel))
      end do
   end subroutine add_prescribed

   !> Torque of a shaft on its second wheel: by its law or, if rigid, the torque required by the wheels behind it [N m].
   !> Equation TR2.
   pure subroutine find_shaft_torque(shaft, y, needed, torque)
      type(shaft_t), intent(in) :: shaft
      real(wp), intent(in) :: y(lanes, *), needed(lanes, *) !! needed: torque required by every wheel, with all loads applied
      real(wp), intent(out) :: torque(lanes)
      integer :: k

      if (.not. shaft%rigid) then
         call carry(shaft, y, torque)
         return
      end if
      torque = 0
      do k = 1, size(shaft%behind) ! the shafts of a rotor form no loop
         call add_row(needed(:, shaft%behind(k)), torque)
      end do
   end subroutine find_shaft_torque

   !> Reactions of every wheel on the housing. Equation H6.
   subroutine find_reactions(gearbox, states, load, reactions)
      type(gearbox_t), intent(in) :: gearbox
      type(output_states), intent(in) :: states
      real(wp), intent(in) :: load(lanes, size(gearbox%wheels))        !! torque of all loads [N m]
      real(wp), intent(out) :: reactions(lanes, 6, size(gearbox%wheels)) !! force [N], moment [N m]
      real(wp), dimension(lanes) :: spin, torque
      integer :: c, i

      reactions = 0
      do c = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(c), wheels => gearbox%wheels, slot => states%slots(c))
            if (.not. slot%touches) cycle
            call push(contact, slot%force, 1.0_wp, wheels(contact%wheel_a), reactions(:, :, contact%wheel_a))
            call push(contact, slot%force, -1.0_wp, wheels(contact%wheel_b), reactions(:, :, contact%wheel_b))
         end associate
      end do
      do i = 1, size(gearbox%wheels)
         call add_inertia(gearbox, i, states, reactions(:, :, i))
         ! part of the load torque that acts on the housing
         call housing_torque_in_lanes(gearbox, i, load(:, i), states%t, states%y, states%integers, torque)
         if (gearbox%housing%acts .and. .not. wheel_follows_ground(gearbox, i)) then
            call find_spin_torque(gearbox, i, states, spin)
            torque = torque - spin
         end if
         call add_row(-torque, reactions(:, 6, i))
      end do
   end subroutine find_reactions

   !> Add the force of a tooth contact. Equation H6.
   pure subroutine push(contact, force, sign, wheel, reaction)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_force), intent(in) :: force
      real(wp), intent(in) :: sign                  !! +1 on A, -1 on B
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(inout) :: reaction(lanes, 6)
      real(wp) :: arm, x, y
      integer :: l

      arm = contact%axial_position - wheel%axial_position
      !$omp simd private(x, y)
      do l = 1, lanes
         x = force%on_a_t(l)*contact%t_0(1) + force%on_a_e(l)*contact%e_0(1)
         y = force%on_a_t(l)*contact%t_0(2) + force%on_a_e(l)*contact%e_0(2)
         reaction(l, 1) = reaction(l, 1) + sign*x
         reaction(l, 2) = reaction(l, 2) + sign*y
         reaction(l, 4) = reaction(l, 4) - sign*(arm*y)
         reaction(l, 5) = reaction(l, 5) + sign*(arm*x)
      end do
   end subroutine push

   !> Add the inertial force of a wheel. Equation H6.
   subroutine add_inertia(gearbox, index, states, reaction)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      type(output_states), intent(in) :: states
      real(wp), intent(inout) :: reaction(lanes, 6)
      real(wp) :: acceleration(lanes, 3)
      type(axle_motion) :: reference
      integer :: l

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support)
         acceleration(:, 3) = 0
         call find_axle(support, states%f, 1, acceleration(:, 1:2))
         do l = 1, lanes
            reference = wheel_reference(wheel, states%t(l))
            acceleration(l, 1:2) = acceleration(l, 1:2) + reference%acceleration
         end do
         if (gearbox%housing%acts) call add_apparent(gearbox, wheel, states, acceleration, reaction)
         reaction(:, 1:3) = reaction(:, 1:3) - support%mass*acceleration
      end associate
   end subroutine add_inertia

   !> Add the contribution of the housing motion to the acceleration of a wheel, and the moment of its rotation. Equation H6.
   subroutine add_apparent(gearbox, wheel, states, acceleration, reaction)
      type(gearbox_t), intent(in) :: gearbox
      type(wheel_t), intent(in) :: wheel
      type(output_states), intent(in) :: states
      real(wp), intent(inout) :: acceleration(lanes, 3), reaction(lanes, 6)
      real(wp) :: centre(3), f(gearbox%n_states), moment(3), velocity(3), y(gearbox%n_states)
      integer :: l

      do l = 1, lanes
         y = states%y(l, :)
         f = states%f(l, :)
         call wheel_position(wheel, states%t(l), y, centre, velocity)
         acceleration(l, :) = acceleration(l, :) + apparent_acceleration(states%frames(l), centre, velocity)
         moment = wheel_moment(states%frames(l), wheel%inertia, wheel%transverse_inertia, wheel_speed(wheel, y), &
                               wheel_speed(wheel, f))
         reaction(l, 4:5) = reaction(l, 4:5) - moment(1:2)
      end do
   end subroutine add_apparent

end module evl_torque_outputs
