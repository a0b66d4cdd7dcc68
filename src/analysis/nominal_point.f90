!> Nominal operating point of a gearbox: the speed at which its loads balance, and the load of every mesh and shaft there.
!>
!> The wheels turn together, without friction, by their speed ratios g. Each load acts with its mean: tables at a knot, harmonic
!> torques without their amplitude. A prescribed speed is the speed of the point; otherwise the sum of g M(g omega) over all loads
!> is zero there. No type of load has a torque that rises with the speed, so there is at most one such speed. If there is none, the
!> loads accelerate the wheels: the speed is that after one second from rest, and the inertia of the wheels is part of the balance.
!> If tables change the loads, the speed and each mesh and shaft load are those of the knot with the largest magnitude.
!> Source: docs/theory/theory.md, "Nominal operating point".
module evl_nominal_point
   use evl_gearbox, only: gearbox_t, nominal_point_t
   use evl_kinds, only: wp
   use evl_load, only: load_point, load_t
   use evl_load_instants, only: first_instant, instant_t, next_instant
   use evl_train_statics, only: lay_out_train, train_carries, train_t
   use evl_wheel_loads, only: segment_of
   implicit none (type, external)
   private

   public :: gearbox_set_nominal, loads_at_start, speed_in_balance

   real(wp), parameter :: spin_up = 1.0_wp        !! time at which the speed of an unbalanced gearbox is taken [s]
   real(wp), parameter :: rounding = 8*epsilon(1.0_wp) !! limit of the sum of torques over the sum of their magnitudes for a balance
   real(wp), parameter :: nothing = 1.0e-12_wp    !! fraction of the loads below which a mesh or shaft counts as unloaded

contains

   !> Compute the nominal operating point.
   subroutine gearbox_set_nominal(gearbox)
      type(gearbox_t), intent(inout) :: gearbox !! including its contacts
      type(train_t) :: train
      type(nominal_point_t) :: point
      type(instant_t) :: now
      real(wp), dimension(size(gearbox%pairs) + size(gearbox%shafts)) :: nominal, swing, scale, there
      real(wp) :: speed, acceleration, swing_speed, swing_torque
      logical :: is_balanced, is_next

      call lay_out_train(gearbox, train)
      nominal = 0
      now = first_instant(gearbox)
      do
         call operating_speed(gearbox, now, speed, is_balanced)
         point%is_balanced = point%is_balanced .and. is_balanced
         if (abs(speed) > abs(point%speed)) point%speed = speed
         acceleration = 0
         if (.not. is_balanced) acceleration = speed/spin_up
         if (.not. is_balanced) speed = 0
         call transmitted_loads(gearbox, train, now, speed*gearbox%wheels%ratio, acceleration, there)
         where (abs(there) > abs(nominal)) nominal = there
         point%torque_scale = max(point%torque_scale, torque_through(gearbox, now, speed))
         call next_instant(gearbox, now, is_next)
         if (.not. is_next) exit
      end do
      call swinging_loads(gearbox, train, swing, swing_speed, swing_torque)
      if (.not. point%torque_scale > 0) point%torque_scale = swing_torque
      if (.not. point%torque_scale > 0) point%torque_scale = rated_torque(gearbox)
      point%speed_scale = abs(point%speed)
      if (.not. point%speed_scale > 0) point%speed_scale = swing_speed
      scale = abs(nominal)
      where (.not. scale > 0) scale = point%torque_scale/advances(train, gearbox)
      associate (n => size(gearbox%pairs))
         point%force = nominal(:n)
         point%torque = nominal(n + 1:)
         point%mesh_load = abs(point%force)
         where (.not. point%mesh_load > 0) point%mesh_load = swing(:n)
         point%mesh_scale = scale(:n)
         point%shaft_scale = scale(n + 1:)
      end associate
      gearbox%nominal = point
   end subroutine gearbox_set_nominal

   !> Largest load of each mesh [N] and shaft [N m] during acceleration by the loads at given speeds of the wheels.
   subroutine loads_at_start(gearbox, speeds, force, torque)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: speeds(:) !! of the wheels [rad/s]
      real(wp), intent(out) :: force(:), torque(:)
      type(train_t) :: train
      type(instant_t) :: now
      real(wp) :: there(size(force) + size(torque)), turns(size(speeds)), fastest
      logical :: is_next

      call lay_out_train(gearbox, train)
      turns = speeds/gearbox%wheels%ratio
      fastest = turns(maxloc(abs(turns), dim=1))
      force = 0
      torque = 0
      now = first_instant(gearbox)
      do
         call transmitted_loads(gearbox, train, now, speeds, acceleration_at(gearbox, now, speeds), there)
         there = max(abs(there), torque_through(gearbox, now, fastest)/advances(train, gearbox))
         force = max(force, abs(there(:size(force))))
         torque = max(torque, abs(there(size(force) + 1:)))
         call next_instant(gearbox, now, is_next)
         if (.not. is_next) exit
      end do
   end subroutine loads_at_start

   !> Speed of the reference wheel at which the loads at a time balance; without a balance, after one second from rest [rad/s].
   pure real(wp) function speed_in_balance(gearbox, t, integers) result(speed)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      integer, intent(in) :: integers(:)
      type(instant_t) :: now
      logical :: is_balanced
      integer :: i

      now%t = t
      now%segments = [(segment_of(gearbox%loads(i)%load, integers), i=1, size(gearbox%loads))]
      call operating_speed(gearbox, now, speed, is_balanced)
   end function speed_in_balance

   !> Whether a load prescribes the speed of a wheel.
   pure logical function prescribes_speed(gearbox)
      type(gearbox_t), intent(in) :: gearbox

      prescribes_speed = any(gearbox%wheels%prescribed > 0)
   end function prescribes_speed

   !> Speed of the reference wheel: the largest prescribed one, that of the balance, or that after one second from rest [rad/s].
   pure subroutine operating_speed(gearbox, now, speed, is_balanced)
      type(gearbox_t), intent(in) :: gearbox
      type(instant_t), intent(in) :: now
      real(wp), intent(out) :: speed
      logical, intent(out) :: is_balanced
      real(wp) :: prescribed
      integer :: i

      is_balanced = .true.
      if (.not. prescribes_speed(gearbox)) then
         call find_balance(gearbox, now, speed, is_balanced)
         if (.not. is_balanced) speed = acceleration_at(gearbox, now, 0*gearbox%wheels%ratio)*spin_up
         return
      end if
      speed = 0
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i)%load)
            if (.not. load%prescribes) cycle
            prescribed = load%speed(now%t, now%segments(i))/gearbox%wheels(load%wheel)%ratio
            if (abs(prescribed) > abs(speed)) speed = prescribed
         end associate
      end do
   end subroutine operating_speed

   !> Speed at which the torques balance, by Newton's method with bracketing, starting at rest. Equation T66.
   pure subroutine find_balance(gearbox, now, speed, exists)
      type(gearbox_t), intent(in) :: gearbox
      type(instant_t), intent(in) :: now
      real(wp), intent(out) :: speed !! of the reference wheel [rad/s]; 0 without a balance
      logical, intent(out) :: exists
      integer, parameter :: most_newton = 200
      real(wp), parameter :: first = 1.0_wp !! first trial speed if the torque does not depend on the speed [rad/s]
      real(wp), parameter :: never = huge(1.0_wp)
      real(wp) :: sense, torque, damping, gross, low, high, x, next
      integer :: i

      speed = 0
      call sum_torques(gearbox, now, 0.0_wp, torque, damping, gross)
      exists = abs(torque) <= rounding*gross
      if (exists .or. .not. any([(gearbox%loads(i)%load%by_speed, i=1, size(gearbox%loads))])) return
      sense = sign(1.0_wp, torque)
      low = 0
      high = never
      x = 0
      do i = 1, most_newton
         next = never
         if (damping > 0) next = x + sense*torque/damping
         if (.not. (next > low .and. next < high)) next = merge(max(2*low, first), low + (high - low)/2, high >= never)
         call sum_torques(gearbox, now, sense*next, torque, damping, gross)
         exists = abs(torque) <= rounding*gross .or. abs(next - x) <= epsilon(x)*next
         x = next
         if (exists) exit
         if (sense*torque > 0) then
            low = x
         else
            high = x
         end if
      end do
      if (exists) speed = sense*x
   end subroutine find_balance

   !> Sum of all torques at a speed of the reference wheel, referred to that wheel. Equation T66.
   pure subroutine sum_torques(gearbox, now, speed, torque, damping, gross)
      type(gearbox_t), intent(in) :: gearbox
      type(instant_t), intent(in) :: now
      real(wp), intent(in) :: speed    !! [rad/s]
      real(wp), intent(out) :: torque  !! sum [N m]
      real(wp), intent(out) :: damping !! minus its derivative [N m s]
      real(wp), intent(out) :: gross   !! sum of their magnitudes [N m]
      real(wp) :: mine, slope
      integer :: i

      torque = 0
      damping = 0
      gross = 0
      do i = 1, size(gearbox%loads)
         associate (g => gearbox%wheels(gearbox%loads(i)%load%wheel)%ratio)
            call mean_torque(gearbox%loads(i)%load, now%t, now%segments(i), g*speed, mine, slope)
            torque = torque + g*mine
            damping = damping + g**2*slope
            gross = gross + abs(g*mine)
         end associate
      end do
   end subroutine sum_torques

   !> Mean torque of a load, without its harmonic amplitude.
   pure subroutine mean_torque(load, t, segment, omega, torque, damping)
      class(load_t), intent(in) :: load
      real(wp), intent(in) :: t      !! [s]
      integer, intent(in) :: segment !! number of knots passed
      real(wp), intent(in) :: omega  !! speed of its wheel [rad/s]
      real(wp), intent(out) :: torque, damping !! [N m], [N m s]
      class(load_t), allocatable :: still
      real(wp) :: stiffness

      if (abs(load%swing) > 0) then
         allocate (still, source=load)
         still%swing = 0
         call still%ask(load_point(t=t, omega=omega, segment=segment), torque, damping, stiffness)
      else
         call load%ask(load_point(t=t, omega=omega, segment=segment), torque, damping, stiffness)
      end if
   end subroutine mean_torque

   !> Torque transmitted through the train at a speed of the reference wheel, referred to it [N m]: half of the sum of all
   !> magnitudes, including that of a prescribed speed or of the inertia. 0 if it is rounding error of the torques at zero speed.
   pure real(wp) function torque_through(gearbox, now, speed) result(torque)
      type(gearbox_t), intent(in) :: gearbox
      type(instant_t), intent(in) :: now
      real(wp), intent(in) :: speed !! [rad/s]
      real(wp) :: remainder, damping, gross, gross_static

      call sum_torques(gearbox, now, 0.0_wp, remainder, damping, gross_static)
      call sum_torques(gearbox, now, speed, remainder, damping, gross)
      torque = 0
      if (gross > nothing*gross_static) torque = (gross + abs(remainder))/2
   end function torque_through

   !> Sum of the torques at the operating points given for loads, referred to the reference wheel [N m].
   pure real(wp) function rated_torque(gearbox) result(torque)
      type(gearbox_t), intent(in) :: gearbox
      integer :: i

      torque = sum([(abs(gearbox%wheels(gearbox%loads(i)%load%wheel)%ratio*gearbox%loads(i)%load%rated), i=1, size(gearbox%loads))])
   end function rated_torque

   !> Acceleration of the reference wheel at given wheel speeds: the prescribed one, or that due to the loads [rad/s^2].
   !> Equation T80.
   pure real(wp) function acceleration_at(gearbox, now, speeds) result(acceleration)
      type(gearbox_t), intent(in) :: gearbox
      type(instant_t), intent(in) :: now
      real(wp), intent(in) :: speeds(:) !! [rad/s]
      real(wp) :: torque, gross, mine, damping
      integer :: i

      associate (driver => gearbox%wheels(gearbox%reference)%prescribed)
         if (driver > 0) then ! on the reference wheel's rotor, whose ratio is 1
            acceleration = gearbox%loads(driver)%load%acceleration(now%segments(driver))
            return
         end if
      end associate
      torque = 0
      gross = 0
      do i = 1, size(gearbox%loads)
         associate (wheel => gearbox%loads(i)%load%wheel)
            call mean_torque(gearbox%loads(i)%load, now%t, now%segments(i), speeds(wheel), mine, damping)
            torque = torque + gearbox%wheels(wheel)%ratio*mine
            gross = gross + abs(gearbox%wheels(wheel)%ratio*mine)
         end associate
      end do
      acceleration = 0
      if (abs(torque) > rounding*gross) acceleration = torque/train_inertia(gearbox)
   end function acceleration_at

   !> Inertia of all wheels, referred to the reference wheel [kg m^2]. Equation T80.
   pure real(wp) function train_inertia(gearbox) result(inertia)
      type(gearbox_t), intent(in) :: gearbox

      inertia = sum(gearbox%wheels%inertia*gearbox%wheels%ratio**2)
   end function train_inertia

   !> Load of each mesh [N] and shaft [N m] at one instant.
   subroutine transmitted_loads(gearbox, train, now, speeds, acceleration, transmitted)
      type(gearbox_t), intent(in) :: gearbox
      type(train_t), intent(in) :: train
      type(instant_t), intent(in) :: now
      real(wp), intent(in) :: speeds(:)     !! of the wheels [rad/s]
      real(wp), intent(in) :: acceleration  !! of the reference wheel [rad/s^2]
      real(wp), intent(out) :: transmitted(:)
      real(wp) :: torque(size(gearbox%wheels) + 1), mine, damping, gross, gross_static
      integer :: i

      torque = 0
      gross = 0
      do i = 1, size(gearbox%loads)
         associate (wheel => gearbox%wheels(gearbox%loads(i)%load%wheel), omega => speeds(gearbox%loads(i)%load%wheel))
            call mean_torque(gearbox%loads(i)%load, now%t, now%segments(i), omega, mine, damping)
            torque(wheel%leader) = torque(wheel%leader) + mine
            gross = gross + abs(mine*wheel%ratio)
         end associate
      end do
      call sum_torques(gearbox, now, 0.0_wp, mine, damping, gross_static)
      gross = max(gross, gross_static)
      call carry(gearbox, train, torque, acceleration, gross, transmitted)
   end subroutine transmitted_loads

   !> The same from the torques on the rotors, which are overwritten.
   subroutine carry(gearbox, train, torque, acceleration, gross, transmitted)
      type(gearbox_t), intent(in) :: gearbox
      type(train_t), intent(in) :: train
      real(wp), intent(inout) :: torque(:)  !! on the leading wheel of each rotor [N m]
      real(wp), intent(in) :: acceleration  !! of the reference wheel [rad/s^2]
      real(wp), intent(in) :: gross         !! sum of magnitudes of all torques, referred to the reference wheel [N m]
      real(wp), intent(out) :: transmitted(:)
      real(wp) :: all(size(train%ends, 2)), total
      integer :: i

      total = gross
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            torque(wheel%leader) = torque(wheel%leader) - wheel%inertia*wheel%ratio*acceleration
            total = total + abs(wheel%inertia*wheel%ratio**2*acceleration)
         end associate
      end do
      call train_carries(train, torque, all)
      transmitted = all(:size(transmitted))
      where (abs(transmitted)*advances(train, gearbox) <= nothing*total) transmitted = 0
   end subroutine carry

   !> Load amplitudes of meshes [N] and shafts [N m] due to all harmonic loads; they add because the phases are unknown.
   subroutine swinging_loads(gearbox, train, transmitted, speed, total)
      type(gearbox_t), intent(in) :: gearbox
      type(train_t), intent(in) :: train
      real(wp), intent(out) :: transmitted(:)
      real(wp), intent(out) :: speed !! of the reference wheel, after one second under the amplitudes [rad/s]
      real(wp), intent(out) :: total !! sum of the amplitudes, referred to the reference wheel [N m]
      real(wp) :: torque(size(gearbox%wheels) + 1), there(size(transmitted)), acceleration
      integer :: i

      transmitted = 0
      speed = 0
      total = 0
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i)%load)
            if (.not. abs(load%swing) > 0) cycle
            associate (wheel => gearbox%wheels(load%wheel))
               torque = 0
               torque(wheel%leader) = abs(load%swing)
               acceleration = 0
               if (.not. prescribes_speed(gearbox)) acceleration = wheel%ratio*abs(load%swing)/train_inertia(gearbox)
               call carry(gearbox, train, torque, acceleration, abs(wheel%ratio*load%swing), there)
               transmitted = transmitted + abs(there)
               speed = speed + abs(acceleration)*spin_up
               total = total + abs(wheel%ratio*load%swing)
            end associate
         end associate
      end do
   end subroutine swinging_loads

   !> Torque at the reference wheel per load of each mesh [m] and shaft [1]; 1 for a rigid shaft.
   pure function advances(train, gearbox) result(advance)
      type(train_t), intent(in) :: train
      type(gearbox_t), intent(in) :: gearbox
      real(wp) :: advance(train%n_meshes + train%n_shafts)
      integer :: i

      advance = 1
      do i = 1, size(advance)
         if (abs(train%arms(1, i)) > 0) advance(i) = abs(train%arms(1, i)*gearbox%wheels(train%ends(1, i))%ratio)
      end do
   end function advances

end module evl_nominal_point
