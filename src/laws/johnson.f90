!> Normal elastic force between two cylinders after Johnson, per unit width.
!>
!> With rho the sum of the radii of curvature, e = 2.718... and w > 1:
!>
!>    h = N/(pi E*) [ln(4 pi E* rho/N) - 1]                                (13)
!>    N = pi E* h/w,   w - ln w = ell = -ln(x),   x = e h/(4 rho)          (14), w = -W_{-1}(-x)
!>    h < 4 rho/e**2,  N < 4 pi E* rho/e**2                                (15)
!>
!> Beyond the limits (15) the model has no solution; this is reported and never clamped. Forces and penetrations are extended
!> as odd functions to negative arguments, so that a root of either can be located from both sides of zero.
!>
!> Sources: K. L. Johnson, Contact Mechanics, 1985, section 5.6; I. Kosenko, I. Gusev, Implementation of the spur
!> involute gear model on Modelica, 8th Modelica Conference, 2011, (13)-(18).
module evl_johnson
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_contact_context, only: contact_context, lane_context
   use evl_elastic_law, only: elastic_law_t, elastic_result
   use evl_kinds, only: lanes, pi, wp
   use evl_row, only: kind_t
   use evl_status, only: code_ok, code_out_of_domain, quantity
   implicit none (type, external)
   private

   public :: johnson_t
   public :: johnson_force, johnson_penetration, johnson_penetration_limit

   real(wp), parameter :: exp_minus_2 = 0.13533528323661269189399949497248_wp !! e**(-2)

   !> Smallest h/(4 rho), and N/(4 pi E* rho), whose logarithm is evaluated. Below it N is linear in h, which is accurate to
   !> 1.5 % down to the smallest number, and avoids underflow and ln(0).
   real(wp), parameter :: smallest_ratio = 1.0e-301_wp

   type, extends(elastic_law_t) :: johnson_t
      real(wp) :: radii_factor = 1.0_wp !! factor on the radii, for laws of this form with another constant
   contains
      procedure :: describe
      procedure :: force
      procedure :: force_lanes
      procedure :: potential
      procedure :: potential_lanes
      procedure :: penetration
      procedure :: limit_message
   end type johnson_t

contains

   include "numerics/all_positive.inc"
   include "numerics/logarithm_terms.inc"
   include "numerics/logarithm.inc"
   include "numerics/lambert_w.inc"

   !> Name and source.
   pure subroutine describe(self, info)
      class(johnson_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "johnson"
      info%text = "two elastic cylinders, their approach measured between the centres of curvature"
      info%source = "Johnson 1985, section 5.6; Kosenko & Gusev 2011, (13)-(18)"
   end subroutine describe

   !> Force over the whole width.
   pure subroutine force(self, ctx, result, code)
      class(johnson_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      type(elastic_result), intent(out) :: result
      integer, intent(out) :: code
      real(wp) :: margin

      call force_over_width(ctx%h, ctx%rho_a + ctx%rho_b, self%radii_factor, ctx%e_star, ctx%width, result, margin)
      code = merge(code_ok, code_out_of_domain, margin > 0.0_wp)
   end subroutine force

   !> `force` in eight states.
   pure subroutine force_lanes(self, at, force, d_energy, excess, is_defined)
      class(johnson_t), intent(in) :: self
      type(lane_context), intent(in) :: at
      real(wp), dimension(lanes), intent(out) :: force, d_energy, excess
      logical, intent(out) :: is_defined
      real(wp) :: margin(lanes), factor, e_star, width
      integer :: l

      factor = self%radii_factor
      e_star = at%e_star
      width = at%width
      !$omp simd
      do l = 1, lanes
         call force_of_lane(at%h(l), at%rho_a(l) + at%rho_b(l), factor, e_star, width, force(l), d_energy(l), excess(l), margin(l))
      end do
      is_defined = all_positive(margin)
   end subroutine force_lanes

   !> One lane.
   elemental subroutine force_of_lane(h, rho_sum, factor, e_star, width, force, d_energy, excess, margin)
      real(wp), intent(in) :: h, rho_sum, factor, e_star, width
      real(wp), intent(out) :: force, d_energy, excess
      real(wp), intent(out) :: margin !! as in `johnson_force`
      type(elastic_result) :: elastic

      call force_over_width(h, rho_sum, factor, e_star, width, elastic, margin)
      force = elastic%force
      d_energy = elastic%d_energy
      excess = elastic%excess
   end subroutine force_of_lane

   !> Elastic energy.
   pure function potential(self, ctx, force) result(energy)
      class(johnson_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      real(wp), intent(in) :: force
      real(wp) :: energy

      energy = ctx%width*johnson_energy(ctx%h, abs(force)/ctx%width, ctx%rho_a + ctx%rho_b, ctx%e_star)
   end function potential

   !> `potential` in eight states.
   pure subroutine potential_lanes(self, at, force, energy)
      class(johnson_t), intent(in) :: self
      type(lane_context), intent(in) :: at
      real(wp), intent(in) :: force(lanes)
      real(wp), intent(out) :: energy(lanes)
      real(wp) :: e_star, width
      integer :: l

      e_star = at%e_star
      width = at%width
      !$omp simd
      do l = 1, lanes
         energy(l) = width*johnson_energy(at%h(l), abs(force(l))/width, at%rho_a(l) + at%rho_b(l), e_star)
      end do
   end subroutine potential_lanes

   !> Penetration under a force.
   pure subroutine penetration(self, ctx, force, h, code)
      class(johnson_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      real(wp), intent(in) :: force
      real(wp), intent(out) :: h
      integer, intent(out) :: code

      call johnson_penetration(force/ctx%width, self%radii_factor*(ctx%rho_a + ctx%rho_b), ctx%e_star, h, code)
   end subroutine penetration

   !> Reason why there is no force.
   pure subroutine limit_message(self, ctx, message)
      class(johnson_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      character(len=*), intent(out) :: message

      if (.not. ctx%rho_a + ctx%rho_b > 0.0_wp) then
         message = "rho_A + rho_B = "//quantity(ctx%rho_a + ctx%rho_b, "m")//" is not positive, as the Johnson force requires"
      else
         message = "penetration h = "//quantity(ctx%h, "m")//" exceeds the limit 4 (rho_A + rho_B)/e^2 = " &
                   //quantity(johnson_penetration_limit(ctx%rho_a + ctx%rho_b), "m")//" of the Johnson force, eq. (15)"
      end if
   end subroutine limit_message

   !> Force over the whole width of a law h = N/(pi E*) (ln(rho_sum/N) + constant), with the derivatives of the energy of
   !> `johnson_energy`. Equations L1, T48.
   elemental subroutine force_over_width(h, rho_sum, factor, e_star, width, result, margin)
      real(wp), intent(in) :: h       !! penetration [m]
      real(wp), intent(in) :: rho_sum !! sum of the radii of curvature [m]
      real(wp), intent(in) :: factor  !! factor on it
      real(wp), intent(in) :: e_star  !! effective modulus [Pa]
      real(wp), intent(in) :: width   !! common face width [m]
      type(elastic_result), intent(out) :: result
      real(wp), intent(out) :: margin   !! as in `johnson_force`
      real(wp) :: per_line, x, y, last

      call johnson_force(h, factor*rho_sum, e_star, result%force, result%d_h, result%d_rho_a, margin)
      per_line = factor*(1/(factor*rho_sum)) ! that reciprocal is computed anyway
      x = abs(h)*per_line
      y = abs(result%force)*per_line*(1/(pi*e_star))
      last = -y*(x*(x/12 + y*(11.0_wp/72)) + y**2*(3.0_wp/32))
      result%d_energy = width*abs(result%force)*(last - y*(0.5_wp + x/6 + y*(2.0_wp/9)))
      result%force = width*result%force
      result%d_h = width*result%d_h
      result%d_rho_a = width*(factor*result%d_rho_a)
      result%d_rho_b = result%d_rho_a
      result%excess = last*result%force
   end subroutine force_over_width

   !> Force per unit width from the penetration, with its derivatives. Equations L1, T40, T44, T45.
   !>
   !> Source: Kosenko & Gusev 2011, (13)-(14) through W_{-1}.   Valid: |h| < 4 rho/e**2, rho > 0.
   !> At h = 0 the derivative is 0, its (logarithmic) limit. No branches: outside the domain another value is computed and
   !> discarded.
   elemental subroutine johnson_force(h, rho_sum, e_star, force, d_h, d_rho, margin)
      real(wp), intent(in) :: h       !! penetration [m]; the force is odd in it
      real(wp), intent(in) :: rho_sum !! sum of the radii of curvature [m], > 0
      real(wp), intent(in) :: e_star  !! effective modulus [Pa], > 0
      real(wp), intent(out) :: force  !! N [N/m]; 0 on error
      real(wp), intent(out) :: d_h    !! dN/dh at constant rho_sum [N/m^2]; 0 on error
      real(wp), intent(out) :: d_rho  !! dN/d(rho_sum) at constant h [N/m^2]; 0 on error
      real(wp), intent(out) :: margin   !! positive where there is a force; not an integer, which is shorter: vectors would be too
      real(wp) :: ratio, excess, v, w_inverse

      ratio = (0.25_wp*abs(h))*(1/rho_sum)
      excess = -natural_logarithm(min(max(ratio, smallest_ratio), exp_minus_2)) - 2.0_wp
      ! one comparison at a time: without AVX, an .and. of two prevents vectorisation
      margin = merge(min(rho_sum, excess), 0.0_wp, ratio < exp_minus_2) ! also 0 for the last few numbers below the limit
      call lambert_w(max(excess, epsilon(excess)), v, w_inverse)
      force = merge(pi*e_star*h*w_inverse, 0.0_wp, margin > 0.0_wp)
      d_h = merge(merge(pi*e_star/v, 0.0_wp, margin > 0.0_wp), 0.0_wp, abs(h) > 0.0_wp)
      d_rho = sign(4.0_wp*ratio*d_h*w_inverse, -h)
   end subroutine johnson_force

   !> Penetration from the force per unit width. Equations L1, T38.
   !>
   !> Source: Kosenko & Gusev 2011, (13).   Valid: |N| < 4 pi E* rho/e**2, rho > 0
   elemental subroutine johnson_penetration(force, rho_sum, e_star, h, code)
      real(wp), intent(in) :: force   !! N [N/m]; the penetration is odd in it
      real(wp), intent(in) :: rho_sum !! sum of the radii of curvature [m], > 0
      real(wp), intent(in) :: e_star  !! effective modulus [Pa], > 0
      real(wp), intent(out) :: h      !! penetration [m]; 0 on error
      integer, intent(out) :: code    !! code_ok or code_out_of_domain
      real(wp) :: ratio

      h = 0.0_wp
      code = code_out_of_domain
      if (.not. (rho_sum > 0.0_wp .and. e_star > 0.0_wp)) return
      ratio = abs(force)/(4.0_wp*pi*e_star*rho_sum)
      if (.not. ratio < exp_minus_2) return
      code = code_ok
      h = force/(pi*e_star)*(-natural_logarithm(max(ratio, smallest_ratio)) - 1.0_wp)
   end subroutine johnson_penetration

   !> Elastic energy per unit width at penetration h, reached with r = rho_sum - h constant. Equation T46.
   !>
   !> In a mesh r is the length of the line of action, so dV = N dh along that path. With y = N/(pi E* rho_sum):
   !>
   !>    V = N h/2 - N**2/(4 pi E*) + y N h/6 - y N**2/(9 pi E*) + N (24 h**2 + 20 h y rho_sum - 27 (y rho_sum)**2) y/(576 rho_sum)
   !>
   !> The first two terms are the energy at constant radii. Each further order is minus the integral over h of the derivative
   !> of the previous one by rho_sum. The terms omitted are of the relative order (h/rho_sum)**3: below 1e-13 for
   !> h < 3e-4 rho_sum, which is beyond the strength of steel. `force_over_width` has the derivatives of this V, so that no energy
   !> is lost where it is relevant.
   !>
   !> It holds for each law N = pi E* h/w with w - ln w = ln(rho_sum/h) + constant: for Radzimovsky's as well.
   !>
   !> Source: integral of (13); the terms after the first two are derived here.   Valid: as johnson_force; even in h
   elemental real(wp) function johnson_energy(h, force, rho_sum, e_star) result(potential)
      real(wp), intent(in) :: h       !! penetration [m]
      real(wp), intent(in) :: force   !! N at |h| [N/m]
      real(wp), intent(in) :: rho_sum !! sum of the radii of curvature at h [m], > 0
      real(wp), intent(in) :: e_star  !! effective modulus [Pa], > 0
      real(wp) :: x, y

      x = abs(h)/rho_sum
      y = force/(pi*e_star*rho_sum)
      potential = force*rho_sum*((x/2 - y/4) + (x/6 - y/9)*y + (24*x**2 + (20*x - 27*y)*y)*y/576)
   end function johnson_energy

   !> Limit of the penetration, 4 rho/e**2 [m]; outside the model itself. Source: Kosenko & Gusev 2011, (15).
   elemental real(wp) function johnson_penetration_limit(rho_sum)
      real(wp), intent(in) :: rho_sum !! sum of the radii of curvature [m]

      johnson_penetration_limit = 4.0_wp*rho_sum*exp_minus_2
   end function johnson_penetration_limit

end module evl_johnson
