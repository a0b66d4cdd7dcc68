!> Mean coefficient of friction of an operating point with a roughness factor:
!>
!>    mu = 0.045 (F_bt/b/(v_SigmaC rho_redC))^0.2 eta^-0.05 X_R    X_R = 3.8 (Ra/d_1)^0.25    N/mm, m/s, mm, mPa s, um
!>
!> No public source was found for 0.045 together with X_R: the law has no standard's name.
module evl_mean_roughness
   use evl_friction_law, only: regularisation
   use evl_kinds, only: wp
   use evl_operating_friction, only: load_term, operating_friction_t, operating_point, viscosity_term
   use evl_row, only: kind_t, parameter_row, positive, span_t
   implicit none (type, external)
   private

   public :: mean_roughness_t

   type, extends(operating_friction_t) :: mean_roughness_t
   contains
      procedure :: describe
      procedure :: coefficient
   end type mean_roughness_t

contains

   !> Name, source and parameters.
   pure subroutine describe(self, info)
      class(mean_roughness_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "mean_roughness"
      info%text = "Coulomb's law with the mean coefficient of the nominal operating point by a roughness factor; needs a lubricant"
      info%source = "from memory; no public source was found for its constants"
      info%rows = [parameter_row("lubricant_factor", "", "factor of the lubricant, 1 for mineral oil", range=positive, &
                                 default="1", &
                                 plausible=span_t(0.1_wp, 2.0_wp)), &
                   regularisation("sliding velocity at which friction is fully developed")]
   end subroutine describe

   !> Equation L23.
   pure real(wp) function coefficient(self, at) result(mu)
      class(mean_roughness_t), intent(in) :: self
      type(operating_point), intent(in) :: at
      real(wp) :: roughness_factor

      roughness_factor = 3.8_wp*(self%lubricant%roughness*1.0e6_wp/(at%diameter*1.0e3_wp))**0.25_wp
      mu = 0.045_wp*load_term(at)*viscosity_term(self%lubricant)*roughness_factor*self%parameters(1)
   end function coefficient

end module evl_mean_roughness
