!> Normal viscous forces of a contact, positive when they push the flanks apart.
!>
!> A law's force is that of the overlapping flanks; that a contact never pulls is the business of the mesh.
module evl_damping
   use evl_kinds, only: wp
   use evl_law_info, only: law_info_t, law_parameter
   implicit none (type, external)
   private

   public :: damping_share, impact_damping, linear_damping, one_sided_damping
   public :: linear_damping_law, no_damping_law, one_sided_damping_law
   public :: ratio_damping, ratio_damping_law

contains

   include "laws/damping.inc"

   !> Share of one-sided damping that acts: all on the side of approach, nothing on that of separation.
   pure real(wp) function damping_share(side, h_dot) result(share)
      integer, intent(in) :: side   !! +1 approach, -1 separation; 0: as the rate says
      real(wp), intent(in) :: h_dot !! rate of penetration [m/s]

      share = merge(1.0_wp, 0.0_wp, side > 0 .or. (side == 0 .and. h_dot > 0))
   end function damping_share

   !> The entries of the law table.
   pure type(law_info_t) function no_damping_law() result(info)

      info%name = "none"
      info%description = "no viscous force"
   end function no_damping_law

   pure type(law_info_t) function linear_damping_law() result(info)

      info%name = "linear"
      info%description = "proportional to the rate of penetration"
      info%source = "Kosenko & Gusev 2011, section 4"
      info%n_parameters = 1
      info%parameters(1) = law_parameter("coefficient", "N s/m", "force per rate of penetration", minimum=0.0_wp)
   end function linear_damping_law

   pure type(law_info_t) function one_sided_damping_law() result(info)

      info%name = "one_sided"
      info%description = "proportional to penetration and its rate on approach, zero on separation"
      info%source = "the Modelica library of Kosenko's group: damp |kappa| |h'|"
      info%n_parameters = 1
      info%parameters(1) = law_parameter("coefficient", "N s/m2", "force per penetration and rate of penetration", &
                                         minimum=0.0_wp)
   end function one_sided_damping_law

   pure type(law_info_t) function ratio_damping_law() result(info)

      info%name = "ratio"
      info%description = "c h' with c = 2 value sqrt(k m), by the damping ratio of one tooth pair at the nominal load"
      info%source = "the definition of a damping ratio; k and m: docs/laws.md"
      info%n_parameters = 1
      info%parameters(1) = law_parameter("value", "1", "damping ratio of one tooth pair at the nominal load", minimum=0.0_wp, &
                                         maximum=1.0_wp, maximum_open=.true.)
   end function ratio_damping_law

   !> The coefficient c of a linear damper that gives an oscillator the damping ratio [N s/m].
   elemental real(wp) function ratio_damping(ratio, stiffness, mass) result(coefficient)
      real(wp), intent(in) :: ratio     !! of critical damping
      real(wp), intent(in) :: stiffness !! k [N/m]
      real(wp), intent(in) :: mass      !! m [kg]

      coefficient = 2*ratio*sqrt(stiffness*mass)
   end function ratio_damping

end module evl_damping
