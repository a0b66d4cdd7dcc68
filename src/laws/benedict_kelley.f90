!> Local coefficient of friction of Benedict and Kelley:
!>
!>    mu = 0.0127 log10(29660 w/(eta u V^2))    N/mm, mPa s, m/s
!>
!> u is the sliding velocity and V the sum of the rolling speeds. Constants from memory.
module evl_benedict_kelley
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_force_law, only: no
   use evl_friction_law, only: by_curvature, by_load, by_rolling, by_sliding, n_sliding, regularisation, sliding_t
   use evl_kinds, only: wp
   use evl_local_friction, only: local_friction_t
   use evl_row, only: kind_t
   use evl_status, only: message_length
   implicit none (type, external)
   private

   public :: benedict_kelley_t

   real(wp), parameter :: per_decade = 0.0127_wp/2.302585092994045684_wp !! over ln 10
   real(wp), parameter :: largest = 0.2_wp !! the formula diverges at slow sliding or rolling

   type, extends(local_friction_t) :: benedict_kelley_t
   contains
      procedure :: describe
      procedure, nopass :: uses_roughness => no
      procedure :: falls
      procedure :: coefficient
      procedure :: beyond_limits
   end type benedict_kelley_t

contains

   include "numerics/logarithm_terms.inc"
   include "numerics/logarithm.inc"

   !> Name, source and parameters.
   pure subroutine describe(self, info)
      class(benedict_kelley_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "benedict_kelley"
      info%text = "local coefficient by load, viscosity, sliding and rolling speed; needs a lubricant"
      info%source = "Benedict & Kelley 1961, ASLE Transactions 4, 59; constants from memory"
      info%rows = [regularisation("sliding velocity below which friction is nearly viscous")]
   end subroutine describe

   !> Friction decreases with the sliding velocity, except near 0.
   pure logical function falls(self)
      class(benedict_kelley_t), intent(in) :: self

      falls = .true.
   end function falls

   !> Equation L26.
   pure subroutine coefficient(self, n, at, mu, d_mu)
      class(benedict_kelley_t), intent(in) :: self
      integer, intent(in) :: n
      type(sliding_t), intent(in) :: at
      real(wp), intent(out) :: mu(n)
      real(wp), intent(out) :: d_mu(n, n_sliding)
      real(wp) :: eta, load, unlimited, slope
      integer :: i

      eta = self%lubricant%viscosity*1.0e3_wp
      !$omp simd private(load, unlimited, slope)
      do i = 1, n
         load = max(at%x(i, by_load), 1.0e-30_wp)
         unlimited = per_decade*natural_logarithm(29660.0_wp*(load*1.0e-3_wp)/(eta*at%x(i, by_sliding)*at%x(i, by_rolling)**2))
         mu(i) = min(max(unlimited, 0.0_wp), largest)
         slope = merge(per_decade, 0.0_wp, unlimited > 0.0_wp .and. unlimited < largest)
         d_mu(i, by_sliding) = -slope/at%x(i, by_sliding)
         d_mu(i, by_rolling) = -2*slope/at%x(i, by_rolling)
         d_mu(i, by_load) = slope/load
         d_mu(i, by_curvature) = 0
      end do
   end subroutine coefficient

   !> The coefficient is bounded; the formula has no other limits.
   pure subroutine beyond_limits(self, at, of, message)
      class(benedict_kelley_t), intent(in) :: self
      type(sliding_t), intent(in) :: at
      character(len=*), intent(in) :: of
      character(len=message_length), intent(out) :: message

      message = ""
   end subroutine beyond_limits

end module evl_benedict_kelley
