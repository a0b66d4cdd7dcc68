!> Contributions of wheels, supports, shafts and tooth contacts to dF/dy, with F = y' - f. All integrators use these derivatives, as
!> a full matrix or as listed entries (radau).
!>
!> A row of psi' contains the contributions to its rotor until `couple_reference` completes it.
module evl_force_jacobian
   use evl_contact_gradient, only: force_gradient, mesh_force_gradient, point_gradient
   use evl_contact_point, only: contact_gradient
   use evl_contacts_at_state, only: flank_cache, look_at_forces
   use evl_flank, only: flank_t
   use evl_gearbox, only: add_turn, gearbox_t, of_angle, of_speed, wheel_speed
   use evl_housing, only: at_omega, frame_t, housing_frame
   use evl_housing_jacobian, only: ride_gradient
   use evl_jacobian_entries, only: add_entry, add_row, jacobian_entries, listed_entries, n_noted, note_entries, sort_entries, &
                                   take_noted
   use evl_kinds, only: wp
   use evl_load, only: load_t
   use evl_local_variables, only: i_omega, i_theta, local_link, n_local, wheel_link
   use evl_shaft, only: shaft_t, shaft_torque, shaft_twist
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: contact_state, no_force, touches
   use evl_wheel_loads, only: evaluate_load, load_terms, lost_power, wheel_acceleration, wheel_follows_ground
   implicit none (type, external)
   private

   public :: add_constants, add_forces, couple_reference, find_pattern, scatter

contains

   !> Entries that df/dy may have in any discrete state, column by column; for a housing that is not mounted.
   subroutine find_pattern(gearbox, rows, columns)
      type(gearbox_t), intent(in) :: gearbox
      integer, allocatable, intent(out) :: rows(:), columns(:)
      real(wp), allocatable :: notes(:)
      type(jacobian_entries) :: entries
      integer :: capacity, i, turn

      capacity = 256 ! enough for most gearboxes
      do
         call note_entries(gearbox%n_states, capacity, entries)
         notes = [(0.0_wp, i=0, capacity)]
         call note_forces(gearbox, entries, notes)
         if (n_noted(notes) <= capacity) exit
         capacity = n_noted(notes)
      end do
      call take_noted(gearbox%n_states, notes, rows, columns)
      call listed_entries(gearbox%n_states, rows, columns, entries)
      associate (wheels => gearbox%wheels, of_reference => entries%columns(entries%start(i_omega):entries%start(i_omega + 1) - 1))
         do i = 1, size(wheels)
            if (wheels(i)%leader /= i .or. wheels(i)%i_psi == 0) cycle
            rows = [rows, (wheels(i)%i_speed, turn=1, size(of_reference))]
            columns = [columns, of_reference]
         end do
      end associate
      call sort_entries(gearbox%n_states, rows, columns)
   end subroutine find_pattern

   !> Record all entries that are added to, except those of `couple_reference`.
   subroutine note_forces(gearbox, entries, notes)
      type(gearbox_t), intent(in) :: gearbox
      type(jacobian_entries), intent(in) :: entries !! in recording mode
      real(wp), intent(inout) :: notes(entries%n_entries)
      real(wp) :: y(gearbox%n_states), reals(size(gearbox%contacts))
      integer :: integers(gearbox%n_integers)
      type(frame_t) :: frame
      type(status_t) :: status

      y = 0
      integers = 0
      reals = 0
      call housing_frame(gearbox%housing, 0.0_wp, y, frame)
      call add_constants(gearbox, entries, notes)
      call add_forces(gearbox, 0.0_wp, y, integers, reals, frame, entries, notes, status)
   end subroutine note_forces

   !> Add the constant entries: rates that are states themselves, supports and elastic shafts.
   pure subroutine add_constants(gearbox, entries, values)
      type(gearbox_t), intent(in) :: gearbox
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)
      integer :: i, j

      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i), support => gearbox%wheels(i)%support)
            if (wheel%leader == i .and. wheel%i_psi > 0) call add_entry(entries, wheel%i_psi, wheel%i_psi + 1, -1.0_wp, values)
            do j = 1, support%n
               associate (s => support%i_state(j))
                  call add_entry(entries, s, s + 1, -1.0_wp, values)
                  call add_entry(entries, s + 1, s, support%stiffness(j)*support%per_mass, values)
                  call add_entry(entries, s + 1, s + 1, support%damping(j)*support%per_mass, values)
               end associate
            end do
         end associate
      end do
      call add_entry(entries, i_theta, i_omega, -1.0_wp, values)
      do i = 1, size(gearbox%shafts)
         call add_shaft_torque(gearbox, gearbox%shafts(i), entries, values)
      end do
   end subroutine add_constants

   !> Add all other contributions of the forces.
   subroutine add_forces(gearbox, t, y, integers, reals, frame, entries, values, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      type(frame_t), intent(in) :: frame !! of a housing that acts
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)
      type(status_t), intent(inout) :: status
      type(load_terms) :: all_terms(size(gearbox%loads))
      real(wp) :: spin
      integer :: i

      spin = 0
      if (gearbox%housing%acts) spin = frame%omega(3)
      do i = 1, size(gearbox%loads)
         call evaluate_load(gearbox, i, t, y, integers, spin, all_terms(i))
         call add_load(gearbox, gearbox%loads(i)%load, all_terms(i), entries, values)
      end do
      do i = 1, size(gearbox%flanks)
         call add_flank(gearbox, gearbox%flanks(i)%flank, y, spin, integers, reals, entries, values, status)
         if (has_failed(status)) return
      end do
      do i = 1, size(gearbox%shafts)
         call add_shaft(gearbox, gearbox%shafts(i), y, spin, entries, values)
      end do
      do i = 1, size(gearbox%wheels)
         call add_powers(gearbox, i, y, integers, entries, values)
         if (gearbox%housing%acts) call ride_gradient(gearbox, i, t, y, integers, frame, entries, values)
      end do
      do i = 1, size(gearbox%loads)
         call add_load_power(gearbox, gearbox%loads(i)%load, all_terms(i), y, entries, values)
      end do
      do i = 1, size(gearbox%losses)
         call add_lost_power(gearbox, gearbox%losses(i), t, y, integers, spin, entries, values)
      end do
   end subroutine add_forces

   !> Power dissipated in the dampers of a wheel's support, and the power that drives a prescribed speed.
   pure subroutine add_powers(gearbox, index, y, integers, entries, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)
      integer :: j

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support)
         do j = 1, support%n
            associate (rate => support%i_state(j) + 1)
               call add_entry(entries, gearbox%i_dissipated, rate, -2*support%damping(j)*y(rate), values)
            end associate
         end do
         if (wheel%prescribed > 0) &
            call add_turn(wheel, of_speed, gearbox%i_work, -wheel%inertia*wheel_acceleration(gearbox, index, 0.0_wp, integers), &
                          entries, &
                          values)
      end associate
   end subroutine add_powers

   !> Dependence of the torque of a load on its wheel; it does not accelerate a wheel with prescribed speed.
   pure subroutine add_load(gearbox, load, terms, entries, values)
      type(gearbox_t), intent(in) :: gearbox
      class(load_t), intent(in) :: load
      type(load_terms), intent(in) :: terms
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)

      associate (wheel => gearbox%wheels(load%wheel))
         if (wheel%prescribed > 0) return
         if (load%by_speed) call add_turn(wheel, of_speed, wheel%i_speed, terms%damping*wheel%per_inertia, entries, values)
         if (load%by_angle) call add_turn(wheel, of_angle, wheel%i_speed, terms%stiffness*wheel%per_inertia, entries, values)
      end associate
   end subroutine add_load

   !> Power of a load on a wheel without prescribed speed, except for the effect of the housing rotation on its torque.
   pure subroutine add_load_power(gearbox, load, terms, y, entries, values)
      type(gearbox_t), intent(in) :: gearbox
      class(load_t), intent(in) :: load
      type(load_terms), intent(in) :: terms
      real(wp), intent(in) :: y(gearbox%n_states)
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)
      real(wp) :: omega

      associate (wheel => gearbox%wheels(load%wheel))
         if (wheel%prescribed > 0) return
         omega = wheel_speed(wheel, y)
         call add_turn(wheel, of_speed, gearbox%i_work, terms%damping*omega - terms%torque, entries, values)
         if (load%by_angle) call add_turn(wheel, of_angle, gearbox%i_work, terms%stiffness*omega, entries, values)
      end associate
   end subroutine add_load_power

   !> Power of a loss, which is dissipated instead of negative work.
   pure subroutine add_lost_power(gearbox, index, t, y, integers, spin, entries, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index !! index of the load
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: spin !! Omega_z of the housing [rad/s]
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)
      real(wp) :: power, slope
      integer :: i, rows(2)

      call lost_power(gearbox, index, t, y, integers, spin, power, slope)
      rows = [gearbox%i_dissipated, gearbox%i_work]
      associate (load => gearbox%loads(index)%load, o => gearbox%housing%i_state + at_omega + 2)
         do i = 1, size(rows)
            call add_turn(gearbox%wheels(load%wheel), of_speed, rows(i), -slope, entries, values)
            if (gearbox%housing%is_mounted .and. .not. load%against_housing) &
               call add_entry(entries, rows(i), o, -slope, values)
         end do
      end associate
   end subroutine add_lost_power

   !> Touching contacts of a flank, in the rows of their wheels, the supports and the energies.
   subroutine add_flank(gearbox, flank, y, spin, integers, reals, entries, values, status)
      type(gearbox_t), intent(in) :: gearbox
      class(flank_t), intent(in) :: flank
      real(wp), intent(in) :: y(gearbox%n_states), spin, reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)
      type(status_t), intent(inout) :: status
      type(contact_state) :: at(size(gearbox%contacts))
      type(contact_gradient) :: d(size(gearbox%contacts))
      type(mesh_force_gradient) :: gradient
      type(flank_cache) :: cache
      integer :: m

      if (.not. entries%notes) call look_at_forces(gearbox, flank%first, flank%last, y, integers, reals, cache, at, status)
      if (has_failed(status)) return
      do m = flank%first, flank%last
         if (entries%notes) cycle
         if (touches(at(m)%mode)) call point_gradient(gearbox%contacts(m), cache%line, at(m), d(m))
      end do
      do m = flank%first, flank%last
         if (entries%notes) then ! each contact may touch
            at(m)%force = no_force
            gradient = mesh_force_gradient(torque_a=0.0_wp, torque_b=0.0_wp, on_a=0.0_wp, dissipation=0.0_wp)
         else
            if (.not. touches(at(m)%mode)) cycle
            call force_gradient(flank, gearbox%contacts, at, d, m, gradient)
         end if
         associate (contact => gearbox%contacts(m), force => at(m)%force)
            call add_torque(gearbox, contact%links, contact%wheel_a, force%torque_a, gradient%torque_a, y, spin, entries, values)
            call add_torque(gearbox, contact%links, contact%wheel_b, force%torque_b, gradient%torque_b, y, spin, entries, values)
            call add_push(contact%links, contact%link_a, gearbox%wheels(contact%wheel_a)%support%per_mass, gradient%on_a, entries, &
                          values)
            call add_push(contact%links, contact%link_b, -gearbox%wheels(contact%wheel_b)%support%per_mass, gradient%on_a, &
                          entries, values)
            call scatter(contact%links, gearbox%i_dissipated, -1.0_wp, gradient%dissipation, entries, values)
         end associate
      end do
   end subroutine add_flank

   !> Acceleration of the rotors by the torque of a shaft; these entries are constant.
   pure subroutine add_shaft_torque(gearbox, shaft, entries, values)
      type(gearbox_t), intent(in) :: gearbox
      type(shaft_t), intent(in) :: shaft
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)
      type(local_link) :: links(4)
      integer :: n

      if (shaft%rigid) return
      call link_shaft(shaft, links, n)
      associate (a => gearbox%wheels(shaft%wheel_a), b => gearbox%wheels(shaft%wheel_b), gradient => [shaft%stiffness, &
                                                                                                      shaft%damping])
         if (a%prescribed == 0) call scatter(links(:n), a%i_speed, a%per_inertia, gradient, entries, values)
         if (b%prescribed == 0) call scatter(links(:n), b%i_speed, -b%per_inertia, gradient, entries, values)
      end associate
   end subroutine add_shaft_torque

   !> Powers of a shaft: dissipation by its damping, and work of a load that prescribes the speed of one of its wheels.
   pure subroutine add_shaft(gearbox, shaft, y, spin, entries, values)
      type(gearbox_t), intent(in) :: gearbox
      type(shaft_t), intent(in) :: shaft
      real(wp), intent(in) :: y(gearbox%n_states), spin
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)
      type(local_link) :: links(4)
      real(wp) :: torque
      integer :: n

      if (shaft%rigid) return
      call link_shaft(shaft, links, n)
      torque = shaft_torque(shaft, y)
      associate (a => shaft%wheel_a, b => shaft%wheel_b, gradient => [shaft%stiffness, shaft%damping])
         if (gearbox%wheels(a)%prescribed > 0) &
            call add_torque(gearbox, links(:n), a, -torque, -gradient, y, spin, entries, values)
         if (gearbox%wheels(b)%prescribed > 0) call add_torque(gearbox, links(:n), b, torque, gradient, y, spin, entries, values)
      end associate
      call scatter(links(:n), gearbox%i_dissipated, -2*shaft%damping*shaft_twist(shaft, y, 1), [0.0_wp, 1.0_wp], entries, values)
   end subroutine add_shaft

   !> Twist of a shaft and its rate, the local variables of its torque, in terms of the state.
   pure subroutine link_shaft(shaft, links, n)
      type(shaft_t), intent(in) :: shaft
      type(local_link), intent(out) :: links(4)
      integer, intent(out) :: n !! number of links
      integer :: i

      n = 0
      do i = 1, 2
         associate (psi => merge(shaft%i_psi_a, shaft%i_psi_b, i == 1), weight => real(3 - 2*i, wp))
            if (psi == 0) cycle
            links(n + 1:n + 2) = [local_link(1, psi, weight), local_link(2, psi + 1, weight)]
            n = n + 2
         end associate
      end do
   end subroutine link_shaft

   !> Torque of a contact or a shaft on a wheel: it accelerates the wheel or, for a prescribed speed, is balanced by the load.
   pure subroutine add_torque(gearbox, links, index, torque, gradient, y, spin, entries, values)
      type(gearbox_t), intent(in) :: gearbox
      type(local_link), intent(in), contiguous :: links(:)
      integer, intent(in) :: index !! index of the wheel
      real(wp), intent(in) :: torque, gradient(*), y(gearbox%n_states), spin
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)

      associate (wheel => gearbox%wheels(index), work => gearbox%i_work)
         if (wheel%prescribed == 0) then
            call scatter(links, wheel%i_speed, -wheel%per_inertia, gradient, entries, values)
            return
         end if
         call scatter(links, work, wheel_speed(wheel, y), gradient, entries, values)
         call add_turn(wheel, of_speed, work, torque, entries, values)
         if (.not. (gearbox%housing%is_mounted .and. wheel_follows_ground(gearbox, index))) return
         ! the torque of a speed prescribed relative to the ground balances it, and acts on the housing
         associate (o => gearbox%housing%i_state + at_omega + 2)
            call scatter(links, work, spin, gradient, entries, values)
            call scatter(links, o, 1.0_wp, gradient, entries, values)
            call add_entry(entries, work, o, torque, values)
         end associate
      end associate
   end subroutine add_torque

   !> Force of a contact on the support of a wheel.
   pure subroutine add_push(links, wheel, per_mass, gradient, entries, values)
      type(local_link), intent(in), contiguous :: links(:)
      type(wheel_link), intent(in) :: wheel
      real(wp), intent(in) :: per_mass !! inverse mass; negative for B, where the force is opposite
      real(wp), intent(in) :: gradient(n_local, 2)
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)
      real(wp) :: along
      integer :: i, j

      do j = 1, wheel%n
         do i = 1, size(links)
            associate (link => links(i))
               along = wheel%along_t(j)*gradient(link%local, 1) + wheel%along_e(j)*gradient(link%local, 2)
               call add_entry(entries, wheel%i_state(j) + 1, link%state, -per_mass*link%weight*along, values)
            end associate
         end do
      end do
   end subroutine add_push

   !> Add a multiple of derivatives with respect to local variables to a row.
   pure subroutine scatter(links, row, factor, gradient, entries, values)
      type(local_link), intent(in), contiguous :: links(:)
      integer, intent(in) :: row
      real(wp), intent(in) :: factor, gradient(*)
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)
      integer :: i

      do i = 1, size(links)
         call add_entry(entries, row, links(i)%state, factor*links(i)%weight*gradient(links(i)%local), values)
      end do
   end subroutine scatter

   !> Complete the rows of the rotors' speeds: psi'' = phi'' - g theta''.
   pure subroutine couple_reference(gearbox, entries, values)
      type(gearbox_t), intent(in) :: gearbox
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)
      integer :: i

      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%leader == i .and. wheel%i_psi > 0) call add_row(entries, i_omega, wheel%i_speed, -wheel%ratio, values)
         end associate
      end do
   end subroutine couple_reference

end module evl_force_jacobian
