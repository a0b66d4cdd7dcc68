!> Friction laws with a local coefficient, which depends on load, speeds and curvature of each tooth pair at every instant. A law
!> extends `local_friction_t` in a file of its own, with a formula for the coefficient.
!>
!>    phi = mu(w, u, V, kappa) v_t/u    u = sqrt(v_t^2 + delta^2)    V = sqrt(v_Sigma^2 + delta^2)
!>
!> with the normal force w over the width and the sum kappa of the curvatures of both flanks: smooth at the pitch point and finite
!> at standstill.
module evl_local_friction
   use evl_friction_law, only: by_curvature, by_load, by_rolling, by_sliding, n_sliding, sliding_t
   use evl_kinds, only: wp
   use evl_lubricated_friction, only: lubricated_friction_t
   use evl_status, only: message_length
   implicit none (type, external)
   private

   public :: local_friction_t

   type, abstract, extends(lubricated_friction_t) :: local_friction_t
   contains
      procedure(coefficient_formula), deferred :: coefficient
      procedure(limit_check), deferred :: beyond_limits
      procedure :: is_local
      procedure :: evaluate_local
   end type local_friction_t

   integer, parameter :: i_regularisation = 1 !! index of the regularisation velocity in the parameters

   abstract interface

      !> Coefficient of friction in n states, and its derivatives. `at` has u > 0 and V > 0 in place of the velocities.
      pure subroutine coefficient_formula(self, n, at, mu, d_mu)
         import :: local_friction_t, n_sliding, sliding_t, wp
         implicit none (type, external)
         class(local_friction_t), intent(in) :: self
         integer, intent(in) :: n            !! 1 or 8: loops over them are vectorised
         type(sliding_t), intent(in) :: at
         real(wp), intent(out) :: mu(n)
         real(wp), intent(out) :: d_mu(n, n_sliding)
      end subroutine coefficient_formula

      !> Sentence about quantities outside their limits at a point; "" if there are none.
      pure subroutine limit_check(self, at, message)
         import :: local_friction_t, message_length, sliding_t
         implicit none (type, external)
         class(local_friction_t), intent(in) :: self
         type(sliding_t), intent(in) :: at
         character(len=message_length), intent(out) :: message
      end subroutine limit_check

   end interface

contains

   !> The coefficient varies along the path of contact.
   pure logical function is_local(self)
      class(local_friction_t), intent(in) :: self

      is_local = .true.
   end function is_local

   !> phi and its derivatives. Equation L25.
   pure subroutine evaluate_local(self, n, branch, at, phi, d_phi)
      class(local_friction_t), intent(in) :: self
      integer, intent(in) :: n, branch
      type(sliding_t), intent(in) :: at
      real(wp), intent(out) :: phi(n)
      real(wp), intent(inout), optional :: d_phi(n, n_sliding)
      type(sliding_t) :: smooth
      real(wp) :: mu(n), d_mu(n, n_sliding), delta

      delta = self%parameters(i_regularisation)
      smooth = at
      smooth%x(:n, by_sliding) = sqrt(at%x(:n, by_sliding)**2 + delta**2)
      smooth%x(:n, by_rolling) = sqrt(at%x(:n, by_rolling)**2 + delta**2)
      call self%coefficient(n, smooth, mu, d_mu)
      associate (v => at%x(:n, by_sliding), u => smooth%x(:n, by_sliding))
         phi = mu*(v/u)
         if (.not. present(d_phi)) return
         d_phi(:, by_sliding) = d_mu(:, by_sliding)*(v/u)**2 + mu*(delta/u)**2/u
         d_phi(:, by_rolling) = d_mu(:, by_rolling)*(at%x(:n, by_rolling)/smooth%x(:n, by_rolling))*(v/u)
         d_phi(:, by_load) = d_mu(:, by_load)*(v/u)
         d_phi(:, by_curvature) = d_mu(:, by_curvature)*(v/u)
      end associate
   end subroutine evaluate_local

end module evl_local_friction
