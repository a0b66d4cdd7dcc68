!> The rates of a gearbox for eight states at once, as `gearbox_rates` gives them for one.
!>
!> It serves tooth contacts in closed form with a force law, in a fixed housing without gravity: see `lanes_serve`.
module evl_gearbox_lanes
   use evl_contact_lanes, only: contact_in_lanes, lane_contact
   use evl_force_lanes, only: forces_in_lanes, lane_force, laws_have_lanes
   use evl_gearbox, only: gearbox_mode, gearbox_t, i_omega, i_theta, i_turns, segment_of, wheel_acceleration, wheel_t
   use evl_gearbox_rates, only: gearbox_rates
   use evl_kinds, only: wp
   use evl_line_lanes, only: lane_line, line_in_lanes
   use evl_load, only: load_damping, load_table, load_torque, load_varies
   use evl_local_variables, only: wheel_link
   use evl_mesh, only: contact_loaded, contact_unloaded, mesh_mode, tracking_closed_form
   use evl_ode_model, only: lanes
   use evl_shaft, only: shaft_t
   use evl_status, only: code_out_of_domain, fail, has_failed, status_t
   implicit none (type, external)
   private

   public :: lanes_serve, rates_in_lanes

contains

   include "formulas/between_knots.inc"
   include "formulas/springs_and_dampers.inc"

   !> Whether a gearbox can be evaluated here; if not, its states are asked one by one.
   pure logical function lanes_serve(gearbox) result(serve)
      type(gearbox_t), intent(in) :: gearbox
      integer :: i

      serve = .not. gearbox%housing%acts
      do i = 1, size(gearbox%contacts)
         associate (mesh => gearbox%contacts(i))
            serve = serve .and. .not. mesh%rigid .and. mesh%tracking == tracking_closed_form .and. laws_have_lanes(mesh)
         end associate
      end do
   end function lanes_serve

   !> Rates of all states: y' = f(t, y).
   subroutine rates_in_lanes(gearbox, t, y, integers, reals, f, status)
      type(gearbox_t), intent(in) :: gearbox           !! one that `lanes_serve` accepts
      real(wp), intent(in) :: t(lanes)                 !! [s]
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      real(wp), intent(out) :: f(lanes, gearbox%n_states)
      type(status_t), intent(inout) :: status          !! code_out_of_domain if a law has no answer in one of the lanes
      type(lane_line) :: line
      logical :: answered
      integer :: i

      f = 0
      do i = 1, size(gearbox%contacts)
         call add_contact(gearbox, i, y, integers, reals, line, f, answered)
         if (.not. answered) then
            call say_why(gearbox, t, y, integers, reals, status)
            return
         end if
      end do
      do i = 1, size(gearbox%shafts)
         if (.not. gearbox%shafts(i)%rigid) &
            call twist_shaft(gearbox%shafts(i), gearbox%wheels(gearbox%shafts(i)%wheel_a)%i_speed, &
                             gearbox%wheels(gearbox%shafts(i)%wheel_b)%i_speed, gearbox%i_dissipated, y, f)
      end do
      do i = 1, size(gearbox%wheels)
         call load_wheel(gearbox, i, t, y, integers, f)
      end do
      do i = 1, size(gearbox%wheels)
         if (gearbox%wheels(i)%leader == i) call accelerate_rotor(gearbox, i, y, integers, f)
      end do
      f(:, i_theta) = y(:, i_omega)
      do i = 1, size(gearbox%wheels)
         associate (psi => gearbox%wheels(i)%i_psi, speed => gearbox%wheels(i)%i_speed)
            if (psi == 0 .or. gearbox%wheels(i)%leader /= i) cycle
            f(:, psi) = y(:, psi + 1)
            f(:, speed) = f(:, speed) - gearbox%wheels(i)%ratio*f(:, i_omega)
         end associate
      end do
   end subroutine rates_in_lanes

   !> The first lane without an answer says why, in the words of the scalar kernel.
   subroutine say_why(gearbox, t, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states), reals(:)
      integer, intent(in) :: integers(:)
      type(status_t), intent(inout) :: status
      real(wp) :: f(gearbox%n_states)
      integer :: l

      do l = 1, lanes
         call gearbox_rates(gearbox, t(l), y(l, :), integers, reals, f, status)
         if (has_failed(status)) return
      end do
      call fail(status, code_out_of_domain, "a contact law has no answer at one of the states")
   end subroutine say_why

   !> Forces of a tooth contact in the rows of its wheels, their supports and the dissipated energy.
   subroutine add_contact(gearbox, index, y, integers, reals, line, f, answered)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(lanes, gearbox%n_states), reals(:)
      integer, intent(in) :: integers(:)
      type(lane_line), intent(inout) :: line    !! of an earlier contact, or nobody's
      real(wp), intent(inout) :: f(lanes, gearbox%n_states)
      logical, intent(out) :: answered
      type(mesh_mode) :: mode
      type(lane_contact) :: at
      type(lane_force) :: force

      answered = .true.
      associate (contact => integers(gearbox%contacts(index)%i_mode + 1))
         if (contact /= contact_loaded .and. contact /= contact_unloaded) return
      end associate
      mode = gearbox_mode(gearbox, index, integers, reals)
      associate (mesh => gearbox%contacts(index))
         call line_in_lanes(mesh, y, line)
         call contact_in_lanes(mesh, mode, integers(i_turns), line, at)
         call forces_in_lanes(mesh, mode, line%margin, at, force, answered)
         if (.not. answered) return
         associate (a => gearbox%wheels(mesh%wheel_a), b => gearbox%wheels(mesh%wheel_b))
            f(:, a%i_speed) = f(:, a%i_speed) + force%torque_a
            f(:, b%i_speed) = f(:, b%i_speed) + force%torque_b
            call push_axle(mesh%link_a, force%on_a_t, force%on_a_e, f)
            call push_axle(mesh%link_b, -force%on_a_t, -force%on_a_e, f)
         end associate
      end associate
      f(:, gearbox%i_dissipated) = f(:, gearbox%i_dissipated) + force%dissipation
   end subroutine add_contact

   !> Force of a tooth contact on an axle.
   pure subroutine push_axle(link, force_t, force_e, f)
      type(wheel_link), intent(in) :: link
      real(wp), intent(in) :: force_t(lanes), force_e(lanes)
      real(wp), intent(inout) :: f(lanes, *)
      integer :: j

      do j = 1, link%n
         associate (row => link%i_state(j) + 1)
            f(:, row) = f(:, row) + force_t*link%along_t(j) + force_e*link%along_e(j)
         end associate
      end do
   end subroutine push_axle

   !> Torque of an elastic shaft on its two wheels, and what its damping takes.
   pure subroutine twist_shaft(shaft, row_a, row_b, row_dissipated, y, f)
      type(shaft_t), intent(in) :: shaft
      integer, intent(in) :: row_a, row_b, row_dissipated
      real(wp), intent(in), contiguous :: y(:, :)
      real(wp), intent(inout), contiguous :: f(:, :)
      real(wp), dimension(lanes) :: twist, rate, torque

      twist = 0
      rate = 0
      if (shaft%i_psi_a > 0) then
         twist = y(1:lanes, shaft%i_psi_a)
         rate = y(1:lanes, shaft%i_psi_a + 1)
      end if
      if (shaft%i_psi_b > 0) then
         twist = twist - y(1:lanes, shaft%i_psi_b)
         rate = rate - y(1:lanes, shaft%i_psi_b + 1)
      end if
      torque = spring_damper(shaft%stiffness, shaft%damping, twist, rate)
      f(1:lanes, row_a) = f(1:lanes, row_a) - torque
      f(1:lanes, row_b) = f(1:lanes, row_b) + torque
      f(1:lanes, row_dissipated) = f(1:lanes, row_dissipated) + damper_power(shaft%damping, rate)
   end subroutine twist_shaft

   !> Torque and power of a wheel's loads; acceleration of its support.
   subroutine load_wheel(gearbox, index, t, y, integers, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(inout) :: f(lanes, gearbox%n_states)
      real(wp), dimension(lanes) :: omega, torque
      integer :: j

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support)
         if (wheel%is_loaded) then
            omega = speed_of(wheel, y)
            torque = 0
            do j = 1, size(gearbox%loads)
               if (gearbox%loads(j)%wheel == index) call add_load(gearbox, j, t, omega, integers, torque)
            end do
            f(:, wheel%i_speed) = f(:, wheel%i_speed) + torque
            f(:, gearbox%i_work) = f(:, gearbox%i_work) + torque*omega
         end if
         do j = 1, support%n
            associate (i => support%i_state(j))
               f(:, i) = y(:, i + 1)
               f(:, gearbox%i_dissipated) = f(:, gearbox%i_dissipated) + damper_power(support%damping(j), y(:, i + 1))
               f(:, i + 1) = support_acceleration(f(:, i + 1), support%stiffness(j), support%damping(j), support%per_mass, &
                                                  y(:, i), y(:, i + 1))
            end associate
         end do
      end associate
   end subroutine load_wheel

   !> Add the torque of a load: of a table by the time of each lane, else linear in the speed.
   subroutine add_load(gearbox, index, t, omega, integers, torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t(lanes), omega(lanes)
      integer, intent(in) :: integers(:)
      real(wp), intent(inout) :: torque(lanes)
      integer :: segment

      associate (load => gearbox%loads(index))
         segment = segment_of(load, integers)
         if (load%kind == load_table .and. load_varies(load, segment)) then
            torque = torque + between_knots(t, load%time(segment), load%time(segment + 1), load%values(segment), &
                                            load%values(segment + 1))
         else
            torque = torque + (load_torque(load, t(1), 0.0_wp, segment) - load_damping(load)*omega)
         end if
      end associate
   end subroutine add_load

   !> From the torque on a rotor to its acceleration; a load that prescribes its speed brings the power that is missing.
   subroutine accelerate_rotor(gearbox, leader, y, integers, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: leader
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(inout) :: f(lanes, gearbox%n_states)
      real(wp) :: missing(lanes), acceleration

      associate (wheel => gearbox%wheels(leader))
         if (wheel%prescribed == 0) then
            f(:, wheel%i_speed) = f(:, wheel%i_speed)*wheel%per_inertia
            return
         end if
         acceleration = wheel_acceleration(gearbox, leader, 0.0_wp, integers)
         missing = -f(:, wheel%i_speed) + wheel%rotor_inertia*acceleration
         f(:, wheel%i_speed) = acceleration
         f(:, gearbox%i_work) = f(:, gearbox%i_work) + missing*speed_of(wheel, y)
      end associate
   end subroutine accelerate_rotor

   !> Angular velocity of a wheel [rad/s].
   pure function speed_of(wheel, y) result(omega)
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(in), contiguous :: y(:, :)
      real(wp) :: omega(lanes)

      omega = wheel%ratio*y(1:lanes, i_omega)
      if (wheel%i_psi > 0) omega = omega + y(1:lanes, wheel%i_psi + 1)
   end function speed_of

end module evl_gearbox_lanes
