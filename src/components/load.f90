!> Load: an external torque on a wheel, or a prescribed speed. Common interface of all kinds of load.
!>
!> The torque of a kind has one formula, `evaluate`, for one state or eight; all other torque results here derive from it. A
!> kind extends load_t in a file of its own and has a line in evl_load_kinds; no other module depends on the set of kinds.
module evl_load
   use evl_kind_finder, only: described_t
   use evl_kinds, only: wp
   use evl_knots, only: knots_t
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: short_length
   implicit none (type, external)
   private

   public :: load_point, load_t

   !> State in which a load is evaluated. The wheel's angle in the housing is 2 pi revolutions + angle.
   type :: load_point
      real(wp) :: t = 0.0_wp           !! [s]
      real(wp) :: omega = 0.0_wp       !! speed of the wheel [rad/s]
      real(wp) :: revolutions = 0.0_wp !! whole revolutions of the wheel; for loads with by_angle
      real(wp) :: angle = 0.0_wp       !! remaining angle [rad]; likewise
      integer :: segment = 0           !! knots passed, if there are any
   end type load_point

   type, abstract, extends(described_t) :: load_t
      integer :: wheel = 0                  !! index of the wheel on which it acts
      logical :: against_housing = .false.  !! reference of the speed and body that takes the reaction; otherwise the ground
      integer :: i_segment = 0              !! index of the segment in the discrete state; 0 without knots
      type(knots_t) :: knots                !! of a table, where the torque or its rate may jump. Not allocated without one
      logical :: prescribes = .false.       !! it prescribes the speed, and provides the torque for it
      logical :: by_speed = .false.         !! its torque depends on the speed of the wheel: `find_dependence`
      logical :: by_angle = .false.         !! its torque depends on the angle of the wheel
      logical :: may_feed = .false.         !! its torque may increase with the speed: it can excite a vibration
      logical :: is_loss = .false.          !! its power is dissipated, not work of the loads; its torque opposes the motion
      real(wp) :: swing = 0.0_wp            !! amplitude of its torque about the mean [N m]; steady-state analysis sets it to 0
      real(wp) :: cycle = huge(1.0_wp)      !! period of the swing: time [s], or by_angle the wheel's angle [rad]; huge: none
      real(wp) :: rated = 0.0_wp            !! its torque at the operating point, if it defines one [N m]
      real(wp) :: fastest = 0.0_wp          !! largest magnitude of the prescribed speed [rad/s]
      logical :: is_input = .false.         !! its torque or speed is one number, which `feed` can change
      character(len=short_length) :: sense = "value" !! parameter that determines the sign of its torque or speed
   contains
      procedure(take_numbers), deferred :: take
      procedure(torque_formula), deferred :: evaluate
      procedure, nopass :: refusal => no_refusal
      procedure, non_overridable :: find_dependence
      procedure, non_overridable :: ask
      procedure, non_overridable :: spin_torque
      procedure :: feed => feed_nothing
      procedure :: speed => no_speed
      procedure :: acceleration => no_acceleration
   end type load_t

   abstract interface

      !> Set the parameters: all are in their ranges, and `refusal` has found no error.
      subroutine take_numbers(self, input)
         import :: parameter_view_t, load_t
         implicit none (type, external)
         class(load_t), intent(inout) :: self
         type(parameter_view_t), intent(in) :: input
      end subroutine take_numbers

      !> Torque in n states with common whole revolutions and segment; a prescribed speed has none of its own. Optionally both
      !> its derivatives, which are zero on entry.
      pure subroutine torque_formula(self, n, t, omega, angle, revolutions, segment, torque, damping, stiffness)
         import :: load_t, wp
         implicit none (type, external)
         class(load_t), intent(in) :: self
         integer, intent(in) :: n                         !! 1 or 8: loops over them are vectorised
         real(wp), intent(in) :: t(n), omega(n), angle(n) !! as in `load_point`
         real(wp), intent(in) :: revolutions
         integer, intent(in) :: segment
         real(wp), intent(out) :: torque(n)                !! M, counterclockwise positive [N m]
         real(wp), intent(inout), optional :: damping(n)   !! -dM/domega [N m s]; 0 without by_speed
         real(wp), intent(inout), optional :: stiffness(n) !! -dM/dphi [N m]; 0 without by_angle
      end subroutine torque_formula

   end interface

contains

   !> Error message for numbers that are in their ranges but inconsistent, and the parameter to change; "" if there is no error.
   pure subroutine no_refusal(input, message, field)
      type(parameter_view_t), intent(in) :: input
      character(len=*), intent(out) :: message, field

      message = ""
      field = ""
   end subroutine no_refusal

   !> Determine whether the torque depends on the speed, from its derivative at several speeds and angles.
   subroutine find_dependence(self)
      class(load_t), intent(inout) :: self
      real(wp), parameter :: omega(8) = [-1.0e4_wp, -300.0_wp, -10.0_wp, -0.1_wp, 0.2_wp, 20.0_wp, 500.0_wp, 2.0e4_wp]
      real(wp), parameter :: angle(8) = [-3.0_wp, -2.0_wp, -1.0_wp, -0.1_wp, 0.3_wp, 1.2_wp, 2.1_wp, 3.1_wp]
      real(wp), dimension(8) :: t, torque, damping, stiffness

      t = 0
      damping = 0
      stiffness = 0
      call self%evaluate(8, t, omega, angle, 0.0_wp, 1, torque, damping, stiffness)
      self%by_speed = self%is_loss .or. any(abs(damping) > 0)
   end subroutine find_dependence

   !> Torque in one state; that of a prescribed speed is 0.
   pure subroutine ask(self, at, torque, damping, stiffness)
      class(load_t), intent(in) :: self
      type(load_point), intent(in) :: at
      real(wp), intent(out) :: torque, damping, stiffness !! as in `evaluate`
      real(wp) :: there(1), by_speed(1), by_angle(1)

      by_speed = 0
      by_angle = 0
      call self%evaluate(1, [at%t], [at%omega], [at%angle], at%revolutions, at%segment, there, by_speed, by_angle)
      torque = there(1)
      damping = by_speed(1)
      stiffness = by_angle(1)
   end subroutine ask

   !> Change of a torque against the ground by the rotation of the housing: it depends on the speed relative to the ground [N m].
   !>
   !> The tangent replaces the difference where both agree within rounding: it is exact if the torque is linear in the speed.
   pure real(wp) function spin_torque(self, at, spin) result(torque)
      class(load_t), intent(in) :: self
      type(load_point), intent(in) :: at !! in the housing
      real(wp), intent(in) :: spin       !! Omega_z of the housing [rad/s]
      type(load_point) :: seen
      real(wp) :: here, there, damping, stiffness

      seen = at
      seen%omega = at%omega + spin
      call self%ask(at, here, damping, stiffness)
      call self%ask(seen, there, damping, stiffness)
      torque = -damping*spin
      associate (difference => there - here, size => abs(here) + abs(there) + abs(damping*at%omega))
         if (.not. abs(difference - torque) <= 4*epsilon(size)*size) torque = difference
      end associate
   end function spin_torque

   !> Set the torque, or the prescribed speed and its rate, that is valid from now on; only of a load that is an input.
   subroutine feed_nothing(self, value, rate)
      class(load_t), intent(inout) :: self
      real(wp), intent(in) :: value !! [N m] or [rad/s]
      real(wp), intent(in) :: rate  !! of a speed [rad/s^2]

   end subroutine feed_nothing

   !> Prescribed speed [rad/s].
   pure real(wp) function no_speed(self, t, segment) result(speed)
      class(load_t), intent(in) :: self
      real(wp), intent(in) :: t      !! [s]
      integer, intent(in) :: segment !! knots passed, if there are any

      speed = 0
   end function no_speed

   !> Rate of the prescribed speed [rad/s^2].
   pure real(wp) function no_acceleration(self, segment) result(acceleration)
      class(load_t), intent(in) :: self
      integer, intent(in) :: segment

      acceleration = 0
   end function no_acceleration

end module evl_load
