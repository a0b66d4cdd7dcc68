!> Housing: its motion, its effect on the accelerations of bodies in it, and the forces on it from the ground.
!>
!> Source: docs/theory/housing.md, which derives every equation. Components are those of the housing frame unless the ground
!> is named.
module evl_housing
   use evl_accelerometer, only: accelerometer_t
   use evl_housing_motion, only: motion_at, motion_curve, motion_term
   use evl_kinds, only: wp
   use evl_rotation, only: cross, identity, quaternion_product, rotation_matrix, turned, turned_back
   implicit none (type, external)
   private

   public :: housing_t, frame_t, n_housing_states
   public :: housing_fixed, housing_prescribed, housing_mounted
   public :: at_position, at_orientation, at_velocity, at_omega
   public :: apparent_acceleration, felt_acceleration, frame_acceleration, housing_frame, norm_rate, wheel_moment
   public :: mount_force, mount_loss, mount_turn
   public :: mount_deflection, housing_rates, housing_renormalise, housing_turn_columns, housing_take_turn, is_balance, &
             small_turns

   integer, parameter :: housing_fixed = 0      !! fixed to the ground, with its frame
   integer, parameter :: housing_prescribed = 1 !! prescribed motion
   integer, parameter :: housing_mounted = 2    !! a rigid body on a mount

   integer, parameter :: n_housing_states = 13 !! of a mounted housing, at housing%i_state + these offsets:
   integer, parameter :: at_position = 0       !! r, ground [m]
   integer, parameter :: at_orientation = 3    !! p
   integer, parameter :: at_velocity = 7       !! v, ground [m/s]
   integer, parameter :: at_omega = 10         !! Omega [rad/s]

   real(wp), parameter :: norm_rate = 1.0e4_wp !! nu: rate at which the quaternion returns to norm 1 [1/s]

   type :: housing_t
      integer :: kind = housing_fixed
      logical :: acts = .false.                 !! it moves, or there is gravity, or supports move in it: this affects bodies in it
      logical :: is_mounted = .false.
      real(wp) :: gravity(3) = 0.0_wp           !! ground [m/s^2]
      type(motion_term), allocatable :: motion(:) !! prescribed
      type(accelerometer_t), allocatable :: accelerometers(:)
      integer :: i_state = 0                    !! index of r in the state, if mounted
      real(wp) :: mass = 0.0_wp                 !! [kg]
      real(wp) :: centre(3) = 0.0_wp            !! centre of mass [m]
      real(wp) :: inertia(3, 3) = 0.0_wp        !! about the centre of mass [kg m^2]
      real(wp) :: mount_point(3) = 0.0_wp       !! P [m]
      real(wp) :: stiffness(3) = 0.0_wp, damping(3) = 0.0_wp           !! ground axes [N/m], [N s/m]
      real(wp) :: turn_stiffness(3) = 0.0_wp, turn_damping(3) = 0.0_wp !! [N m/rad], [N m s/rad]
      real(wp) :: force(3) = 0.0_wp, moment(3) = 0.0_wp !! external, ground axes; the force at the centre of mass [N], [N m]
      real(wp) :: position(3) = 0.0_wp, orientation(4) = [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp] !! at the start
      real(wp) :: velocity(3) = 0.0_wp, omega(3) = 0.0_wp                                 !! at the start
   end type housing_t

   !> The housing frame at one time.
   type, extends(motion_curve) :: frame_t
      real(wp) :: t = 0.0_wp                !! [s]
      real(wp) :: rotation(3, 3)            !! R
      real(wp) :: acceleration(3)           !! a = R^T (v' - g) [m/s^2]
   end type frame_t

contains

   !> Housing frame at time t or, if mounted, at a state with its rates; v' and Omega' are 0 if no rates are given.
   pure subroutine housing_frame(housing, t, y, frame, yp)
      type(housing_t), intent(in) :: housing
      real(wp), intent(in) :: t, y(*)
      type(frame_t), intent(out) :: frame
      real(wp), intent(in), optional :: yp(:)
      real(wp) :: velocity_rate(3)

      frame%t = t
      velocity_rate = 0
      select case (housing%kind)
      case (housing_mounted)
         associate (i => housing%i_state)
            frame%position = y(i + at_position:i + at_position + 2)
            frame%orientation = y(i + at_orientation:i + at_orientation + 3)
            frame%velocity = y(i + at_velocity:i + at_velocity + 2)
            frame%omega = y(i + at_omega:i + at_omega + 2)
            frame%alpha = 0
            if (present(yp)) then
               velocity_rate = yp(i + at_velocity:i + at_velocity + 2)
               frame%alpha = yp(i + at_omega:i + at_omega + 2)
            end if
         end associate
      case (housing_prescribed)
         call motion_at(housing%motion, t, frame%motion_curve, velocity_rate)
      case default
         frame = frame_t(t=t, position=0.0_wp, velocity=0.0_wp, orientation=[1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], rotation=identity, &
                         omega=0.0_wp, alpha=0.0_wp, acceleration=-housing%gravity)
         return
      end select
      frame%rotation = rotation_matrix(frame%orientation)
      frame%acceleration = turned_back(frame%rotation, velocity_rate - housing%gravity)
   end subroutine housing_frame

   !> Whether a state's equation is one of the two balances of a mounted housing, in newtons and newton metres, instead of y'
   !> - f.
   pure logical function is_balance(housing, state)
      type(housing_t), intent(in) :: housing
      integer, intent(in) :: state

      is_balance = housing%is_mounted .and. state >= housing%i_state + at_velocity .and. state < housing%i_state + n_housing_states
   end function is_balance

   !> Acceleration minus gravity of a point fixed to the housing [m/s^2]. Equation H2.
   pure function frame_acceleration(frame, c) result(b)
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: c(3) !! the point [m]
      real(wp) :: b(3)

      b = frame%acceleration + cross(frame%alpha, c) + cross(frame%omega, cross(frame%omega, c))
   end function frame_acceleration

   !> Acceleration that an accelerometer records along its direction: relative to the ground, without gravity [m/s^2]. Equation H12.
   pure real(wp) function felt_acceleration(housing, frame, accelerometer) result(acceleration)
      type(housing_t), intent(in) :: housing
      type(frame_t), intent(in) :: frame
      type(accelerometer_t), intent(in) :: accelerometer

      acceleration = dot_product(accelerometer%direction, frame_acceleration(frame, accelerometer%point) &
                                 + turned_back(frame%rotation, housing%gravity))
   end function felt_acceleration

   !> `frame_acceleration` of a point that moves in the housing, without its relative acceleration [m/s^2]. Equation H2.
   pure function apparent_acceleration(frame, c, rate) result(b)
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: c(3), rate(3) !! the point [m], its relative velocity [m/s]
      real(wp) :: b(3)

      b = frame_acceleration(frame, c) + 2*cross(frame%omega, rate)
   end function apparent_acceleration

   !> H' + Omega x H: the moment about its centre that a wheel requires [N m]. Equation H4.
   pure function wheel_moment(frame, inertia, transverse_inertia, speed, acceleration) result(moment)
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: inertia, transverse_inertia !! about the axle, about a diameter [kg m^2]
      real(wp), intent(in) :: speed, acceleration         !! phi', phi'' [rad/s], [rad/s^2]
      real(wp) :: moment(3), spin

      associate (o => frame%omega)
         spin = inertia*(o(3) + speed) - transverse_inertia*o(3)
         moment = [transverse_inertia*frame%alpha(1) + o(2)*spin, transverse_inertia*frame%alpha(2) - o(1)*spin, &
                   inertia*(frame%alpha(3) + acceleration)]
      end associate
   end function wheel_moment

   !> Force of the mount, with the velocity of the point where it acts, both in ground axes [N], [m/s]. Equation H10.
   pure subroutine mount_force(housing, frame, force, velocity)
      type(housing_t), intent(in) :: housing
      type(frame_t), intent(in) :: frame
      real(wp), intent(out) :: force(3), velocity(3)

      velocity = frame%velocity + turned(frame%rotation, cross(frame%omega, housing%mount_point))
      force = -housing%stiffness*mount_deflection(housing, frame) - housing%damping*velocity
   end subroutine mount_force

   !> d = r + R P - P [m]. Equation H10.
   pure function mount_deflection(housing, frame) result(d)
      type(housing_t), intent(in) :: housing
      type(frame_t), intent(in) :: frame
      real(wp) :: d(3)

      d = frame%position + (turned(frame%rotation, housing%mount_point) - housing%mount_point)
   end function mount_deflection

   !> Moment of the mount's torsional springs and dampers [N m]. Equation H11.
   pure function mount_turn(housing, frame) result(moment)
      type(housing_t), intent(in) :: housing
      type(frame_t), intent(in) :: frame
      real(wp) :: moment(3)

      associate (p_0 => frame%orientation(1), q => frame%orientation(2:4))
         moment = -2*(p_0*housing%turn_stiffness*q + cross(housing%turn_stiffness*q, q)) - housing%turn_damping*frame%omega
      end associate
   end function mount_turn

   !> Power dissipated by the mount's dampers [W].
   pure real(wp) function mount_loss(housing, frame, velocity) result(power)
      type(housing_t), intent(in) :: housing
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: velocity(3) !! from `mount_force` [m/s]

      power = dot_product(housing%damping, velocity**2) + dot_product(housing%turn_damping, frame%omega**2)
   end function mount_loss

   !> Contribution of a mounted housing to the rates: r', p', and, at the indices of v' and Omega', the force and the moment
   !> about the origin from the ground, added to those of the loads; also the power dissipated and the power of external forces.
   !> Equations H1, H8, H9.
   pure subroutine housing_rates(housing, frame, f, dissipation, power)
      type(housing_t), intent(in) :: housing
      type(frame_t), intent(in) :: frame
      real(wp), intent(inout) :: f(*)             !! rates of the whole system; forces are added
      real(wp), intent(out) :: dissipation, power !! [W]
      real(wp) :: mount(3), velocity(3), force(3), moment(3)

      call mount_force(housing, frame, mount, velocity)
      force = turned_back(frame%rotation, housing%force)
      moment = turned_back(frame%rotation, housing%moment)
      dissipation = mount_loss(housing, frame, velocity)
      power = dot_product(housing%force, frame%velocity) + dot_product(force, cross(frame%omega, housing%centre)) &
              + dot_product(moment, frame%omega)
      mount = turned_back(frame%rotation, mount)
      associate (i => housing%i_state, p => frame%orientation)
         f(i + at_position:i + at_position + 2) = frame%velocity
         f(i + at_orientation:i + at_orientation + 3) = quaternion_product(p, [0.0_wp, frame%omega])/2 &
                                                        + norm_rate*(1 - dot_product(p, p))*p
         associate (linear => f(i + at_velocity:i + at_velocity + 2), angular => f(i + at_omega:i + at_omega + 2))
            linear = linear + mount + force
            angular = angular + cross(housing%mount_point, mount) + mount_turn(housing, frame) &
                      + cross(housing%centre, force) + moment
         end associate
      end associate
   end subroutine housing_rates

   !> Reset the quaternion to norm 1.
   pure subroutine housing_renormalise(housing, y)
      type(housing_t), intent(in) :: housing
      real(wp), intent(inout) :: y(*)

      if (.not. housing%is_mounted) return
      associate (p => y(housing%i_state + at_orientation:housing%i_state + at_orientation + 3))
         p = p/norm2(p)
      end associate
   end subroutine housing_renormalise

   !> Derivative of the orientation by small rotations about the housing's own axes.
   pure function small_turns(orientation) result(gradient)
      real(wp), intent(in) :: orientation(4)
      real(wp) :: gradient(4, 3), turn(4)
      integer :: j

      do j = 1, 3
         turn = 0
         turn(1 + j) = 0.5_wp
         gradient(:, j) = quaternion_product(orientation, turn)
      end do
   end function small_turns

   !> Store the derivatives by a small rotation of the housing, about its own axes, in the columns of Omega.
   pure subroutine housing_turn_columns(housing, y, jacobian)
      type(housing_t), intent(in) :: housing
      real(wp), intent(in) :: y(*)
      real(wp), intent(inout) :: jacobian(:, :)
      real(wp) :: turns(4, 3)

      associate (p => housing%i_state + at_orientation, o => housing%i_state + at_omega)
         turns = small_turns(y(p:p + 3))
         jacobian(:, o:o + 2) = matmul(jacobian(:, p:p + 3), turns)
      end associate
   end subroutine housing_turn_columns

   !> Rotate the housing by the angles stored at the indices of Omega, and set these to 0.
   pure subroutine housing_take_turn(housing, y)
      type(housing_t), intent(in) :: housing
      real(wp), intent(inout) :: y(*)

      associate (p => housing%i_state + at_orientation, o => housing%i_state + at_omega)
         y(p:p + 3) = quaternion_product(y(p:p + 3), [1.0_wp, y(o:o + 2)/2])
         y(o:o + 2) = 0
      end associate
      call housing_renormalise(housing, y)
   end subroutine housing_take_turn

end module evl_housing
