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
      procedure, non_overridable :: held
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

      !> Sentence about a quantity outside its limits at a point; "" if there is none. `at` as in the formula.
      pure subroutine limit_check(self, at, of, message)
         import :: local_friction_t, message_length, sliding_t
         implicit none (type, external)
         class(local_friction_t), intent(in) :: self
         type(sliding_t), intent(in) :: at
         character(len=*), intent(in) :: of !! pressure and sliding ratio of this, such as "a tooth pair"
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
      call smooth_speeds(n, delta, smooth)
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

   !> Sentence about a quantity of a sliding contact outside its limits; "" if there is none.
   pure subroutine held(self, at, of, message)
      class(local_friction_t), intent(in) :: self
      type(sliding_t), intent(in) :: at !! in one state
      character(len=*), intent(in) :: of
      character(len=message_length), intent(out) :: message
      type(sliding_t) :: smooth

      smooth = at
      call smooth_speeds(1, self%parameters(i_regularisation), smooth)
      call self%beyond_limits(smooth, of, message)
   end subroutine held

   !> u and V in place of the velocities. Equation L25.
   pure subroutine smooth_speeds(n, delta, at)
      integer, intent(in) :: n
      real(wp), intent(in) :: delta !! regularisation velocity [m/s]
      type(sliding_t), intent(inout) :: at

      at%x(:n, by_sliding) = sqrt(at%x(:n, by_sliding)**2 + delta**2)
      at%x(:n, by_rolling) = sqrt(at%x(:n, by_rolling)**2 + delta**2)
   end subroutine smooth_speeds

end module evl_local_friction
