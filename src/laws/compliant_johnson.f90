!> Johnson's contact in series with an elastic body: normal force per unit width of a tooth pair that is not coupled to others.
!>
!> With the length Lambda, the body's compliance c [1/Pa] and w > 1:
!>
!>    h = N/(pi E*) [ln(4 pi E* Lambda/N) - 1] + c N
!>    N = pi E* h/w,   w - ln w = ell,   ell = ln(4 Lambda/(e h)) + pi E* c
!>
!> It is Johnson's law with the length Lambda exp(pi E* c); that exponential is never evaluated. With v = w - 1
!>
!>    dN/dh = pi E*/v,   dN/dc = -pi E* N/v,   dN/dLambda = -N/(Lambda v),   V = N h/2 - N**2/(4 pi E*)
!>
!> and dV = N dh - N**2/2 dc - N**2/(2 pi E* Lambda) dLambda, exactly.
!>
!> Valid: 1 < ell < 699; that is h < 4 Lambda/e**2 exp(pi E* c), beyond which there is no solution and an error is reported, and h
!> > Lambda exp(pi E* c - 698.6), below which N is linear in h: 1e-285 m for pi E* c = 40 and Lambda = 0.1 m. Forces are odd in h.
!>
!> Source: K. L. Johnson, Contact Mechanics, 1985, (5.57); the rest is derived in docs/theory/compliant_flanks.md.
module evl_compliant_johnson
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_kinds, only: lanes, pi, wp
   use evl_status, only: code_ok, code_out_of_domain
   implicit none (type, external)
   private

   public :: compliant_contact, compliant_energy, compliant_force, compliant_force_lanes, compliant_penetration
   public :: largest_excess, smallest

   real(wp), parameter :: smallest = tiny(1.0_wp)   !! smallest h/(4 Lambda) whose logarithm is evaluated
   real(wp), parameter :: largest_excess = 698.0_wp !! ell - 1 up to which w is evaluated

   !> A force per unit width with its derivatives.
   type :: compliant_contact
      real(wp) :: force    !! N [N/m]
      real(wp) :: d_h      !! dN/dh [N/m^2]; 0 at h = 0, its (logarithmic) limit
      real(wp) :: d_c      !! dN/dc [N^2/m^2]
      real(wp) :: d_length !! dN/dLambda [N/m^2]
   end type compliant_contact

contains

   include "numerics/all_positive.inc"
   include "numerics/logarithm_terms.inc"
   include "numerics/logarithm.inc"
   include "numerics/lambert_w.inc"

   include "laws/compliant_johnson.inc"

   !> `compliant_force` in eight states.
   pure subroutine compliant_force_lanes(h, length, c, e_star, force, is_defined)
      real(wp), intent(in), dimension(lanes) :: h, length, c
      real(wp), intent(in) :: e_star
      real(wp), intent(out) :: force(lanes)
      logical, intent(out) :: is_defined !! false if one of the states is outside the law's domain
      real(wp) :: lane_defined(lanes)
      integer :: l

      !$omp simd
      do l = 1, lanes
         call force_of_lane(h(l), length(l), c(l), e_star, force(l), lane_defined(l))
      end do
      is_defined = all_positive(lane_defined)
   end subroutine compliant_force_lanes

   !> One lane.
   elemental subroutine force_of_lane(h, length, c, e_star, force, defined)
      real(wp), intent(in) :: h, length, c, e_star
      real(wp), intent(out) :: force
      real(wp), intent(out) :: defined !! 1, or 0 outside the law's domain
      type(compliant_contact) :: contact
      integer :: code

      call compliant_force(h, length, c, e_star, contact, code)
      force = contact%force
      defined = merge(1.0_wp, 0.0_wp, code == code_ok)
   end subroutine force_of_lane

   !> Elastic energy per unit width [J/m], including that of the body; even in h. Equation F3.
   elemental real(wp) function compliant_energy(h, force, e_star) result(energy)
      real(wp), intent(in) :: h      !! penetration [m]
      real(wp), intent(in) :: force  !! N at h [N/m]
      real(wp), intent(in) :: e_star !! effective modulus [Pa]

      energy = force*h/2 - force**2/(4*pi*e_star)
   end function compliant_energy

end module evl_compliant_johnson
