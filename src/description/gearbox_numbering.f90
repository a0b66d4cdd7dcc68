!> Positions of the parts of a gearbox in its state, its root functions and its discrete state.
module evl_gearbox_numbering
   use evl_contact_roots, only: list_roots, share_roots
   use evl_discrete_state, only: number_integers
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_housing, only: n_housing_states
   use evl_local_variables, only: i_omega, n_track
   use evl_tooth_contact, only: tracking_closed_form
   implicit none (type, external)
   private

   public :: number_modes, number_states

contains

   !> Number the states.
   subroutine number_states(gearbox)
      type(gearbox_t), intent(inout) :: gearbox !! its contacts are listed
      integer :: i, j, n

      n = i_omega
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            wheel%i_speed = i_omega
            if (i == gearbox%reference .or. wheel%leader /= i) cycle
            wheel%i_psi = n + 1
            wheel%i_speed = n + 2
            n = n + 2
         end associate
      end do
      gearbox%wheels%i_psi = gearbox%wheels(gearbox%wheels%leader)%i_psi
      gearbox%wheels%i_speed = gearbox%wheels(gearbox%wheels%leader)%i_speed
      gearbox%shafts%i_psi_a = gearbox%wheels(gearbox%shafts%wheel_a)%i_psi
      gearbox%shafts%i_psi_b = gearbox%wheels(gearbox%shafts%wheel_b)%i_psi
      do i = 1, size(gearbox%wheels)
         do j = 1, gearbox%wheels(i)%support%n
            gearbox%wheels(i)%support%i_state(j) = n + 1
            n = n + 2
         end do
      end do
      do i = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(i))
            if (contact%tracking == tracking_closed_form) cycle
            contact%i_track = n + 1 - merge(n_track, 0, contact%slot > 0)
            if (contact%slot == 0) n = n + n_track
         end associate
      end do
      if (gearbox%housing%is_mounted) then
         gearbox%housing%i_state = n + 1
         n = n + n_housing_states
      end if
      do i = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(i))
            if (.not. contact%rigid) cycle
            contact%leads = contact%slot == 0
            if (contact%leads) n = n + 1
            contact%i_normal = n
            if (contact%leads) gearbox%n_multipliers = gearbox%n_multipliers + 1
         end associate
      end do
      gearbox%i_dissipated = n + 1
      gearbox%i_work = n + 2
      gearbox%n_states = n + 2
   end subroutine number_states

   !> Number the root functions and the discrete state: revolutions, contact modes, and knots passed.
   subroutine number_modes(gearbox)
      type(gearbox_t), intent(inout) :: gearbox !! its contacts are complete
      integer :: i

      do i = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(i))
            if (contact%slot == 0) then
               call list_roots(contact)
            else
               call share_roots(gearbox%contacts(i - 1), contact)
            end if
            contact%i_root = gearbox%n_roots
            gearbox%n_roots = gearbox%n_roots + contact%n_roots
         end associate
      end do
      gearbox%n_roots = gearbox%n_roots + 1 ! revolutions of the reference wheel
      gearbox%n_integers = i_turns
      call number_integers(gearbox%contacts, gearbox%n_integers)
      do i = 1, size(gearbox%loads)
         if (.not. allocated(gearbox%loads(i)%load%knots%time)) cycle
         gearbox%n_integers = gearbox%n_integers + 1
         gearbox%loads(i)%load%i_segment = gearbox%n_integers
      end do
   end subroutine number_modes

end module evl_gearbox_numbering
