!> Tooth contact in closed form: gap, normal and radii of curvature, computed from the positions of the wheels alone.
!>
!> Source: Kosenko & Gusev 2011, Assertions 1 and 2.
module evl_closed_form
   use evl_contact_point, only: complete_gradient, complete_point, contact_gradient, contact_point, tracked_pair
   use evl_kinds, only: wp
   use evl_local_variables, only: at_psi_a, at_psi_b, at_theta, at_u_a, at_u_b, n_local, n_track
   use evl_tangent_line, only: find_tangent_line, small_sine, tangent_line_t
   implicit none (type, external)
   private

   public :: track_closed_form, point_on_line, gradient_closed_form, gradient_along, closed_form_gap, closed_form_line
   public :: gap_along, radii_on_line, points_along, points_from_closed_form, error_of_turns, transmission_error
   public :: centre_line_angle, centre_line_turn, centre_line_turn_gradient

contains

   !> Compute the contact point in closed form (Assertions 1 and 2): gap, normal and radii of curvature.
   pure subroutine track_closed_form(pair, rho_a0, q, point)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: rho_a0      !! nominal radius of curvature on A at theta [m]
      real(wp), intent(in) :: q(n_local)  !! local variables
      type(contact_point), intent(out) :: point
      type(tangent_line_t) :: line

      call closed_form_line(pair, q, line)
      call point_on_line(pair, rho_a0, q, line, point)
   end subroutine track_closed_form

   include "contact/transmission_error.inc"
   include "contact/closed_form.inc"

   !> Line of action at the actual centre distance.
   pure subroutine closed_form_line(pair, q, line)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      type(tangent_line_t), intent(out) :: line

      call find_tangent_line(pair%r_b, pair%rho_0, q(at_u_b) - q(at_u_a), q(at_u_b + 1) - q(at_u_a + 1), line)
   end subroutine closed_form_line

   !> Gap kappa in closed form [m].
   pure real(wp) function closed_form_gap(pair, q) result(kappa)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      type(tangent_line_t) :: line

      call closed_form_line(pair, q, line)
      kappa = gap_along(pair, q, line)
   end function closed_form_gap

   !> Dynamic transmission error along the line of action [m].
   pure real(wp) function transmission_error(pair, axles_rest, q) result(lag)
      type(tracked_pair), intent(in) :: pair
      logical, intent(in) :: axles_rest !! whether both axles are fixed; the centre line then does not rotate
      real(wp), intent(in) :: q(n_local)
      real(wp) :: turn

      turn = 0
      if (.not. axles_rest) turn = centre_line_turn(pair, q)
      lag = error_of_turns(pair, q(at_psi_a), q(at_psi_b), turn)
   end function transmission_error

   !> Tracked variables consistent with the positions of the wheels (Assertions 1 and 2): the points lie on the line of action.
   pure subroutine points_from_closed_form(pair, q, track)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)       !! local variables; the tracked ones are not used
      real(wp), intent(out) :: track(n_track)  !! turn, zeta, dr, lambda, mu
      type(tangent_line_t) :: line

      call closed_form_line(pair, q, line)
      call points_along(pair, q, line, track)
   end subroutine points_from_closed_form

   !> As `points_from_closed_form`, for a given line of action. Equation T18.
   pure subroutine points_along(pair, q, line, track)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      type(tangent_line_t), intent(in) :: line      !! at q
      real(wp), intent(out) :: track(n_track)
      real(wp) :: kappa

      kappa = gap_along(pair, q, line)
      track(1) = line%angle
      track(2) = -pair%r_ba*(line%angle + pair%sigma*q(at_psi_a))
      track(3:4) = kappa*[-line%s, line%c]
      track(5) = -pair%r_bb/pair%r_ba
      track(6) = pair%r_bb*kappa
   end subroutine points_along

   !> Derivatives of `track_closed_form`.
   pure subroutine gradient_closed_form(pair, q, point, gradient)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      type(contact_point), intent(in) :: point !! at q
      type(contact_gradient), intent(out) :: gradient
      type(tangent_line_t) :: line

      call closed_form_line(pair, q, line)
      call gradient_along(pair, q, line, point, gradient)
   end subroutine gradient_closed_form

   !> As `gradient_closed_form`, for a given line of action.
   pure subroutine gradient_along(pair, q, line, point, gradient)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      type(tangent_line_t), intent(in) :: line      !! at q
      type(contact_point), intent(in) :: point !! at q
      type(contact_gradient), intent(out) :: gradient

      gradient%angle = 0
      gradient%angle(at_u_b:at_u_b + 1) = -[line%c, line%s]/line%rho
      gradient%angle(at_u_a:at_u_a + 1) = -gradient%angle(at_u_b:at_u_b + 1)
      gradient%h = 0
      gradient%h(at_psi_a) = -pair%sigma*pair%r_ba
      gradient%h(at_psi_b) = -pair%sigma*pair%r_bb
      gradient%h(at_u_b:at_u_b + 1) = [line%s, -line%c]
      gradient%h(at_u_a:at_u_a + 1) = -gradient%h(at_u_b:at_u_b + 1)
      gradient%rho_a = -pair%r_ba*gradient%angle
      gradient%rho_a(at_theta) = pair%advance
      gradient%rho_a(at_psi_a) = -pair%r_ba*pair%sigma
      gradient%rho_b = -pair%r_bb*gradient%angle
      gradient%rho_b(at_theta) = -pair%advance
      gradient%rho_b(at_psi_b) = -pair%r_bb*pair%sigma
      call complete_gradient(pair, q, point, gradient)
   end subroutine gradient_along

   include "contact/centre_line.inc"

   !> Dchi: rotation of the centre line from its reference direction [rad], counterclockwise.
   pure real(wp) function centre_line_turn(pair, q) result(turn)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      real(wp) :: along, across

      call centre_line(pair, q(at_u_b) - q(at_u_a), q(at_u_b + 1) - q(at_u_a + 1), along, across)
      turn = centre_line_angle(along, across)
   end function centre_line_turn

   !> Angle between the centre line and its reference direction [rad].
   elemental real(wp) function centre_line_angle(along, across) result(angle)
      real(wp), intent(in) :: along, across !! as from `centre_line`

      if (abs(across) < small_sine*along) then
         angle = small_arctangent(across/along)
      else
         angle = atan2(across, along)
      end if
   end function centre_line_angle

   !> Derivatives of `centre_line_turn` with respect to the local variables.
   pure function centre_line_turn_gradient(pair, q) result(gradient)
      type(tracked_pair), intent(in) :: pair
      real(wp), intent(in) :: q(n_local)
      real(wp) :: gradient(n_local), c(2)

      c = [pair%r_b, pair%rho_0] + q(at_u_b:at_u_b + 1) - q(at_u_a:at_u_a + 1) ! O_B - O_A
      gradient = 0
      gradient(at_u_b:at_u_b + 1) = pair%sigma*[c(2), -c(1)]/dot_product(c, c)
      gradient(at_u_a:at_u_a + 1) = -gradient(at_u_b:at_u_b + 1)
   end function centre_line_turn_gradient

end module evl_closed_form
