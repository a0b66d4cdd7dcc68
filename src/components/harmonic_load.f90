!> A torque that oscillates about a mean, over time or with the angle of its wheel:
!>
!>    M = mean + amplitude sin(2 pi frequency t + phase)
!>    M = mean + amplitude sin(order phi + phase)
!>
!> The argument is in cycles; whole cycles are subtracted before the sine, so that the precision does not decrease with their
!> number.
module evl_harmonic_load
   use evl_kinds, only: lanes, pi, wp
   use evl_load, only: load_t
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: kind_t, parameter_row, positive, span_t
   implicit none (type, external)
   private

   public :: harmonic_load

   type, extends(load_t) :: harmonic_load
      real(wp) :: mean = 0.0_wp      !! [N m]
      real(wp) :: frequency = 0.0_wp !! [Hz]; 0 if by order
      real(wp) :: order = 0.0_wp     !! cycles per revolution of the wheel; 0 if by frequency
      real(wp) :: phase = 0.0_wp     !! in cycles
   contains
      procedure :: describe
      procedure, nopass :: refusal
      procedure :: take
      procedure :: evaluate
   end type harmonic_load

contains

   include "numerics/sine_cosine.inc"

   pure subroutine describe(self, info)
      class(harmonic_load), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "harmonic"
      info%text = "torque harmonic over time or over the wheel's angle"
      allocate (info%rows, source=[parameter_row("mean", "N m", "mean torque, counterclockwise positive", default="0", &
                                                 plausible=span_t(0.0_wp, 1.0e7_wp)), &
                                   parameter_row("amplitude", "N m", "the torque is mean + amplitude sin(...)", &
                                                 plausible=span_t(1.0e-9_wp, 1.0e7_wp)), &
                                   parameter_row("frequency", "Hz", "frequency in sin(2 pi frequency t + phase); alternative to" &
                                                 //" order", range=positive, &
                                                 left_open=.true., &
                                                 plausible=span_t(1.0e-3_wp, 1.0e6_wp)), &
                                   parameter_row("order", "", "order in sin(order phi + phase), with the angle phi of the wheel" &
                                                 //" since the start", &
                                                 range=positive, left_open=.true.), &
                                   parameter_row("phase", "deg", "phase at time 0, or at angle 0", default="0", &
                                                 plausible=span_t(0.0_wp, 360.0_wp))])
   end subroutine describe

   pure subroutine refusal(input, message, field)
      type(parameter_view_t), intent(in) :: input
      character(len=*), intent(out) :: message, field

      message = ""
      field = ""
      if (input%has("frequency") .neqv. input%has("order")) return
      message = "a harmonic torque needs either 'frequency' or 'order'"
      if (input%has("frequency")) message = trim(message)//"; it has both"
   end subroutine refusal

   subroutine take(self, input)
      class(harmonic_load), intent(inout) :: self
      type(parameter_view_t), intent(in) :: input

      self%mean = input%number("mean")
      self%swing = input%number("amplitude")
      self%by_angle = input%has("order")
      if (self%by_angle) then
         self%order = input%number("order")
         self%cycle = 2*pi/self%order
      else
         self%frequency = input%number("frequency")
         self%cycle = 1/self%frequency
      end if
      self%phase = input%in_unit("phase")/360
      self%sense = "mean"
   end subroutine take

   !> Torque and its slope by the angle. Equation T75.
   pure subroutine evaluate(self, n, t, omega, angle, revolutions, segment, torque, damping, stiffness)
      class(harmonic_load), intent(in) :: self
      integer, intent(in) :: n, segment
      real(wp), intent(in) :: t(n), omega(n), angle(n), revolutions
      real(wp), intent(out) :: torque(n)
      real(wp), intent(inout), optional :: damping(n), stiffness(n)
      real(wp) :: frequency, order, start, sine(lanes), cosine(lanes)
      integer :: l

      frequency = self%frequency
      order = self%order
      start = start_of(self, revolutions)
      !$omp simd
      do l = 1, n
         call sine_cosine(argument(frequency*t(l) + order*(angle(l)/(2*pi)), start), sine(l), cosine(l))
      end do
      torque = self%mean + self%swing*sine(:n)
      if (present(stiffness)) stiffness = -self%swing*self%order*cosine(:n)
   end subroutine evaluate

   !> Cycles that do not depend on time and angle: the phase, and the fraction of a cycle at the end of the whole revolutions.
   pure real(wp) function start_of(self, revolutions) result(cycles)
      class(harmonic_load), intent(in) :: self
      real(wp), intent(in) :: revolutions

      cycles = modulo(self%order*revolutions, 1.0_wp) + self%phase
   end function start_of

   !> Argument of the sine: between -pi and pi.
   elemental real(wp) function argument(cycles, start) result(x)
      real(wp), intent(in) :: cycles, start
      real(wp), parameter :: to_whole = 1.5_wp*2.0_wp**52 ! a sum with it has no fractional digits
      real(wp) :: all

      all = cycles + start
      x = 2*pi*(all - ((all + to_whole) - to_whole))
   end function argument

end module evl_harmonic_load
