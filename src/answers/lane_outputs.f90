!> Outputs of a gearbox in eight states at once. Each that evl_lane_columns lists has a line in one of the procedures here; a test
!> compares all of them with what the rows of the table tell in one state.
module evl_lane_outputs
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_contact_lanes, only: lane_contact
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_gearbox_lanes, only: loads_in_lanes
   use evl_kinds, only: lanes, pi, wp
   use evl_lane_columns, only: n_lane_outputs, needs_no_places, none, of_acceleration, of_angle, of_angle_deviation, of_arm_a, &
                               of_arm_b, of_axle_acceleration, of_coast_force, of_coast_gap, of_curvature, of_curvature_loss, &
                               of_damping_loss, of_deviation, of_displacement, of_dissipated, of_efficiency, of_friction, &
                               of_friction_loss, of_gap, of_gap_rate, of_kinetic, of_lag, of_load_torque, of_loaded, of_mode, &
                               of_normal, of_pair_friction, of_pair_kind, of_pair_mode, of_pair_normal, of_pair_number, &
                               of_pair_on_path, of_pair_penetration, of_pair_position, of_pair_sliding, of_pair_tooth_a, &
                               of_pair_tooth_b, of_penetration, of_potential, of_sliding, of_speed, of_support_loss, of_theta, &
                               of_tooth_pair, of_torque_a, of_torque_b, of_touching, of_tracked, of_turns, of_velocity, of_work, &
                               put, put_same, put_whole
   use evl_line_lanes, only: turn_wheel
   use evl_local_variables, only: i_omega, i_theta
   use evl_mesh_lanes, only: add_mesh, lane_mesh
   use evl_shaft, only: shaft_t
   use evl_springs_and_dampers, only: damper_power, spring_damper
   use evl_support, only: support_t
   use evl_tooth_contact, only: contact_mode, edge_wheel, flank_coast, flanks_loaded, flanks_off, no_mode, tooth_of_a, tooth_of_b
   implicit none (type, external)
   private

   public :: columns_create, lane_columns, tell_in_lanes

   real(wp), parameter :: nan = transfer(int(z"7FF8000000000000", int64), 1.0_wp)

   !> What is asked for, and where its values go.
   type :: lane_columns
      integer :: of(n_lane_outputs) = none !! values before those of each output
      logical :: has_meshes = .false., has_pairs = .false. !! outputs of these are asked for
      logical :: has_prescribed = .false.  !! so is the torque of a load that prescribes a speed
      logical :: has_places = .false.      !! and something that needs the places of tooth pairs that do not touch
      real(wp), allocatable, private :: torque(:, :) !! (lanes, wheels) of the meshes [N m]
      real(wp), allocatable, private :: known(:, :)  !! the same of loads
   end type lane_columns

contains

   !> What is asked for.
   subroutine columns_create(self, gearbox)
      type(lane_columns), intent(inout) :: self !! with its columns
      type(gearbox_t), intent(in) :: gearbox
      integer :: kind

      do kind = 1, n_lane_outputs
         if (self%of(kind) == none) cycle
         self%has_places = self%has_places .or. .not. any(needs_no_places == kind)
         self%has_pairs = self%has_pairs .or. (kind >= of_pair_normal .and. kind <= of_pair_sliding)
         self%has_meshes = self%has_meshes .or. (kind >= of_lag .and. kind <= of_efficiency) .or. kind >= of_coast_gap
         self%has_prescribed = self%has_prescribed .or. (kind == of_load_torque .and. any(gearbox%wheels%prescribed > 0))
      end do
      self%has_meshes = self%has_meshes .or. self%has_prescribed
      allocate (self%torque(lanes, size(gearbox%wheels)), self%known(lanes, size(gearbox%wheels)))
   end subroutine columns_create

   !> All that is asked for.
   subroutine tell_in_lanes(gearbox, self, t, y, integers, slots, aside, f, values)
      type(gearbox_t), intent(in) :: gearbox
      type(lane_columns), intent(inout) :: self              !! scratch of it changes
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      type(lane_slot), intent(in) :: slots(*), aside(*)      !! as of `add_mesh`
      real(wp), intent(in) :: f(lanes, gearbox%n_states)     !! rates
      real(wp), intent(inout) :: values(lanes, *)
      type(lane_mesh) :: mesh
      integer :: m

      self%torque = 0
      do m = 1, merge(size(gearbox%pairs), 0, self%has_meshes)
         call add_mesh(gearbox, m, y, integers, slots, aside, self%has_places, mesh)
         call tell_mesh(self%of, m, mesh, values)
         if (.not. self%has_prescribed) cycle
         associate (contact => gearbox%contacts(gearbox%first(m)))
            self%torque(:, contact%wheel_a) = self%torque(:, contact%wheel_a) + mesh%torque_a
            self%torque(:, contact%wheel_b) = self%torque(:, contact%wheel_b) + mesh%torque_b
         end associate
      end do
      do m = 1, merge(size(gearbox%pairs), 0, self%has_pairs)
         call tell_pairs(gearbox, m, self%of, slots, aside, values)
      end do
      call tell_energies(gearbox, self%of, y, integers, slots, values)
      call tell_wheels(gearbox, self%of, y, f, integers, values)
      if (self%of(of_load_torque) == none) return
      associate (before => self%of(of_load_torque))
         call tell_loads(gearbox, t, y, integers, values(1, before + 1))
         if (self%has_prescribed) call tell_prescribed(gearbox, y, f, self%torque, self%known, values(1, before + 1))
      end associate
   end subroutine tell_in_lanes

   !> A mesh.
   pure subroutine tell_mesh(columns, m, mesh, values)
      integer, intent(in) :: columns(:), m
      type(lane_mesh), intent(in) :: mesh
      real(wp), intent(inout) :: values(lanes, *)
      real(wp) :: input
      integer :: i, l

      call put(columns(of_lag), m, mesh%lag, values)
      call put(columns(of_penetration), m, max(mesh%h, 0.0_wp), values)
      call put(columns(of_gap), m, -mesh%h, values)
      call put(columns(of_curvature), m, mesh%curvature, values)
      call put(columns(of_normal), m, mesh%normal, values)
      call put(columns(of_friction), m, mesh%friction, values)
      call put(columns(of_sliding), m, mesh%v_t, values)
      call put(columns(of_arm_a), m, mesh%l_a, values)
      call put(columns(of_arm_b), m, mesh%l_b, values)
      do i = 1, size(of_tracked)
         call put_same(columns(of_tracked(i)), m, nan, values)
      end do
      call put_whole(columns(of_tooth_pair), m, mesh%mode%tooth_pair, values)
      call put(columns(of_touching), m, mesh%touching, values)
      call put_whole(columns(of_mode), m, mesh%mode%flanks, values)
      call put(columns(of_gap_rate), m, -mesh%h_dot, values)
      call put(columns(of_deviation), m, mesh%deviation, values)
      call put_whole(columns(of_loaded), m, mesh%loaded, values)
      call put(columns(of_torque_a), m, mesh%torque_a, values)
      call put(columns(of_torque_b), m, mesh%torque_b, values)
      call put(columns(of_friction_loss), m, mesh%loss, values)
      call put(columns(of_damping_loss), m, mesh%damping_loss, values)
      call put(columns(of_curvature_loss), m, mesh%curvature_loss, values)
      call put(columns(of_coast_gap), m, -mesh%h_coast, values)
      call put(columns(of_coast_force), m, mesh%coast, values)
      if (columns(of_efficiency) == none) return
      do l = 1, lanes
         input = abs(mesh%torque_a(l)*mesh%omega_a(l))
         values(l, columns(of_efficiency) + m) = nan
         if (input > 0) values(l, columns(of_efficiency) + m) = 1 - mesh%loss(l)/input
      end do
   end subroutine tell_mesh

   !> The places of a mesh's tooth pairs.
   subroutine tell_pairs(gearbox, m, columns, slots, aside, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m, columns(:)
      type(lane_slot), intent(in) :: slots(*), aside(*)
      real(wp), intent(inout) :: values(lanes, *)
      type(contact_mode) :: nothing
      integer :: before, c, place, tooth_a, tooth_b

      before = (m - 1)*gearbox%n_pair_places
      nothing = no_mode
      nothing%flanks = flanks_off
      if (gearbox%first(m + 1) - gearbox%first(m) < gearbox%n_pair_places) then
         do place = before + 1, before + gearbox%n_pair_places
            call tell_mode(columns, place, nothing, 0, 0, values)
            call tell_no_point(columns, place, values)
         end do
      end if
      do c = gearbox%first(m), gearbox%first(m + 1) - 1
         associate (contact => gearbox%contacts(c), mode => slots(c)%mode)
            place = before + 1 + contact%slot + merge(gearbox%n_drive_places, 0, contact%flank == flank_coast)
            tooth_a = modulo(tooth_of_a(contact, mode%tooth_pair), gearbox%wheels(contact%wheel_a)%teeth)
            tooth_b = modulo(tooth_of_b(contact, mode%tooth_pair), gearbox%wheels(contact%wheel_b)%teeth)
            call tell_mode(columns, place, mode, tooth_a, tooth_b, values)
            call tell_no_point(columns, place, values)
            if (slots(c)%touches) then
               call tell_point(columns, place, slots(c)%at, values)
            else if (mode%flanks /= flanks_off) then
               call tell_point(columns, place, aside(c)%at, values)
            end if
            if (mode%flanks /= flanks_loaded) cycle
            associate (force => slots(c)%force)
               call put(columns(of_pair_normal), place, force%unclipped, values)
               call put(columns(of_pair_friction), place, -force%unclipped*force%factor, values)
            end associate
         end associate
      end do
   end subroutine tell_pairs

   !> The whole numbers of a place.
   pure subroutine tell_mode(columns, place, mode, tooth_a, tooth_b, values)
      integer, intent(in) :: columns(:), place
      type(contact_mode), intent(in) :: mode
      integer, intent(in) :: tooth_a, tooth_b
      real(wp), intent(inout) :: values(lanes, *)

      call put_whole(columns(of_pair_on_path), place, merge(1, 0, mode%flanks /= flanks_off), values)
      call put_whole(columns(of_pair_number), place, mode%tooth_pair, values)
      call put_whole(columns(of_pair_tooth_a), place, tooth_a, values)
      call put_whole(columns(of_pair_tooth_b), place, tooth_b, values)
      call put_whole(columns(of_pair_mode), place, mode%flanks, values)
      call put_whole(columns(of_pair_kind), place, edge_wheel(mode), values)
   end subroutine tell_mode

   !> Where no tooth pair is on the path: no force, and no point.
   pure subroutine tell_no_point(columns, place, values)
      integer, intent(in) :: columns(:), place
      real(wp), intent(inout) :: values(lanes, *)

      call put_same(columns(of_pair_normal), place, 0.0_wp, values)
      call put_same(columns(of_pair_friction), place, 0.0_wp, values)
      call put_same(columns(of_pair_position), place, nan, values)
      call put_same(columns(of_pair_penetration), place, nan, values)
      call put_same(columns(of_pair_sliding), place, nan, values)
   end subroutine tell_no_point

   !> Where one is.
   pure subroutine tell_point(columns, place, at, values)
      integer, intent(in) :: columns(:), place
      type(lane_contact), intent(in) :: at
      real(wp), intent(inout) :: values(lanes, *)

      call put(columns(of_pair_position), place, at%rho_a, values)
      call put(columns(of_pair_penetration), place, at%h, values)
      call put(columns(of_pair_sliding), place, at%v_t, values)
   end subroutine tell_point

   !> The gearbox as a whole.
   subroutine tell_energies(gearbox, columns, y, integers, slots, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: columns(:)
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(:)
      type(lane_slot), intent(in) :: slots(*)
      real(wp), intent(inout) :: values(lanes, *)
      real(wp), dimension(lanes) :: kinetic, potential, psi, rate
      integer :: i

      call put(columns(of_theta), 1, y(:, i_theta), values)
      call put_whole(columns(of_turns), 1, integers(i_turns), values)
      call put(columns(of_dissipated), 1, y(:, gearbox%i_dissipated), values)
      call put(columns(of_work), 1, y(:, gearbox%i_work), values)
      if (columns(of_kinetic) == none .and. columns(of_potential) == none) return
      kinetic = 0
      potential = 0
      do i = 1, size(gearbox%flanks)
         associate (flank => gearbox%flanks(i)%flank)
            call flank%add_energy_in_lanes(gearbox%contacts, flank%first, flank%last, slots, potential)
         end associate
      end do
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            call turn_wheel(wheel%i_psi, y, psi, rate)
            call add_motion(wheel%inertia, wheel%ratio, y(:, i_omega), rate, kinetic)
            call add_support(wheel%support, y, kinetic, potential)
         end associate
      end do
      do i = 1, size(gearbox%shafts)
         call add_shaft(gearbox%shafts(i), y, potential)
      end do
      call put(columns(of_kinetic), 1, kinetic, values)
      call put(columns(of_potential), 1, potential, values)
   end subroutine tell_energies

   !> The energy of a wheel that turns.
   pure subroutine add_motion(inertia, ratio, omega, rate, kinetic)
      real(wp), intent(in) :: inertia, ratio, omega(lanes), rate(lanes)
      real(wp), intent(inout) :: kinetic(lanes)
      integer :: l

      !$omp simd
      do l = 1, lanes
         kinetic(l) = kinetic(l) + inertia*(ratio*omega(l) + rate(l))**2/2
      end do
   end subroutine add_motion

   !> The energies of a support.
   pure subroutine add_support(support, y, kinetic, potential)
      type(support_t), intent(in) :: support
      real(wp), intent(in) :: y(lanes, *)
      real(wp), intent(inout) :: kinetic(lanes), potential(lanes)
      integer :: j

      do j = 1, support%n
         associate (i => support%i_state(j))
            kinetic = kinetic + support%mass*y(:, i + 1)**2/2
            potential = potential + support%stiffness(j)*y(:, i)**2/2
         end associate
      end do
   end subroutine add_support

   !> The energy of an elastic shaft.
   pure subroutine add_shaft(shaft, y, potential)
      type(shaft_t), intent(in) :: shaft
      real(wp), intent(in) :: y(lanes, *)
      real(wp), intent(inout) :: potential(lanes)
      real(wp), dimension(lanes) :: psi_a, psi_b, rate

      if (shaft%rigid) return
      call turn_wheel(shaft%i_psi_a, y, psi_a, rate)
      call turn_wheel(shaft%i_psi_b, y, psi_b, rate)
      potential = potential + shaft%stiffness*(psi_a - psi_b)**2/2
   end subroutine add_shaft

   !> The wheels, but for their loads.
   subroutine tell_wheels(gearbox, columns, y, f, integers, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: columns(:)
      real(wp), intent(in) :: y(lanes, gearbox%n_states), f(lanes, gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(inout) :: values(lanes, *)
      real(wp), dimension(lanes) :: psi, rate, loss
      integer :: i, j

      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i), support => gearbox%wheels(i)%support)
            call turn_wheel(wheel%i_psi, y, psi, rate)
            call put(columns(of_angle_deviation), i, psi, values)
            call put_turned(columns(of_angle), i, wheel%ratio, y(:, i_theta), 2*pi*integers(i_turns), psi, values)
            call put_turned(columns(of_speed), i, wheel%ratio, y(:, i_omega), 0.0_wp, rate, values)
            if (columns(of_acceleration) /= none) then
               call turn_wheel(wheel%i_psi, f, psi, rate)
               call put_turned(columns(of_acceleration), i, wheel%ratio, f(:, i_omega), 0.0_wp, rate, values)
            end if
            call put_axle(columns(of_displacement), i, support, y, 0, values)
            call put_axle(columns(of_velocity), i, support, y, 1, values)
            call put_axle(columns(of_axle_acceleration), i, support, f, 1, values)
            if (columns(of_support_loss) == none) cycle
            loss = 0
            do j = 1, support%n
               loss = loss + damper_power(support%damping(j), y(:, support%i_state(j) + 1))
            end do
            call put(columns(of_support_loss), i, loss, values)
         end associate
      end do
   end subroutine tell_wheels

   !> What the gearbox turns at a ratio, and what a wheel turns more.
   pure subroutine put_turned(column, element, ratio, turned, whole, more, values)
      integer, intent(in) :: column, element
      real(wp), intent(in) :: ratio, turned(lanes), whole, more(lanes)
      real(wp), intent(inout) :: values(lanes, *)
      integer :: l

      if (column == none) return
      !$omp simd
      do l = 1, lanes
         values(l, column + element) = ratio*(turned(l) + whole) + more(l)
      end do
   end subroutine put_turned

   !> Both components of how an axle deviates, or of a rate of that.
   pure subroutine put_axle(column, wheel, support, y, order, values)
      integer, intent(in) :: column, wheel
      type(support_t), intent(in) :: support
      real(wp), intent(in) :: y(lanes, *) !! as of `axle_deviation`
      integer, intent(in) :: order
      real(wp), intent(inout) :: values(lanes, *)
      integer :: j, k, to

      if (column == none) return
      do k = 1, 2
         to = column + 2*(wheel - 1) + k
         values(:, to) = 0
         do j = 1, support%n
            values(:, to) = values(:, to) + y(:, support%i_state(j) + order)*support%direction(k, j)
         end do
      end do
   end subroutine put_axle

   !> Torque of the loads of every wheel, as `load_torques` in one state.
   subroutine tell_loads(gearbox, t, y, integers, load_torque)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: load_torque(lanes, size(gearbox%wheels))
      real(wp) :: omega(lanes)
      integer :: i

      do i = 1, size(gearbox%wheels)
         load_torque(:, i) = 0
         if (size(gearbox%wheels(i)%loads) == 0) cycle
         call loads_in_lanes(gearbox, i, t, y, integers, omega, load_torque(:, i))
      end do
   end subroutine tell_loads

   !> Add the torque of loads that prescribe a speed: what the rotor needs.
   subroutine tell_prescribed(gearbox, y, f, mesh_torque, known, load_torque)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(lanes, gearbox%n_states), f(lanes, gearbox%n_states)
      real(wp), intent(in) :: mesh_torque(lanes, size(gearbox%wheels))
      real(wp), intent(out) :: known(lanes, size(gearbox%wheels)) !! scratch
      real(wp), intent(inout) :: load_torque(lanes, size(gearbox%wheels))
      integer :: i

      known = load_torque
      do i = 1, size(gearbox%wheels)
         associate (leader => gearbox%wheels(gearbox%wheels(i)%leader))
            if (leader%prescribed == 0) cycle
            associate (driver => gearbox%loads(leader%prescribed)%load%wheel)
               call add_needed(gearbox, i, y, f, mesh_torque(:, i) + known(:, i), load_torque(:, driver))
            end associate
         end associate
      end do
   end subroutine tell_prescribed

   !> Torque that a wheel needs for its motion beside that of its meshes, loads and elastic shafts.
   pure subroutine add_needed(gearbox, index, y, f, torque, needed)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: y(lanes, gearbox%n_states), f(lanes, gearbox%n_states)
      real(wp), intent(in) :: torque(lanes) !! of meshes and loads
      real(wp), intent(inout) :: needed(lanes)
      real(wp), dimension(lanes) :: psi_a, psi_b, rate_a, rate_b
      integer :: i

      associate (wheel => gearbox%wheels(index))
         call turn_wheel(wheel%i_psi, f, psi_a, rate_a)
         needed = needed + (wheel%inertia*(wheel%ratio*f(:, i_omega) + rate_a) - torque)
      end associate
      do i = 1, size(gearbox%shafts)
         associate (shaft => gearbox%shafts(i))
            if (shaft%rigid .or. (shaft%wheel_a /= index .and. shaft%wheel_b /= index)) cycle
            call turn_wheel(shaft%i_psi_a, y, psi_a, rate_a)
            call turn_wheel(shaft%i_psi_b, y, psi_b, rate_b)
            needed = needed + merge(1, -1, shaft%wheel_a == index) &
                     *spring_damper(shaft%stiffness, shaft%damping, psi_a - psi_b, rate_a - rate_b)
         end associate
      end do
   end subroutine add_needed

end module evl_lane_outputs
