!> Motor, or brake, by the tangent to its torque-speed curve:
!>
!>    M = torque + slope (omega - speed)
module evl_drive_load
   use evl_kinds, only: wp
   use evl_load, only: load_t
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: kind_t, parameter_row, span_t
   use evl_status, only: quantity
   implicit none (type, external)
   private

   public :: drive_load

   type, extends(load_t) :: drive_load
      real(wp) :: at_speed = 0.0_wp !! speed at which the tangent touches [rad/s]
      real(wp) :: torque = 0.0_wp   !! torque at that speed [N m]
      real(wp) :: slope = 0.0_wp    !! [N m s] <= 0
   contains
      procedure :: describe
      procedure, nopass :: refusal
      procedure :: take
      procedure :: evaluate
   end type drive_load

contains

   pure subroutine describe(self, info)
      class(drive_load), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "drive"
      info%text = "torque that decreases with the speed, as of a motor"
      allocate (info%rows, source=[parameter_row("speed", "rad/s", "angular velocity of the operating point", &
                                                 plausible=span_t(0.0_wp, 15000.0_wp)), &
                                   parameter_row("torque", "N m", "torque at that speed, counterclockwise positive", default="0", &
                                                 plausible=span_t(0.0_wp, 1.0e7_wp)), &
                                   parameter_row("slope", "N m s/rad", &
                                                 "slope of the torque-speed characteristic, at most 0: the torque is torque +" &
                                                 //" slope (omega - speed)", &
                                                 plausible=span_t(1.0e-12_wp, 1.0e6_wp))])
   end subroutine describe

   !> A torque that rises with the speed is unstable: the operating point would not be maintained.
   pure subroutine refusal(input, message, field)
      type(parameter_view_t), intent(in) :: input
      character(len=*), intent(out) :: message, field

      message = ""
      field = ""
      if (.not. input%number("slope") > 0) return
      field = "slope"
      associate (slope => input%number("slope"))
         message = "the torque of a drive must decrease with the speed: slope = "//quantity(slope, "N m s/rad") &
                   //" must be at most 0; if that is the stiffness of the motor's curve, give "//quantity(-slope, "")
      end associate
   end subroutine refusal

   subroutine take(self, input)
      class(drive_load), intent(inout) :: self
      type(parameter_view_t), intent(in) :: input

      self%at_speed = input%number("speed")
      self%torque = input%number("torque")
      self%rated = abs(self%torque)
      self%slope = input%number("slope")
      self%sense = "speed"
   end subroutine take

   !> Torque and its slope. Equation T74.
   pure subroutine evaluate(self, n, t, omega, angle, revolutions, segment, torque, damping, stiffness)
      class(drive_load), intent(in) :: self
      integer, intent(in) :: n, segment
      real(wp), intent(in) :: t(n), omega(n), angle(n), revolutions
      real(wp), intent(out) :: torque(n)
      real(wp), intent(inout), optional :: damping(n), stiffness(n)

      torque = self%torque + self%slope*(omega - self%at_speed)
      if (present(damping)) damping = -self%slope
   end subroutine evaluate

end module evl_drive_load
