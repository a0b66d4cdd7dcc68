!> Friction laws with one coefficient for an operating point: computed once from the nominal operating point of the mesh and its
!> lubricant, constant in the run. A law extends `operating_friction_t` in a file of its own, with a formula for the coefficient.
!>
!> It is replaced by Coulomb's law with this coefficient when the mesh is known.
module evl_operating_friction
   use evl_coulomb, only: coulomb_t
   use evl_friction_law, only: friction_law_t
   use evl_kinds, only: wp
   use evl_lubricated_friction, only: lubricated_friction_t, mesh_lubricant
   implicit none (type, external)
   private

   public :: load_term, operating_friction_t, operating_point, viscosity_term

   real(wp), parameter :: least_line_load = 150.0e3_wp !! [N/m]; a smaller one counts as this
   integer, parameter :: i_regularisation = 2          !! index of the regularisation velocity in the parameters

   !> A mesh at its nominal operating point.
   type :: operating_point
      real(wp) :: line_load = 0.0_wp     !! F_bt/b [N/m]
      real(wp) :: rolling_speed = 0.0_wp !! v_SigmaC: sum of both rolling speeds at the pitch point [m/s], > 0
      real(wp) :: radius = 0.0_wp        !! rho_redC: reduced radius of curvature there [m]
      real(wp) :: diameter = 0.0_wp      !! d_1: reference diameter of the smaller wheel [m]
   end type operating_point

   type, abstract, extends(lubricated_friction_t) :: operating_friction_t
   contains
      procedure(coefficient_formula), deferred :: coefficient
      procedure, non_overridable :: acting
      procedure :: knee
   end type operating_friction_t

   abstract interface

      !> Coefficient of friction at an operating point.
      pure real(wp) function coefficient_formula(self, at) result(mu)
         import :: operating_friction_t, operating_point, wp
         implicit none (type, external)
         class(operating_friction_t), intent(in) :: self
         type(operating_point), intent(in) :: at
      end function coefficient_formula

   end interface

contains

   !> The law that replaces this one.
   subroutine acting(self, at, law)
      class(operating_friction_t), intent(in) :: self
      type(operating_point), intent(in) :: at
      class(friction_law_t), allocatable, intent(out) :: law

      allocate (coulomb_t :: law)
      law%parameters(1) = self%coefficient(at)
      law%parameters(2) = self%parameters(i_regularisation)
   end subroutine acting

   !> [F_bt/b / (v_SigmaC rho_redC)]^0.2 with N/mm, m/s and mm. Equation L22.
   pure real(wp) function load_term(at)
      type(operating_point), intent(in) :: at

      load_term = (max(at%line_load, least_line_load)*1.0e-3_wp/(at%rolling_speed*(at%radius*1.0e3_wp)))**0.2_wp
   end function load_term

   !> eta^-0.05 with mPa s. Equation L22.
   pure real(wp) function viscosity_term(lubricant)
      type(mesh_lubricant), intent(in) :: lubricant

      viscosity_term = (lubricant%viscosity*1.0e3_wp)**(-0.05_wp)
   end function viscosity_term

   !> That of the law that replaces it: root functions are numbered before the coefficient is known.
   pure real(wp) function knee(self)
      class(operating_friction_t), intent(in) :: self

      knee = self%parameters(i_regularisation)
   end function knee

end module evl_operating_friction
