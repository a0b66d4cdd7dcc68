!> The linear spring, over the whole width: F = k h, with V = k h**2/2.
!>
!> It is independent of the radii of curvature and has no limit of validity.
module evl_linear_spring
   use evl_contact_context, only: contact_context, lane_context
   use evl_elastic_law, only: elastic_law_t, elastic_result, no_elastic
   use evl_kinds, only: lanes, wp
   use evl_row, only: kind_t, parameter_row, positive, span_t
   use evl_status, only: code_ok
   implicit none (type, external)
   private

   public :: linear_spring_t

   type, extends(elastic_law_t) :: linear_spring_t
   contains
      procedure :: describe
      procedure :: stiffness
      procedure :: force
      procedure :: force_lanes
      procedure :: potential
      procedure :: penetration
   end type linear_spring_t

contains

   !> Name, source and parameter.
   pure subroutine describe(self, info)
      class(linear_spring_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "linear"
      info%text = "proportional to the penetration"
      info%source = "Hooke's law"
      info%rows = [parameter_row("stiffness", "N/m", "normal force per penetration, for the whole face width", range=positive, &
                                 plausible=span_t(1.0e3_wp, 1.0e12_wp))]
   end subroutine describe

   !> k [N/m].
   pure real(wp) function stiffness(self, e_star, width)
      class(linear_spring_t), intent(in) :: self
      real(wp), intent(in) :: e_star !! effective modulus E* [Pa]
      real(wp), intent(in) :: width  !! common face width b [m]

      stiffness = self%parameters(1)
   end function stiffness

   !> Force.
   pure subroutine force(self, ctx, result, code)
      class(linear_spring_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      type(elastic_result), intent(out) :: result
      integer, intent(out) :: code

      result = no_elastic
      result%d_h = self%stiffness(ctx%e_star, ctx%width)
      result%force = linear_spring(result%d_h, ctx%h)
      code = code_ok
   end subroutine force

   !> `force` in eight states.
   pure subroutine force_lanes(self, at, force, d_energy, excess, is_defined)
      class(linear_spring_t), intent(in) :: self
      type(lane_context), intent(in) :: at
      real(wp), dimension(lanes), intent(out) :: force, d_energy, excess
      logical, intent(out) :: is_defined

      force = linear_spring(self%stiffness(at%e_star, at%width), at%h)
      d_energy = 0
      excess = 0
      is_defined = .true.
   end subroutine force_lanes

   !> Elastic energy.
   pure function potential(self, ctx, force) result(energy)
      class(linear_spring_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      real(wp), intent(in) :: force
      real(wp) :: energy

      energy = 0.5_wp*self%stiffness(ctx%e_star, ctx%width)*ctx%h**2
   end function potential

   !> Penetration under a force.
   pure subroutine penetration(self, ctx, force, h, code)
      class(linear_spring_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      real(wp), intent(in) :: force
      real(wp), intent(out) :: h
      integer, intent(out) :: code

      h = force/self%stiffness(ctx%e_star, ctx%width)
      code = code_ok
   end subroutine penetration

   !> F = k h. Equation L4.
   elemental real(wp) function linear_spring(stiffness, h) result(force)
      real(wp), intent(in) :: stiffness !! k [N/m], > 0
      real(wp), intent(in) :: h         !! penetration [m]

      force = stiffness*h
   end function linear_spring

end module evl_linear_spring
