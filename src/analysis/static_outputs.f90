!> Outputs of the quasi-static analysis of a mesh as rows of a table: for a torque, for the mesh positions, for tooth pairs there,
!> and for the harmonics of the transmission error. Positions and pairs are listed and stored as in evl_output_registry.
module evl_static_outputs
   use evl_kinds, only: nan, pi, wp
   use evl_mesh_geometry, only: spur_pair_t
   use evl_output, only: dims_harmonic, dims_none, dims_position, dims_position_pair, dims_position_wheel, output_t, &
                         rows_before_sections
   use evl_output_registry, only: add_output, begin_section, registry_t, take_rows
   use evl_pair_point, only: by_a, by_b, edge_of
   use evl_path_points, only: tooth_loss_factor
   use evl_static_extremes, only: extremes_t
   use evl_static_mesh, only: static_state
   use evl_static_points, only: point_pressures_t
   use evl_static_roots, only: root_record_t
   use evl_tooth_root, only: root_extremes_t
   implicit none (type, external)
   private

   public :: list_static, static_counts, static_columns, static_sum
   public :: add_static_harmonic, add_static_mesh, add_static_pair, add_static_position, add_static_root, add_static_start, &
             add_static_points, add_static_torque, add_static_torque_roots
   public :: n_harmonics, youngest

   integer, parameter :: n_harmonics = 10
   integer, parameter :: youngest = -1 !! first slot, for the next pair: pitches ahead of the last pair on the path

   integer, parameter :: in_mesh = 1, in_start = 2, in_torque = 3, in_positions = 4, in_pairs = 5, in_harmonics = 6, &
                         in_torque_roots = 7, in_roots = 8, in_points = 9

   !> Results over all positions at one torque.
   type :: static_sum
      real(wp) :: torque = 0.0_wp, force = 0.0_wp !! of the driving wheel; total tooth force [N m], [N]
      real(wp) :: line_load = 0.0_wp             !! tooth force over the width [N/m]
      real(wp) :: mean = 0.0_wp                  !! mean transmission error [m]
      real(wp) :: secant = 0.0_wp, tangent = 0.0_wp !! mean stiffnesses [N/m]
      real(wp) :: per_width = 0.0_wp             !! mean secant stiffness over the width [Pa]
      real(wp) :: carrying = 0.0_wp              !! mean number of loaded pairs
      real(wp) :: loss_factor = 0.0_wp           !! with the load shares of the analysis, mean over the positions
      type(extremes_t) :: extremes
      type(point_pressures_t) :: points
      real(wp) :: share = 0.0_wp                 !! largest force of a pair over the tooth force [1]
      real(wp) :: single = 0.0_wp                !! stiffness of one pair at the pitch point, per width [Pa]
      real(wp) :: iso_single = 0.0_wp, iso = 0.0_wp !! c' and c_gamma of ISO 6336-1 [Pa]
   end type static_sum

contains

   !> List the table: every section once.
   subroutine list_static(table)
      type(output_t), intent(out), allocatable :: table(:)
      type(registry_t) :: registry
      type(static_state) :: state
      type(static_sum) :: total
      type(spur_pair_t) :: pair
      type(root_extremes_t) :: root
      type(root_record_t) :: records(2)
      real(wp), parameter :: one = 1.0_wp

      call add_static_mesh(registry, pair, 0.0_wp, 0.0_wp)
      call add_static_start(registry, 1, 0.0_wp, 0.0_wp)
      call add_static_torque(registry, total)
      call add_static_position(registry, 1, one, one, one, state)
      call add_static_pair(registry, 1, state, 0, 0.0_wp, 0.0_wp, 0.0_wp)
      call add_static_harmonic(registry, 1, (0.0_wp, 0.0_wp))
      call add_static_torque_roots(registry, records, records)
      call add_static_root(registry, 1, .true., root)
      call add_static_points(registry, total%extremes, total%points)
      call take_rows(registry, table)
   end subroutine list_static

   !> Number of values of each row.
   subroutine static_counts(n_positions, n_pairs, n_wheels, counts)
      integer, intent(in) :: n_positions, n_pairs, n_wheels
      integer, allocatable, intent(out) :: counts(:)
      type(output_t), allocatable :: table(:)
      integer :: i

      call list_static(table)
      counts = [(elements_of(table(i), n_positions, n_pairs, n_wheels), i=1, size(table))]
   end subroutine static_counts

   !> Offsets of the rows in the array of values, and the number of values.
   subroutine static_columns(n_positions, n_pairs, n_wheels, rows_before, columns, n_values)
      integer, intent(in) :: n_positions, n_pairs, n_wheels
      integer, allocatable, intent(out) :: rows_before(:), columns(:) !! as for `store_in`
      integer, intent(out) :: n_values
      type(output_t), allocatable :: table(:)
      integer :: i

      call list_static(table)
      call rows_before_sections(table, rows_before)
      allocate (columns(size(table)))
      n_values = 0
      do i = 1, size(table)
         columns(i) = n_values
         n_values = n_values + elements_of(table(i), n_positions, n_pairs, n_wheels)
      end do
   end subroutine static_columns

   !> Number of elements of a row.
   pure integer function elements_of(row, n_positions, n_pairs, n_wheels) result(n)
      type(output_t), intent(in) :: row
      integer, intent(in) :: n_positions, n_pairs
      integer, intent(in) :: n_wheels !! 2 with root stress, otherwise 0

      select case (row%dims)
      case (dims_position)
         n = n_positions
      case (dims_position_pair)
         n = n_positions*n_pairs
      case (dims_harmonic)
         n = n_harmonics
      case (dims_position_wheel)
         n = n_positions*n_wheels
      case default
         n = 1
      end select
      if (row%section == in_torque_roots .and. n_wheels == 0) n = 0
   end function elements_of

   !> Rows of the mesh.
   subroutine add_static_mesh(registry, pair, width, speed)
      type(registry_t), intent(inout) :: registry
      type(spur_pair_t), intent(in) :: pair
      real(wp), intent(in) :: width !! common face width [m]
      real(wp), intent(in) :: speed !! of the driving wheel, for friction [rad/s]

      call begin_section(registry, in_mesh, dims_none, 1, is_static=.true.)
      call add_output(registry, "base_pitch", "m", "p_b", "base pitch", pair%base_pitch)
      call add_output(registry, "contact_ratio", "1", "eps_alpha", "path of contact over base pitch", pair%contact_ratio)
      call add_output(registry, "common_width", "m", "b", "common face width", width)
      call add_output(registry, "base_radius_driving", "m", "r_bA", "base radius of the driving wheel", pair%base_radius_a)
      call add_output(registry, "base_radius_driven", "m", "r_bB", "base radius of the driven wheel", pair%base_radius_b)
      call add_output(registry, "normal_backlash", "m", "j_bn", &
                      "normal backlash, by which the driven wheel leads on coast flanks without load", pair%backlash)
      call add_output(registry, "driving_speed", "rad s-1", "omega_A", &
                      "speed of the driving wheel for friction; 0: none", speed)
      call add_output(registry, "tooth_loss_factor", "1", "H_V", &
                      "tooth loss factor, equal load shares; NaN outside its validity", &
                      tooth_loss_factor(pair))
   end subroutine add_static_mesh

   !> Rows of a position that do not depend on the torque.
   subroutine add_static_start(registry, position, angle, h_0)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: position
      real(wp), intent(in) :: angle !! [rad]
      real(wp), intent(in) :: h_0   !! [m]

      call begin_section(registry, in_start, dims_position, position, is_static=.true.)
      call add_output(registry, "driving_angle", "rad", "phi_A", &
                      "angle of the driving wheel from position 0", angle)
      call add_output(registry, "free_transmission_error", "m", "h_0", &
                      "transmission error without load, at first contact", h_0)
   end subroutine add_static_start

   !> Rows of all positions at a torque.
   subroutine add_static_torque(registry, total)
      type(registry_t), intent(inout) :: registry
      type(static_sum), intent(in) :: total

      call begin_section(registry, in_torque, dims_none, 1)
      call add_output(registry, "tooth_force", "N", "F", "torque of the driving wheel over its base radius", total%force)
      call add_output(registry, "line_load", "N m-1", "w", "this force over the common width", total%line_load)
      call add_output(registry, "mean_transmission_error", "m", "h_m", "mean transmission error over the positions", total%mean)
      call add_output(registry, "peak_to_peak_transmission_error", "m", "h_pp", "largest less smallest transmission error", &
                      total%extremes%highest_h - total%extremes%lowest_h)
      call add_output(registry, "mean_secant_stiffness", "N m-1", "k_s", &
                      "mean of F/(h - h_0), the transmission error that load adds", total%secant)
      call add_output(registry, "mean_tangent_stiffness", "N m-1", "k_t", "mean of dF/dh with the driving wheel fixed", &
                      total%tangent)
      call add_output(registry, "loaded_contact_ratio", "1", "eps_F", "mean number of loaded tooth pairs", total%carrying)
      call add_output(registry, "loaded_tooth_loss_factor", "1", "H_VL", &
                      "tooth loss factor with the load shares of the analysis, mean over the positions", total%loss_factor)
      call add_output(registry, "largest_force_share", "1", "", "largest force share of a tooth pair", total%share)
      call add_output(registry, "largest_contact_pressure", "Pa", "p_max", &
                      "largest contact pressure, except on sharp tip edges and flanks too concave for one", &
                      total%extremes%pressure)
      call add_output(registry, "largest_edge_force", "N", "", "largest corner (tip-edge) contact force", total%extremes%edge_force)
      call add_output(registry, "smallest_tangent_stiffness", "N m-1", "k_t,min", "smallest tangent stiffness", &
                      total%extremes%softest)
      call add_output(registry, "largest_tangent_stiffness", "N m-1", "k_t,max", "largest tangent stiffness", &
                      total%extremes%stiffest)
      call add_output(registry, "mesh_stiffness_per_width", "Pa", "k_s/b", "mean secant stiffness over the common width", &
                      total%per_width)
      call add_output(registry, "pair_stiffness_per_width", "Pa", "k_1/b", &
                      "secant stiffness of a single pair at the pitch point, over the width", total%single)
      call add_output(registry, "iso_mesh_stiffness_per_width", "Pa", "c_gamma", &
                      "c_gamma of ISO 6336-1 (from measured pairs without body, a different quantity)", total%iso)
      call add_output(registry, "iso_pair_stiffness_per_width", "Pa", "c'", &
                      "c' of ISO 6336-1 (from measured pairs without body, a different quantity)", total%iso_single)
   end subroutine add_static_torque

   !> Rows of a position. Equation SA4.
   subroutine add_static_position(registry, position, force, lag, base_radius, state)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: position
      real(wp), intent(in) :: force       !! total tooth force [N]
      real(wp), intent(in) :: lag         !! of the driven wheel [m]
      real(wp), intent(in) :: base_radius !! of the driven wheel [m]
      type(static_state), intent(in) :: state

      call begin_section(registry, in_positions, dims_position, position)
      call add_output(registry, "transmission_error", "m", "h", "transmission error: lag of the driven wheel along the line" &
                      //" of action", lag)
      call add_output(registry, "transmission_error_angle", "rad", "h/r_bB", "the same as an angle of the driven wheel", &
                      lag/base_radius)
      call add_output(registry, "secant_stiffness", "N m-1", "F/h", &
                      "force over transmission error past the backlash; NaN where that is not positive", ratio(force, state%h))
      call add_output(registry, "loaded_secant_stiffness", "N m-1", "F/(h-h_0)", &
                      "force over the transmission error that load adds", ratio(force, state%h - state%h_0))
      call add_output(registry, "tangent_stiffness", "N m-1", "dF/dh", &
                      "stiffness for small changes of load, the driving wheel fixed", state%stiffness)
      call add_output(registry, "elastic_energy", "J", "U", "elastic energy of teeth, bodies and contacts", state%potential%energy)
      call add_output(registry, "loaded_pairs", "1", "", "number of loaded tooth pairs", &
                      count(state%potential%solution%force(:state%n) > 0))
   end subroutine add_static_position

   !> Rows of a tooth pair slot at a position.
   subroutine add_static_pair(registry, pair_slot, state, i, share, force, pressure)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: pair_slot !! index of the slot, counted over all positions
      type(static_state), intent(in) :: state
      integer, intent(in) :: i     !! index of the pair in the state; 0: none in this slot
      real(wp), intent(in) :: share, force, pressure !! [1], [N], [Pa]
      real(wp) :: foot(2), friction
      integer :: kind

      foot = nan
      friction = 0
      kind = 0
      if (i > 0) then
         friction = state%friction(i)
         foot = state%feet(i)%foot
         if (force > 0) kind = 1 + max(state%feet(i)%zone - edge_of(by_a) + 1, 0)
      end if
      call begin_section(registry, in_pairs, dims_position_pair, pair_slot)
      call add_output(registry, "force_share", "1", "", "normal force of a tooth pair over tooth_force", share)
      call add_output(registry, "pair_normal_force", "N", "F_nk", "normal force of a tooth pair", force)
      call add_output(registry, "pair_friction_force", "N", "F_tk", &
                      "its friction force on the driving wheel, along the t of its flank", friction)
      call add_output(registry, "pair_contact_pressure", "Pa", "p_k", &
                      "largest contact pressure; NaN on a concave flank without one, and on a sharp tip edge", pressure)
      call add_output(registry, "pair_position", "m", "rho_Ak", &
                      "radius of curvature of the driving flank at the contact; NaN out of reach", foot(by_a))
      call add_output(registry, "pair_position_driven", "m", "rho_Bk", "the same for the driven flank", foot(by_b))
      call add_output(registry, "pair_contact_kind", "1", "", &
                      "0 no force, 1 flank on flank, 2 tip edge of the driving wheel, 3 tip edge of the driven wheel", kind)
   end subroutine add_static_pair

   !> Rows of a harmonic of the mesh frequency.
   subroutine add_static_harmonic(registry, harmonic, amplitude)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: harmonic
      complex(wp), intent(in) :: amplitude !! h = Re of the sum over all harmonics of amplitude exp(2 pi i harmonic position) [m]

      call begin_section(registry, in_harmonics, dims_harmonic, harmonic)
      call add_output(registry, "harmonic_amplitude", "m", "h_n", &
                      "amplitude of a harmonic of the transmission error over a pitch", abs(amplitude))
      call add_output(registry, "harmonic_phase", "rad", "phi_n", "its phase: h_n cos(2 pi n position + phi_n)", &
                      atan2(amplitude%im, amplitude%re))
   end subroutine add_static_harmonic

   !> Rows of the contact pressure at A to E at a torque.
   subroutine add_static_points(registry, extremes, points)
      type(registry_t), intent(inout) :: registry
      type(extremes_t), intent(in) :: extremes
      type(point_pressures_t), intent(in) :: points
      character(len=1), parameter :: names(5) = ["a", "b", "c", "d", "e"], symbols(5) = ["A", "B", "C", "D", "E"]
      integer :: i

      call begin_section(registry, in_points, dims_none, 1)
      do i = 1, 5
         call add_output(registry, "contact_pressure_at_"//names(i), "Pa", "p_"//symbols(i), &
                         "contact pressure at point "//symbols(i)//" of the path; 0: no load, NaN: no such point or too concave", &
                         points%simulated(i))
      end do
      do i = 1, 5
         call add_output(registry, "nominal_pressure_at_"//names(i), "Pa", "p_H"//symbols(i), &
                         "nominal contact pressure at point "//symbols(i)//" of the path: geometric load share", points%nominal(i))
      end do
      call add_output(registry, "sharp_edge_force", "N", "", &
                      "largest corner (tip-edge) contact force without a rounding: pressure undefined; 0: none", &
                      extremes%sharp_force)
   end subroutine add_static_points

   !> Rows of the root stress of both wheels over all positions at a torque.
   subroutine add_static_torque_roots(registry, largest, least)
      type(registry_t), intent(inout) :: registry
      type(root_record_t), intent(in) :: largest(2), least(2) !! of the driving and the driven wheel; NaN: no finite elements
      character(len=*), parameter :: wheels(2) = ["driving", "driven "], numbers(2) = ["1", "2"]
      integer :: i

      call begin_section(registry, in_torque_roots, dims_none, 1)
      do i = 1, 2
         call add_extreme("max", "largest", trim(wheels(i)), numbers(i), largest(i))
         call add_extreme("min", "least", trim(wheels(i)), numbers(i)//"-", least(i))
      end do

   contains

      subroutine add_extreme(extreme, text, wheel, suffix, record)
         character(len=*), intent(in) :: extreme, text, wheel, suffix
         type(root_record_t), intent(in) :: record

         call add_output(registry, "root_stress_"//extreme//"_"//wheel, "Pa", "sigma_F"//suffix, &
                         text//" root stress of the "//wheel//" wheel, also between the positions", record%value)
         call add_output(registry, "root_stress_"//extreme//"_x_"//wheel, "1", "x_F"//suffix, "position of this stress", &
                         record%position)
         call add_output(registry, "root_stress_"//extreme//"_arc_"//wheel, "m", "s_"//suffix, &
                         "arc from the form circle to this stress", record%arc)
         call add_output(registry, "root_stress_"//extreme//"_tooth_"//wheel, "1", "", &
                         "tooth with this stress, from 0, counterclockwise; -1: none", record%tooth)
      end subroutine add_extreme

   end subroutine add_static_torque_roots

   !> Rows of the root stress of a wheel at a position.
   subroutine add_static_root(registry, element, exists, root)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: element !! index of the wheel, counted over all positions
      logical, intent(in) :: exists  !! the wheel has finite elements
      type(root_extremes_t), intent(in) :: root

      call begin_section(registry, in_roots, dims_position_wheel, element)
      call add_output(registry, "root_stress_max", "Pa", "sigma_F", &
                      "largest root stress of all teeth; NaN without finite elements", merge(root%largest, nan, exists))
      call add_output(registry, "root_stress_min", "Pa", "sigma_F-", &
                      "least root stress of all teeth; NaN without finite elements", merge(root%least, nan, exists))
      call add_output(registry, "root_stress_max_arc", "m", "s", "arc from the form circle to the largest root stress", &
                      root%arc_largest)
      call add_output(registry, "root_stress_min_arc", "m", "s-", "arc from the form circle to the least root stress", &
                      root%arc_least)
      call add_output(registry, "root_stress_max_tooth", "1", "", &
                      "tooth with the largest root stress, from 0, counterclockwise; -1: none", &
                      merge(root%tooth_largest, -1, exists))
      call add_output(registry, "root_stress_min_tooth", "1", "", &
                      "tooth with the least root stress, from 0, counterclockwise; -1: none", merge(root%tooth_least, -1, exists))
   end subroutine add_static_root

   !> A secant stiffness; NaN if h is not positive. Equation SA4.
   pure real(wp) function ratio(force, h)
      real(wp), intent(in) :: force, h

      ratio = nan
      if (h > 0) ratio = force/h
   end function ratio

end module evl_static_outputs
