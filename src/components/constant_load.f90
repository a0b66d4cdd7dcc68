!> A constant torque.
module evl_constant_load
   use evl_kinds, only: wp
   use evl_load, only: load_t
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: kind_t, parameter_row, span_t
   implicit none (type, external)
   private

   public :: constant_load

   type, extends(load_t) :: constant_load
      real(wp) :: value = 0.0_wp !! [N m]
   contains
      procedure :: describe
      procedure :: take
      procedure :: feed
      procedure :: evaluate
   end type constant_load

contains

   pure subroutine describe(self, info)
      class(constant_load), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "torque"
      info%text = "constant torque"
      allocate (info%rows, source=[parameter_row("value", "N m", "torque, counterclockwise positive", &
                                                 plausible=span_t(1.0e-9_wp, 1.0e7_wp))])
   end subroutine describe

   subroutine take(self, input)
      class(constant_load), intent(inout) :: self
      type(parameter_view_t), intent(in) :: input

      self%value = input%number("value")
      self%is_input = .true.
   end subroutine take

   subroutine feed(self, value, rate)
      class(constant_load), intent(inout) :: self
      real(wp), intent(in) :: value, rate

      self%value = value
   end subroutine feed

   pure subroutine evaluate(self, n, t, omega, angle, revolutions, segment, torque, damping, stiffness)
      class(constant_load), intent(in) :: self
      integer, intent(in) :: n, segment
      real(wp), intent(in) :: t(n), omega(n), angle(n), revolutions
      real(wp), intent(out) :: torque(n)
      real(wp), intent(inout), optional :: damping(n), stiffness(n)

      torque = self%value
   end subroutine evaluate

end module evl_constant_load
