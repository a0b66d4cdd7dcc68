!> Normal elastic forces that are a power of the penetration, over the whole width.
!>
!> All are odd in h, like every elastic force. None depends on the radii of curvature, and none has a limit of its own.
module evl_springs
   use evl_elementary, only: real_power
   use evl_kinds, only: pi, wp
   use evl_law_info, only: law_info_t, law_parameter
   implicit none (type, external)
   private

   public :: linear_spring, linear_spring_law
   public :: power_penetration, power_spring, power_spring_law
   public :: yang_lin_law, yang_lin_stiffness

contains

   include "laws/springs.inc"

   !> k = pi E* b/2, the stiffness of two cylinders whose pressure is spread over the strip of contact.
   !>
   !> Source: D. C. H. Yang, J. Y. Lin, Hertzian damping, tooth friction and bending elasticity in gear impact dynamics,
   !> ASME J. Mech. Transm. Autom. Des. 109 (1987) 189: pi E b/(4 (1 - nu**2)) for two wheels of the same material.
   elemental real(wp) function yang_lin_stiffness(e_star, width) result(stiffness)
      real(wp), intent(in) :: e_star !! effective modulus E* [Pa]
      real(wp), intent(in) :: width  !! common face width b [m]

      stiffness = 0.5_wp*pi*e_star*width
   end function yang_lin_stiffness

   !> The inverse: h = (|F|/K)**(1/m) sign(F).
   elemental real(wp) function power_penetration(force, coefficient, exponent) result(h)
      real(wp), intent(in) :: force       !! [N]
      real(wp), intent(in) :: coefficient !! K [N/m^m], > 0
      real(wp), intent(in) :: exponent    !! m >= 1

      h = sign((abs(force)/coefficient)**(1.0_wp/exponent), force)
   end function power_penetration

   !> The entries of the law table.
   pure type(law_info_t) function linear_spring_law() result(info)

      info%name = "linear"
      info%description = "proportional to the penetration"
      info%source = "Hooke's law"
      info%n_parameters = 1
      info%parameters(1) = law_parameter("stiffness", "N/m", "force per penetration, over the whole width", &
                                         minimum=0.0_wp, minimum_open=.true.)
   end function linear_spring_law

   pure type(law_info_t) function yang_lin_law() result(info)

      info%name = "yang_lin"
      info%description = "proportional to the penetration, with the stiffness pi E* b/2"
      info%source = "Yang & Lin 1987, J. Mech. Transm. Autom. Des. 109, 189"
   end function yang_lin_law

   pure type(law_info_t) function power_spring_law() result(info)

      info%name = "power"
      info%description = "proportional to a power of the penetration"
      info%source = "Hunt & Crossley 1975, J. Appl. Mech. 42, 440"
      info%n_parameters = 2
      info%parameters(1) = law_parameter("coefficient", "N/m^exponent", "force per power of the penetration, over the width", &
                                         minimum=0.0_wp, minimum_open=.true.)
      info%parameters(2) = law_parameter("exponent", "1", "power of the penetration", minimum=1.0_wp)
   end function power_spring_law

end module evl_springs
