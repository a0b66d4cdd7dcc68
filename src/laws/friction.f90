!> Friction between the flanks as a factor of the normal force: F_t = -F_n phi(v_t).
!>
!> A law with kinks is a set of smooth branches, told apart by a mode in {-1, 0, +1}. The mode is part of the discrete
!> state: it changes at located events, and within a mode the law is smooth even where a trial step leaves the branch. A
!> law without kinks has the mode 0 alone, and no knee.
module evl_friction
   use evl_elementary, only: exponential, hyperbolic_tangent
   use evl_kinds, only: wp
   use evl_law_info, only: law_info_t, law_parameter, law_parameter_t
   implicit none (type, external)
   private

   public :: coulomb_factor, coulomb_friction_law, coulomb_knee, coulomb_mode, no_friction_law
   public :: stribeck_factor, stribeck_friction_law, tanh_factor, tanh_friction_law

contains

   include "laws/friction.inc"

   !> The mode that belongs to a sliding velocity: 0 if |v_t| <= knee or there is no knee, else the sign of v_t.
   elemental integer function coulomb_mode(v_t, coefficient, delta)
      real(wp), intent(in) :: v_t         !! sliding velocity [m/s]
      real(wp), intent(in) :: coefficient !! f, >= 0
      real(wp), intent(in) :: delta       !! regularisation velocity [m/s], > 0
      real(wp) :: knee

      coulomb_mode = 0
      knee = coulomb_knee(coefficient, delta)
      if (knee > 0.0_wp .and. abs(v_t) > knee) coulomb_mode = merge(1, -1, v_t > 0.0_wp)
   end function coulomb_mode

   !> The |v_t| at which the mode changes [m/s]; 0 without friction (f = 0), when there is nothing to locate.
   elemental real(wp) function coulomb_knee(coefficient, delta)
      real(wp), intent(in) :: coefficient !! f, >= 0
      real(wp), intent(in) :: delta       !! regularisation velocity [m/s], > 0

      coulomb_knee = merge(delta, 0.0_wp, coefficient > 0.0_wp)
   end function coulomb_knee

   !> The entries of the law table.
   pure type(law_info_t) function no_friction_law() result(info)

      info%name = "none"
      info%description = "smooth flanks"
   end function no_friction_law

   pure type(law_info_t) function coulomb_friction_law() result(info)

      info%name = "coulomb"
      info%description = "Coulomb's law, linear in the sliding velocity below the regularisation velocity"
      info%source = "Kosenko & Gusev 2011, section 7.2"
      info%n_parameters = 2
      info%parameters(1) = law_parameter("coefficient", "1", "coefficient of friction", minimum=0.0_wp)
      info%parameters(2) = regularisation("sliding velocity at which friction is fully developed")
   end function coulomb_friction_law

   pure type(law_info_t) function tanh_friction_law() result(info)

      info%name = "tanh"
      info%description = "Coulomb's law, smoothed by the hyperbolic tangent of the sliding velocity"
      info%source = "Andersson, Soederberg & Bjoerklund 2007, Tribology International 40, 580"
      info%n_parameters = 2
      info%parameters(1) = law_parameter("coefficient", "1", "coefficient of friction", minimum=0.0_wp)
      info%parameters(2) = regularisation("sliding velocity at which friction is developed to 76 %")
   end function tanh_friction_law

   pure type(law_info_t) function stribeck_friction_law() result(info)

      info%name = "stribeck"
      info%description = "falling from static to kinetic friction over the Stribeck velocity, smooth"
      info%source = "Armstrong-Helouvry et al. 1994, Automatica 30, 1083; Andersson et al. 2007"
      info%n_parameters = 4
      info%parameters(1) = law_parameter("static_coefficient", "1", "coefficient of friction as sliding begins, >= kinetic", &
                                         minimum=0.0_wp)
      info%parameters(2) = law_parameter("kinetic_coefficient", "1", "coefficient of friction at high sliding velocity", &
                                         minimum=0.0_wp)
      info%parameters(3) = law_parameter("stribeck_velocity", "m/s", &
                                         "sliding velocity at which 1/e of the excess of static friction is left", &
                                         minimum=0.0_wp, minimum_open=.true.)
      info%parameters(4) = regularisation("sliding velocity at which friction is developed to 76 %")
   end function stribeck_friction_law

   !> The parameter that keeps friction finite in slope at rest.
   pure type(law_parameter_t) function regularisation(description) result(parameter)
      character(len=*), intent(in) :: description !! what it means in the law

      parameter = law_parameter("regularisation_velocity", "m/s", description, default_value=1.0e-4_wp, minimum=0.0_wp, &
                                minimum_open=.true.)
   end function regularisation

end module evl_friction
