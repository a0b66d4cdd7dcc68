!> A load: a torque on a wheel from outside, or a prescribed speed. What a kind of load is asked, whichever it is.
!>
!> A kind extends load_t in a file of its own and has a line in evl_load_kinds; nobody else knows which kinds there are.
module evl_load
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use evl_given, only: given_t
   use evl_kind_finder, only: described_t
   use evl_kinds, only: lanes, wp
   use evl_knots, only: knots_t
   use evl_row, only: short_length
   implicit none (type, external)
   private

   public :: lane_points, load_point, load_t

   !> Where a load is asked. The wheel's angle in the housing is 2 pi revolutions + angle.
   type :: load_point
      real(wp) :: t = 0.0_wp           !! [s]
      real(wp) :: omega = 0.0_wp       !! speed of the wheel [rad/s]
      real(wp) :: revolutions = 0.0_wp !! whole turns of the wheel; for loads with by_angle
      real(wp) :: angle = 0.0_wp       !! the rest [rad]; likewise
      integer :: segment = 0           !! knots passed, if it has any
   end type load_point

   !> The same of eight states.
   type :: lane_points
      real(wp) :: t(lanes), omega(lanes), angle(lanes) !! as above
      real(wp) :: revolutions = 0.0_wp
      integer :: segment = 0
   end type lane_points

   type, abstract, extends(described_t) :: load_t
      integer :: wheel = 0                  !! which wheel it acts on
      logical :: against_housing = .false.  !! the reaction, and the speed referred to; otherwise the ground
      integer :: i_segment = 0              !! index of the segment in the discrete state; 0 without knots
      type(knots_t) :: knots                !! of a table; where the torque or its rate may jump. Not allocated without one
      logical :: prescribes = .false.       !! it prescribes the speed, and brings what torque that needs
      logical :: by_speed = .false.         !! its torque depends on the speed of the wheel
      logical :: by_angle = .false.         !! its torque depends on the angle of the wheel
      logical :: may_feed = .false.         !! its torque may grow with the speed: it can feed a vibration
      real(wp) :: swing = 0.0_wp            !! amplitude of its torque about the mean [N m]; a steady state sets it to 0
      real(wp) :: cycle = huge(1.0_wp)      !! of the swing: of time [s], or by_angle of the wheel's angle [rad]; huge: none
      real(wp) :: rated = 0.0_wp            !! its torque at the operating point that it states, if it states one [N m]
      real(wp) :: fastest = 0.0_wp          !! largest magnitude of the prescribed speed [rad/s]
      logical :: is_input = .false.         !! its torque or speed is one number, which may be given anew: `feed`
      character(len=short_length) :: sense = "value" !! parameter that gives its torque or speed its sense
   contains
      procedure(take_numbers), deferred :: take
      procedure(torque_there), deferred :: ask
      procedure, nopass :: refusal => no_refusal
      procedure :: add_in_lanes => ask_one_by_one
      procedure :: spin_torque
      procedure :: feed => feed_nothing
      procedure :: speed => no_speed
      procedure :: acceleration => no_acceleration
   end type load_t

   abstract interface

      !> Take the parameters: every one is in its range, and `refusal` has nothing to say.
      subroutine take_numbers(self, given)
         import :: given_t, load_t
         implicit none (type, external)
         class(load_t), intent(inout) :: self
         type(given_t), intent(in) :: given
      end subroutine take_numbers

      !> The torque; a prescribed speed has none of its own.
      pure subroutine torque_there(self, at, torque, damping, stiffness)
         import :: load_point, load_t, wp
         implicit none (type, external)
         class(load_t), intent(in) :: self
         type(load_point), intent(in) :: at
         real(wp), intent(out) :: torque    !! M, counterclockwise positive [N m]
         real(wp), intent(out) :: damping   !! -dM/domega [N m s]; 0 without by_speed
         real(wp), intent(out) :: stiffness !! -dM/dphi [N m]; 0 without by_angle
      end subroutine torque_there

   end interface

contains

   !> What is wrong with numbers that are in their ranges, but do not go together, and the parameter to change; "" if nothing is.
   pure subroutine no_refusal(given, message, field)
      type(given_t), intent(in) :: given
      character(len=*), intent(out) :: message, field

      message = ""
      field = ""
   end subroutine no_refusal

   !> Add the torques of eight states, asked one by one: for a kind that has no loop of its own.
   pure subroutine ask_one_by_one(self, at, torque)
      class(load_t), intent(in) :: self
      type(lane_points), intent(in) :: at
      real(wp), intent(inout) :: torque(lanes) !! [N m]
      real(wp) :: mine, damping, stiffness
      integer :: l

      do l = 1, lanes
         call self%ask(load_point(at%t(l), at%omega(l), at%revolutions, at%angle(l), at%segment), mine, damping, stiffness)
         torque(l) = torque(l) + mine
      end do
   end subroutine ask_one_by_one

   !> What the turning of the housing adds to a torque against the ground: it follows the speed seen from there [N m].
   pure real(wp) function spin_torque(self, at, spin) result(torque)
      class(load_t), intent(in) :: self
      type(load_point), intent(in) :: at !! in the housing
      real(wp), intent(in) :: spin       !! Omega_z of the housing [rad/s]
      type(load_point) :: seen
      real(wp) :: here, damping, stiffness

      torque = 0
      if (.not. self%by_speed) return
      seen = at
      seen%omega = at%omega + spin
      call self%ask(at, here, damping, stiffness)
      call self%ask(seen, torque, damping, stiffness)
      torque = torque - here
   end function spin_torque

   !> Take the torque, or the prescribed speed and its rate, that holds from now on; only of a load that is an input.
   subroutine feed_nothing(self, value, rate)
      class(load_t), intent(inout) :: self
      real(wp), intent(in) :: value !! [N m] or [rad/s]
      real(wp), intent(in) :: rate  !! of a speed [rad/s^2]

   end subroutine feed_nothing

   !> Prescribed speed [rad/s].
   pure real(wp) function no_speed(self, t, segment) result(speed)
      class(load_t), intent(in) :: self
      real(wp), intent(in) :: t      !! [s]
      integer, intent(in) :: segment !! knots passed, if it has any

      speed = 0
   end function no_speed

   !> Rate of the prescribed speed [rad/s^2].
   pure real(wp) function no_acceleration(self, segment) result(acceleration)
      class(load_t), intent(in) :: self
      integer, intent(in) :: segment

      acceleration = 0
   end function no_acceleration

end module evl_load
