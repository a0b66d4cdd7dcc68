!> The steady state of a gearbox: speeds in the kinematic ratio, and positions at which nothing accelerates.
module evl_steady_state
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use evl_contact_point, only: contact_point
   use evl_dae_jacobian, only: gearbox_jacobian
   use evl_dae_residual, only: gearbox_residual
   use evl_gearbox, only: gearbox_mode, gearbox_store_mode, gearbox_t, i_omega, i_theta
   use evl_gearbox_scaling, only: gearbox_likely_speed, gearbox_state_scales
   use evl_housing, only: at_omega, at_position, at_velocity, housing_prescribed, housing_turn_columns, housing_take_turn
   use evl_kinds, only: wp
   use evl_lapack, only: dgesv
   use evl_load, only: load_acceleration, load_damping, load_prescribed_speed, load_torque
   use evl_mesh, only: contact_loaded, contact_off, flank_coast, flank_drive, mesh_mode, mesh_settle_friction, mesh_settle_zones, &
                       tracking_closed_form
   use evl_start_positions, only: closed_form_point, place_pairs, prescribed_speed, set_gaps
   use evl_status, only: clear, code_no_solution, fail, has_failed, quantity, status_t, subject_initial, subject_housing, &
                         subject_load, subject_mesh
   implicit none (type, external)
   private

   public :: find_steady_state

   integer, parameter :: max_modes = 20                !! sets of pairs in contact and friction branches that are tried
   integer, parameter :: max_newton = 60               !! corrections; a start from rest needs about five
   real(wp), parameter :: newton_tolerance = 1.0e-13_wp !! last correction, relative to the scales of the states

contains

   !> Positions and speeds at which nothing accelerates, by Newton's method on the closed form.
   subroutine find_steady_state(gearbox, t, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(gearbox%n_states)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(status_t), intent(inout) :: status
      type(gearbox_t) :: closed
      integer, allocatable :: unknown(:), row(:), leaders(:)
      integer :: before(gearbox%n_integers)
      real(wp) :: penetrations(size(gearbox%pairs))
      integer :: i, turn

      call check_steady(gearbox, integers, status)
      if (has_failed(status)) return
      closed = gearbox
      closed%contacts%tracking = tracking_closed_form
      closed%contacts%i_track = 0
      leaders = pack([(i, i=1, size(gearbox%wheels))], gearbox%wheels%leader == [(i, i=1, size(gearbox%wheels))])
      unknown = gearbox%wheels(leaders)%i_psi
      row = unknown + 1
      do i = 1, size(gearbox%contacts)
         ! a rigid contact determines a position by kappa = 0, and its multiplier is unknown instead
         if (gearbox%contacts(i)%leads) row = merge(unknown, row, unknown == gearbox%contacts(i)%i_dependent .and. unknown > 0)
      end do
      where (leaders == gearbox%reference)
         unknown = i_omega
         row = i_omega
      end where
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
      if (gearbox%housing%is_mounted) then
         ! the turns of the pose stand in the places of Omega, which is 0
         unknown = [unknown, (gearbox%housing%i_state + at_position + i, i=0, 2), (gearbox%housing%i_state + at_omega + i, i=0, 2)]
         row = [row, (gearbox%housing%i_state + at_velocity + i, i=0, 5)]
      end if
      unknown = [unknown, pack(gearbox%contacts%i_normal, gearbox%contacts%leads)]
      row = [row, pack(gearbox%contacts%i_normal, gearbox%contacts%leads)]
      do i = 1, size(gearbox%pairs)
         associate (drive => gearbox%contacts(gearbox%first(i)))
            penetrations(i) = merge(0.0_wp, drive%h_scale, drive%rigid)
         end associate
      end do
      call set_gaps(gearbox, penetrations, y)
      do i = 1, size(gearbox%contacts)
         associate (mesh => gearbox%contacts(i))
            if (mesh%leads .and. mesh%flank == flank_drive) y(mesh%i_normal) = mesh%force_scale
         end associate
      end do
      do turn = 1, max_modes ! modes depend on positions and speeds, these on the modes
         before = integers
         call load_all(closed, y, integers, reals, status)
         if (has_failed(status)) return
         if (turn > 1 .and. all(integers == before)) exit
         call newton(closed, t, unknown, row, y, integers, reals, status)
         if (has_failed(status)) return
      end do
      call check_pressed(closed, y, integers, status)
   end subroutine find_steady_state

   !> A steady state can exist: no prescribed speed changes, and at most one is prescribed.
   subroutine check_steady(gearbox, integers, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: integers(:)
      type(status_t), intent(inout) :: status
      integer :: i

      if (gearbox%housing%kind == housing_prescribed) then
         call fail(status, code_no_solution, "a steady start needs a housing that is at rest or mounted, but its motion is" &
                   //" prescribed: start from rest or with given speeds", subject_initial, field="kind")
         return
      else if (norm2([gearbox%housing%velocity, gearbox%housing%omega]) > 0) then
         call fail(status, code_no_solution, "a steady start has a housing without velocity", subject_housing, field="velocity")
         return
      end if
      if (count(gearbox%loads%kind == load_prescribed_speed) > 1) then
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

   !> The tooth pairs that carry load at y: on every drive flank those that overlap, and at least the one that is nearest to it;
   !> every friction branch as the speeds say.
   subroutine load_all(gearbox, y, integers, reals, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(:)
      integer, intent(inout) :: integers(:)
      real(wp), intent(inout) :: reals(:)
      type(status_t), intent(inout) :: status
      type(contact_point) :: points(size(gearbox%contacts))
      real(wp) :: largest(size(gearbox%pairs))
      type(mesh_mode) :: mode
      integer :: m

      call place_pairs(gearbox, y, integers)
      largest = -huge(largest)
      do m = 1, size(gearbox%contacts)
         associate (mesh => gearbox%contacts(m), at => gearbox%contacts(m)%i_mode)
            if (integers(at + 1) == contact_off .or. mesh%flank == flank_coast) cycle
            call closed_form_point(gearbox, m, y, 0, integers(at), points(m))
            largest(mesh%mesh) = max(largest(mesh%mesh), points(m)%h)
         end associate
      end do
      m = minloc(largest, dim=1)
      if (.not. largest(m) > -huge(largest)) then
         call fail(status, code_no_solution, "there is no steady state: under load no tooth pair of a mesh of contact ratio " &
                   //quantity(gearbox%pairs(m)%contact_ratio, "")//" is on the path of contact at the start; start from rest or" &
                   //" with given speeds", subject_initial, field="kind")
         return
      end if
      do m = 1, size(gearbox%contacts)
         associate (mesh => gearbox%contacts(m))
            mode = gearbox_mode(gearbox, m, integers, reals)
            if (mode%contact == contact_off .or. mesh%flank == flank_coast) cycle
            call mesh_settle_zones(mesh, points(m), mode)
            if (mesh%rigid .or. points(m)%h > 0 .or. points(m)%h >= largest(mesh%mesh)) then
               mode%contact = contact_loaded
               mode%friction = mesh_settle_friction(mesh, points(m))
            end if
         end associate
         call gearbox_store_mode(gearbox, m, mode, integers, reals)
      end do
   end subroutine load_all

   !> Solve F(row) = 0 for y(unknown) where nothing but theta moves, halving corrections that leave the domain or do not reduce the
   !> scaled residual.
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

      call gearbox_state_scales(gearbox, [real(wp) ::], scale, row_scale, differential)
      zero = 0
      last = huge(last)
      call steady_residual(gearbox, t, y, integers, reals, f, status)
      do turn = 1, max_newton
         if (has_failed(status)) return
         size_now = norm2(f(row)/row_scale(row))
         call gearbox_jacobian(gearbox, t, 0.0_wp, y, zero, integers, reals, jacobian, status)
         if (gearbox%housing%is_mounted) call housing_turn_columns(gearbox%housing, y, jacobian)
         matrix = jacobian(row, unknown)
         matrix = matrix*spread(scale(unknown), 1, size(row))/spread(row_scale(row), 2, size(row))
         step(:, 1) = -f(row)/row_scale(row)
         call dgesv(size(row), 1, matrix, size(row), pivots, step, size(row), info)
         if (info /= 0 .or. .not. all(ieee_is_finite(step))) then
            call undetermined(gearbox, status)
            return
         end if
         share = 1
         do
            trial = y
            trial(unknown) = y(unknown) + share*step(:, 1)*scale(unknown)
            if (gearbox%housing%is_mounted) call housing_take_turn(gearbox%housing, trial)
            call clear(status)
            call steady_residual(gearbox, t, trial, integers, reals, f, status)
            size_trial = norm2(f(row)/row_scale(row))
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

   !> The linear system of Newton's method has no solution.
   subroutine undetermined(gearbox, status)
      type(gearbox_t), intent(in) :: gearbox
      type(status_t), intent(inout) :: status

      if (gearbox%housing%is_mounted) then
         call fail(status, code_no_solution, "the steady state is not determined: no load depends on the speed, and none is" &
                   //" prescribed; or the mount leaves the housing free to move", subject_initial, field="kind")
      else
         call fail(status, code_no_solution, "the steady speed is not determined: no load depends on the speed, and none is" &
                   //" prescribed", subject_initial, field="kind")
      end if
   end subroutine undetermined

   !> The residual where nothing but theta moves.
   subroutine steady_residual(gearbox, t, y, integers, reals, residual, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), reals(:)
      integer, intent(in) :: integers(:)
      real(wp), intent(out) :: residual(gearbox%n_states)
      type(status_t), intent(inout) :: status
      real(wp) :: yp(gearbox%n_states)

      yp = 0
      yp(i_theta) = y(i_omega)
      call gearbox_residual(gearbox, t, y, yp, integers, reals, residual, status)
   end subroutine steady_residual

   !> In the steady state every tooth pair that carries load pushes.
   subroutine check_pressed(gearbox, y, integers, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(:)
      integer, intent(in) :: integers(:)
      type(status_t), intent(inout) :: status
      type(contact_point) :: point
      integer :: m

      do m = 1, size(gearbox%contacts)
         associate (mesh => gearbox%contacts(m), at => gearbox%contacts(m)%i_mode)
            if (integers(at + 1) /= contact_loaded) cycle
            call closed_form_point(gearbox, m, y, 0, integers(at), point)
            if (point%h > 0 .or. (mesh%rigid .and. y(max(1, mesh%i_normal)) > 0)) cycle
            if (mesh%deviates) then
               call fail(status, code_no_solution, "there is no steady state: the slope of the deviating flanks moves them, and" &
                         //" their damping would have to carry the load (penetration "//quantity(point%h, "m")//"); start from" &
                         //" rest or with given speeds", subject_mesh, mesh%mesh, "damping")
               return
            end if
            call fail(status, code_no_solution, "there is no steady state: this flank would have to pull (penetration " &
                      //quantity(point%h, "m")//"); the loads turn the wheels against driving_rotation", subject_mesh, mesh%mesh, &
                      "driving_rotation")
         end associate
         return
      end do
   end subroutine check_pressed

end module evl_steady_state
