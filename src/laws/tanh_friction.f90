!> Coulomb's law, smooth everywhere: phi = f tanh(v_t/delta).
!>
!> Source: S. Andersson, A. Soederberg, S. Bjoerklund, Friction models for sliding dry, boundary and mixed lubricated
!> contacts, Tribology International 40 (2007) 580.
module evl_tanh_friction
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_friction_law, only: friction_law_t, regularisation
   use evl_kinds, only: lanes, wp
   use evl_row, only: kind_t, not_negative, parameter_row, span_t
   implicit none (type, external)
   private

   public :: tanh_friction_t

   type, extends(friction_law_t) :: tanh_friction_t
   contains
      procedure :: describe
      procedure :: factor
      procedure :: factor_lanes
   end type tanh_friction_t

contains

   include "numerics/exponential_parts.inc"
   include "numerics/hyperbolic_tangent.inc"
   include "laws/smooth_sliding.inc"

   !> Name, source and parameters.
   pure subroutine describe(self, info)
      class(tanh_friction_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "tanh"
      info%text = "Coulomb's law, smoothed by the hyperbolic tangent of the sliding velocity"
      info%source = "Andersson, Soederberg & Bjoerklund 2007, Tribology International 40, 580"
      info%rows = [parameter_row("coefficient", "", "coefficient of friction", range=not_negative, &
                                 plausible=span_t(0.0_wp, 1.0_wp)), &
                   regularisation("sliding velocity at which friction is developed to 76 %")]
   end subroutine describe

   !> The factor.
   pure subroutine factor(self, branch, v_t, phi, d_v)
      class(tanh_friction_t), intent(in) :: self
      integer, intent(in) :: branch
      real(wp), intent(in) :: v_t
      real(wp), intent(out) :: phi, d_v

      call tanh_factor(v_t, self%parameters(1), self%parameters(2), phi, d_v)
   end subroutine factor

   !> The same in eight states.
   pure subroutine factor_lanes(self, branch, v_t, phi)
      class(tanh_friction_t), intent(in) :: self
      integer, intent(in) :: branch
      real(wp), intent(in) :: v_t(lanes)
      real(wp), intent(out) :: phi(lanes)
      real(wp) :: coefficient, delta, d_v
      integer :: l

      coefficient = self%parameters(1)
      delta = self%parameters(2)
      !$omp simd private(d_v)
      do l = 1, lanes
         call tanh_factor(v_t(l), coefficient, delta, phi(l), d_v)
      end do
   end subroutine factor_lanes

   !> phi and its slope.
   elemental subroutine tanh_factor(v_t, coefficient, delta, phi, d_v)
      real(wp), intent(in) :: v_t         !! sliding velocity [m/s]
      real(wp), intent(in) :: coefficient !! f, >= 0
      real(wp), intent(in) :: delta       !! regularisation velocity [m/s], > 0
      real(wp), intent(out) :: phi
      real(wp), intent(out) :: d_v        !! dphi/dv_t [s/m]
      real(wp) :: share, d_share

      call smooth_sign(v_t, delta, share, d_share)
      phi = coefficient*share
      d_v = coefficient/delta*d_share
   end subroutine tanh_factor

end module evl_tanh_friction
