!> One tooth contact of a mesh: a slot that tooth pairs pass through one after the other on one flank, the forces on both wheels,
!> and what happens to it.
!>
!> A mesh has as many slots on each flank, drive and coast, as tooth pairs can be on the path of contact at once, and one more
!> that waits: pair k takes slot k mod n_slots. A pair is on the path while both radii of curvature are below those of the tips.
!> Where the contact ratio is exactly 1 there is one slot, and a pair hands over to the next one pitch on.
!>
!> Forces are counted on the driving wheel A, along t and against e; wheel B feels the opposite.
module evl_tooth_contact
   use evl_closed_form, only: track_closed_form
   use evl_contact_context, only: contact_context
   use evl_contact_point, only: contact_point, tracked_pair
   use evl_contact_tracking, only: track_points
   use evl_damping_law, only: damping_law_t, viscous_force, viscous_result
   use evl_deviating_flanks, only: deviate, flank_value
   use evl_elastic_law, only: elastic_law_t, elastic_result
   use evl_flank_deviation, only: deviation_branch, deviation_on, deviation_zone, flank_branch, flank_deviation_t
   use evl_friction_law, only: friction_law_t
   use evl_kinds, only: wp
   use evl_local_variables, only: local_link, n_local, wheel_link
   use evl_rational, only: rational_pitches, rational_t
   use evl_root_kinds, only: n_discrete, n_root_kinds, n_sides, side_of_rate
   use evl_status, only: code_ok, code_out_of_domain, fail, quantity, status_t, subject_mesh
   use evl_tangent_line, only: tangent_line_t
   implicit none (type, external)
   private

   public :: tooth_contact_t, contact_state, contact_mode, contact_force
   public :: contact_law, context_of, flank_branches, flank_values, forces_of_laws, left_involute, locate_contact
   public :: contact_forces, contact_energy, on_involutes
   public :: nominal_rho, nominal_start, unclipped_force, settle_friction, touches
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
      integer :: mesh = 0                 !! of the gearbox, to which the contact belongs
      integer :: flank = flank_drive      !! drive or coast
      integer :: slot = 0, n_slots = 1    !! which of the flank's slots, from 0, and how many
      logical :: handover = .true.        !! one slot, and pairs change one pitch on; else at the ends of the path
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
      real(wp) :: step = 0.0_wp           !! by how much rho_A of a pair is less than that of the pair before; < 0 for coast [m]
      real(wp) :: rho_start = 0.0_wp      !! rho_A of pair 0 at theta = 0 [m]
      real(wp) :: rho_entry = 0.0_wp      !! rho_A where a pair that hands over begins [m]
      real(wp) :: rho_tip_a = 0.0_wp, rho_tip_b = 0.0_wp !! radii of curvature at the tips, the ends of the path [m]
      type(rational_t) :: pitches_per_turn !! by how many pitches one turn of the reference wheel moves rho_A0
      real(wp) :: gap_apart = 0.0_wp      !! gap past which flanks are not tracked [m]
      real(wp) :: t_0(2) = 0.0_wp, e_0(2) = 0.0_wp !! nominal basis in the housing frame
      real(wp) :: axial_position = 0.0_wp !! z of the middle of the common width [m]
      real(wp) :: k_a0(2) = 0.0_wp        !! K_A at the reference centre distance [m]
      real(wp) :: force_scale = 0.0_wp    !! normal force that the loads suggest [N]
      real(wp) :: h_scale = 0.0_wp        !! its penetration [m]
      real(wp) :: rate_scale = 0.0_wp     !! its rate, if the contact vibrates that far [m/s]
      logical :: deviates = .false.       !! whether a flank deviates from the involute
      type(flank_deviation_t) :: deviation_a, deviation_b !! and how
      integer :: tooth_sign = 1           !! +1: tooth pairs come in the order of A's teeth, counted counterclockwise; -1: against
      integer :: tooth_a = 0, tooth_b = 0 !! teeth of pair 0, counted counterclockwise from the first ones of the wheels
      type(local_link), allocatable :: links(:) !! local variables in terms of the state
      type(wheel_link) :: link_a, link_b  !! the same, wheel by wheel
      logical :: axles_rest = .false.     !! both axles are fixed, and the line of action with them
      type(tangent_line_t) :: rest_line        !! where it is then
      logical :: leads = .false.          !! the first slot of a rigid flank: the flank's constraint is its
      integer :: i_normal = 0             !! multiplier of a rigid flank in the state; 0 if none
      integer :: i_dependent = 0          !! deviation of the wheel that a closed rigid contact determines
      real(wp) :: mobility = 0.0_wp       !! r_bA^2/J_A + r_bB^2/J_B [1/kg]
      integer :: i_track = 0              !! first tracked variable in the state; 0 if none
      integer :: i_discrete(n_discrete) = 0 !! indices of its integers in the discrete state, for its door alone; 0: has none
      integer :: i_root = 0               !! place before its root functions
      integer :: n_roots = 0              !! how many there are
      integer :: roots(n_root_kinds) = 0  !! their kinds, the first n_roots
      integer :: moved(n_root_kinds) = 0  !! which integer of the mode each of them moves
      integer :: directions(-1:1, flanks_open:flanks_off, n_root_kinds) = 0 !! of each: by that integer and the flanks
   end type tooth_contact_t

   !> Discrete state of a tooth contact.
   type :: contact_mode
      integer :: tooth_pair = 0         !! pitches since the start
      integer :: flanks = flanks_open   !! open, loaded, unloaded, apart, or off the path
      integer :: friction = 0           !! branch of the friction law
      integer :: zone_a = 0, zone_b = 0 !! parts of the modified flanks
      integer :: sides(n_sides) = 0     !! of the borders of root kinds that have sides: +1 above, -1 below
      real(wp) :: share = 1.0_wp        !! of a rigid flank's normal force that this pair carries
      real(wp) :: v0 = 0.0_wp           !! approach speed at the last closing [m/s]
   end type contact_mode

   !> Forces of a tooth contact.
   type :: contact_force
      real(wp) :: normal = 0.0_wp   !! F_n >= 0 [N]
      real(wp) :: elastic = 0.0_wp  !! its elastic part before clipping [N]
      real(wp) :: viscous = 0.0_wp  !! its viscous part before clipping [N]
      real(wp) :: friction = 0.0_wp !! F_t along t on A [N]
      real(wp) :: torque_a = 0.0_wp, torque_b = 0.0_wp !! on the wheels [N m]
      real(wp) :: on_a(2) = 0.0_wp  !! force on A in (t_0, e_0) [N]
      real(wp) :: dissipation = 0.0_wp !! power lost to damping, clipping, friction and changing radii [W]
   end type contact_force

   !> A tooth contact at a state of the gearbox.
   type :: contact_state
      type(contact_mode) :: mode
      real(wp) :: q(n_local)      !! local variables
      type(contact_point) :: point
      type(contact_force) :: force
   end type contact_state

contains

   !> Nominal radius of curvature rho_A0 of the tooth pair in mesh [m]; teeth and turns are whole numbers and stay exact.
   pure real(wp) function nominal_rho(contact, theta, turns, teeth) result(rho_a0)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: theta  !! reference angle [rad]
      integer, intent(in) :: turns   !! whole turns of the reference wheel beside theta
      integer, intent(in) :: teeth   !! tooth pair: pitches since the start

      rho_a0 = nominal_start(contact, turns, teeth) + contact%pair%advance*theta
   end function nominal_rho

   !> The same at theta = 0.
   pure real(wp) function nominal_start(contact, turns, teeth) result(rho_a0)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: turns, teeth

      rho_a0 = contact%rho_start + contact%step*rational_pitches(contact%pitches_per_turn, turns, teeth)
   end function nominal_start

   !> The contact as the mesh's tracking sees it.
   pure subroutine locate_contact(contact, mode, rho_a0, q, point)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      real(wp), intent(in) :: rho_a0, q(n_local)
      type(contact_point), intent(out) :: point
      type(flank_value) :: a, b

      if (contact%tracking == tracking_closed_form) then
         call track_closed_form(contact%pair, rho_a0, q, point)
      else
         call track_points(contact%pair, rho_a0, q, point)
      end if
      if (.not. contact%deviates) return
      call flank_values(contact, mode, point, a, b)
      call deviate(contact%pair, a, b, q, point)
   end subroutine locate_contact

   !> What the flanks of a tooth pair lack in material.
   pure subroutine flank_values(contact, mode, point, a, b)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      type(flank_value), intent(out) :: a, b

      type(flank_branch) :: branch_a, branch_b

      call flank_branches(contact, mode, branch_a, branch_b)
      call deviation_on(branch_a, point%rho_a, a%e, a%de, a%d2e)
      call deviation_on(branch_b, point%rho_b, b%e, b%de, b%d2e)
   end subroutine flank_values

   !> The branches of the deviations on which the flanks of a tooth pair lie.
   pure subroutine flank_branches(contact, mode, a, b)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(flank_branch), intent(out) :: a, b

      associate (side => nint(contact%pair%sigma))
         a = deviation_branch(contact%deviation_a, tooth_of_a(contact, mode%tooth_pair), side, mode%zone_a)
         b = deviation_branch(contact%deviation_b, tooth_of_b(contact, mode%tooth_pair), side, mode%zone_b)
      end associate
   end subroutine flank_branches

   !> The driving wheel's tooth of a pair, counted counterclockwise; any whole turn may be added.
   pure integer function tooth_of_a(contact, pair) result(tooth)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: pair

      tooth = contact%tooth_a + contact%tooth_sign*pair
   end function tooth_of_a

   !> The driven wheel's tooth of a pair, counted counterclockwise.
   pure integer function tooth_of_b(contact, pair) result(tooth)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: pair

      tooth = contact%tooth_b - contact%tooth_sign*pair
   end function tooth_of_b

   !> The parts of its modified flanks on which a contact lies.
   pure subroutine settle_zones(contact, point, mode)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_point), intent(in) :: point
      type(contact_mode), intent(inout) :: mode

      if (.not. contact%deviates) return
      mode%zone_a = deviation_zone(contact%deviation_a, point%rho_a)
      mode%zone_b = deviation_zone(contact%deviation_b, point%rho_b)
   end subroutine settle_zones

   !> What the laws may know.
   pure type(contact_context) function context_of(contact, mode, point) result(ctx)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point

      ctx%h = point%h
      ctx%h_dot = point%h_dot
      ctx%rho_a = point%rho_a
      ctx%rho_b = point%rho_b
      ctx%e_star = contact%e_star
      ctx%width = contact%width
      ctx%v0 = mode%v0
      ctx%side = mode%sides(side_of_rate)
   end function context_of

   !> Forces at a contact point. Nothing acts in the modes without contact.
   subroutine contact_forces(contact, mode, point, force, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      type(contact_force), intent(out) :: force
      type(status_t), intent(inout) :: status !! code_out_of_domain if a limit of the law or of the involutes is passed
      type(elastic_result) :: elastic
      type(viscous_result) :: viscous
      real(wp) :: factor, d_v

      if (.not. touches(mode)) return
      if (.not. on_involutes(point)) then
         call left_involute(contact, point, status)
         return
      end if
      call contact_law(contact, mode, point, elastic, viscous, status)
      factor = 0
      if (mode%flanks == flanks_loaded) call contact%friction%factor(mode%friction, point%v_t, factor, d_v)
      call forces_of_laws(contact, mode, point, elastic, viscous%force, factor, force)
   end subroutine contact_forces

   !> Whether a contact lies on both involutes.
   pure logical function on_involutes(point)
      type(contact_point), intent(in) :: point

      on_involutes = point%exists .and. point%rho_a > 0 .and. point%rho_b > 0
   end function on_involutes

   !> Forces from what the laws say where flanks overlap.
   pure subroutine forces_of_laws(contact, mode, point, elastic, viscous, factor, force)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      type(elastic_result), intent(in) :: elastic
      real(wp), intent(in) :: viscous !! [N]
      real(wp), intent(in) :: factor  !! phi of the friction law
      type(contact_force), intent(out) :: force

      if (mode%flanks == flanks_unloaded) then
         force%elastic = elastic%force
         force%viscous = viscous
         force%dissipation = unloaded_loss(point, elastic)
      else
         call resolve_forces(contact%pair%sigma, point, elastic, viscous, factor, force)
      end if
   end subroutine forces_of_laws

   include "contact/contact_forces.inc"

   !> Elastic and viscous force with derivatives.
   subroutine contact_law(contact, mode, point, elastic, viscous, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      type(elastic_result), intent(out) :: elastic
      type(viscous_result), intent(out) :: viscous
      type(status_t), intent(inout) :: status
      type(contact_context) :: ctx
      character(len=len(status%message)) :: message
      integer :: code

      if (contact%rigid) then
         elastic = elastic_result(force=mode%share*point%multiplier)
         viscous = viscous_result()
         return
      end if
      ctx = context_of(contact, mode, point)
      call contact%elastic%force(ctx, elastic, code)
      if (code /= code_ok) then
         call contact%elastic%limit_message(ctx, message)
         call fail(status, code, message, subject_mesh, contact%mesh, "contact")
      end if
      call viscous_force(contact%damping, ctx, elastic, viscous)
   end subroutine contact_law

   !> The contact has left an involute: say which radius of curvature ran out.
   pure subroutine left_involute(contact, point, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_point), intent(in) :: point
      type(status_t), intent(inout) :: status
      character(len=7) :: which

      which = "driven"
      if (point%rho_a <= 0 .or. .not. point%exists) which = "driving"
      call fail(status, code_out_of_domain, "the contact has left the involute of the "//trim(which)//" wheel below its base" &
                //" circle (radii of curvature rho_A = "//quantity(point%rho_a, "m")//", rho_B = "//quantity(point%rho_b, "m") &
                //"): the tooth pair has turned back too far, or the gap is too wide", subject_mesh, contact%mesh, "tracking")
   end subroutine left_involute

   !> Elastic energy stored in the contact [J]; 0 without penetration.
   pure real(wp) function contact_energy(contact, mode, point, elastic) result(energy)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      real(wp), intent(in), optional :: elastic !! elastic force there, if it is known [N]
      type(contact_context) :: ctx
      type(elastic_result) :: result
      integer :: code

      energy = 0
      if (contact%rigid .or. .not. touches(mode)) return
      ctx = context_of(contact, mode, point)
      if (present(elastic)) then
         result%force = elastic
      else
         call contact%elastic%force(ctx, result, code)
      end if
      energy = contact%elastic%potential(ctx, result%force)
   end function contact_energy

   !> Elastic + viscous force as if nothing were clipped [N].
   subroutine unclipped_force(contact, mode, point, force, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      real(wp), intent(out) :: force
      type(status_t), intent(inout) :: status
      type(elastic_result) :: elastic
      type(viscous_result) :: viscous

      call contact_law(contact, mode, point, elastic, viscous, status)
      force = elastic%force + viscous%force
   end subroutine unclipped_force

   !> Whether the flanks of a tooth pair overlap, so that the laws say what acts.
   pure logical function touches(mode)
      type(contact_mode), intent(in) :: mode

      touches = mode%flanks == flanks_loaded .or. mode%flanks == flanks_unloaded
   end function touches

   !> The friction branch that belongs to a contact.
   pure integer function settle_friction(contact, point) result(branch)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_point), intent(in) :: point

      branch = contact%friction%branch(point%v_t)
   end function settle_friction

end module evl_tooth_contact
