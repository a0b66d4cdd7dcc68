!> A constant torque.
module evl_constant_load
   use evl_given, only: given_t
   use evl_kinds, only: lanes, wp
   use evl_load, only: lane_points, load_point, load_t
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
      procedure :: ask
      procedure :: add_in_lanes
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

   subroutine take(self, given)
      class(constant_load), intent(inout) :: self
      type(given_t), intent(in) :: given

      self%value = given%number("value")
      self%is_input = .true.
   end subroutine take

   subroutine feed(self, value, rate)
      class(constant_load), intent(inout) :: self
      real(wp), intent(in) :: value, rate

      self%value = value
   end subroutine feed

   pure subroutine ask(self, at, torque, damping, stiffness)
      class(constant_load), intent(in) :: self
      type(load_point), intent(in) :: at
      real(wp), intent(out) :: torque, damping, stiffness

      torque = self%value
      damping = 0
      stiffness = 0
   end subroutine ask

   pure subroutine add_in_lanes(self, at, torque)
      class(constant_load), intent(in) :: self
      type(lane_points), intent(in) :: at
      real(wp), intent(inout) :: torque(lanes)
      real(wp) :: value
      integer :: l

      value = self%value
      !$omp simd
      do l = 1, lanes
         torque(l) = torque(l) + value
      end do
   end subroutine add_in_lanes

end module evl_constant_load
