!> Closed form of the contact, for its tests: a C interface that the kernel does not export.
module closed_form_calls
   use, intrinsic :: iso_c_binding, only: c_double
   use evl_closed_form, only: gradient_closed_form, track_closed_form
   use evl_contact_point, only: contact_gradient, contact_point, tracked_pair
   use evl_kinds, only: wp
   use evl_local_variables, only: n_local
   implicit none (type, external)
   private

   public :: closed_form_contact

contains

   !> Penetration, its rate, radii of curvature and sliding velocity of a pair, with their derivatives to the local variables.
   subroutine closed_form_contact(constants, q, values, gradients) bind(c)
      real(c_double), intent(in) :: constants(7) !! sigma, r_bA, r_bB, rho_0, g_A, g_B, rho_A0
      real(c_double), intent(in) :: q(n_local)
      real(c_double), intent(out) :: values(5), gradients(n_local, 5)
      type(tracked_pair) :: pair
      type(contact_point) :: point
      type(contact_gradient) :: gradient

      pair = tracked_pair(sigma=constants(1), r_ba=constants(2), r_bb=constants(3), r_b=constants(2) + constants(3), &
                          rho_0=constants(4), ratio_a=constants(5), ratio_b=constants(6), &
                          advance=-constants(1)*constants(2)*constants(5), share_a=0.25_wp, share_b=0.75_wp)
      call track_closed_form(pair, constants(7), q, point)
      call gradient_closed_form(pair, q, point, gradient)
      values = [point%h, point%h_dot, point%rho_a, point%rho_b, point%v_t]
      gradients(:, 1) = gradient%h
      gradients(:, 2) = gradient%h_dot
      gradients(:, 3) = gradient%rho_a
      gradients(:, 4) = gradient%rho_b
      gradients(:, 5) = gradient%v_t
   end subroutine closed_form_contact

end module closed_form_calls
