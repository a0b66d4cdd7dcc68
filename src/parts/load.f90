!> Torques on a wheel from outside, and prescribed speeds.
module evl_load
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: load_t, load_torque, load_damping, load_speed, load_acceleration, load_segment, load_next_knot, load_largest
   public :: load_varies
   public :: load_constant, load_viscous, load_table, load_prescribed_speed

   integer, parameter :: load_constant = 0         !! constant torque
   integer, parameter :: load_viscous = 1          !! torque against the speed
   integer, parameter :: load_table = 2            !! torque over time
   integer, parameter :: load_prescribed_speed = 3 !! speed, constant or over time

   type :: load_t
      integer :: wheel = 0                  !! which wheel it acts on
      integer :: kind = load_constant       !! one of the kinds above
      real(wp) :: value = 0.0_wp            !! torque [N m], coefficient [N m s] or speed [rad/s]
      real(wp), allocatable :: time(:)      !! knots [s], strictly increasing; size 0 without a table
      real(wp), allocatable :: values(:)    !! torque [N m] or speed [rad/s] there
      logical :: against_housing = .false.  !! the reaction, and the speed referred to; otherwise the ground
      integer :: i_segment = 0              !! index of the segment in the discrete state; 0 without a table
   end type load_t

contains

   !> Torque at time t and speed omega [N m]; a prescribed speed has none of its own.
   pure real(wp) function load_torque(load, t, omega, segment) result(torque)
      type(load_t), intent(in) :: load
      real(wp), intent(in) :: t        !! [s]
      real(wp), intent(in) :: omega    !! [rad/s]
      integer, intent(in) :: segment   !! number of knots passed, if there is a table

      select case (load%kind)
      case (load_constant)
         torque = load%value
      case (load_viscous)
         torque = -load%value*omega
      case (load_table)
         torque = interpolate(load, t, segment)
      case default
         torque = 0
      end select
   end function load_torque

   !> -d torque/d omega [N m s].
   elemental real(wp) function load_damping(load) result(damping)
      type(load_t), intent(in) :: load

      damping = merge(load%value, 0.0_wp, load%kind == load_viscous)
   end function load_damping

   !> Prescribed speed [rad/s].
   pure real(wp) function load_speed(load, t, segment) result(speed)
      type(load_t), intent(in) :: load
      real(wp), intent(in) :: t
      integer, intent(in) :: segment

      if (size(load%time) > 0) then
         speed = interpolate(load, t, segment)
      else
         speed = load%value
      end if
   end function load_speed

   !> Rate of the prescribed speed [rad/s^2].
   pure real(wp) function load_acceleration(load, segment) result(acceleration)
      type(load_t), intent(in) :: load
      integer, intent(in) :: segment

      acceleration = 0
      if (.not. load_varies(load, segment)) return
      acceleration = (load%values(segment + 1) - load%values(segment))/(load%time(segment + 1) - load%time(segment))
   end function load_acceleration

   !> Linear between the knots, constant before the first and after the last.
   pure real(wp) function interpolate(load, t, segment) result(value)
      type(load_t), intent(in) :: load
      real(wp), intent(in) :: t
      integer, intent(in) :: segment

      if (load_varies(load, segment)) then
         value = between_knots(t, load%time(segment), load%time(segment + 1), load%values(segment), load%values(segment + 1))
      else
         value = load%values(merge(1, size(load%time), segment < 1))
      end if
   end function interpolate

   include "parts/between_knots.inc"

   !> Whether a load has a table and is between two of its knots.
   pure logical function load_varies(load, segment) result(varies)
      type(load_t), intent(in) :: load
      integer, intent(in) :: segment !! number of knots passed

      varies = segment >= 1 .and. segment < size(load%time)
   end function load_varies

   !> Number of knots at or before t.
   pure integer function load_segment(load, t) result(segment)
      type(load_t), intent(in) :: load
      real(wp), intent(in) :: t

      segment = count(load%time <= t)
   end function load_segment

   !> Time of the next knot [s]; +huge if there is none.
   pure real(wp) function load_next_knot(load, segment) result(time)
      type(load_t), intent(in) :: load
      integer, intent(in) :: segment

      time = huge(time)
      if (segment < size(load%time)) time = load%time(segment + 1)
   end function load_next_knot

   !> Largest magnitude of what is given: torque, or prescribed speed.
   pure real(wp) function load_largest(load) result(largest)
      type(load_t), intent(in) :: load

      largest = abs(load%value)
      if (size(load%time) > 0) largest = maxval(abs(load%values))
   end function load_largest

end module evl_load
