!> Makes a gearbox from its description: checks every number, finds the layout, derives the geometry, numbers the states.
module evl_gearbox_build
   use evl_contact_laws, only: is_rigid
   use evl_gear_build, only: gears_build
   use evl_gear_pair, only: gear_pair_derive
   use evl_gearbox, only: gearbox_t, i_omega, i_theta, support_bearing, support_slider, support_t
   use evl_gearbox_deviations, only: gearbox_set_deviations
   use evl_gearbox_description, only: check_description, mesh_input, wheel_input
   use evl_gearbox_scaling, only: gearbox_set_scales
   use evl_housing, only: n_housing_states
   use evl_housing_description, only: housing_create, housing_input
   use evl_kinds, only: pi, wp
   use evl_layout, only: layout_resolve, layout_t
   use evl_load, only: load_prescribed_speed, load_t
   use evl_local_variables, only: at_normal, at_omega, at_psi_a, at_psi_b, at_psi_dot_a, at_psi_dot_b, at_theta, at_track, at_u_a, &
                                  at_u_b, at_v_a, at_v_b, n_track
   use evl_mesh, only: mesh_link, mesh_t, tracking_closed_form
   use evl_output_table, only: count_values
   use evl_spur_geometry, only: spur_pair_derive
   use evl_status, only: code_invalid_input, fail, has_failed, message_length, quantity, status_t, subject_mesh, subject_wheel
   implicit none (type, external)
   private

   public :: gearbox_create

   real(wp), parameter :: narrow = 0.1_wp       !! half width of the contact strip over a radius of curvature: warn above
   real(wp), parameter :: agreement = 1.0e-9_wp !! relative: base radii from two meshes that differ less are the same

contains

   !> Make a gearbox. Loads come with `wheel` from 1 and without `i_segment`.
   !> Errors: code_invalid_input with subject, index and field.
   subroutine gearbox_create(wheels, loads, meshes, housing, gearbox, status)
      type(wheel_input), intent(in) :: wheels(:)
      type(load_t), intent(in) :: loads(:)
      type(mesh_input), intent(in) :: meshes(:)
      type(housing_input), intent(in) :: housing
      type(gearbox_t), intent(out) :: gearbox
      type(status_t), intent(inout) :: status
      type(layout_t) :: layout
      integer :: i

      call check_description(wheels, loads, meshes, status)
      if (has_failed(status)) return
      call housing_create(housing, gearbox%housing, status)
      if (has_failed(status)) return
      allocate (gearbox%wheels(size(wheels)), gearbox%meshes(size(meshes)), gearbox%pairs(size(meshes)))
      allocate (gearbox%warnings(0))
      gearbox%loads = loads
      do i = 1, size(loads)
         if (loads(i)%kind == load_prescribed_speed) gearbox%wheels(loads(i)%wheel)%prescribed = i
      end do
      gearbox%reference = max(1, findloc(gearbox%wheels%prescribed > 0, .true., dim=1))
      allocate (gearbox%gears(size(wheels)), gearbox%gear_meshes(size(meshes)))
      call gears_build(wheels, meshes, gearbox%gears, gearbox%gear_meshes, gearbox%warnings, status)
      if (has_failed(status)) return
      call start_layout(wheels, meshes, gearbox, layout)
      call layout_resolve(layout, gearbox%reference, status)
      if (has_failed(status)) return
      call take_wheels(wheels, layout, gearbox, status)
      if (has_failed(status)) return
      call number_states(meshes, gearbox)
      do i = 1, size(meshes)
         call take_mesh(gearbox, wheels, meshes(i), layout, i, status)
         if (has_failed(status)) return
      end do
      call gearbox_set_deviations(gearbox, wheels, meshes, status)
      if (has_failed(status)) return
      call find_dependents(gearbox, status)
      if (has_failed(status)) return
      call gearbox_set_scales(gearbox)
      do i = 1, size(meshes)
         call check_contact_width(gearbox, i)
      end do
      gearbox%n_values = count_values(gearbox)
   end subroutine gearbox_create

   !> What the description says of the layout.
   subroutine start_layout(wheels, meshes, gearbox, layout)
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: meshes(:)
      type(gearbox_t), intent(in) :: gearbox !! its gears
      type(layout_t), intent(out) :: layout
      integer :: i

      layout%teeth = wheels%teeth
      layout%has_radius = wheels%has_pitch_radius .or. wheels%has_gear
      layout%pitch_radius = merge(gearbox%gears%reference_radius, wheels%pitch_radius, wheels%has_gear)
      layout%has_centre = wheels%has_centre
      allocate (layout%centre(2, size(wheels)))
      do i = 1, size(wheels)
         layout%centre(:, i) = wheels(i)%centre
      end do
      layout%driving = meshes%driving
      layout%driven = meshes%driven
      layout%has_angle = meshes%has_centre_line_angle
      layout%angle = meshes%centre_line_angle
      layout%has_distance = gearbox%gear_meshes%exists
      layout%distance = gearbox%gear_meshes%centre_distance
   end subroutine start_layout

   !> Mass, inertia, support and speed ratio of every wheel. A solid disc of the pitch radius, less
   !> the bore of a real gear, unless mass and inertia are given.
   subroutine take_wheels(wheels, layout, gearbox, status)
      type(wheel_input), intent(in) :: wheels(:)
      type(layout_t), intent(in) :: layout
      type(gearbox_t), intent(inout) :: gearbox
      type(status_t), intent(inout) :: status
      integer :: i

      do i = 1, size(wheels)
         associate (wheel => gearbox%wheels(i), given => wheels(i))
            wheel%teeth = given%teeth
            wheel%pitch_radius = layout%pitch_radius(i)
            wheel%centre = layout%centre(:, i)
            wheel%ratio = layout%turn(i)*real(wheels(gearbox%reference)%teeth, wp)/given%teeth
            wheel%mass = given%density*pi*(wheel%pitch_radius**2 - gearbox%gears(i)%bore_radius**2)*given%width
            if (given%has_mass) wheel%mass = given%mass
            wheel%inertia = wheel%mass*(wheel%pitch_radius**2 + gearbox%gears(i)%bore_radius**2)/2
            if (given%has_inertia) wheel%inertia = given%inertia
            wheel%axial_position = given%axial_position
            call take_transverse(given, i, wheel%mass, wheel%inertia, wheel%transverse_inertia, status)
            call take_support(given, wheel%mass, wheel%support)
         end associate
      end do
   end subroutine take_wheels

   !> Inertia about a diameter: given, or that of any axisymmetric body that is alike over its width, as a disc or a ring is.
   subroutine take_transverse(given, index, mass, inertia, transverse_inertia, status)
      type(wheel_input), intent(in) :: given
      integer, intent(in) :: index
      real(wp), intent(in) :: mass, inertia         !! [kg], [kg m^2]
      real(wp), intent(out) :: transverse_inertia   !! [kg m^2]
      type(status_t), intent(inout) :: status

      transverse_inertia = inertia/2 + mass*given%width**2/12
      if (.not. given%has_transverse_inertia) return
      transverse_inertia = given%transverse_inertia
      if (transverse_inertia >= inertia/2*(1 - agreement)) return
      call fail(status, code_invalid_input, "transverse_inertia "//quantity(transverse_inertia, "kg m^2")//" is less than half" &
                //" the moment of inertia about the axle "//quantity(inertia, "kg m^2")//", which no body has", subject_wheel, &
                index, "transverse_inertia")
   end subroutine take_transverse

   !> A support's directions, springs and dampers.
   subroutine take_support(given, wheel_mass, support)
      type(wheel_input), intent(in) :: given
      real(wp), intent(in) :: wheel_mass !! [kg]
      type(support_t), intent(out) :: support

      support%kind = given%support_kind
      support%mass = wheel_mass + given%support_mass
      support%stiffness = given%support_stiffness
      support%damping = given%support_damping
      select case (support%kind)
      case (support_slider)
         support%n = 1
         support%direction(:, 1) = [cos(given%support_direction), sin(given%support_direction)]
      case (support_bearing)
         support%n = 2
         support%direction(:, 1) = [1, 0]
         support%direction(:, 2) = [0, 1]
      end select
   end subroutine take_support

   !> Give every quantity its place in the state and in the discrete state.
   subroutine number_states(meshes, gearbox)
      type(mesh_input), intent(in) :: meshes(:)
      type(gearbox_t), intent(inout) :: gearbox
      integer :: i, j, n

      n = i_omega
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            wheel%i_speed = i_omega
            if (i == gearbox%reference) cycle
            wheel%i_psi = n + 1
            wheel%i_speed = n + 2
            n = n + 2
         end associate
      end do
      do i = 1, size(gearbox%wheels)
         do j = 1, gearbox%wheels(i)%support%n
            gearbox%wheels(i)%support%i_state(j) = n + 1
            n = n + 2
         end do
      end do
      do i = 1, size(meshes)
         if (meshes(i)%tracking == tracking_closed_form) cycle
         gearbox%meshes(i)%i_track = n + 1
         n = n + n_track
      end do
      if (gearbox%housing%is_mounted) then
         gearbox%housing%i_state = n + 1
         n = n + n_housing_states
      end if
      do i = 1, size(meshes)
         if (.not. is_rigid(meshes(i)%contact)) cycle
         n = n + 1
         gearbox%meshes(i)%i_normal = n
         gearbox%n_multipliers = gearbox%n_multipliers + 1
      end do
      gearbox%i_dissipated = n + 1
      gearbox%i_work = n + 2
      gearbox%n_states = n + 2

      n = 1
      do i = 1, size(meshes)
         gearbox%meshes(i)%i_mode = n + 1
         n = n + 3
      end do
      do i = 1, size(gearbox%loads)
         if (size(gearbox%loads(i)%time) == 0) cycle
         gearbox%loads(i)%i_segment = n + 1
         n = n + 1
      end do
      gearbox%n_integers = n
   end subroutine number_states

   !> Geometry, laws and couplings of one mesh; base and tip radii of its wheels.
   subroutine take_mesh(gearbox, wheels, given, layout, index, status)
      type(gearbox_t), intent(inout) :: gearbox
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: given
      type(layout_t), intent(in) :: layout
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status
      real(wp) :: compliance_a, compliance_b

      associate (mesh => gearbox%meshes(index), pair => gearbox%pairs(index), a => given%driving, b => given%driven)
         if (gearbox%gear_meshes(index)%exists) then
            call gear_pair_derive(gearbox%gears(a), gearbox%gears(b), gearbox%gear_meshes(index), layout%angle(index), &
                                  -given%driving_rotation, layout%centre(:, a), pair)
         else
            call spur_pair_derive(wheels(a)%teeth, wheels(b)%teeth, layout%pitch_radius(a), given%paper_rule, &
                                  given%pressure_angle, layout%angle(index), -given%driving_rotation, layout%centre(:, a), pair, &
                                  status)
            pair%has_coast = given%has_backlash
            pair%backlash = given%backlash
         end if
         if (has_failed(status)) then
            status%subject = subject_mesh
            status%index = index
            return
         end if
         call take_radii(gearbox, a, pair%base_radius_a, pair%tip_radius_a, index, status)
         call take_radii(gearbox, b, pair%base_radius_b, pair%tip_radius_b, index, status)
         if (has_failed(status)) return
         mesh%wheel_a = a
         mesh%wheel_b = b
         mesh%contact = given%contact
         mesh%rigid = is_rigid(given%contact)
         mesh%damping = given%damping
         mesh%friction = given%friction
         mesh%tracking = given%tracking
         compliance_a = (1 - wheels(a)%poisson_ratio**2)/wheels(a)%youngs_modulus
         compliance_b = (1 - wheels(b)%poisson_ratio**2)/wheels(b)%youngs_modulus
         mesh%e_star = 1/(compliance_a + compliance_b)
         mesh%mobility = pair%base_radius_a**2/gearbox%wheels(a)%inertia + pair%base_radius_b**2/gearbox%wheels(b)%inertia
         call take_overlap(wheels, a, b, mesh, status)
         if (has_failed(status)) return
         mesh%base_pitch = pair%base_pitch
         mesh%rho_start = pair%rho_start_a
         mesh%gap_apart = (pair%rho - pair%base_pitch)/4
         mesh%t_0 = pair%t
         mesh%e_0 = pair%e
         mesh%k_a0 = pair%point_k_a
         mesh%pair%sigma = real(pair%sigma, wp)
         mesh%pair%r_ba = pair%base_radius_a
         mesh%pair%r_bb = pair%base_radius_b
         mesh%pair%rho_0 = pair%rho
         mesh%pair%ratio_a = gearbox%wheels(a)%ratio
         mesh%pair%ratio_b = gearbox%wheels(b)%ratio
         mesh%pair%advance = -mesh%pair%sigma*mesh%pair%r_ba*mesh%pair%ratio_a
         mesh%pair%share_a = compliance_a*mesh%e_star
         mesh%pair%share_b = compliance_b*mesh%e_star
         mesh%pitches_per_turn = -pair%sigma*layout%turn(a)*wheels(gearbox%reference)%teeth
         if (.not. pair%contains_pitch_point) call warn(gearbox, index, "its path of contact does not contain the pitch point:" &
                                                        //" the teeth slide in one sense only")
         if (index > 1) call check_senses(gearbox, layout, given, index)
      end associate
      call link_states(gearbox, gearbox%meshes(index))
   end subroutine take_mesh

   !> The common width of two wheels is the overlap of their faces.
   subroutine take_overlap(wheels, a, b, mesh, status)
      type(wheel_input), intent(in) :: wheels(:)
      integer, intent(in) :: a, b
      type(mesh_t), intent(inout) :: mesh
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
      logical :: reached(size(gearbox%wheels)), used(size(gearbox%meshes))
      integer :: i, m

      reached = .false.
      used = .false.
      do i = 1, size(gearbox%wheels)
         if (gearbox%wheels(i)%prescribed > 0) call reach(i)
      end do
      if (.not. reached(gearbox%reference)) call reach(gearbox%reference)
      do i = 1, size(gearbox%wheels)
         if (.not. reached(i)) call reach(i)
      end do
      do m = 1, size(gearbox%meshes)
         if (.not. gearbox%meshes(m)%rigid .or. used(m) .or. has_failed(status)) cycle
         call fail(status, code_invalid_input, "a rigid contact that closes a ring of rigid contacts is overdetermined: give it" &
                   //" an elastic law", subject_mesh, m, "contact.law")
      end do

   contains

      !> Reach all wheels that rigid meshes join to the first one.
      subroutine reach(first)
         integer, intent(in) :: first
         logical :: group(size(gearbox%wheels)), found
         integer :: k

         group = .false.
         group(first) = .true.
         found = .true.
         do while (found)
            found = .false.
            do k = 1, size(gearbox%meshes)
               associate (mesh => gearbox%meshes(k), a => gearbox%meshes(k)%wheel_a, b => gearbox%meshes(k)%wheel_b)
                  if (.not. mesh%rigid .or. (group(a) .eqv. group(b))) cycle
                  associate (next => merge(b, a, group(a)))
                     if (gearbox%wheels(next)%prescribed > 0 .and. .not. has_failed(status)) &
                        call fail(status, code_invalid_input, "rigid contacts join two wheels whose speeds are prescribed: give" &
                                  //" this one an elastic law", subject_mesh, k, "contact.law")
                     mesh%i_dependent = gearbox%wheels(next)%i_psi
                  end associate
                  group([a, b]) = .true.
                  used(k) = .true.
                  found = .true.
               end associate
            end do
         end do
         reached = reached .or. group
      end subroutine reach

   end subroutine find_dependents

   !> The contact strip has to stay narrow beside the radii of curvature, which are smallest at the start of contact.
   !>
   !> Half width of two cylinders pressed together: sqrt(4 N rho_A rho_B/(pi E* (rho_A + rho_B))), Hertz.
   subroutine check_contact_width(gearbox, index)
      type(gearbox_t), intent(inout) :: gearbox
      integer, intent(in) :: index
      real(wp) :: half_width

      associate (mesh => gearbox%meshes(index), a => gearbox%pairs(index)%rho_start_a, b => gearbox%pairs(index)%rho_start_b)
         if (mesh%rigid) return
         half_width = sqrt(4*mesh%force_scale/mesh%width*a*b/(pi*mesh%e_star*(a + b)))
         if (half_width > narrow*min(a, b)) &
            call warn(gearbox, index, "under its load of about "//quantity(mesh%force_scale, "N")//" the contact strip is " &
                      //quantity(half_width, "m")//" wide to either side, more than a tenth of the smallest radius of" &
                      //" curvature "//quantity(min(a, b), "m")//": the force law is stretched")
      end associate
   end subroutine check_contact_width

   !> Whether the flank of a mesh fits the sense of rotation that the first mesh gives the wheels.
   subroutine check_senses(gearbox, layout, given, index)
      type(gearbox_t), intent(inout) :: gearbox
      type(layout_t), intent(in) :: layout
      type(mesh_input), intent(in) :: given
      integer, intent(in) :: index
      integer :: first

      first = -gearbox%pairs(1)%sigma*layout%turn(gearbox%meshes(1)%wheel_a)
      if (first*layout%turn(given%driving) /= given%driving_rotation) &
         call warn(gearbox, index, "its driving wheel turns against driving_rotation when the first mesh turns as it says")
   end subroutine check_senses

   !> A wheel has one base circle, whatever it meshes with.
   subroutine take_radii(gearbox, index, base_radius, tip_radius, mesh, status)
      type(gearbox_t), intent(inout) :: gearbox
      integer, intent(in) :: index, mesh
      real(wp), intent(in) :: base_radius, tip_radius !! from the mesh [m]
      type(status_t), intent(inout) :: status

      associate (wheel => gearbox%wheels(index))
         wheel%tip_radius = max(wheel%tip_radius, tip_radius)
         if (.not. wheel%base_radius > 0) wheel%base_radius = base_radius
         if (abs(wheel%base_radius - base_radius) <= agreement*base_radius) return
         call fail(status, code_invalid_input, "its pressure angle gives a wheel the base radius "//quantity(base_radius, "m") &
                   //", but another mesh gives the same wheel "//quantity(wheel%base_radius, "m")//": a wheel has one base" &
                   //" circle, so give the pressure angles", subject_mesh, mesh, "pressure_angle")
      end associate
   end subroutine take_radii

   !> Write a warning about a mesh down.
   subroutine warn(gearbox, mesh, text)
      type(gearbox_t), intent(inout) :: gearbox
      integer, intent(in) :: mesh !! from 1
      character(len=*), intent(in) :: text
      character(len=message_length) :: warning

      write (warning, "(a, i0, a)") "meshes.", mesh - 1, ": "//text
      gearbox%warnings = [character(len=message_length) :: gearbox%warnings, warning]
   end subroutine warn

   !> Local variables of a mesh in terms of the state.
   subroutine link_states(gearbox, mesh)
      type(gearbox_t), intent(in) :: gearbox
      type(mesh_t), intent(inout) :: mesh
      integer :: i

      mesh%links = [mesh_link(at_theta, i_theta, 1.0_wp), mesh_link(at_omega, i_omega, 1.0_wp)]
      call link_wheel(gearbox, mesh, mesh%wheel_a, at_psi_a, at_psi_dot_a, at_u_a, at_v_a)
      call link_wheel(gearbox, mesh, mesh%wheel_b, at_psi_b, at_psi_dot_b, at_u_b, at_v_b)
      if (mesh%i_normal > 0) mesh%links = [mesh%links, mesh_link(at_normal, mesh%i_normal, 1.0_wp)]
      if (mesh%i_track > 0) &
         mesh%links = [mesh%links, (mesh_link(at_track + i, mesh%i_track + i, 1.0_wp), i=0, n_track - 1)]
   end subroutine link_states

   !> One wheel's part of them.
   subroutine link_wheel(gearbox, mesh, index, at_psi, at_psi_dot, at_u, at_v)
      type(gearbox_t), intent(in) :: gearbox
      type(mesh_t), intent(inout) :: mesh
      integer, intent(in) :: index, at_psi, at_psi_dot, at_u, at_v
      real(wp) :: along(2)
      integer :: j

      associate (wheel => gearbox%wheels(index))
         if (wheel%i_psi > 0) mesh%links = [mesh%links, mesh_link(at_psi, wheel%i_psi, 1.0_wp), &
                                            mesh_link(at_psi_dot, wheel%i_psi + 1, 1.0_wp)]
         do j = 1, wheel%support%n
            along = [dot_product(wheel%support%direction(:, j), mesh%t_0), dot_product(wheel%support%direction(:, j), mesh%e_0)]
            associate (i => wheel%support%i_state(j))
               mesh%links = [mesh%links, mesh_link(at_u, i, along(1)), mesh_link(at_u + 1, i, along(2)), &
                             mesh_link(at_v, i + 1, along(1)), mesh_link(at_v + 1, i + 1, along(2))]
            end associate
         end do
      end associate
   end subroutine link_wheel

end module evl_gearbox_build
