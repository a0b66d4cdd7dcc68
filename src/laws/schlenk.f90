!> Mean coefficient of friction of an operating point by Schlenk:
!>
!>    mu = 0.048 (F_bt/b/(v_SigmaC rho_redC))^0.2 eta^-0.05 Ra^0.25 X_L    N/mm, m/s, mm, mPa s, um
module evl_schlenk
   use evl_friction_law, only: regularisation
   use evl_kinds, only: wp
   use evl_operating_friction, only: load_term, operating_friction_t, operating_point, viscosity_term
   use evl_row, only: kind_t, parameter_row, positive, span_t
   implicit none (type, external)
   private

   public :: schlenk_t

   type, extends(operating_friction_t) :: schlenk_t
   contains
      procedure :: describe
      procedure :: coefficient
   end type schlenk_t

contains

   !> Name, source and parameters.
   pure subroutine describe(self, info)
      class(schlenk_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "schlenk"
      info%text = "Coulomb's law with the mean coefficient of the nominal operating point by Schlenk; needs a lubricant"
      info%source = "A. Schlenk; formula from memory, two public sources agree"
      info%rows = [parameter_row("lubricant_factor", "", "X_L of the lubricant, 1 for mineral oil", range=positive, default="1", &
                                 plausible=span_t(0.1_wp, 2.0_wp)), &
                   regularisation("sliding velocity at which friction is fully developed")]
   end subroutine describe

   !> Equation L22.
   pure real(wp) function coefficient(self, at) result(mu)
      class(schlenk_t), intent(in) :: self
      type(operating_point), intent(in) :: at

      mu = 0.048_wp*load_term(at)*viscosity_term(self%lubricant)*(self%lubricant%roughness*1.0e6_wp)**0.25_wp*self%parameters(1)
   end function coefficient

end module evl_schlenk
