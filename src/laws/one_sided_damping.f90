!> F = c h h' on approach (h' > 0), 0 on separation.
!>
!> The paper's group writes it damp |kappa| |h'| with kappa = -h. Continued to h < 0 with its sign, so that it stays
!> smooth through the end of contact, and on each side through h' = 0, where the side changes.
module evl_one_sided_damping
   use evl_contact_context, only: contact_context, lane_context
   use evl_damping_law, only: damping_law_t, viscous_result
   use evl_force_law, only: yes
   use evl_kinds, only: lanes, wp
   use evl_row, only: kind_t, not_negative, parameter_row, span_t
   implicit none (type, external)
   private

   public :: one_sided_damping_t

   type, extends(damping_law_t) :: one_sided_damping_t
   contains
      procedure :: describe
      procedure, nopass :: has_sides => yes
      procedure :: force
      procedure :: force_lanes
   end type one_sided_damping_t

contains

   !> Name, source and parameter.
   pure subroutine describe(self, info)
      class(one_sided_damping_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "one_sided"
      info%text = "proportional to penetration and its rate on approach, zero on separation"
      info%source = "the Modelica library of Kosenko's group: damp |kappa| |h'|"
      info%rows = [parameter_row("coefficient", "N s/m2", "force per penetration and rate of penetration", range=not_negative, &
                                 plausible=span_t(1.0_wp, 1.0e15_wp))]
   end subroutine describe

   !> The force.
   pure subroutine force(self, ctx, elastic, result)
      class(one_sided_damping_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      real(wp), intent(in) :: elastic
      type(viscous_result), intent(inout) :: result

      call one_sided_damping(ctx%h, ctx%h_dot, self%parameters(1), ctx%side, result%force, result%d_h, result%d_h_dot)
   end subroutine force

   !> The same in eight states.
   pure subroutine force_lanes(self, at, elastic, force)
      class(one_sided_damping_t), intent(in) :: self
      type(lane_context), intent(in) :: at
      real(wp), intent(in) :: elastic(lanes)
      real(wp), intent(out) :: force(lanes)
      real(wp) :: coefficient, d_h, d_h_dot
      integer :: l, side

      coefficient = self%parameters(1)
      side = at%side
      !$omp simd private(d_h, d_h_dot)
      do l = 1, lanes
         call one_sided_damping(at%h(l), at%h_dot(l), coefficient, side, force(l), d_h, d_h_dot)
      end do
   end subroutine force_lanes

   !> The force on one of its sides.
   elemental subroutine one_sided_damping(h, h_dot, coefficient, side, force, d_h, d_h_dot)
      real(wp), intent(in) :: h           !! penetration [m]
      real(wp), intent(in) :: h_dot       !! rate of penetration [m/s], positive on approach
      real(wp), intent(in) :: coefficient !! c [N s/m^2], >= 0
      integer, intent(in) :: side         !! +1 approach, -1 separation; 0: as the rate says
      real(wp), intent(out) :: force      !! [N]
      real(wp), intent(out) :: d_h        !! dF/dh [N/m]
      real(wp), intent(out) :: d_h_dot    !! dF/dh' [N s/m]
      real(wp) :: slope

      slope = merge(1.0_wp, 0.0_wp, side > 0 .or. (side == 0 .and. h_dot > 0))*coefficient
      d_h = slope*h_dot
      d_h_dot = slope*h
      force = d_h_dot*h_dot
   end subroutine one_sided_damping

end module evl_one_sided_damping
