!> Viscous forces that multiply the elastic one, after Hunt and Crossley: F_v = F_e chi h'/v0.
!>
!> v0 is the approach speed at the last closing, so that an impact loses the same share of its energy at every speed. The
!> laws differ in how they get chi from the coefficient of restitution e in their name. The restitution e' that the force
!> really gives follows from m h'' = -F_e (1 + chi h'/v0), free of loads: dividing by 1 + chi h'/v0 and integrating over h,
!> once from v0 to 0 and once from 0 to -e' v0, the elastic energy drops out and
!>
!>    chi (1 + e') = ln[(1 + chi)/(1 - chi e')]
!>
!> is left, whatever the elastic law. Hence e' < 1/chi: in a free impact the flanks never pull.
!>
!> Source: K. H. Hunt, F. R. E. Crossley, Coefficient of restitution interpreted as damping in vibroimpact, J. Appl. Mech.
!> 42 (1975) 440. Sources of chi with each factor; all are compared in P. Flores, M. Machado, M. T. Silva, J. M. Martins,
!> On the continuous contact force models for soft materials in multibody dynamics, Multibody Syst. Dyn. 25 (2011) 357.
module evl_hunt_crossley
   use evl_kinds, only: wp
   use evl_law_info, only: law_info_t, law_parameter
   implicit none (type, external)
   private

   public :: flores_factor, gonthier_factor, hunt_crossley_factor, lankarani_nikravesh_factor, lee_wang_factor
   public :: flores_law, gonthier_law, hunt_crossley_law, lankarani_nikravesh_law, lee_wang_law

contains

   !> chi = 3/2 (1 - e). Source: Hunt & Crossley 1975, for small 1 - e.   Valid: 0 <= e <= 1
   elemental real(wp) function hunt_crossley_factor(e) result(chi)
      real(wp), intent(in) :: e !! nominal coefficient of restitution

      chi = 1.5_wp*(1.0_wp - e)
   end function hunt_crossley_factor

   !> chi = 3/4 (1 - e**2).   Valid: 0 <= e <= 1
   !> Source: H. M. Lankarani, P. E. Nikravesh, A contact force model with hysteresis damping for impact analysis of multibody
   !> systems, J. Mech. Des. 112 (1990) 369.
   elemental real(wp) function lankarani_nikravesh_factor(e) result(chi)
      real(wp), intent(in) :: e !! nominal coefficient of restitution

      chi = 0.75_wp*(1.0_wp - e)*(1.0_wp + e)
   end function lankarani_nikravesh_factor

   !> chi = 8 (1 - e)/(5 e). Source: Flores et al. 2011.   Valid: 0 < e <= 1
   elemental real(wp) function flores_factor(e) result(chi)
      real(wp), intent(in) :: e !! nominal coefficient of restitution

      chi = 1.6_wp*(1.0_wp - e)/e
   end function flores_factor

   !> chi = (1 - e**2)/e.   Valid: 0 < e <= 1
   !> Source: Y. Gonthier, J. McPhee, C. Lange, J.-C. Piedboeuf, A regularized contact model with asymmetric damping and
   !> dwell-time dependent friction, Multibody Syst. Dyn. 11 (2004) 209.
   elemental real(wp) function gonthier_factor(e) result(chi)
      real(wp), intent(in) :: e !! nominal coefficient of restitution

      chi = (1.0_wp - e)*(1.0_wp + e)/e
   end function gonthier_factor

   !> chi = 3/4 (1 - e).   Valid: 0 <= e <= 1
   !> Source: T. W. Lee, A. C. Wang, On the dynamics of intermittent-motion mechanisms, J. Mech. Transm. Autom. Des. 105
   !> (1983) 534.
   elemental real(wp) function lee_wang_factor(e) result(chi)
      real(wp), intent(in) :: e !! nominal coefficient of restitution

      chi = 0.75_wp*(1.0_wp - e)
   end function lee_wang_factor

   !> The entries of the law table.
   pure type(law_info_t) function hunt_crossley_law() result(info)

      info = restitution_law("hunt_crossley", "1.5 (1 - e)", "Hunt & Crossley 1975, J. Appl. Mech. 42, 440", .false.)
   end function hunt_crossley_law

   pure type(law_info_t) function lankarani_nikravesh_law() result(info)

      info = restitution_law("lankarani_nikravesh", "0.75 (1 - e^2)", "Lankarani & Nikravesh 1990, J. Mech. Des. 112, 369", &
                             .false.)
   end function lankarani_nikravesh_law

   pure type(law_info_t) function flores_law() result(info)

      info = restitution_law("flores", "8 (1 - e)/(5 e)", "Flores et al. 2011, Multibody Syst. Dyn. 25, 357", .true.)
   end function flores_law

   pure type(law_info_t) function gonthier_law() result(info)

      info = restitution_law("gonthier", "(1 - e^2)/e", "Gonthier et al. 2004, Multibody Syst. Dyn. 11, 209", .true.)
   end function gonthier_law

   pure type(law_info_t) function lee_wang_law() result(info)

      info = restitution_law("lee_wang", "0.75 (1 - e)", "Lee & Wang 1983, J. Mech. Transm. Autom. Des. 105, 534", .false.)
   end function lee_wang_law

   !> What the entries have in common.
   pure type(law_info_t) function restitution_law(name, factor, source, is_positive) result(info)
      character(len=*), intent(in) :: name   !! of the law
      character(len=*), intent(in) :: factor !! chi as a formula
      character(len=*), intent(in) :: source !! of chi
      logical, intent(in) :: is_positive     !! chi divides by e: 0 is refused

      info%name = name
      info%description = "elastic force times chi h'/v0, chi = "//factor
      info%source = source
      info%n_parameters = 2
      info%parameters(1) = law_parameter("restitution", "1", "nominal coefficient of restitution e", &
                                         minimum=0.0_wp, minimum_open=is_positive, maximum=1.0_wp)
      info%parameters(2) = law_parameter("v0_min", "m/s", "smallest approach speed v0 that is used; h_0 sqrt(k/m) if not given", &
                                         minimum=0.0_wp, minimum_open=.true., from_mesh=.true.)
   end function restitution_law

end module evl_hunt_crossley
