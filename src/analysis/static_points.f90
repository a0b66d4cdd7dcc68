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
   use evl_status, only: code_no_solution, fail, has_failed, status_t, subject_none
   use evl_tooth_contact, only: contact_mode
   implicit none (type, external)
   private

   public :: find_point_pressures, point_pressures_t

   integer, parameter :: n_points = 5
   real(wp), parameter :: beside = 1.0e-7_wp   !! distance from a border, in base pitches
   real(wp), parameter :: accuracy = 1.0e-3_wp !! of a position, relative to that distance

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

   !> Position rho_A of pair 0 at which its contact on the driven flank is at rho_B = rho + h - rho_A, from inside the flank.
   !>
   !> The root of rho_A - (rho + h - rho_B) is bracketed, since h is bounded, and found by false position with halving. If h jumps
   !> across it, because a pair without compliance takes its load at once, the result is the side inside the flank.
   !> Errors: those of `solve_static`; code_no_solution if no bracket is found within a pitch.
   subroutine find_end(search, rho_b, rho_a, status)
      type(static_search), intent(inout) :: search
      real(wp), intent(in) :: rho_b
      real(wp), intent(out) :: rho_a
      type(status_t), intent(inout) :: status
      real(wp) :: inside, outside, middle, f_inside, f_outside, f_middle, width, near, reach

      near = accuracy*beside*search%mesh%base_pitch
      rho_a = search%mesh%line - rho_b
      call excess_at(rho_a, f_middle)
      if (has_failed(status) .or. .not. abs(f_middle) > 0) return
      ! the excess rises by one with rho_A, apart from the changes of h
      middle = rho_a
      reach = abs(f_middle)
      inside = middle
      outside = middle
      f_inside = f_middle
      f_outside = f_middle
      do while (.not. (f_outside < 0 .and. f_inside >= 0))
         if (reach > search%mesh%base_pitch) then
            call fail(status, code_no_solution, "no position of the contact at the end of the driven flank was found", subject_none)
            return
         end if
         if (f_middle < 0) then
            inside = middle + reach
            call excess_at(inside, f_inside)
         else
            outside = middle - reach
            call excess_at(outside, f_outside)
         end if
         if (has_failed(status)) return
         reach = 2*reach
      end do
      do
         rho_a = inside
         width = inside - outside
         if (min(width, f_inside) <= near) return
         call take(min(inside, near/2 + inside - f_inside*(width/(f_inside - f_outside))))
         if (has_failed(status)) return
         if (inside - outside > width/2) call take((inside + outside)/2)
         if (has_failed(status)) return
      end do

   contains

      !> Distance of the contact from rho_B into the flank.
      subroutine excess_at(rho, excess)
         real(wp), intent(in) :: rho
         real(wp), intent(out) :: excess
         type(static_state) :: state

         call solve_at_rho(search, rho, state, status)
         excess = rho - (search%mesh%line + state%h - rho_b)
      end subroutine excess_at

      !> Replace one end of the bracket.
      subroutine take(rho)
         real(wp), intent(in) :: rho
         real(wp) :: excess

         call excess_at(rho, excess)
         if (excess < 0) then
            outside = rho
            f_outside = excess
         else
            inside = rho
            f_inside = excess
         end if
      end subroutine take

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
