!> Flank with compliant teeth and wheel bodies and independent pairs: Johnson's contact in series with c_A(rho_A) + c_B(rho_B).
!>
!> The elastic energy V also depends on the position of a pair, and on the length rho of the line of action. With F over the width b
!> and the compliance C
!>
!>    dV = F dh - a_A drho_A - a_B drho_B - P drho,   a_i = F s_i,   s_i = F/(2 b) dC/drho_i,   P = F**2/(2 pi E* b rho)
!>
!> so that in addition to F the forces a_i act like the slope of a deviation: on the torques with the arms r_b, and on the axles
!> with -P along e and -(r_bA (a_A + P) + r_bB (a_B + P))/rho along t. Viscous forces and friction have no such terms. Energy is
!> conserved.
!>
!> Past the end of a flank the loaded positions depend on all three lengths, so that the a_i act on all of them.
!>
!> Source: docs/theory/compliant_flanks.md, sections 1 and 3.
module evl_compliant_flank
   use evl_compliant_johnson, only: compliant_contact, compliant_energy, compliant_force, compliant_force_lanes, &
                                    compliant_penetration
   use evl_compliant_lanes, only: feet_in_lanes, line_in_lanes, push_sides_in_lanes
   use evl_contact_point, only: contact_gradient, contact_point, tracked_pair
   use evl_damping_law, only: viscous_force
   use evl_edge_contact, only: change_of_foot
   use evl_elastic_law, only: elastic_result
   use evl_flank, only: context_of, flank_t
   use evl_flank_limits, only: in_lanes_on_involutes
   use evl_force_lanes, only: lane_slot
   use evl_kinds, only: lanes, pi, wp
   use evl_local_variables, only: n_local
   use evl_pair_compliance, only: own_in_lanes, own_of_pair
   use evl_pair_point, only: by_a, by_b, by_line
   use evl_status, only: code_ok, fail, quantity, status_t, subject_mesh
   use evl_tooth_contact, only: beyond_flank, contact_state, feet_of, flanks_unloaded, line_of, tooth_contact_t, touches
   use evl_wheel_compliance, only: own_at_t, wheel_compliance_t
   implicit none (type, external)
   private

   public :: change_of, change_of_line, viscous_change, compliant_flank_t

   type, extends(flank_t) :: compliant_flank_t
      class(wheel_compliance_t), allocatable :: a, b !! both wheels
      real(wp) :: k_difference = 0.0_wp             !! K_A - K_B, as in evl_pair_compliance [1/Pa]
   contains
      procedure :: laws
      procedure :: pair_alone
      procedure :: pair_under
      procedure :: add_energy
      procedure :: add_energy_in_lanes
      procedure :: force_changes
      procedure :: loss_change
      procedure :: slope_changes
      procedure :: add_compliant_forces
      procedure :: add_compliant_changes
      procedure :: laws_in_lanes
      procedure :: add_compliant_in_lanes
   end type compliant_flank_t

contains

   include "contact/solver/compliant_forces.inc"

   !> Elastic and viscous forces of the contacts that touch.
   subroutine laws(self, contacts, first, last, at, status)
      class(compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      integer, intent(in) :: first, last
      type(contact_state), intent(inout) :: at(*)
      type(status_t), intent(inout) :: status
      type(compliant_contact) :: solution
      type(own_at_t) :: own(2)
      integer :: code, k

      do k = first, last
         if (.not. touches(at(k)%mode)) cycle
         associate (contact => contacts(k), point => at(k)%point, elastic => at(k)%elastic, b => contacts(k)%width)
            call own_of_pair(self%a, self%b, self%k_difference, feet_of(at(k)), own)
            call compliant_force(point%h, line_of(at(k)), sum(own%value), contact%e_star, solution, code)
            if (code /= code_ok) &
               call fail(status, code, "penetration h = "//quantity(point%h, "m")//" has no force: the teeth would deflect by" &
                         //" more than the length of the line of action", subject_mesh, contact%mesh, "contact")
            elastic = elastic_result(b*solution%force, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp)
            associate (compliant => at(k)%compliant)
               compliant%by_force(1, :) = own%slope/2
               compliant%by_own(1, :) = own%curvature/2
               compliant%slope = solution%force*compliant%by_force(1, :)
               compliant%by_h = b*solution%d_h
               compliant%by_line = b*solution%d_length
               compliant%by_foot = b*solution%d_c*own%slope
            end associate
            call viscous_force(contact%damping, context_of(contact, at(k)), elastic, at(k)%viscous)
         end associate
      end do
   end subroutine laws

   !> Elastic force of a single perfect tooth pair at the pitch point.
   subroutine pair_alone(self, contact, h, elastic, code)
      class(compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: h
      type(elastic_result), intent(out) :: elastic
      integer, intent(out) :: code
      type(compliant_contact) :: solution

      call compliant_force(h, contact%pair%rho_0, at_pitch_point(self, contact), contact%e_star, solution, code)
      elastic = elastic_result(force=contact%width*solution%force, d_h=contact%width*solution%d_h, d_rho_a=0.0_wp, d_rho_b=0.0_wp, &
                               d_energy=0.0_wp, excess=0.0_wp)
   end subroutine pair_alone

   !> Penetration of a single perfect tooth pair under a force.
   subroutine pair_under(self, contact, force, h, code)
      class(compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: force
      real(wp), intent(out) :: h
      integer, intent(out) :: code
      real(wp) :: slope

      call compliant_penetration(force/contact%width, contact%pair%rho_0, at_pitch_point(self, contact), contact%e_star, h, &
                                 slope, code)
   end subroutine pair_under

   !> C of a pair at the pitch point [1/Pa].
   pure real(wp) function at_pitch_point(self, contact) result(c)
      class(compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contact
      type(own_at_t) :: own(2)

      associate (pair => contact%pair)
         call own_of_pair(self%a, self%b, self%k_difference, pair%rho_0/pair%r_b*[pair%r_ba, pair%r_bb], own)
      end associate
      c = sum(own%value)
   end function at_pitch_point

   !> Derivatives of the elastic and the viscous force of a contact with respect to the local variables, including those of the
   !> loaded positions.
   pure subroutine force_changes(self, contacts, at, d, k, elastic, viscous)
      class(compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      type(contact_state), intent(in) :: at(*)
      type(contact_gradient), intent(in) :: d(*)
      integer, intent(in) :: k
      real(wp), intent(out) :: elastic(n_local), viscous(n_local)

      associate (compliant => at(k)%compliant)
         elastic = compliant%by_h*d(k)%h + compliant%by_line*change_of_line(at(k), d(k)) &
                   + compliant%by_foot(by_a)*change_of(at(k), d(k), by_a) + compliant%by_foot(by_b)*change_of(at(k), d(k), by_b)
      end associate
      viscous = viscous_change(at(k), d(k), elastic)
   end subroutine force_changes

   !> Derivatives of the viscous force, given those of the elastic force.
   pure function viscous_change(at, d, elastic) result(change)
      type(contact_state), intent(in) :: at
      type(contact_gradient), intent(in) :: d
      real(wp), intent(in) :: elastic(n_local) !! of the elastic force
      real(wp) :: change(n_local)

      associate (v => at%viscous)
         change = v%d_elastic*elastic + v%d_h*d%h + v%d_rho_a*d%rho_a + v%d_rho_b*d%rho_b + v%d_h_dot*d%h_dot
      end associate
   end function viscous_change

   !> Derivatives of the loaded position on a wheel with respect to the local variables.
   pure function change_of(at, d, wheel) result(change)
      type(contact_state), intent(in) :: at
      type(contact_gradient), intent(in) :: d
      integer, intent(in) :: wheel !! by_a or by_b
      real(wp) :: change(n_local)

      if (beyond_flank(at%mode)) then
         change = change_of_foot(at%edge, d, wheel)
      else if (wheel == by_a) then
         change = d%rho_a
      else
         change = d%rho_b
      end if
   end function change_of

   !> Derivatives of the length of the line of action.
   pure function change_of_line(at, d) result(change)
      type(contact_state), intent(in) :: at
      type(contact_gradient), intent(in) :: d
      real(wp) :: change(n_local)

      if (beyond_flank(at%mode)) then
         change = d%line
      else
         change = d%l_a + d%l_b
      end if
   end function change_of_line

   !> Add the elastic energy, including that of the bodies.
   pure subroutine add_energy(self, contacts, first, last, at, energy)
      class(compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      integer, intent(in) :: first, last
      type(contact_state), intent(in) :: at(*)
      real(wp), intent(inout) :: energy
      integer :: k

      do k = first, last
         if (.not. touches(at(k)%mode)) cycle
         associate (b => contacts(k)%width)
            energy = energy + b*compliant_energy(at(k)%point%h, at(k)%elastic%force/b, contacts(k)%e_star)
         end associate
      end do
   end subroutine add_energy

   !> `add_energy` for eight states.
   subroutine add_energy_in_lanes(self, contacts, first, last, slots, energy)
      class(compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      integer, intent(in) :: first, last
      type(lane_slot), intent(in) :: slots(*)
      real(wp), intent(inout) :: energy(lanes)
      integer :: k

      do k = first, last
         if (.not. slots(k)%touches) cycle
         associate (b => contacts(k)%width)
            energy = energy + b*compliant_energy(slots(k)%at%h, slots(k)%force%elastic/b, contacts(k)%e_star)
         end associate
      end do
   end subroutine add_energy_in_lanes

   !> Zero: the power of the force equals the rate of the elastic energy.
   pure function loss_change(self, point, elastic, d) result(change)
      class(compliant_flank_t), intent(in) :: self
      type(contact_point), intent(in) :: point
      type(elastic_result), intent(in) :: elastic
      type(contact_gradient), intent(in) :: d
      real(wp) :: change(n_local)

      change = 0
   end function loss_change

   !> Forces against rho_A, rho_B and rho: a_A, a_B and P [N].
   pure function side_forces(contact, at) result(a)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      real(wp) :: a(3)

      associate (force => at%elastic%force, slope => at%compliant%slope)
         a = [force*slope, 0.0_wp]
         if (beyond_flank(at%mode)) a = matmul(at%edge%d_foot, force*slope)
         a(by_line) = a(by_line) + push_along(force, 2*pi*contact%e_star*contact%width, line_of(at))
      end associate
   end function side_forces

   !> Add the effect of `side_forces` on the wheels.
   pure subroutine add_compliant_forces(self, contact, at)
      class(compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(inout) :: at
      real(wp) :: a(3)

      a = side_forces(contact, at)
      associate (point => at%point, force => at%force)
         call push_sides(contact%pair, line_of(at), point%s, point%c, a(by_a), a(by_b), a(by_line), force%torque_a, &
                         force%torque_b, force%on_a(1), force%on_a(2))
      end associate
   end subroutine add_compliant_forces

   !> Add its derivatives with respect to the local variables.
   pure subroutine add_compliant_changes(self, contacts, at, d, k, elastic, torque_a, torque_b, on_a)
      class(compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      type(contact_state), intent(in) :: at(*)
      type(contact_gradient), intent(in) :: d(*)
      integer, intent(in) :: k
      real(wp), intent(in) :: elastic(n_local)
      real(wp), intent(inout) :: torque_a(n_local), torque_b(n_local), on_a(n_local, 2)
      real(wp) :: d_slope(n_local, 2)

      call self%slope_changes(contacts, at, d, k, elastic, d_slope)
      call add_changes(contacts(k), at(k), d(k), elastic, d_slope, torque_a, torque_b, on_a)
   end subroutine add_compliant_changes

   !> Derivatives of the slopes of an independent pair.
   pure subroutine slope_changes(self, contacts, at, d, k, elastic, change)
      class(compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      type(contact_state), intent(in) :: at(*)
      type(contact_gradient), intent(in) :: d(*)
      integer, intent(in) :: k
      real(wp), intent(in) :: elastic(n_local) !! of the elastic force
      real(wp), intent(out) :: change(n_local, 2)

      associate (compliant => at(k)%compliant, b => contacts(k)%width)
         associate (force => at(k)%elastic%force/b)
            change(:, by_a) = compliant%by_force(1, by_a)/b*elastic + force*compliant%by_own(1, by_a)*change_of(at(k), d(k), by_a)
            change(:, by_b) = compliant%by_force(1, by_b)/b*elastic + force*compliant%by_own(1, by_b)*change_of(at(k), d(k), by_b)
         end associate
      end associate
   end subroutine slope_changes

   !> Add the derivatives that follow from those of F and s.
   pure subroutine add_changes(contact, at, d, elastic, d_slope, torque_a, torque_b, on_a)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      type(contact_gradient), intent(in) :: d
      real(wp), intent(in) :: elastic(n_local), d_slope(n_local, 2)
      real(wp), intent(inout) :: torque_a(n_local), torque_b(n_local), on_a(n_local, 2)
      real(wp), dimension(n_local) :: d_line, d_tangential
      real(wp) :: a(3), d_a(n_local, 3)

      a = side_forces(contact, at)
      d_line = change_of_line(at, d)
      call side_changes(at, d, elastic, d_slope, d_a)
      associate (pair => contact%pair, point => at%point, f => at%elastic%force, line => line_of(at), push => d_a(:, by_line))
         push = push + f/(2*pi*contact%e_star*contact%width*line)*(2*elastic - f/line*d_line)
         torque_a = torque_a - (pair%sigma*pair%r_ba)*d_a(:, by_a)
         torque_b = torque_b - (pair%sigma*pair%r_bb)*d_a(:, by_b)
         d_tangential = (across(pair, a(by_a), a(by_b), a(by_line))/line*d_line &
                         - across(pair, d_a(:, by_a), d_a(:, by_b), push))/line
         on_a(:, 1) = on_a(:, 1) + point%s*push + point%c*d_tangential
         on_a(:, 2) = on_a(:, 2) - point%c*push + point%s*d_tangential
         if (at%mode%flanks /= flanks_unloaded) return ! otherwise the rotation of the normal is not yet included
         on_a(:, 1) = on_a(:, 1) - at%force%on_a(2)*d%angle
         on_a(:, 2) = on_a(:, 2) + at%force%on_a(1)*d%angle
      end associate
   end subroutine add_changes

   !> Derivatives of `side_forces`, except for P.
   pure subroutine side_changes(at, d, elastic, d_slope, d_a)
      type(contact_state), intent(in) :: at
      type(contact_gradient), intent(in) :: d
      real(wp), intent(in) :: elastic(n_local), d_slope(n_local, 2)
      real(wp), intent(out) :: d_a(n_local, 3)
      real(wp) :: side(n_local)
      integer :: i, w

      d_a = 0
      associate (slope => at%compliant%slope, f => at%elastic%force, edge => at%edge)
         do w = by_a, by_b
            side = slope(w)*elastic + f*d_slope(:, w)
            if (beyond_flank(at%mode)) then
               do i = by_a, by_line
                  d_a(:, i) = d_a(:, i) + edge%d_foot(i, w)*side + (f*slope(w))*( &
                              edge%d2_foot(by_a, i, w)*d%rho_a + edge%d2_foot(by_b, i, w)*d%rho_b &
                              + edge%d2_foot(by_line, i, w)*d%line)
               end do
            else
               d_a(:, w) = side
            end if
         end do
      end associate
   end subroutine side_changes

   !> `laws` for eight states.
   subroutine laws_in_lanes(self, contacts, first, last, slots, is_defined)
      class(compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contacts(*)
      integer, intent(in) :: first, last
      type(lane_slot), intent(inout) :: slots(*)
      logical, intent(out) :: is_defined
      real(wp) :: c(lanes), foot(lanes, 2), line(lanes)
      integer :: k

      is_defined = .true.
      do k = first, last
         if (.not. slots(k)%touches) cycle
         associate (at => slots(k)%at, force => slots(k)%force)
            is_defined = in_lanes_on_involutes(slots(k))
            if (.not. is_defined) return
            call feet_in_lanes(slots(k), foot)
            call own_in_lanes(self%a, self%b, self%k_difference, foot, c, force%slope_a, force%slope_b)
            call line_in_lanes(slots(k), line)
            call compliant_force_lanes(at%h, line, c, at%e_star, force%elastic, is_defined)
            if (.not. is_defined) return
            force%slope_a = force%elastic*force%slope_a
            force%slope_b = force%elastic*force%slope_b
            force%elastic = at%width*force%elastic
            force%d_energy = 0
            force%excess = 0
            call contacts(k)%damping%force_lanes(at%lane_context, force%elastic, force%viscous)
            force%unclipped = force%elastic + force%viscous
         end associate
      end do
   end subroutine laws_in_lanes

   !> Add the effect of a_i and P on the wheels for eight states.
   pure subroutine add_compliant_in_lanes(self, contact, slot)
      class(compliant_flank_t), intent(in) :: self
      type(tooth_contact_t), intent(in) :: contact
      type(lane_slot), intent(inout) :: slot

      call push_sides_in_lanes(contact, slot)
   end subroutine add_compliant_in_lanes

end module evl_compliant_flank
