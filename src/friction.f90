!> Friction between the flanks as a factor of the normal force: F_t = -F_n phi(v_t).
!>
!> A law with kinks is a set of smooth branches, told apart by a mode in {-1, 0, +1}. The mode is part of the discrete
!> state: it changes at located events, and within a mode the law is smooth even where a trial step leaves the branch.
module evl_friction
   use evl_kinds, only: wp
   use evl_law_info, only: law_info_t, law_parameter
   implicit none (type, external)
   private

   public :: coulomb_factor, coulomb_friction_law, coulomb_knee, coulomb_mode, no_friction_law

contains

   !> phi = f v_t/delta in mode 0, -f or +f in mode -1 or +1.
   !>
   !> Source: Coulomb's law, regularised piecewise linearly as in Kosenko & Gusev 2011, section 7.2.
   elemental subroutine coulomb_factor(mode, v_t, coefficient, delta, factor, d_v)
      integer, intent(in) :: mode         !! -1, 0 or +1
      real(wp), intent(in) :: v_t         !! sliding velocity [m/s]
      real(wp), intent(in) :: coefficient !! f, >= 0
      real(wp), intent(in) :: delta       !! regularisation velocity [m/s], > 0
      real(wp), intent(out) :: factor     !! phi
      real(wp), intent(out) :: d_v        !! dphi/dv_t [s/m]

      if (mode == 0) then
         d_v = coefficient/delta
         factor = coefficient*(v_t/delta)
      else
         d_v = 0.0_wp
         factor = sign(coefficient, real(mode, wp))
      end if
   end subroutine coulomb_factor

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
      info%parameters(2) = law_parameter("regularisation_velocity", "m/s", &
                                         "sliding velocity at which friction is fully developed", &
                                         default_value=1.0e-4_wp, minimum=0.0_wp, minimum_open=.true.)
   end function coulomb_friction_law

end module evl_friction
