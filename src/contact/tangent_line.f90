!> Position of a point relative to the tangents of a circle.
!>
!> A point near r_b t_0 + rho_0 e_0 lies on a line tangent to the circle of radius r_b. The line is rotated from e_0 by `angle`, and
!> the point is at the distance `rho` from the point of tangency. With the base circle of a wheel this gives the normal and the
!> radius of curvature of the involute through a point. With the sum of both base radii it gives the line of action at any centre
!> distance.
module evl_tangent_line
   use evl_kinds, only: wp
   use evl_local_variables, only: n_local
   implicit none (type, external)
   private

   public :: find_tangent_line, tangent_line_gradients, small_sine, tangent_angle, tangent_line_t, versine

   real(wp), parameter :: small_sine = 1.0e-2_wp !! below this value an angle is computed from a series

   !> Position of a point relative to the tangents of a circle, see `find_tangent_line`.
   type :: tangent_line_t
      logical :: exists   !! false if the point lies inside the circle
      real(wp) :: d_rho   !! rho - rho_0 [m]
      real(wp) :: rho     !! distance from the point of tangency [m]
      real(wp) :: angle   !! from e_0 to e, such that t = cos t_0 + sin e_0, e = -sin t_0 + cos e_0 [rad]
      real(wp) :: s, c    !! sine and cosine of `angle`
   end type tangent_line_t

contains

   include "contact/tangent_line.inc"
   include "contact/small_angle.inc"

   !> Tangent to a circle of radius r_b through the point (r_b + a_t, rho_0 + a_e), and its angle: see `tangent_line`.
   pure subroutine find_tangent_line(r_b, rho_0, a_t, a_e, found)
      real(wp), intent(in) :: r_b      !! radius of the circle [m]
      real(wp), intent(in) :: rho_0    !! nominal distance from the point of tangency [m]
      real(wp), intent(in) :: a_t, a_e !! deviation from the nominal point [m]
      type(tangent_line_t), intent(out) :: found
      real(wp) :: margin

      call tangent_line(r_b, rho_0, a_t, a_e, margin, found%d_rho, found%rho, found%s, found%c)
      found%exists = margin > 0
      if (.not. found%exists) then
         found%d_rho = 0
         found%rho = rho_0
         found%angle = 0
         found%s = 0
         found%c = 1
      else
         found%angle = tangent_angle(found%s, found%c)
      end if
   end subroutine find_tangent_line

   !> Angle from its sine and cosine [rad].
   elemental real(wp) function tangent_angle(s, c) result(angle)
      real(wp), intent(in) :: s, c

      if (abs(s) < small_sine) then
         angle = small_angle(s)
      else
         angle = atan2(s, c)
      end if
   end function tangent_angle

   !> 1 - cos of the angle of a tangent line, without cancellation.
   pure real(wp) function versine(found)
      type(tangent_line_t), intent(in) :: found

      versine = found%s**2/(1 + found%c)
   end function versine

   !> Derivatives of the angle of a tangent line, and of rho - rho_0 + r_b angle.
   pure subroutine tangent_line_gradients(on, position, rho_0, angle, distance)
      type(tangent_line_t), intent(in) :: on
      real(wp), intent(in) :: position(n_local, 2), rho_0(n_local) !! derivatives of the point and of the nominal distance
      real(wp), intent(out) :: angle(n_local), distance(n_local)

      angle = -(position(:, 1)*on%c + (position(:, 2) + rho_0)*on%s)/on%rho
      distance = -position(:, 1)*on%s + position(:, 2)*on%c - versine(on)*rho_0
   end subroutine tangent_line_gradients

end module evl_tangent_line
