!> Creation of the tooth contacts of a gearbox from its meshes: their number, constants and links to the state.
module evl_contact_build
   use evl_compliant_mesh, only: make_flank
   use evl_coupled_pairs, only: most_pairs
   use evl_edge_contact, only: make_tip
   use evl_first_tooth_pair, only: tooth_phase_t
   use evl_flank_deviation, only: take_line
   use evl_gear, only: gear_t
   use evl_gearbox, only: gearbox_t, wheel_t
   use evl_gearbox_description, only: mesh_input, wheel_input
   use evl_kinds, only: wp
   use evl_local_variables, only: at_normal, at_omega, at_psi_a, at_psi_b, at_psi_dot_a, at_psi_dot_b, at_theta, at_track, &
                                  at_u_a, at_u_b, at_v_a, at_v_b, i_omega, i_theta, local_link, n_track, wheel_link
   use evl_mesh_geometry, only: spur_pair_least_radius, spur_pair_t
   use evl_pair_point, only: by_a, by_b
   use evl_pair_sequence, only: exactly_one
   use evl_rational, only: rational_scaled
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t, subject_mesh, subject_wheel
   use evl_tangent_line, only: find_tangent_line
   use evl_tooth_contact, only: flank_coast, flank_drive, tooth_contact_t, tracking_closed_form
   implicit none (type, external)
   private

   public :: list_contacts, take_contact, find_dependents

   real(wp), parameter :: least_apart = 1.0e-3_wp !! gap_apart in base pitches if the path of contact ends on a base circle

contains

   !> Allocate slots on each flank that can make contact: the maximum number of tooth pairs on the path, plus one for the waiting
   !> pair.
   subroutine list_contacts(gearbox, wheels, meshes)
      type(gearbox_t), intent(inout) :: gearbox
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: meshes(:)
      integer :: m, flank, n, f

      allocate (gearbox%first(size(meshes) + 1), gearbox%flanks(size(meshes) + count(gearbox%pairs%has_coast)))
      n = 0
      f = 0
      do m = 1, size(meshes)
         gearbox%first(m) = n + 1
         associate (pair => gearbox%pairs(m))
            do flank = flank_drive, merge(flank_coast, flank_drive, pair%has_coast)
               f = f + 1
               call make_flank(gearbox, wheels, meshes(m), gearbox%flanks(f))
               gearbox%flanks(f)%flank%first = n + 1
               n = n + gearbox%flanks(f)%flank%slots_for(pair%contact_ratio, pair%handover)
               gearbox%flanks(f)%flank%last = n
            end do
         end associate
      end do
      gearbox%first(size(meshes) + 1) = n + 1
      allocate (gearbox%contacts(n))
      f = 0
      do m = 1, size(meshes)
         do flank = flank_drive, merge(flank_coast, flank_drive, gearbox%pairs(m)%has_coast)
            f = f + 1
            do n = gearbox%flanks(f)%flank%first, gearbox%flanks(f)%flank%last
               associate (contact => gearbox%contacts(n), of => gearbox%flanks(f)%flank)
                  contact%mesh = m
                  contact%flank = flank
                  contact%i_flank = f
                  contact%slot = n - of%first
                  contact%n_slots = of%last - of%first + 1
                  contact%handover = contact%n_slots == 1
                  allocate (contact%elastic, source=meshes(m)%contact)
                  allocate (contact%damping, source=meshes(m)%damping)
                  allocate (contact%friction, source=meshes(m)%friction)
                  contact%rigid = contact%elastic%is_rigid()
                  contact%one_sided = contact%damping%has_sides()
                  contact%has_edges = of%reach > 0
                  contact%deviates = contact%has_edges .or. &
                                     any(gearbox%wheels([meshes(m)%driving, meshes(m)%driven])%deviation%exists)
                  ! contact points of the coast flank follow from the wheels' positions, whatever the tracking of the drive flank
                  contact%tracking = merge(meshes(m)%tracking, tracking_closed_form, flank == flank_drive)
               end associate
            end do
         end do
      end do
   end subroutine list_contacts

   !> Geometry, laws and state links of a tooth contact. Equations T39, T59, T78.
   subroutine take_contact(gearbox, wheels, input, index, status)
      type(gearbox_t), intent(inout) :: gearbox
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: input
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status
      real(wp) :: compliance_a, compliance_b
      logical :: fits

      associate (contact => gearbox%contacts(index), pair => gearbox%pairs(gearbox%contacts(index)%mesh), &
                 phase => gearbox%phases(gearbox%contacts(index)%mesh), a => input%driving, b => input%driven)
         contact%wheel_a = a
         contact%wheel_b = b
         compliance_a = wheels(a)%compliance
         compliance_b = wheels(b)%compliance
         contact%e_star = 1/(compliance_a + compliance_b)
         contact%mobility = pair%base_radius_a**2/gearbox%wheels(a)%rotor_inertia &
                            + pair%base_radius_b**2/gearbox%wheels(b)%rotor_inertia
         call take_overlap(wheels, a, b, contact, status)
         if (has_failed(status)) return
         contact%pair%ratio_a = gearbox%wheels(a)%ratio
         contact%pair%ratio_b = gearbox%wheels(b)%ratio
         contact%pair%share_a = compliance_a*contact%e_star
         contact%pair%share_b = compliance_b*contact%e_star
         call rational_scaled(gearbox%wheels(a)%exact_ratio, -pair%sigma*wheels(a)%side*wheels(a)%teeth, 1, &
                              contact%pitches_per_turn, fits)
         if (.not. fits) then
            call fail(status, code_invalid_input, "its teeth pass too often in a revolution of the reference wheel", subject_mesh, &
                      contact%mesh)
            return
         end if
         contact%order = pair%sigma*[wheels(a)%side, -wheels(b)%side]
         contact%side = [wheels(a)%side, wheels(b)%side]
         contact%tooth_a = phase%tooth_a
         contact%tooth_b = phase%tooth_b
         contact%deviation_a = gearbox%wheels(a)%deviation
         contact%deviation_b = gearbox%wheels(b)%deviation
         contact%smooth(:, by_a) = [gearbox%compliances(a)%low, gearbox%compliances(a)%high]
         contact%smooth(:, by_b) = [gearbox%compliances(b)%low, gearbox%compliances(b)%high]
         call take_pair(pair, contact)
         call take_ends(pair, gearbox%gears(a), gearbox%gears(b), contact)
         if (contact%flank == flank_drive) then
            call take_drive(pair, phase, contact)
         else
            call take_coast(pair, phase, contact)
         end if
         contact%pair%advance = -contact%pair%sigma*contact%pair%r_ba*contact%pair%ratio_a
         call check_contact(pair, contact, gearbox%flanks(contact%i_flank)%flank%couples, status)
      end associate
      if (.not. has_failed(status)) call link_states(gearbox, gearbox%contacts(index))
   end subroutine take_contact

   !> Constants of both flanks of a pair.
   pure subroutine take_pair(pair, contact)
      type(spur_pair_t), intent(in) :: pair
      type(tooth_contact_t), intent(inout) :: contact

      contact%base_pitch = pair%base_pitch
      contact%rho_tip_a = pair%rho_tip_a
      contact%rho_tip_b = pair%rho_tip_b
      contact%gap_apart = max(spur_pair_least_radius(pair)/2, least_apart*pair%base_pitch)
      contact%pair%r_ba = pair%base_radius_a
      contact%pair%r_bb = pair%base_radius_b
      contact%pair%r_b = pair%base_radius_sum
      contact%pair%rho_0 = pair%rho
   end subroutine take_pair

   !> Tips and fillets of both wheels, where the involutes end.
   subroutine take_ends(pair, gear_a, gear_b, contact)
      type(spur_pair_t), intent(in) :: pair
      type(gear_t), intent(in) :: gear_a, gear_b
      type(tooth_contact_t), intent(inout) :: contact !! with the deviations of its flanks

      if (contact%has_edges) then
         call take_line(contact%deviation_a, pair%rho, pair%rho - pair%rho_tip_b)
         call take_line(contact%deviation_b, pair%rho, pair%rho - pair%rho_tip_a)
      end if
      call make_tip(contact%deviation_a, pair%base_radius_a, pair%base_radius_b, pair%rho_tip_a, gear_a%tip_rounding, pair%rho, &
                    contact%tips(by_a))
      call make_tip(contact%deviation_b, pair%base_radius_b, pair%base_radius_a, pair%rho_tip_b, gear_b%tip_rounding, pair%rho, &
                    contact%tips(by_b))
      contact%fillets = contact%side*sqrt(max([gear_a%form_radius, gear_b%form_radius]**2 &
                                              - [gear_a%base_radius, gear_b%base_radius]**2, 0.0_wp))
   end subroutine take_ends

   !> Drive flank.
   pure subroutine take_drive(pair, phase, contact)
      type(spur_pair_t), intent(in) :: pair
      type(tooth_phase_t), intent(in) :: phase
      type(tooth_contact_t), intent(inout) :: contact

      contact%pair%sigma = real(pair%sigma, wp)
      contact%step = pair%base_pitch
      contact%rho_start = phase%rho_start
      contact%pair%gap_0 = phase%gap
      contact%rho_entry = pair%rho_start_a
      contact%t_0 = pair%t
      contact%e_0 = pair%e
      contact%k_a0 = pair%point_k_a
   end subroutine take_drive

   !> Reject contacts whose number or law does not fit the geometry.
   subroutine check_contact(pair, contact, couples, status)
      type(spur_pair_t), intent(in) :: pair
      type(tooth_contact_t), intent(in) :: contact
      logical, intent(in) :: couples !! tooth pairs deflect under each other's loads
      type(status_t), intent(inout) :: status

      if (couples .and. contact%n_slots > most_pairs) then
         call fail(status, code_invalid_input, "at its contact ratio of "//quantity(pair%contact_ratio, "")//" more tooth" &
                   //" pairs can touch at once than the program can couple; give tooth_coupling: false", subject_mesh, &
                   contact%mesh, "tooth_coupling")
      else if (contact%rigid .and. pair%has_coast .and. .not. pair%backlash > 0) then
         call fail(status, code_invalid_input, "rigid contacts need backlash, but the normal backlash of this mesh is " &
                   //quantity(pair%backlash, "m")//": both flanks would touch at once", subject_mesh, contact%mesh, &
                   "contact.law")
      else if (contact%rigid .and. pair%contact_ratio < 1 - exactly_one) then
         call fail(status, code_invalid_input, "a rigid contact needs a contact ratio of at least 1, but that of this mesh is " &
                   //quantity(pair%contact_ratio, "")//": flanks would overlap when a tooth pair begins", subject_mesh, &
                   contact%mesh, "contact.law")
      end if
   end subroutine check_contact

   !> Coast flank: the mirror image of the drive flank, on the opposite side of the same tooth of the driving wheel.
   !> Equations P3, P4, P5.
   !>
   !> With tau the tooth thickness angle on the base circle, the involutes of both sides of a tooth start tau apart:
   !> rho_A + rho_A(coast) = r_bA (2 alpha_w + tau). On the driven wheel it is the next tooth behind, in the order of the pairs.
   pure subroutine take_coast(pair, phase, contact)
      type(spur_pair_t), intent(in) :: pair
      type(tooth_phase_t), intent(in) :: phase
      type(tooth_contact_t), intent(inout) :: contact
      real(wp) :: tau
      integer :: passed

      contact%pair%sigma = -real(pair%sigma, wp)
      contact%pair%gap_0 = pair%backlash - phase%gap
      contact%step = -pair%base_pitch
      contact%rho_entry = pair%rho_tip_a
      associate (direction => pair%chi - pair%sigma*pair%alpha_w)
         contact%t_0 = [cos(direction), sin(direction)]
         contact%e_0 = -pair%sigma*[sin(direction), -cos(direction)]
      end associate
      contact%k_a0 = pair%centre_a + pair%base_radius_a*contact%t_0
      tau = pair%tooth_angle_a
      ! if unknown, the teeth of both wheels have the same thickness on the pitch circles
      if (.not. abs(tau) > 0) tau = (pair%pitch_radius_a*pair%gamma_a - pair%backlash/cos(pair%alpha_w))/2/pair%pitch_radius_a &
                                    + 2*(tan(pair%alpha_w) - pair%alpha_w)
      contact%rho_start = pair%base_radius_a*(2*pair%alpha_w + tau) - phase%rho_start
      contact%tooth_b = contact%tooth_b + contact%order(by_b)
      if (.not. contact%handover) return
      ! the pair within the path of contact at the start has number 0
      passed = floor((contact%rho_entry - contact%rho_start)/pair%base_pitch)
      contact%rho_start = contact%rho_start + passed*pair%base_pitch
      contact%tooth_a = contact%tooth_a + passed*contact%order(by_a)
      contact%tooth_b = contact%tooth_b + passed*contact%order(by_b)
   end subroutine take_coast

   !> Common face width of two wheels: the axial overlap of their faces.
   subroutine take_overlap(wheels, a, b, contact, status)
      type(wheel_input), intent(in) :: wheels(:)
      integer, intent(in) :: a, b
      type(tooth_contact_t), intent(inout) :: contact
      type(status_t), intent(inout) :: status
      real(wp) :: low, high, z(2), width(2)

      z = [wheels(a)%number("axial_position"), wheels(b)%number("axial_position")]
      width = [wheels(a)%number("width"), wheels(b)%number("width")]
      low = maxval(z - width/2)
      high = minval(z + width/2)
      contact%width = high - low
      contact%axial_position = (low + high)/2
      if (contact%width > 0) return
      call fail(status, code_invalid_input, "the faces of the two wheels of a mesh do not overlap: one is at z = " &
                //quantity(z(1), "m")//" and "//quantity(width(1), "m")//" wide, the other at z = "//quantity(z(2), "m")//" and " &
                //quantity(width(2), "m")//" wide", subject_wheel, b, "axial_position")
   end subroutine take_overlap

   !> Wheel that each rigid mesh determines when it is closed. Wheels connected by rigid meshes move as one. Each such group is
   !> traversed from one wheel: the one with prescribed speed, else the reference wheel. Every mesh determines the wheel that it
   !> reaches; a mesh that closes a loop determines none.
   subroutine find_dependents(gearbox, status)
      type(gearbox_t), intent(inout) :: gearbox
      type(status_t), intent(inout) :: status
      logical :: reached(size(gearbox%wheels)), used(size(gearbox%pairs))
      integer :: i, m

      reached = .false.
      used = .false.
      do i = 1, size(gearbox%wheels)
         if (gearbox%wheels(i)%prescribed > 0) call reach(i)
      end do
      call reach(gearbox%reference)
      do i = 1, size(gearbox%wheels)
         call reach(i)
      end do
      do m = 1, size(gearbox%pairs)
         if (.not. gearbox%contacts(gearbox%first(m))%rigid .or. used(m) .or. has_failed(status)) cycle
         call fail(status, code_invalid_input, "a rigid contact that closes a ring of rigid contacts is overdetermined; give it" &
                   //" an elastic law", subject_mesh, m, "contact.law")
      end do

   contains

      !> Traverse all wheels connected to the first one by rigid meshes, unless already reached.
      subroutine reach(first)
         integer, intent(in) :: first
         logical :: group(size(gearbox%wheels)), found
         integer :: k

         if (reached(first)) return
         group = gearbox%wheels%leader == gearbox%wheels(first)%leader
         found = .true.
         do while (found)
            found = .false.
            do k = 1, size(gearbox%pairs)
               associate (contact => gearbox%contacts(gearbox%first(k)), a => gearbox%contacts(gearbox%first(k))%wheel_a, &
                          b => gearbox%contacts(gearbox%first(k))%wheel_b)
                  if (.not. contact%rigid .or. (group(a) .eqv. group(b))) cycle
                  associate (next => merge(b, a, group(a)))
                     if (gearbox%wheels(next)%prescribed > 0 .and. .not. has_failed(status)) &
                        call fail(status, code_invalid_input, "rigid contacts join two wheels whose speeds are prescribed: give" &
                                  //" this one an elastic law", subject_mesh, k, "contact.law")
                     gearbox%contacts(gearbox%first(k):gearbox%first(k + 1) - 1)%i_dependent = gearbox%wheels(next)%i_psi
                  end associate
                  group = group .or. gearbox%wheels%leader == gearbox%wheels(a)%leader &
                          .or. gearbox%wheels%leader == gearbox%wheels(b)%leader
                  used(k) = .true.
                  found = .true.
               end associate
            end do
         end do
         reached = reached .or. group
      end subroutine reach

   end subroutine find_dependents

   !> Local variables of a tooth contact in terms of the state.
   subroutine link_states(gearbox, contact)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(inout) :: contact
      integer :: i

      contact%links = [local_link(at_theta, i_theta, 1.0_wp), local_link(at_omega, i_omega, 1.0_wp)]
      contact%link_a = link_of(gearbox%wheels(contact%wheel_a), contact)
      contact%link_b = link_of(gearbox%wheels(contact%wheel_b), contact)
      call link_wheel(contact, contact%link_a, at_psi_a, at_psi_dot_a, at_u_a, at_v_a)
      call link_wheel(contact, contact%link_b, at_psi_b, at_psi_dot_b, at_u_b, at_v_b)
      if (contact%i_normal > 0) contact%links = [contact%links, local_link(at_normal, contact%i_normal, 1.0_wp)]
      if (contact%i_track > 0) &
         contact%links = [contact%links, (local_link(at_track + i, contact%i_track + i, 1.0_wp), i=0, n_track - 1)]
      contact%axles_rest = gearbox%wheels(contact%wheel_a)%support%n == 0 .and. gearbox%wheels(contact%wheel_b)%support%n == 0
      if (contact%axles_rest) call find_tangent_line(contact%pair%r_b, contact%pair%rho_0, 0.0_wp, 0.0_wp, contact%rest_line)
   end subroutine link_states

   !> Link of a tooth contact to the motion of a wheel.
   pure type(wheel_link) function link_of(wheel, contact) result(link)
      type(wheel_t), intent(in) :: wheel
      type(tooth_contact_t), intent(in) :: contact
      integer :: j

      link%i_psi = wheel%i_psi
      link%n = wheel%support%n
      link%i_state = wheel%support%i_state
      do j = 1, link%n
         link%along_t(j) = dot_product(wheel%support%direction(:, j), contact%t_0)
         link%along_e(j) = dot_product(wheel%support%direction(:, j), contact%e_0)
      end do
   end function link_of

   !> Local variables of one wheel in terms of the state.
   subroutine link_wheel(contact, link, at_psi, at_psi_dot, at_u, at_v)
      type(tooth_contact_t), intent(inout) :: contact
      type(wheel_link), intent(in) :: link
      integer, intent(in) :: at_psi, at_psi_dot, at_u, at_v
      integer :: j

      if (link%i_psi > 0) contact%links = [contact%links, local_link(at_psi, link%i_psi, 1.0_wp), &
                                           local_link(at_psi_dot, link%i_psi + 1, 1.0_wp)]
      do j = 1, link%n
         associate (i => link%i_state(j), along_t => link%along_t(j), along_e => link%along_e(j))
            contact%links = [contact%links, local_link(at_u, i, along_t), local_link(at_u + 1, i, along_e), &
                             local_link(at_v, i + 1, along_t), local_link(at_v + 1, i + 1, along_e)]
         end associate
      end do
   end subroutine link_wheel

end module evl_contact_build
