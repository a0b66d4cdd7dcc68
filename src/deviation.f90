!> Where a point lies relative to the tangents of a circle.
!>
!> A point near r_b t_0 + rho_0 e_0 lies on a line that touches the circle of radius r_b; the line is turned from e_0 by `angle`,
!> and the point lies `rho` from where it touches. With the base circle of a wheel this gives the normal and the radius of
!> curvature of the involute through a point; with the sum of both base radii it gives the line of action at any centre distance.
module evl_deviation
   use evl_kinds, only: wp
   use evl_local_variables, only: n_local
   implicit none (type, external)
   private

   public :: deviation, deviation_find, deviation_gradients, versine

   !> Where a point lies relative to a circle's tangents, see `deviation_find`.
   type :: deviation
      logical :: exists   !! false if the point lies inside the circle
      real(wp) :: d_rho   !! rho - rho_0 [m]
      real(wp) :: rho     !! distance from the point of tangency [m]
      real(wp) :: angle   !! from e_0 to e, such that t = cos t_0 + sin e_0, e = -sin t_0 + cos e_0 [rad]
      real(wp) :: s, c    !! sine and cosine of `angle`
   end type deviation

contains

   !> Tangent to a circle of radius r_b through the point (r_b + a_t, rho_0 + a_e).
   !>
   !> Valid: rho_0 > 0 and the point outside the circle. Written without cancellation: rho - rho_0 and the angle keep full relative
   !> precision in a. Derivatives: d angle = -(da.t + s drho_0)/rho, d rho = da.e + c drho_0 - r_b d angle, hence
   !> d(rho - rho_0 + r_b angle) = da.e + (c-1) drho_0.
   pure subroutine deviation_find(r_b, rho_0, a_t, a_e, found)
      real(wp), intent(in) :: r_b      !! radius of the circle [m]
      real(wp), intent(in) :: rho_0    !! nominal distance from the point of tangency [m]
      real(wp), intent(in) :: a_t, a_e !! deviation from the nominal point [m]
      type(deviation), intent(out) :: found
      real(wp) :: change, radicand, y, radius2, s2

      change = a_t*(2*r_b + a_t) + a_e*(2*rho_0 + a_e)
      radicand = rho_0**2 + change
      y = rho_0 + a_e
      found%exists = radicand > 0 .and. rho_0 > 0 .and. y > 0
      if (.not. found%exists) then
         found%d_rho = 0
         found%rho = rho_0
         found%angle = 0
         found%s = 0
         found%c = 1
         return
      end if
      found%rho = sqrt(radicand)
      found%d_rho = change/(found%rho + rho_0)
      radius2 = r_b**2 + radicand
      found%s = -a_t*(r_b*(2*r_b + a_t)/(found%rho + y) + found%rho)/radius2
      found%c = (r_b*(r_b + a_t) + found%rho*y)/radius2
      s2 = found%s**2
      if (s2 < 1.0e-4_wp) then ! the series of asin: next term 2e-22 relative
         found%angle = found%s*(1 + s2*(1/6.0_wp + s2*(3/40.0_wp + s2*(15/336.0_wp + s2*(105/3456.0_wp)))))
      else
         found%angle = atan2(found%s, found%c)
      end if
   end subroutine deviation_find

   !> 1 - cos of a deviation's angle, without cancellation.
   pure real(wp) function versine(found)
      type(deviation), intent(in) :: found

      versine = found%s**2/(1 + found%c)
   end function versine

   !> Derivatives of a deviation: of its angle, and of rho - rho_0 + r_b angle.
   pure subroutine deviation_gradients(on, position, rho_0, angle, distance)
      type(deviation), intent(in) :: on
      real(wp), intent(in) :: position(n_local, 2), rho_0(n_local) !! derivatives of the point and of the nominal distance
      real(wp), intent(out) :: angle(n_local), distance(n_local)

      angle = -(position(:, 1)*on%c + (position(:, 2) + rho_0)*on%s)/on%rho
      distance = -position(:, 1)*on%s + position(:, 2)*on%c - versine(on)*rho_0
   end subroutine deviation_gradients

end module evl_deviation
