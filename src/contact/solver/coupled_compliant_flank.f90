!> Flank with coupled tooth pairs: teeth deflect under each other's loads, so all forces depend on the positions of all pairs.
!>
!> The forces are those of evl_coupled_pairs times the width, with C of evl_pair_compliance. The energy is the sum of
!> F h/2 - F**2/(4 pi E* b). Each pair k also has a_i and P of evl_compliant_flank, with s_i = sum_l N_l dC_kl/drho_i, half of the
!> own term. A pair that overlaps without force remains in the potential.
!>
!> Whether a pair carries load follows from its overlap g_k = h_k - sum over the others of C_kl N_l. Within a mode the forces are
!> continued as odd functions of g, so that a root can be approached from both sides.
!>
!> Source: docs/theory/compliant_flanks.md, sections 2 and 3.
module evl_coupled_compliant_flank
   use evl_compliant_flank, only: change_of, change_of_line, compliant_flank_t, viscous_change
   use evl_contact_point, only: contact_gradient
   use evl_coupled_lanes, only: overlap_in_lanes, solve_in_lanes
   use evl_coupled_pairs, only: coupled_solution, force_change_of_pairs, most_pairs, overlaps, solve_pairs
   use evl_damping_law, only: viscous_force
   use evl_elastic_law, only: elastic_result
   use evl_flank, only: context_of
   use evl_flank_limits, only: in_lanes_on_involutes
   use evl_flank_pairs, only: add_in_lanes, lane_pairs, list_pairs, pairs_t
   use evl_force_lanes, only: lane_slot
   use evl_kinds, only: lanes, wp
   use evl_local_variables, only: n_local
   use evl_pair_compliance, only: assemble_compliance, assemble_in_lanes, couple, couple_in_lanes, pair_compliance
   use evl_pair_point, only: by_a, by_b
   use evl_status, only: code_ok, code_out_of_domain, fail, quantity, status_t, subject_mesh
   use evl_tooth_contact, only: contact_state, feet_of, flank_drive, flanks_open, tooth_contact_t, touches
   implicit none (type, external)
   private

   public :: coupled_compliant_flank_t

   type, extends(compliant_flank_t) :: coupled_compliant_flank_t
   contains
      procedure :: loaded_pairs_range
      procedure :: laws
      procedure :: find_overlaps
      procedure :: settle_overlap
      procedure :: force_changes
      procedure :: slope_changes
      procedure :: laws_in_lanes
      procedure :: find_overlaps_in_lanes
   end type coupled_compliant_flank_t

contains

   !> All contacts of the flank.
   pure subroutine loaded_pairs_range(self, contact, first, last)
      class(coupled_compliant_flank_t), intent(in) :: self
      integer, intent(in) :: contact
      integer, intent(out) :: first, last

      first = self%first
      last = self%last
   end subroutine loaded_pairs_range

   !> Compliance matrix of the pairs, with derivatives.
   pure subroutine compliance_of(self, contact, pairs, compliance)
      class(coupled_compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contact !! one of the flank
      type(pairs_t), intent(in) :: pairs
      type(pair_compliance), intent(out) :: compliance

      call assemble_compliance(self%a, self%b, self%k_difference, contact%flank == flank_drive, .true., pairs%n, pairs%number, &
                               pairs%feet, compliance)
   end subroutine compliance_of

   !> Elastic and viscous forces of the contacts that touch, and their overlaps.
   subroutine laws(self, contacts, first, last, at, status)
      class(coupled_compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      integer, intent(in) :: first, last
      type(contact_state), intent(inout) :: at(*)
      type(status_t), intent(inout) :: status
      type(pairs_t) :: pairs
      type(pair_compliance) :: compliance
      type(coupled_solution) :: solution
      real(wp) :: g(most_pairs)
      integer :: code, i

      call list_pairs(first, last, at, .false., pairs)
      if (pairs%n == 0) return
      associate (n => pairs%n, contact => contacts(first))
         call compliance_of(self, contact, pairs, compliance)
         call solve_pairs(n, pairs%h, pairs%line, compliance%c, contact%e_star, .false., solution, code)
         if (code /= code_ok) then
            call fail(status, code_out_of_domain, "the forces of the tooth pairs have no solution at a penetration of h = " &
                      //quantity(pairs%h(1), "m")//": the teeth would deflect by more than the length of the line of action," &
                      //" or the compliances of the wheels are inconsistent", subject_mesh, contact%mesh, "contact")
            return
         end if
         call overlaps(n, pairs%h, compliance%c, solution, g)
         do i = 1, n
            call take(contacts(pairs%contact(i)), n, i, solution, compliance, at(pairs%contact(i)))
            at(pairs%contact(i))%overlap = g(i)
         end do
      end associate
   end subroutine laws

   !> Store the results for pair i of n.
   pure subroutine take(contact, n, i, solution, compliance, at)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: n, i
      type(coupled_solution), intent(in) :: solution
      type(pair_compliance), intent(in) :: compliance
      type(contact_state), intent(inout) :: at
      integer :: w

      at%elastic = elastic_result(contact%width*solution%force(i), 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp)
      associate (compliant => at%compliant)
         do w = by_a, by_b
            compliant%by_force(:n, w) = compliance%d(i, :n, w)
            compliant%by_own(:n, w) = compliance%d_own(i, :n, w)
            compliant%by_other(:n, w) = compliance%d_both(i, :n, w)
            compliant%slope(w) = dot_product(compliant%by_force(:n, w), solution%force(:n))
         end do
         compliant%factor(:n) = solution%factor(i, :n)
         compliant%carries = solution%carries(i)
      end associate
      call viscous_force(contact%damping, context_of(contact, at), at%elastic, at%viscous)
   end subroutine take

   !> Overlap of open contacts under the forces of those that touch.
   pure subroutine find_overlaps(self, contacts, first, last, at)
      class(coupled_compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      integer, intent(in) :: first, last
      type(contact_state), intent(inout) :: at(*)
      type(pairs_t) :: pairs
      real(wp) :: opened
      integer :: i, k

      call list_pairs(first, last, at, .false., pairs)
      do k = first, last
         if (at(k)%mode%flanks /= flanks_open) cycle
         opened = 0
         do i = 1, pairs%n
            opened = opened - couple(self%a, self%b, contacts(k)%flank == flank_drive, at(k)%mode%tooth_pair, feet_of(at(k)), &
                                     pairs%number(i), pairs%feet(i)%foot) &
                     *(at(pairs%contact(i))%elastic%force/contacts(k)%width)
         end do
         at(k)%overlap = at(k)%point%h + opened
      end do
   end subroutine find_overlaps

   !> Overlap of a contact if all pairs that can push are loaded.
   pure subroutine settle_overlap(self, contacts, k, first, last, at)
      class(coupled_compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      integer, intent(in) :: k, first, last
      type(contact_state), intent(inout) :: at(*)
      type(pairs_t) :: pairs
      type(pair_compliance) :: compliance
      type(coupled_solution) :: solution
      real(wp) :: g(most_pairs)
      integer :: code

      call list_pairs(first, last, at, .true., pairs)
      call compliance_of(self, contacts(first), pairs, compliance)
      call solve_pairs(pairs%n, pairs%h, pairs%line, compliance%c, contacts(first)%e_star, .true., solution, code)
      if (code /= code_ok) return ! the laws report the error
      call overlaps(pairs%n, pairs%h, compliance%c, solution, g)
      at(k)%overlap = g(findloc(pairs%contact(:pairs%n), k, dim=1))
   end subroutine settle_overlap

   !> Derivatives of both forces of a contact with respect to the local variables.
   pure subroutine force_changes(self, contacts, at, d, k, elastic, viscous)
      class(coupled_compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      type(contact_state), intent(in) :: at(*)
      type(contact_gradient), intent(in) :: d(*)
      integer, intent(in) :: k
      real(wp), intent(out) :: elastic(n_local), viscous(n_local)
      real(wp) :: change(most_pairs, n_local)
      type(pairs_t) :: pairs

      call list_pairs(self%first, self%last, at, .false., pairs)
      call changes_of_all(contacts, at, d, pairs, change)
      elastic = contacts(k)%width*change(findloc(pairs%contact(:pairs%n), k, dim=1), :)
      viscous = viscous_change(at(k), d(k), elastic)
   end subroutine force_changes

   !> Derivatives of the forces per unit width of all pairs that touch with respect to the local variables.
   pure subroutine changes_of_all(contacts, at, d, pairs, change)
      type(tooth_contact_t), intent(in) :: contacts(*)
      type(contact_state), intent(in) :: at(*)
      type(contact_gradient), intent(in) :: d(*)
      type(pairs_t), intent(in) :: pairs
      real(wp), intent(out) :: change(most_pairs, n_local) !! of the first n
      type(coupled_solution) :: solution
      real(wp) :: d_line(most_pairs, n_local), feet(n_local, 2, most_pairs)
      integer :: i, j, q

      associate (n => pairs%n, contact => contacts(pairs%contact(1)))
         solution%n = n
         do i = 1, n
            associate (k => pairs%contact(i))
               solution%force(i) = at(k)%elastic%force/contact%width
               solution%carries(i) = at(k)%compliant%carries
               solution%factor(i, :n) = at(k)%compliant%factor(:n)
               feet(:, by_a, i) = change_of(at(k), d(k), by_a)
               feet(:, by_b, i) = change_of(at(k), d(k), by_b)
            end associate
         end do
         do i = 1, n
            associate (of => d(pairs%contact(i)), slope => at(pairs%contact(i))%compliant%slope)
               change(i, :) = of%h - slope(by_a)*feet(:, by_a, i) - slope(by_b)*feet(:, by_b, i)
               d_line(i, :) = change_of_line(at(pairs%contact(i)), of)
            end associate
            do j = 1, n
               associate (by => at(pairs%contact(j))%compliant%by_force(i, :), force => solution%force(j))
                  change(i, :) = change(i, :) - (force*by(by_a))*feet(:, by_a, j) - (force*by(by_b))*feet(:, by_b, j)
               end associate
            end do
         end do
         do q = 1, n_local
            call force_change_of_pairs(solution, pairs%line, contact%e_star, d_line(:, q), change(:, q))
         end do
      end associate
   end subroutine changes_of_all

   !> Derivatives of the slopes of a pair, which depend on the forces and positions of all pairs.
   pure subroutine slope_changes(self, contacts, at, d, k, elastic, change)
      class(coupled_compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      type(contact_state), intent(in) :: at(*)
      type(contact_gradient), intent(in) :: d(*)
      integer, intent(in) :: k
      real(wp), intent(in) :: elastic(n_local)
      real(wp), intent(out) :: change(n_local, 2)
      real(wp) :: forces(most_pairs, n_local)
      type(pairs_t) :: pairs
      integer :: l, w

      call list_pairs(self%first, self%last, at, .false., pairs)
      call changes_of_all(contacts, at, d, pairs, forces)
      change = 0
      associate (compliant => at(k)%compliant)
         do l = 1, pairs%n
            associate (other => pairs%contact(l), force => at(pairs%contact(l))%elastic%force/contacts(k)%width)
               do w = by_a, by_b
                  change(:, w) = change(:, w) + compliant%by_force(l, w)*forces(l, :) &
                                 + force*(compliant%by_own(l, w)*change_of(at(k), d(k), w) &
                                          + compliant%by_other(l, w)*change_of(at(other), d(other), w))
               end do
            end associate
         end do
      end associate
   end subroutine slope_changes

   !> `laws` for eight states.
   subroutine laws_in_lanes(self, contacts, first, last, slots, is_defined)
      class(coupled_compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      integer, intent(in) :: first, last
      type(lane_slot), intent(inout) :: slots(*)
      logical, intent(out) :: is_defined
      type(lane_pairs) :: pairs
      real(wp) :: c(lanes, most_pairs, most_pairs), d(lanes, most_pairs, most_pairs, 2), force(lanes, most_pairs)
      integer :: i, k

      is_defined = .true.
      do k = first, last
         if (.not. slots(k)%touches) cycle
         is_defined = is_defined .and. in_lanes_on_involutes(slots(k))
         call add_in_lanes(pairs, k, slots(k))
      end do
      if (.not. is_defined .or. pairs%n == 0) return
      associate (n => pairs%n, contact => contacts(first))
         call assemble_in_lanes(self%a, self%b, self%k_difference, contact%flank == flank_drive, n, pairs%number, pairs%foot, c, d)
         call solve_in_lanes(n, pairs%h, pairs%line, c, contact%e_star, force, is_defined)
         if (.not. is_defined) return
         do i = 1, n
            associate (slot => slots(pairs%contact(i)))
               slot%force%elastic = contact%width*force(:, i)
               call sum_of_products(n, d(:, i, :, by_a), force, slot%force%slope_a)
               call sum_of_products(n, d(:, i, :, by_b), force, slot%force%slope_b)
               call overlap_in_lanes(n, i, pairs%h(:, i), c, force, slot%at%overlap)
               slot%force%d_energy = 0
               slot%force%excess = 0
               call contacts(pairs%contact(i))%damping%force_lanes(slot%at%lane_context, slot%force%elastic, slot%force%viscous)
               slot%force%unclipped = slot%force%elastic + slot%force%viscous
            end associate
         end do
      end associate
   end subroutine laws_in_lanes

   !> Sum over the pairs.
   pure subroutine sum_of_products(n, d, force, slope)
      integer, intent(in) :: n
      real(wp), intent(in), dimension(lanes, most_pairs) :: d, force
      real(wp), intent(out) :: slope(lanes)
      integer :: i, l

      slope = 0
      do i = 1, n
         !$omp simd
         do l = 1, lanes
            slope(l) = slope(l) + d(l, i)*force(l, i)
         end do
      end do
   end subroutine sum_of_products

   !> `find_overlaps` for eight states.
   subroutine find_overlaps_in_lanes(self, contacts, slots, aside, nearby)
      class(coupled_compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      type(lane_slot), intent(in) :: slots(*)
      type(lane_slot), intent(inout) :: aside(*)
      logical, intent(in) :: nearby
      type(lane_pairs) :: pairs
      real(wp), dimension(lanes, most_pairs) :: force
      real(wp) :: c(lanes), opened(lanes)
      type(lane_pairs) :: open
      integer :: i, k

      if (all(aside(self%first:self%last)%mode%flanks /= flanks_open)) return
      do k = self%first, self%last
         if (.not. aside(k)%touches) cycle
         if (nearby) then
            call add_in_lanes(pairs, k, slots(k))
            force(:, pairs%n) = slots(k)%force%elastic/contacts(k)%width
         else
            call add_in_lanes(pairs, k, aside(k))
            force(:, pairs%n) = aside(k)%force%elastic/contacts(k)%width
         end if
      end do
      if (pairs%n == 0) return
      do k = self%first, self%last
         if (aside(k)%mode%flanks /= flanks_open) cycle
         open%n = 0
         call add_in_lanes(open, k, aside(k))
         opened = 0
         do i = 1, pairs%n
            call couple_in_lanes(self%a, self%b, contacts(k)%flank == flank_drive, open%number(1), open%foot(:, :, 1), &
                                 pairs%number(i), pairs%foot(:, :, i), c)
            opened = opened - c*force(:, i)
         end do
         aside(k)%at%overlap = aside(k)%at%h + opened
      end do
   end subroutine find_overlaps_in_lanes

end module evl_coupled_compliant_flank
