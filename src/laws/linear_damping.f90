!> A linear damper: F = c h'. Source: Kosenko & Gusev 2011, section 4, "similar to [7]".
module evl_linear_damping
   use evl_contact_context, only: contact_context, lane_context
   use evl_damping_law, only: damping_law_t, viscous_result
   use evl_kinds, only: lanes, wp
   use evl_row, only: kind_t, not_negative, parameter_row, span_t
   implicit none (type, external)
   private

   public :: linear_damping_t

   type, extends(damping_law_t) :: linear_damping_t
   contains
      procedure :: describe
      procedure :: force
      procedure :: force_lanes
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

   !> The force.
   pure subroutine force(self, ctx, elastic, result)
      class(linear_damping_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      real(wp), intent(in) :: elastic
      type(viscous_result), intent(inout) :: result

      result%d_h_dot = self%parameters(1)
      result%force = linear_damping(result%d_h_dot, ctx%h_dot)
   end subroutine force

   !> The same in eight states.
   pure subroutine force_lanes(self, at, elastic, force)
      class(linear_damping_t), intent(in) :: self
      type(lane_context), intent(in) :: at
      real(wp), intent(in) :: elastic(lanes)
      real(wp), intent(out) :: force(lanes)

      force = linear_damping(self%parameters(1), at%h_dot)
   end subroutine force_lanes

   !> F = c h'.
   elemental real(wp) function linear_damping(coefficient, h_dot) result(force)
      real(wp), intent(in) :: coefficient !! c [N s/m], >= 0
      real(wp), intent(in) :: h_dot       !! rate of penetration [m/s], positive on approach

      force = coefficient*h_dot
   end function linear_damping

end module evl_linear_damping
