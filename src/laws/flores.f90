!> Impact damping with chi = 8 (1 - e)/(5 e).
!>
!> Source: P. Flores, M. Machado, M. T. Silva, J. M. Martins, On the continuous contact force models for soft materials in multibody
!> dynamics, Multibody Syst. Dyn. 25 (2011) 357.
module evl_flores
   use evl_impact_damping, only: describe_impact, impact_damping_t
   use evl_kinds, only: wp
   use evl_row, only: kind_t
   implicit none (type, external)
   private

   public :: flores_t

   type, extends(impact_damping_t) :: flores_t
   contains
      procedure, nopass :: describe
      procedure, nopass :: chi
   end type flores_t

contains

   !> Name, source and parameters.
   pure subroutine describe(info)
      type(kind_t), intent(inout) :: info

      call describe_impact("flores", "8 (1 - e)/(5 e)", "Flores et al. 2011, Multibody Syst. Dyn. 25, 357", .true., info)
   end subroutine describe

   !> The factor.   Valid: 0 < e <= 1
   pure real(wp) function chi(e)
      real(wp), intent(in) :: e !! nominal coefficient of restitution

      chi = 1.6_wp*(1.0_wp - e)/e
   end function chi

end module evl_flores
