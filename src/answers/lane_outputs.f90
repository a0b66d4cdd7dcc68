!> Outputs of a gearbox in eight states at once: each that evl_lane_columns lists has a line in one of the procedures here, of
!> evl_pair_lanes, evl_motion_lanes or evl_torque_lanes. A test compares all of them, bit by bit, with what the rows of the table
!> tell in one state.
module evl_lane_outputs
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_closed_form, only: points_along
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: lanes, wp
   use evl_lane_columns, only: n_lane_outputs, needs_no_places, none, of_arm_a, of_arm_b, of_coast_force, of_coast_gap, &
                               of_curvature, of_curvature_loss, of_damping_loss, of_deviation, of_efficiency, of_friction, &
                               of_friction_loss, of_gap, of_gap_rate, of_lag, of_loaded, of_mode, of_normal, of_pair_normal, &
                               of_pair_sliding, of_penetration, of_point_a, of_point_b, of_sliding, of_tooth_pair, of_torque_a, &
                               of_torque_b, of_touching, of_tracked, put, put_same, put_whole
   use evl_local_variables, only: at_track, n_local
   use evl_mesh_lanes, only: add_mesh, lane_mesh
   use evl_mesh_outputs, only: place_points
   use evl_motion_lanes, only: tell_energies, tell_twists, tell_wheels
   use evl_pair_lanes, only: tell_pairs
   use evl_tangent_line, only: tangent_line_t
   use evl_tooth_contact, only: tooth_contact_t
   use evl_torque_lanes, only: add_torque, forget_torques, lane_torques, tell_torques, torques_create
   implicit none (type, external)
   private

   public :: columns_create, lane_columns, tell_in_lanes

   real(wp), parameter :: nan = transfer(int(z"7FF8000000000000", int64), 1.0_wp)

   !> What is asked for, and where its values go.
   type :: lane_columns
      integer :: of(n_lane_outputs) = none !! values before those of each output
      logical :: has_meshes = .false., has_pairs = .false. !! outputs of these are asked for
      logical :: has_places = .false.      !! and something that needs the places of tooth pairs that do not touch
      type(lane_torques), private :: torques
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
         self%has_meshes = self%has_meshes .or. (kind >= of_lag .and. kind <= of_point_b) .or. kind == of_coast_gap &
                           .or. kind == of_coast_force
      end do
      call torques_create(self%torques, gearbox, self%of)
      self%has_meshes = self%has_meshes .or. self%torques%has_meshes
   end subroutine columns_create

   !> All that is asked for.
   subroutine tell_in_lanes(gearbox, n, self, t, y, integers, slots, aside, f, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: n                               !! the first n states count
      type(lane_columns), intent(inout) :: self              !! scratch of it changes
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      type(lane_slot), intent(in) :: slots(*), aside(*)      !! as of `add_mesh`
      real(wp), intent(in) :: f(lanes, gearbox%n_states)     !! rates
      real(wp), intent(inout) :: values(lanes, *)
      type(lane_mesh) :: mesh
      integer :: m

      call forget_torques(self%torques)
      do m = 1, merge(size(gearbox%pairs), 0, self%has_meshes)
         call add_mesh(gearbox, m, y, integers, slots, aside, self%has_places, mesh)
         call tell_mesh(self%of, m, mesh, values)
      if (self%of(of_point_a) /= none .or. self%of(of_point_b) /= none) call tell_points(gearbox, n, m, self%of, t, y, mesh, values)
         if (.not. self%torques%has_meshes) cycle
         associate (contact => gearbox%contacts(gearbox%first(m)))
            call add_torque(self%torques, contact%wheel_a, mesh%torque_a)
            call add_torque(self%torques, contact%wheel_b, mesh%torque_b)
         end associate
      end do
      do m = 1, merge(size(gearbox%pairs), 0, self%has_pairs)
         call tell_pairs(gearbox, n, m, self%of, slots, aside, values)
      end do
      call tell_energies(gearbox, self%of, y, integers, slots, values)
      call tell_wheels(gearbox, self%of, y, f, integers, values)
      call tell_twists(gearbox, self%of, y, values)
      call tell_torques(gearbox, self%of, self%torques, t, y, f, integers, slots, values)
   end subroutine tell_in_lanes

   !> A mesh.
   pure subroutine tell_mesh(columns, m, mesh, values)
      integer, intent(in) :: columns(:), m
      type(lane_mesh), intent(in) :: mesh
      real(wp), intent(inout) :: values(lanes, *)
      real(wp), dimension(lanes) :: gap, coast_gap, gap_rate
      real(wp) :: input
      integer :: i, l

      !$omp simd
      do l = 1, lanes
         gap(l) = -mesh%h(l)
         coast_gap(l) = -mesh%h_coast(l)
         gap_rate(l) = 0 - mesh%h_dot(l)
      end do
      call put(columns(of_lag), m, mesh%lag, values)
      call put(columns(of_penetration), m, mesh%penetration, values)
      call put(columns(of_gap), m, gap, values)
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
      call put(columns(of_gap_rate), m, gap_rate, values)
      call put(columns(of_deviation), m, mesh%deviation, values)
      call put_whole(columns(of_loaded), m, mesh%loaded, values)
      call put(columns(of_torque_a), m, mesh%torque_a, values)
      call put(columns(of_torque_b), m, mesh%torque_b, values)
      call put(columns(of_friction_loss), m, mesh%loss, values)
      call put(columns(of_damping_loss), m, mesh%damping_loss, values)
      call put(columns(of_curvature_loss), m, mesh%curvature_loss, values)
      call put(columns(of_coast_gap), m, coast_gap, values)
      call put(columns(of_coast_force), m, mesh%coast, values)
      if (columns(of_efficiency) == none) return
      do l = 1, lanes
         input = abs(mesh%torque_a(l)*mesh%omega_a(l))
         values(l, columns(of_efficiency) + m) = nan
         if (input > 0) values(l, columns(of_efficiency) + m) = 1 - mesh%loss(l)/input
      end do
   end subroutine tell_mesh

   !> The points of the contact that speaks for a mesh, by the formulas of one state.
   subroutine tell_points(gearbox, n, m, columns, t, y, mesh, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: n, m, columns(:)
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states)
      type(lane_mesh), intent(in) :: mesh
      real(wp), intent(inout) :: values(lanes, *)
      real(wp) :: q(n_local), points(2, 2)
      integer :: l

      associate (contact => gearbox%contacts(mesh%leader))
         do l = 1, n
            call take_local(contact, l, y, q)
            associate (line => mesh%line)
               call points_along(contact%pair, q, tangent_line_t(.true., line%d_rho(l), line%rho(l), line%angle(l), line%s(l), &
                                                                 line%c(l)), q(at_track:))
            end associate
            call place_points(gearbox, contact, t(l), mesh%rho_a0(l), q, points(:, 1), points(:, 2))
            if (columns(of_point_a) /= none) values(l, columns(of_point_a) + 2*m - 1:columns(of_point_a) + 2*m) = points(:, 1)
            if (columns(of_point_b) /= none) values(l, columns(of_point_b) + 2*m - 1:columns(of_point_b) + 2*m) = points(:, 2)
         end do
      end associate
   end subroutine tell_points

   !> Local variables of one lane, as of `gearbox_local`.
   pure subroutine take_local(contact, l, y, q)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: l
      real(wp), intent(in) :: y(lanes, *)
      real(wp), intent(out) :: q(n_local)
      integer :: i

      q = 0
      do i = 1, size(contact%links)
         associate (link => contact%links(i))
            q(link%local) = q(link%local) + link%weight*y(l, link%state)
         end associate
      end do
   end subroutine take_local

end module evl_lane_outputs
