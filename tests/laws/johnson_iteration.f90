!> Johnson's force by the iteration of the paper, and the limits of the force: what the kernel's force is compared with.
module johnson_iteration_of_paper
   use evl_elementary, only: natural_logarithm
   use evl_johnson, only: johnson_penetration_limit
   use evl_kinds, only: pi, wp
   use evl_status, only: code_no_solution, code_ok, code_out_of_domain
   implicit none (type, external)
   private

   public :: johnson_force_limit, johnson_iteration, johnson_iteration_force

contains

   !> Largest force per unit width of the model, 4 pi E* rho/e**2 [N/m]. Source: Kosenko & Gusev 2011, (15).
   elemental real(wp) function johnson_force_limit(rho_sum, e_star)
      real(wp), intent(in) :: rho_sum !! sum of the radii of curvature [m]
      real(wp), intent(in) :: e_star  !! effective modulus [Pa]

      johnson_force_limit = 4.0_wp*pi*e_star*rho_sum*exp(-2.0_wp)
   end function johnson_force_limit

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

end module johnson_iteration_of_paper
