!> Normal elastic force between two cylinders after Radzimovsky, per unit width.
!>
!>    h = N/(pi E*) [2/3 + ln(4 rho_A/w) + ln(4 rho_B/w)],   w = 2 sqrt(4 N rho_A rho_B/(pi E* (rho_A + rho_B)))
!>
!> w is the full width of the contact strip after Hertz. With it 16 rho_A rho_B/w**2 = pi E* (rho_A + rho_B)/N: the radii
!> enter through their sum alone, as in Johnson's equation (13) but with another constant,
!>
!>    h = N/(pi E*) [ln(4 pi E* (rho_A + rho_B)/N) + 2/3 - ln 4],   2/3 - ln 4 = -0.72 instead of -1.
!>
!> The force is thus Johnson's for a sum of radii exp(5/3)/4 = 1.32 times as large, and all other results follow from that.
!> (With the half width instead of w the constant would be 2/3; the full width is the one used here.)
!>
!> Source: E. I. Radzimovsky, Stress distribution and strength condition of two rolling cylinders pressed together,
!> University of Illinois Engineering Experiment Station Bulletin 408, 1953.
module evl_radzimovsky
   use evl_contact_context, only: contact_context
   use evl_johnson, only: johnson_penetration_limit, johnson_t
   use evl_kinds, only: wp
   use evl_row, only: kind_t
   use evl_status, only: quantity
   implicit none (type, external)
   private

   public :: radzimovsky_t

   real(wp), parameter :: enlarged = 1.323622512617507341706843001049_wp !! exp(5/3)/4

   !> Valid: |h| < exp(-1/3) rho_sum, |N| < exp(-1/3) pi E* rho_sum, rho_sum > 0
   type, extends(johnson_t) :: radzimovsky_t
   contains
      procedure :: describe
      procedure :: limit_message
   end type radzimovsky_t

   interface radzimovsky_t
      module procedure johnson_of_larger_radii
   end interface radzimovsky_t

contains

   !> Create the law. Equations L2, L3.
   pure type(radzimovsky_t) function johnson_of_larger_radii() result(law)
      law%radii_factor = enlarged
   end function johnson_of_larger_radii

   !> Name and source.
   pure subroutine describe(self, info)
      class(radzimovsky_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "radzimovsky"
      info%text = "two elastic cylinders, with the full width of the contact strip after Hertz"
      info%source = "Radzimovsky 1953, University of Illinois Bulletin 408"
   end subroutine describe

   !> Reason why there is no force.
   pure subroutine limit_message(self, ctx, message)
      class(radzimovsky_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      character(len=*), intent(out) :: message

      if (.not. ctx%rho_a + ctx%rho_b > 0.0_wp) then
         message = "rho_A + rho_B = "//quantity(ctx%rho_a + ctx%rho_b, "m")//" is not positive, as the Radzimovsky force needs"
      else
         message = "penetration h = "//quantity(ctx%h, "m")//" exceeds the limit e^(-1/3) (rho_A + rho_B) = " &
                   //quantity(johnson_penetration_limit(enlarged*(ctx%rho_a + ctx%rho_b)), "m")//" of the Radzimovsky force"
      end if
   end subroutine limit_message

end module evl_radzimovsky
