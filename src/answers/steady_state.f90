!> The steady state of a gearbox: nothing accelerates, and where flanks deviate the wheels follow their slopes.
module evl_steady_state
   use evl_contact_modes, only: mode_at
   use evl_discrete_state, only: flanks_of, gearbox_store_mode, take_mode, tooth_pair_of
   use evl_gearbox, only: gearbox_t
   use evl_housing, only: at_omega, at_position, at_velocity
   use evl_kinds, only: wp
   use evl_local_variables, only: i_omega
   use evl_no_damping, only: no_damping_t
   use evl_nominal_point, only: speed_in_balance
   use evl_places, only: places
   use evl_start_positions, only: closed_form_point, place_pairs, prescribed_speed, set_gaps
   use evl_status, only: clear, code_no_solution, code_out_of_domain, fail, has_failed, quantity, status_t, subject_initial
   use evl_steady_newton, only: find_slopes, solve_steady, steady_system
   use evl_steady_refusals, only: check_pressed, check_steady, refuse_alternation, refuse_slope
   use evl_tooth_contact, only: contact_state, flank_drive, flanks_loaded, flanks_off, settle_friction
   use evl_wheel_loads, only: hold_still
   implicit none (type, external)
   private

   public :: find_steady_state

   integer, parameter :: max_modes = 30 !! sets of pairs in contact and friction branches that are tried

contains

   !> Positions and speeds at which nothing accelerates, by Newton's method on the closed form. Approach speeds are 0. A speed that
   !> is looked for is that of the loads to begin with, then none: at the first friction may hardly depend on it.
   !> Errors: code_no_solution, code_out_of_domain.
   subroutine find_steady_state(gearbox, t, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(status_t), intent(inout) :: status
      type(gearbox_t) :: closed
      type(status_t) :: refusal
      real(wp) :: y_begin(gearbox%n_states)
      integer :: begin(gearbox%n_integers)

      call check_steady(gearbox, integers, status)
      if (has_failed(status)) return
      closed = gearbox
      call hold_still(closed)
      y_begin = y
      begin = integers
      associate (driver => gearbox%wheels(gearbox%reference)%prescribed)
         if (driver > 0) then
            y(i_omega) = prescribed_speed(gearbox, driver, t, integers)
         else
            y(i_omega) = speed_in_balance(closed, t, integers)
         end if
         call find_from(gearbox, closed, t, y, integers, reals, status)
         if (driver > 0 .or. .not. has_failed(status)) return
      end associate
      refusal = status
      call clear(status)
      y = y_begin
      integers = begin
      y(i_omega) = 0
      call find_from(gearbox, closed, t, y, integers, reals, status)
      if (has_failed(status)) status = refusal
   end subroutine find_steady_state

   !> The same from a speed on.
   !>
   !> Where flanks deviate, the static equilibrium comes first: positions at which the forces balance without damping of the
   !> contacts. How they change along theta gives the speeds, and then the dampers take part.
   subroutine find_from(gearbox, still, t, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox, still !! still: that holds still
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(status_t), intent(inout) :: status
      type(gearbox_t) :: closed
      type(steady_system) :: system
      integer :: i

      closed = still
      call list_unknowns(gearbox, system)
      call press_flanks(gearbox, y, integers)
      reals = 0
      if (any(gearbox%contacts%deviates)) then
         do i = 1, size(closed%contacts)
            closed%contacts(i)%damping = no_damping_t()
         end do
         call settle_steady(closed, system, t, y, integers, reals, status)
         if (.not. has_failed(status)) call check_pressed(closed, t, y, integers, reals, status)
         if (.not. has_failed(status)) call find_slopes(closed, system, t, y, integers, reals, status)
         if (has_failed(status)) return
         do i = 1, size(closed%contacts)
            closed%contacts(i)%damping = gearbox%contacts(i)%damping
         end do
      end if
      call settle_steady(closed, system, t, y, integers, reals, status)
      if (.not. has_failed(status)) call check_pressed(closed, t, y, integers, reals, status)
   end subroutine find_from

   !> What is looked for. A mounted housing has a pose to be found, but it rests.
   subroutine list_unknowns(gearbox, system)
      type(gearbox_t), intent(in) :: gearbox
      type(steady_system), intent(out) :: system
      integer, allocatable :: unknown(:), row(:), speed(:), leaders(:)
      integer :: i

      leaders = places([(gearbox%wheels(i)%leader == i .and. i /= gearbox%reference, i=1, size(gearbox%wheels))])
      unknown = gearbox%wheels(leaders)%i_psi
      row = unknown + 1
      do i = 1, size(gearbox%contacts)
         ! a rigid contact determines a position by kappa = 0, and its multiplier is unknown instead
         if (gearbox%contacts(i)%leads) row = merge(unknown, row, unknown == gearbox%contacts(i)%i_dependent)
      end do
      speed = unknown + 1
      do i = 1, size(gearbox%wheels)
         associate (support => gearbox%wheels(i)%support)
            unknown = [unknown, support%i_state(:support%n)]
            row = [row, support%i_state(:support%n) + 1]
            speed = [speed, support%i_state(:support%n) + 1]
         end associate
      end do
      unknown = [unknown, gearbox%contacts(places(gearbox%contacts%leads))%i_normal]
      row = [row, gearbox%contacts(places(gearbox%contacts%leads))%i_normal]
      speed = [speed, (0, i=1, count(gearbox%contacts%leads))]
      allocate (system%speed, source=speed)
      allocate (system%slopes(size(speed)), source=0.0_wp)
      if (gearbox%wheels(gearbox%reference)%prescribed == 0) then
         unknown = [unknown, i_omega]
         row = [row, i_omega]
      end if
      if (gearbox%housing%is_mounted) then
         ! the turns of the pose stand in the places of Omega, which is 0
         unknown = [unknown, (gearbox%housing%i_state + at_position + i, i=0, 2), (gearbox%housing%i_state + at_omega + i, i=0, 2)]
         row = [row, (gearbox%housing%i_state + at_velocity + i, i=0, 5)]
      end if
      allocate (system%unknown, source=unknown)
      allocate (system%row, source=row)
   end subroutine list_unknowns

   !> Positions to begin with: every mesh has about its static penetration, on the pair that is nearest to it.
   subroutine press_flanks(gearbox, y, integers)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(inout) :: y(:)
      integer, intent(inout) :: integers(:)
      real(wp) :: penetrations(size(gearbox%pairs)), wanted(size(gearbox%pairs)), largest(size(gearbox%pairs))
      type(contact_state) :: at(size(gearbox%contacts))
      integer :: i

      wanted = merge(0.0_wp, gearbox%contacts(gearbox%first(:size(wanted)))%h_scale, &
                     gearbox%contacts(gearbox%first(:size(wanted)))%rigid)
      penetrations = wanted
      do i = 1, merge(2, 1, any(gearbox%contacts%deviates))
         call set_gaps(gearbox, penetrations, y)
         call look_at_pairs(gearbox, y, integers, at, largest)
         where (largest > -huge(largest)) penetrations = penetrations + wanted - largest
      end do
      do i = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(i))
            if (contact%leads .and. contact%flank == flank_drive) y(contact%i_normal) = contact%force_scale
         end associate
      end do
   end subroutine press_flanks

   !> Positions, speeds and modes that belong together: modes depend on positions and speeds, these on the modes.
   subroutine settle_steady(gearbox, system, t, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      type(steady_system), intent(in) :: system
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(:), reals(:)
      integer, intent(inout) :: integers(:)
      type(status_t), intent(inout) :: status
      integer :: before(gearbox%n_integers), turn
      type(status_t) :: refusal
      logical :: found

      found = .false.
      do turn = 1, max_modes
         before = integers
         call load_all(gearbox, y, integers, reals, status)
         if (has_failed(status)) exit
         if (found .and. all(integers == before)) return
         call solve_steady(gearbox, system, t, y, integers, reals, found, status)
         if (status%code == code_out_of_domain) then ! as where a soft shaft twists by more than these pairs reach
            if (.not. has_failed(refusal)) refusal = status
            call clear(status)
         else if (has_failed(status)) then
            return
         else if (.not. found) then
            exit
         end if
      end do
      if (.not. found .and. has_failed(refusal)) status = refusal
      if (has_failed(status)) return
      if (found) call refuse_alternation(gearbox, before, integers, status)
      if (.not. has_failed(status)) call refuse_slope(gearbox, y, integers, reals, status)
   end subroutine settle_steady

   !> The tooth pairs that carry load at y: those that overlap and push, and on every drive flank at least the nearest one; every
   !> friction branch as the speeds say.
   subroutine load_all(gearbox, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(:)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(status_t), intent(inout) :: status
      type(contact_state) :: at(size(gearbox%contacts))
      real(wp) :: largest(size(gearbox%pairs))
      logical :: carried(size(gearbox%pairs))
      integer :: first, last, m, pass

      call look_at_pairs(gearbox, y, integers, at, largest)
      m = minloc(largest, dim=1)
      if (.not. largest(m) > -huge(largest)) then
         call fail(status, code_no_solution, "there is no steady state: under load no tooth pair of a mesh of contact ratio " &
                   //quantity(gearbox%pairs(m)%contact_ratio, "")//" is on the path of contact at the start; start from rest or" &
                   //" with given speeds", subject_initial, field="kind")
         return
      end if
      do m = 1, size(gearbox%contacts)
         call take_mode(gearbox, m, integers, reals, at(m)%mode)
      end do
      do m = 1, size(gearbox%contacts) ! what each carries depends on what the others of its company do
         if (at(m)%mode%flanks == flanks_off) cycle
         associate (flank => gearbox%flanks(gearbox%contacts(m)%i_flank)%flank)
            call flank%company(m, first, last)
            if (first < last) call mode_at(flank, gearbox%contacts, m, first, last, at, status)
            if (has_failed(status)) return
         end associate
      end do
      carried = .false.
      do pass = 1, 2 ! first what overlaps and pushes, then the nearest pair where that is nothing
         do m = 1, size(gearbox%contacts)
            associate (contact => gearbox%contacts(m), drives => gearbox%contacts(m)%flank == flank_drive, mode => at(m)%mode, &
                       flank => gearbox%flanks(gearbox%contacts(m)%i_flank)%flank)
               call take_mode(gearbox, m, integers, reals, mode)
               if (mode%flanks == flanks_off .or. (contact%rigid .and. .not. drives)) cycle
               if (pass == 1) then
                  call flank%company(m, first, last)
                  call mode_at(flank, gearbox%contacts, m, first, last, at, status)
                  if (has_failed(status)) return
                  mode%sides = 0 ! as the rates say, which the solution still changes
                  mode%v0 = 0    ! it follows from no approach
                  if (contact%rigid) mode%flanks = flanks_loaded ! one on the path pushes
                  if (drives .and. mode%flanks == flanks_loaded) carried(contact%mesh) = .true.
               else if (drives .and. .not. carried(contact%mesh) .and. at(m)%point%h >= largest(contact%mesh)) then
                  mode%flanks = flanks_loaded
               end if
               if (mode%flanks == flanks_loaded) mode%friction = settle_friction(contact, at(m)%point)
               call gearbox_store_mode(gearbox, m, mode, integers, reals)
            end associate
         end do
      end do
   end subroutine load_all

   !> Put the tooth pairs that are on the path into their slots, and find their contacts and the largest penetration of every
   !> mesh's drive flank; -huge if none is on the path.
   subroutine look_at_pairs(gearbox, y, integers, at, largest)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(:)
      integer, intent(inout) :: integers(:)
      type(contact_state), intent(inout) :: at(*)
      real(wp), intent(out) :: largest(:) !! [m]
      integer :: m

      call place_pairs(gearbox, y, integers)
      largest = -huge(largest)
      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m))
            if (flanks_of(contact, integers) == flanks_off) cycle
            call closed_form_point(gearbox, m, y, 0, tooth_pair_of(contact, integers), at(m))
            if (contact%flank == flank_drive) largest(contact%mesh) = max(largest(contact%mesh), at(m)%point%h)
         end associate
      end do
   end subroutine look_at_pairs

end module evl_steady_state
