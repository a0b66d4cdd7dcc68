!> Changes of a gearbox as a system of orbits: modes on the section, events, and derivatives with respect to approach speeds.
!>
!> Derivatives of root functions and approach speeds are fourth-order differences with steps of a thousandth of the scales. The
!> functions are smooth there; the error is 1e-9. Residuals do not contain these derivatives.
submodule(evl_gearbox_orbits) evl_gearbox_orbit_changes
   use evl_contacts_at_state, only: look_at
   use evl_discrete_state, only: take_mode
   use evl_event_log, only: event_log
   use evl_gearbox, only: i_turns
   use evl_gearbox_events, only: gearbox_apply_event, gearbox_root
   use evl_gearbox_ode, only: gearbox_ode_set
   use evl_gearbox_rates, only: gearbox_rates
   use evl_state_transfer, only: take_back, take_over
   use evl_tooth_contact, only: contact_mode, contact_state, touches
   implicit none (type, external)

   real(wp), parameter :: step = 1.0e-3_wp       !! step of the differences, relative to the scales

contains

   !> Pass the discrete state on to the ODE, and set the modes.
   subroutine take_modes(self)
      type(gearbox_orbits), intent(inout) :: self
      type(contact_mode) :: mode
      integer :: m

      call gearbox_ode_set(self%ode, self%integers, self%reals)
      do m = 1, size(self%reals)
         call take_mode(self%gearbox, m, self%integers, self%reals, mode)
         associate (modes => self%modes(per_contact*(m - 1) + 1:per_contact*m))
            modes = [mode%tooth_pair, mode%flanks, mode%zone_a, mode%zone_b]
            if (.not. touches(mode)) modes(3:) = 0 ! otherwise undefined
         end associate
      end do
   end subroutine take_modes

   !> Modes of a state on the section.
   module procedure settle
      type(contact_mode) :: mode
      type(event_log) :: log
      integer :: nothing(self%n_roots), k
      real(wp) :: yp(self%n_gears)

      self%integers = 0
      self%reals = 0
      call take_over(self%gearbox, .false., t, y(:self%n_gears), yp, self%integers, self%reals, status)
      if (has_failed(status)) return
      self%reals = 0
      do k = 1, size(self%memory)
         call take_mode(self%gearbox, self%memory(k), self%integers, self%reals, mode)
         if (.not. touches(mode)) y(self%n_gears + k) = 0
         self%reals(self%memory(k)) = y(self%n_gears + k)
      end do
      nothing = 0
      if (size(self%memory) > 0) & ! whether the contact force is tensile depends on it
         call gearbox_apply_event(self%gearbox, t, nothing, .false., y(:self%n_gears), yp, self%integers, self%reals, log, status)
      if (.not. has_failed(status)) call take_modes(self)
   end procedure settle

   !> Convert the state of a gearbox run that returned to the section to a state of this system.
   module procedure gearbox_orbits_arrive
      integer :: began(size(self%modes))

      began = self%modes
      call gearbox_orbits_start(self, y_gears, integers(i_turns), reals, y)
      self%integers = integers
      self%integers(i_turns) = 0
      self%reals = 0
      self%reals(self%memory) = reals(self%memory)
      call take_modes(self)
      same_modes = all(self%modes == began)
   end procedure gearbox_orbits_arrive

   !> Shift tooth pairs, after whole periods, back to the indices at the start of the motion.
   module procedure come_back
      real(wp) :: from(size(self%reals)), before(self%n), rows(self%n, self%n), scrap(self%n_gears)
      integer :: moved(size(self%integers)), k, old
      type(contact_mode) :: mode

      from = [(real(k, wp), k=1, size(from))]
      moved = self%integers
      scrap = y(:self%n_gears)
      call take_back(self%gearbox, self%common, periods, scrap, moved, from) ! from: source index of each contact's approach speed
      before = y
      rows = derivative
      y(:self%n_gears) = scrap
      y(i_theta) = y(i_theta) + 2*pi*moved(i_turns)
      moved(i_turns) = 0
      self%integers = moved
      self%reals = 0
      do k = 1, size(self%memory)
         old = findloc(self%memory, nint(from(self%memory(k))), 1)
         call take_mode(self%gearbox, self%memory(k), self%integers, self%reals, mode)
         y(self%n_gears + k) = merge(before(self%n_gears + old), 0.0_wp, touches(mode))
         derivative(self%n_gears + k, :) = 0
         if (touches(mode)) derivative(self%n_gears + k, :) = rows(self%n_gears + old, :)
         self%reals(self%memory(k)) = y(self%n_gears + k)
      end do
      call take_modes(self)
   end procedure come_back

   !> Number of other touching tooth pairs of the mesh.
   module procedure other_contacts
      integer :: m
      type(contact_mode) :: mode

      n = 0
      do m = 1, size(self%reals)
         if (m == self%root_list(root)%contact .or. self%gearbox%contacts(m)%mesh /= self%root_list(root)%mesh) cycle
         call take_mode(self%gearbox, m, self%integers, self%reals, mode)
         if (touches(mode)) n = n + 1
      end do
   end procedure other_contacts

   !> Derivative of f with respect to an approach speed.
   module procedure by_memory
      real(wp) :: reals(size(self%reals)), f(self%n_gears, -2:2)
      type(contact_mode) :: mode
      integer :: i, k

      slope = 0
      call take_mode(self%gearbox, m, self%integers, self%reals, mode)
      if (.not. touches(mode) .or. .not. self%reals(m) > 0) return
      reals = self%reals
      do k = -2, 2
         if (k == 0) cycle
         reals(m) = self%reals(m)*(1 + k*step)
         call gearbox_rates(self%gearbox, t, y, self%integers, reals, f(:, k), status)
         if (has_failed(status)) return
      end do
      do i = 1, self%n_gears
         slope(i) = slope_of(f(i, :))/(step*self%reals(m))
      end do
   end procedure by_memory

   !> Derivatives of a root function with respect to its states; no root function depends on time explicitly.
   module procedure root_gradient
      real(wp) :: roots(self%n_roots), moved(self%n_gears), values(-2:2)
      integer :: i, k

      by_state = 0
      by_time = 0
      do i = self%root_first(root), self%root_last(root)
         associate (state => self%root_states(i))
            if (state == i_omega .and. self%common%by_time) cycle ! it is constant
            do k = -2, 2
               if (k == 0) cycle
               moved = y(:self%n_gears)
               moved(state) = moved(state) + k*step*self%scale(state)
               call gearbox_root(self%gearbox, root, moved, self%integers, self%reals, roots, status)
               if (has_failed(status)) return
               values(k) = roots(root)
            end do
            by_state(state) = slope_of(values)/(step*self%scale(state))
         end associate
      end do
   end procedure root_gradient

   !> Derivative at the middle of five values, per index step; the middle value is not used.
   pure real(wp) function slope_of(values) result(slope)
      real(wp), intent(in) :: values(-2:2)

      slope = (8*(values(1) - values(-1)) - (values(2) - values(-2)))/12
   end function slope_of

   !> Apply the changes of an event: modes, and the approach speeds of contacts that close or leave.
   module procedure apply_event
      real(wp) :: before(size(self%reals)), yp(self%n_gears)
      type(event_log) :: log
      type(contact_mode) :: mode
      integer :: i, k

      by_time = 0
      by_state = 0
      do i = 1, self%n
         by_state(i, i) = 1
      end do
      before = self%reals
      call gearbox_apply_event(self%gearbox, t, fired, time_event, y(:self%n_gears), yp, self%integers, self%reals, log, status)
      if (has_failed(status)) return
      do k = 1, size(self%memory)
         associate (m => self%memory(k), row => self%n_gears + k)
            call take_mode(self%gearbox, m, self%integers, self%reals, mode)
            y(row) = self%reals(m)
            if (touches(mode) .and. .not. abs(self%reals(m) - before(m)) > 0) cycle
            by_state(row, :) = 0
            if (touches(mode) .and. self%reals(m) > 0) call approach_gradient(self, m, y, by_state(row, :self%n_gears), status)
         end associate
         if (has_failed(status)) return
      end do
      call take_modes(self)
   end procedure apply_event

   !> Derivative of the closing speed of a contact with respect to the state.
   subroutine approach_gradient(self, m, y, gradient, status)
      type(gearbox_orbits), intent(in) :: self
      integer, intent(in) :: m
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: gradient(self%n_gears)
      type(status_t), intent(inout) :: status
      type(contact_state) :: at(size(self%reals))
      real(wp) :: moved(self%n_gears), values(-2:2)
      integer :: first, i, k, last

      gradient = 0
      call self%gearbox%flanks(self%gearbox%contacts(m)%i_flank)%flank%loaded_pairs_range(m, first, last)
      do i = 1, self%n_gears
         do k = -2, 2
            if (k == 0) cycle
            moved = y(:self%n_gears)
            moved(i) = moved(i) + k*step*self%scale(i)
            call look_at(self%gearbox, first, last, moved, self%integers, self%reals, at, status)
            if (has_failed(status)) return
            values(k) = at(m)%point%h_dot
         end do
         gradient(i) = slope_of(values)/(step*self%scale(i))
      end do
   end subroutine approach_gradient

end submodule evl_gearbox_orbit_changes
