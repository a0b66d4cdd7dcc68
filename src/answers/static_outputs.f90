!> What the static analysis of a mesh tells, as rows of a table: of a torque, of the positions in the mesh, of tooth pairs there,
!> and of the harmonics of the transmission error. Positions and pairs are listed and filled as evl_teller says.
module evl_static_outputs
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use evl_gearbox, only: section_t
   use evl_kinds, only: pi, wp
   use evl_mesh_geometry, only: spur_pair_t
   use evl_output, only: dims_harmonic, dims_none, dims_position, dims_position_pair, output_t
   use evl_pair_place, only: by_a, by_b, edge_of
   use evl_static_extremes, only: extremes_t
   use evl_static_mesh, only: static_state
   use evl_teller, only: begin, take_rows, tell, teller_t
   implicit none (type, external)
   private

   public :: list_static, static_counts, static_sections, static_sum
   public :: tell_static_harmonic, tell_static_mesh, tell_static_pair, tell_static_position, tell_static_start, tell_static_torque
   public :: n_harmonics, youngest

   integer, parameter :: n_harmonics = 10
   integer, parameter :: youngest = -1 !! the pair that comes next: pitches that it is ahead of the last one on the path

   integer, parameter :: in_mesh = 1, in_start = 2, in_torque = 3, in_positions = 4, in_pairs = 5, in_harmonics = 6

   !> What all positions at one torque add up to.
   type :: static_sum
      real(wp) :: torque = 0.0_wp, force = 0.0_wp !! of the driving wheel; of the teeth [N m], [N]
      real(wp) :: line_load = 0.0_wp             !! force over the width [N/m]
      real(wp) :: mean = 0.0_wp                  !! transmission error [m]
      real(wp) :: secant = 0.0_wp, tangent = 0.0_wp !! mean stiffnesses [N/m]
      real(wp) :: per_width = 0.0_wp             !! the mean secant stiffness over the width [Pa]
      real(wp) :: carrying = 0.0_wp              !! mean number of pairs that carry
      type(extremes_t) :: extremes
      real(wp) :: share = 0.0_wp                 !! the largest force of a pair over that of the teeth [1]
      real(wp) :: single = 0.0_wp                !! stiffness of one pair at the pitch point, per width [Pa]
      real(wp) :: iso_single = 0.0_wp, iso = 0.0_wp !! c' and c_gamma of ISO 6336-1 [Pa]
   end type static_sum

contains

   !> The table: every section told once.
   subroutine list_static(table)
      type(output_t), intent(out), allocatable :: table(:)
      type(teller_t) :: teller
      type(static_state) :: state
      type(static_sum) :: total
      type(spur_pair_t) :: pair
      real(wp), parameter :: one = 1.0_wp

      call tell_static_mesh(teller, pair, 0.0_wp, 0.0_wp)
      call tell_static_start(teller, 1, 0.0_wp, 0.0_wp)
      call tell_static_torque(teller, total)
      call tell_static_position(teller, 1, one, one, one, state)
      call tell_static_pair(teller, 1, state, 0, 0.0_wp, 0.0_wp, 0.0_wp)
      call tell_static_harmonic(teller, 1, (0.0_wp, 0.0_wp))
      call take_rows(teller, table)
   end subroutine list_static

   !> How many values each row has.
   subroutine static_counts(n_positions, n_pairs, counts)
      integer, intent(in) :: n_positions, n_pairs
      integer, allocatable, intent(out) :: counts(:)
      type(output_t), allocatable :: table(:)
      integer :: i

      call list_static(table)
      counts = [(elements_of(table(i)%dims, n_positions, n_pairs), i=1, size(table))]
   end subroutine static_counts

   !> Where the sections stand among the values, and how many these are.
   subroutine static_sections(n_positions, n_pairs, sections, n_values)
      integer, intent(in) :: n_positions, n_pairs
      type(section_t), allocatable, intent(out) :: sections(:)
      integer, intent(out) :: n_values
      type(output_t), allocatable :: table(:)
      integer :: i

      call list_static(table)
      allocate (sections(maxval(table%section)))
      n_values = 0
      do i = 1, size(table)
         associate (n => elements_of(table(i)%dims, n_positions, n_pairs), section => sections(table(i)%section))
            if (section%elements == 0) section = section_t(n_values, n)
            n_values = n_values + n
         end associate
      end do
   end subroutine static_sections

   !> Elements of a section.
   pure integer function elements_of(dims, n_positions, n_pairs) result(n)
      integer, intent(in) :: dims, n_positions, n_pairs

      select case (dims)
      case (dims_position)
         n = n_positions
      case (dims_position_pair)
         n = n_positions*n_pairs
      case (dims_harmonic)
         n = n_harmonics
      case default
         n = 1
      end select
   end function elements_of

   !> Of the mesh.
   subroutine tell_static_mesh(teller, pair, width, speed)
      type(teller_t), intent(inout) :: teller
      type(spur_pair_t), intent(in) :: pair
      real(wp), intent(in) :: width !! common face width [m]
      real(wp), intent(in) :: speed !! of the driving wheel, for friction [rad/s]

      call begin(teller, in_mesh, dims_none, 1, is_static=.true.)
      call tell(teller, "base_pitch", "m", "p_b", "base pitch", pair%base_pitch)
      call tell(teller, "contact_ratio", "1", "eps_alpha", "path of contact over base pitch", pair%contact_ratio)
      call tell(teller, "common_width", "m", "b", "common face width", width)
      call tell(teller, "base_radius_driving", "m", "r_bA", "base radius of the driving wheel", pair%base_radius_a)
      call tell(teller, "base_radius_driven", "m", "r_bB", "base radius of the driven wheel", pair%base_radius_b)
      call tell(teller, "normal_backlash", "m", "j_bn", &
                "normal backlash, by which the driven wheel leads on coast flanks without load", pair%backlash)
      call tell(teller, "driving_speed", "rad s-1", "omega_A", "speed of the driving wheel that friction goes by; 0: none", speed)
   end subroutine tell_static_mesh

   !> Of a position, whatever the torque.
   subroutine tell_static_start(teller, position, angle, h_0)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: position
      real(wp), intent(in) :: angle !! [rad]
      real(wp), intent(in) :: h_0   !! [m]

      call begin(teller, in_start, dims_position, position, is_static=.true.)
      call tell(teller, "driving_angle", "rad", "phi_A", &
                "angle by which the driving wheel has turned on since position 0", angle)
      call tell(teller, "free_transmission_error", "m", "h_0", "transmission error without load, where the first pair touches", h_0)
   end subroutine tell_static_start

   !> Of all positions at a torque.
   subroutine tell_static_torque(teller, total)
      type(teller_t), intent(inout) :: teller
      type(static_sum), intent(in) :: total

      call begin(teller, in_torque, dims_none, 1)
      call tell(teller, "tooth_force", "N", "F", "torque of the driving wheel over its base radius", total%force)
      call tell(teller, "line_load", "N m-1", "w", "this force over the common width", total%line_load)
      call tell(teller, "mean_transmission_error", "m", "h_m", "mean transmission error over the positions", total%mean)
      call tell(teller, "peak_to_peak_transmission_error", "m", "h_pp", "largest less smallest transmission error", &
                total%extremes%highest_h - total%extremes%lowest_h)
      call tell(teller, "mean_secant_stiffness", "N m-1", "k_s", "mean of F/(h - h_0), the transmission error that load adds", &
                total%secant)
      call tell(teller, "mean_tangent_stiffness", "N m-1", "k_t", "mean of dF/dh at rest of the driving wheel", total%tangent)
      call tell(teller, "loaded_contact_ratio", "1", "eps_F", "mean number of tooth pairs that carry", total%carrying)
      call tell(teller, "largest_force_share", "1", "", "largest force share of a tooth pair", total%share)
      call tell(teller, "largest_contact_pressure", "Pa", "p_max", &
                "largest contact pressure of all pairs that have one; on sharp tip edges there is none", &
                total%extremes%pressure)
      call tell(teller, "largest_edge_force", "N", "", "largest force that a tip edge carries", total%extremes%edge_force)
      call tell(teller, "smallest_tangent_stiffness", "N m-1", "k_t,min", "smallest tangent stiffness", total%extremes%softest)
      call tell(teller, "largest_tangent_stiffness", "N m-1", "k_t,max", "largest tangent stiffness", total%extremes%stiffest)
      call tell(teller, "mesh_stiffness_per_width", "Pa", "k_s/b", "mean secant stiffness over the common width", total%per_width)
      call tell(teller, "pair_stiffness_per_width", "Pa", "k_1/b", &
                "secant stiffness of one pair alone at the pitch point, over the width", total%single)
      call tell(teller, "iso_mesh_stiffness_per_width", "Pa", "c_gamma", &
                "c_gamma of ISO 6336-1, from measured pairs without body: not the same", total%iso)
      call tell(teller, "iso_pair_stiffness_per_width", "Pa", "c'", &
                "c' of ISO 6336-1, from measured pairs without body: not the same", total%iso_single)
   end subroutine tell_static_torque

   !> Of a position.
   subroutine tell_static_position(teller, position, force, lag, base_radius, state)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: position
      real(wp), intent(in) :: force       !! of the teeth [N]
      real(wp), intent(in) :: lag         !! of the driven wheel [m]
      real(wp), intent(in) :: base_radius !! of the driven wheel [m]
      type(static_state), intent(in) :: state

      call begin(teller, in_positions, dims_position, position)
      call tell(teller, "transmission_error", "m", "h", "by which the driven wheel lags along the line of action", lag)
      call tell(teller, "transmission_error_angle", "rad", "h/r_bB", "the same as an angle of the driven wheel", &
                lag/base_radius)
      call tell(teller, "secant_stiffness", "N m-1", "F/h", &
                "force over transmission error past the backlash; NaN where that is not positive", ratio(force, state%h))
      call tell(teller, "loaded_secant_stiffness", "N m-1", "F/(h-h_0)", "force over the transmission error that load adds", &
                ratio(force, state%h - state%h_0))
      call tell(teller, "tangent_stiffness", "N m-1", "dF/dh", "stiffness for small changes of load, the driving wheel at rest", &
                state%stiffness)
      call tell(teller, "elastic_energy", "J", "U", "elastic energy of teeth, bodies and contacts", state%potential%energy)
      call tell(teller, "loaded_pairs", "1", "", "number of tooth pairs that carry", &
                count(state%potential%answer%force(:state%n) > 0))
   end subroutine tell_static_position

   !> Of a place for a tooth pair at a position.
   subroutine tell_static_pair(teller, place, state, i, share, force, pressure)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: place !! of all of all positions
      type(static_state), intent(in) :: state
      integer, intent(in) :: i     !! which of its pairs; 0: none is there
      real(wp), intent(in) :: share, force, pressure !! [1], [N], [Pa]
      real(wp) :: foot(2), friction
      integer :: kind

      foot = ieee_value(foot, ieee_quiet_nan)
      friction = 0
      kind = 0
      if (i > 0) then
         friction = state%friction(i)
         foot = state%feet(i)%foot
         if (force > 0) kind = 1 + max(state%feet(i)%zone - edge_of(by_a) + 1, 0)
      end if
      call begin(teller, in_pairs, dims_position_pair, place)
      call tell(teller, "force_share", "1", "", "normal force of a tooth pair over tooth_force", share)
      call tell(teller, "pair_normal_force", "N", "F_nk", "normal force of a tooth pair", force)
call tell(teller, "pair_friction_force", "N", "F_tk", "its friction force on the driving wheel, along the t of its flank", friction)
      call tell(teller, "pair_contact_pressure", "Pa", "p_k", &
                "largest contact pressure; NaN on a sharp tip edge, where none is known", pressure)
      call tell(teller, "pair_position", "m", "rho_Ak", &
                "radius of curvature of the driving flank at the contact; NaN out of reach", foot(by_a))
      call tell(teller, "pair_position_driven", "m", "rho_Bk", "the same of the driven flank", foot(by_b))
      call tell(teller, "pair_contact_kind", "1", "", &
                "0 no force, 1 flank on flank, 2 tip edge of the driving wheel, 3 tip edge of the driven wheel", kind)
   end subroutine tell_static_pair

   !> Of a harmonic of the mesh frequency.
   subroutine tell_static_harmonic(teller, harmonic, amplitude)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: harmonic
      complex(wp), intent(in) :: amplitude !! sum of all is h = Re sum amplitude exp(2 pi i harmonic position) [m]

      call begin(teller, in_harmonics, dims_harmonic, harmonic)
      call tell(teller, "harmonic_amplitude", "m", "h_n", "amplitude of a harmonic of the transmission error over a pitch", &
                abs(amplitude))
      call tell(teller, "harmonic_phase", "rad", "phi_n", "its phase: h_n cos(2 pi n position + phi_n)", &
                atan2(amplitude%im, amplitude%re))
   end subroutine tell_static_harmonic

   !> A stiffness; NaN if there is none.
   pure real(wp) function ratio(force, h)
      real(wp), intent(in) :: force, h

      ratio = ieee_value(ratio, ieee_quiet_nan)
      if (h > 0) ratio = force/h
   end function ratio

end module evl_static_outputs
