!> Analytic compliance c of a tooth: a beam with the actual outline, on a ring fixed at the hub, plus the local contact term.
!>
!> The load at the radius of curvature rho makes the angle tau with the tooth's cross direction. (x_F, y_F) is the loaded point, 2x
!> the thickness at the height y, S_f = 2 r_f theta_f the arc of the root under the tooth, u = y_F - x_F tan tau - r_f. The
!> integrals run from the root, y = r_f cos theta_f, to y_F. With E' and nu' of the plane state, and E = 1:
!>
!>    c = 1/E' int 12 [cos tau (y_F - y) - x_F sin tau]^2/(2x)^3 dy + 1.2 int 2 (1+nu) cos^2 tau/(2x) dy
!>      + 1/E' int sin^2 tau/(2x) dy
!>      + 1/E' cos^2 tau [L (u/S_f)^2 + M u/S_f + P (1 + Q tan^2 tau)] + K [ln(x_F/(2 rho cos tau)) + 1/2 - nu'/(2 (1 - nu'))]
!>
!> The last term is the contact deflection down to the middle of the tooth, in place of Johnson's cylinder. L .. Q are Sainsot's for
!> a ring. Coupling of two loaded teeth through the ring is not included.
!>
!> Sources: Weber & Banaschek 1953; Sainsot, Velex, Duverger, J. Mech. Des. 126 (2004) 748.
module evl_analytic_compliance
   use evl_chebyshev, only: chebyshev_points
   use evl_influence_functions, only: n_own
   use evl_kinds, only: pi, wp
   use evl_lobatto, only: lobatto_rule
   use evl_plane_element, only: elasticity_t
   use evl_tooth_outline, only: fillet_point, involute_curvature, involute_point, tooth_outline_t
   implicit none (type, external)
   private

   public :: analytic_samples, is_in_range

   real(wp), parameter :: from_ends = 0.06_wp !! distance from the ends of the involute, arc [modules]
   integer, parameter :: order = 16           !! of the quadrature

   ! A .. F of L, M, P, Q = A/theta_f^2 + B h^2 + C h/theta_f + D/theta_f + E h + F
   real(wp), parameter :: sainsot(6, 4) = reshape([ &
                                                  -5.574e-5_wp, -1.9986e-3_wp, -2.3015e-4_wp, 4.7702e-3_wp, 0.0271_wp, 6.8045_wp, &
                                                  60.111e-5_wp, 28.100e-3_wp, -83.431e-4_wp, -9.9256e-3_wp, 0.1624_wp, 0.9086_wp, &
                                                  -50.952e-5_wp, 185.50e-3_wp, 0.0538e-4_wp, 53.300e-3_wp, 0.2895_wp, 0.9236_wp, &
                                           -6.2042e-5_wp, 9.0889e-3_wp, -4.0964e-4_wp, 7.8297e-3_wp, -0.1472_wp, 0.6904_wp], [6, 4])
   real(wp), parameter, public :: ring_range(2) = [1.4_wp, 7.0_wp]     !! of h = r_f/r_hub
   real(wp), parameter, public :: root_range(2) = [0.01_wp, 0.12_wp]   !! of theta_f [rad]

contains

   !> Whether a wheel is in the range to which the formula of the ring was fitted.
   pure logical function is_in_range(outline, hub_radius)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: hub_radius !! in modules

      associate (h => outline%root_radius/hub_radius, theta => outline%root_angle)
         is_in_range = h >= ring_range(1) .and. h <= ring_range(2) .and. theta >= root_range(1) .and. theta <= root_range(2)
      end associate
   end function is_in_range

   !> E c at the Chebyshev points of a flank, in modules.
   pure subroutine analytic_samples(outline, hub_radius, law, rho, c)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: hub_radius !! in modules
      type(elasticity_t), intent(in) :: law
      real(wp), intent(out) :: rho(0:n_own), c(0:n_own)
      real(wp) :: inset
      integer :: i

      inset = min(from_ends, (outline%s_tip - outline%s_form)/8)
      rho = chebyshev_points(n_own, involute_curvature(outline, outline%s_form + inset), &
                             involute_curvature(outline, outline%s_tip - inset))
      do i = 0, n_own
         c(i) = analytic(outline, hub_radius, law, rho(i))
      end do
   end subroutine analytic_samples

   !> E c at one position. Equation C4.
   pure real(wp) function analytic(outline, hub_radius, law, rho) result(c)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: hub_radius, rho !! in modules
      type(elasticity_t), intent(in) :: law
      real(wp) :: x(0:order), w(0:order), d(0:order, 0:order), outer(2, 0:order), loaded(2), tau, s_f, u, l(4), k, sideways
      integer :: i

      call lobatto_rule(x, w, d)
      loaded = involute_point(outline, rho)
      tau = rho/outline%base_radius - outline%half_tooth
      c = 0
      do i = 0, order
         outer(:, i) = fillet_point(outline, outline%fillet_start*(1 + x(i))/2)
      end do
      c = c + part_of_beam()
      do i = 0, order
         outer(:, i) = involute_point(outline, outline%rho_form + (rho - outline%rho_form)*(1 + x(i))/2)
      end do
      c = c + part_of_beam()
      associate (theta => outline%root_angle, h => outline%root_radius/hub_radius)
         do i = 1, 4
            l(i) = dot_product(sainsot(:, i), [1/theta**2, h**2, h/theta, 1/theta, h, 1.0_wp])
         end do
         s_f = 2*outline%root_radius*theta
      end associate
      u = (loaded(1) - loaded(2)*tan(tau) - outline%root_radius)/s_f
      k = 2/(pi*law%plane_modulus)
      sideways = law%across/law%direct ! nu/(1 - nu)
      c = c + cos(tau)**2/law%plane_modulus*(l(1)*u**2 + l(2)*u + l(3)*(1 + l(4)*tan(tau)**2)) &
          + k*(log(loaded(2)/(2*rho*cos(tau))) + 0.5_wp - sideways/2)

   contains

      !> Contribution of the beam between two points of the outline. Equation C4.
      pure real(wp) function part_of_beam() result(part)
         real(wp) :: dy, thickness, arm
         integer :: k

         part = 0
         do k = 0, order
            dy = dot_product(d(k, :), outer(1, :))*w(k)
            thickness = 2*outer(2, k)
            arm = cos(tau)*(loaded(1) - outer(1, k)) - loaded(2)*sin(tau)
            part = part + dy*(12*arm**2/thickness**3/law%plane_modulus + 1.2_wp*cos(tau)**2/(law%shear*thickness) &
                              + sin(tau)**2/thickness/law%plane_modulus)
         end do
      end function part_of_beam

   end function analytic

end module evl_analytic_compliance
