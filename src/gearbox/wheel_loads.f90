!> Loads of wheels: torques, their reaction on the housing, and the motion of a wheel with prescribed speed.
module evl_wheel_loads
   use evl_gearbox, only: gearbox_t, i_turns, wheel_speed, wheel_t
   use evl_housing, only: frame_t, housing_fixed, housing_frame
   use evl_kinds, only: pi, wp
   use evl_load, only: load_point, load_t
   use evl_local_variables, only: i_theta
   use evl_rational, only: rational_parts
   use evl_tooth_contact, only: tracking_closed_form
   implicit none (type, external)
   private

   public :: evaluate_load, followed_speed, hold_still, known_torques, load_terms, load_point_of, load_torque, lost_power
   public :: segment_of, turns_of_wheel, wheel_acceleration, wheel_follows_ground, wheel_housing_torque, wheel_spin_torque

   !> Torque of a load at a state, with derivatives.
   type :: load_terms
      real(wp) :: torque             !! as from `load_torque` [N m]
      real(wp) :: damping, stiffness !! -dM/domega and -dM/dphi at the speed in its frame of reference [N m s], [N m]
   end type load_terms

contains

   !> Arguments of a load: time, and speed and angle of its wheel in the housing.
   pure type(load_point) function load_point_of(gearbox, index, t, y, integers) result(at)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index !! index of the load
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)

      associate (load => gearbox%loads(index)%load)
         associate (wheel => gearbox%wheels(load%wheel))
            at%t = t
            at%omega = wheel_speed(wheel, y)
            if (load%i_segment > 0) at%segment = integers(load%i_segment)
            if (.not. load%by_angle) return
            call turns_of_wheel(wheel, integers, at%revolutions, at%angle)
            at%angle = at%angle + wheel%ratio*y(i_theta)
            if (wheel%i_psi > 0) at%angle = at%angle + y(wheel%i_psi)
         end associate
      end associate
   end function load_point_of

   !> The same with the speed relative to the load's frame of reference, the housing or the ground.
   pure type(load_point) function spinning_point_of(gearbox, index, t, y, integers, spin) result(at)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index !! index of the load
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: spin !! Omega_z of the housing [rad/s]

      at = load_point_of(gearbox, index, t, y, integers)
      if (.not. gearbox%loads(index)%load%against_housing) at%omega = at%omega + spin
   end function spinning_point_of

   !> Rotation of a wheel by the whole revolutions of the reference wheel: its whole revolutions, and the remainder [rad].
   pure subroutine turns_of_wheel(wheel, integers, revolutions, angle)
      type(wheel_t), intent(in) :: wheel
      integer, intent(in) :: integers(*)
      real(wp), intent(out) :: revolutions, angle

      call rational_parts(wheel%exact_ratio, integers(i_turns), revolutions, angle)
      angle = 2*pi*angle
   end subroutine turns_of_wheel

   !> Number of knots that a load's table has passed; 0 without a table.
   pure integer function segment_of(load, integers) result(segment)
      class(load_t), intent(in) :: load
      integer, intent(in) :: integers(*)

      segment = 0
      if (load%i_segment > 0) segment = integers(load%i_segment)
   end function segment_of

   !> Torque of a load at a state [N m]; a prescribed speed has none of its own.
   pure real(wp) function load_torque(gearbox, index, t, y, integers) result(torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index !! index of the load
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp) :: damping, stiffness

      call gearbox%loads(index)%load%ask(load_point_of(gearbox, index, t, y, integers), torque, damping, stiffness)
   end function load_torque

   !> Torque of a load, with derivatives with respect to the speed and the angle of the wheel.
   pure subroutine evaluate_load(gearbox, index, t, y, integers, spin, terms)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index !! index of the load
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: spin !! Omega_z of the housing [rad/s]
      type(load_terms), intent(out) :: terms
      real(wp) :: torque

      associate (load => gearbox%loads(index)%load)
         call load%ask(load_point_of(gearbox, index, t, y, integers), terms%torque, terms%damping, terms%stiffness)
         if (load%against_housing .or. .not. abs(spin) > 0) return
         call load%ask(spinning_point_of(gearbox, index, t, y, integers, spin), torque, terms%damping, terms%stiffness)
      end associate
   end subroutine evaluate_load

   !> Power lost in a load with is_loss, and its derivative with respect to the speed. Equation T83.
   pure subroutine lost_power(gearbox, index, t, y, integers, spin, power, slope)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index !! index of the load
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: spin !! Omega_z of the housing [rad/s]
      real(wp), intent(out) :: power !! [W]
      real(wp), intent(out) :: slope !! dP/domega [N m]
      type(load_point) :: at
      real(wp) :: torque, damping, stiffness

      at = spinning_point_of(gearbox, index, t, y, integers, spin)
      call gearbox%loads(index)%load%ask(at, torque, damping, stiffness)
      power = -torque*at%omega
      slope = damping*at%omega - torque
   end subroutine lost_power

   !> Simplify a gearbox for steady states: loads do not oscillate, and contacts are in closed form.
   pure subroutine hold_still(gearbox)
      type(gearbox_t), intent(inout) :: gearbox
      integer :: i

      do i = 1, size(gearbox%loads)
         gearbox%loads(i)%load%swing = 0
      end do
      gearbox%contacts%tracking = tracking_closed_form
      gearbox%contacts%i_track = 0
   end subroutine hold_still

   !> Sum of the torques of the loads of each wheel, without that of a prescribed speed [N m].
   pure subroutine known_torques(gearbox, t, y, integers, torques)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: torques(size(gearbox%wheels))
      integer :: i

      torques = 0
      do i = 1, size(gearbox%loads)
         associate (torque => torques(gearbox%loads(i)%load%wheel))
            torque = torque + load_torque(gearbox, i, t, y, integers)
         end associate
      end do
   end subroutine known_torques

   !> Change of a wheel's torque by the housing rotation: torques against the ground depend on the speed relative to it [N m].
   pure real(wp) function wheel_spin_torque(gearbox, index, spin, t, y, integers) result(torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: spin !! Omega_z of the housing [rad/s]
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      integer :: i

      torque = 0
      do i = 1, size(gearbox%wheels(index)%loads)
         associate (number => gearbox%wheels(index)%loads(i))
            if (gearbox%loads(number)%load%against_housing) cycle
            torque = torque + gearbox%loads(number)%load%spin_torque(load_point_of(gearbox, number, t, y, integers), spin)
         end associate
      end do
   end function wheel_spin_torque

   !> Part of the torque of a wheel's loads with reaction on the housing [N m].
   pure real(wp) function wheel_housing_torque(gearbox, index, spin, total, t, y, integers) result(torque)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: spin  !! Omega_z of the housing [rad/s]
      real(wp), intent(in) :: total !! of all loads, including that of a prescribed speed [N m]
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      logical :: follows
      integer :: i

      follows = wheel_follows_ground(gearbox, index)
      torque = merge(0.0_wp, total, follows)
      do i = 1, size(gearbox%wheels(index)%loads)
         associate (number => gearbox%wheels(index)%loads(i))
            if (gearbox%loads(number)%load%against_housing .neqv. follows) cycle
            torque = torque + merge(1.0_wp, -1.0_wp, follows)*load_torque(gearbox, number, t, y, integers)
         end associate
      end do
      if (.not. follows) torque = torque - wheel_spin_torque(gearbox, index, spin, t, y, integers)
   end function wheel_housing_torque

   !> Whether phi'' + Omega_z', not phi'', follows from torques or a prescribed speed: always, except for a speed against the
   !> housing.
   pure logical function wheel_follows_ground(gearbox, index) result(follows)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index

      follows = .true.
      associate (driver => gearbox%wheels(index)%prescribed)
         if (driver > 0) follows = .not. gearbox%loads(driver)%load%against_housing
      end associate
   end function wheel_follows_ground

   !> Angular velocity of a wheel relative to the frame of its prescribed speed [rad/s].
   pure real(wp) function followed_speed(gearbox, index, t, y) result(speed)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t, y(*)
      type(frame_t) :: frame

      speed = wheel_speed(gearbox%wheels(index), y)
      if (gearbox%housing%kind == housing_fixed .or. .not. wheel_follows_ground(gearbox, index)) return
      call housing_frame(gearbox%housing, t, y, frame)
      speed = speed + frame%omega(3)
   end function followed_speed

   !> Angular acceleration of a rotor under the torque of its meshes, shafts and loads, or the prescribed one [rad/s^2].
   !> Equation T54.
   pure real(wp) function wheel_acceleration(gearbox, index, torque, integers) result(acceleration)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index       !! one of its wheels
      real(wp), intent(in) :: torque     !! on the rotor [N m]
      integer, intent(in) :: integers(gearbox%n_integers)

      associate (wheel => gearbox%wheels(index))
         if (wheel%prescribed > 0) then
            associate (load => gearbox%loads(wheel%prescribed)%load)
               acceleration = load%acceleration(segment_of(load, integers))
            end associate
         else
            acceleration = torque*wheel%per_inertia
         end if
      end associate
   end function wheel_acceleration

end module evl_wheel_loads
