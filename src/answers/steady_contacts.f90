!> Tooth pairs of a static equilibrium: positions to begin with, and which pairs carry load at given positions.
module evl_steady_contacts
   use evl_contact_modes, only: mode_at
   use evl_discrete_state, only: flanks_of, gearbox_store_mode, take_mode, tooth_pair_of
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_start_positions, only: closed_form_point, gearbox_state, place_pairs, set_gaps
   use evl_status, only: code_no_solution, fail, has_failed, quantity, status_t, subject_initial
   use evl_tooth_contact, only: contact_state, flank_drive, flanks_loaded, flanks_off, settle_friction
   implicit none (type, external)
   private

   public :: load_all, press_flanks

contains

   !> Positions to begin with: every mesh has about its static penetration, on the pair that is nearest to it.
   subroutine press_flanks(gearbox, state)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      real(wp) :: penetrations(size(gearbox%pairs)), wanted(size(gearbox%pairs)), largest(size(gearbox%pairs))
      type(contact_state) :: at(size(gearbox%contacts))
      integer :: i

      wanted = merge(0.0_wp, gearbox%contacts(gearbox%first(:size(wanted)))%h_scale, &
                     gearbox%contacts(gearbox%first(:size(wanted)))%rigid)
      penetrations = wanted
      do i = 1, merge(2, 1, any(gearbox%contacts%deviates))
         call set_gaps(gearbox, penetrations, state%y)
         call look_at_pairs(gearbox, state, at, largest)
         where (largest > -huge(largest)) penetrations = penetrations + wanted - largest
      end do
      do i = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(i))
            if (contact%leads .and. contact%flank == flank_drive) state%y(contact%i_normal) = contact%force_scale
         end associate
      end do
   end subroutine press_flanks

   !> The tooth pairs that carry load at y: those that overlap and push, and on every drive flank at least the nearest one; every
   !> friction branch as the speeds say.
   subroutine load_all(gearbox, state, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(status_t), intent(inout) :: status
      type(contact_state) :: at(size(gearbox%contacts))
      real(wp) :: largest(size(gearbox%pairs))
      logical :: carried(size(gearbox%pairs))
      integer :: first, last, m, pass

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
               call take_mode(gearbox, m, state%integers, state%reals, mode)
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
               call gearbox_store_mode(gearbox, m, mode, state%integers, state%reals)
            end associate
         end do
      end do
   end subroutine load_all

   !> Put the tooth pairs that are on the path into their slots, and find their contacts and the largest penetration of every
   !> mesh's drive flank; -huge if none is on the path.
   subroutine look_at_pairs(gearbox, state, at, largest)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(inout) :: state
      type(contact_state), intent(inout) :: at(*)
      real(wp), intent(out) :: largest(:) !! [m]
      integer :: m

      call place_pairs(gearbox, state%y, state%integers)
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
