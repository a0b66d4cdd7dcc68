!> The equations of motion of a gearbox: accelerations of wheels and supports, and the powers, from forces and torques.
module evl_gearbox_rates
   use evl_contacts_at_state, only: flank_cache, look_at_forces
   use evl_discrete_state, only: is_closed
   use evl_gearbox, only: gearbox_local, gearbox_t, transport_acceleration, wheel_position, wheel_speed
   use evl_housing, only: at_omega, frame_t, housing_frame, housing_rates
   use evl_kinds, only: wp
   use evl_local_variables, only: i_omega, i_theta, n_local, wheel_link
   use evl_rigid_contact, only: rigid_acceleration
   use evl_rotation, only: cross
   use evl_shaft, only: shaft_loss, shaft_torque
   use evl_springs_and_dampers, only: damper_power, support_acceleration
   use evl_status, only: has_failed, status_t
   use evl_support, only: axle_deviation
   use evl_tooth_contact, only: contact_state, touches
   use evl_wheel_loads, only: known_torques, lost_power, wheel_acceleration, wheel_follows_ground, wheel_housing_torque, &
                              wheel_spin_torque
   implicit none (type, external)
   private

   public :: gearbox_rates, multiplier_row

contains

   !> Rates of all states except the tracked ones, whose elements are set to zero: y' = f(t, y). The element of a multiplier is the
   !> quantity that must vanish [N]: kappa'' times the inertia of the mesh for a closed rigid contact, the multiplier itself for an
   !> open one. Equation T54.
   !>
   !> With a mounted housing f also depends on v' and Omega'. The elements of these two are the force and the moment from the
   !> ground.
   subroutine gearbox_rates(gearbox, t, y, integers, reals, f, status, yp, contacts)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t                     !! [s]
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      real(wp), intent(out) :: f(gearbox%n_states)
      type(status_t), intent(inout) :: status       !! code_out_of_domain if a law has no solution at y
      real(wp), intent(in), optional :: yp(:)       !! for a mounted housing; v' = Omega' = 0 if absent
      !> All tooth contacts; only the mode for those that do not touch
      type(contact_state), intent(inout), optional :: contacts(size(gearbox%contacts))
      type(contact_state) :: at(size(gearbox%contacts))
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
      do i = 1, size(gearbox%flanks)
         associate (flank => gearbox%flanks(i)%flank)
            if (present(contacts)) then
               call push_flank(gearbox, flank%first, flank%last, y, integers, reals, contacts, f, status)
            else
               call push_flank(gearbox, flank%first, flank%last, y, integers, reals, at, f, status)
            end if
         end associate
         if (has_failed(status)) return
      end do
      do i = 1, size(gearbox%shafts)
         call twist_shaft(gearbox, i, y, f)
      end do
      call known_torques(gearbox, t, y, integers, torques)
      do i = 1, size(gearbox%wheels)
         call load_wheel(gearbox, i, t, y, integers, spin, f, torques(i))
      end do
      do i = 1, size(gearbox%losses)
         call lose_power(gearbox, gearbox%losses(i), t, y, integers, spin, f)
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

   !> Quantity that must vanish, in the element of a multiplier. Equation T59.
   pure subroutine multiplier_row(gearbox, index, y, integers, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(inout) :: f(gearbox%n_states)
      real(wp) :: q(n_local), rates(n_local)

      associate (contact => gearbox%contacts(index))
         f(contact%i_normal) = y(contact%i_normal)
         if (.not. is_closed(gearbox, index, integers)) return
         call gearbox_local(gearbox, contact, y, q)
         call gearbox_local(gearbox, contact, f, rates)
         f(contact%i_normal) = rigid_acceleration(contact%pair, q, rates)/contact%mobility
      end associate
   end subroutine multiplier_row

   !> Add the forces of a flank to the rows of its wheels and their supports. Equation T53.
   subroutine push_flank(gearbox, first, last, y, integers, reals, at, f, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: first, last !! its contacts
      real(wp), intent(in) :: y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      type(contact_state), intent(inout) :: at(*)
      real(wp), intent(inout) :: f(gearbox%n_states)
      type(status_t), intent(inout) :: status
      type(flank_cache) :: cache
      integer :: m

      call look_at_forces(gearbox, first, last, y, integers, reals, cache, at, status)
      if (has_failed(status)) return
      do m = first, last
         if (.not. touches(at(m)%mode)) cycle
         associate (contact => gearbox%contacts(m), force => at(m)%force)
            associate (row_a => gearbox%wheels(contact%wheel_a)%i_speed, row_b => gearbox%wheels(contact%wheel_b)%i_speed)
               f(row_a) = f(row_a) + force%torque_a
               f(row_b) = f(row_b) + force%torque_b
            end associate
            call push_axle(contact%link_a, force%on_a, f)
            call push_axle(contact%link_b, -force%on_a, f)
            f(gearbox%i_dissipated) = f(gearbox%i_dissipated) + force%dissipation
         end associate
      end do
   end subroutine push_flank

   !> Add the force of a mesh to the rows of an axle's degrees of freedom [N].
   pure subroutine push_axle(link, force, f)
      type(wheel_link), intent(in) :: link
      real(wp), intent(in) :: force(2) !! (t_0, e_0)
      real(wp), intent(inout) :: f(*)
      integer :: j

      do j = 1, link%n
         associate (row => link%i_state(j) + 1)
            f(row) = f(row) + force(1)*link%along_t(j) + force(2)*link%along_e(j)
         end associate
      end do
   end subroutine push_axle

   !> Add the torque of an elastic shaft to the rows of its two wheels, and the power dissipated by its damping.
   pure subroutine twist_shaft(gearbox, index, y, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(gearbox%n_states)
      real(wp), intent(inout) :: f(gearbox%n_states)
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

   !> Add the torque of a wheel's loads to the row of its rotor, and its power; accelerate its support by the mesh forces.
   !> Equation T76.
   pure subroutine load_wheel(gearbox, index, t, y, integers, spin, f, torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: spin    !! Omega_z of the housing [rad/s]
      real(wp), intent(inout) :: f(gearbox%n_states)
      real(wp), intent(inout) :: torque !! of the loads; the effect of the housing rotation is added [N m]
      real(wp) :: omega
      integer :: j

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support)
         omega = wheel_speed(wheel, y)
         if (gearbox%housing%acts) torque = torque + wheel_spin_torque(gearbox, index, spin, t, y, integers)
         f(wheel%i_speed) = f(wheel%i_speed) + torque
         f(gearbox%i_work) = f(gearbox%i_work) + torque*omega
         do j = 1, support%n
            associate (i => support%i_state(j))
               f(i) = y(i + 1)
               f(gearbox%i_dissipated) = f(gearbox%i_dissipated) + damper_power(support%damping(j), y(i + 1))
               f(i + 1) = support_acceleration(f(i + 1), support%stiffness(j), support%damping(j), support%per_mass, y(i), y(i + 1))
            end associate
         end do
      end associate
   end subroutine load_wheel

   !> Count the power of a loss as dissipated instead of negative work. Equation T83.
   pure subroutine lose_power(gearbox, index, t, y, integers, spin, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index    !! index of the load
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: spin    !! Omega_z of the housing [rad/s]
      real(wp), intent(inout) :: f(gearbox%n_states)
      real(wp) :: power, slope

      call lost_power(gearbox, index, t, y, integers, spin, power, slope)
      f(gearbox%i_dissipated) = f(gearbox%i_dissipated) + power
      f(gearbox%i_work) = f(gearbox%i_work) + power
   end subroutine lose_power

   !> Acceleration of a rotor relative to the housing from the torque on it; a load that prescribes its speed supplies the remaining
   !> torque. Equations H3, T54.
   pure subroutine accelerate_rotor(gearbox, leader, y, integers, alpha, f, torques)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: leader
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: alpha         !! Omega_z' of the housing [rad/s^2]
      real(wp), intent(inout) :: f(gearbox%n_states)
      real(wp), intent(inout) :: torques(size(gearbox%wheels)) !! of the loads of each wheel [N m]
      real(wp) :: omega, missing

      associate (wheel => gearbox%wheels(leader))
         missing = -f(wheel%i_speed)
         f(wheel%i_speed) = wheel_acceleration(gearbox, leader, f(wheel%i_speed), integers)
         if (wheel%prescribed > 0) then
            omega = wheel_speed(wheel, y)
            missing = missing + wheel%rotor_inertia*f(wheel%i_speed)
            if (.not. wheel_follows_ground(gearbox, leader)) missing = missing + wheel%rotor_inertia*alpha
            associate (driver => gearbox%loads(wheel%prescribed)%load%wheel)
               torques(driver) = torques(driver) + missing
            end associate
            f(gearbox%i_work) = f(gearbox%i_work) + missing*omega
         end if
         if (gearbox%housing%acts .and. wheel_follows_ground(gearbox, leader)) f(wheel%i_speed) = f(wheel%i_speed) - alpha
      end associate
   end subroutine accelerate_rotor

   !> Add the effect of housing motion and gravity to the acceleration of a wheel's support, and to the powers.
   !> Equations H5, H9, H13.
   pure subroutine ride_along(gearbox, index, t, torque, y, integers, frame, f)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t
      real(wp), intent(in) :: torque !! of all loads of the wheel [N m]
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      type(frame_t), intent(in) :: frame
      real(wp), intent(inout) :: f(gearbox%n_states)
      real(wp) :: omega, centre(3), velocity(3), transport(3), apparent(3)
      integer :: j

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support, power => f(gearbox%i_work))
         omega = wheel_speed(wheel, y)
         call wheel_position(wheel, t, y, centre, velocity)
         velocity = [axle_deviation(support, y, 1), 0.0_wp]
         transport = transport_acceleration(wheel, frame, centre)
         apparent = transport + 2*cross(frame%omega, velocity)
         do j = 1, support%n
            f(support%i_state(j) + 1) = f(support%i_state(j) + 1) - dot_product(support%direction(:, j), apparent(1:2))
         end do
         if (gearbox%housing%is_mounted) then
            associate (moment => f(gearbox%housing%i_state + at_omega + 2), &
                       ground => torque - wheel_housing_torque(gearbox, index, frame%omega(3), torque, t, y, integers))
               power = power + ground*frame%omega(3)
               moment = moment + ground
            end associate
         else
            power = power - wheel%inertia*frame%alpha(3)*omega &
                    - support%mass*dot_product(velocity, transport)
         end if
      end associate
   end subroutine ride_along

end module evl_gearbox_rates
