!> Prescribed speed, constant or over time: the load provides the required torque.
module evl_speed_load
   use evl_kinds, only: wp
   use evl_knots, only: knot_slope, knot_value, knots_t
   use evl_load, only: load_t
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: kind_t, parameter_row, span_t, type_at_knots, type_knots
   implicit none (type, external)
   private

   public :: speed_load

   type, extends(load_t) :: speed_load
      real(wp) :: value = 0.0_wp !! [rad/s] without a table
      real(wp) :: rate = 0.0_wp  !! of that, as set by `feed` [rad/s^2]
   contains
      procedure :: describe
      procedure, nopass :: refusal
      procedure :: take
      procedure :: feed
      procedure :: evaluate
      procedure :: speed
      procedure :: acceleration
   end type speed_load

contains

   pure subroutine describe(self, info)
      class(speed_load), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "speed"
      info%text = "prescribed speed"
      allocate (info%rows, &
                source=[parameter_row("value", "rad/s", "constant angular velocity; alternative to time and speed", &
                                      left_open=.true., &
                                      plausible=span_t(0.0_wp, 15000.0_wp)), &
                        parameter_row("time", "s", "knots of the table, strictly increasing, at least two", &
                                      left_open=.true., &
                                      type=type_knots, &
                                      plausible=span_t(0.0_wp, 1.0e5_wp)), &
                        parameter_row("speed", "rad/s", &
                                      "angular velocity at the knots; linear between them, constant outside", &
                                      left_open=.true., type=type_at_knots, &
                                      plausible=span_t(0.0_wp, 15000.0_wp))])
   end subroutine describe

   pure subroutine refusal(input, message, field)
      type(parameter_view_t), intent(in) :: input
      character(len=*), intent(out) :: message, field

      message = ""
      field = ""
      if ((input%has("value") .neqv. input%has("time")) .and. (input%has("time") .eqv. input%has("speed"))) return
      message = "a prescribed speed needs either 'value' or both 'time' and 'speed'"
   end subroutine refusal

   subroutine take(self, input)
      class(speed_load), intent(inout) :: self
      type(parameter_view_t), intent(in) :: input

      self%prescribes = .true.
      if (input%has("value")) then
         self%value = input%number("value")
         self%fastest = abs(self%value)
         self%is_input = .true.
      else
         self%knots = knots_t(input%numbers("time"), input%numbers("speed"))
         self%fastest = maxval(abs(self%knots%values))
         self%sense = "speed"
      end if
   end subroutine take

   subroutine feed(self, value, rate)
      class(speed_load), intent(inout) :: self
      real(wp), intent(in) :: value, rate

      self%value = value
      self%rate = rate
   end subroutine feed

   pure subroutine evaluate(self, n, t, omega, angle, revolutions, segment, torque, damping, stiffness)
      class(speed_load), intent(in) :: self
      integer, intent(in) :: n, segment
      real(wp), intent(in) :: t(n), omega(n), angle(n), revolutions
      real(wp), intent(out) :: torque(n)
      real(wp), intent(inout), optional :: damping(n), stiffness(n)

      torque = 0
   end subroutine evaluate

   pure real(wp) function speed(self, t, segment)
      class(speed_load), intent(in) :: self
      real(wp), intent(in) :: t
      integer, intent(in) :: segment

      speed = self%value
      if (allocated(self%knots%time)) speed = knot_value(self%knots, t, segment)
   end function speed

   pure real(wp) function acceleration(self, segment)
      class(speed_load), intent(in) :: self
      integer, intent(in) :: segment

      acceleration = self%rate
      if (allocated(self%knots%time)) acceleration = knot_slope(self%knots, segment)
   end function acceleration

end module evl_speed_load
