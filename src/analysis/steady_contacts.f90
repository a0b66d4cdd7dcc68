!> Tooth pairs of a static equilibrium: initial positions, and loaded pairs at given positions.
module evl_steady_contacts
   use evl_discrete_state, only: flanks_of, gearbox_store_mode, take_mode, tooth_pair_of
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_start_positions, only: assign_pairs, closed_form_point, find_coupled_modes, find_mode, gearbox_state, set_gaps
   use evl_status, only: code_no_solution, fail, has_failed, quantity, status_t, subject_initial
   use evl_tooth_contact, only: contact_state, flank_drive, flanks_loaded, flanks_off, settle_friction
   implicit none (type, external)
   private

   public :: load_all, press_flanks

contains

   !> Initial positions: every mesh has approximately its static penetration, at the tooth pair with the largest penetration.
   subroutine press_flanks(gearbox, state)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      real(wp) :: penetrations(size(gearbox%pairs)), nominal(size(gearbox%pairs)), largest(size(gearbox%pairs))
      type(contact_state) :: at(size(gearbox%contacts))
      integer :: i

      nominal = merge(0.0_wp, gearbox%contacts(gearbox%first(:size(nominal)))%h_scale, &
                      gearbox%contacts(gearbox%first(:size(nominal)))%rigid)
      penetrations = nominal
      do i = 1, merge(2, 1, any(gearbox%contacts%deviates))
         call set_gaps(gearbox, penetrations, state%y)
         call look_at_pairs(gearbox, state, at, largest)
         where (largest > -huge(largest)) penetrations = penetrations + nominal - largest
      end do
      do i = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(i))
            if (contact%leads .and. contact%flank == flank_drive) state%y(contact%i_normal) = contact%force_scale
         end associate
      end do
   end subroutine press_flanks

   !> Set the loaded tooth pairs at y: those that overlap with a compressive force, and at least the nearest pair of every drive
   !> flank. Friction branches follow from the speeds.
   subroutine load_all(gearbox, state, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(status_t), intent(inout) :: status
      type(contact_state) :: at(size(gearbox%contacts))
      real(wp) :: largest(size(gearbox%pairs))
      logical :: is_loaded(size(gearbox%pairs))
      integer :: m, pass

      call look_at_pairs(gearbox, state, at, largest)
      m = minloc(largest, dim=1)
      if (.not. largest(m) > -huge(largest)) then
         call fail(status, code_no_solution, "there is no steady state: under load no tooth pair of a mesh of contact ratio " &
                   //quantity(gearbox%pairs(m)%contact_ratio, "")//" is on the path of contact at the start; start from rest or" &
                   //" with given speeds", subject_initial, field="kind")
         return
      end if
      do m = 1, size(gearbox%contacts)
         call take_mode(gearbox, m, state%integers, state%reals, at(m)%mode)
      end do
      call find_coupled_modes(gearbox, at, status)
      if (has_failed(status)) return
      is_loaded = .false.
      do pass = 1, 2 ! first overlapping pairs under compression, then the nearest pair if there are none
         do m = 1, size(gearbox%contacts)
            associate (contact => gearbox%contacts(m), drives => gearbox%contacts(m)%flank == flank_drive, mode => at(m)%mode)
               call take_mode(gearbox, m, state%integers, state%reals, mode)
               if (mode%flanks == flanks_off .or. (contact%rigid .and. .not. drives)) cycle
               if (pass == 1) then
                  call find_mode(gearbox, m, at, status)
                  if (has_failed(status)) return
                  mode%sides = 0 ! given by the rates, which the solution still changes
                  mode%v0 = 0    ! no approach precedes the start
                  if (contact%rigid) mode%flanks = flanks_loaded ! on the path it carries load
                  if (drives .and. mode%flanks == flanks_loaded) is_loaded(contact%mesh) = .true.
               else if (drives .and. .not. is_loaded(contact%mesh) .and. at(m)%point%h >= largest(contact%mesh)) then
                  mode%flanks = flanks_loaded
               end if
               if (mode%flanks == flanks_loaded) mode%friction = settle_friction(contact, at(m)%point)
               call gearbox_store_mode(gearbox, m, mode, state%integers, state%reals)
            end associate
         end do
      end do
   end subroutine load_all

   !> Assign the tooth pairs on the path to their slots, and compute their contacts. largest: maximum penetration of every drive
   !> flank; -huge if no pair is on the path.
   subroutine look_at_pairs(gearbox, state, at, largest)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(contact_state), intent(inout) :: at(*)
      real(wp), intent(out) :: largest(:) !! [m]
      integer :: m

      call assign_pairs(gearbox, state%y, state%integers)
      largest = -huge(largest)
      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m))
            if (flanks_of(contact, state%integers) == flanks_off) cycle
            call closed_form_point(gearbox, m, state%y, 0, tooth_pair_of(contact, state%integers), at(m))
            if (contact%flank == flank_drive) largest(contact%mesh) = max(largest(contact%mesh), at(m)%point%h)
         end associate
      end do
   end subroutine look_at_pairs

end module evl_steady_contacts
