!> The first law of its kind, for small 1 - e: chi = 3/2 (1 - e).
!>
!> Source: K. H. Hunt, F. R. E. Crossley, Coefficient of restitution interpreted as damping in vibroimpact, J. Appl. Mech.
!> 42 (1975) 440.
module evl_hunt_crossley
   use evl_impact_damping, only: describe_impact, impact_damping_t
   use evl_kinds, only: wp
   use evl_row, only: kind_t
   implicit none (type, external)
   private

   public :: hunt_crossley_t

   type, extends(impact_damping_t) :: hunt_crossley_t
   contains
      procedure, nopass :: describe
      procedure, nopass :: chi
   end type hunt_crossley_t

contains

   !> Name, source and parameters.
   pure subroutine describe(info)
      type(kind_t), intent(inout) :: info

      call describe_impact("hunt_crossley", "1.5 (1 - e)", "Hunt & Crossley 1975, J. Appl. Mech. 42, 440", .false., info)
   end subroutine describe

   !> The factor.   Valid: 0 <= e <= 1
   pure real(wp) function chi(e)
      real(wp), intent(in) :: e !! nominal coefficient of restitution

      chi = 1.5_wp*(1.0_wp - e)
   end function chi

end module evl_hunt_crossley
