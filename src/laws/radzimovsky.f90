!> Normal elastic force between two cylinders after Radzimovsky, per unit width.
!>
!>    h = N/(pi E*) [2/3 + ln(4 rho_A/w) + ln(4 rho_B/w)],   w = 2 sqrt(4 N rho_A rho_B/(pi E* (rho_A + rho_B)))
!>
!> w is the full width of the contact strip after Hertz. With it 16 rho_A rho_B/w**2 = pi E* (rho_A + rho_B)/N: the radii
!> enter through their sum alone, as in Johnson's equation (13) but with another constant,
!>
!>    h = N/(pi E*) [ln(4 pi E* (rho_A + rho_B)/N) + 2/3 - ln 4],   2/3 - ln 4 = -0.72 in place of -1.
!>
!> So the force is Johnson's for a sum of radii exp(5/3)/4 = 1.32 times as large, and everything else follows from that.
!> (With the half width in the place of w the constant would be 2/3; the full width is the one used here.)
!>
!> Source: E. I. Radzimovsky, Stress distribution and strength condition of two rolling cylinders pressed together,
!> University of Illinois Engineering Experiment Station Bulletin 408, 1953.
module evl_radzimovsky
   use evl_johnson, only: johnson_force, johnson_penetration, johnson_penetration_limit
   use evl_kinds, only: wp
   use evl_law_info, only: law_info_t
   use evl_status, only: quantity
   implicit none (type, external)
   private

   public :: enlarged
   public :: radzimovsky_force, radzimovsky_law, radzimovsky_limit_message, radzimovsky_penetration

   real(wp), parameter :: enlarged = 1.323622512617507341706843001049_wp !! exp(5/3)/4

contains

   include "laws/radzimovsky.inc"

   !> Penetration from the force per unit width.   Valid: |N| < exp(-1/3) pi E* rho_sum, rho_sum > 0
   elemental subroutine radzimovsky_penetration(force, rho_sum, e_star, h, code)
      real(wp), intent(in) :: force   !! N [N/m]; the penetration is odd in it
      real(wp), intent(in) :: rho_sum !! sum of the radii of curvature [m], > 0
      real(wp), intent(in) :: e_star  !! effective modulus [Pa], > 0
      real(wp), intent(out) :: h      !! penetration [m]; 0 on error
      integer, intent(out) :: code    !! code_ok or code_out_of_domain

      call johnson_penetration(force, enlarged*rho_sum, e_star, h, code)
   end subroutine radzimovsky_penetration

   !> Why radzimovsky_force refuses h, as one sentence.
   pure subroutine radzimovsky_limit_message(h, rho_sum, message)
      real(wp), intent(in) :: h                 !! penetration [m]
      real(wp), intent(in) :: rho_sum           !! sum of the radii of curvature [m]
      character(len=*), intent(out) :: message  !! truncated to its length

      if (.not. rho_sum > 0.0_wp) then
         message = "rho_A + rho_B = "//quantity(rho_sum, "m")//" is not positive, as the Radzimovsky force needs"
      else
         message = "penetration h = "//quantity(h, "m")//" exceeds the limit e^(-1/3) (rho_A + rho_B) = " &
                   //quantity(johnson_penetration_limit(enlarged*rho_sum), "m")//" of the Radzimovsky force"
      end if
   end subroutine radzimovsky_limit_message

   !> The entry of the law table.
   pure type(law_info_t) function radzimovsky_law() result(info)

      info%name = "radzimovsky"
      info%description = "two elastic cylinders, with the full width of the contact strip after Hertz"
      info%source = "Radzimovsky 1953, University of Illinois Bulletin 408"
   end function radzimovsky_law

end module evl_radzimovsky
