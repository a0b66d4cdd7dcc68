!> Local coefficient of friction of Xu and Kahraman, a regression of thermal elastohydrodynamic solutions:
!>
!>    mu = e^f p_h^b2 SR^b3 V_e^b6 eta^b7 R^b8    f = b1 + b4 x + b5 e^(-x) + b9 e^S    x = SR p_h log10 eta
!>
!> with SR = u/V_e, half the sum V_e of the rolling speeds [m/s], Hertz pressure p_h [GPa], viscosity eta [cP], reduced radius R [m]
!> and roughness S [um].
!>
!> Source: H. Xu, A. Kahraman, N. E. Anderson, D. G. Maddock, Prediction of mechanical efficiency of parallel-axis gear pairs,
!> Journal of Mechanical Design 129 (2007) 58; constants from memory, two public sources agree.
module evl_xu_kahraman
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_friction_law, only: by_curvature, by_load, by_rolling, by_sliding, n_sliding, regularisation, sliding_t
   use evl_kinds, only: pi, wp
   use evl_local_friction, only: local_friction_t
   use evl_row, only: kind_t
   use evl_status, only: message_length, quantity
   implicit none (type, external)
   private

   public :: xu_kahraman_t

   real(wp), parameter :: b(9) = [-8.916465_wp, 1.03303_wp, 1.036077_wp, -0.354068_wp, 2.812084_wp, -0.100601_wp, 0.752755_wp, &
                                  -0.390958_wp, 0.620305_wp]
   ! Limits at which an argument is held: those of this program, not of the source
   real(wp), parameter :: least_pressure = 0.05_wp, largest_pressure = 4.0_wp !! [GPa]
   real(wp), parameter :: largest_ratio = 2.0_wp                              !! of one flank at rest
   real(wp), parameter :: least_viscosity = 1.0_wp                            !! [cP]; below it the logarithm changes its sign
   real(wp), parameter :: largest_roughness = 1.0_wp                          !! [um]

   type, extends(local_friction_t) :: xu_kahraman_t
   contains
      procedure :: describe
      procedure :: coefficient
      procedure :: beyond_limits
   end type xu_kahraman_t

contains

   include "numerics/exponential_parts.inc"
   include "numerics/exponential.inc"
   include "numerics/logarithm_terms.inc"
   include "numerics/logarithm.inc"
   include "laws/hertz_pressure.inc"

   !> Name, source and parameters.
   pure subroutine describe(self, info)
      class(xu_kahraman_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "xu_kahraman"
      info%text = "local coefficient of an elastohydrodynamic contact; needs a lubricant"
      info%source = "Xu, Kahraman, Anderson & Maddock 2007, J. Mech. Des. 129, 58"
      info%rows = [regularisation("sliding and rolling velocity below which friction is nearly viscous")]
   end subroutine describe

   !> Equation L27.
   pure subroutine coefficient(self, n, at, mu, d_mu)
      class(xu_kahraman_t), intent(in) :: self
      integer, intent(in) :: n
      type(sliding_t), intent(in) :: at
      real(wp), intent(out) :: mu(n)
      real(wp), intent(out) :: d_mu(n, n_sliding)
      real(wp) :: log_eta, constant, load, p, p_held, ratio, ratio_held, speed, x, decay, by_x, by_p, by_ratio
      integer :: i

      log_eta = log10(max(self%lubricant%viscosity*1.0e3_wp, least_viscosity))
      constant = b(1) + b(7)*log_eta*log(10.0_wp) + b(9)*exp(min(self%lubricant%roughness*1.0e6_wp, largest_roughness))
      !$omp simd private(load, p, p_held, ratio, ratio_held, speed, x, decay, by_x, by_p, by_ratio)
      do i = 1, n
         load = max(at%x(i, by_load), 0.0_wp)
         p = hertz_pressure(load, 1.0_wp, at%e_star, max(at%x(i, by_curvature), 0.0_wp))*1.0e-9_wp
         p_held = min(max(p, least_pressure), largest_pressure)
         speed = at%x(i, by_rolling)/2
         ratio = at%x(i, by_sliding)/speed
         ratio_held = min(ratio, largest_ratio)
         x = ratio_held*p_held*log_eta
         decay = exponential(-x)
         mu(i) = exponential(constant + b(4)*x + b(5)*decay + b(2)*natural_logarithm(p_held) + b(3)*natural_logarithm(ratio_held) &
                             + b(6)*natural_logarithm(speed) - b(8)*natural_logarithm(at%x(i, by_curvature)))
         by_x = b(4) - b(5)*decay
         by_p = merge(b(2)/p_held + by_x*ratio_held*log_eta, 0.0_wp, p > least_pressure .and. p < largest_pressure)
         by_ratio = merge(b(3)/ratio_held + by_x*p_held*log_eta, 0.0_wp, ratio < largest_ratio)
         d_mu(i, by_sliding) = mu(i)*by_ratio/speed
         d_mu(i, by_rolling) = mu(i)*(b(6) - by_ratio*ratio)/at%x(i, by_rolling)
         d_mu(i, by_load) = mu(i)*by_p*p/(2*max(load, 1.0e-30_wp))
         d_mu(i, by_curvature) = mu(i)*(by_p*p/2 - b(8))/at%x(i, by_curvature)
      end do
   end subroutine coefficient

   !> Name a quantity that is held at its limit. Pressures below the least one are not named: every pair has them where its contact
   !> begins and ends.
   pure subroutine beyond_limits(self, at, of, message)
      class(xu_kahraman_t), intent(in) :: self
      type(sliding_t), intent(in) :: at
      character(len=*), intent(in) :: of
      character(len=message_length), intent(out) :: message
      real(wp), parameter :: rounding = 1.0e-9_wp
      real(wp) :: p, ratio

      message = ""
      p = hertz_pressure(max(at%x(1, by_load), 0.0_wp), 1.0_wp, at%e_star, max(at%x(1, by_curvature), 0.0_wp))
      ratio = 2*at%x(1, by_sliding)/at%x(1, by_rolling)
      if (self%lubricant%viscosity*1.0e3_wp < least_viscosity) then
         message = "the viscosity "//quantity(self%lubricant%viscosity, "Pa s")//" counts as " &
                   //quantity(least_viscosity*1.0e-3_wp, "Pa s")//", the least value of this friction law"
      else if (self%lubricant%roughness*1.0e6_wp > largest_roughness) then
         message = "the roughness "//quantity(self%lubricant%roughness, "m")//" counts as " &
                   //quantity(largest_roughness*1.0e-6_wp, "m")//", the largest value of this friction law"
      else if (p > largest_pressure*1.0e9_wp) then
         message = "the pressure "//of//", "//quantity(p, "Pa")//", counts as " &
                   //quantity(largest_pressure*1.0e9_wp, "Pa")//", the largest value of this friction law"
      else if (ratio > largest_ratio*(1 + rounding)) then
         message = "the sliding ratio "//of//", "//quantity(ratio, "")//", counts as " &
                   //quantity(largest_ratio, "")//", the largest value of this friction law"
      end if
   end subroutine beyond_limits

end module evl_xu_kahraman
