!> Forces of coupled tooth pairs: all pairs of one flank at once, per unit width.
!>
!> The forces N maximise the potential of the flank,
!>
!>    max over N of  sum_k N_k h_k - W(N),   W = sum_k N_k**2/(2 pi E*) [ln(4 pi E* Lambda_k/N_k) - 1/2] + 1/2 sum_kl C_kl N_k N_l
!>
!> that is
!>
!>    h_k = N_k/(pi E*) [ln(4 pi E* Lambda_k/N_k) - 1] + sum_l C_kl N_l
!>
!> for each loaded pair. With `pushes_only` a pair carries no load if the others open its gap,
!> g_k = h_k - sum_{l /= k} C_kl N_l <= 0. Otherwise N is continued as an odd function of g, so that a root can be approached from
!> both sides.
!>
!> `push_together` solves for pairs that all push; it also exists for eight states (evl_coupled_lanes). Otherwise Newton's method is
!> applied to the loaded pairs, starting from the forces of uncoupled pairs. At N = 0 the slope dh/dN is infinite: a pair whose
!> force would change its sign, or become nonzero, gets the force that corresponds to its g. If Newton's step does not halve the
!> residual, each pair in turn gets that force. Since W is convex, this alone would also converge, but slowly.
!>
!> Derivatives: with the matrix A = diag(dh_J/dN) + C of the loaded pairs, dN = A**-1 (dh - dC N - N/(pi E* Lambda) dLambda).
!> Lambda is the length of the line of action. It is the same for all pairs, except for the deviations of their flanks.
!>
!> No memory is allocated; at most `most_pairs` pairs.
module evl_coupled_pairs
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_compliant_johnson, only: compliant_contact, compliant_energy, largest_excess, smallest
   use evl_kinds, only: pi, wp
   use evl_status, only: code_no_solution, code_ok, code_out_of_domain, code_singular
   implicit none (type, external)
   private

   public :: coupled_solution, energy_of_pairs, force_change_of_pairs, most_pairs, near_end, overlaps, solve_pairs

   integer, parameter :: most_pairs = 6 !! on one flank

   integer, parameter :: width = 1 !! states evaluated at once by the included formulas

   integer, parameter :: most_turns = 200
   real(wp), parameter :: near = 1.0e-8_wp           !! a relative step of the force this small leaves an error of its square
   real(wp), parameter :: near_end = 1.0e-6_wp       !! with the third-order term such a step leaves a relative error of 1e-18
   real(wp), parameter :: rounding = 16*epsilon(near) !! a residual this small, relative to its terms, counts as zero

   !> Forces of all pairs, and the data for their derivatives.
   type :: coupled_solution
      integer :: n = 0
      real(wp) :: force(most_pairs) = 0.0_wp    !! N [N/m]
      logical :: carries(most_pairs) = .false.  !! whether the pair is loaded, so that Newton's method changes its force
      real(wp) :: factor(most_pairs, most_pairs) = 0.0_wp !! of A, from `factorise`; rows of unloaded pairs: unit matrix
      integer :: turns = 0                      !! number of iterations
   end type coupled_solution

contains

   include "contact/solver/coupled_contact_newton.inc"

   !> Solve for the forces. Equation F6.
   pure subroutine solve_pairs(n, h, length, c, e_star, pushes_only, solution, code)
      integer, intent(in) :: n                      !! pairs, at most `most_pairs`
      real(wp), intent(in) :: h(n)                  !! penetrations [m]
      real(wp), intent(in) :: length(n)             !! Lambda [m], > 0
      real(wp), intent(in) :: c(most_pairs, *)      !! deflection of pair k under a unit load on l, symmetric [1/Pa]
      real(wp), intent(in) :: e_star                !! effective modulus [Pa]
      logical, intent(in) :: pushes_only            !! no pair pulls; otherwise forces are odd functions
      type(coupled_solution), intent(out) :: solution
      integer, intent(out) :: code                  !! code_ok, code_out_of_domain, code_singular or code_no_solution
      real(wp) :: found(width)

      solution%n = n
      code = code_ok
      if (.not. (pushes_only .and. any(h <= 0))) then
         call push_together(n, h, length, c, e_star, solution%force, solution%factor, found)
         solution%carries(:n) = .true.
         if (found(1) > 0) then
            if (n > 1) call factor_at_forces(n, h, c, e_star, solution)
            return
         end if
      end if
      call search_pairs(n, h, length, c, e_star, pushes_only, solution, code)
   end subroutine solve_pairs

   !> Factorise A at the final forces, since the last step of Newton's method leaves the factor of the previous forces. With
   !> g_k = h_k - sum_{l /= k} C_kl N_l the slope of a pair is g_k/N_k - 1/(pi E*), which avoids a logarithm.
   pure subroutine factor_at_forces(n, h, c, e_star, solution)
      integer, intent(in) :: n
      real(wp), intent(in) :: h(n), c(most_pairs, *), e_star
      type(coupled_solution), intent(inout) :: solution
      real(wp) :: good(width)
      integer :: k

      do k = 1, n
         solution%factor(k, :k - 1) = c(k, :k - 1)
         solution%factor(k, k) = (h(k) - others(n, c, k, solution%force))/solution%force(k) - 1/(pi*e_star)
      end do
      good = 1
      call factorise(n, solution%factor, good)
   end subroutine factor_at_forces

   !> Solve for the forces when pairs may become loaded or unloaded.
   pure subroutine search_pairs(n, h, length, c, e_star, pushes_only, solution, code)
      integer, intent(in) :: n
      real(wp), intent(in) :: h(n), length(n), c(most_pairs, *), e_star
      logical, intent(in) :: pushes_only
      type(coupled_solution), intent(inout) :: solution
      integer, intent(out) :: code
      real(wp), dimension(most_pairs) :: residual, scale, step, trial
      real(wp) :: good(width), least, size_of
      logical :: definite, done, same_sign
      integer :: k, turn

      code = code_ok
      do k = 1, n
         call pair_force(h(k), length(k), c(k, k), e_star, pushes_only, solution%force(k), code)
         if (code /= code_ok) return
      end do
      least = huge(least)
      definite = .true.
      do turn = 1, most_turns
         solution%turns = turn
         call look(n, h, length, c, e_star, pushes_only, solution, residual, scale, code)
         if (code /= code_ok) return
         good = 1
         call factorise(n, solution%factor, good)
         size_of = sum(abs(residual(:n)))
         if (good(1) > 0 .and. size_of <= least/2) then
            least = size_of
            step(:n) = residual(:n)
            call solve(n, solution, step)
            done = .true.
            trial(:n) = solution%force(:n) + step(:n)
            do k = 1, n
               same_sign = solution%carries(k) .and. trial(k)*solution%force(k) > 0
               if (.not. same_sign) then
                  call pair_force(h(k) - others(n, c, k, trial), length(k), c(k, k), e_star, pushes_only, trial(k), code)
                  if (code /= code_ok) return
                  step(k) = trial(k) - solution%force(k)
               end if
               if (same_sign .and. abs(step(k)) <= near*abs(trial(k))) cycle
               done = done .and. c(k, k)*abs(step(k)) <= rounding*scale(k)
            end do
            solution%force(:n) = trial(:n)
            if (done) return
         else
            if (all(abs(residual(:n)) <= rounding*scale(:n))) return ! Newton's method has converged to rounding
            definite = good(1) > 0
            do k = 1, n
               call pair_force(h(k) - others(n, c, k, solution%force), length(k), c(k, k), e_star, pushes_only, solution%force(k), &
                               code)
               if (code /= code_ok) return
            end do
         end if
      end do
      code = merge(code_no_solution, code_singular, definite)
   end subroutine search_pairs

   !> Residual of the equations at the present forces, and the matrix A of the loaded pairs. Equation F6.
   pure subroutine look(n, h, length, c, e_star, pushes_only, solution, residual, scale, code)
      integer, intent(in) :: n
      real(wp), intent(in) :: h(n), length(n), c(most_pairs, *), e_star
      logical, intent(in) :: pushes_only
      type(coupled_solution), intent(inout) :: solution
      real(wp), intent(out) :: residual(most_pairs) !! [m]
      real(wp), intent(out) :: scale(most_pairs)    !! magnitude of the terms that cancel in it [m]
      integer, intent(out) :: code
      real(wp) :: apart, slope, own
      integer :: k

      code = code_ok
      do k = 1, n
         apart = others(n, c, k, solution%force)
         scale(k) = abs(h(k)) + abs(apart)
         solution%carries(k) = abs(solution%force(k)) > 0
         solution%factor(k, :n) = 0
         if (solution%carries(k)) then
            call compliant_penetration(solution%force(k), length(k), c(k, k), e_star, own, slope, code)
            if (code /= code_ok) return
            residual(k) = h(k) - apart - own
            where (solution%carries(:k - 1)) solution%factor(k, :k - 1) = c(k, :k - 1)
            solution%factor(k, k) = slope
         else
            residual(k) = h(k) - apart
            if (pushes_only) residual(k) = max(residual(k), 0.0_wp)
            solution%factor(k, k) = 1
         end if
      end do
   end subroutine look

   !> Force of a single pair with overlap g.
   pure subroutine pair_force(g, length, c, e_star, pushes_only, force, code)
      real(wp), intent(in) :: g, length, c, e_star
      logical, intent(in) :: pushes_only
      real(wp), intent(out) :: force
      integer, intent(out) :: code
      type(compliant_contact) :: contact

      force = 0
      code = code_ok
      if (pushes_only .and. g <= 0) return
      call compliant_force(g, length, c, e_star, contact, code)
      force = contact%force
   end subroutine pair_force

   !> Gap of one pair opened by the other pairs [m]. Equation F6.
   pure real(wp) function others(n, c, k, force)
      integer, intent(in) :: n, k
      real(wp), intent(in) :: c(most_pairs, *), force(n)
      integer :: l

      others = 0
      do l = 1, n
         if (l /= k) others = others + c(k, l)*force(l)
      end do
   end function others

   !> Penetrations less the gaps opened by the other pairs: g_k, the root functions of closing and opening [m]. Equation F6.
   pure subroutine overlaps(n, h, c, solution, g)
      integer, intent(in) :: n
      real(wp), intent(in) :: h(n), c(most_pairs, *)
      type(coupled_solution), intent(in) :: solution
      real(wp), intent(out) :: g(n)
      integer :: k

      do k = 1, n
         g(k) = h(k) - others(n, c, k, solution%force)
      end do
   end subroutine overlaps

   !> Changes of the forces. In: dh - dC N; out: dN, both per pair; 0 for unloaded pairs. Equation F8.
   pure subroutine force_change_of_pairs(solution, length, e_star, d_length, change)
      type(coupled_solution), intent(in) :: solution
      real(wp), intent(in) :: length(*), e_star
      real(wp), intent(in) :: d_length(*)  !! change of Lambda
      real(wp), intent(inout) :: change(*) !! [n]

      associate (n => solution%n)
         change(:n) = change(:n) - solution%force(:n)*(d_length(:n)/(pi*e_star*length(:n)))
         call solve(n, solution, change)
      end associate
   end subroutine force_change_of_pairs

   !> Elastic energy per unit width, sum N_k h_k - W = sum_k [N_k h_k/2 - N_k**2/(4 pi E*)], including that of the bodies [J/m].
   !> Equation F5.
   pure real(wp) function energy_of_pairs(solution, h, e_star) result(energy)
      type(coupled_solution), intent(in) :: solution
      real(wp), intent(in) :: h(*) !! [n], [m]
      real(wp), intent(in) :: e_star

      energy = sum(compliant_energy(h(:solution%n), solution%force(:solution%n), e_star))
   end function energy_of_pairs

   !> Solve A x = b for the loaded pairs; 0 for the others.
   pure subroutine solve(n, solution, x)
      integer, intent(in) :: n
      type(coupled_solution), intent(in) :: solution
      real(wp), intent(inout) :: x(*) !! b, then the solution

      where (.not. solution%carries(:n)) x(:n) = 0
      call solve_factorised(n, solution%factor, x)
   end subroutine solve

end module evl_coupled_pairs
