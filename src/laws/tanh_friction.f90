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
      procedure :: evaluate
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
                   regularisation("sliding velocity at which the friction force reaches 76 %")]
   end subroutine describe

   !> phi and its slope. Equation L15.
   pure subroutine evaluate(self, n, branch, v_t, phi, d_v)
      class(tanh_friction_t), intent(in) :: self
      integer, intent(in) :: n, branch
      real(wp), intent(in) :: v_t(n)
      real(wp), intent(out) :: phi(n)
      real(wp), intent(inout), optional :: d_v(n)
      real(wp) :: delta, share(lanes), d_share(lanes)
      integer :: i

      delta = self%parameters(2)
      !$omp simd
      do i = 1, n
         call smooth_sign(v_t(i), delta, share(i), d_share(i))
      end do
      phi = self%parameters(1)*share(:n)
      if (present(d_v)) d_v = self%parameters(1)/delta*d_share(:n)
   end subroutine evaluate

end module evl_tanh_friction
