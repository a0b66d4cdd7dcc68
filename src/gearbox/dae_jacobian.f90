!> The analytic Jacobian dF/dy + cj dF/dy' of the gearbox.
module evl_dae_jacobian
   use evl_contact_point, only: contact_gradient, contact_point
   use evl_contact_tracking, only: algebraic_jacobian, differential_jacobian
   use evl_contacts_at_state, only: find_tracked
   use evl_discrete_state, only: is_closed
   use evl_force_jacobian, only: add_constants, add_forces, couple_reference, scatter
   use evl_gearbox, only: gearbox_local, gearbox_t
   use evl_gearbox_rates, only: gearbox_rates
   use evl_housing, only: frame_t, housing_frame
   use evl_housing_dynamics, only: housing_coupling
   use evl_housing_jacobian, only: housing_gradient, mounted_gradient
   use evl_jacobian_entries, only: full_matrix, jacobian_entries
   use evl_kinds, only: wp
   use evl_local_variables, only: at_psi_dot_a, at_v_b, n_local, n_track
   use evl_rigid_contact, only: rigid_acceleration_gradient, rigid_gradient
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: tooth_contact_t, tracking_algebraic
   implicit none (type, external)
   private

   public :: gearbox_jacobian

contains

   !> dF/dy + cj dF/dy'.
   subroutine gearbox_jacobian(gearbox, t, cj, y, yp, integers, reals, jacobian, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, cj
      real(wp), intent(in) :: y(gearbox%n_states), yp(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      real(wp), intent(out) :: jacobian(gearbox%n_states, gearbox%n_states)
      type(status_t), intent(inout) :: status
      type(frame_t) :: frame
      type(jacobian_entries) :: entries
      integer :: i

      if (gearbox%housing%acts) call housing_frame(gearbox%housing, t, y, frame, yp)
      call full_matrix(gearbox%n_states, entries)
      jacobian = 0
      call add_constants(gearbox, entries, jacobian)
      call add_forces(gearbox, t, y, integers, reals, frame, entries, jacobian, status)
      if (has_failed(status)) return
      if (gearbox%housing%is_mounted) then
         do i = 1, size(gearbox%wheels)
            call mounted_gradient(gearbox, i, t, y, integers, frame, jacobian)
         end do
      end if
      call couple_reference(gearbox, entries, jacobian)
      if (gearbox%housing%is_mounted) call add_housing(gearbox, cj, y, yp, frame, jacobian)
      do i = 1, size(gearbox%contacts)
         if (gearbox%contacts(i)%leads) call add_multiplier(gearbox, i, t, y, yp, integers, reals, entries, jacobian, status)
      end do
      associate (before => gearbox%i_dissipated - gearbox%n_multipliers - 1, behind => gearbox%i_dissipated)
         do i = 1, gearbox%n_states
            if (i <= before .or. i >= behind) jacobian(i, i) = jacobian(i, i) + cj
         end do
      end associate
      do i = 1, size(gearbox%contacts)
         if (is_closed(gearbox, i, integers)) call add_constraint(gearbox, gearbox%contacts(i), y, entries, jacobian)
      end do
      do i = 1, size(gearbox%contacts)
         call add_tracking(gearbox, i, cj, y, yp, integers, entries, jacobian)
      end do
   end subroutine gearbox_jacobian

   !> The rows of a mounted housing, and what its accelerations are for the others.
   subroutine add_housing(gearbox, cj, y, yp, frame, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: cj, y(gearbox%n_states), yp(gearbox%n_states)
      type(frame_t), intent(in) :: frame
      real(wp), intent(inout) :: jacobian(:, :)
      real(wp) :: coupling(gearbox%n_states, gearbox%n_states)

      call housing_gradient(gearbox, y, yp, frame, jacobian)
      call housing_coupling(gearbox, frame, y, coupling)
      jacobian = jacobian + cj*coupling
   end subroutine add_housing

   !> The row of a multiplier: kappa'' in terms of the rows of the velocities, which hold minus their derivatives.
   subroutine add_multiplier(gearbox, index, t, y, yp, integers, reals, entries, jacobian, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index, integers(gearbox%n_integers)
      real(wp), intent(in) :: t, y(gearbox%n_states), yp(gearbox%n_states), reals(size(gearbox%contacts))
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: jacobian(gearbox%n_states, gearbox%n_states)
      type(status_t), intent(inout) :: status
      real(wp) :: f(gearbox%n_states), q(n_local), rates(n_local), direct(n_local)
      type(contact_point) :: point
      type(contact_gradient) :: gradient
      integer :: i

      associate (contact => gearbox%contacts(index), row => gearbox%contacts(index)%i_normal)
         jacobian(row, :) = 0
         if (.not. is_closed(gearbox, index, integers)) then
            jacobian(row, row) = 1
            return
         end if
         call gearbox_rates(gearbox, t, y, integers, reals, f, status, yp)
         call gearbox_local(gearbox, contact, y, q)
         call gearbox_local(gearbox, contact, f, rates)
         call rigid_gradient(contact%pair, q, point, gradient)
         do i = 1, size(contact%links)
            associate (link => contact%links(i))
               if (link%local < at_psi_dot_a .or. link%local > at_v_b + 1) cycle
               jacobian(row, :) = jacobian(row, :) + gradient%h_dot(link%local)*link%weight/contact%mobility*jacobian(link%state, :)
            end associate
         end do
         call rigid_acceleration_gradient(contact%pair, q, rates, direct)
         call scatter(contact%links, row, 1/contact%mobility, direct, entries, jacobian)
      end associate
   end subroutine add_multiplier

   !> The rows of the wheel that a closed rigid contact determines: kappa and kappa'.
   pure subroutine add_constraint(gearbox, contact, y, entries, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: y(gearbox%n_states)
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: jacobian(gearbox%n_states, gearbox%n_states)
      real(wp) :: q(n_local)
      type(contact_point) :: point
      type(contact_gradient) :: gradient

      call gearbox_local(gearbox, contact, y, q)
      call rigid_gradient(contact%pair, q, point, gradient)
      associate (row => contact%i_dependent)
         jacobian(row:row + 1, :) = 0
         call scatter(contact%links, row, -1.0_wp, gradient%h, entries, jacobian)
         call scatter(contact%links, row + 1, -1.0_wp, gradient%h_dot, entries, jacobian)
      end associate
   end subroutine add_constraint

   !> The rows of a mesh's tracked variables.
   pure subroutine add_tracking(gearbox, index, cj, y, yp, integers, entries, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: cj, y(gearbox%n_states), yp(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: jacobian(gearbox%n_states, gearbox%n_states)
      real(wp) :: q(n_local), rho_a0, local(n_track, n_local)
      logical :: tracks
      integer :: row

      call find_tracked(gearbox, index, y, integers, tracks, q, rho_a0)
      if (.not. tracks) return
      associate (contact => gearbox%contacts(index))
         if (contact%tracking == tracking_algebraic) then
            call algebraic_jacobian(contact%pair, rho_a0, q, local)
         else
            call differential_jacobian(contact%pair, rho_a0, q, yp(contact%i_track:contact%i_track + n_track - 1), cj, local)
         end if
         do row = 1, n_track
            jacobian(contact%i_track + row - 1, :) = 0
            call scatter(contact%links, contact%i_track + row - 1, 1.0_wp, local(row, :), entries, jacobian)
         end do
      end associate
   end subroutine add_tracking

end module evl_dae_jacobian
