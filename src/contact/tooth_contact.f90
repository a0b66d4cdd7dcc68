!> One tooth contact of a mesh: a slot on one flank that tooth pairs pass through in succession, and the position of the contact of
!> the pair. The flank computes the forces: evl_flank.
!>
!> A mesh has as many slots on each flank, drive and coast, as tooth pairs can be on the path of contact at once, plus one for the
!> waiting pair: pair k uses slot k mod n_slots. A pair is on the path while both radii of curvature are below those of the tips. If
!> the contact ratio is exactly 1, there is one slot, and a pair hands over to the next after one pitch.
!>
!> Forces are those on the driving wheel A, positive along t and against e; the forces on wheel B are opposite.
module evl_tooth_contact
   use evl_closed_form, only: closed_form_line, point_on_line, radii_on_line, track_closed_form
   use evl_contact_point, only: contact_point, tracked_pair
   use evl_contact_tracking, only: track_points
   use evl_coupled_pairs, only: most_pairs
   use evl_damping_law, only: damping_law_t, viscous_result
   use evl_deviating_flanks, only: deviate, flank_value, flanks_turned, turn_values
   use evl_edge_contact, only: edge_contact, feet_beyond, put_on_edge
   use evl_elastic_law, only: elastic_law_t, elastic_result
   use evl_flank_deviation, only: deviation_branch, deviation_on, deviation_zone, flank_branch, flank_deviation_t, flank_slope, &
                                  slope_on, zone_edge, zone_end, zone_tip, zone_tip_corner
   use evl_friction_law, only: friction_law_t, n_sliding
   use evl_kinds, only: wp
   use evl_local_variables, only: local_link, n_local, wheel_link
   use evl_pair_point, only: by_a, by_b, tip_t
   use evl_rational, only: rational_pitches, rational_t
   use evl_root_kinds, only: n_discrete, n_root_kinds, n_sides
   use evl_tangent_line, only: tangent_line_t
   implicit none (type, external)
   private

   public :: tooth_contact_t, contact_state, contact_mode, contact_force, no_force, no_mode
   public :: beyond_flank, edge_wheel, ended_wheel, flank_branches, flank_values, line_along, line_length, locate_anywhere
   public :: feet_of, line_of, locate_contact, on_involutes, pair_compliant_data
   public :: nominal_rho, nominal_start, settle_friction, touches, unclipped
   public :: tracking_closed_form, tracking_algebraic, tracking_differential
   public :: flanks_open, flanks_loaded, flanks_unloaded, flanks_apart, flanks_off
   public :: flank_drive, flank_coast
   public :: settle_zones, tooth_of_a, tooth_of_b

   integer, parameter :: tracking_closed_form = 0  !! contact from the wheels' positions
   integer, parameter :: tracking_algebraic = 1    !! contact from (1)
   integer, parameter :: tracking_differential = 2 !! contact from (2)-(3)

   integer, parameter :: flanks_open = 0     !! a gap
   integer, parameter :: flanks_loaded = 1   !! penetration and force
   integer, parameter :: flanks_unloaded = 2 !! penetration, but the damper would pull: no force
   integer, parameter :: flanks_apart = 3    !! tracked flanks so far apart that no two points face each other
   integer, parameter :: flanks_off = 4      !! no tooth pair of this slot is on the path of contact

   integer, parameter :: flank_drive = 0 !! the driving wheel pushes in its nominal sense of rotation
   integer, parameter :: flank_coast = 1 !! the other side of the teeth

   type :: tooth_contact_t
      integer :: mesh = 0                 !! index of its mesh in the gearbox
      integer :: flank = flank_drive      !! drive or coast
      integer :: i_flank = 0              !! index of its flank in the gearbox
      integer :: slot = 0, n_slots = 1    !! slot of the flank, from 0, and number of slots
      logical :: handover = .true.        !! one slot, pairs change after one pitch; otherwise at the ends of the path
      integer :: wheel_a = 0, wheel_b = 0 !! driving and driven wheel
      type(tracked_pair) :: pair          !! geometry for the tracking
      class(elastic_law_t), allocatable :: elastic
      class(damping_law_t), allocatable :: damping
      class(friction_law_t), allocatable :: friction
      logical :: rigid = .false.          !! contact is a constraint
      logical :: one_sided = .false.      !! the damping law has a side of approach and one of separation
      integer :: tracking = tracking_closed_form
      real(wp) :: e_star = 0.0_wp         !! effective modulus [Pa]
      real(wp) :: width = 0.0_wp          !! common face width [m]
      real(wp) :: base_pitch = 0.0_wp     !! |ab| [m]
      real(wp) :: step = 0.0_wp           !! decrease of rho_A from one pair to the next; < 0 for coast [m]
      real(wp) :: rho_start = 0.0_wp      !! rho_A of pair 0 at theta = 0 [m]
      real(wp) :: rho_entry = 0.0_wp      !! rho_A where a pair with handover begins [m]
      real(wp) :: rho_tip_a = 0.0_wp, rho_tip_b = 0.0_wp !! radii of curvature at the tips, the ends of the path [m]
      type(rational_t) :: pitches_per_turn !! pitches by which one revolution of the reference wheel moves rho_A0
      real(wp) :: gap_apart = 0.0_wp      !! gap above which flanks are not tracked [m]
      real(wp) :: t_0(2) = 0.0_wp, e_0(2) = 0.0_wp !! nominal basis in the housing frame
      real(wp) :: axial_position = 0.0_wp !! z of the middle of the common width [m]
      real(wp) :: k_a0(2) = 0.0_wp        !! K_A at the reference centre distance [m]
      real(wp) :: force_scale = 0.0_wp    !! normal force at the nominal operating point, or a fallback > 0 [N]
      real(wp) :: h_scale = 0.0_wp        !! its penetration [m]
      real(wp) :: rate_scale = 0.0_wp     !! rate of a vibration with that amplitude [m/s]
      logical :: deviates = .false.       !! whether a flank deviates from the involute
      type(flank_deviation_t) :: deviation_a, deviation_b !! deviations of A and B
      logical :: has_edges = .false.      !! edge contact before and after the path; deviates is then true
      type(tip_t) :: tips(2)              !! of A and B
      real(wp) :: fillets(2) = 0.0_wp     !! radii of curvature where the fillets of A and B begin; 0: unknown [m]
      real(wp) :: smooth(2, 2) = 0.0_wp   !! radii of curvature between which c is smooth, of A and B; 0: rigid wheel [m]
      integer :: order(2) = [1, -1]       !! +1: tooth pairs are in the order of A's, B's teeth, counterclockwise; -1: opposite
      real(wp) :: side(2) = 1.0_wp        !! +1, or -1 for an internal wheel: sign of the radii of A, B
      integer :: tooth_a = 0, tooth_b = 0 !! teeth of pair 0, counted counterclockwise from the first ones of the wheels
      type(local_link), allocatable :: links(:) !! local variables in terms of the state
      type(wheel_link) :: link_a, link_b  !! the same, for each wheel
      logical :: axles_rest = .false.     !! both axles are fixed, and so is the line of action
      type(tangent_line_t) :: rest_line        !! line of action for fixed axles
      logical :: leads = .false.          !! the first slot of a rigid flank, which holds the constraint of the flank
      integer :: i_normal = 0             !! multiplier of a rigid flank in the state; 0 if none
      integer :: i_dependent = 0          !! deviation of the wheel that a closed rigid contact determines
      real(wp) :: mobility = 0.0_wp       !! r_bA^2/J_A + r_bB^2/J_B [1/kg]
      integer :: i_track = 0              !! first tracked variable in the state; 0 if none
      integer :: i_discrete(n_discrete) = 0 !! indices of its integers in the discrete state, for evl_discrete_state only; 0: none
      integer :: i_root = 0               !! index before its first root function
      integer :: n_roots = 0              !! number of root functions
      integer :: roots(n_root_kinds) = 0  !! their kinds, the first n_roots
      integer :: moved(n_root_kinds) = 0  !! integer of the mode that each of them changes
      integer :: directions(zone_tip_corner:zone_edge, flanks_open:flanks_off, n_root_kinds) = 0 !! by that integer and the flanks
   end type tooth_contact_t

   !> Discrete state of a tooth contact.
   type :: contact_mode
      integer :: tooth_pair         !! pitches since the start
      integer :: flanks   !! open, loaded, unloaded, apart, or off the path
      integer :: friction           !! branch of the friction law
      integer :: zone_a, zone_b !! parts of the modified flanks
      integer :: sides(n_sides)     !! for root kinds with a side: +1 above the border, -1 below
      real(wp) :: share        !! part of a rigid flank's normal force carried by this pair
      real(wp) :: v0           !! approach speed at the last closing [m/s]
   end type contact_mode
   type(contact_mode), parameter :: no_mode = contact_mode(0, flanks_open, 0, 0, 0, 0, 1.0_wp, 0.0_wp)

   !> Forces of a tooth contact.
   type :: contact_force
      real(wp) :: normal   !! F_n >= 0 [N]
      real(wp) :: friction !! F_t along t on A [N]
      real(wp) :: torque_a, torque_b !! on the wheels [N m]
      real(wp) :: on_a(2)  !! force on A in (t_0, e_0) [N]
      real(wp) :: dissipation !! power lost to damping, clipping, friction and changing radii [W]
   end type contact_force
   type(contact_force), parameter :: no_force = contact_force(0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp)

   !> Data of a compliant pair on A and on B; used only for compliant flanks. Per unit width; arrays over the pairs that touch, in
   !> their order. For independent pairs the first element is the pair itself.
   type :: pair_compliant_data
      real(wp) :: slope(2)                 !! s, with respect to the loaded positions: acts like a slope of the flank deviation [1]
      real(wp) :: by_force(most_pairs, 2)  !! ds/dN [m/N]
      real(wp) :: by_own(most_pairs, 2)    !! with respect to the pair's own position, divided by N of each pair [1/N]
      real(wp) :: by_other(most_pairs, 2)  !! with respect to the position of each pair, divided by its N [1/N]
      real(wp) :: factor(most_pairs)       !! its row of the factor of `coupled_solution`
      logical :: carries                   !! as in `coupled_solution`
      real(wp) :: by_h, by_line, by_foot(2) !! derivatives of its elastic force, for independent pairs [N/m]
   end type pair_compliant_data

   !> A tooth contact at a state of the gearbox: scratch of the caller, not initialised.
   type :: contact_state
      type(contact_mode) :: mode
      real(wp) :: rho_a0             !! nominal radius of curvature on A [m]
      real(wp) :: q(n_local)         !! local variables
      type(contact_point) :: point
      real(wp) :: overlap            !! overlap of its flanks if it were unloaded: h, less the gap opened by other pairs [m]
      type(elastic_result) :: elastic !! this and the following components are undefined if flanks do not touch
      type(viscous_result) :: viscous
      type(pair_compliant_data) :: compliant
      type(edge_contact) :: edge      !! past the end of a flank only
      real(wp) :: factor, d_factor(n_sliding) !! phi of the friction law and its derivatives
      type(contact_force) :: force
   end type contact_state

contains

   !> Nominal radius of curvature rho_A0 of the tooth pair in mesh [m]; teeth and revolutions are integers and remain exact.
   !> Equations T24, TR3.
   pure real(wp) function nominal_rho(contact, theta, turns, teeth) result(rho_a0)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: theta  !! reference angle [rad]
      integer, intent(in) :: turns   !! whole revolutions of the reference wheel in addition to theta
      integer, intent(in) :: teeth   !! tooth pair: pitches since the start

      rho_a0 = nominal_start(contact, turns, teeth) + contact%pair%advance*theta
   end function nominal_rho

   !> The same at theta = 0. Equations P2, T24, TR3.
   pure real(wp) function nominal_start(contact, turns, teeth) result(rho_a0)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: turns, teeth

      rho_a0 = contact%rho_start + contact%step*rational_pitches(contact%pitches_per_turn, turns, teeth)
   end function nominal_start

   !> Contact position of a tooth pair by its tracking method; in closed form while tracking is off. For a pair off the path of
   !> contact the closed form gives only the radii of curvature, which determine when a pair enters.
   pure subroutine locate_contact(contact, line, at)
      type(tooth_contact_t), intent(in) :: contact
      type(tangent_line_t), intent(in) :: line    !! line of action; not used for tracked points
      type(contact_state), intent(inout) :: at    !! with its mode, rho_a0 and local variables

      if (at%mode%flanks == flanks_apart) then
         call track_closed_form(contact%pair, at%rho_a0, at%q, at%point)
      else if (contact%tracking /= tracking_closed_form) then
         call track_points(contact%pair, at%rho_a0, at%q, at%point)
      else if (at%mode%flanks == flanks_off) then
         call radii_on_line(contact%pair, at%rho_a0, at%q, line, at%point)
      else
         call point_on_line(contact%pair, at%rho_a0, at%q, line, at%point)
         if (contact%deviates) call leave_involutes(contact, at)
      end if
      at%overlap = at%point%h
   end subroutine locate_contact

   !> The same in closed form, for any tracking method and any position of the pair.
   pure subroutine locate_anywhere(contact, settles, at)
      type(tooth_contact_t), intent(in) :: contact
      logical, intent(in) :: settles           !! whether to determine the zones of the modified flanks from the position
      type(contact_state), intent(inout) :: at !! as in `locate_contact`

      call track_closed_form(contact%pair, at%rho_a0, at%q, at%point)
      if (settles) call settle_zones(contact, line_length(contact, at%q), at%point, at%mode)
      if (contact%deviates) call leave_involutes(contact, at)
      at%overlap = at%point%h
   end subroutine locate_anywhere

   !> Correct the contact of perfect involutes for deviations of the flanks or for a tip edge.
   pure subroutine leave_involutes(contact, at)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(inout) :: at
      type(flank_value) :: a, b
      type(flanks_turned) :: turned
      type(flank_branch) :: branches(2)

      if (beyond_flank(at%mode)) then
         call flank_branches(contact, at%mode, branches(by_a), branches(by_b))
         call put_on_edge(contact%pair, contact%tips, contact%deviation_a, contact%deviation_b, [at%mode%zone_a, at%mode%zone_b], &
                          branches, at%q, at%point, at%edge)
         return
      end if
      call flank_values(contact, at%mode, at%point, a, b, turned)
      call deviate(contact%pair, a, b, at%q, at%point)
   end subroutine leave_involutes

   !> Line of action of a contact in closed form.
   pure subroutine line_along(contact, q, line)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: q(n_local)
      type(tangent_line_t), intent(out) :: line

      line = contact%rest_line
      if (.not. contact%axles_rest) call closed_form_line(contact%pair, q, line)
   end subroutine line_along

   !> Length of the line of action [m].
   pure real(wp) function line_length(contact, q)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: q(n_local)
      type(tangent_line_t) :: line

      call line_along(contact, q, line)
      line_length = line%rho
   end function line_length

   !> Whether a pair is past the end of a flank.
   pure logical function beyond_flank(mode)
      type(contact_mode), intent(in) :: mode

      beyond_flank = max(mode%zone_a, mode%zone_b) >= zone_end
   end function beyond_flank

   !> Wheel whose flank end is passed: by_a or by_b.
   pure integer function ended_wheel(mode)
      type(contact_mode), intent(in) :: mode !! past the end of a flank

      ended_wheel = merge(by_a, by_b, mode%zone_a >= zone_end)
   end function ended_wheel

   !> Wheel in contact with its tip edge: by_a, by_b, or 0 if both flanks touch.
   pure integer function edge_wheel(mode) result(wheel)
      type(contact_mode), intent(in) :: mode

      wheel = 0
      if (mode%zone_b == zone_edge) wheel = by_b
      if (mode%zone_a == zone_edge) wheel = by_a
   end function edge_wheel

   !> Roll lengths at which A and B are loaded [m].
   pure function feet_of(at) result(foot)
      type(contact_state), intent(in) :: at !! with its point
      real(wp) :: foot(2)

      foot = [at%point%rho_a, at%point%rho_b]
      if (at%mode%flanks /= flanks_off .and. beyond_flank(at%mode)) foot = at%edge%foot
   end function feet_of

   !> Length of the line of action, independent of deviations: from the edge past the end of a flank, otherwise the sum of the arms
   !> of friction [m].
   pure real(wp) function line_of(at)
      type(contact_state), intent(in) :: at !! with its point

      line_of = at%point%l_a + at%point%l_b
      if (beyond_flank(at%mode)) line_of = at%edge%line
   end function line_of

   !> Unclipped elastic + viscous force [N]; 0 if flanks do not overlap.
   pure real(wp) function unclipped(at) result(force)
      type(contact_state), intent(in) :: at !! with the forces of its laws

      force = 0
      if (touches(at%mode)) force = at%elastic%force + at%viscous%force
   end function unclipped

   !> Deviations of the flanks of a tooth pair.
   pure subroutine flank_values(contact, mode, point, a, b, turned)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      type(flank_value), intent(out) :: a, b
      type(flanks_turned), intent(out) :: turned
      type(flank_branch) :: branch_a, branch_b
      type(flank_slope) :: slope_a, slope_b

      call flank_branches(contact, mode, branch_a, branch_b)
      call deviation_on(branch_a, point%rho_a, a%e, a%de, a%d2e)
      call deviation_on(branch_b, point%rho_b, b%e, b%de, b%d2e)
      if (.not. (branch_a%slopes .and. branch_b%slopes)) return
      call slope_on(contact%deviation_a, mode%zone_a, branch_a, point%rho_a, slope_a)
      call slope_on(contact%deviation_b, mode%zone_b, branch_b, point%rho_b, slope_b)
      call turn_values(contact%pair, slope_a, slope_b, a, b, turned)
   end subroutine flank_values

   !> Branches of the deviations of the flanks of a tooth pair.
   pure subroutine flank_branches(contact, mode, a, b)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(flank_branch), intent(out) :: a, b

      associate (side => nint(contact%pair%sigma))
         a = deviation_branch(contact%deviation_a, tooth_of_a(contact, mode%tooth_pair), side, mode%zone_a)
         b = deviation_branch(contact%deviation_b, tooth_of_b(contact, mode%tooth_pair), side, mode%zone_b)
      end associate
   end subroutine flank_branches

   !> Tooth of the driving wheel in a pair, counted counterclockwise, modulo the number of teeth.
   pure integer function tooth_of_a(contact, pair) result(tooth)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: pair

      tooth = contact%tooth_a + contact%order(by_a)*pair
   end function tooth_of_a

   !> Tooth of the driven wheel in a pair, counted counterclockwise.
   pure integer function tooth_of_b(contact, pair) result(tooth)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: pair

      tooth = contact%tooth_b + contact%order(by_b)*pair
   end function tooth_of_b

   !> Zones of the modified flanks in which a contact lies, or past which it lies.
   pure subroutine settle_zones(contact, line, point, mode)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: line !! length of the line of action [m]
      type(contact_point), intent(in) :: point
      type(contact_mode), intent(inout) :: mode
      integer :: zones(2)
      real(wp) :: foot(2)

      if (.not. contact%deviates) return
      zones = zone_tip
      foot = [point%rho_a, point%rho_b]
      if (contact%has_edges) call feet_beyond(contact%tips, point%rho_a, point%rho_b, line, zones, foot)
      mode%zone_a = zones(by_a)
      mode%zone_b = zones(by_b)
      if (zones(by_a) <= zone_tip) mode%zone_a = deviation_zone(contact%deviation_a, foot(by_a))
      if (zones(by_b) <= zone_tip) mode%zone_b = deviation_zone(contact%deviation_b, foot(by_b))
   end subroutine settle_zones

   !> Whether a contact lies on both involutes. An edge touches its mate farther out than on the line of action.
   pure logical function on_involutes(contact, at)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at

      on_involutes = at%point%exists .and. all(contact%side*feet_of(at) > 0)
   end function on_involutes

   !> Whether the flanks of a tooth pair overlap, so that the laws give forces.
   pure logical function touches(mode)
      type(contact_mode), intent(in) :: mode

      touches = mode%flanks == flanks_loaded .or. mode%flanks == flanks_unloaded
   end function touches

   !> Friction branch of a contact.
   pure integer function settle_friction(contact, point) result(branch)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_point), intent(in) :: point

      branch = contact%friction%branch(point%v_t)
   end function settle_friction

end module evl_tooth_contact
