!> Impact damping with chi = 3/4 (1 - e**2).
!>
!> Source: H. M. Lankarani, P. E. Nikravesh, A contact force model with hysteresis damping for impact analysis of multibody
!> systems, J. Mech. Des. 112 (1990) 369.
module evl_lankarani_nikravesh
   use evl_impact_damping, only: describe_impact, impact_damping_t
   use evl_kinds, only: wp
   use evl_row, only: kind_t
   implicit none (type, external)
   private

   public :: lankarani_nikravesh_t

   type, extends(impact_damping_t) :: lankarani_nikravesh_t
   contains
      procedure, nopass :: describe
      procedure, nopass :: chi
   end type lankarani_nikravesh_t

contains

   !> Name, source and parameters.
   pure subroutine describe(info)
      type(kind_t), intent(inout) :: info

      call describe_impact("lankarani_nikravesh", "0.75 (1 - e^2)", "Lankarani & Nikravesh 1990, J. Mech. Des. 112, 369", .false., &
                           info)
   end subroutine describe

   !> The factor.   Valid: 0 <= e <= 1
   pure real(wp) function chi(e)
      real(wp), intent(in) :: e !! nominal coefficient of restitution

      chi = 0.75_wp*(1.0_wp - e)*(1.0_wp + e)
   end function chi

end module evl_lankarani_nikravesh
