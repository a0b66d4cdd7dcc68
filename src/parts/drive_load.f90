!> A motor, or a brake, by the tangent to its curve of torque over speed:
!>
!>    M = torque + slope (omega - speed)
module evl_drive_load
   use evl_given, only: given_t
   use evl_kinds, only: lanes, wp
   use evl_load, only: lane_points, load_point, load_t
   use evl_row, only: kind_t, parameter_row, span_t
   use evl_status, only: quantity
   implicit none (type, external)
   private

   public :: drive_load

   type, extends(load_t) :: drive_load
      real(wp) :: at_speed = 0.0_wp !! where the tangent touches [rad/s]
      real(wp) :: torque = 0.0_wp   !! there [N m]
      real(wp) :: slope = 0.0_wp    !! [N m s] <= 0
   contains
      procedure :: describe
      procedure, nopass :: refusal
      procedure :: take
      procedure :: ask
      procedure :: add_in_lanes
      procedure :: spin_torque
   end type drive_load

contains

   pure subroutine describe(self, info)
      class(drive_load), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "drive"
      info%text = "torque that falls as the speed rises, as a motor's"
      allocate (info%rows, source=[parameter_row("speed", "rad/s", "angular velocity of the operating point", &
                                                 plausible=span_t(0.0_wp, 15000.0_wp)), &
                                   parameter_row("torque", "N m", "torque at that speed, counterclockwise positive", default="0", &
                                                 plausible=span_t(0.0_wp, 1.0e7_wp)), &
                                   parameter_row("slope", "N m s/rad", &
                                                 "the torque is torque + slope (omega - speed); at most 0: minus the stiffness of" &
                                                 //" the motor's curve", &
                                                 plausible=span_t(1.0e-12_wp, 1.0e6_wp))])
   end subroutine describe

   !> A torque that rises with the speed feeds itself: nothing would hold the operating point.
   pure subroutine refusal(given, message, field)
      type(given_t), intent(in) :: given
      character(len=*), intent(out) :: message, field

      message = ""
      field = ""
      if (.not. given%number("slope") > 0) return
      field = "slope"
      associate (slope => given%number("slope"))
         message = "the torque of a drive has to fall as the speed rises: slope = "//quantity(slope, "N m s/rad") &
                   //" must be at most 0; if that is the stiffness of the motor's curve, give "//quantity(-slope, "")
      end associate
   end subroutine refusal

   subroutine take(self, given)
      class(drive_load), intent(inout) :: self
      type(given_t), intent(in) :: given

      self%at_speed = given%number("speed")
      self%torque = given%number("torque")
      self%rated = abs(self%torque)
      self%slope = given%number("slope")
      self%by_speed = self%slope < 0
      self%sense = "speed"
   end subroutine take

   pure subroutine ask(self, at, torque, damping, stiffness)
      class(drive_load), intent(in) :: self
      type(load_point), intent(in) :: at
      real(wp), intent(out) :: torque, damping, stiffness

      torque = self%torque + self%slope*(at%omega - self%at_speed)
      damping = -self%slope
      stiffness = 0
   end subroutine ask

   pure subroutine add_in_lanes(self, at, torque)
      class(drive_load), intent(in) :: self
      type(lane_points), intent(in) :: at
      real(wp), intent(inout) :: torque(lanes)
      real(wp) :: there, slope, speed
      integer :: l

      there = self%torque
      slope = self%slope
      speed = self%at_speed
      !$omp simd
      do l = 1, lanes
         torque(l) = torque(l) + (there + slope*(at%omega(l) - speed))
      end do
   end subroutine add_in_lanes

   pure real(wp) function spin_torque(self, at, spin) result(torque)
      class(drive_load), intent(in) :: self
      type(load_point), intent(in) :: at
      real(wp), intent(in) :: spin

      torque = self%slope*spin
   end function spin_torque

end module evl_drive_load
