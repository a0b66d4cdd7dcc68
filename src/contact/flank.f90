!> A flank: all tooth contacts on one side of the teeth of a mesh, drive or coast. It computes the forces of all its contacts
!> together, and the ends of the path of contact.
!>
!> In this base type the pairs are independent: the laws give the force of a pair from its own position. If the teeth of a wheel
!> deflect together, the forces of all pairs depend on the positions of all. Such a flank extends `flank_t` and overrides its
!> procedures. It is selected in `description/contact_build.f90`; no other code distinguishes flank types.
!>
!> The contacts of a flank share their local variables, since they lie between the same two wheels.
module evl_flank
   use evl_contact_context, only: contact_context
   use evl_contact_friction, only: friction_factor
   use evl_contact_point, only: contact_gradient, contact_point, is_internal, rho_of_ring
   use evl_damping_law, only: no_viscous, viscous_force
   use evl_edge_contact, only: lift_of
   use evl_elastic_law, only: elastic_law_t, elastic_result, no_elastic
   use evl_flank_limits, only: check_edge, in_lanes_on_flank, left_involute
   use evl_force_lanes, only: lane_slot, laws_of_pair, lift_in_lanes, resolve_in_lanes, ring_context
   use evl_kinds, only: lanes, wp
   use evl_local_variables, only: at_normal, n_local, unit
   use evl_pair_sequence, only: exactly_one
   use evl_root_kinds, only: side_of_rate
   use evl_status, only: code_ok, fail, has_failed, status_t, subject_mesh
   use evl_tooth_contact, only: beyond_flank, contact_force, contact_state, flanks_unloaded, no_force, &
                                on_involutes, tooth_contact_t, touches
   implicit none (type, external)
   private

   public :: context_of, energy_gap, flank_slot, flank_t, nominal_context

   !> Its procedures take some or all of its contacts; `loaded_pairs_range` returns the range that must be evaluated together.
   type :: flank_t
      integer :: first = 1, last = 0 !! its tooth contacts among those of the gearbox
      logical :: bends = .false.     !! the deflection of a pair under a load depends on its position
      logical :: couples = .false.   !! pairs deflect under each other's loads
      real(wp) :: reach = 0.0_wp     !! distance past the ends of the path of contact up to which pairs stay, in pitches
   contains
      procedure :: slots_for
      procedure :: loaded_pairs_range
      procedure :: laws
      procedure :: find_overlaps
      procedure :: settle_overlap
      procedure :: pair_alone
      procedure :: pair_under
      procedure :: add_energy
      procedure :: add_energy_in_lanes
      procedure :: force_changes
      procedure :: loss_change
      procedure :: add_compliant_forces
      procedure :: add_compliant_changes
      procedure :: laws_in_lanes
      procedure :: find_overlaps_in_lanes
      procedure :: add_compliant_in_lanes
      procedure, non_overridable :: forces
      procedure, non_overridable :: forces_in_lanes
   end type flank_t

   !> A flank of any kind.
   type :: flank_slot
      class(flank_t), allocatable :: flank
   end type flank_slot

contains

   !> Number of slots of a flank: the largest number of tooth pairs on its path of contact, plus one for the waiting pair.
   pure integer function slots_for(self, contact_ratio, hands_over) result(n)
      class(flank_t), intent(in) :: self
      real(wp), intent(in) :: contact_ratio !! path of contact over base pitch
      logical, intent(in) :: hands_over     !! a pair hands its load over to the next after one pitch
      real(wp) :: pitches

      n = 1
      pitches = contact_ratio + 2*self%reach
      if (.not. (hands_over .or. abs(pitches - 1) < exactly_one)) n = ceiling(pitches - exactly_one) + 1
   end function slots_for

   !> Range of contacts whose positions determine the force of one contact; here that contact alone.
   pure subroutine loaded_pairs_range(self, contact, first, last)
      class(flank_t), intent(in) :: self
      integer, intent(in) :: contact      !! index in the gearbox
      integer, intent(out) :: first, last

      first = contact
      last = contact
   end subroutine loaded_pairs_range

   !> Unclipped elastic and viscous forces of the contacts that touch, with derivatives; also their overlaps, if these depend on
   !> other contacts.
   subroutine laws(self, contacts, first, last, at, status)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*) !! of the gearbox
      integer, intent(in) :: first, last               !! range of contacts to evaluate
      type(contact_state), intent(inout) :: at(*) !! with their points
      type(status_t), intent(inout) :: status     !! code_out_of_domain if a law is not defined
      type(contact_context) :: ctx
      character(len=len(status%message)) :: message
      integer :: code, k

      do k = first, last
         if (.not. touches(at(k)%mode)) cycle
         associate (contact => contacts(k), elastic => at(k)%elastic, viscous => at(k)%viscous)
            if (contact%rigid) then
               elastic = no_elastic
               elastic%force = at(k)%mode%share*at(k)%point%multiplier
               viscous = no_viscous
               cycle
            end if
            ctx = context_of(contact, at(k))
            call contact%elastic%force(ctx, elastic, code)
            if (is_internal(contact%pair)) call elastic_of_ring(elastic)
            if (code /= code_ok) then
               message = ""
               if (status%in_words) call contact%elastic%limit_message(ctx, message)
               call fail(status, code, message, subject_mesh, contact%mesh, "contact")
            end if
            call viscous_force(contact%damping, ctx, elastic, viscous)
         end associate
      end do
   end subroutine laws

   !> Overlaps of open contacts; here they do not depend on the contacts that touch.
   pure subroutine find_overlaps(self, contacts, first, last, at)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      integer, intent(in) :: first, last          !! range of contacts to evaluate, from `loaded_pairs_range`
      type(contact_state), intent(inout) :: at(*) !! with their points, and the forces of those that touch

   end subroutine find_overlaps

   !> Overlap of a contact with unknown mode, assuming that all pairs of its range on the path that can push are loaded.
   pure subroutine settle_overlap(self, contacts, k, first, last, at)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      integer, intent(in) :: k, first, last
      type(contact_state), intent(inout) :: at(*) !! with their points; for the others only whether they are off is used

   end subroutine settle_overlap

   !> Quantities of a pair that are available to the laws. An internal pair acts like the external one with the same length of the
   !> line of action: see `rho_of_ring`.
   pure type(contact_context) function context_of(contact, at) result(ctx)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at

      ctx = contact_context(h=at%point%h, h_dot=at%point%h_dot, rho_a=at%point%rho_a, rho_b=at%point%rho_b, e_star=contact%e_star, &
                            width=contact%width, v0=at%mode%v0, side=at%mode%sides(side_of_rate))
      if (.not. is_internal(contact%pair)) return
      ctx%rho_a = rho_of_ring(ctx%rho_a, ctx%h)
      ctx%rho_b = rho_of_ring(ctx%rho_b, ctx%h)
   end function context_of

   !> Derivatives of an elastic force with respect to the radii of an internal pair, from those with respect to `rho_of_ring`.
   pure subroutine elastic_of_ring(elastic)
      type(elastic_result), intent(inout) :: elastic

      elastic%d_h = elastic%d_h + elastic%d_rho_a + elastic%d_rho_b
      elastic%d_rho_a = -elastic%d_rho_a
      elastic%d_rho_b = -elastic%d_rho_b
      elastic%d_energy = -elastic%d_energy
   end subroutine elastic_of_ring

   !> Context of a perfect tooth pair at the pitch point. Each radius of curvature there is taken as half of their sum.
   pure type(contact_context) function nominal_context(contact) result(ctx)
      type(tooth_contact_t), intent(in) :: contact

      ctx%rho_a = abs(contact%pair%rho_0)/2
      ctx%rho_b = abs(contact%pair%rho_0)/2
      ctx%e_star = contact%e_star
      ctx%width = contact%width
   end function nominal_context

   !> Elastic force of a single perfect tooth pair at the pitch point. For a rigid contact the compliant form of its law is used.
   subroutine pair_alone(self, contact, h, elastic, code)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: h !! [m]
      type(elastic_result), intent(out) :: elastic
      integer, intent(out) :: code !! code_ok or code_out_of_domain
      class(elastic_law_t), allocatable :: law
      type(contact_context) :: ctx

      ctx = nominal_context(contact)
      ctx%h = h
      call contact%elastic%compliant(law)
      call law%force(ctx, elastic, code)
   end subroutine pair_alone

   !> Penetration of a single perfect tooth pair under a force.
   subroutine pair_under(self, contact, force, h, code)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: force !! [N]
      real(wp), intent(out) :: h    !! [m]; 0 on error
      integer, intent(out) :: code
      class(elastic_law_t), allocatable :: law

      call contact%elastic%compliant(law)
      call law%penetration(nominal_context(contact), force, h, code)
   end subroutine pair_under

   !> Add the elastic energy of the contacts that touch [J].
   pure subroutine add_energy(self, contacts, first, last, at, energy)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*) !! of the gearbox
      integer, intent(in) :: first, last               !! range of contacts to evaluate
      type(contact_state), intent(in) :: at(*) !! with their elastic forces
      real(wp), intent(inout) :: energy
      integer :: k

      do k = first, last
         if (contacts(k)%rigid .or. .not. touches(at(k)%mode)) cycle
         energy = energy + contacts(k)%elastic%potential(context_of(contacts(k), at(k)), at(k)%elastic%force)
      end do
   end subroutine add_energy

   !> `add_energy` for eight states.
   subroutine add_energy_in_lanes(self, contacts, first, last, slots, energy)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      integer, intent(in) :: first, last
      type(lane_slot), intent(in) :: slots(*) !! touching ones with their forces
      real(wp), intent(inout) :: energy(lanes)
      real(wp) :: mine(lanes)
      integer :: k

      do k = first, last
         if (.not. slots(k)%touches) cycle
         if (is_internal(contacts(k)%pair)) then
            call contacts(k)%elastic%potential_lanes(ring_context(slots(k)%at), slots(k)%force%elastic, mine)
         else
            call contacts(k)%elastic%potential_lanes(slots(k)%at%lane_context, slots(k)%force%elastic, mine)
         end if
         energy = energy + mine
      end do
   end subroutine add_energy_in_lanes

   !> Derivatives of the elastic and the viscous force of a contact with respect to the local variables.
   pure subroutine force_changes(self, contacts, at, d, k, elastic, viscous)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      type(contact_state), intent(in) :: at(*)
      type(contact_gradient), intent(in) :: d(*) !! of the points of the contacts that touch
      integer, intent(in) :: k                   !! index of the contact; it must touch
      real(wp), intent(out) :: elastic(n_local), viscous(n_local)
      integer :: j

      associate (e => at(k)%elastic, v => at(k)%viscous, h => d(k)%h, rho_a => d(k)%rho_a, rho_b => d(k)%rho_b)
         do j = 1, n_local
            elastic(j) = force_change(e%d_h, e%d_rho_a, e%d_rho_b, h(j), rho_a(j), rho_b(j))
            viscous(j) = force_change(v%d_h, v%d_rho_a, v%d_rho_b, h(j), rho_a(j), rho_b(j)) + v%d_h_dot*d(k)%h_dot(j)
         end do
         if (contacts(k)%rigid) elastic = unit(at_normal, at(k)%mode%share)
      end associate
   end subroutine force_changes

   !> Change of a force with the penetration and both radii of curvature. All present laws depend on the sum of the radii only. The
   !> form lets opposite changes of the two radii due to axle motion cancel before the multiplication.
   elemental real(wp) function force_change(d_h, d_rho_a, d_rho_b, h, rho_a, rho_b) result(change)
      real(wp), intent(in) :: d_h, d_rho_a, d_rho_b !! derivatives of the force [N/m]
      real(wp), intent(in) :: h, rho_a, rho_b       !! derivatives of these

      change = d_h*h + d_rho_a*(rho_a + rho_b) + (d_rho_b - d_rho_a)*rho_b
   end function force_change

   !> Derivatives of V' - F h', the rate of the elastic energy less the power of the force.
   pure function loss_change(self, point, elastic, d) result(change)
      class(flank_t), intent(in) :: self
      type(contact_point), intent(in) :: point
      type(elastic_result), intent(in) :: elastic
      type(contact_gradient), intent(in) :: d
      real(wp) :: change(n_local), by_r, d_energy, d_r
      integer :: j

      ! dV/dr depends on h as the force depends on r, and is homogeneous in both; `excess` is taken as constant
      d_r = (elastic%d_rho_a + elastic%d_rho_b)/2
      by_r = (elastic%d_energy - point%h*d_r)/(point%rho_a + point%rho_b - point%h)
      do j = 1, n_local
         d_energy = d_r*d%h(j) + by_r*(d%rho_a(j) + d%rho_b(j) - d%h(j))
         change(j) = point%rho_dot*d_energy + elastic%d_energy*d%rho_dot(j) + elastic%excess*d%h_dot(j)
      end do
   end function loss_change

   !> Add the forces on the wheels from flank compliance; none for this flank.
   pure subroutine add_compliant_forces(self, contact, at)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(inout) :: at !! of a touching pair, with its forces

   end subroutine add_compliant_forces

   !> Add their derivatives with respect to the local variables; none for this flank.
   pure subroutine add_compliant_changes(self, contacts, at, d, k, elastic, torque_a, torque_b, on_a)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      type(contact_state), intent(in) :: at(*)
      type(contact_gradient), intent(in) :: d(*) !! as in `force_changes`
      integer, intent(in) :: k
      real(wp), intent(in) :: elastic(n_local)   !! of the elastic force
      real(wp), intent(inout) :: torque_a(n_local), torque_b(n_local), on_a(n_local, 2)

   end subroutine add_compliant_changes

   !> `add_compliant_forces` for eight states.
   pure subroutine add_compliant_in_lanes(self, contact, slot)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(inout) :: slot !! of a touching pair, with its forces

   end subroutine add_compliant_in_lanes

   !> All forces of the contacts that touch.
   subroutine forces(self, contacts, first, last, at, status)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*) !! of the gearbox
      integer, intent(in) :: first, last               !! range of contacts to evaluate
      type(contact_state), intent(inout) :: at(*) !! with their points
      type(status_t), intent(inout) :: status     !! code_out_of_domain if a limit of a law or of the involutes is passed
      integer :: k

      do k = first, last
         if (.not. touches(at(k)%mode)) cycle
         if (beyond_flank(at(k)%mode)) call check_edge(contacts(k), at(k), status)
         if (.not. (has_failed(status) .or. on_involutes(contacts(k), at(k)))) call left_involute(contacts(k), at(k)%point, status)
         if (has_failed(status)) return
      end do
      call self%laws(contacts, first, last, at, status)
      if (has_failed(status)) return
      do k = first, last
         if (.not. touches(at(k)%mode)) cycle
         associate (contact => contacts(k), mode => at(k)%mode, point => at(k)%point, elastic => at(k)%elastic)
            if (mode%flanks == flanks_unloaded) then
               at(k)%factor = 0
               at(k)%d_factor = 0
               at(k)%force = no_force
               at(k)%force%dissipation = unloaded_loss(point, elastic)
            else
               call friction_factor(contact, mode, point, elastic%force + at(k)%viscous%force, at(k)%factor, at(k)%d_factor)
               call resolve_forces(contact%pair%sigma, point, elastic, at(k)%viscous%force, at(k)%factor, at(k)%force)
               if (beyond_flank(mode)) at(k)%force%on_a = at(k)%force%on_a &
                                                          + at(k)%force%normal*lift_of(at(k)%edge)*[point%s, -point%c]
            end if
         end associate
         call self%add_compliant_forces(contacts(k), at(k))
      end do
   end subroutine forces

   include "contact/contact_forces.inc"
   !> `laws` for eight states.
   subroutine laws_in_lanes(self, contacts, first, last, slots, is_defined)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*) !! of the gearbox
      integer, intent(in) :: first, last               !! range of contacts to evaluate
      type(lane_slot), intent(inout) :: slots(*) !! touching ones with their contact points
      logical, intent(out) :: is_defined           !! false if the laws or the involutes are not defined in one of the lanes
      integer :: k

      is_defined = .true.
      do k = first, last
         if (.not. slots(k)%touches) cycle
         call laws_of_pair(contacts(k), slots(k)%at, slots(k)%force, is_defined)
         if (.not. is_defined) return
      end do
   end subroutine laws_in_lanes

   !> `find_overlaps` for eight states.
   subroutine find_overlaps_in_lanes(self, contacts, slots, aside, nearby)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      type(lane_slot), intent(in) :: slots(*)    !! if nearby: touching contacts with their forces
      type(lane_slot), intent(inout) :: aside(*) !! the other contacts with their points; if not nearby: all contacts
      logical, intent(in) :: nearby

   end subroutine find_overlaps_in_lanes

   !> `forces` for eight states.
   subroutine forces_in_lanes(self, contacts, first, last, slots, is_defined)
      class(flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*) !! of the gearbox
      integer, intent(in) :: first, last               !! range of contacts to evaluate
      type(lane_slot), intent(inout) :: slots(*) !! touching ones with their contact points
      logical, intent(out) :: is_defined
      integer :: k

      do k = first, last
         if (.not. slots(k)%touches) cycle
         is_defined = in_lanes_on_flank(contacts(k), slots(k))
         if (.not. is_defined) return
      end do
      call self%laws_in_lanes(contacts, first, last, slots, is_defined)
      if (.not. is_defined) return
      do k = first, last
         if (.not. slots(k)%touches) cycle
         call resolve_in_lanes(contacts(k), slots(k)%mode, slots(k)%at, slots(k)%force)
         if (beyond_flank(slots(k)%mode) .and. slots(k)%mode%flanks /= flanks_unloaded) call lift_in_lanes(slots(k)%at, &
                                                                                                           slots(k)%force)
         call self%add_compliant_in_lanes(contacts(k), slots(k))
      end do
   end subroutine forces_in_lanes

end module evl_flank
