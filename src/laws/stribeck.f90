!> phi = [f_k + (f_s - f_k) exp(-(v_t/v_s)**2)] tanh(v_t/delta): friction falls from static to kinetic as sliding begins.
!>
!> Source: the Stribeck curve of B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, A survey of models, analysis tools and
!> compensation methods for the control of machines with friction, Automatica 30 (1994) 1083, with exponent 2, without its
!> viscous term; tanh instead of the sign as in Andersson, Soederberg and Bjoerklund 2007.
module evl_stribeck
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_friction_law, only: friction_law_t, regularisation
   use evl_kinds, only: lanes, wp
   use evl_row, only: kind_t, not_negative, parameter_row, positive, span_t
   use evl_status, only: quantity
   implicit none (type, external)
   private

   public :: stribeck_t

   type, extends(friction_law_t) :: stribeck_t
   contains
      procedure :: describe
      procedure :: check
      procedure :: evaluate
      procedure :: falls
   end type stribeck_t

contains

   include "numerics/exponential_parts.inc"
   include "numerics/exponential.inc"
   include "numerics/hyperbolic_tangent.inc"
   include "laws/smooth_sliding.inc"

   !> Name, source and parameters.
   pure subroutine describe(self, info)
      class(stribeck_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "stribeck"
      info%text = "falling from static to kinetic friction over the Stribeck velocity, smooth"
      info%source = "Armstrong-Helouvry et al. 1994, Automatica 30, 1083; Andersson et al. 2007"
      info%rows = [parameter_row("static_coefficient", "", "static coefficient of friction, at least the kinetic one", &
                                 range=not_negative, &
                                 plausible=span_t(0.0_wp, 1.0_wp)), &
                   parameter_row("kinetic_coefficient", "", "kinetic coefficient of friction, at high sliding velocity", &
                                 range=not_negative, &
                                 plausible=span_t(0.0_wp, 1.0_wp)), &
                   parameter_row("stribeck_velocity", "m/s", &
                                 "sliding velocity at which the excess of static over kinetic friction falls to 1/e", &
                                 range=positive, &
                                 plausible=span_t(1.0e-6_wp, 10.0_wp)), &
                   regularisation("sliding velocity at which the friction force reaches 76 %")]
   end subroutine describe

   !> Check that static friction is not below kinetic friction.
   pure subroutine check(self, field, message)
      class(stribeck_t), intent(in) :: self
      character(len=*), intent(out) :: field, message

      field = ""
      message = ""
      if (self%parameters(1) >= self%parameters(2)) return
      field = "static_coefficient"
      message = "static_coefficient = "//quantity(self%parameters(1), "")//" must be at least the kinetic_coefficient = " &
                //quantity(self%parameters(2), "")
   end subroutine check

   !> phi and its slope. Equation L16.
   pure subroutine evaluate(self, n, branch, v_t, phi, d_v)
      class(stribeck_t), intent(in) :: self
      integer, intent(in) :: n, branch
      real(wp), intent(in) :: v_t(n)
      real(wp), intent(out) :: phi(n)
      real(wp), intent(inout), optional :: d_v(n)
      real(wp) :: static, kinetic, stribeck_velocity, delta
      real(wp), dimension(lanes) :: share, d_share, excess
      integer :: i

      static = self%parameters(1)
      kinetic = self%parameters(2)
      stribeck_velocity = self%parameters(3)
      delta = self%parameters(4)
      !$omp simd
      do i = 1, n
         call smooth_sign(v_t(i), delta, share(i), d_share(i))
         excess(i) = (static - kinetic)*exponential(-(v_t(i)/stribeck_velocity)**2)
      end do
      phi = (kinetic + excess(:n))*share(:n)
      if (.not. present(d_v)) return
      d_v = (kinetic + excess(:n))*(1/delta*d_share(:n)) &
            - 2.0_wp*excess(:n)*(v_t/stribeck_velocity)/stribeck_velocity*share(:n)
   end subroutine evaluate

   !> It falls from static to kinetic friction.
   pure logical function falls(self)
      class(stribeck_t), intent(in) :: self

      falls = self%parameters(1) > self%parameters(2)
   end function falls

end module evl_stribeck
