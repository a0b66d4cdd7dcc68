!> Support of an axle: the reference motion of its centre, and its deviation from that. The deviation's components are states;
!> meshes use no other data of an axle.
!>
!> The kind of support determines these. It extends support_kind_t in a file of its own and has a line in evl_support_kinds.
module evl_support
   use evl_kind_finder, only: described_t
   use evl_kinds, only: wp
   use evl_parameter_view, only: parameter_view_t
   implicit none (type, external)
   private

   public :: axle_deviation, axle_motion, support_kind_t, support_t

   !> A motion of an axle in the housing frame.
   type :: axle_motion
      real(wp) :: centre(2)                 !! [m]
      real(wp) :: velocity(2) = 0.0_wp      !! [m/s]
      real(wp) :: acceleration(2) = 0.0_wp  !! [m/s^2]
   end type axle_motion

   !> Support of an axle: up to two directions, each with spring and damper.
   type :: support_t
      integer :: n = 0                       !! degrees of freedom
      real(wp) :: direction(2, 2) = 0.0_wp   !! column j: unit vector of degree of freedom j in the housing frame
      real(wp) :: mass = 0.0_wp              !! moving mass: wheel and support [kg]
      real(wp) :: per_mass = 0.0_wp          !! its inverse
      real(wp) :: stiffness(2) = 0.0_wp      !! [N/m]
      real(wp) :: damping(2) = 0.0_wp        !! [N s/m]
      integer :: i_state(2) = 0              !! index of s_j in the state; s_j' follows
      logical :: moves = .false.             !! whether its reference point moves
      class(support_kind_t), allocatable :: kind
   end type support_t

   type, abstract, extends(described_t) :: support_kind_t
   contains
      procedure(take_numbers), deferred :: take
      procedure :: reference => at_rest
   end type support_kind_t

   abstract interface

      !> Set the degrees of freedom with their springs and dampers, and the mass that moves in addition to the wheel's, from
      !> parameters in their ranges.
      subroutine take_numbers(self, input, support)
         import :: parameter_view_t, support_kind_t, support_t
         implicit none (type, external)
         class(support_kind_t), intent(inout) :: self !! stores the data of its reference motion
         type(parameter_view_t), intent(in) :: input
         type(support_t), intent(inout) :: support    !! in: no degrees of freedom, the mass of the wheel
      end subroutine take_numbers

   end interface

contains

   !> Reference motion of the centre, to which its deviation refers. A kind with a moving reference sets `moves`.
   pure type(axle_motion) function at_rest(self, centre, t) result(motion)
      class(support_kind_t), intent(in) :: self
      real(wp), intent(in) :: centre(2) !! of the wheel in the layout of the train [m]
      real(wp), intent(in) :: t         !! [s]

      motion = axle_motion(centre)
   end function at_rest

   !> Deviation of the centre from its reference motion [m], or the rate of that [m/s].
   pure function axle_deviation(support, y, order) result(u)
      type(support_t), intent(in) :: support
      real(wp), intent(in) :: y(*) !! state, a change of it, or its rates
      integer, intent(in) :: order !! 0: itself, 1: its rate
      real(wp) :: u(2)
      integer :: j

      u = 0
      do j = 1, support%n
         u(1) = u(1) + y(support%i_state(j) + order)*support%direction(1, j)
         u(2) = u(2) + y(support%i_state(j) + order)*support%direction(2, j)
      end do
   end function axle_deviation

end module evl_support
