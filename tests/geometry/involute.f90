!> The involute flank as an implicit curve: f(x, y) = 0 on the flank, f < 0 in the material.
!>
!> In the wheel's own frame, x axis through the root of the involute, R and theta polar, s = sqrt(R**2 - r_b**2):
!>
!>    f = s/r_b - acos(r_b/R) - hand theta                                  (4)-(6)
!>
!> hand = +1 is the involute that unwinds counterclockwise, -1 its mirror image. r_b f is the signed distance from the
!> flank, so |grad f| = 1/r_b everywhere outside the base circle and the gradient points out of the tooth. Gradient and
!> Hessian are the same for every tooth; f is that of the tooth whose root lies on the x axis, for theta in (-pi, pi].
!>
!> Source: I. Kosenko, I. Gusev, Implementation of the spur involute gear model on Modelica, 2011, (4)-(12).
module involute
   use evl_kinds, only: wp
   use evl_status, only: code_ok, code_out_of_domain
   implicit none (type, external)
   private

   public :: involute_flank, involute_flank_housing, involute_flank_polar, involute_point

contains

   !> f, gradient and Hessian in the wheel's frame, the short way: Hess f = tau tau^T/(r_b s), tau the unit tangent.
   !>
   !> Source: Kosenko & Gusev 2011, (4)-(12), simplified here.   Valid: R > r_b
   pure subroutine involute_flank(point, base_radius, hand, value, gradient, hessian, code)
      real(wp), intent(in) :: point(2)       !! x, y in the wheel's frame [m]
      real(wp), intent(in) :: base_radius    !! r_b [m], > 0
      integer, intent(in) :: hand            !! +1 counterclockwise, -1 clockwise involute
      real(wp), intent(out) :: value         !! f; 0 on error
      real(wp), intent(out) :: gradient(2)   !! [1/m]; 0 on error
      real(wp), intent(out) :: hessian(2, 2) !! [1/m^2]; 0 on error
      integer, intent(out) :: code           !! code_ok, or code_out_of_domain inside the base circle
      real(wp) :: radius, s, roll

      value = 0.0_wp
      gradient = 0.0_wp
      hessian = 0.0_wp
      code = code_out_of_domain
      radius = norm2(point)
      if (.not. radius > base_radius) return
      code = code_ok
      s = sqrt((radius - base_radius)*(radius + base_radius))
      roll = s/base_radius
      value = roll - atan(roll) - hand*atan2(point(2), point(1))
      gradient = (roll*point + hand*[point(2), -point(1)])/radius**2
      associate (tangent => base_radius*[-gradient(2), gradient(1)])
         hessian = spread(tangent, 2, 2)*spread(tangent, 1, 2)/(base_radius*s)
      end associate
   end subroutine involute_flank

   !> The same through the Jacobian of polar coordinates, as the paper writes it; slower, to check the short way.
   !>
   !> Source: Kosenko & Gusev 2011, (4)-(12).   Valid: R > r_b
   pure subroutine involute_flank_polar(point, base_radius, hand, value, gradient, hessian, code)
      real(wp), intent(in) :: point(2)       !! x, y in the wheel's frame [m]
      real(wp), intent(in) :: base_radius    !! r_b [m], > 0
      integer, intent(in) :: hand            !! +1 counterclockwise, -1 clockwise involute
      real(wp), intent(out) :: value         !! f; 0 on error
      real(wp), intent(out) :: gradient(2)   !! [1/m]; 0 on error
      real(wp), intent(out) :: hessian(2, 2) !! [1/m^2]; 0 on error
      integer, intent(out) :: code           !! code_ok, or code_out_of_domain inside the base circle
      real(wp) :: radius, theta, s, inverse(2, 2), polar(2, 2), x_polar(2, 2), y_polar(2, 2)

      value = 0.0_wp
      gradient = 0.0_wp
      hessian = 0.0_wp
      code = code_out_of_domain
      radius = norm2(point)
      if (.not. radius > base_radius) return
      code = code_ok
      theta = atan2(hand*point(2), point(1)) ! of the mirror image if hand = -1
      s = sqrt(radius**2 - base_radius**2)
      value = s/base_radius - acos(base_radius/radius) - theta
      associate (c => cos(theta), d => sin(theta))
         inverse = reshape([c, -d/radius, d, c/radius], [2, 2]) ! d(R, theta)/d(x, y)
         x_polar = reshape([0.0_wp, -d, -d, -radius*c], [2, 2])
         y_polar = reshape([0.0_wp, c, c, -radius*d], [2, 2])
      end associate
      gradient = matmul([s/(base_radius*radius), -1.0_wp], inverse)
      polar = reshape([base_radius/(radius**2*s), 0.0_wp, 0.0_wp, 0.0_wp], [2, 2])
      hessian = matmul(transpose(inverse), matmul(polar - gradient(1)*x_polar - gradient(2)*y_polar, inverse))
      gradient(2) = hand*gradient(2)
      hessian(1, 2) = hand*hessian(1, 2)
      hessian(2, 1) = hand*hessian(2, 1)
   end subroutine involute_flank_polar

   !> f, gradient and Hessian in the housing frame: g(r) = f(T^T (r - r_O)), T the rotation by `angle`.
   !>
   !> Source: Kosenko & Gusev 2011, section 3.   Valid: |r - r_O| > r_b
   pure subroutine involute_flank_housing(point, centre, angle, base_radius, hand, value, gradient, hessian, code)
      real(wp), intent(in) :: point(2)       !! r, in the housing frame [m]
      real(wp), intent(in) :: centre(2)      !! r_O, centre of the wheel in the housing frame [m]
      real(wp), intent(in) :: angle          !! of the involute's root to the housing's x axis [rad]
      real(wp), intent(in) :: base_radius    !! r_b [m], > 0
      integer, intent(in) :: hand            !! +1 counterclockwise, -1 clockwise involute
      real(wp), intent(out) :: value         !! g; 0 on error
      real(wp), intent(out) :: gradient(2)   !! in the housing frame [1/m]; 0 on error
      real(wp), intent(out) :: hessian(2, 2) !! in the housing frame [1/m^2]; 0 on error
      integer, intent(out) :: code           !! code_ok, or code_out_of_domain inside the base circle
      real(wp) :: rotation(2, 2)

      rotation = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
      call involute_flank(matmul(point - centre, rotation), base_radius, hand, value, gradient, hessian, code)
      gradient = matmul(rotation, gradient)
      hessian = matmul(rotation, matmul(hessian, transpose(rotation)))
   end subroutine involute_flank_housing

   !> Point of the flank at a roll angle, in the wheel's frame. Its radius of curvature is r_b xi.
   pure function involute_point(roll_angle, base_radius, hand) result(point)
      real(wp), intent(in) :: roll_angle  !! xi [rad], >= 0; 0 is the root on the base circle
      real(wp), intent(in) :: base_radius !! r_b [m], > 0
      integer, intent(in) :: hand         !! +1 counterclockwise, -1 clockwise involute
      real(wp) :: point(2)                !! x, y in the wheel's frame [m]

      point(1) = base_radius*(cos(roll_angle) + roll_angle*sin(roll_angle))
      point(2) = hand*base_radius*(sin(roll_angle) - roll_angle*cos(roll_angle))
   end function involute_point

end module involute
