!> The gearbox as a differential-algebraic system F(t, y, y') = 0, and consistent derivatives y'.
module evl_dae_residual
   use evl_contact_tracking, only: algebraic_residual, differential_rates, differential_residual
   use evl_contacts_at_state, only: find_tracked
   use evl_discrete_state, only: is_closed
   use evl_gearbox, only: gearbox_local, gearbox_t
   use evl_gearbox_rates, only: gearbox_rates
   use evl_housing, only: at_velocity
   use evl_housing_dynamics, only: coupled_rates, housing_residual
   use evl_kinds, only: wp
   use evl_local_variables, only: n_local, n_track
   use evl_rigid_contact, only: rigid_constraint
   use evl_rigid_forces, only: multiplier_rates
   use evl_status, only: code_out_of_domain, code_singular, fail, has_failed, status_t, subject_mesh
   use evl_tooth_contact, only: tracking_algebraic
   implicit none (type, external)
   private

   public :: gearbox_residual, gearbox_derivative

contains

   !> Residual F(t, y, y') of the whole system.
   subroutine gearbox_residual(gearbox, t, y, yp, integers, reals, residual, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(gearbox%n_states), yp(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      real(wp), intent(out) :: residual(gearbox%n_states)
      type(status_t), intent(inout) :: status
      real(wp) :: q(n_local), rho_a0, balances(6)
      logical :: exists, tracks
      integer :: i

      call gearbox_rates(gearbox, t, y, integers, reals, residual, status, yp)
      if (has_failed(status)) return
      if (gearbox%housing%is_mounted) call housing_residual(gearbox, t, y, yp, residual, balances)
      ! the rows of the multipliers, which are contiguous before the energies, are already complete
      associate (before => gearbox%i_dissipated - gearbox%n_multipliers - 1, behind => gearbox%i_dissipated)
         residual(:before) = yp(:before) - residual(:before)
         residual(behind:) = yp(behind:) - residual(behind:)
      end associate
      associate (first => gearbox%housing%i_state + at_velocity)
         if (gearbox%housing%is_mounted) residual(first:first + 5) = balances
      end associate
      do i = 1, size(gearbox%contacts)
         if (gearbox%n_multipliers == 0) exit
         associate (contact => gearbox%contacts(i), row => gearbox%contacts(i)%i_dependent)
            if (.not. is_closed(gearbox, i, integers)) cycle
            call gearbox_local(gearbox, contact, y, q)
            residual(row:row + 1) = rigid_constraint(contact%pair, q)
         end associate
      end do
      do i = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(i))
            call find_tracked(gearbox, i, y, integers, tracks, q, rho_a0)
            if (.not. tracks) cycle
            associate (first => contact%i_track, last => contact%i_track + n_track - 1)
               if (contact%tracking == tracking_algebraic) then
                  call algebraic_residual(contact%pair, rho_a0, q, residual(first:last), exists)
               else
                  call differential_residual(contact%pair, rho_a0, q, yp(first:last), residual(first:last), exists)
               end if
            end associate
            if (.not. exists) then
               call fail_inside_base_circle(contact%mesh, status)
               return
            end if
         end associate
      end do
   end subroutine gearbox_residual

   !> Consistent y' for y; tracked variables by the differential form, solved with LAPACK. y must contain its multipliers.
   subroutine gearbox_derivative(gearbox, t, y, integers, reals, yp, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      real(wp), intent(out) :: yp(gearbox%n_states)
      type(status_t), intent(inout) :: status !! code_out_of_domain or code_singular
      real(wp) :: q(n_local), rho_a0, at_rest(n_track), residual(n_track)
      logical :: exists, solved, tracks
      integer :: i

      call coupled_rates(gearbox, t, y, integers, reals, yp, status)
      if (has_failed(status)) return
      if (gearbox%n_multipliers > 0) call multiplier_rates(gearbox, t, y, integers, reals, yp, status)
      if (has_failed(status)) return
      do i = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(i))
            call find_tracked(gearbox, i, y, integers, tracks, q, rho_a0)
            if (.not. tracks) cycle
            call differential_rates(contact%pair, rho_a0, q, yp(contact%i_track:contact%i_track + n_track - 1), solved)
            if (solved) cycle
            at_rest = 0
            call differential_residual(contact%pair, rho_a0, q, at_rest, residual, exists)
            if (.not. exists) then
               call fail_inside_base_circle(contact%mesh, status)
            else
               call fail(status, code_singular, "the contact points' velocities are not determined at this state", &
                         subject_mesh, contact%mesh, "tracking")
            end if
            return
         end associate
      end do
   end subroutine gearbox_derivative

   !> Fail because a tracked point lies inside the base circle, where its flank has no involute.
   subroutine fail_inside_base_circle(mesh, status)
      integer, intent(in) :: mesh
      type(status_t), intent(inout) :: status

      call fail(status, code_out_of_domain, "a tracked contact point lies inside its wheel's base circle: the tooth pair" &
                //" has turned back too far", subject_mesh, mesh, "tracking")
   end subroutine fail_inside_base_circle

end module evl_dae_residual
