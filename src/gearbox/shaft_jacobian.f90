!> What an elastic shaft adds to dF/dy.
module evl_shaft_jacobian
   use evl_gearbox, only: add_speed, gearbox_t, wheel_speed
   use evl_housing, only: at_omega
   use evl_jacobian_entries, only: add_entry, jacobian_entries
   use evl_kinds, only: wp
   use evl_shaft, only: shaft_t, shaft_torque, shaft_twist_rate
   use evl_wheel_loads, only: wheel_follows_ground
   implicit none (type, external)
   private

   public :: add_shaft, add_shaft_torque

contains

   !> Add how a shaft's torque accelerates the rotors of its wheels, which never changes, before the rows of psi' are coupled with
   !> that of the reference wheel.
   pure subroutine add_shaft_torque(gearbox, index, entries, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)

      associate (shaft => gearbox%shafts(index))
         if (shaft%rigid) return
         associate (a => gearbox%wheels(shaft%wheel_a), b => gearbox%wheels(shaft%wheel_b))
            if (a%prescribed == 0) call add_gradient(shaft, a%i_speed, 1/a%rotor_inertia, entries, values)
            if (b%prescribed == 0) call add_gradient(shaft, b%i_speed, -1/b%rotor_inertia, entries, values)
         end associate
      end associate
   end subroutine add_shaft_torque

   !> Add its powers: what its damping takes, and what a load brings that prescribes the speed of one of its wheels.
   pure subroutine add_shaft(gearbox, index, y, spin, entries, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(:), spin !! Omega_z of the housing [rad/s]
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)
      real(wp) :: torque

      associate (shaft => gearbox%shafts(index))
         if (shaft%rigid) return
         torque = shaft_torque(shaft, y)
         call carry_torque(gearbox, shaft, shaft%wheel_a, -torque, -1.0_wp, y, spin, entries, values)
         call carry_torque(gearbox, shaft, shaft%wheel_b, torque, 1.0_wp, y, spin, entries, values)
         call add_rates(shaft, gearbox%i_dissipated, -2*shaft%damping*shaft_twist_rate(shaft, y), entries, values)
      end associate
   end subroutine add_shaft

   !> The shaft's torque on a wheel whose speed is prescribed is carried by the load.
   pure subroutine carry_torque(gearbox, shaft, index, torque, sign, y, spin, entries, values)
      type(gearbox_t), intent(in) :: gearbox
      type(shaft_t), intent(in) :: shaft
      integer, intent(in) :: index                    !! of the wheel
      real(wp), intent(in) :: torque, sign, y(:), spin !! sign: +1 on the second wheel, -1 on the first
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)

      associate (wheel => gearbox%wheels(index), work => gearbox%i_work)
         if (wheel%prescribed == 0) return
         call add_gradient(shaft, work, sign*wheel_speed(wheel, y), entries, values)
         call add_speed(wheel, work, torque, entries, values)
         if (.not. (gearbox%housing%is_mounted .and. wheel_follows_ground(gearbox, index))) return
         ! the torque of a speed prescribed against the ground balances the shaft, and acts on the housing
         associate (o => gearbox%housing%i_state + at_omega + 2)
            call add_gradient(shaft, work, sign*spin, entries, values)
            call add_gradient(shaft, o, sign, entries, values)
            call add_entry(entries, work, o, torque, values)
         end associate
      end associate
   end subroutine carry_torque

   !> Add a multiple of the torque's derivatives to a row.
   pure subroutine add_gradient(shaft, row, factor, entries, values)
      type(shaft_t), intent(in) :: shaft
      integer, intent(in) :: row
      real(wp), intent(in) :: factor
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)

      associate (a => shaft%i_psi_a, b => shaft%i_psi_b, c => shaft%stiffness)
         if (a > 0) call add_entry(entries, row, a, factor*c, values)
         if (b > 0) call add_entry(entries, row, b, -factor*c, values)
      end associate
      call add_rates(shaft, row, factor*shaft%damping, entries, values)
   end subroutine add_gradient

   !> Add a multiple of the derivatives of the twist's rate to a row.
   pure subroutine add_rates(shaft, row, factor, entries, values)
      type(shaft_t), intent(in) :: shaft
      integer, intent(in) :: row
      real(wp), intent(in) :: factor
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)

      associate (a => shaft%i_psi_a, b => shaft%i_psi_b)
         if (a > 0) call add_entry(entries, row, a + 1, factor, values)
         if (b > 0) call add_entry(entries, row, b + 1, -factor, values)
      end associate
   end subroutine add_rates

end module evl_shaft_jacobian
