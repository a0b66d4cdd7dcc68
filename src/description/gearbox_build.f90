!> Creation of a gearbox from its description: validation, layout, geometry, and numbering of the states.
module evl_gearbox_build
   use evl_compliance_description, only: compliance_create
   use evl_compliant_mesh, only: check_compliant_mesh
   use evl_contact_build, only: find_dependents, list_contacts, take_contact
   use evl_first_tooth_pair, only: find_tooth_phases, tooth_mesh_t
   use evl_gear_build, only: gears_build
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_description, only: mesh_input, read_description, wheel_input
   use evl_gearbox_deviations, only: check_second_order, gearbox_set_deviations
   use evl_gearbox_numbering, only: number_modes, number_states
   use evl_gearbox_references, only: gearbox_set_references
   use evl_gearbox_scaling, only: gearbox_set_scales
   use evl_gearbox_warnings, only: check_contact_width, warn_of_tooth_errors
   use evl_gears_in_mesh, only: gear_pair_derive
   use evl_housing_description, only: housing_create
   use evl_influence_store, only: influence_store_t
   use evl_kinds, only: pi, wp
   use evl_mesh_geometry, only: spur_pair_derive
   use evl_nominal_point, only: gearbox_set_nominal
   use evl_output_list, only: set_output_offsets
   use evl_parameter_view, only: description_t, parameter_view_t
   use evl_parts_build, only: loads_build, support_build
   use evl_rational, only: rational_value
   use evl_rotors, only: rotors_join
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t, subject_mesh, subject_wheel, warn
   use evl_tooth_contact, only: tracking_closed_form
   use evl_train_layout, only: layout_resolve, layout_t
   implicit none (type, external)
   private

   public :: gearbox_create

   real(wp), parameter :: agreement = 1.0e-9_wp !! relative: base radii of one wheel from two meshes must agree to this

contains

   !> Create a gearbox.
   !> Errors: code_invalid_input with subject, index and field; those of the store.
   subroutine gearbox_create(description, store, gearbox, status)
      type(description_t), target, intent(in) :: description !! checked
      class(influence_store_t), intent(inout) :: store !! cache of compliant wheels
      type(gearbox_t), intent(out) :: gearbox
      type(status_t), intent(inout) :: status
      type(parameter_view_t) :: root
      type(wheel_input), allocatable :: wheels(:)
      type(mesh_input), allocatable :: meshes(:)
      type(layout_t) :: layout
      integer :: i

      call root%all_of(description)
      call read_description(root, wheels, meshes, gearbox%shafts, status)
      if (.not. has_failed(status)) call housing_create(root, gearbox%housing, status)
      if (has_failed(status)) return
      allocate (gearbox%wheels(size(wheels)), gearbox%pairs(size(meshes)))
      allocate (gearbox%warnings(0))
      call loads_build(wheels, gearbox%loads, status)
      if (.not. has_failed(status)) call rotors_join(gearbox, status)
      if (has_failed(status)) return
      allocate (gearbox%gears(size(wheels)), gearbox%gear_meshes(size(meshes)))
      call gears_build(wheels, meshes, gearbox%gears, gearbox%gear_meshes, gearbox%warnings, status)
      if (has_failed(status)) return
      call start_layout(wheels, meshes, gearbox, layout)
      call layout_resolve(layout, gearbox%reference, status)
      if (has_failed(status)) return
      call take_wheels(wheels, layout, gearbox, status)
      gearbox%housing%acts = gearbox%housing%acts .or. any(gearbox%wheels%support%moves)
      if (has_failed(status)) return
      do i = 1, size(wheels)
         gearbox%wheels(i)%rotor_inertia = sum(gearbox%wheels%inertia, mask=gearbox%wheels%leader == gearbox%wheels(i)%leader)
         gearbox%wheels(i)%per_inertia = 1/gearbox%wheels(i)%rotor_inertia
      end do
      do i = 1, size(wheels)
         allocate (gearbox%wheels(i)%loads(0))
      end do
      allocate (gearbox%losses(0))
      do i = 1, size(gearbox%loads)
         if (gearbox%loads(i)%load%is_loss) gearbox%losses = [gearbox%losses, i]
         associate (wheel => gearbox%wheels(gearbox%loads(i)%load%wheel))
            wheel%loads = [wheel%loads, i]
         end associate
      end do
      do i = 1, size(meshes)
         call take_pair(gearbox, wheels, meshes, layout, i, status)
         if (has_failed(status)) return
      end do
      call set_tooth_phases(meshes, gearbox, status)
      if (.not. has_failed(status)) call gearbox_set_deviations(gearbox, wheels, meshes, status)
      if (.not. has_failed(status)) call take_compliances(wheels, meshes, store, gearbox, status)
      if (has_failed(status)) return
      call list_contacts(gearbox, wheels, meshes)
      call number_states(gearbox)
      do i = 1, size(gearbox%contacts)
         call take_contact(gearbox, wheels, meshes(gearbox%contacts(i)%mesh), i, status)
         if (has_failed(status)) return
      end do
      call number_modes(gearbox)
      call find_dependents(gearbox, status)
      if (has_failed(status)) return
      call gearbox_set_nominal(gearbox)
      call gearbox_set_scales(gearbox, status)
      if (.not. has_failed(status)) call gearbox_set_references(gearbox, status)
      if (has_failed(status)) return
      do i = 1, size(meshes)
         call check_contact_width(gearbox, i)
         call check_second_order(gearbox, i)
      end do
      call warn_of_tooth_errors(gearbox)
      call set_output_offsets(gearbox)
   end subroutine gearbox_create

   !> Compliance of the wheels; identical wheels are computed once.
   subroutine take_compliances(wheels, meshes, store, gearbox, status)
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: meshes(:)
      class(influence_store_t), intent(inout) :: store
      type(gearbox_t), intent(inout) :: gearbox
      type(status_t), intent(inout) :: status
      integer :: i, n_before

      allocate (gearbox%compliances(size(wheels)))
      do i = 1, size(wheels)
         n_before = size(gearbox%warnings)
         call compliance_create(wheels(i)%parameter_view_t, wheels(i)%material, gearbox%gears(i), store, gearbox%compliances(i), &
                                gearbox%warnings, status)
         gearbox%warnings(n_before + 1:)%index = i
         if (.not. has_failed(status)) cycle
         status%index = i
         return
      end do
      do i = 1, size(meshes)
         call check_compliant_mesh(gearbox, wheels, meshes(i), i, status)
         if (has_failed(status)) return
      end do
   end subroutine take_compliances

   !> Layout data given in the description.
   subroutine start_layout(wheels, meshes, gearbox, layout)
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: meshes(:)
      type(gearbox_t), intent(in) :: gearbox !! including its gears and shafts
      type(layout_t), intent(out) :: layout
      integer :: i

      layout%teeth = wheels%side*wheels%teeth
      layout%has_radius = [(wheels(i)%is_gear .or. wheels(i)%has("pitch_radius") .or. wheels(i)%teeth == 0, i=1, size(wheels))]
      layout%has_centre = [(wheels(i)%has("centre"), i=1, size(wheels))]
      allocate (layout%pitch_radius(size(wheels)), layout%centre(2, size(wheels)), source=0.0_wp)
      do i = 1, size(wheels)
         if (layout%has_centre(i)) layout%centre(:, i) = wheels(i)%numbers("centre")
         if (wheels(i)%is_gear) then
            layout%pitch_radius(i) = gearbox%gears(i)%reference_radius
         else if (wheels(i)%teeth > 0) then
            if (layout%has_radius(i)) layout%pitch_radius(i) = wheels(i)%number("pitch_radius")
         else if (wheels(i)%has("radius")) then
            layout%pitch_radius(i) = wheels(i)%number("radius")
         else ! radius of a solid disc with this mass and inertia
            layout%pitch_radius(i) = sqrt(2*wheels(i)%number("inertia")/wheels(i)%number("mass"))
         end if
      end do
      layout%driving = meshes%driving
      layout%driven = meshes%driven
      layout%has_angle = [(meshes(i)%has("centre_line_angle"), i=1, size(meshes))]
      layout%angle = [(merge(meshes(i)%number("centre_line_angle"), 0.0_wp, layout%has_angle(i)), i=1, size(meshes))]
      layout%has_distance = gearbox%gear_meshes%exists
      layout%distance = gearbox%gear_meshes%centre_distance
      layout%shaft_a = gearbox%shafts%wheel_a
      layout%shaft_b = gearbox%shafts%wheel_b
   end subroutine start_layout

   !> Mass, inertia, support and speed ratio of every wheel. Unless mass and inertia are given, the wheel is a solid disc with the
   !> pitch radius and, if it has a basic rack, the bore. Equation T73.
   subroutine take_wheels(wheels, layout, gearbox, status)
      type(wheel_input), intent(in) :: wheels(:)
      type(layout_t), intent(in) :: layout
      type(gearbox_t), intent(inout) :: gearbox
      type(status_t), intent(inout) :: status
      type(parameter_view_t) :: accuracy, support
      real(wp) :: edge
      integer :: i

      do i = 1, size(wheels)
         associate (wheel => gearbox%wheels(i), input => wheels(i))
            wheel%teeth = input%teeth
            wheel%has_radius = input%teeth > 0 .or. input%has("radius")
            wheel%pitch_radius = layout%pitch_radius(i)
            wheel%centre = layout%centre(:, i)
            wheel%exact_ratio = layout%ratio(i)
            wheel%ratio = rational_value(layout%ratio(i))
            wheel%width = input%number("width")
            wheel%density = input%material%number("density")
            edge = merge(real(gearbox%gears(i)%rim_radius, wp), real(gearbox%gears(i)%bore_radius, wp), input%side < 0)
            wheel%mass = wheel%density*pi*(input%side*(wheel%pitch_radius**2 - edge**2))*wheel%width
            if (input%has("mass")) wheel%mass = input%number("mass")
            wheel%inertia = wheel%mass*(wheel%pitch_radius**2 + edge**2)/2
            if (input%side < 0 .and. .not. (abs(edge) > 0 .or. input%has("mass") .and. input%has("inertia"))) then
               call fail(status, code_invalid_input, "an internal gear needs its outer diameter, rim_diameter, or both mass and" &
                         //" inertia", subject_wheel, i, "rim_diameter")
               return
            end if
            if (input%has("inertia")) wheel%inertia = input%number("inertia")
            wheel%axial_position = input%number("axial_position")
            if (input%is_gear .and. input%has("accuracy")) then
               call input%inner("accuracy", accuracy)
               wheel%tolerance_class = accuracy%whole("class")
            end if
            call take_transverse(input, i, wheel%mass, wheel%inertia, wheel%transverse_inertia, status)
            call input%inner("support", support)
            call support_build(support, i, wheel%mass, wheel%support, status)
         end associate
      end do
   end subroutine take_wheels

   !> Inertia about a diameter: given, or that of an axisymmetric body with constant cross-section over its width, such as a disc or
   !> ring. Equation H14.
   subroutine take_transverse(input, index, mass, inertia, transverse_inertia, status)
      type(wheel_input), intent(in) :: input
      integer, intent(in) :: index
      real(wp), intent(in) :: mass, inertia         !! [kg], [kg m^2]
      real(wp), intent(out) :: transverse_inertia   !! [kg m^2]
      type(status_t), intent(inout) :: status

      transverse_inertia = inertia/2 + mass*input%number("width")**2/12
      if (.not. input%has("transverse_inertia")) return
      transverse_inertia = input%number("transverse_inertia")
      if (transverse_inertia >= inertia/2*(1 - agreement)) return
      call fail(status, code_invalid_input, "transverse_inertia "//quantity(transverse_inertia, "kg m^2")//" is less than half" &
                //" the moment of inertia about the axle "//quantity(inertia, "kg m^2")//", which no body has", subject_wheel, &
                index, "transverse_inertia")
   end subroutine take_transverse

   !> Geometry of one mesh; base and tip radii of its wheels. Equation I8.
   subroutine take_pair(gearbox, wheels, meshes, layout, index, status)
      type(gearbox_t), intent(inout) :: gearbox
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: meshes(:)
      type(layout_t), intent(in) :: layout
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status

      associate (pair => gearbox%pairs(index), input => meshes(index), a => meshes(index)%driving, b => meshes(index)%driven)
         if (gearbox%gear_meshes(index)%exists) then
            call gear_pair_derive(gearbox%gears(a), gearbox%gears(b), gearbox%gear_meshes(index), layout%angle(index), &
                                  -wheels(a)%side*input%driving_rotation, layout%centre(:, a), pair)
         else
            call spur_pair_derive(wheels(a)%teeth, wheels(b)%teeth, layout%pitch_radius(a), &
                                  input%word("pressure_angle") == "paper_rule", input%number("pressure_angle"), &
                                  layout%angle(index), -input%driving_rotation, layout%centre(:, a), pair, status)
            pair%has_coast = input%has("backlash")
            if (pair%has_coast) pair%backlash = input%number("backlash")
         end if
         if (has_failed(status)) then
            status%subject = subject_mesh
            status%index = index
            return
         end if
         call take_radii(gearbox, a, pair%base_radius_a, pair%tip_radius_a, index, status)
         call take_radii(gearbox, b, pair%base_radius_b, pair%tip_radius_b, index, status)
         if (has_failed(status)) return
         if (.not. pair%contains_pitch_point) call warn(gearbox%warnings, "its path of contact does not contain the pitch" &
                                                        //" point: the teeth slide in one sense only", subject_mesh, index)
         if (index > 1) call check_senses(gearbox, layout, meshes(1), input, index)
      end associate
   end subroutine take_pair

   !> Position of the first tooth pair of each mesh.
   subroutine set_tooth_phases(meshes, gearbox, status)
      type(mesh_input), intent(in) :: meshes(:)
      type(gearbox_t), intent(inout) :: gearbox
      type(status_t), intent(inout) :: status
      type(tooth_mesh_t) :: teeth(size(meshes))
      real(wp) :: tooth_angle(size(gearbox%wheels))
      integer :: m

      tooth_angle = 0
      do m = 1, size(meshes)
         associate (pair => gearbox%pairs(m), a => meshes(m)%driving, b => meshes(m)%driven)
            teeth(m) = tooth_mesh_t(a, b, pair%sigma, pair%chi, pair%alpha_w, pair%rho, pair%base_pitch, pair%rho_start_a, &
                                    pair%backlash)
            tooth_angle([a, b]) = [pair%tooth_angle_a, pair%tooth_angle_b]
         end associate
      end do
      allocate (gearbox%phases(size(meshes)))
      call find_tooth_phases(gearbox%wheels%base_radius, tooth_angle, gearbox%wheels%teeth, teeth, gearbox%phases, status)
      if (has_failed(status)) return
      m = findloc(gearbox%phases%gap > 0 .and. meshes%tracking /= tracking_closed_form, .true., dim=1)
      if (m > 0) call fail(status, code_invalid_input, "its flanks start with a gap of "//quantity(gearbox%phases(m)%gap, "m") &
                           //", which the teeth around the loop leave: only closed_form carries it", subject_mesh, m, "tracking")
   end subroutine set_tooth_phases

   !> Warn if the flank of a mesh does not match the sense of rotation that follows from the first mesh.
   subroutine check_senses(gearbox, layout, first_mesh, input, index)
      type(gearbox_t), intent(inout) :: gearbox
      type(layout_t), intent(in) :: layout
      type(mesh_input), intent(in) :: first_mesh, input
      integer, intent(in) :: index
      integer :: first

      first = first_mesh%driving_rotation*turn(first_mesh%driving)
      if (first*turn(input%driving) /= input%driving_rotation) &
         call warn(gearbox%warnings, "its driving wheel turns against driving_rotation if the first mesh turns in its own", &
                   subject_mesh, index)

   contains

      !> +1 if a wheel rotates in the sense of the reference wheel, -1 if opposite.
      pure integer function turn(wheel)
         integer, intent(in) :: wheel

         turn = merge(1, -1, layout%ratio(wheel)%above > 0)
      end function turn

   end subroutine check_senses

   !> Set the radii of a wheel; all its meshes must give the same base circle.
   subroutine take_radii(gearbox, index, base_radius, tip_radius, mesh, status)
      type(gearbox_t), intent(inout) :: gearbox
      integer, intent(in) :: index, mesh
      real(wp), intent(in) :: base_radius, tip_radius !! from the mesh [m]
      type(status_t), intent(inout) :: status

      associate (wheel => gearbox%wheels(index))
         if (.not. abs(wheel%tip_radius) > abs(tip_radius)) wheel%tip_radius = tip_radius
         if (.not. abs(wheel%base_radius) > 0) wheel%base_radius = base_radius
         if (abs(wheel%base_radius - base_radius) <= agreement*abs(base_radius)) return
         call fail(status, code_invalid_input, "its pressure angle gives a wheel the base radius "//quantity(base_radius, "m") &
                   //", but another mesh gives the same wheel "//quantity(wheel%base_radius, "m")//": a wheel has one base" &
                   //" circle, so give the pressure angles", subject_mesh, mesh, "pressure_angle")
      end associate
   end subroutine take_radii

end module evl_gearbox_build
