!> Contact pressure of a tooth pair under its quasi-static force at the points A to E of the path of contact, beside the nominal
!> pressure there.
!>
!> B, C and D are positions of the contact on the undeformed driving flank; where the force jumps at a border of single contact, the
!> larger value counts. A and E are the last positions before the end of a flank, where a tip edge takes over: under load the
!> transmission error moves A by its amount.
module evl_static_points
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use evl_kinds, only: nan, wp
   use evl_mesh_geometry, only: spur_pair_t
   use evl_pair_point, only: by_a, by_b
   use evl_path_points, only: nominal_pressures, path_points_of, path_points_t, point_a, point_e
   use evl_static_mesh, only: solve_static, static_state
   use evl_static_node, only: touch
   use evl_static_search, only: rho_at, static_search
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: contact_mode
   implicit none (type, external)
   private

   public :: find_point_pressures, point_pressures_t

   integer, parameter :: n_points = 5
   real(wp), parameter :: beside = 1.0e-7_wp   !! distance from a border, in base pitches
   real(wp), parameter :: accuracy = 1.0e-3_wp !! of a position, relative to that distance
   integer, parameter :: most_turns = 50

   !> At A to E; NaN where a point does not exist.
   type :: point_pressures_t
      real(wp) :: nominal(n_points) = nan   !! [Pa]
      real(wp) :: simulated(n_points) = nan !! 0: the pair carries no load there [Pa]
      real(wp) :: force(n_points) = nan     !! of the pair [N]
   end type point_pressures_t

contains

   !> Compute the pressures under the force of a search.
   !> Errors: those of `solve_static`.
   subroutine find_point_pressures(search, pair, pressures, status)
      type(static_search), intent(inout) :: search
      type(spur_pair_t), intent(in) :: pair
      type(point_pressures_t), intent(out) :: pressures
      type(status_t), intent(inout) :: status
      type(path_points_t) :: points
      real(wp) :: force, pressure, rho
      integer :: i, side

      points = path_points_of(pair)
      pressures%nominal = nominal_pressures(points, pair, search%force/search%contact%width, search%contact%e_star)
      associate (step => beside*search%mesh%base_pitch)
         do i = 1, n_points
            if (ieee_is_nan(points%rho(by_a, i))) cycle
            do side = -1, 1, 2
               if (i == point_a) then
                  call find_end(search, search%mesh%tips(by_b)%leaves - step, rho, status)
               else if (i == point_e) then
                  rho = search%mesh%tips(by_a)%leaves - step
               else
                  rho = points%rho(by_a, i) + side*step
               end if
               if (.not. has_failed(status)) call solve_pair(search, rho, force, pressure, status)
               if (has_failed(status)) return
               if (side < 0 .or. force > pressures%force(i)) then
                  pressures%force(i) = force
                  pressures%simulated(i) = pressure
               end if
               if (i == point_a .or. i == point_e) exit
            end do
         end do
      end associate
   end subroutine find_point_pressures

   !> Position rho_A of pair 0 at which its contact on the driven flank is at rho_B = rho + h - rho_A.
   subroutine find_end(search, rho_b, rho_a, status)
      type(static_search), intent(inout) :: search
      real(wp), intent(in) :: rho_b
      real(wp), intent(out) :: rho_a
      type(status_t), intent(inout) :: status
      type(static_state) :: state
      real(wp) :: before
      integer :: turn

      rho_a = search%mesh%line - rho_b
      do turn = 1, most_turns ! the transmission error is nearly constant over its own amount
         call solve_at_rho(search, rho_a, state, status)
         if (has_failed(status)) return
         before = rho_a
         rho_a = search%mesh%line + state%h - rho_b
         if (abs(rho_a - before) <= accuracy*beside*search%mesh%base_pitch) return
      end do
   end subroutine find_end

   !> Force and pressure of pair 0 at rho_A.
   subroutine solve_pair(search, rho_a, force, pressure, status)
      type(static_search), intent(inout) :: search
      real(wp), intent(in) :: rho_a
      real(wp), intent(out) :: force, pressure !! NaN on a sharp edge [N], [Pa]
      type(status_t), intent(inout) :: status
      type(static_state) :: state
      type(contact_mode) :: mode
      integer :: i

      force = 0
      pressure = 0
      call solve_at_rho(search, rho_a, state, status)
      if (has_failed(status)) return
      i = findloc(state%numbers(:state%n), 0, dim=1)
      if (i == 0) return
      if (.not. state%potential%solution%force(i) > 0) return
      force = state%potential%solution%force(i)*search%mesh%width
      call touch(search%contact, 0, search%mesh, state, i, mode, pressure)
   end subroutine solve_pair

   !> Solve the mesh with pair 0 at rho_A.
   subroutine solve_at_rho(search, rho_a, state, status)
      type(static_search), intent(inout) :: search
      real(wp), intent(in) :: rho_a
      type(static_state), intent(out) :: state
      type(status_t), intent(inout) :: status

      search%at = (rho_a - rho_at(search, 0.0_wp))/(search%turns*search%mesh%base_pitch)
      call solve_static(search%mesh, rho_a, search%force, state, status)
   end subroutine solve_at_rho

end module evl_static_points
