!> Shaft between two wheels on one axis; it transmits only torque.
!>
!> Torque on the second wheel, T = c twist + d twist', twist = phi_a - phi_b; on the first -T. Both wheels have the same speed
!> ratio, so the twist is the difference of their deviations: the reference angle cancels analytically. A rigid shaft has no
!> twist: its wheels are one rotor, and share one deviation.
module evl_shaft
   use evl_kinds, only: wp
   use evl_row, only: not_negative, positive, row_t, span_t, type_choice, type_name, type_number, type_references
   use evl_springs_and_dampers, only: damper_power, spring_damper
   implicit none (type, external)
   private

   public :: shaft_t, shaft_energy, shaft_loss, shaft_torque, shaft_twist

   ! parameters of a shaft
   type(row_t), parameter, public :: shaft_rows(*) = [ &
                               row_t("kind", type_choice, "", "torsional spring and damper; rigid: the wheels rotate as one body", &
                                           default="elastic", &
                                           words="elastic rigid"), &
                                     row_t("name", type_name, "", "name in paths and the history", required=.true.), &
                                     row_t("wheels", type_references, "", "names of its two wheels, on one axis", required=.true., &
                                           holds="wheels"), &
            row_t("stiffness", type_number, "N m/rad", "torsional stiffness", range=positive, required=.true., variants="elastic", &
                                           plausible=span_t(1.0e-3_wp, 1.0e10_wp)), &
              row_t("damping", type_number, "N m s/rad", "torsional damping", range=not_negative, default="0", variants="elastic", &
                                           plausible=span_t(1.0e-9_wp, 1.0e7_wp))]

   type :: shaft_t
      integer :: wheel_a = 0, wheel_b = 0    !! its wheels
      logical :: rigid = .false.             !! it cannot twist
      real(wp) :: stiffness = 0.0_wp         !! c [N m/rad]; 0 if rigid
      real(wp) :: damping = 0.0_wp           !! d [N m s/rad]; 0 if rigid
      integer, allocatable :: behind(:)      !! wheels that a rigid one drives: its second wheel, and those rigidly behind it
      integer :: i_psi_a = 0, i_psi_b = 0    !! indices of the wheels' deviations in the state, rates follow; 0: none
   end type shaft_t

contains

   !> phi_a - phi_b [rad], or the rate of that [rad/s].
   pure real(wp) function shaft_twist(shaft, y, order) result(twist)
      type(shaft_t), intent(in) :: shaft
      real(wp), intent(in) :: y(*)
      integer, intent(in) :: order !! 0: itself, 1: its rate

      twist = 0
      if (shaft%rigid) return
      if (shaft%i_psi_a > 0) twist = y(shaft%i_psi_a + order)
      if (shaft%i_psi_b > 0) twist = twist - y(shaft%i_psi_b + order)
   end function shaft_twist

   !> Torque of an elastic shaft on its second wheel [N m]. Equation TR1.
   pure real(wp) function shaft_torque(shaft, y) result(torque)
      type(shaft_t), intent(in) :: shaft
      real(wp), intent(in) :: y(*)

      torque = spring_damper(shaft%stiffness, shaft%damping, shaft_twist(shaft, y, 0), shaft_twist(shaft, y, 1))
   end function shaft_torque

   !> Elastic energy [J].
   pure real(wp) function shaft_energy(shaft, y) result(energy)
      type(shaft_t), intent(in) :: shaft
      real(wp), intent(in) :: y(*)

      energy = shaft%stiffness*shaft_twist(shaft, y, 0)**2/2
   end function shaft_energy

   !> Power dissipated by its damping [W].
   pure real(wp) function shaft_loss(shaft, y) result(power)
      type(shaft_t), intent(in) :: shaft
      real(wp), intent(in) :: y(*)

      power = damper_power(shaft%damping, shaft_twist(shaft, y, 1))
   end function shaft_loss

end module evl_shaft
