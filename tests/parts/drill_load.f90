!> A load of a kind that no case has: a drag with a linear and a quadratic term, of which one procedure may be wrong on purpose.
!>
!>    M = -coefficient omega - quadratic omega |omega|
!>
!> A procedure that is wrong has one and a half times the quadratic term. The test library `kernel_drill` offers this kind.
module evl_drill_load
   use evl_given, only: given_t
   use evl_kinds, only: lanes, wp
   use evl_load, only: lane_points, load_point, load_t
   use evl_row, only: kind_t, not_negative, parameter_row
   implicit none (type, external)
   private

   public :: drill_load

   integer, parameter :: in_ask = 1, in_lanes = 2, in_spin = 3, in_largest = 4

   type, extends(load_t) :: drill_load
      real(wp) :: coefficient = 0.0_wp !! [N m s]
      real(wp) :: quadratic = 0.0_wp   !! [N m s^2]
      integer :: wrong = 0             !! which procedure; 0: none
   contains
      procedure :: describe
      procedure :: take
      procedure :: ask
      procedure :: largest
      procedure :: add_in_lanes
      procedure :: spin_torque
   end type drill_load

contains

   pure subroutine describe(self, info)
      class(drill_load), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "drill"
      info%text = "drag, one of its procedures wrong on purpose"
      allocate (info%rows, source=[parameter_row("coefficient", "N m s/rad", "linear term", range=not_negative), &
                                   parameter_row("quadratic", "N m s2/rad2", "quadratic term", range=not_negative), &
                                   parameter_row("wrong", "", "1 ask, 2 add_in_lanes, 3 spin_torque, 4 largest", default="0")])
   end subroutine describe

   subroutine take(self, given)
      class(drill_load), intent(inout) :: self
      type(given_t), intent(in) :: given

      self%coefficient = given%number("coefficient")
      self%quadratic = given%number("quadratic")
      self%wrong = nint(given%number("wrong"))
      self%by_speed = .true.
      self%sense = "coefficient"
   end subroutine take

   !> The quadratic coefficient that a procedure takes.
   pure real(wp) function quadratic_of(self, procedure)
      class(drill_load), intent(in) :: self
      integer, intent(in) :: procedure

      quadratic_of = merge(1.5_wp, 1.0_wp, procedure == self%wrong)*self%quadratic
   end function quadratic_of

   pure subroutine ask(self, at, torque, damping, stiffness)
      class(drill_load), intent(in) :: self
      type(load_point), intent(in) :: at
      real(wp), intent(out) :: torque, damping, stiffness
      real(wp) :: quadratic

      quadratic = quadratic_of(self, in_ask)
      torque = -self%coefficient*at%omega - quadratic*at%omega*abs(at%omega)
      damping = self%coefficient + 2*quadratic*abs(at%omega)
      stiffness = 0
   end subroutine ask

   pure subroutine add_in_lanes(self, at, torque)
      class(drill_load), intent(in) :: self
      type(lane_points), intent(in) :: at
      real(wp), intent(inout) :: torque(lanes)
      real(wp) :: quadratic
      integer :: l

      quadratic = quadratic_of(self, in_lanes)
      do l = 1, lanes
         torque(l) = torque(l) - self%coefficient*at%omega(l) - quadratic*at%omega(l)*abs(at%omega(l))
      end do
   end subroutine add_in_lanes

   pure real(wp) function spin_torque(self, at, spin) result(torque)
      class(drill_load), intent(in) :: self
      type(load_point), intent(in) :: at
      real(wp), intent(in) :: spin

      associate (seen => at%omega + spin)
         torque = -self%coefficient*spin - quadratic_of(self, in_spin)*(seen*abs(seen) - at%omega*abs(at%omega))
      end associate
   end function spin_torque

   pure real(wp) function largest(self, ratio, speed)
      class(drill_load), intent(in) :: self
      real(wp), intent(in) :: ratio, speed

      largest = self%coefficient*ratio*speed + quadratic_of(self, in_largest)*(ratio*speed)**2
   end function largest

end module evl_drill_load
