!> Friction laws of a contact, as a factor of the normal force: F_t = -F_n phi(v_t). A law extends `friction_law_t` in a file
!> of its own.
!>
!> A law with kinks is a set of smooth branches, numbered -1, 0 and +1. The branch is part of the discrete state: it changes
!> at located events, and a law is smooth on its branch even if a trial step leaves it. A law without kinks has only branch 0,
!> and no knee.
module evl_friction_law
   use evl_force_law, only: force_law_t
   use evl_kinds, only: lanes, wp
   use evl_row, only: parameter_row, positive, row_t, span_t
   implicit none (type, external)
   private

   public :: friction_law_t, regularisation, sliding_t
   public :: by_curvature, by_load, by_rolling, by_sliding, n_sliding

   integer, parameter :: n_sliding = 4 !! quantities of a sliding contact
   integer, parameter :: by_sliding = 1   !! sliding velocity v_t [m/s]
   integer, parameter :: by_rolling = 2   !! sum of the rolling speeds of both flanks, of either sign [m/s]
   integer, parameter :: by_load = 3      !! normal force over the width [N/m]
   integer, parameter :: by_curvature = 4 !! sum of the curvatures of both flanks [1/m]

   !> Sliding contact in one state or in eight: scratch of the caller, not initialised. Laws that are not local use v_t only.
   type :: sliding_t
      real(wp) :: x(lanes, n_sliding)
      real(wp) :: e_star !! effective modulus E* [Pa]
   end type sliding_t

   type, abstract, extends(force_law_t) :: friction_law_t
   contains
      procedure(factor_formula), deferred :: evaluate
      procedure :: evaluate_local
      procedure :: is_local => never
      procedure, non_overridable :: factor
      procedure, non_overridable :: factor_lanes
      procedure :: acts
      procedure :: falls => never
      procedure :: branch
      procedure :: knee
   end type friction_law_t

   abstract interface

      !> phi of F_t = -F_n phi(v_t) in n states on one branch, also if v_t is outside it; and optionally its slope, which is
      !> zero on entry.
      pure subroutine factor_formula(self, n, branch, v_t, phi, d_v)
         import :: friction_law_t, wp
         implicit none (type, external)
         class(friction_law_t), intent(in) :: self
         integer, intent(in) :: n          !! 1 or 8: loops over them are vectorised
         integer, intent(in) :: branch     !! -1, 0 or +1, as returned by `branch`
         real(wp), intent(in) :: v_t(n)    !! sliding velocity [m/s]
         real(wp), intent(out) :: phi(n)
         real(wp), intent(inout), optional :: d_v(n) !! dphi/dv_t [s/m]
      end subroutine factor_formula

   end interface

contains

   !> Whether there is any friction: the first parameter is a coefficient that scales it.
   pure logical function acts(self)
      class(friction_law_t), intent(in) :: self

      acts = self%parameters(1) > 0
   end function acts

   !> Most laws neither fall with the sliding velocity, which is negative damping, nor are local: they depend on nothing else.
   pure logical function never(self)
      class(friction_law_t), intent(in) :: self

      never = .false.
   end function never

   !> phi in n states, and optionally its derivatives; a local law overrides it.
   pure subroutine evaluate_local(self, n, branch, at, phi, d_phi)
      class(friction_law_t), intent(in) :: self
      integer, intent(in) :: n, branch
      type(sliding_t), intent(in) :: at
      real(wp), intent(out) :: phi(n)
      real(wp), intent(inout), optional :: d_phi(n, n_sliding) !! zero on entry

      if (present(d_phi)) then
         call self%evaluate(n, branch, at%x(:n, by_sliding), phi, d_phi(:, by_sliding))
      else
         call self%evaluate(n, branch, at%x(:n, by_sliding), phi)
      end if
   end subroutine evaluate_local

   !> phi in one state, and its derivatives.
   pure subroutine factor(self, branch, at, phi, d_phi)
      class(friction_law_t), intent(in) :: self
      integer, intent(in) :: branch      !! -1, 0 or +1
      type(sliding_t), intent(in) :: at
      real(wp), intent(out) :: phi, d_phi(n_sliding)
      real(wp) :: there(1), slopes(1, n_sliding)

      slopes = 0
      call self%evaluate_local(1, branch, at, there, slopes)
      phi = there(1)
      d_phi = slopes(1, :)
   end subroutine factor

   !> phi in eight states on one branch.
   pure subroutine factor_lanes(self, branch, at, phi)
      class(friction_law_t), intent(in) :: self
      integer, intent(in) :: branch      !! -1, 0 or +1
      type(sliding_t), intent(in) :: at
      real(wp), intent(out) :: phi(lanes)

      call self%evaluate_local(lanes, branch, at, phi)
   end subroutine factor_lanes

   !> Branch of a sliding velocity: -1, 0 or +1.
   pure integer function branch(self, v_t)
      class(friction_law_t), intent(in) :: self
      real(wp), intent(in) :: v_t !! [m/s]
      real(wp) :: knee

      branch = 0
      knee = self%knee()
      if (knee > 0.0_wp .and. abs(v_t) > knee) branch = merge(1, -1, v_t > 0.0_wp)
   end function branch

   !> |v_t| at which the branch changes [m/s]; 0 if it never does.
   pure real(wp) function knee(self)
      class(friction_law_t), intent(in) :: self

      knee = 0
   end function knee

   !> Parameter that makes the slope of friction finite at zero sliding velocity.
   pure type(row_t) function regularisation(text) result(row)
      character(len=*), intent(in) :: text !! its meaning in the law

      row = parameter_row("regularisation_velocity", "m/s", text, range=positive, default="0.0001", &
                          plausible=span_t(1.0e-9_wp, 1.0_wp))
   end function regularisation

end module evl_friction_law
