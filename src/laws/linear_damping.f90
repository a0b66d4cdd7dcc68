!> A linear damper: F = c h'. Source: Kosenko & Gusev 2011, section 4, "similar to [7]".
module evl_linear_damping
   use evl_damping_law, only: damping_law_t
   use evl_kinds, only: wp
   use evl_row, only: kind_t, not_negative, parameter_row, span_t
   implicit none (type, external)
   private

   public :: linear_damping_t

   type, extends(damping_law_t) :: linear_damping_t
   contains
      procedure :: describe
      procedure :: evaluate
   end type linear_damping_t

contains

   !> Name, source and parameter.
   pure subroutine describe(self, info)
      class(linear_damping_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "linear"
      info%text = "proportional to the rate of penetration"
      info%source = "Kosenko & Gusev 2011, section 4"
      info%rows = [parameter_row("coefficient", "N s/m", "force per rate of penetration", range=not_negative, &
                                 plausible=span_t(1.0e-3_wp, 1.0e8_wp))]
   end subroutine describe

   !> F = c h'. Equation L7.
   pure subroutine evaluate(self, n, h, h_dot, elastic, v0, side, force, d_h, d_h_dot, d_elastic)
      class(linear_damping_t), intent(in) :: self
      integer, intent(in) :: n, side
      real(wp), intent(in) :: h(n), h_dot(n), elastic(n), v0
      real(wp), intent(out) :: force(n)
      real(wp), dimension(n), intent(inout), optional :: d_h, d_h_dot, d_elastic

      force = self%parameters(1)*h_dot
      if (present(d_h_dot)) d_h_dot = self%parameters(1)
   end subroutine evaluate

end module evl_linear_damping
