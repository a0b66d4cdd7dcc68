!> Makes the tooth contacts of a gearbox from its meshes: how many there are, their constants, their links to the state.
module evl_contact_build
   use evl_contact_laws, only: is_rigid
   use evl_first_tooth_pair, only: tooth_phase_t
   use evl_gearbox, only: gearbox_t, wheel_t
   use evl_gearbox_description, only: mesh_input, wheel_input
   use evl_kinds, only: pi, wp
   use evl_local_variables, only: at_normal, at_omega, at_psi_a, at_psi_b, at_psi_dot_a, at_psi_dot_b, at_theta, at_track, &
                                  at_u_a, at_u_b, at_v_a, at_v_b, i_omega, i_theta, mesh_link, n_track, wheel_link
   use evl_mesh_geometry, only: spur_pair_least_radius, spur_pair_t
   use evl_rational, only: rational_scaled
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t, subject_mesh, subject_wheel
   use evl_tangent_line, only: deviation_find
   use evl_tooth_contact, only: contact_t, flank_coast, flank_drive, n_border_roots, n_mesh_roots, tracking_closed_form
   implicit none (type, external)
   private

   public :: list_contacts, take_contact, find_dependents

   real(wp), parameter :: exactly_one = 1.0e-9_wp !! contact ratios this near a whole number are one; at 1 pairs hand over
   real(wp), parameter :: least_apart = 1.0e-3_wp !! in base pitches: gap_apart where the path ends on a base circle

contains

   !> As many slots as tooth pairs can be on the path at once, and one for the pair that waits, on each flank that can touch.
   subroutine list_contacts(gearbox, meshes)
      type(gearbox_t), intent(inout) :: gearbox
      type(mesh_input), intent(in) :: meshes(:)
      integer :: m, flank, slot, slots, n

      allocate (gearbox%first(size(meshes) + 1))
      n = 0
      do m = 1, size(meshes)
         gearbox%first(m) = n + 1
         n = n + n_slots(gearbox%pairs(m))*merge(2, 1, gearbox%pairs(m)%has_coast)
      end do
      gearbox%first(size(meshes) + 1) = n + 1
      allocate (gearbox%contacts(n))
      do m = 1, size(meshes)
         n = gearbox%first(m) - 1
         slots = n_slots(gearbox%pairs(m))
         do flank = flank_drive, merge(flank_coast, flank_drive, gearbox%pairs(m)%has_coast)
            do slot = 0, slots - 1
               n = n + 1
               associate (contact => gearbox%contacts(n))
                  contact%mesh = m
                  contact%flank = flank
                  contact%slot = slot
                  contact%n_slots = slots
                  contact%handover = slots == 1
                  contact%rigid = is_rigid(meshes(m)%contact)
                  contact%damping = meshes(m)%damping
                  contact%deviates = any(gearbox%wheels([meshes(m)%driving, meshes(m)%driven])%deviation%exists)
                  contact%n_roots = n_mesh_roots + merge(n_border_roots, 0, contact%deviates)
                  ! the points of the coast flank follow from the wheels' positions, whatever tracks those of the drive flank
                  contact%tracking = merge(meshes(m)%tracking, tracking_closed_form, flank == flank_drive)
               end associate
            end do
         end do
      end do
   end subroutine list_contacts

   !> Slots of a flank.
   pure integer function n_slots(pair) result(n)
      type(spur_pair_t), intent(in) :: pair

      n = 1
      if (.not. (pair%handover .or. abs(pair%contact_ratio - 1) < exactly_one)) n = ceiling(pair%contact_ratio - exactly_one) + 1
   end function n_slots

   !> Geometry, laws and links to the state of a tooth contact.
   subroutine take_contact(gearbox, wheels, given, index, status)
      type(gearbox_t), intent(inout) :: gearbox
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: given
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status
      real(wp) :: compliance_a, compliance_b
      logical :: fits

      associate (mesh => gearbox%contacts(index), pair => gearbox%pairs(gearbox%contacts(index)%mesh), a => given%driving, &
                 b => given%driven)
         mesh%wheel_a = a
         mesh%wheel_b = b
         mesh%contact = given%contact
         mesh%damping = given%damping
         mesh%friction = given%friction
         compliance_a = (1 - wheels(a)%poisson_ratio**2)/wheels(a)%youngs_modulus
         compliance_b = (1 - wheels(b)%poisson_ratio**2)/wheels(b)%youngs_modulus
         mesh%e_star = 1/(compliance_a + compliance_b)
         mesh%mobility = pair%base_radius_a**2/gearbox%wheels(a)%rotor_inertia &
                         + pair%base_radius_b**2/gearbox%wheels(b)%rotor_inertia
         call take_overlap(wheels, a, b, mesh, status)
         if (has_failed(status)) return
         mesh%base_pitch = pair%base_pitch
         mesh%rho_tip_a = pair%rho_tip_a
         mesh%rho_tip_b = pair%rho_tip_b
         mesh%gap_apart = max(spur_pair_least_radius(pair)/2, least_apart*pair%base_pitch)
         mesh%pair%r_ba = pair%base_radius_a
         mesh%pair%r_bb = pair%base_radius_b
         mesh%pair%rho_0 = pair%rho
         mesh%pair%ratio_a = gearbox%wheels(a)%ratio
         mesh%pair%ratio_b = gearbox%wheels(b)%ratio
         mesh%pair%share_a = compliance_a*mesh%e_star
         mesh%pair%share_b = compliance_b*mesh%e_star
         call rational_scaled(gearbox%wheels(a)%exact_ratio, -pair%sigma*wheels(a)%teeth, 1, mesh%pitches_per_turn, fits)
         if (.not. fits) then
            call fail(status, code_invalid_input, "its teeth pass too often in a turn of the reference wheel", subject_mesh, &
                      mesh%mesh)
            return
         end if
         mesh%tooth_sign = pair%sigma
         mesh%tooth_a = gearbox%phases(mesh%mesh)%tooth_a
         mesh%tooth_b = gearbox%phases(mesh%mesh)%tooth_b
         mesh%deviation_a = gearbox%wheels(a)%deviation
         mesh%deviation_b = gearbox%wheels(b)%deviation
         if (mesh%flank == flank_drive) then
            mesh%pair%sigma = real(pair%sigma, wp)
            mesh%step = pair%base_pitch
            mesh%rho_start = gearbox%phases(mesh%mesh)%rho_start
            mesh%pair%gap_0 = gearbox%phases(mesh%mesh)%gap
            mesh%rho_entry = pair%rho_start_a
            mesh%t_0 = pair%t
            mesh%e_0 = pair%e
            mesh%k_a0 = pair%point_k_a
         else
            call take_coast(pair, gearbox%phases(mesh%mesh), mesh)
         end if
         mesh%pair%advance = -mesh%pair%sigma*mesh%pair%r_ba*mesh%pair%ratio_a
         if (mesh%rigid .and. pair%has_coast .and. .not. pair%backlash > 0) then
            call fail(status, code_invalid_input, "rigid contacts need backlash, but the normal backlash of this mesh is " &
                      //quantity(pair%backlash, "m")//": both flanks would touch at once", subject_mesh, mesh%mesh, "contact.law")
         else if (mesh%rigid .and. pair%contact_ratio < 1 - exactly_one) then
            call fail(status, code_invalid_input, "a rigid contact needs a contact ratio of at least 1, but that of this mesh is " &
                      //quantity(pair%contact_ratio, "")//": flanks would overlap when a tooth pair begins", subject_mesh, &
                      mesh%mesh, "contact.law")
         end if
      end associate
      call link_states(gearbox, gearbox%contacts(index))
   end subroutine take_contact

   !> The coast flank: the mirror image of the drive flank, on the other side of the same tooth of the driving wheel.
   !>
   !> With tau the angle that a tooth fills on the base circle, the involutes of both sides of a tooth are rooted tau apart:
   !> rho_A + rho_A(coast) = r_bA (2 alpha_w + tau). On the driven wheel it is the tooth behind, in the order in which pairs come.
   pure subroutine take_coast(pair, phase, mesh)
      type(spur_pair_t), intent(in) :: pair
      type(tooth_phase_t), intent(in) :: phase
      type(contact_t), intent(inout) :: mesh
      real(wp) :: tau
      integer :: passed

      mesh%pair%sigma = -real(pair%sigma, wp)
      mesh%pair%gap_0 = pair%backlash - phase%gap
      mesh%step = -pair%base_pitch
      mesh%rho_entry = pair%rho_tip_a
      associate (direction => pair%chi - pair%sigma*pair%alpha_w)
         mesh%t_0 = [cos(direction), sin(direction)]
         mesh%e_0 = -pair%sigma*[sin(direction), -cos(direction)]
      end associate
      mesh%k_a0 = pair%centre_a + pair%base_radius_a*mesh%t_0
      tau = pair%tooth_angle_a
      if (.not. tau > 0) tau = even_tooth_angle(pair)
      mesh%rho_start = pair%base_radius_a*(2*pair%alpha_w + tau) - phase%rho_start
      mesh%tooth_b = mesh%tooth_b - mesh%tooth_sign
      if (.not. mesh%handover) return
      ! the pair between the ends of the path at the start is number 0
      passed = floor((mesh%rho_entry - mesh%rho_start)/pair%base_pitch)
      mesh%rho_start = mesh%rho_start + passed*pair%base_pitch
      mesh%tooth_a = mesh%tooth_a + passed*mesh%tooth_sign
      mesh%tooth_b = mesh%tooth_b - passed*mesh%tooth_sign
   end subroutine take_coast

   !> Angle that a tooth of the driving wheel fills on its base circle if both wheels' teeth are equally thick on the pitch circles.
   pure real(wp) function even_tooth_angle(pair) result(tau)
      type(spur_pair_t), intent(in) :: pair

      associate (thickness => (pair%pitch_radius_a*pair%gamma_a - pair%backlash/cos(pair%alpha_w))/2)
         tau = thickness/pair%pitch_radius_a + 2*(tan(pair%alpha_w) - pair%alpha_w)
      end associate
   end function even_tooth_angle

   !> The common width of two wheels is the overlap of their faces.
   subroutine take_overlap(wheels, a, b, mesh, status)
      type(wheel_input), intent(in) :: wheels(:)
      integer, intent(in) :: a, b
      type(contact_t), intent(inout) :: mesh
      type(status_t), intent(inout) :: status
      real(wp) :: low, high

      low = max(wheels(a)%axial_position - wheels(a)%width/2, wheels(b)%axial_position - wheels(b)%width/2)
      high = min(wheels(a)%axial_position + wheels(a)%width/2, wheels(b)%axial_position + wheels(b)%width/2)
      mesh%width = high - low
      mesh%axial_position = (low + high)/2
      if (mesh%width > 0) return
      call fail(status, code_invalid_input, "the faces of the two wheels of a mesh do not overlap: one is at z = " &
                //quantity(wheels(a)%axial_position, "m")//" and "//quantity(wheels(a)%width, "m")//" wide, the other at z = " &
                //quantity(wheels(b)%axial_position, "m")//" and "//quantity(wheels(b)%width, "m")//" wide", subject_wheel, b, &
                "axial_position")
   end subroutine take_overlap

   !> The wheel that each rigid mesh determines when it is closed. Wheels that rigid meshes join move as one: each such group is
   !> reached from one of its wheels on, the one whose speed is prescribed or else the reference wheel, and every mesh determines
   !> the wheel that it reaches. A mesh that closes a ring of them determines none.
   subroutine find_dependents(gearbox, status)
      type(gearbox_t), intent(inout) :: gearbox
      type(status_t), intent(inout) :: status
      logical :: reached(size(gearbox%wheels)), used(size(gearbox%pairs))
      integer :: i, m

      reached = .false.
      used = .false.
      do i = 1, size(gearbox%wheels)
         if (gearbox%wheels(i)%prescribed > 0 .and. .not. reached(i)) call reach(i)
      end do
      if (.not. reached(gearbox%reference)) call reach(gearbox%reference)
      do i = 1, size(gearbox%wheels)
         if (.not. reached(i)) call reach(i)
      end do
      do m = 1, size(gearbox%pairs)
         if (.not. gearbox%contacts(gearbox%first(m))%rigid .or. used(m) .or. has_failed(status)) cycle
         call fail(status, code_invalid_input, "a rigid contact that closes a ring of rigid contacts is overdetermined: give it" &
                   //" an elastic law", subject_mesh, m, "contact.law")
      end do

   contains

      !> Reach all wheels that rigid meshes join to the first one.
      subroutine reach(first)
         integer, intent(in) :: first
         logical :: group(size(gearbox%wheels)), found
         integer :: k

         group = gearbox%wheels%leader == gearbox%wheels(first)%leader
         found = .true.
         do while (found)
            found = .false.
            do k = 1, size(gearbox%pairs)
               associate (mesh => gearbox%contacts(gearbox%first(k)), a => gearbox%contacts(gearbox%first(k))%wheel_a, &
                          b => gearbox%contacts(gearbox%first(k))%wheel_b)
                  if (.not. mesh%rigid .or. (group(a) .eqv. group(b))) cycle
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
   subroutine link_states(gearbox, mesh)
      type(gearbox_t), intent(in) :: gearbox
      type(contact_t), intent(inout) :: mesh
      integer :: i

      mesh%links = [mesh_link(at_theta, i_theta, 1.0_wp), mesh_link(at_omega, i_omega, 1.0_wp)]
      mesh%link_a = link_of(gearbox%wheels(mesh%wheel_a), mesh)
      mesh%link_b = link_of(gearbox%wheels(mesh%wheel_b), mesh)
      call link_wheel(mesh, mesh%link_a, at_psi_a, at_psi_dot_a, at_u_a, at_v_a)
      call link_wheel(mesh, mesh%link_b, at_psi_b, at_psi_dot_b, at_u_b, at_v_b)
      if (mesh%i_normal > 0) mesh%links = [mesh%links, mesh_link(at_normal, mesh%i_normal, 1.0_wp)]
      if (mesh%i_track > 0) &
         mesh%links = [mesh%links, (mesh_link(at_track + i, mesh%i_track + i, 1.0_wp), i=0, n_track - 1)]
      mesh%axles_rest = gearbox%wheels(mesh%wheel_a)%support%n == 0 .and. gearbox%wheels(mesh%wheel_b)%support%n == 0
      if (mesh%axles_rest) &
         call deviation_find(mesh%pair%r_ba + mesh%pair%r_bb, mesh%pair%rho_0, 0.0_wp, 0.0_wp, mesh%rest_line)
   end subroutine link_states

   !> What a tooth contact has to know of a wheel's motion.
   pure type(wheel_link) function link_of(wheel, mesh) result(link)
      type(wheel_t), intent(in) :: wheel
      type(contact_t), intent(in) :: mesh
      integer :: j

      link%i_psi = wheel%i_psi
      link%n = wheel%support%n
      link%i_state = wheel%support%i_state
      do j = 1, link%n
         link%along_t(j) = dot_product(wheel%support%direction(:, j), mesh%t_0)
         link%along_e(j) = dot_product(wheel%support%direction(:, j), mesh%e_0)
      end do
   end function link_of

   !> One wheel's local variables in terms of the state.
   subroutine link_wheel(mesh, link, at_psi, at_psi_dot, at_u, at_v)
      type(contact_t), intent(inout) :: mesh
      type(wheel_link), intent(in) :: link
      integer, intent(in) :: at_psi, at_psi_dot, at_u, at_v
      integer :: j

      if (link%i_psi > 0) mesh%links = [mesh%links, mesh_link(at_psi, link%i_psi, 1.0_wp), &
                                        mesh_link(at_psi_dot, link%i_psi + 1, 1.0_wp)]
      do j = 1, link%n
         associate (i => link%i_state(j), along_t => link%along_t(j), along_e => link%along_e(j))
            mesh%links = [mesh%links, mesh_link(at_u, i, along_t), mesh_link(at_u + 1, i, along_e), &
                          mesh_link(at_v, i + 1, along_t), mesh_link(at_v + 1, i + 1, along_e)]
         end associate
      end do
   end subroutine link_wheel

end module evl_contact_build
