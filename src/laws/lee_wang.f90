!> Impact damping with chi = 3/4 (1 - e).
!>
!> Source: T. W. Lee, A. C. Wang, On the dynamics of intermittent-motion mechanisms, J. Mech. Transm. Autom. Des. 105
!> (1983) 534.
module evl_lee_wang
   use evl_impact_damping, only: describe_impact, impact_damping_t
   use evl_kinds, only: wp
   use evl_row, only: kind_t
   implicit none (type, external)
   private

   public :: lee_wang_t

   type, extends(impact_damping_t) :: lee_wang_t
   contains
      procedure, nopass :: describe
      procedure, nopass :: chi
   end type lee_wang_t

contains

   !> Name, source and parameters.
   pure subroutine describe(info)
      type(kind_t), intent(inout) :: info

      call describe_impact("lee_wang", "0.75 (1 - e)", "Lee & Wang 1983, J. Mech. Transm. Autom. Des. 105, 534", .false., info)
   end subroutine describe

   !> The factor.   Valid: 0 <= e <= 1
   pure real(wp) function chi(e)
      real(wp), intent(in) :: e !! nominal coefficient of restitution

      chi = 0.75_wp*(1.0_wp - e)
   end function chi

end module evl_lee_wang
