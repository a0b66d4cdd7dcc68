!> Rates of a gearbox for eight states at once; `gearbox_rates` is the version for one state.
!>
!> Supported: tooth contacts in closed form with a force law, in a fixed housing without gravity; see `supports_lanes`.
module evl_gearbox_lanes
   use evl_contact_lanes, only: contact_in_lanes
   use evl_flank, only: flank_t
   use evl_force_lanes, only: lane_force, lane_slot
   use evl_gearbox, only: gearbox_t, wheel_t
   use evl_gearbox_rates, only: gearbox_rates
   use evl_kinds, only: lanes, wp
   use evl_line_lanes, only: lane_line, line_in_lanes, turn_wheel
   use evl_local_variables, only: i_omega, i_theta, wheel_link
   use evl_shaft, only: shaft_t
   use evl_status, only: code_out_of_domain, fail, has_failed, status_t
   use evl_support, only: support_t
   use evl_tooth_contact, only: touches, tracking_closed_form
   use evl_wheel_loads, only: segment_of, turns_of_wheel, wheel_acceleration, wheel_follows_ground
   implicit none (type, external)
   private

   public :: add_row, housing_torque_in_lanes, supports_lanes, loads_in_lanes, lost_power_in_lanes, rates_in_lanes

contains

   include "numerics/all_positive.inc"
   include "components/springs_and_dampers.inc"

   !> Whether a gearbox is supported by this module; otherwise its states are evaluated one by one.
   pure logical function supports_lanes(gearbox) result(serve)
      type(gearbox_t), intent(in) :: gearbox
      integer :: i

      serve = .not. gearbox%housing%acts
      do i = 1, size(gearbox%contacts)
         serve = serve .and. .not. gearbox%contacts(i)%rigid .and. gearbox%contacts(i)%tracking == tracking_closed_form
      end do
   end function supports_lanes

   !> Rates of all states: y' = f(t, y).
   subroutine rates_in_lanes(gearbox, t, y, integers, reals, slots, f, status)
      type(gearbox_t), intent(in) :: gearbox           !! supported by `supports_lanes`
      real(wp), intent(in) :: t(lanes)                 !! [s]
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      !> [tooth contacts] on entry from `settle_slots`; on return with positions and forces of those that touch
      type(lane_slot), intent(inout) :: slots(size(gearbox%contacts))
      real(wp), intent(out) :: f(lanes, gearbox%n_states)
      type(status_t), intent(inout) :: status          !! code_out_of_domain if a law is not defined in one of the lanes
      real(wp), parameter :: no_spin(lanes) = 0.0_wp
      real(wp) :: power(lanes)
      logical :: is_defined
      integer :: i

      f = 0
      do i = 1, size(gearbox%flanks)
         associate (flank => gearbox%flanks(i)%flank)
            if (.not. any(slots(flank%first:flank%last)%touches)) cycle
            call push_flank(gearbox, flank, y, slots, f, is_defined)
         end associate
         if (.not. is_defined) then
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
         if (size(gearbox%wheels(i)%loads) > 0) call load_wheel(gearbox, i, t, y, integers, f)
         call accelerate_support(gearbox, gearbox%wheels(i)%support, y, f)
      end do
      do i = 1, size(gearbox%losses)
         call lost_power_in_lanes(gearbox, gearbox%losses(i), t, y, integers, no_spin, power)
         call add_row(power, f(:, gearbox%i_dissipated))
         call add_row(power, f(:, gearbox%i_work))
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

   !> Report the error of the first lane without a solution, with the message of the scalar kernel.
   subroutine say_why(gearbox, t, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      type(status_t), intent(inout) :: status
      real(wp) :: f(gearbox%n_states)
      integer :: l

      if (.not. status%in_words) then
         call fail(status, code_out_of_domain, "")
         return
      end if
      do l = 1, lanes
         call gearbox_rates(gearbox, t(l), y(l, :), integers, reals, f, status)
         if (has_failed(status)) return
      end do
      call fail(status, code_out_of_domain, "a contact law is undefined at one of the states")
   end subroutine say_why

   !> Add the forces of a flank with touching contacts to the rows of its wheels, their supports and the dissipated energy.
   subroutine push_flank(gearbox, flank, y, slots, f, is_defined)
      type(gearbox_t), intent(in) :: gearbox
      class(flank_t), intent(in) :: flank
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      type(lane_slot), intent(inout) :: slots(size(gearbox%contacts))
      real(wp), intent(inout) :: f(lanes, gearbox%n_states)
      logical, intent(out) :: is_defined
      type(lane_line) :: line
      integer :: m

      is_defined = .true.
      do m = flank%first, flank%last
         if (.not. slots(m)%touches) cycle
         call line_in_lanes(gearbox%contacts(m), y, line)
         is_defined = all_positive(line%margin)
         if (.not. is_defined) return
         call contact_in_lanes(gearbox%contacts(m), slots(m)%mode, slots(m)%rho_start, line, slots(m)%at)
      end do
      call flank%forces_in_lanes(gearbox%contacts, flank%first, flank%last, slots, is_defined)
      if (.not. is_defined) return
      do m = flank%first, flank%last
         if (.not. slots(m)%touches) cycle
         associate (contact => gearbox%contacts(m), force => slots(m)%force)
            call add_row(force%torque_a, f(:, gearbox%wheels(contact%wheel_a)%i_speed))
            call add_row(force%torque_b, f(:, gearbox%wheels(contact%wheel_b)%i_speed))
            call push_axle(contact%link_a, 1.0_wp, force, f)
            call push_axle(contact%link_b, -1.0_wp, force, f)
            call add_row(force%dissipation, f(:, gearbox%i_dissipated))
         end associate
      end do
   end subroutine push_flank

   !> Add to a row of an array. A separate procedure, because GCC 12 with AVX omits sums of rows under a condition.
   pure subroutine add_row(x, row)
      real(wp), intent(in) :: x(lanes)
      real(wp), intent(inout) :: row(lanes)
      integer :: l

      !$omp simd
      do l = 1, lanes
         row(l) = row(l) + x(l)
      end do
   end subroutine add_row

   !> Force of a tooth contact on an axle.
   pure subroutine push_axle(link, sign, force, f)
      type(wheel_link), intent(in) :: link
      real(wp), intent(in) :: sign !! +1 on A, -1 on B
      type(lane_force), intent(in) :: force
      real(wp), intent(inout) :: f(lanes, *)
      integer :: j

      do j = 1, link%n
         associate (row => link%i_state(j) + 1)
            f(:, row) = f(:, row) + force%on_a_t*(sign*link%along_t(j)) + force%on_a_e*(sign*link%along_e(j))
         end associate
      end do
   end subroutine push_axle

   !> Torque of an elastic shaft on its two wheels, and the power dissipated by its damping.
   pure subroutine twist_shaft(shaft, row_a, row_b, row_dissipated, y, f)
      type(shaft_t), intent(in) :: shaft
      integer, intent(in) :: row_a, row_b, row_dissipated
      real(wp), intent(in) :: y(lanes, *)
      real(wp), intent(inout) :: f(lanes, *)
      real(wp), dimension(lanes) :: psi_a, psi_b, rate_a, rate_b, torque

      call turn_wheel(shaft%i_psi_a, y, psi_a, rate_a)
      call turn_wheel(shaft%i_psi_b, y, psi_b, rate_b)
      torque = spring_damper(shaft%stiffness, shaft%damping, psi_a - psi_b, rate_a - rate_b)
      call add_row(-torque, f(:, row_a))
      call add_row(torque, f(:, row_b))
      f(:, row_dissipated) = f(:, row_dissipated) + damper_power(shaft%damping, rate_a - rate_b)
   end subroutine twist_shaft

   !> Torque and power of the loads of a wheel.
   subroutine load_wheel(gearbox, index, t, y, integers, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(inout) :: f(lanes, gearbox%n_states)
      real(wp) :: omega(lanes), torque(lanes)

      call loads_in_lanes(gearbox, index, t, y, integers, omega, torque)
      call add_row(torque, f(:, gearbox%wheels(index)%i_speed))
      call add_row(torque*omega, f(:, gearbox%i_work))
   end subroutine load_wheel

   !> Torque of the loads of a wheel without that of a prescribed speed, and speed of the wheel; `known_torques` for eight states.
   subroutine loads_in_lanes(gearbox, index, t, y, integers, omega, torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: omega(lanes)  !! [rad/s]
      real(wp), intent(out) :: torque(lanes) !! [N m]
      integer :: j

      call speed_of(gearbox%wheels(index), y, omega)
      torque = 0
      do j = 1, size(gearbox%wheels(index)%loads)
         call add_load(gearbox, gearbox%wheels(index)%loads(j), t, y, omega, integers, torque)
      end do
   end subroutine loads_in_lanes

   !> Torque of a wheel's loads with reaction on the housing; `wheel_housing_torque` for eight states.
   subroutine housing_torque_in_lanes(gearbox, index, total, t, y, integers, torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: total(lanes)   !! of all loads, including that of a prescribed speed [N m]
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: torque(lanes) !! [N m]
      real(wp) :: omega(lanes), mine(lanes)
      logical :: follows
      integer :: j

      follows = wheel_follows_ground(gearbox, index)
      torque = merge(0.0_wp, total, follows)
      call speed_of(gearbox%wheels(index), y, omega)
      do j = 1, size(gearbox%wheels(index)%loads)
         associate (number => gearbox%wheels(index)%loads(j))
            if (gearbox%loads(number)%load%against_housing .neqv. follows) cycle
            mine = 0
            call add_load(gearbox, number, t, y, omega, integers, mine)
            torque = torque + merge(1.0_wp, -1.0_wp, follows)*mine
         end associate
      end do
   end subroutine housing_torque_in_lanes

   !> Add the torque of one load.
   subroutine add_load(gearbox, index, t, y, omega, integers, torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index             !! index of the load
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states)
      real(wp), intent(in) :: omega(lanes)     !! speed of its wheel [rad/s]
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(inout) :: torque(lanes) !! [N m]
      real(wp) :: angle(lanes), revolutions, mine(lanes)

      revolutions = 0
      angle = 0
      associate (load => gearbox%loads(index)%load)
         if (load%by_angle) call angle_of(gearbox%wheels(load%wheel), y, integers, revolutions, angle)
         call load%evaluate(lanes, t, omega, angle, revolutions, segment_of(load, integers), mine)
      end associate
      call add_row(mine, torque)
   end subroutine add_load

   !> Power lost in a load with is_loss; `lost_power` for eight states. Equation T83.
   subroutine lost_power_in_lanes(gearbox, index, t, y, integers, spin, power)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index           !! index of the load
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: spin(lanes)    !! Omega_z of the housing [rad/s]
      real(wp), intent(out) :: power(lanes)  !! [W]
      real(wp) :: omega(lanes), torque(lanes)

      call speed_of(gearbox%wheels(gearbox%loads(index)%load%wheel), y, omega)
      if (.not. gearbox%loads(index)%load%against_housing) omega = omega + spin
      torque = 0
      call add_load(gearbox, index, t, y, omega, integers, torque)
      power = -torque*omega
   end subroutine lost_power_in_lanes

   !> Acceleration of a support by the forces on it, and the power dissipated by its dampers.
   pure subroutine accelerate_support(gearbox, support, y, f)
      type(gearbox_t), intent(in) :: gearbox
      type(support_t), intent(in) :: support
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      real(wp), intent(inout) :: f(lanes, gearbox%n_states)
      integer :: j

      do j = 1, support%n
         associate (i => support%i_state(j))
            f(:, i) = y(:, i + 1)
            f(:, gearbox%i_dissipated) = f(:, gearbox%i_dissipated) + damper_power(support%damping(j), y(:, i + 1))
            f(:, i + 1) = support_acceleration(f(:, i + 1), support%stiffness(j), support%damping(j), support%per_mass, &
                                               y(:, i), y(:, i + 1))
         end associate
      end do
   end subroutine accelerate_support

   !> Acceleration of a rotor from the torque on it; a load that prescribes its speed supplies the remaining power. Equation T54.
   subroutine accelerate_rotor(gearbox, leader, y, integers, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: leader
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(inout) :: f(lanes, gearbox%n_states)
      real(wp) :: missing(lanes), omega(lanes), acceleration

      associate (wheel => gearbox%wheels(leader))
         if (wheel%prescribed == 0) then
            f(:, wheel%i_speed) = wheel%per_inertia*f(:, wheel%i_speed)
            return
         end if
         acceleration = wheel_acceleration(gearbox, leader, 0.0_wp, integers)
         missing = -f(:, wheel%i_speed) + wheel%rotor_inertia*acceleration
         f(:, wheel%i_speed) = acceleration
         call speed_of(wheel, y, omega)
         call add_row(missing*omega, f(:, gearbox%i_work))
      end associate
   end subroutine accelerate_rotor

   !> Angular velocity of a wheel [rad/s].
   pure subroutine speed_of(wheel, y, omega)
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(in) :: y(lanes, *)
      real(wp), intent(out) :: omega(lanes)
      real(wp) :: psi(lanes), psi_dot(lanes)

      call turn_wheel(wheel%i_psi, y, psi, psi_dot)
      omega = wheel%ratio*y(:, i_omega) + psi_dot
   end subroutine speed_of

   !> Angle of a wheel in the housing: whole revolutions, and the remainder [rad].
   pure subroutine angle_of(wheel, y, integers, revolutions, angle)
      type(wheel_t), intent(in) :: wheel
      real(wp), intent(in) :: y(lanes, *)
      integer, intent(in) :: integers(*)
      real(wp), intent(out) :: revolutions, angle(lanes)
      real(wp) :: psi(lanes), psi_dot(lanes), turned

      call turn_wheel(wheel%i_psi, y, psi, psi_dot)
      call turns_of_wheel(wheel, integers, revolutions, turned)
      angle = turned + wheel%ratio*y(:, i_theta) + psi
   end subroutine angle_of

end module evl_gearbox_lanes
