!> Coulomb's law, regularised: phi = f v_t/delta on branch 0, -f or +f on branch -1 or +1.
!>
!> Source: Coulomb's law, regularised piecewise linearly as in Kosenko & Gusev 2011, section 7.2.
module evl_coulomb
   use evl_friction_law, only: friction_law_t, regularisation
   use evl_kinds, only: lanes, wp
   use evl_row, only: kind_t, not_negative, parameter_row, span_t
   implicit none (type, external)
   private

   public :: coulomb_t

   type, extends(friction_law_t) :: coulomb_t
   contains
      procedure :: describe
      procedure :: factor
      procedure :: factor_lanes
      procedure :: knee
   end type coulomb_t

contains

   !> Name, source and parameters.
   pure subroutine describe(self, info)
      class(coulomb_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "coulomb"
      info%text = "Coulomb's law, linear in the sliding velocity below the regularisation velocity"
      info%source = "Kosenko & Gusev 2011, section 7.2"
      info%rows = [parameter_row("coefficient", "", "coefficient of friction", range=not_negative, &
                                 plausible=span_t(0.0_wp, 1.0_wp)), &
                   regularisation("sliding velocity at which friction is fully developed")]
   end subroutine describe

   !> The factor.
   pure subroutine factor(self, branch, v_t, phi, d_v)
      class(coulomb_t), intent(in) :: self
      integer, intent(in) :: branch
      real(wp), intent(in) :: v_t
      real(wp), intent(out) :: phi, d_v

      call coulomb_factor(branch, v_t, self%parameters(1), self%parameters(2), phi, d_v)
   end subroutine factor

   !> The same in eight states.
   pure subroutine factor_lanes(self, branch, v_t, phi)
      class(coulomb_t), intent(in) :: self
      integer, intent(in) :: branch
      real(wp), intent(in) :: v_t(lanes)
      real(wp), intent(out) :: phi(lanes)
      real(wp) :: coefficient, delta, d_v
      integer :: l

      coefficient = self%parameters(1)
      delta = self%parameters(2)
      !$omp simd private(d_v)
      do l = 1, lanes
         call coulomb_factor(branch, v_t(l), coefficient, delta, phi(l), d_v)
      end do
   end subroutine factor_lanes

   !> Where the branch changes; without friction (f = 0) there is nothing to locate.
   pure real(wp) function knee(self)
      class(coulomb_t), intent(in) :: self

      knee = merge(self%parameters(2), 0.0_wp, self%parameters(1) > 0.0_wp)
   end function knee

   !> phi and its slope.
   elemental subroutine coulomb_factor(branch, v_t, coefficient, delta, phi, d_v)
      integer, intent(in) :: branch       !! -1, 0 or +1
      real(wp), intent(in) :: v_t         !! sliding velocity [m/s]
      real(wp), intent(in) :: coefficient !! f, >= 0
      real(wp), intent(in) :: delta       !! regularisation velocity [m/s], > 0
      real(wp), intent(out) :: phi
      real(wp), intent(out) :: d_v        !! dphi/dv_t [s/m]

      if (branch == 0) then
         d_v = coefficient/delta
         phi = coefficient*(v_t/delta)
      else
         d_v = 0.0_wp
         phi = sign(coefficient, real(branch, wp))
      end if
   end subroutine coulomb_factor

end module evl_coulomb
