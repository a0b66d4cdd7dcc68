!> Impact damping with chi = (1 - e**2)/e.
!>
!> Source: Y. Gonthier, J. McPhee, C. Lange, J.-C. Piedboeuf, A regularized contact model with asymmetric damping and
!> dwell-time dependent friction, Multibody Syst. Dyn. 11 (2004) 209.
module evl_gonthier
   use evl_impact_damping, only: describe_impact, impact_damping_t
   use evl_kinds, only: wp
   use evl_row, only: kind_t
   implicit none (type, external)
   private

   public :: gonthier_t

   type, extends(impact_damping_t) :: gonthier_t
   contains
      procedure, nopass :: describe
      procedure, nopass :: chi
   end type gonthier_t

contains

   !> Name, source and parameters.
   pure subroutine describe(info)
      type(kind_t), intent(inout) :: info

      call describe_impact("gonthier", "(1 - e^2)/e", "Gonthier et al. 2004, Multibody Syst. Dyn. 11, 209", .true., info)
   end subroutine describe

   !> The factor.   Valid: 0 < e <= 1
   pure real(wp) function chi(e)
      real(wp), intent(in) :: e !! nominal coefficient of restitution

      chi = (1.0_wp - e)*(1.0_wp + e)/e
   end function chi

end module evl_gonthier
