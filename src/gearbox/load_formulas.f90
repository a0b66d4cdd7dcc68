!> Formulas that state the torque of one load twice, compared with each other: a run fails where they differ.
!>
!> `ask` gives the torque at one state. `add_in_lanes` gives that of eight states, and `spin_torque` what a change of the speed
!> adds. Radau integrates the second, IDA the first, a moving housing the third.
module evl_load_formulas
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: lanes, wp
   use evl_load, only: lane_points, load_point, load_t
   use evl_wheel_loads, only: load_point_of
   implicit none (type, external)
   private

   public :: load_conflict, find_load_conflict
   public :: formula_in_lanes, formula_of_spin

   integer, parameter :: formula_in_lanes = 1, formula_of_spin = 2

   !> Two formulas of a load that differ.
   type :: load_conflict
      integer :: wheel = 0                      !! index of the wheel of the load; 0: no load has such formulas
      integer :: formula = 0                    !! which formula differs from `ask`
      real(wp) :: omega = 0.0_wp                !! speed of the wheel [rad/s]
      real(wp) :: here = 0.0_wp, other = 0.0_wp !! torque by `ask`, and by the other formula [N m]
   end type load_conflict

contains

   !> The first load whose formulas differ by more than a part of its largest torque, at the speed and the angle of a state and at
   !> seven others near it.
   pure subroutine find_load_conflict(gearbox, t, y, integers, part, conflict)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t                    !! [s]
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: part                 !! such as 1e-8
      type(load_conflict), intent(out) :: conflict
      integer :: i

      do i = 1, size(gearbox%loads)
         call compare_load(gearbox%loads(i)%load, load_point_of(gearbox, i, t, y, integers), part, conflict)
         if (conflict%formula == 0) cycle
         conflict%wheel = gearbox%loads(i)%load%wheel
         return
      end do
   end subroutine find_load_conflict

   !> One load.
   pure subroutine compare_load(load, at, part, conflict)
      class(load_t), intent(in) :: load
      type(load_point), intent(in) :: at
      real(wp), intent(in) :: part
      type(load_conflict), intent(inout) :: conflict
      real(wp), parameter :: angle_step = 0.3_wp, speed_step = 0.15_wp ! no speed of the eight is 0, or the opposite of another
      type(lane_points) :: points
      type(load_point) :: point
      real(wp) :: in_lanes(lanes), alone(lanes), spun, damping, stiffness, bound
      integer :: l

      points%t = at%t
      points%revolutions = at%revolutions
      points%segment = at%segment
      point = at
      do l = 1, lanes
         points%omega(l) = at%omega + (l - 1)*speed_step*(1 + abs(at%omega))
         points%angle(l) = at%angle + (l - 1)*angle_step
         point%omega = points%omega(l)
         point%angle = points%angle(l)
         call load%ask(point, alone(l), damping, stiffness)
      end do
      bound = part*maxval(abs(alone))
      in_lanes = 0
      call load%add_in_lanes(points, in_lanes)
      do l = 1, lanes
         if (abs(in_lanes(l) - alone(l)) <= bound) cycle
         conflict = load_conflict(0, formula_in_lanes, points%omega(l), alone(l), in_lanes(l))
         return
      end do
      point = at
      do l = 2, lanes
         point%angle = points%angle(l)
         call load%ask(point, alone(1), damping, stiffness)
         spun = alone(1) + load%spin_torque(point, points%omega(l) - at%omega)
         if (abs(spun - alone(l)) <= bound) cycle
         conflict = load_conflict(0, formula_of_spin, points%omega(l), alone(l), spun)
         return
      end do
   end subroutine compare_load

end module evl_load_formulas
