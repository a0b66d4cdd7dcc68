!> A torque against the speed, proportional to it.
module evl_viscous_load
   use evl_kinds, only: wp
   use evl_load, only: load_t
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: kind_t, not_negative, parameter_row, span_t
   implicit none (type, external)
   private

   public :: viscous_load

   type, extends(load_t) :: viscous_load
      real(wp) :: coefficient = 0.0_wp !! [N m s] >= 0
   contains
      procedure :: describe
      procedure :: take
      procedure :: evaluate
   end type viscous_load

contains

   pure subroutine describe(self, info)
      class(viscous_load), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "viscous"
      info%text = "viscous torque"
      allocate (info%rows, &
                source=[parameter_row("coefficient", "N m s/rad", "the torque is minus coefficient times angular velocity", &
                                      range=not_negative, &
                                      plausible=span_t(1.0e-12_wp, 1.0e6_wp))])
   end subroutine describe

   subroutine take(self, input)
      class(viscous_load), intent(inout) :: self
      type(parameter_view_t), intent(in) :: input

      self%coefficient = input%number("coefficient")
      self%sense = "coefficient"
   end subroutine take

   pure subroutine evaluate(self, n, t, omega, angle, revolutions, segment, torque, damping, stiffness)
      class(viscous_load), intent(in) :: self
      integer, intent(in) :: n, segment
      real(wp), intent(in) :: t(n), omega(n), angle(n), revolutions
      real(wp), intent(out) :: torque(n)
      real(wp), intent(inout), optional :: damping(n), stiffness(n)

      torque = -self%coefficient*omega
      if (present(damping)) damping = self%coefficient
   end subroutine evaluate

end module evl_viscous_load
