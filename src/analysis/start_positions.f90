!> Positions and speeds for initial states, and the rotation of wheels, which is the position of outputs over position. Both are
!> linear in the state for constant integers.
module evl_start_positions
   use evl_contact_modes, only: mode_at
   use evl_contact_roots, only: ends_of_path, pitches_since_handover
   use evl_discrete_state, only: put_pair
   use evl_gearbox, only: gearbox_local, gearbox_t, i_turns, wheel_speed
   use evl_kinds, only: pi, wp
   use evl_local_variables, only: i_theta
   use evl_pair_sequence, only: pair_on_path
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: contact_state, flanks_off, flanks_open, locate_anywhere, nominal_rho, nominal_start
   use evl_wheel_loads, only: segment_of, turns_of_wheel
   implicit none (type, external)
   private

   public :: can_turn, closed_form_point, find_coupled_modes, find_mode, gearbox_state, mesh_position, pitches_turned, &
             assign_pairs, prescribed_speed, set_gaps, turns_made

   real(wp), parameter :: at_the_end = 1.0e-10_wp !! in pitches: tolerance for a pair to be on the path

   !> A state of a gearbox.
   type :: gearbox_state
      real(wp) :: t = 0.0_wp             !! [s]
      real(wp), allocatable :: y(:)      !! [n_states]
      integer, allocatable :: integers(:) !! [n_integers] discrete state
      real(wp), allocatable :: reals(:)  !! [contacts] discrete state
   end type gearbox_state

contains

   !> Position of a mesh, from 0 to 1: pitches from the start of contact to its last tooth pair, by the angle of the driving wheel.
   pure real(wp) function mesh_position(gearbox, index, y, turns) result(pitches)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index    !! of the mesh
      real(wp), intent(in) :: y(:)
      integer, intent(in) :: turns
      real(wp) :: theta

      theta = y(i_theta)
      associate (contact => gearbox%contacts(gearbox%first(index)))
         associate (driving => gearbox%wheels(contact%wheel_a))
            if (driving%i_psi > 0) theta = theta + y(driving%i_psi)/driving%ratio
         end associate
         pitches = (nominal_rho(contact, theta, turns, 0) - contact%rho_entry)/contact%base_pitch
      end associate
      pitches = pitches - floor(pitches + at_the_end)
      if (abs(pitches) < at_the_end) pitches = 0
   end function mesh_position

   !> Speed prescribed by a load at time t [rad/s].
   pure real(wp) function prescribed_speed(gearbox, load, t, integers) result(speed)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: load, integers(:)
      real(wp), intent(in) :: t

      speed = gearbox%loads(load)%load%speed(t, segment_of(gearbox%loads(load)%load, integers))
   end function prescribed_speed

   !> Rotate the wheels, starting at the reference wheel, until every mesh has the given penetration; shafts are not twisted.
   pure subroutine set_gaps(gearbox, penetrations, y)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: penetrations(:) !! of the meshes [m]
      real(wp), intent(inout) :: y(:)
      logical :: is_set(size(gearbox%wheels)), found
      real(wp) :: psi(size(gearbox%wheels)), arc
      integer :: m

      is_set = .false.
      is_set(gearbox%reference) = .true.
      psi = 0
      found = .true.
      do while (found)
         found = .false.
         do m = 1, size(gearbox%pairs)
            associate (contact => gearbox%contacts(gearbox%first(m)))
               associate (a => contact%wheel_a, b => contact%wheel_b)
                  if (is_set(a) .eqv. is_set(b)) cycle
                  arc = -contact%pair%sigma*penetrations(m) ! equals r_bA psi_A + r_bB psi_B
                  if (is_set(a)) then
                     psi(b) = (arc - contact%pair%r_ba*psi(a))/contact%pair%r_bb
                  else
                     psi(a) = (arc - contact%pair%r_bb*psi(b))/contact%pair%r_ba
                  end if
                  is_set(a) = .true.
                  is_set(b) = .true.
               end associate
            end associate
            found = .true.
         end do
         do m = 1, size(gearbox%shafts)
            associate (a => gearbox%shafts(m)%wheel_a, b => gearbox%shafts(m)%wheel_b)
               if (is_set(a) .eqv. is_set(b)) cycle
               psi(merge(b, a, is_set(a))) = psi(merge(a, b, is_set(a)))
               is_set([a, b]) = .true.
               found = .true.
            end associate
         end do
      end do
      do m = 1, size(gearbox%wheels)
         if (gearbox%wheels(m)%i_psi > 0) y(gearbox%wheels(m)%i_psi) = psi(m)
      end do
   end subroutine set_gaps

   !> Assign to every slot the tooth pair that is on the path of contact, or the next one that enters it.
   subroutine assign_pairs(gearbox, y, integers)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(:)
      integer, intent(inout) :: integers(:)
      type(contact_state) :: at
      real(wp) :: near, far, moved
      integer :: m, pair

      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m))
            pair = contact%slot
            call put_pair(contact, pair, flanks_open, integers)
            call closed_form_point(gearbox, m, y, integers(i_turns), pair, at)
            call ends_of_path(gearbox%flanks(contact%i_flank)%flank, contact, at%point, near, far)
            ! on handover, a pair keeps its load within one pitch forward and back, unless a gap has moved it farther
            if (contact%handover .and. .not. abs(y(i_theta)) > 0 .and. near > -1 .and. far >= -at_the_end) then
               moved = pitches_since_handover(contact, at)
               if (abs(moved) > 1) call put_pair(contact, pair_on_path(contact, pair, moved + at_the_end), flanks_open, integers)
               cycle
            end if
            pair = pair_on_path(contact, pair, near + at_the_end)
            call put_pair(contact, pair, flanks_open, integers)
            if (contact%handover) cycle
            call closed_form_point(gearbox, m, y, integers(i_turns), pair, at)
            call ends_of_path(gearbox%flanks(contact%i_flank)%flank, contact, at%point, near, far)
            if (far < -at_the_end) call put_pair(contact, pair + contact%n_slots, flanks_off, integers)
         end associate
      end do
   end subroutine assign_pairs

   !> Closed-form evaluation of a tooth contact, whatever its tracking, including flank deviations.
   subroutine closed_form_point(gearbox, index, y, turns, teeth, at)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index, turns, teeth
      real(wp), intent(in) :: y(:)
      type(contact_state), intent(inout) :: at !! tooth pair and zones of its mode are set

      associate (contact => gearbox%contacts(index))
         call gearbox_local(gearbox, contact, y, at%q)
         at%mode%tooth_pair = teeth
         at%rho_a0 = nominal_rho(contact, y(i_theta), turns, teeth)
         call locate_anywhere(contact, .true., at)
      end associate
   end subroutine closed_form_point

   !> Rotation of the driving wheel of a mesh, in pitches, from the position where its unloaded tooth pair 0 is at the start of
   !> contact: the position of the static analysis. It grows in the nominal sense of rotation. Equation N1.
   pure real(wp) function pitches_turned(gearbox, mesh, y, integers) result(pitches)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh, integers(gearbox%n_integers)
      real(wp), intent(in) :: y(gearbox%n_states)

      associate (contact => gearbox%contacts(gearbox%first(mesh)))
         associate (wheel => gearbox%wheels(contact%wheel_a), rho => nominal_start(contact, integers(i_turns), 0))
            pitches = contact%pair%advance*y(i_theta)
            if (wheel%i_psi > 0) pitches = pitches - contact%pair%sigma*contact%pair%r_ba*y(wheel%i_psi)
            pitches = (pitches + (rho - contact%rho_entry))/contact%base_pitch
         end associate
      end associate
   end function pitches_turned

   !> Revolutions of a wheel since its start position, positive in its nominal sense of rotation, which the first mesh defines.
   pure real(wp) function turns_made(gearbox, index, y, integers) result(turns)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index !! of the wheel
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp) :: whole, angle

      associate (wheel => gearbox%wheels(index))
         call turns_of_wheel(wheel, integers, whole, angle)
         angle = angle + wheel%ratio*y(i_theta)
         if (wheel%i_psi > 0) angle = angle + y(wheel%i_psi)
         turns = sign(1.0_wp, gearbox%contacts(1)%pair%advance*wheel%ratio)*(whole + angle/(2*pi))
      end associate
   end function turns_made

   !> Whether a wheel turns or can turn: wheels move at the start, or a load or the housing moves it. All wheels are connected.
   pure logical function can_turn(gearbox, index, y, yp) result(may)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index            !! of the wheel
      real(wp), intent(in) :: y(gearbox%n_states), yp(gearbox%n_states)     !! at the start
      integer :: i

      associate (prescribed => gearbox%wheels(index)%prescribed)
         may = gearbox%housing%acts .or. gearbox%nominal%torque_scale > 0 .or. gearbox%nominal%speed_scale > 0
         if (prescribed > 0) may = gearbox%loads(prescribed)%load%fastest > 0
         if (prescribed > 0 .or. may) return
      end associate
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            may = may .or. abs(wheel_speed(wheel, y)) > 0 .or. abs(wheel_speed(wheel, yp)) > 0
         end associate
      end do
   end function can_turn

   !> Modes of the contacts that share their load with others: each depends on the modes of the others.
   subroutine find_coupled_modes(gearbox, at, status)
      type(gearbox_t), intent(in) :: gearbox
      type(contact_state), intent(inout) :: at(*) !! of all contacts, with their points
      type(status_t), intent(inout) :: status     !! as from `mode_at`
      integer :: first, last, m

      do m = 1, size(gearbox%contacts)
         if (at(m)%mode%flanks == flanks_off) cycle
         call gearbox%flanks(gearbox%contacts(m)%i_flank)%flank%loaded_pairs_range(m, first, last)
         if (first < last) call find_mode(gearbox, m, at, status)
         if (has_failed(status)) return
      end do
   end subroutine find_coupled_modes

   !> Mode of a tooth pair on the path, by its points and those of the contacts that share its load.
   subroutine find_mode(gearbox, m, at, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m                    !! index of the contact
      type(contact_state), intent(inout) :: at(*)
      type(status_t), intent(inout) :: status     !! as from `mode_at`
      integer :: first, last

      associate (flank => gearbox%flanks(gearbox%contacts(m)%i_flank)%flank)
         call flank%loaded_pairs_range(m, first, last)
         call mode_at(flank, gearbox%contacts, m, first, last, at, status)
      end associate
   end subroutine find_mode

end module evl_start_positions
