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
   use evl_contact_laws, only: contact_context, elastic_force, elastic_limit_message, elastic_potential, elastic_result, &
                               friction_factor, friction_mode, law_choice, viscous_force, viscous_result
   use evl_contact_point, only: contact_point, tracked_pair
   use evl_contact_tracking, only: track_points
   use evl_deviating_flanks, only: deviate, flank_value
   use evl_flank_deviation, only: deviation_branch, deviation_on, deviation_zone, flank_branch, flank_deviation_t
   use evl_kinds, only: wp
   use evl_local_variables, only: mesh_link, n_local, wheel_link
   use evl_rational, only: rational_pitches, rational_t
   use evl_status, only: code_ok, code_out_of_domain, fail, quantity, status_t, subject_mesh
   use evl_tangent_line, only: deviation
   implicit none (type, external)
   private

   public :: contact_t, contact_state, mesh_mode, mesh_force
   public :: contact_law, context_of, flank_branches, flank_values, forces_of_laws, left_involute, mesh_contact
   public :: mesh_forces, mesh_energy, on_involutes
   public :: mesh_nominal_rho, mesh_nominal_start, mesh_unclipped_force, mesh_settle_friction, touches
   public :: tracking_closed_form, tracking_algebraic, tracking_differential
   public :: contact_open, contact_loaded, contact_unloaded, contact_apart, contact_off
   public :: n_mesh_roots, n_border_roots
   public :: flank_drive, flank_coast
   public :: mesh_settle_zones, mesh_tooth_a, mesh_tooth_b

   integer, parameter :: tracking_closed_form = 0  !! contact from the wheels' positions
   integer, parameter :: tracking_algebraic = 1    !! contact from (1)
   integer, parameter :: tracking_differential = 2 !! contact from (2)-(3)

   integer, parameter :: contact_open = 0     !! a gap
   integer, parameter :: contact_loaded = 1   !! penetration and force
   integer, parameter :: contact_unloaded = 2 !! penetration, but the damper would pull: no force
   integer, parameter :: contact_apart = 3    !! tracked flanks so far apart that no two points face each other
   integer, parameter :: contact_off = 4      !! no tooth pair of this slot is on the path of contact

   integer, parameter :: flank_drive = 0 !! the driving wheel pushes in its nominal sense of rotation
   integer, parameter :: flank_coast = 1 !! the other side of the teeth

   integer, parameter :: n_mesh_roots = 8       !! root functions of a tooth contact
   integer, parameter :: n_border_roots = 4     !! more of them where a flank deviates: borders of tip and root relief of A, of B

   type :: contact_t
      integer :: mesh = 0                 !! of the gearbox, to which the contact belongs
      integer :: flank = flank_drive      !! drive or coast
      integer :: slot = 0, n_slots = 1    !! which of the flank's slots, from 0, and how many
      logical :: handover = .true.        !! one slot, and pairs change one pitch on; else at the ends of the path
      integer :: wheel_a = 0, wheel_b = 0 !! driving and driven wheel
      type(tracked_pair) :: pair          !! geometry for the tracking
      type(law_choice) :: contact, damping, friction
      logical :: rigid = .false.          !! contact is a constraint
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
      type(mesh_link), allocatable :: links(:) !! local variables in terms of the state
      type(wheel_link) :: link_a, link_b  !! the same, wheel by wheel
      logical :: axles_rest = .false.     !! both axles are fixed, and the line of action with them
      type(deviation) :: rest_line        !! where it is then
      logical :: leads = .false.          !! the first slot of a rigid flank: the flank's constraint is its
      integer :: i_normal = 0             !! multiplier of a rigid flank in the state; 0 if none
      integer :: i_dependent = 0          !! deviation of the wheel that a closed rigid contact determines
      real(wp) :: mobility = 0.0_wp       !! r_bA^2/J_A + r_bB^2/J_B [1/kg]
      integer :: i_track = 0              !! first tracked variable in the state; 0 if none
      integer :: i_side = 0               !! place of the side of h' = 0 in the discrete state; 0 where the damping law has none
      integer :: i_mode = 0               !! place of its integers in the discrete state: three, and two zones if it deviates
      integer :: i_root = 0               !! place before its root functions
      integer :: n_roots = n_mesh_roots   !! how many there are
   end type contact_t

   !> Discrete state of a mesh.
   type :: mesh_mode
      integer :: teeth = 0              !! pitches since the start
      integer :: contact = contact_open !! one of the contact modes
      integer :: friction = 0           !! branch of the friction law
      integer :: zone_a = 0, zone_b = 0 !! parts of the modified flanks
      integer :: side = 0               !! of h' = 0, where the damping law has two: +1 approach, -1 separation
      real(wp) :: share = 1.0_wp        !! of a rigid flank's normal force that this pair carries
      real(wp) :: v0 = 0.0_wp           !! approach speed at the last closing [m/s]
   end type mesh_mode

   !> Forces of a mesh.
   type :: mesh_force
      real(wp) :: normal = 0.0_wp   !! F_n >= 0 [N]
      real(wp) :: elastic = 0.0_wp  !! its elastic part before clipping [N]
      real(wp) :: viscous = 0.0_wp  !! its viscous part before clipping [N]
      real(wp) :: friction = 0.0_wp !! F_t along t on A [N]
      real(wp) :: torque_a = 0.0_wp, torque_b = 0.0_wp !! on the wheels [N m]
      real(wp) :: on_a(2) = 0.0_wp  !! force on A in (t_0, e_0) [N]
      real(wp) :: dissipation = 0.0_wp !! power lost to damping, clipping, friction and changing radii [W]
   end type mesh_force

   !> A tooth contact at a state of the gearbox.
   type :: contact_state
      type(mesh_mode) :: mode
      real(wp) :: q(n_local)      !! local variables
      type(contact_point) :: point
      type(mesh_force) :: force
   end type contact_state

contains

   !> Nominal radius of curvature rho_A0 of the tooth pair in mesh [m]; teeth and turns are whole numbers and stay exact.
   pure real(wp) function mesh_nominal_rho(mesh, theta, turns, teeth) result(rho_a0)
      type(contact_t), intent(in) :: mesh
      real(wp), intent(in) :: theta  !! reference angle [rad]
      integer, intent(in) :: turns   !! whole turns of the reference wheel beside theta
      integer, intent(in) :: teeth   !! tooth pair: pitches since the start

      rho_a0 = mesh_nominal_start(mesh, turns, teeth) + mesh%pair%advance*theta
   end function mesh_nominal_rho

   !> The same at theta = 0.
   pure real(wp) function mesh_nominal_start(mesh, turns, teeth) result(rho_a0)
      type(contact_t), intent(in) :: mesh
      integer, intent(in) :: turns, teeth

      rho_a0 = mesh%rho_start + mesh%step*rational_pitches(mesh%pitches_per_turn, turns, teeth)
   end function mesh_nominal_start

   !> The contact as the mesh's tracking sees it.
   pure subroutine mesh_contact(mesh, mode, rho_a0, q, point)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      real(wp), intent(in) :: rho_a0, q(n_local)
      type(contact_point), intent(out) :: point
      type(flank_value) :: a, b

      if (mesh%tracking == tracking_closed_form) then
         call track_closed_form(mesh%pair, rho_a0, q, point)
      else
         call track_points(mesh%pair, rho_a0, q, point)
      end if
      if (.not. mesh%deviates) return
      call flank_values(mesh, mode, point, a, b)
      call deviate(mesh%pair, a, b, q, point)
   end subroutine mesh_contact

   !> What the flanks of a tooth pair lack in material.
   pure subroutine flank_values(mesh, mode, point, a, b)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      type(flank_value), intent(out) :: a, b

      type(flank_branch) :: branch_a, branch_b

      call flank_branches(mesh, mode, branch_a, branch_b)
      call deviation_on(branch_a, point%rho_a, a%e, a%de, a%d2e)
      call deviation_on(branch_b, point%rho_b, b%e, b%de, b%d2e)
   end subroutine flank_values

   !> The branches of the deviations on which the flanks of a tooth pair lie.
   pure subroutine flank_branches(mesh, mode, a, b)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(flank_branch), intent(out) :: a, b

      associate (side => nint(mesh%pair%sigma))
         a = deviation_branch(mesh%deviation_a, mesh_tooth_a(mesh, mode%teeth), side, mode%zone_a)
         b = deviation_branch(mesh%deviation_b, mesh_tooth_b(mesh, mode%teeth), side, mode%zone_b)
      end associate
   end subroutine flank_branches

   !> The driving wheel's tooth of a pair, counted counterclockwise; any whole turn may be added.
   pure integer function mesh_tooth_a(mesh, pair) result(tooth)
      type(contact_t), intent(in) :: mesh
      integer, intent(in) :: pair

      tooth = mesh%tooth_a + mesh%tooth_sign*pair
   end function mesh_tooth_a

   !> The driven wheel's tooth of a pair, counted counterclockwise.
   pure integer function mesh_tooth_b(mesh, pair) result(tooth)
      type(contact_t), intent(in) :: mesh
      integer, intent(in) :: pair

      tooth = mesh%tooth_b - mesh%tooth_sign*pair
   end function mesh_tooth_b

   !> The parts of its modified flanks on which a contact lies.
   pure subroutine mesh_settle_zones(mesh, point, mode)
      type(contact_t), intent(in) :: mesh
      type(contact_point), intent(in) :: point
      type(mesh_mode), intent(inout) :: mode

      if (.not. mesh%deviates) return
      mode%zone_a = deviation_zone(mesh%deviation_a, point%rho_a)
      mode%zone_b = deviation_zone(mesh%deviation_b, point%rho_b)
   end subroutine mesh_settle_zones

   !> What the laws may know.
   pure type(contact_context) function context_of(mesh, mode, point) result(ctx)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point

      ctx%h = point%h
      ctx%h_dot = point%h_dot
      ctx%rho_sum = point%rho_a + point%rho_b
      ctx%rho_a = point%rho_a
      ctx%rho_b = point%rho_b
      ctx%e_star = mesh%e_star
      ctx%width = mesh%width
      ctx%v0 = mode%v0
      ctx%side = mode%side
   end function context_of

   !> Forces at a contact point. Nothing acts in the modes without contact.
   subroutine mesh_forces(mesh, mode, point, force, status)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      type(mesh_force), intent(out) :: force
      type(status_t), intent(inout) :: status !! code_out_of_domain if a limit of the law or of the involutes is passed
      type(elastic_result) :: elastic
      type(viscous_result) :: viscous
      real(wp) :: factor, d_v

      if (.not. touches(mode)) return
      if (.not. on_involutes(point)) then
         call left_involute(mesh, point, status)
         return
      end if
      call contact_law(mesh, mode, point, elastic, viscous, status)
      factor = 0
      if (mode%contact == contact_loaded) call friction_factor(mesh%friction, mode%friction, point%v_t, factor, d_v)
      call forces_of_laws(mesh, mode, point, elastic, viscous%force, factor, force)
   end subroutine mesh_forces

   !> Whether a contact lies on both involutes.
   pure logical function on_involutes(point)
      type(contact_point), intent(in) :: point

      on_involutes = point%exists .and. point%rho_a > 0 .and. point%rho_b > 0
   end function on_involutes

   !> Forces from what the laws say where flanks overlap.
   pure subroutine forces_of_laws(mesh, mode, point, elastic, viscous, factor, force)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      type(elastic_result), intent(in) :: elastic
      real(wp), intent(in) :: viscous !! [N]
      real(wp), intent(in) :: factor  !! phi of the friction law
      type(mesh_force), intent(out) :: force

      if (mode%contact == contact_unloaded) then
         force%elastic = elastic%force
         force%viscous = viscous
         force%dissipation = unloaded_loss(point, elastic)
      else
         call resolve_forces(mesh%pair%sigma, point, elastic, viscous, factor, force)
      end if
   end subroutine forces_of_laws

   include "contact/contact_forces.inc"

   !> Elastic and viscous force with derivatives.
   subroutine contact_law(mesh, mode, point, elastic, viscous, status)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      type(elastic_result), intent(out) :: elastic
      type(viscous_result), intent(out) :: viscous
      type(status_t), intent(inout) :: status
      type(contact_context) :: ctx
      character(len=len(status%message)) :: message
      integer :: code

      if (mesh%rigid) then
         elastic = elastic_result(force=mode%share*point%multiplier)
         viscous = viscous_result()
         return
      end if
      ctx = context_of(mesh, mode, point)
      call elastic_force(mesh%contact, ctx, elastic, code)
      if (code /= code_ok) then
         call elastic_limit_message(mesh%contact, ctx, message)
         call fail(status, code, message, subject_mesh, mesh%mesh, "contact")
      end if
      call viscous_force(mesh%damping, ctx, elastic, viscous)
   end subroutine contact_law

   !> The contact has left an involute: say which radius of curvature ran out.
   pure subroutine left_involute(mesh, point, status)
      type(contact_t), intent(in) :: mesh
      type(contact_point), intent(in) :: point
      type(status_t), intent(inout) :: status
      character(len=7) :: which

      which = "driven"
      if (point%rho_a <= 0 .or. .not. point%exists) which = "driving"
      call fail(status, code_out_of_domain, "the contact has left the involute of the "//trim(which)//" wheel below its base" &
                //" circle (radii of curvature rho_A = "//quantity(point%rho_a, "m")//", rho_B = "//quantity(point%rho_b, "m") &
                //"): the tooth pair has turned back too far, or the gap is too wide", subject_mesh, mesh%mesh, "tracking")
   end subroutine left_involute

   !> Elastic energy stored in the contact [J]; 0 without penetration.
   pure real(wp) function mesh_energy(mesh, mode, point, elastic) result(energy)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      real(wp), intent(in), optional :: elastic !! elastic force there, if it is known [N]

      energy = 0
      if (mesh%rigid) return
      if (touches(mode)) call elastic_potential(mesh%contact, context_of(mesh, mode, point), energy, elastic=elastic)
   end function mesh_energy

   !> Elastic + viscous force as if nothing were clipped [N].
   subroutine mesh_unclipped_force(mesh, mode, point, force, status)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      real(wp), intent(out) :: force
      type(status_t), intent(inout) :: status
      type(elastic_result) :: elastic
      type(viscous_result) :: viscous

      call contact_law(mesh, mode, point, elastic, viscous, status)
      force = elastic%force + viscous%force
   end subroutine mesh_unclipped_force

   !> Whether the flanks of a tooth pair overlap, so that the laws say what acts.
   pure logical function touches(mode)
      type(mesh_mode), intent(in) :: mode

      touches = mode%contact == contact_loaded .or. mode%contact == contact_unloaded
   end function touches

   !> The friction branch that belongs to a contact.
   pure integer function mesh_settle_friction(mesh, point) result(branch)
      type(contact_t), intent(in) :: mesh
      type(contact_point), intent(in) :: point

      branch = friction_mode(mesh%friction, point%v_t)
   end function mesh_settle_friction

end module evl_tooth_contact
