!> Torques of loads and shafts, and what wheels do to a housing that rests, in eight states at once: as evl_outside_torques and
!> evl_housing_outputs have them in one.
module evl_torque_lanes
   use evl_force_lanes, only: lane_force, lane_slot
   use evl_gearbox, only: gearbox_t, wheel_t
   use evl_gearbox_lanes, only: add_row, housing_torque_in_lanes, loads_in_lanes
   use evl_kinds, only: lanes, wp
   use evl_lane_columns, only: none, of_bearing_force, of_bearing_moment, of_load_torque, of_shaft_torque, put
   use evl_line_lanes, only: turn_wheel
   use evl_local_variables, only: i_omega
   use evl_shaft, only: shaft_t
   use evl_springs_and_dampers, only: spring_damper
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: add_torque, forget_torques, lane_torques, tell_torques, torques_create

   !> What is needed for the torques that are asked for, and scratch of `tell_torques`.
   type :: lane_torques
      logical :: has_meshes = .false.                   !! the torques of the meshes
      logical, private :: has_loads = .false.           !! those of the loads
      logical, private :: has_prescribed = .false.      !! so are those of loads that prescribe a speed
      logical, private :: has_rigid = .false.           !! those of rigid shafts
      logical, private :: has_reactions = .false.       !! and what the wheels do to the housing
      real(wp), allocatable, private :: mesh(:, :)      !! (lanes, wheels) of the meshes [N m]
      real(wp), allocatable, private :: load(:, :)      !! the same of all loads
      real(wp), allocatable, private :: needed(:, :)    !! the same for the motion, beside that of meshes, loads and elastic shafts
      real(wp), allocatable, private :: reactions(:, :, :) !! (lanes, 6, wheels) as of `finish_reaction`
   end type lane_torques

contains

   !> What the columns ask for.
   subroutine torques_create(self, gearbox, columns)
      type(lane_torques), intent(inout) :: self
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: columns(:)
      integer :: n

      self%has_reactions = columns(of_bearing_force) /= none .or. columns(of_bearing_moment) /= none
      self%has_rigid = columns(of_shaft_torque) /= none .and. any(gearbox%shafts%rigid)
      self%has_loads = columns(of_load_torque) /= none .or. self%has_rigid .or. self%has_reactions
      self%has_prescribed = self%has_loads .and. any(gearbox%wheels%prescribed > 0)
      self%has_meshes = self%has_prescribed .or. self%has_rigid
      n = size(gearbox%wheels)
      allocate (self%mesh(lanes, n), self%load(lanes, n), self%needed(lanes, n))
      n = merge(n, 0, self%has_reactions)
      allocate (self%reactions(lanes, 6, n))
   end subroutine torques_create

   !> Begin anew with the torques of the meshes.
   pure subroutine forget_torques(self)
      type(lane_torques), intent(inout) :: self

      self%mesh(:, :) = 0
   end subroutine forget_torques

   !> Add the torque of a mesh on a wheel.
   pure subroutine add_torque(self, wheel, torque)
      type(lane_torques), intent(inout) :: self
      integer, intent(in) :: wheel
      real(wp), intent(in) :: torque(lanes) !! [N m]
      integer :: l

      do l = 1, lanes
         self%mesh(l, wheel) = self%mesh(l, wheel) + torque(l)
      end do
   end subroutine add_torque

   !> All that is asked for.
   subroutine tell_torques(gearbox, columns, self, t, y, f, integers, slots, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: columns(:)
      type(lane_torques), intent(inout) :: self
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states)
      real(wp), intent(in) :: f(lanes, gearbox%n_states) !! rates
      integer, intent(in) :: integers(gearbox%n_integers)
      type(lane_slot), intent(in) :: slots(*)            !! as the rates left them
      real(wp), intent(inout) :: values(lanes, *)
      integer :: i

      if (self%has_loads) call find_loads(gearbox, t, y, integers, self%load)
      if (self%has_prescribed) then
         call find_needed(gearbox, y, f, self)
         call add_prescribed(gearbox, self%needed, self%load)
      end if
      do i = 1, size(gearbox%wheels)
         call put(columns(of_load_torque), i, self%load(:, i), values)
      end do
      if (self%has_reactions) call tell_reactions(gearbox, columns, self, t, y, f, integers, slots, values)
      if (columns(of_shaft_torque) == none) return
      if (self%has_rigid) call find_needed(gearbox, y, f, self)
      do i = 1, size(gearbox%shafts)
         call tell_shaft(gearbox%shafts(i), columns(of_shaft_torque) + i, y, self%needed, values)
      end do
   end subroutine tell_torques

   !> Torque that the loads of every wheel know, as `known_torques` in one state.
   subroutine find_loads(gearbox, t, y, integers, load_torque)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: load_torque(lanes, size(gearbox%wheels))
      real(wp) :: omega(lanes)
      integer :: i

      do i = 1, size(gearbox%wheels)
         load_torque(:, i) = 0
         if (size(gearbox%wheels(i)%loads) == 0) cycle
         call loads_in_lanes(gearbox, i, t, y, integers, omega, load_torque(:, i))
      end do
   end subroutine find_loads

   !> Torque that every wheel needs for its motion, as `needed_torques` in one state.
   pure subroutine find_needed(gearbox, y, f, self)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(lanes, gearbox%n_states), f(lanes, gearbox%n_states)
      type(lane_torques), intent(inout) :: self
      real(wp), dimension(lanes) :: psi, rate, carried
      integer :: i

      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            call turn_wheel(wheel%i_psi, f, psi, rate)
            call need(wheel%inertia, wheel%ratio, f(:, i_omega), rate, self%mesh(:, i), self%load(:, i), self%needed(:, i))
         end associate
      end do
      do i = 1, size(gearbox%shafts)
         associate (shaft => gearbox%shafts(i))
            if (shaft%rigid) cycle
            call carry(shaft, y, carried)
            call add_row(carried, self%needed(:, shaft%wheel_a))
            call add_row(-carried, self%needed(:, shaft%wheel_b))
         end associate
      end do
   end subroutine find_needed

   !> Torque that one wheel needs beside those of its meshes and loads.
   pure subroutine need(inertia, ratio, spin, rate, mesh, load, needed)
      real(wp), intent(in) :: inertia, ratio, spin(lanes), rate(lanes), mesh(lanes), load(lanes)
      real(wp), intent(out) :: needed(lanes)
      integer :: l

      !$omp simd
      do l = 1, lanes
         needed(l) = inertia*(ratio*spin(l) + rate(l)) - (mesh(l) + load(l))
      end do
   end subroutine need

   !> Torque of an elastic shaft on its second wheel.
   pure subroutine carry(shaft, y, torque)
      type(shaft_t), intent(in) :: shaft
      real(wp), intent(in) :: y(lanes, *)
      real(wp), intent(out) :: torque(lanes)
      real(wp), dimension(lanes) :: psi_a, psi_b, rate_a, rate_b

      call turn_wheel(shaft%i_psi_a, y, psi_a, rate_a)
      call turn_wheel(shaft%i_psi_b, y, psi_b, rate_b)
      torque = spring_damper(shaft%stiffness, shaft%damping, psi_a - psi_b, rate_a - rate_b)
   end subroutine carry

   !> Add the torque of loads that prescribe a speed: what the rotor needs.
   pure subroutine add_prescribed(gearbox, needed, load_torque)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: needed(lanes, size(gearbox%wheels))
      real(wp), intent(inout) :: load_torque(lanes, size(gearbox%wheels))
      real(wp) :: total(lanes)
      integer :: i, k

      do i = 1, size(gearbox%wheels)
         if (gearbox%wheels(i)%prescribed == 0 .or. gearbox%wheels(i)%leader /= i) cycle
         total = 0
         do k = 1, size(gearbox%wheels)
            if (gearbox%wheels(k)%leader == i) call add_row(needed(:, k), total)
         end do
         call add_row(total, load_torque(:, gearbox%loads(gearbox%wheels(i)%prescribed)%load%wheel))
      end do
   end subroutine add_prescribed

   !> Torque of a shaft, as `shaft_torques` in one state.
   pure subroutine tell_shaft(shaft, to, y, needed, values)
      type(shaft_t), intent(in) :: shaft
      integer, intent(in) :: to
      real(wp), intent(in) :: y(lanes, *), needed(lanes, *)
      real(wp), intent(inout) :: values(lanes, *)
      integer :: k

      if (.not. shaft%rigid) then
         call carry(shaft, y, values(:, to))
         return
      end if
      values(:, to) = 0
      do k = 1, size(shaft%behind)
         call add_row(needed(:, shaft%behind(k)), values(:, to))
      end do
   end subroutine tell_shaft

   !> What every wheel does to the housing.
   subroutine tell_reactions(gearbox, columns, self, t, y, f, integers, slots, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: columns(:)
      type(lane_torques), intent(inout) :: self
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states), f(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      type(lane_slot), intent(in) :: slots(*)
      real(wp), intent(inout) :: values(lanes, *)
      integer :: c, i, k

      self%reactions = 0
      do c = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(c), wheels => gearbox%wheels)
            if (.not. slots(c)%touches) cycle
            call push(contact, slots(c)%force, 1.0_wp, wheels(contact%wheel_a), self%reactions(:, :, contact%wheel_a))
            call push(contact, slots(c)%force, -1.0_wp, wheels(contact%wheel_b), self%reactions(:, :, contact%wheel_b))
         end associate
      end do
      do i = 1, size(gearbox%wheels)
         associate (reaction => self%reactions(:, :, i))
            call finish_in_lanes(gearbox, i, t, y, f, integers, self%load(:, i), reaction)
            do k = 1, 3
               call put(columns(of_bearing_force), 3*(i - 1) + k, reaction(:, k), values)
               call put(columns(of_bearing_moment), 3*(i - 1) + k, reaction(:, 3 + k), values)
            end do
         end associate
      end do
   end subroutine tell_reactions

   !> Add the force of a tooth contact, as `add_mesh_reaction` in one state.
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

   !> From the forces of the meshes on a wheel to its reaction, as `finish_reaction` in one state.
   subroutine finish_in_lanes(gearbox, index, t, y, f, integers, load_torque, reaction)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states), f(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: load_torque(lanes)
      real(wp), intent(inout) :: reaction(lanes, 6)
      real(wp) :: acceleration(lanes), torque(lanes)
      integer :: j, k

      associate (support => gearbox%wheels(index)%support)
         do k = 1, 2
            acceleration = 0
            do j = 1, support%n
               acceleration = acceleration + f(:, support%i_state(j) + 1)*support%direction(k, j)
            end do
            reaction(:, k) = reaction(:, k) - support%mass*acceleration
         end do
      end associate
      call housing_torque_in_lanes(gearbox, index, load_torque, t, y, integers, torque)
      reaction(:, 6) = reaction(:, 6) - torque
   end subroutine finish_in_lanes

end module evl_torque_lanes
