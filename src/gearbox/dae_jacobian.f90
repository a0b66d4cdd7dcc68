!> Analytic Jacobian dF/dy + cj dF/dy' of the gearbox.
module evl_dae_jacobian
   use evl_contact_point, only: contact_gradient, contact_point
   use evl_contact_tracking, only: algebraic_jacobian, differential_jacobian
   use evl_contacts_at_state, only: find_tracked
   use evl_discrete_state, only: is_closed
   use evl_force_jacobian, only: add_constants, add_forces, couple_reference, find_pattern, scatter
   use evl_gearbox, only: gearbox_local, gearbox_t
   use evl_gearbox_rates, only: gearbox_rates
   use evl_housing, only: frame_t, housing_frame, is_balance
   use evl_housing_dynamics, only: housing_coupling
   use evl_housing_jacobian, only: housing_gradient, mounted_gradient
   use evl_jacobian_entries, only: add_entry, add_row, clear_row, full_matrix, jacobian_entries, listed_entries, n_noted, &
                                   note_entries, sort_entries, take_noted
   use evl_kinds, only: wp
   use evl_local_variables, only: at_psi_dot_a, at_v_b, local_link, n_local, n_track
   use evl_rigid_contact, only: rigid_acceleration_gradient, rigid_gradient
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: tooth_contact_t, tracking_algebraic
   implicit none (type, external)
   private

   public :: find_dae_pattern, gearbox_jacobian, gearbox_jacobian_entries

contains

   !> Full matrix dF/dy + cj dF/dy'.
   subroutine gearbox_jacobian(gearbox, t, cj, y, yp, integers, reals, jacobian, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, cj
      real(wp), intent(in) :: y(gearbox%n_states), yp(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      real(wp), intent(out) :: jacobian(gearbox%n_states, gearbox%n_states)
      type(status_t), intent(inout) :: status
      type(jacobian_entries) :: entries

      call full_matrix(gearbox%n_states, entries)
      call gearbox_jacobian_entries(gearbox, t, cj, y, yp, integers, reals, entries, jacobian, status)
   end subroutine gearbox_jacobian

   !> The same in the storage given by `entries`: a full matrix, or, without a mounted housing, also the list of `find_dae_pattern`.
   subroutine gearbox_jacobian_entries(gearbox, t, cj, y, yp, integers, reals, entries, jacobian, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, cj
      real(wp), intent(in) :: y(gearbox%n_states), yp(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(out) :: jacobian(entries%n_entries)
      type(status_t), intent(inout) :: status
      real(wp) :: f(gearbox%n_states)
      type(frame_t) :: frame
      integer :: i

      if (gearbox%housing%acts) call housing_frame(gearbox%housing, t, y, frame, yp)
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
      if (gearbox%n_multipliers > 0) call gearbox_rates(gearbox, t, y, integers, reals, f, status, yp)
      do i = 1, size(gearbox%contacts)
         if (gearbox%contacts(i)%leads) call add_multiplier(gearbox, i, y, f, integers, entries, jacobian)
      end do
      associate (before => gearbox%i_dissipated - gearbox%n_multipliers - 1, behind => gearbox%i_dissipated)
         do i = 1, gearbox%n_states
            if (i > before .and. i < behind .or. is_balance(gearbox%housing, i)) cycle
            call add_entry(entries, i, i, cj, jacobian)
         end do
      end associate
      do i = 1, size(gearbox%contacts)
         if (is_closed(gearbox, i, integers)) call add_constraint(gearbox, gearbox%contacts(i), y, entries, jacobian)
      end do
      do i = 1, size(gearbox%contacts)
         call add_tracking(gearbox, i, cj, y, yp, integers, entries, jacobian)
      end do
   end subroutine gearbox_jacobian_entries

   !> Entries that may be nonzero in any discrete state, column by column; for a housing that is not mounted.
   subroutine find_dae_pattern(gearbox, rows, columns)
      type(gearbox_t), intent(in) :: gearbox
      integer, allocatable, intent(out) :: rows(:), columns(:)
      integer, allocatable :: more_rows(:), more_columns(:)
      real(wp), allocatable :: notes(:)
      type(jacobian_entries) :: forces, entries
      integer :: capacity, i, turn

      call find_pattern(gearbox, rows, columns)
      call listed_entries(gearbox%n_states, rows, columns, forces)
      capacity = 0
      do turn = 1, 2
         call note_entries(gearbox%n_states, capacity, entries)
         notes = [(0.0_wp, i=0, capacity)]
         do i = 1, gearbox%n_states
            call add_entry(entries, i, i, 0.0_wp, notes)
         end do
         do i = 1, size(gearbox%contacts)
            call note_contact(gearbox%contacts(i), forces, entries, notes)
         end do
         capacity = n_noted(notes)
      end do
      call take_noted(gearbox%n_states, notes, more_rows, more_columns)
      rows = [rows, more_rows]
      columns = [columns, more_columns]
      call sort_entries(gearbox%n_states, rows, columns)
   end subroutine find_dae_pattern

   !> Record the rows of a tooth contact's multiplier, its constraint and its tracked variables.
   pure subroutine note_contact(contact, forces, entries, notes)
      type(tooth_contact_t), intent(in) :: contact
      type(jacobian_entries), intent(in) :: forces  !! for the rows of the speeds
      type(jacobian_entries), intent(in) :: entries !! in recording mode
      real(wp), intent(inout) :: notes(entries%n_entries)
      real(wp), parameter :: some(n_local) = 0.0_wp
      integer :: i, p, row

      if (contact%leads) then
         do i = 1, size(contact%links)
            associate (link => contact%links(i))
               if (.not. has_rate(link)) cycle
               do p = forces%start(link%state), forces%start(link%state + 1) - 1
                  call add_entry(entries, contact%i_normal, forces%columns(p), 0.0_wp, notes)
               end do
            end associate
         end do
         call scatter(contact%links, contact%i_normal, 0.0_wp, some, entries, notes)
         call scatter(contact%links, contact%i_dependent, 0.0_wp, some, entries, notes)
         call scatter(contact%links, contact%i_dependent + 1, 0.0_wp, some, entries, notes)
      end if
      if (contact%i_track == 0) return
      do row = contact%i_track, contact%i_track + n_track - 1
         call scatter(contact%links, row, 0.0_wp, some, entries, notes)
      end do
   end subroutine note_contact

   !> Whether the rate of a local variable is an acceleration that enters kappa''.
   elemental logical function has_rate(link)
      type(local_link), intent(in) :: link

      has_rate = link%local >= at_psi_dot_a .and. link%local <= at_v_b + 1
   end function has_rate

   !> Rows of a mounted housing, and the effect of its accelerations on the other rows.
   subroutine add_housing(gearbox, cj, y, yp, frame, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: cj, y(gearbox%n_states), yp(gearbox%n_states)
      type(frame_t), intent(in) :: frame
      real(wp), intent(inout) :: jacobian(gearbox%n_states, gearbox%n_states)
      real(wp) :: coupling(gearbox%n_states, gearbox%n_states)

      call housing_gradient(gearbox, y, yp, frame, jacobian)
      call housing_coupling(gearbox, frame, y, coupling)
      jacobian = jacobian + cj*coupling
   end subroutine add_housing

   !> Row of a multiplier: kappa'' from the rows of the velocities, which contain the negative derivatives of the accelerations.
   pure subroutine add_multiplier(gearbox, index, y, f, integers, entries, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index, integers(gearbox%n_integers)
      real(wp), intent(in) :: y(gearbox%n_states), f(gearbox%n_states) !! f: rates at this state
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: jacobian(entries%n_entries)
      real(wp) :: q(n_local), rates(n_local), direct(n_local)
      type(contact_point) :: point
      type(contact_gradient) :: gradient
      integer :: i

      associate (contact => gearbox%contacts(index), row => gearbox%contacts(index)%i_normal)
         call clear_row(entries, row, jacobian)
         if (.not. is_closed(gearbox, index, integers)) then
            call add_entry(entries, row, row, 1.0_wp, jacobian)
            return
         end if
         call gearbox_local(gearbox, contact, y, q)
         call gearbox_local(gearbox, contact, f, rates)
         call rigid_gradient(contact%pair, q, point, gradient)
         do i = 1, size(contact%links)
            associate (link => contact%links(i))
               if (has_rate(link)) &
                  call add_row(entries, link%state, row, gradient%h_dot(link%local)*link%weight/contact%mobility, jacobian)
            end associate
         end do
         call rigid_acceleration_gradient(contact%pair, q, rates, direct)
         call scatter(contact%links, row, 1/contact%mobility, direct, entries, jacobian)
      end associate
   end subroutine add_multiplier

   !> Rows of the wheel that a closed rigid contact determines: kappa and kappa'.
   pure subroutine add_constraint(gearbox, contact, y, entries, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: y(gearbox%n_states)
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: jacobian(entries%n_entries)
      real(wp) :: q(n_local)
      type(contact_point) :: point
      type(contact_gradient) :: gradient

      call gearbox_local(gearbox, contact, y, q)
      call rigid_gradient(contact%pair, q, point, gradient)
      associate (row => contact%i_dependent)
         call clear_row(entries, row, jacobian)
         call clear_row(entries, row + 1, jacobian)
         call scatter(contact%links, row, -1.0_wp, gradient%h, entries, jacobian)
         call scatter(contact%links, row + 1, -1.0_wp, gradient%h_dot, entries, jacobian)
      end associate
   end subroutine add_constraint

   !> Rows of the tracked variables of a mesh.
   pure subroutine add_tracking(gearbox, index, cj, y, yp, integers, entries, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: cj, y(gearbox%n_states), yp(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: jacobian(entries%n_entries)
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
            call clear_row(entries, contact%i_track + row - 1, jacobian)
            call scatter(contact%links, contact%i_track + row - 1, 1.0_wp, local(row, :), entries, jacobian)
         end do
      end associate
   end subroutine add_tracking

end module evl_dae_jacobian
