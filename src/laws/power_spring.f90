!> A spring with a power of the penetration, over the whole width: F = K |h|**m sign(h), with V = K |h|**(m + 1)/(m + 1).
!>
!> It is independent of the radii of curvature and has no limit of validity.
!>
!> Source: K. H. Hunt, F. R. E. Crossley, Coefficient of restitution interpreted as damping in vibroimpact, J. Appl. Mech.
!> 42 (1975) 440, the elastic part of their law.
module evl_power_spring
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_contact_context, only: contact_context, lane_context
   use evl_elastic_law, only: elastic_law_t, elastic_result, no_elastic
   use evl_kinds, only: lanes, wp
   use evl_row, only: at_least, kind_t, parameter_row, positive, span_t
   use evl_status, only: code_ok
   implicit none (type, external)
   private

   public :: power_spring_t

   type, extends(elastic_law_t) :: power_spring_t
   contains
      procedure :: describe
      procedure :: force
      procedure :: force_lanes
      procedure :: potential
      procedure :: penetration
   end type power_spring_t

contains

   include "numerics/logarithm_terms.inc"
   include "numerics/exponential_parts.inc"
   include "numerics/exponential.inc"
   include "numerics/power.inc"

   !> Name, source and parameters.
   pure subroutine describe(self, info)
      class(power_spring_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "power"
      info%text = "proportional to a power of the penetration"
      info%source = "Hunt & Crossley 1975, J. Appl. Mech. 42, 440"
      info%rows = [parameter_row("coefficient", "N/m^exponent", "normal force per power of the penetration, for the whole face" &
                                 //" width", &
                                 range=positive, &
                                 plausible=span_t(1.0_wp, 1.0e20_wp)), &
                   parameter_row("exponent", "", "exponent of the penetration", range=at_least(1.0_wp))]
   end subroutine describe

   !> Force.
   pure subroutine force(self, ctx, result, code)
      class(power_spring_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      type(elastic_result), intent(out) :: result
      integer, intent(out) :: code

      result = no_elastic
      call power_spring(ctx%h, self%parameters(1), self%parameters(2), result%force, result%d_h)
      code = code_ok
   end subroutine force

   !> `force` in eight states.
   pure subroutine force_lanes(self, at, force, d_energy, excess, is_defined)
      class(power_spring_t), intent(in) :: self
      type(lane_context), intent(in) :: at
      real(wp), dimension(lanes), intent(out) :: force, d_energy, excess
      logical, intent(out) :: is_defined
      real(wp) :: coefficient, exponent, d_h
      integer :: l

      coefficient = self%parameters(1)
      exponent = self%parameters(2)
      !$omp simd private(d_h)
      do l = 1, lanes
         call power_spring(at%h(l), coefficient, exponent, force(l), d_h)
      end do
      d_energy = 0
      excess = 0
      is_defined = .true.
   end subroutine force_lanes

   !> Elastic energy.
   pure function potential(self, ctx, force) result(energy)
      class(power_spring_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      real(wp), intent(in) :: force
      real(wp) :: energy

      energy = force*ctx%h/(self%parameters(2) + 1.0_wp)
   end function potential

   !> Penetration under a force: (|F|/K)**(1/m) sign(F).
   pure subroutine penetration(self, ctx, force, h, code)
      class(power_spring_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      real(wp), intent(in) :: force
      real(wp), intent(out) :: h
      integer, intent(out) :: code

      h = sign((abs(force)/self%parameters(1))**(1.0_wp/self%parameters(2)), force)
      code = code_ok
   end subroutine penetration

   !> F = K |h|**m sign(h). Equation L6.
   elemental subroutine power_spring(h, coefficient, exponent, force, d_h)
      real(wp), intent(in) :: h           !! penetration [m]
      real(wp), intent(in) :: coefficient !! K [N/m^m], > 0
      real(wp), intent(in) :: exponent    !! m >= 1
      real(wp), intent(out) :: force      !! [N]
      real(wp), intent(out) :: d_h        !! dF/dh [N/m]
      real(wp) :: secant

      secant = coefficient*real_power(abs(h), exponent - 1.0_wp) ! 0**0 is 1: m = 1 is the linear spring
      force = secant*h
      d_h = exponent*secant
   end subroutine power_spring

end module evl_power_spring
