!> The state at the start: rest, given speeds, or the steady state.
module evl_gearbox_initial
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use evl_closed_form, only: track_closed_form
   use evl_contact_point, only: contact_point
   use evl_contact_tracking, only: points_from_closed_form
   use evl_dae_jacobian, only: gearbox_jacobian
   use evl_dae_residual, only: gearbox_derivative
   use evl_gearbox, only: gearbox_local, gearbox_mode, gearbox_rates, gearbox_store_mode, gearbox_t, i_omega, i_theta, i_turns
   use evl_gearbox_scaling, only: gearbox_likely_speed, gearbox_state_scales
   use evl_kinds, only: wp
   use evl_load, only: load_acceleration, load_segment, load_speed, load_torque, load_damping
   use evl_local_variables, only: at_psi_dot_a, at_psi_dot_b, at_v_a, at_v_b, n_local, n_track
   use evl_mesh, only: contact_loaded, contact_open, contact_unloaded, mesh_mode, mesh_nominal_rho, mesh_settle_friction, &
                       mesh_unclipped_force, tracking_closed_form
   use evl_status, only: clear, code_invalid_input, code_no_solution, fail, has_failed, quantity, status_t, subject_initial, &
                         subject_load, subject_mesh, subject_none
   implicit none (type, external)
   private

   public :: initial_t, gearbox_start, gearbox_initial_speeds
   public :: initial_rest, initial_steady, initial_speeds

   integer, parameter :: initial_rest = 0   !! nothing moves
   integer, parameter :: initial_steady = 1 !! nothing accelerates
   integer, parameter :: initial_speeds = 2 !! given speeds

   real(wp), parameter :: speed_agreement = 1.0e-12_wp !! relative: an initial and a prescribed speed that differ less agree
   integer, parameter :: max_newton = 60               !! corrections; a start from rest needs about five
   real(wp), parameter :: newton_tolerance = 1.0e-13_wp !! last correction, relative to the scales of the states

   type :: initial_t
      integer :: kind = initial_rest       !! one of the kinds above
      real(wp), allocatable :: speeds(:)   !! of the wheels [rad/s], for initial_speeds; else size 0
      real(wp), allocatable :: gaps(:)     !! of the meshes [m]; size 0: all touch
   end type initial_t

contains

   !> The wheels' speeds at the start [rad/s], as far as they are given: size 0 for a steady start.
   pure function gearbox_initial_speeds(gearbox, initial) result(speeds)
      type(gearbox_t), intent(in) :: gearbox
      type(initial_t), intent(in) :: initial
      real(wp), allocatable :: speeds(:)

      select case (initial%kind)
      case (initial_speeds)
         speeds = initial%speeds
      case (initial_rest)
         allocate (speeds(size(gearbox%wheels)), source=0.0_wp)
      case default
         allocate (speeds(0))
      end select
   end function gearbox_initial_speeds

   !> Fill the whole state for time t.
   !> Errors: code_invalid_input, code_no_solution (steady), code_out_of_domain.
   subroutine gearbox_start(gearbox, initial, t, y, yp, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      type(initial_t), intent(in) :: initial
      real(wp), intent(in) :: t
      real(wp), intent(out) :: y(gearbox%n_states), yp(gearbox%n_states)
      integer, intent(out) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: reals(size(gearbox%meshes))
      type(status_t), intent(inout) :: status
      integer :: i

      y = 0
      yp = 0
      integers = 0
      reals = 0
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i))
            if (load%i_segment > 0) integers(load%i_segment) = load_segment(load, t)
         end associate
      end do
      call check_initial(gearbox, initial, status)
      if (has_failed(status)) return
      if (initial%kind == initial_steady) then
         call steady_state(gearbox, t, y, integers, reals, status)
      else
         call set_speeds(gearbox, gearbox_initial_speeds(gearbox, initial), t, y, integers, status)
         if (has_failed(status)) return
         if (size(initial%gaps) > 0) call set_gaps(gearbox, -initial%gaps, y)
         call check_gaps(gearbox, initial, y, status)
      end if
      if (has_failed(status)) return
      call set_tracked(gearbox, y)
      call settle(gearbox, t, y, integers, reals, status)
      if (has_failed(status)) return
      call gearbox_derivative(gearbox, t, y, integers, reals, yp, status)
   end subroutine gearbox_start

   !> The description of the start makes sense.
   subroutine check_initial(gearbox, initial, status)
      type(gearbox_t), intent(in) :: gearbox
      type(initial_t), intent(in) :: initial
      type(status_t), intent(inout) :: status

      if (all(initial%kind /= [initial_rest, initial_steady, initial_speeds])) then
         call fail(status, code_invalid_input, "there is no such kind of start", subject_initial, field="kind")
      else if (initial%kind == initial_speeds .and. size(initial%speeds) /= size(gearbox%wheels)) then
         call fail(status, code_invalid_input, "a start with given speeds needs one for each wheel", subject_initial, &
                   field="speeds")
      else if (.not. (all(ieee_is_finite(initial%speeds)) .and. all(ieee_is_finite(initial%gaps)))) then
         call fail(status, code_invalid_input, "initial speeds and gaps must be finite numbers", subject_initial)
      else if (size(initial%gaps) /= 0 .and. size(initial%gaps) /= size(gearbox%meshes)) then
         call fail(status, code_invalid_input, "initial gaps need one for each mesh", subject_initial, field="gaps")
      else if (initial%kind == initial_steady .and. any(abs(initial%gaps) > 0)) then
         call fail(status, code_invalid_input, "a steady start has no gaps: its penetrations follow from the loads", &
                   subject_initial, field="gaps")
      end if
   end subroutine check_initial

   !> Speeds of the wheels; a prescribed speed has to be the given one.
   subroutine set_speeds(gearbox, speeds, t, y, integers, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: speeds(:), t
      real(wp), intent(inout) :: y(:)
      integer, intent(in) :: integers(:)
      type(status_t), intent(inout) :: status
      real(wp) :: prescribed
      integer :: i

      y(i_omega) = speeds(gearbox%reference)
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%i_psi > 0) y(wheel%i_psi + 1) = speeds(i) - wheel%ratio*y(i_omega)
            if (wheel%prescribed == 0) cycle
            prescribed = prescribed_speed(gearbox, wheel%prescribed, t, integers)
            if (abs(prescribed - speeds(i)) <= speed_agreement*abs(prescribed)) cycle
            call fail(status, code_invalid_input, "the prescribed speed "//quantity(prescribed, "rad/s")//" does not agree" &
                      //" with the initial speed "//quantity(speeds(i), "rad/s")//" of its wheel: start with given speeds," &
                      //" or from a steady state", subject_load, wheel%prescribed, "value")
            return
         end associate
      end do
   end subroutine set_speeds

   !> The speed that a load prescribes at t [rad/s].
   pure real(wp) function prescribed_speed(gearbox, load, t, integers) result(speed)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: load, integers(:)
      real(wp), intent(in) :: t

      associate (l => gearbox%loads(load))
         if (l%i_segment > 0) then
            speed = load_speed(l, t, integers(l%i_segment))
         else
            speed = load_speed(l, t, 0)
         end if
      end associate
   end function prescribed_speed

   !> Turn the wheels, from the reference wheel on, until every mesh has the given penetration.
   pure subroutine set_gaps(gearbox, penetrations, y)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: penetrations(:) !! of the meshes [m]
      real(wp), intent(inout) :: y(:)
      logical :: placed(size(gearbox%wheels)), found
      real(wp) :: psi(size(gearbox%wheels)), arc
      integer :: m

      placed = .false.
      placed(gearbox%reference) = .true.
      psi = 0
      found = .true.
      do while (found)
         found = .false.
         do m = 1, size(gearbox%meshes)
            associate (mesh => gearbox%meshes(m), a => gearbox%meshes(m)%wheel_a, b => gearbox%meshes(m)%wheel_b)
               if (placed(a) .eqv. placed(b)) cycle
               arc = -mesh%pair%sigma*penetrations(m) ! r_bA psi_A + r_bB psi_B
               if (placed(a)) then
                  psi(b) = (arc - mesh%pair%r_ba*psi(a))/mesh%pair%r_bb
               else
                  psi(a) = (arc - mesh%pair%r_bb*psi(b))/mesh%pair%r_ba
               end if
               placed(a) = .true.
               placed(b) = .true.
               found = .true.
            end associate
         end do
      end do
      do m = 1, size(gearbox%wheels)
         if (gearbox%wheels(m)%i_psi > 0) y(gearbox%wheels(m)%i_psi) = psi(m)
      end do
   end subroutine set_gaps

   !> In a ring of wheels the last gap follows from the others: it has to be the given one.
   subroutine check_gaps(gearbox, initial, y, status)
      type(gearbox_t), intent(in) :: gearbox
      type(initial_t), intent(in) :: initial
      real(wp), intent(in) :: y(:)
      type(status_t), intent(inout) :: status
      type(contact_point) :: point
      integer :: m

      if (size(initial%gaps) == 0) return
      do m = 1, size(gearbox%meshes)
         call closed_form_point(gearbox, m, y, 0, 0, point)
         if (abs(-point%h - initial%gaps(m)) <= 1.0e-9_wp*maxval(abs(initial%gaps))) cycle
         call fail(status, code_invalid_input, "its initial gap "//quantity(initial%gaps(m), "m")//" does not agree with " &
                   //quantity(-point%h, "m")//", which the gaps of the other meshes in its ring leave", subject_mesh, m, "gaps")
         return
      end do
   end subroutine check_gaps

   !> The contact of a mesh by the closed form, whatever its tracking.
   subroutine closed_form_point(gearbox, index, y, turns, teeth, point)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index, turns, teeth
      real(wp), intent(in) :: y(:)
      type(contact_point), intent(out) :: point
      real(wp) :: q(n_local)

      associate (mesh => gearbox%meshes(index))
         call gearbox_local(gearbox, mesh, y, q)
         call track_closed_form(mesh%pair, mesh_nominal_rho(mesh, y(i_theta), turns, teeth), q, point)
      end associate
   end subroutine closed_form_point

   !> Tracked variables that belong to the wheels' positions.
   subroutine set_tracked(gearbox, y)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(inout) :: y(gearbox%n_states)
      real(wp) :: q(n_local)
      integer :: m

      do m = 1, size(gearbox%meshes)
         associate (mesh => gearbox%meshes(m))
            if (mesh%i_track == 0) cycle
            call gearbox_local(gearbox, mesh, y, q)
            call points_from_closed_form(mesh%pair, q, y(mesh%i_track:mesh%i_track + n_track - 1))
         end associate
      end do
   end subroutine set_tracked

   !> Contact modes and friction branches that belong to positions and speeds. Flanks that just touch count as loaded unless
   !> they move apart, or would be accelerated apart.
   subroutine settle(gearbox, t, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(status_t), intent(inout) :: status
      type(contact_point) :: point
      type(mesh_mode) :: mode
      real(wp) :: free(gearbox%n_states), q(n_local), force, parting
      integer :: m

      call gearbox_rates(gearbox, t, y, integers, reals, free, status)
      if (has_failed(status)) return
      do m = 1, size(gearbox%meshes)
         associate (mesh => gearbox%meshes(m))
            call closed_form_point(gearbox, m, y, integers(i_turns), 0, point)
            mode = gearbox_mode(gearbox, m, integers, reals)
            mode%contact = contact_open
            if (point%h > 0) then
               mode%contact = contact_loaded
               call mesh_unclipped_force(mesh, m, mode, point, force, status)
               if (has_failed(status)) return
               if (force < 0) mode%contact = contact_unloaded
            else if (.not. point%h < 0) then
               call gearbox_local(gearbox, mesh, free, q)
               parting = mesh%pair%sigma*(mesh%pair%r_ba*q(at_psi_dot_a) + mesh%pair%r_bb*q(at_psi_dot_b)) &
                         + q(at_v_b + 1) - q(at_v_a + 1)
               if (point%h_dot > 0 .or. (.not. point%h_dot < 0 .and. parting <= 0)) mode%contact = contact_loaded
            end if
            if (mode%contact == contact_loaded) then
               mode%friction = mesh_settle_friction(mesh, point)
               mode%v0 = max(point%h_dot, 0.0_wp)
            end if
            call gearbox_store_mode(gearbox, m, mode, integers, reals)
         end associate
      end do
   end subroutine settle

   !> Positions and speeds at which nothing accelerates, by Newton's method on the closed form.
   subroutine steady_state(gearbox, t, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(status_t), intent(inout) :: status
      type(gearbox_t) :: closed
      integer, allocatable :: unknown(:), row(:)
      integer :: i, turn

      call check_steady(gearbox, integers, status)
      if (has_failed(status)) return
      closed = gearbox
      closed%meshes%tracking = tracking_closed_form
      closed%meshes%i_track = 0
      unknown = [(gearbox%wheels(i)%i_psi, i=1, size(gearbox%wheels))]
      row = unknown + 1
      unknown(gearbox%reference) = i_omega
      row(gearbox%reference) = i_omega
      if (gearbox%wheels(gearbox%reference)%prescribed > 0) then
         y(i_omega) = prescribed_speed(gearbox, gearbox%wheels(gearbox%reference)%prescribed, t, integers)
         unknown = pack(unknown, unknown /= i_omega)
         row = pack(row, row /= i_omega)
      else
         y(i_omega) = free_speed(gearbox, t, integers)
      end if
      do i = 1, size(gearbox%wheels)
         associate (support => gearbox%wheels(i)%support)
            unknown = [unknown, support%i_state(:support%n)]
            row = [row, support%i_state(:support%n) + 1]
         end associate
      end do
      call set_gaps(gearbox, gearbox%meshes%h_scale, y)
      do turn = 1, 3 ! friction branches depend on the speed, the speed on friction
         call load_all(closed, y, integers, reals)
         call newton(closed, t, unknown, row, y, integers, reals, status)
         if (has_failed(status)) return
      end do
      call check_pressed(closed, y, status)
   end subroutine steady_state

   !> A steady state can exist: no prescribed speed changes, and at most one is prescribed.
   subroutine check_steady(gearbox, integers, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: integers(:)
      type(status_t), intent(inout) :: status
      integer :: i

      if (count(gearbox%wheels%prescribed > 0) > 1) then
         call fail(status, code_no_solution, "a steady start needs wheels that are free to find their positions, but the speeds" &
                   //" of several are prescribed: start with given speeds", subject_initial, field="kind")
         return
      end if
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i))
            if (load%i_segment == 0) cycle
            if (.not. abs(load_acceleration(load, integers(load%i_segment))) > 0 .or. &
                gearbox%wheels(load%wheel)%prescribed /= i) cycle
            call fail(status, code_no_solution, "the prescribed speed of a wheel changes at the start: that is no steady state", &
                      subject_load, i, "time")
            return
         end associate
      end do
   end subroutine check_steady

   !> Speed at which the loads balance without friction [rad/s].
   pure real(wp) function free_speed(gearbox, t, integers) result(speed)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      integer, intent(in) :: integers(:)
      real(wp) :: torque, damping
      integer :: i, segment

      torque = 0
      damping = 0
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i))
            segment = 0
            if (load%i_segment > 0) segment = integers(load%i_segment)
            associate (g => gearbox%wheels(load%wheel)%ratio)
               torque = torque + g*load_torque(load, t, 0.0_wp, segment)
               damping = damping + g**2*load_damping(load)
            end associate
         end associate
      end do
      speed = gearbox_likely_speed(gearbox)
      if (damping > 0) speed = torque/damping
   end function free_speed

   !> Every mesh loaded, every friction branch as the speeds say.
   subroutine load_all(gearbox, y, integers, reals)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(:)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(contact_point) :: point
      type(mesh_mode) :: mode
      integer :: m

      do m = 1, size(gearbox%meshes)
         call closed_form_point(gearbox, m, y, 0, 0, point)
         mode = gearbox_mode(gearbox, m, integers, reals)
         mode%contact = contact_loaded
         mode%friction = mesh_settle_friction(gearbox%meshes(m), point)
         call gearbox_store_mode(gearbox, m, mode, integers, reals)
      end do
   end subroutine load_all

   !> Solve f(row) = 0 for y(unknown), halving corrections that leave the domain or do not reduce the scaled residual.
   subroutine newton(gearbox, t, unknown, row, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      integer, intent(in) :: unknown(:), row(:), integers(:)
      real(wp), intent(inout) :: y(gearbox%n_states)
      real(wp), intent(in) :: reals(:)
      type(status_t), intent(inout) :: status
      real(wp), dimension(gearbox%n_states) :: f, trial, scale, row_scale, zero
      real(wp) :: jacobian(gearbox%n_states, gearbox%n_states), matrix(size(row), size(row)), step(size(row), 1)
      real(wp) :: size_now, size_trial, share, last
      integer :: differential(gearbox%n_states), pivots(size(row)), info, turn
      interface
         subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
            use evl_kinds, only: wp
            implicit none (type, external)
            integer, intent(in) :: n, nrhs, lda, ldb
            real(wp), intent(inout) :: a(lda, *), b(ldb, *)
            integer, intent(out) :: ipiv(*), info
         end subroutine dgesv
      end interface

      call gearbox_state_scales(gearbox, [real(wp) ::], scale, row_scale, differential)
      zero = 0
      last = huge(last)
      call gearbox_rates(gearbox, t, y, integers, reals, f, status)
      do turn = 1, max_newton
         if (has_failed(status)) return
         size_now = norm2(f(row)/scale(row))
         call gearbox_jacobian(gearbox, t, 0.0_wp, y, zero, integers, reals, jacobian, status)
         matrix = jacobian(row, unknown)
         matrix = matrix*spread(scale(unknown), 1, size(row))/spread(scale(row), 2, size(row))
         step(:, 1) = f(row)/scale(row)
         call dgesv(size(row), 1, matrix, size(row), pivots, step, size(row), info)
         if (info /= 0 .or. .not. all(ieee_is_finite(step))) then
            call fail(status, code_no_solution, "the steady speed is not determined: no load depends on the speed, and none is" &
                      //" prescribed", subject_initial, field="kind")
            return
         end if
         share = 1
         do
            trial = y
            trial(unknown) = y(unknown) + share*step(:, 1)*scale(unknown)
            call clear(status)
            call gearbox_rates(gearbox, t, trial, integers, reals, f, status)
            size_trial = norm2(f(row)/scale(row))
            if (.not. has_failed(status) .and. (size_trial < size_now .or. norm2(step) < 1.0e-6_wp)) exit
            share = share/2
            if (share < 1.0e-6_wp) exit
         end do
         if (has_failed(status)) return
         y = trial
         if (norm2(step) < newton_tolerance .or. (norm2(step) < 1.0e-9_wp .and. norm2(step) >= last)) return
         last = norm2(step)
      end do
      call fail(status, code_no_solution, "no steady state was found: start from rest or with given speeds", subject_initial, &
                field="kind")
   end subroutine newton

   !> In the steady state every flank pushes.
   subroutine check_pressed(gearbox, y, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(:)
      type(status_t), intent(inout) :: status
      type(contact_point) :: point
      integer :: m

      do m = 1, size(gearbox%meshes)
         call closed_form_point(gearbox, m, y, 0, 0, point)
         if (point%h > 0) cycle
         call fail(status, code_no_solution, "there is no steady state: this flank would have to pull (penetration " &
                   //quantity(point%h, "m")//"); the loads turn the wheels against driving_rotation", subject_mesh, m, &
                   "driving_rotation")
         return
      end do
   end subroutine check_pressed

end module evl_gearbox_initial
