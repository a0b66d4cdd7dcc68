!> Coulomb's law, regularised: phi = f v_t/delta on branch 0, -f or +f on branch -1 or +1.
!>
!> Source: Coulomb's law, regularised piecewise linearly as in Kosenko & Gusev 2011, section 7.2.
module evl_coulomb
   use evl_friction_law, only: friction_law_t, regularisation
   use evl_kinds, only: wp
   use evl_row, only: kind_t, not_negative, parameter_row, span_t
   implicit none (type, external)
   private

   public :: coulomb_t

   type, extends(friction_law_t) :: coulomb_t
   contains
      procedure :: describe
      procedure :: evaluate
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
                   regularisation("sliding velocity at which the friction force is fully developed")]
   end subroutine describe

   !> phi and its slope. Equations L14, T51.
   pure subroutine evaluate(self, n, branch, v_t, phi, d_v)
      class(coulomb_t), intent(in) :: self
      integer, intent(in) :: n, branch
      real(wp), intent(in) :: v_t(n)
      real(wp), intent(out) :: phi(n)
      real(wp), intent(inout), optional :: d_v(n)
      real(wp) :: coefficient, delta

      coefficient = self%parameters(1)
      delta = self%parameters(2)
      if (branch == 0) then
         phi = coefficient*(v_t/delta)
         if (present(d_v)) d_v = coefficient/delta
      else
         phi = sign(coefficient, real(branch, wp))
      end if
   end subroutine evaluate

   !> Sliding velocity at which the branch changes; 0 without friction (f = 0), where there is no event.
   pure real(wp) function knee(self)
      class(coulomb_t), intent(in) :: self

      knee = merge(self%parameters(2), 0.0_wp, self%parameters(1) > 0.0_wp)
   end function knee

end module evl_coulomb
