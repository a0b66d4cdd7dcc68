!> Load-independent loss of a shaft, as of seals, bearings and churning oil: a torque against the motion, from a table over the
!> speed.
!>
!>    M = -sign(omega) T(|omega|)
!>
!> T is linear between its knots, constant beyond the last, and linear from 0 at standstill to the first: M is odd and continuous,
!> with the slope -torque/speed of the first knot through 0. Its power is dissipated, not work of the loads.
module evl_loss_load
   use evl_kinds, only: wp
   use evl_load, only: load_t
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: kind_t, not_negative, parameter_row, span_t, type_at_knots, type_knots
   use evl_status, only: quantity
   implicit none (type, external)
   private

   public :: loss_load

   type, extends(load_t) :: loss_load
      real(wp), allocatable :: speeds(:) !! start of each linear part, the first 0 [rad/s]
      real(wp), allocatable :: ranges(:) !! its length [rad/s]
      real(wp), allocatable :: slopes(:) !! dT/d|omega| in it [N m s]
   contains
      procedure :: describe
      procedure, nopass :: refusal
      procedure :: take
      procedure :: evaluate
   end type loss_load

contains

   pure subroutine describe(self, info)
      class(loss_load), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "loss"
      info%text = "load-independent loss"
      allocate (info%rows, &
                source=[parameter_row("speed", "rad/s", "knots of the table, strictly increasing, at least two: magnitudes of the" &
                                      //" angular velocity", range=not_negative, type=type_knots, &
                                      plausible=span_t(1.0e-9_wp, 15000.0_wp)), &
                        parameter_row("torque", "N m", "magnitude of the torque at the knots; linear between them and from 0 at" &
                                      //" standstill to the first, constant beyond the last", range=not_negative, &
                                      type=type_at_knots, plausible=span_t(1.0e-9_wp, 1.0e7_wp))])
   end subroutine describe

   !> A torque at standstill has no direction.
   pure subroutine refusal(input, message, field)
      type(parameter_view_t), intent(in) :: input
      character(len=*), intent(out) :: message, field

      message = ""
      field = ""
      associate (speed => input%numbers("speed"), torque => input%numbers("torque"))
         if (speed(1) > 0 .or. .not. torque(1) > 0) return
         field = "torque"
         message = "the torque of a loss at standstill must be 0, but is "//quantity(torque(1), "N m") &
                   //"; give a small first speed, below which the torque is proportional to the speed"
      end associate
   end subroutine refusal

   subroutine take(self, input)
      class(loss_load), intent(inout) :: self
      type(parameter_view_t), intent(in) :: input

      associate (speed => input%numbers("speed"), torque => input%numbers("torque"))
         if (speed(1) > 0) then
            call divide(self, [0.0_wp, speed], [0.0_wp, torque])
         else
            call divide(self, speed, torque)
         end if
      end associate
      self%may_feed = any(self%slopes < 0)
      self%is_loss = .true.
      self%sense = "torque"
   end subroutine take

   !> Linear parts of the table.
   subroutine divide(self, speed, torque)
      class(loss_load), intent(inout) :: self
      real(wp), intent(in) :: speed(:), torque(:) !! the first of both is 0
      integer :: n

      n = size(speed) - 1
      allocate (self%speeds(n), self%ranges(n), self%slopes(n))
      self%speeds = speed(:n)
      self%ranges = speed(2:) - speed(:n)
      self%slopes = (torque(2:) - torque(:n))/self%ranges
   end subroutine divide

   !> Torque and its slope; at a knot the slope towards higher speeds. Equation T82.
   pure subroutine evaluate(self, n, t, omega, angle, revolutions, segment, torque, damping, stiffness)
      class(loss_load), intent(in) :: self
      integer, intent(in) :: n, segment
      real(wp), intent(in) :: t(n), omega(n), angle(n), revolutions
      real(wp), intent(out) :: torque(n)
      real(wp), intent(inout), optional :: damping(n), stiffness(n)
      real(wp) :: passed
      integer :: k, l

      torque = 0
      do k = 1, size(self%speeds)
         !$omp simd private(passed)
         do l = 1, n
            passed = min(max(abs(omega(l)) - self%speeds(k), 0.0_wp), self%ranges(k))
            torque(l) = torque(l) + self%slopes(k)*passed
         end do
      end do
      torque = -sign(max(torque, 0.0_wp), omega) ! rounding may leave less than 0
      if (.not. present(damping)) return
      do k = 1, size(self%speeds)
         where (abs(omega) >= self%speeds(k) .and. abs(omega) < self%speeds(k) + self%ranges(k)) damping = self%slopes(k)
      end do
   end subroutine evaluate

end module evl_loss_load
