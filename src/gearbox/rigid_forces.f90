!> Normal forces of closed rigid contacts at a state, and impacts.
!>
!> Rates are affine in the multipliers, so one response matrix gives both. Its column k is the contribution of a unit force in
!> contact k to kappa'' of every contact, or of a unit impulse to kappa'.
module evl_rigid_forces
   use evl_contact_point, only: contact_gradient, contact_point
   use evl_discrete_state, only: flanks_of, is_closed, put_flanks
   use evl_event_log, only: moment_t
   use evl_gearbox, only: gearbox_local, gearbox_t, wheel_speed
   use evl_housing, only: at_omega, at_velocity, frame_t, housing_frame
   use evl_housing_dynamics, only: coupled_rates, ground_energies
   use evl_kinds, only: wp
   use evl_lapack, only: dgesv
   use evl_local_variables, only: i_omega, n_local
   use evl_rigid_contact, only: rigid_constraint, rigid_gradient
   use evl_status, only: code_singular, fail, has_failed, quantity, status_t, subject_mesh
   use evl_tooth_contact, only: flanks_loaded, flanks_open
   implicit none (type, external)
   private

   public :: multiplier_rates, set_multipliers, impact, open_flank

   real(wp), parameter :: time_step = 1.0e-8_wp !! for the rates of the multipliers, used only at the start of the next step [s]
   !> A multiplier this far below 0, over the force scale, is not rounding. Smaller than the distance of the root of an opening from
   !> 0 (`past` in evl_root_kinds): a contact that starts beyond that root would pull without end.
   real(wp), parameter :: pulling = 1.0e-11_wp

contains

   !> Compute the multipliers of all closed contacts; a contact that would have to pull opens. Equation T57.
   subroutine set_multipliers(gearbox, t, y, integers, reals, opened, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(gearbox%n_states) !! its multipliers are replaced, and dependent wheels are projected
      integer, intent(inout) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      logical, intent(out) :: opened(:)              !! [contacts] true for the leading contacts of flanks that had to open
      type(status_t), intent(inout) :: status
      real(wp) :: offset(gearbox%n_multipliers), response(gearbox%n_multipliers, gearbox%n_multipliers)
      real(wp) :: velocity(gearbox%n_states, gearbox%n_multipliers), force(gearbox%n_multipliers)
      integer :: closed(gearbox%n_multipliers), n, k, worst

      opened = .false.
      call close_gaps(gearbox, y, integers)
      do
         call responses(gearbox, t, y, integers, reals, closed, n, offset, response, velocity, status)
         if (has_failed(status) .or. n == 0) exit
         force(:n) = -offset(:n)
         call solve(gearbox, closed(:n), response(:n, :n), force(:n), status)
         if (has_failed(status)) return
         do k = 1, n
            y(gearbox%contacts(closed(k))%i_normal) = force(k)
         end do
         worst = minloc(force(:n)/gearbox%contacts(closed(:n))%force_scale, dim=1)
         if (force(worst) > -pulling*gearbox%contacts(closed(worst))%force_scale) exit
         call open_flank(gearbox, closed(worst), y, integers)
         opened(closed(worst)) = .true.
      end do
   end subroutine set_multipliers

   !> Open a rigid flank: set its tooth pairs open and its force to 0.
   subroutine open_flank(gearbox, index, y, integers)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index !! its leading tooth contact
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(inout) :: integers(gearbox%n_integers)
      integer :: m

      do m = index, index + gearbox%contacts(index)%n_slots - 1
         if (flanks_of(gearbox%contacts(m), integers) == flanks_loaded) call put_flanks(gearbox%contacts(m), flanks_open, integers)
      end do
      y(gearbox%contacts(index)%i_normal) = 0
   end subroutine open_flank

   !> Project the dependent wheel of every closed contact to kappa = 0 and kappa' = 0. After a located event both differ from 0 by
   !> rounding only.
   subroutine close_gaps(gearbox, y, integers)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      type(contact_point) :: point
      type(contact_gradient) :: gradient
      real(wp) :: q(n_local)
      integer :: m, i, turn

      do turn = 1, size(gearbox%contacts)
         do m = 1, size(gearbox%contacts)
            if (.not. is_closed(gearbox, m, integers)) cycle
            associate (contact => gearbox%contacts(m))
               call gearbox_local(gearbox, contact, y, q)
               call rigid_gradient(contact%pair, q, point, gradient)
               do i = 1, size(contact%links)
                  associate (link => contact%links(i), dependent => contact%i_dependent)
                     if (link%state == dependent) y(dependent) = y(dependent) - point%h/gradient%h(link%local)
                     if (link%state == dependent + 1) y(dependent + 1) = y(dependent + 1) - point%h_dot/gradient%h_dot(link%local)
                  end associate
               end do
            end associate
         end do
      end do
   end subroutine close_gaps

   !> kappa'' without multipliers, and the contribution of each multiplier to it and to all rates. Equation T61.
   subroutine responses(gearbox, t, y, integers, reals, closed, n, offset, response, velocity, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(gearbox%n_states)   !! its multipliers are set to zero
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      integer, intent(out) :: closed(:)                !! closed contacts
      integer, intent(out) :: n                        !! their number
      real(wp), intent(out) :: offset(:)               !! rows without multipliers [N]
      real(wp), intent(out) :: response(:, :)          !! rows per unit multiplier [1]
      real(wp), intent(out) :: velocity(:, :)          !! rates per unit multiplier
      type(status_t), intent(inout) :: status
      real(wp) :: f0(gearbox%n_states), f(gearbox%n_states)
      integer :: m, k

      n = 0
      do m = 1, size(gearbox%contacts)
         if (.not. gearbox%contacts(m)%leads) cycle
         y(gearbox%contacts(m)%i_normal) = 0
         if (.not. is_closed(gearbox, m, integers)) cycle
         n = n + 1
         closed(n) = m
      end do
      if (n == 0) return
      call coupled_rates(gearbox, t, y, integers, reals, f0, status)
      if (has_failed(status)) return
      do k = 1, n
         associate (contact => gearbox%contacts(closed(k)))
            offset(k) = f0(contact%i_normal)
            y(contact%i_normal) = contact%force_scale
            call coupled_rates(gearbox, t, y, integers, reals, f, status)
            y(contact%i_normal) = 0
            if (has_failed(status)) return
            velocity(:, k) = (f - f0)/contact%force_scale
         end associate
         response(:n, k) = velocity(gearbox%contacts(closed(:n))%i_normal, k)
         if (response(k, k) > 0) cycle
         call fail(status, code_singular, "friction holds the rigid contact fast: a normal force of 1 N would draw the flanks" &
                   //" together by "//quantity(-response(k, k), "N")//"; this state has no solution", subject_mesh, &
                   gearbox%contacts(closed(k))%mesh, &
                   "friction")
         return
      end do
   end subroutine responses

   !> Solve response force = right-hand side.
   subroutine solve(gearbox, closed, response, force, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: closed(:)
      real(wp), intent(in) :: response(:, :)
      real(wp), intent(inout) :: force(:) !! right-hand side, then solution
      type(status_t), intent(inout) :: status
      real(wp) :: matrix(size(force), size(force)), column(size(force), 1)
      integer :: pivots(size(force)), info

      matrix = response
      column(:, 1) = force
      call dgesv(size(force), 1, matrix, size(force), pivots, column, size(force), info)
      force = column(:, 1)
      if (info /= 0) call fail(status, code_singular, "the normal forces of the rigid contacts are not determined at this state", &
                               subject_mesh, gearbox%contacts(closed(1))%mesh, "contact")
   end subroutine solve

   !> Rates of the multipliers, by a finite difference along the motion. In: all other rates.
   subroutine multiplier_rates(gearbox, t, y, integers, reals, yp, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      real(wp), intent(inout) :: yp(gearbox%n_states)
      type(status_t), intent(inout) :: status
      real(wp) :: offset(gearbox%n_multipliers), response(gearbox%n_multipliers, gearbox%n_multipliers)
      real(wp) :: velocity(gearbox%n_states, gearbox%n_multipliers), force(gearbox%n_multipliers), later(gearbox%n_states)
      integer :: closed(gearbox%n_multipliers), n, m, k

      do m = 1, size(gearbox%contacts)
         if (gearbox%contacts(m)%leads) yp(gearbox%contacts(m)%i_normal) = 0
      end do
      later = y + time_step*yp
      call responses(gearbox, t + time_step, later, integers, reals, closed, n, offset, response, velocity, status)
      if (has_failed(status) .or. n == 0) return
      force(:n) = -offset(:n)
      call solve(gearbox, closed(:n), response(:n, :n), force(:n), status)
      do k = 1, n
         associate (i => gearbox%contacts(closed(k))%i_normal)
            yp(i) = (force(k) - y(i))/time_step
         end associate
      end do
   end subroutine multiplier_rates

   !> Newton's impact in the closing contacts: kappa' becomes -e times its value, that of closed contacts remains 0. The friction
   !> factors are those of this instant. A contact that would have to pull is left out and opened. If flanks that hardly move are
   !> held, none is opened here; their normal forces decide. Equation T61.
   !>
   !> P solves G M^-1 D P = -(1 + e) kappa'. Modes: the closing contacts already count as closed.
   subroutine impact(gearbox, closing, holds, now, rebounds, opened, status)
      type(gearbox_t), intent(in) :: gearbox
      type(moment_t), intent(inout) :: now
      logical, intent(in) :: closing(:)     !! [contacts] true for the leading contacts of closing flanks
      logical, intent(in) :: holds          !! closing flanks are held for any direction of motion
      logical, intent(out) :: rebounds(:)   !! [contacts] leading contacts of flanks that close and part at once
      logical, intent(out) :: opened(:)     !! [contacts] leading contacts of flanks that would have to pull
      type(status_t), intent(inout) :: status
      real(wp) :: offset(gearbox%n_multipliers), response(gearbox%n_multipliers, gearbox%n_multipliers)
      real(wp) :: velocity(gearbox%n_states, gearbox%n_multipliers), impulse(gearbox%n_multipliers)
      real(wp) :: q(n_local), gap(2), approach, energy
      integer :: closed(gearbox%n_multipliers), n, k, worst

      rebounds = .false.
      opened = .false.
      energy = kinetic_energy(gearbox, now%y)
      do
         call responses(gearbox, now%t, now%y, now%integers, now%reals, closed, n, offset, response, velocity, status)
         if (has_failed(status) .or. n == 0) return
         do k = 1, n
            associate (contact => gearbox%contacts(closed(k)))
               impulse(k) = 0
               if (.not. closing(closed(k))) cycle
               call gearbox_local(gearbox, contact, now%y, q)
               gap = rigid_constraint(contact%pair, q)
               approach = -gap(2)
               rebounds(closed(k)) = contact%elastic%restitution() > 0 .and. approach > contact%elastic%rest_velocity()
               impulse(k) = approach/contact%mobility
               if (rebounds(closed(k))) impulse(k) = (1 + contact%elastic%restitution())*impulse(k)
            end associate
         end do
         call solve(gearbox, closed(:n), response(:n, :n), impulse(:n), status)
         if (has_failed(status)) return
         worst = minloc(impulse(:n), dim=1)
         if (holds .or. impulse(worst) >= 0) exit
         call open_flank(gearbox, closed(worst), now%y, now%integers)
         rebounds(closed(worst)) = .false.
         opened(closed(worst)) = .true.
      end do
      do k = 1, n
         call add_impulse(gearbox, impulse(k), velocity(:, k), now%y)
      end do
      now%y(gearbox%i_dissipated) = now%y(gearbox%i_dissipated) + energy - kinetic_energy(gearbox, now%y)
   end subroutine impact

   !> Change the speeds by an impulse [N s].
   pure subroutine add_impulse(gearbox, impulse, velocity, y)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: impulse, velocity(:)
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer :: i, j

      y(i_omega) = y(i_omega) + impulse*velocity(i_omega)
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%i_psi > 0 .and. wheel%leader == i) y(wheel%i_psi + 1) = y(wheel%i_psi + 1) + impulse*velocity(wheel%i_psi + 1)
            do j = 1, wheel%support%n
               associate (row => wheel%support%i_state(j) + 1)
                  y(row) = y(row) + impulse*velocity(row)
               end associate
            end do
         end associate
      end do
      if (.not. gearbox%housing%is_mounted) return
      associate (first => gearbox%housing%i_state + at_velocity, last => gearbox%housing%i_state + at_omega + 2)
         y(first:last) = y(first:last) + impulse*velocity(first:last)
      end associate
   end subroutine add_impulse

   !> Kinetic energy: relative to the housing, or to the ground if the housing is mounted [J]. Equation T69.
   pure real(wp) function kinetic_energy(gearbox, y) result(energy)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states)
      type(frame_t) :: frame
      real(wp) :: potential
      integer :: i, j

      if (gearbox%housing%is_mounted) then
         call housing_frame(gearbox%housing, 0.0_wp, y, frame)
         potential = 0
         call ground_energies(gearbox, y, frame, energy, potential)
         return
      end if
      energy = 0
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            energy = energy + wheel%inertia*wheel_speed(wheel, y)**2/2
            do j = 1, wheel%support%n
               energy = energy + wheel%support%mass*y(wheel%support%i_state(j) + 1)**2/2
            end do
         end associate
      end do
   end function kinetic_energy

end module evl_rigid_forces
