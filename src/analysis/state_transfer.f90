!> States relative to the common period: shifted back by whole periods, compared, and transferred to a gearbox with other
!> parameters. docs/guides/response.md.
module evl_state_transfer
   use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_common_period, only: period_t
   use evl_dae_residual, only: gearbox_derivative
   use evl_discrete_state, only: gearbox_store_mode, take_mode
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_gearbox_initial, only: settle_start
   use evl_kinds, only: pi, wp
   use evl_local_variables, only: i_omega, i_theta
   use evl_start_positions, only: assign_pairs, prescribed_speed
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: contact_mode, touches
   use evl_wheel_loads, only: followed_speed
   implicit none (type, external)
   private

   public :: state_distance, take_back, take_over

contains

   !> Shift a state back by whole common periods. Angles, tooth pairs and their slots become those of the same phase in the earlier
   !> period; the energies are reset.
   pure subroutine take_back(gearbox, period, periods, y, integers, reals)
      type(gearbox_t), intent(in) :: gearbox
      type(period_t), intent(in) :: period
      integer, intent(in) :: periods !! in the nominal sense of rotation; negative: forward
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(inout) :: integers(gearbox%n_integers)
      real(wp), intent(inout) :: reals(size(gearbox%contacts))
      type(contact_mode) :: modes(size(gearbox%contacts))
      integer(int64) :: above, below, whole
      integer :: m, passed, to

      associate (first => gearbox%contacts(1)%pitches_per_turn)
         above = int(periods, int64)*period%pitches*first%below ! divided by `below`: revolutions of the reference wheel
         below = first%above
      end associate
      whole = above/below
      integers(i_turns) = integers(i_turns) - int(whole)
      y(i_theta) = y(i_theta) - 2*pi*(real(above - whole*below, wp)/real(below, wp))
      if (abs(y(i_theta)) >= 2*pi) then
         whole = int(y(i_theta)/(2*pi), int64)
         integers(i_turns) = integers(i_turns) + int(whole)
         y(i_theta) = y(i_theta) - 2*pi*real(whole, wp)
      end if
      y([gearbox%i_dissipated, gearbox%i_work]) = 0
      do m = 1, size(gearbox%contacts)
         call take_mode(gearbox, m, integers, reals, modes(m))
      end do
      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m), mine => gearbox%contacts(m)%pitches_per_turn)
            passed = int(above*mine%above/(below*mine%below))
            modes(m)%tooth_pair = modes(m)%tooth_pair - passed
            to = m - contact%slot + modulo(contact%slot - passed, contact%n_slots)
            call gearbox_store_mode(gearbox, to, modes(m), integers, reals)
         end associate
      end do
   end subroutine take_back

   !> Distance between two states: the largest difference of a state in its unit, or of an approach speed in the unit of its
   !> contact; infinite if the discrete states differ. Energies are ignored.
   pure real(wp) function state_distance(gearbox, scale, y_a, integers_a, reals_a, y_b, integers_b, reals_b) result(distance)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: scale(gearbox%n_states) !! scales of the states
      real(wp), intent(in) :: y_a(gearbox%n_states), y_b(gearbox%n_states)
      integer, intent(in) :: integers_a(gearbox%n_integers), integers_b(gearbox%n_integers)
      real(wp), intent(in) :: reals_a(size(gearbox%contacts)), reals_b(size(gearbox%contacts))
      real(wp) :: difference(gearbox%n_states)
      integer :: i

      difference = y_a - y_b
      difference(i_theta) = difference(i_theta) + 2*pi*real(integers_a(i_turns) - integers_b(i_turns), wp)
      difference([gearbox%i_dissipated, gearbox%i_work]) = 0
      distance = maxval(abs(difference)/scale)
      do i = 1, size(gearbox%contacts)
         distance = max(distance, abs(reals_a(i) - reals_b(i))/gearbox%contacts(i)%rate_scale)
      end do
      do i = 1, gearbox%n_integers
         if (i /= i_turns .and. integers_a(i) /= integers_b(i)) distance = ieee_value(distance, ieee_positive_inf)
      end do
   end function state_distance

   !> Transfer a state of a similar gearbox with other parameters to this gearbox. Prescribed speeds become those of its loads, and
   !> all wheels turn accordingly. Penetrations are unchanged. Tooth pairs and their modes follow from the positions of its teeth.
   !> Errors: code_out_of_domain if a law cannot be evaluated there.
   subroutine take_over(gearbox, alike, t, y, yp, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      logical, intent(in) :: alike !! the other gearbox has as many tooth contacts: approach speeds are retained
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(gearbox%n_states)
      real(wp), intent(out) :: yp(gearbox%n_states)
      integer, intent(inout) :: integers(gearbox%n_integers) !! not alike: only the revolutions are used
      real(wp), intent(inout) :: reals(size(gearbox%contacts))
      type(status_t), intent(inout) :: status
      type(contact_mode) :: before(size(gearbox%contacts)), mode
      integer :: m, turns

      if (alike) then
         do m = 1, size(gearbox%contacts)
            call take_mode(gearbox, m, integers, reals, before(m))
         end do
      end if
      turns = integers(i_turns)
      integers = 0
      integers(i_turns) = turns
      reals = 0
      call take_speeds(gearbox, t, y, integers)
      call assign_pairs(gearbox, y, integers)
      call settle_start(gearbox, t, y, integers, reals, status)
      if (has_failed(status)) return
      do m = 1, merge(size(gearbox%contacts), 0, alike)
         call take_mode(gearbox, m, integers, reals, mode)
         if (mode%tooth_pair /= before(m)%tooth_pair .or. .not. (touches(mode) .and. touches(before(m)))) cycle
         reals(m) = before(m)%v0
      end do
      call gearbox_derivative(gearbox, t, y, integers, reals, yp, status)
   end subroutine take_over

   !> Set prescribed speeds: the first one changes the speeds of all wheels.
   subroutine take_speeds(gearbox, t, y, integers)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      logical :: is_taken
      real(wp) :: change
      integer :: i

      is_taken = .false.
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%prescribed == 0) cycle
            change = prescribed_speed(gearbox, wheel%prescribed, t, integers) - followed_speed(gearbox, i, t, y)
            if (.not. is_taken) then
               y(i_omega) = y(i_omega) + change/wheel%ratio
            else if (wheel%i_psi > 0) then
               y(wheel%i_psi + 1) = y(wheel%i_psi + 1) + change
            end if
            is_taken = .true.
         end associate
      end do
   end subroutine take_speeds

end module evl_state_transfer
