!> A torque against the speed, proportional to it.
module evl_viscous_load
   use evl_given, only: given_t
   use evl_kinds, only: lanes, wp
   use evl_load, only: lane_points, load_point, load_t
   use evl_row, only: kind_t, not_negative, parameter_row, span_t
   implicit none (type, external)
   private

   public :: viscous_load

   type, extends(load_t) :: viscous_load
      real(wp) :: coefficient = 0.0_wp !! [N m s] >= 0
   contains
      procedure :: describe
      procedure :: take
      procedure :: ask
      procedure :: add_in_lanes
      procedure :: spin_torque
   end type viscous_load

contains

   pure subroutine describe(self, info)
      class(viscous_load), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "viscous"
      info%text = "torque against the speed"
      allocate (info%rows, &
                source=[parameter_row("coefficient", "N m s/rad", "the torque is minus coefficient times angular velocity", &
                                      range=not_negative, &
                                      plausible=span_t(1.0e-12_wp, 1.0e6_wp))])
   end subroutine describe

   subroutine take(self, given)
      class(viscous_load), intent(inout) :: self
      type(given_t), intent(in) :: given

      self%coefficient = given%number("coefficient")
      self%by_speed = self%coefficient > 0
      self%sense = "coefficient"
   end subroutine take

   pure subroutine ask(self, at, torque, damping, stiffness)
      class(viscous_load), intent(in) :: self
      type(load_point), intent(in) :: at
      real(wp), intent(out) :: torque, damping, stiffness

      torque = -self%coefficient*at%omega
      damping = self%coefficient
      stiffness = 0
   end subroutine ask

   pure subroutine add_in_lanes(self, at, torque)
      class(viscous_load), intent(in) :: self
      type(lane_points), intent(in) :: at
      real(wp), intent(inout) :: torque(lanes)
      real(wp) :: coefficient
      integer :: l

      coefficient = self%coefficient
      !$omp simd
      do l = 1, lanes
         torque(l) = torque(l) - coefficient*at%omega(l)
      end do
   end subroutine add_in_lanes

   pure real(wp) function spin_torque(self, at, spin) result(torque)
      class(viscous_load), intent(in) :: self
      type(load_point), intent(in) :: at
      real(wp), intent(in) :: spin

      torque = -self%coefficient*spin
   end function spin_torque

end module evl_viscous_load
