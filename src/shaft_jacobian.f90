!> What an elastic shaft adds to dF/dy.
module evl_shaft_jacobian
   use evl_gearbox, only: add_speed, gearbox_t, wheel_follows_ground, wheel_speed
   use evl_housing, only: at_omega
   use evl_kinds, only: wp
   use evl_shaft, only: shaft_t, shaft_torque, shaft_twist_rate
   implicit none (type, external)
   private

   public :: add_shaft

contains

   !> Add a shaft's derivatives to the rows of its wheels and of the energies, before the rows of psi' are coupled with that of the
   !> reference wheel.
   pure subroutine add_shaft(gearbox, index, y, spin, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(:), spin !! Omega_z of the housing [rad/s]
      real(wp), intent(inout) :: jacobian(:, :)
      real(wp) :: torque

      associate (shaft => gearbox%shafts(index))
         if (shaft%rigid) return
         torque = shaft_torque(shaft, y)
         call add_torque(gearbox, shaft, shaft%wheel_a, -torque, -1.0_wp, y, spin, jacobian)
         call add_torque(gearbox, shaft, shaft%wheel_b, torque, 1.0_wp, y, spin, jacobian)
         call add_rates(shaft, gearbox%i_dissipated, -2*shaft%damping*shaft_twist_rate(shaft, y), jacobian)
      end associate
   end subroutine add_shaft

   !> The shaft's torque on a wheel: it accelerates the rotor, or, if its speed is prescribed, is carried by the load.
   pure subroutine add_torque(gearbox, shaft, index, torque, sign, y, spin, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      type(shaft_t), intent(in) :: shaft
      integer, intent(in) :: index                    !! of the wheel
      real(wp), intent(in) :: torque, sign, y(:), spin !! sign: +1 on the second wheel, -1 on the first
      real(wp), intent(inout) :: jacobian(:, :)

      associate (wheel => gearbox%wheels(index))
         if (wheel%prescribed == 0) then
            call add_gradient(shaft, wheel%i_speed, -sign/wheel%rotor_inertia, jacobian)
            return
         end if
         call add_gradient(shaft, gearbox%i_work, sign*wheel_speed(wheel, y), jacobian)
         call add_speed(wheel, gearbox%i_work, torque, jacobian)
         if (.not. (gearbox%housing%is_mounted .and. wheel_follows_ground(gearbox, index))) return
         ! the torque of a speed prescribed against the ground balances the shaft, and acts on the housing
         associate (o => gearbox%housing%i_state + at_omega + 2)
            call add_gradient(shaft, gearbox%i_work, sign*spin, jacobian)
            call add_gradient(shaft, o, sign, jacobian)
            jacobian(gearbox%i_work, o) = jacobian(gearbox%i_work, o) + torque
         end associate
      end associate
   end subroutine add_torque

   !> Add a multiple of the torque's derivatives to a row.
   pure subroutine add_gradient(shaft, row, factor, jacobian)
      type(shaft_t), intent(in) :: shaft
      integer, intent(in) :: row
      real(wp), intent(in) :: factor
      real(wp), intent(inout) :: jacobian(:, :)

      associate (a => shaft%i_psi_a, b => shaft%i_psi_b, c => shaft%stiffness)
         if (a > 0) jacobian(row, a) = jacobian(row, a) + factor*c
         if (b > 0) jacobian(row, b) = jacobian(row, b) - factor*c
      end associate
      call add_rates(shaft, row, factor*shaft%damping, jacobian)
   end subroutine add_gradient

   !> Add a multiple of the derivatives of the twist's rate to a row.
   pure subroutine add_rates(shaft, row, factor, jacobian)
      type(shaft_t), intent(in) :: shaft
      integer, intent(in) :: row
      real(wp), intent(in) :: factor
      real(wp), intent(inout) :: jacobian(:, :)

      associate (a => shaft%i_psi_a, b => shaft%i_psi_b)
         if (a > 0) jacobian(row, a + 1) = jacobian(row, a + 1) + factor
         if (b > 0) jacobian(row, b + 1) = jacobian(row, b + 1) - factor
      end associate
   end subroutine add_rates

end module evl_shaft_jacobian
