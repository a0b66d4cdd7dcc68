!> What carries an axle. The equations know its degrees of freedom: how far the centre deviates from its reference position.
!>
!> Which there are is said by its kind, which extends support_kind_t in a file of its own and has a line in evl_support_kinds.
module evl_support
   use evl_kinds, only: wp
   use evl_parameter, only: given_numbers, kind_info_t
   implicit none (type, external)
   private

   public :: support_input, support_kind_t, support_t

   !> What carries an axle: up to two directions, each with spring and damper.
   type :: support_t
      integer :: n = 0                       !! degrees of freedom
      real(wp) :: direction(2, 2) = 0.0_wp   !! column j: unit vector of degree of freedom j in the housing frame
      real(wp) :: mass = 0.0_wp              !! that moves: wheel and support [kg]
      real(wp) :: per_mass = 0.0_wp          !! its inverse
      real(wp) :: stiffness(2) = 0.0_wp      !! [N/m]
      real(wp) :: damping(2) = 0.0_wp        !! [N s/m]
      integer :: i_state(2) = 0              !! index of s_j in the state; s_j' follows
   end type support_t

   !> A support as described.
   type, extends(given_numbers) :: support_input
      integer :: kind = 0 !! index in the table of kinds, from 0
   end type support_input

   type, abstract :: support_kind_t
   contains
      procedure(describe_kind), deferred, nopass :: describe
      procedure(take_numbers), deferred, nopass :: take
   end type support_kind_t

   abstract interface

      !> Name, text and rows of the kind.
      pure type(kind_info_t) function describe_kind()
         import :: kind_info_t
         implicit none (type, external)
      end function describe_kind

      !> Degrees of freedom with their springs and dampers, and the mass that moves beside the wheel's, from parameters that are
      !> in their ranges.
      subroutine take_numbers(given, support)
         import :: support_input, support_t
         implicit none (type, external)
         type(support_input), intent(in) :: given
         type(support_t), intent(inout) :: support !! without degrees of freedom, its mass that of the wheel
      end subroutine take_numbers

   end interface

end module evl_support
