!> Normal elastic force between two cylinders after Johnson, per unit width.
!>
!> With rho the sum of the radii of curvature, e = 2.718... and w > 1:
!>
!>    h = N/(pi E*) [ln(4 pi E* rho/N) - 1]                                (13)
!>    N = pi E* h/w,   w - ln w = ell = -ln(x),   x = e h/(4 rho)          (14), w = -W_{-1}(-x)
!>    h < 4 rho/e**2,  N < 4 pi E* rho/e**2                                (15)
!>
!> Past the limits (15) the model has no solution; that is reported and never clamped. Forces and penetrations are
!> continued as odd functions to negative arguments, so that a root of either can be located from both sides of zero.
!>
!> Sources: K. L. Johnson, Contact Mechanics, 1985, section 5.6; I. Kosenko, I. Gusev, Implementation of the spur
!> involute gear model on Modelica, 8th Modelica Conference, 2011, (13)-(18).
module evl_johnson
   use evl_elementary, only: natural_logarithm
   use evl_kinds, only: pi, wp
   use evl_law_info, only: law_info_t
   use evl_status, only: code_no_solution, code_ok, code_out_of_domain, quantity
   implicit none (type, external)
   private

   public :: johnson_force, johnson_force_limit, johnson_iteration, johnson_iteration_force, johnson_law
   public :: exp_minus_2, smallest_ratio
   public :: johnson_energy, johnson_limit_message, johnson_penetration, johnson_penetration_limit

   real(wp), parameter :: exp_minus_2 = 0.13533528323661269189399949497248_wp !! e**(-2)

   !> Smallest h/(4 rho), and N/(4 pi E* rho), whose logarithm is taken. Below it N is linear in h, which is within
   !> 1.5 % down to the smallest number there is, and saves underflow and ln(0).
   real(wp), parameter :: smallest_ratio = 1.0e-301_wp

contains

   include "laws/johnson.inc"

   !> Penetration from the force per unit width.
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

   !> Elastic energy per unit width at penetration h, reached with r = rho_sum - h constant.
   !>
   !> In a mesh r is the length of the line of action, so dV = N dh along that path. With y = N/(pi E* rho_sum):
   !>
   !>    V = N h/2 - N**2/(4 pi E*) + y N h/6 - y N**2/(9 pi E*) + N (24 h**2 + 20 h y rho_sum - 27 (y rho_sum)**2) y/(576 rho_sum)
   !>
   !> The first two terms are the energy at constant radii; of the further orders each is minus the integral over h of the
   !> derivative of the one before it to rho_sum. What is left out is of the relative order (h/rho_sum)**3: below 1e-13 for
   !> h < 3e-4 rho_sum, past what steel bears. `spread_over_width` has the derivatives of this V, so that no energy is lost
   !> where it matters.
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

   !> Largest penetration of the model, 4 rho/e**2 [m]; itself outside. Source: Kosenko & Gusev 2011, (15).
   elemental real(wp) function johnson_penetration_limit(rho_sum)
      real(wp), intent(in) :: rho_sum !! sum of the radii of curvature [m]

      johnson_penetration_limit = 4.0_wp*rho_sum*exp_minus_2
   end function johnson_penetration_limit

   !> Largest force per unit width of the model, 4 pi E* rho/e**2 [N/m]. Source: Kosenko & Gusev 2011, (15).
   elemental real(wp) function johnson_force_limit(rho_sum, e_star)
      real(wp), intent(in) :: rho_sum !! sum of the radii of curvature [m]
      real(wp), intent(in) :: e_star  !! effective modulus [Pa]

      johnson_force_limit = 4.0_wp*pi*e_star*rho_sum*exp_minus_2
   end function johnson_force_limit

   !> Why johnson_force refuses h, as one sentence.
   pure subroutine johnson_limit_message(h, rho_sum, message)
      real(wp), intent(in) :: h                 !! penetration [m]
      real(wp), intent(in) :: rho_sum           !! sum of the radii of curvature [m]
      character(len=*), intent(out) :: message  !! truncated to its length

      if (.not. rho_sum > 0.0_wp) then
         message = "rho_A + rho_B = "//quantity(rho_sum, "m")//" is not positive, as the Johnson force needs"
      else
         message = "penetration h = "//quantity(h, "m")//" exceeds the limit 4 (rho_A + rho_B)/e^2 = " &
                   //quantity(johnson_penetration_limit(rho_sum), "m")//" of the Johnson force, eq. (15)"
      end if
   end subroutine johnson_limit_message

   !> One turn of the paper's iteration: eta_{n+1} = nu (1 + eta_n ln eta_n), N = 4 pi E* rho x eta/e.
   !>
   !> Source: Kosenko & Gusev 2011, (18).   Valid: 0 < eta <= 1/e, nu = -1/ln x, 0 < x < 1/e
   elemental real(wp) function johnson_iteration(eta, nu)
      real(wp), intent(in) :: eta !! the present value
      real(wp), intent(in) :: nu  !! -1/ln x

      johnson_iteration = nu*(1.0_wp + eta*natural_logarithm(eta))
   end function johnson_iteration

   !> Force per unit width by the paper's iteration (18), the slow way and independent of johnson_force.
   !>
   !> It stops when a turn changes eta by less than `tolerance` times eta. Near the limit (15) the contraction tends to
   !> 1 and the turns grow without bound.
   !>
   !> Source: Kosenko & Gusev 2011, (14), (17), (18).   Valid: 0 < h < 4 rho/e**2, 0 < start < 1/e
   elemental subroutine johnson_iteration_force(h, rho_sum, e_star, start, tolerance, max_turns, force, turns, code)
      real(wp), intent(in) :: h         !! penetration [m], > 0
      real(wp), intent(in) :: rho_sum   !! sum of the radii of curvature [m], > 0
      real(wp), intent(in) :: e_star    !! effective modulus [Pa], > 0
      real(wp), intent(in) :: start     !! eta_0, in (0, 1/e)
      real(wp), intent(in) :: tolerance !! relative change of eta that ends the iteration
      integer, intent(in) :: max_turns  !! give up after so many
      real(wp), intent(out) :: force    !! N [N/m]; 0 on error
      integer, intent(out) :: turns     !! turns made
      integer, intent(out) :: code      !! code_ok, code_out_of_domain, or code_no_solution if max_turns did not do
      real(wp) :: x, nu, eta, next

      force = 0.0_wp
      turns = 0
      code = code_out_of_domain
      if (.not. (h > 0.0_wp .and. h < johnson_penetration_limit(rho_sum))) return
      if (.not. (start > 0.0_wp .and. start < exp(-1.0_wp))) return
      x = exp(1.0_wp)*h/(4.0_wp*rho_sum)
      if (.not. x > 0.0_wp) return
      nu = -1.0_wp/natural_logarithm(x)
      eta = start
      next = start
      code = code_no_solution
      do turns = 1, max_turns
         next = johnson_iteration(eta, nu)
         if (abs(next - eta) <= tolerance*next) exit
         eta = next
      end do
      if (turns > max_turns) then
         turns = max_turns
         return
      end if
      code = code_ok
      force = 4.0_wp*pi*e_star*rho_sum*exp(-1.0_wp)*x*next
   end subroutine johnson_iteration_force

   !> The entry of the law table.
   pure type(law_info_t) function johnson_law() result(info)

      info%name = "johnson"
      info%description = "two elastic cylinders, their approach measured between the centres of curvature"
      info%source = "Johnson 1985, section 5.6; Kosenko & Gusev 2011, (13)-(18)"
   end function johnson_law

end module evl_johnson
