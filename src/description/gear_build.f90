!> Creation of the gears defined by a basic rack, and of their meshes, from the description.
module evl_gear_build
   use evl_gear, only: agreement, gear_t, thin_tip
   use evl_gear_derivation, only: gear_derive
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_description, only: mesh_input, read_description, wheel_input
   use evl_gears_in_mesh, only: gear_mesh_derive, gear_mesh_geometry, gear_mesh_input, gear_mesh_overlap, gear_mesh_t
   use evl_kinds, only: wp
   use evl_parameter_view, only: description_t, parameter_view_t
   use evl_ring_interference, only: check_cutter, trimming_angle
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t, subject_mesh, subject_wheel, warn
   implicit none (type, external)
   private

   public :: gearbox_sketch, gears_build

   real(wp), parameter :: rounded_data = 0.5e-6_wp !! tooth overlap that rounded catalogue data can explain [m]

contains

   !> Compute all gears and meshes, and append warnings. Wheels and meshes without a basic rack get initial values.
   !>
   !> Errors: code_invalid_input with subject, index and field.
   subroutine gears_build(wheels, meshes, gears, gear_meshes, warnings, status)
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: meshes(:)
      type(gear_t), intent(out) :: gears(size(wheels))
      type(gear_mesh_t), intent(out) :: gear_meshes(size(meshes))
      type(status_t), allocatable, intent(inout) :: warnings(:) !! new warnings are appended
      type(status_t), intent(inout) :: status
      real(wp) :: overlaps(size(meshes))
      integer :: i

      do i = 1, size(wheels)
         if (.not. wheels(i)%is_gear) cycle
         call gear_derive(wheels(i)%parameter_view_t, gears(i), status)
         if (.not. has_failed(status)) call check_pitch_radius(wheels(i), gears(i), status)
         if (.not. has_failed(status) .and. gears(i)%cutter_teeth > 0) call check_cutter(gears(i), status)
         if (has_failed(status)) then
            status%index = i
            return
         end if
      end do
      do i = 1, size(meshes)
         call remove_overlap(wheels, meshes(i), gears, overlaps(i))
      end do
      do i = 1, size(wheels)
         if (gears(i)%tip_thickness < thin_tip*gears(i)%normal_module) &
            call warn(warnings, "the tooth is "//quantity(gears(i)%tip_thickness, "m")//" thick on the tip circle, less than " &
                      //quantity(thin_tip, "")//" modules: such a tip breaks easily", subject_wheel, i)
      end do
      do i = 1, size(meshes)
         call build_mesh(wheels, gears, meshes(i), gear_meshes(i), status)
         if (has_failed(status)) then
            status%subject = subject_mesh
            status%index = i
            return
         end if
         if (overlaps(i) > 0) &
            call warn(warnings, "at its centre distance the normal backlash would be "//quantity(-overlaps(i), "m") &
                      //", as rounded data give it: it is taken as 0, and the thickness_allowance of the driven wheel as " &
                      //quantity(gears(meshes(i)%driven)%thickness_allowance, "m"), subject_mesh, i)
         if (gear_meshes(i)%exists .and. gear_meshes(i)%contact_ratio < 1) &
            call warn(warnings, "its contact ratio is "//quantity(gear_meshes(i)%contact_ratio, "")//", less than 1: contact is" &
                      //" lost in every pitch", subject_mesh, i)
         call warn_of_trimming(gears(meshes(i)%driving), gears(meshes(i)%driven), gear_meshes(i), i, warnings)
         if (is_shortened(gear_meshes(i))) call warn_of_undercut(gears, meshes(i), gear_meshes(i), i, warnings)
      end do
   end subroutine gears_build

   !> Compute only the gears and their meshes, from a description that may be invalid. Other parts of the gearbox are not set.
   subroutine gearbox_sketch(description, gearbox)
      type(description_t), target, intent(in) :: description !! checked
      type(gearbox_t), intent(out) :: gearbox
      type(parameter_view_t) :: root
      type(wheel_input), allocatable :: wheels(:)
      type(mesh_input), allocatable :: meshes(:)
      type(status_t) :: status

      call root%all_of(description)
      call read_description(root, wheels, meshes, gearbox%shafts, status)
      allocate (gearbox%gears(size(wheels)), gearbox%gear_meshes(size(meshes)))
      if (.not. has_failed(status)) call gears_sketch(wheels, meshes, gearbox%gears, gearbox%gear_meshes)
   end subroutine gearbox_sketch

   !> Geometry of all valid gears and of all meshes with a working pressure angle, whether they can mesh or not. Others get initial
   !> values.
   subroutine gears_sketch(wheels, meshes, gears, gear_meshes)
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: meshes(:)
      type(gear_t), intent(out) :: gears(size(wheels))
      type(gear_mesh_t), intent(out) :: gear_meshes(size(meshes))
      type(status_t) :: ignored
      integer :: i

      do i = 1, size(wheels)
         if (wheels(i)%is_gear .and. wheels(i)%teeth > 0) call gear_derive(wheels(i)%parameter_view_t, gears(i), ignored)
      end do
      do i = 1, size(meshes)
         associate (a => meshes(i)%driving, b => meshes(i)%driven)
            if (all(gears([a, b])%teeth > 0)) call gear_mesh_geometry(gears(a), gears(b), distances_of(meshes(i)), gear_meshes(i), &
                                                                      ignored)
         end associate
      end do
   end subroutine gears_sketch

   !> Whether undercut shortens the path of contact of a mesh.
   pure logical function is_shortened(mesh)
      type(gear_mesh_t), intent(in) :: mesh

      is_shortened = mesh%rho_end_a < mesh%rho_tip_a .or. mesh%rho_end_b < mesh%rho_tip_b
   end function is_shortened

   !> Warn that an internal pair cannot be assembled in the radial direction.
   subroutine warn_of_trimming(a, b, mesh, index, warnings)
      type(gear_t), intent(in) :: a, b
      type(gear_mesh_t), intent(in) :: mesh
      integer, intent(in) :: index
      type(status_t), allocatable, intent(inout) :: warnings(:)
      type(gear_t) :: pinion, ring

      if (.not. (a%is_internal .or. b%is_internal)) return
      pinion = a
      ring = b
      if (a%is_internal) then
         pinion = b
         ring = a
      end if
      if (trimming_angle(int(pinion%teeth), real(pinion%tip_radius, wp), real(pinion%base_radius, wp), ring, &
                         real(mesh%working_pressure_angle, wp)) < 0) &
         call warn(warnings, "the inner wheel cannot be put into the internal gear in the radial direction (trimming); put it in" &
                   //" axially", subject_mesh, index)
   end subroutine warn_of_trimming

   !> Warn that undercut shortens the path of contact, with the amounts.
   subroutine warn_of_undercut(gears, input, mesh, index, warnings)
      type(gear_t), intent(in) :: gears(:)
      type(mesh_input), intent(in) :: input
      type(gear_mesh_t), intent(in) :: mesh
      integer, intent(in) :: index
      type(status_t), allocatable, intent(inout) :: warnings(:)
      character(len=:), allocatable :: which
      real(wp) :: full

      full = mesh%rho_tip_a + mesh%rho_tip_b - mesh%line_of_action
      which = "both wheels"
      if (.not. mesh%rho_end_a < mesh%rho_tip_a) which = "the driving wheel"
      if (.not. mesh%rho_end_b < mesh%rho_tip_b) which = "the driven wheel"
      associate (a => gears(input%driving), b => gears(input%driven))
         call warn(warnings, "undercut of "//which//" shortens its path of contact from "//quantity(full, "m")//" to " &
                   //quantity(mesh%path_of_contact, "m")//", the contact ratio from "//quantity(full/mesh%base_pitch, "")//" to " &
                   //quantity(mesh%contact_ratio, "")//": the involutes begin at the form diameters " &
                   //quantity(2*a%form_radius, "m")//" and "//quantity(2*b%form_radius, "m"), subject_mesh, index)
      end associate
   end subroutine warn_of_undercut

   !> Reject undercut with compliant teeth or tip edges: they would touch the corner at the form circle, which is not modelled.
   subroutine check_undercut(wheels, input, mesh, status)
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: input
      type(gear_mesh_t), intent(in) :: mesh
      type(status_t), intent(inout) :: status
      character(len=*), parameter :: why = "undercut shortens the path of contact, and the corner that it leaves on the form" &
                                     //" circle, which the mate's flank would touch, is not modelled: "

      if (has_failed(status) .or. .not. is_shortened(mesh)) return
      if (input%word("edge_contact") == "true") then
         call refuse(status, "edge_contact", why//"give false, or larger profile shifts")
      else if (any([is_compliant(wheels(input%driving)), is_compliant(wheels(input%driven))])) then
         call refuse(status, "", why//"leave 'compliance' out of its wheels, or give larger profile shifts")
      end if
   end subroutine check_undercut

   !> Reject what is not available for an internal pair.
   subroutine check_internal(wheels, input, status)
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: input
      type(status_t), intent(inout) :: status
      integer :: k, w

      if (has_failed(status)) return
      if (input%word("edge_contact") == "true") then
         call refuse(status, "edge_contact", "contact of tip edges is not available for an internal pair; give false")
         return
      end if
      do k = 1, 2
         w = merge(input%driving, input%driven, k == 1)
         if (is_compliant(wheels(w))) then
            call refuse(status, "", "compliant teeth are not available for an internal pair: leave 'compliance' out of the" &
                        //" wheel '"//trim(wheels(w)%word("name"))//"'")
            return
         end if
      end do
   end subroutine check_internal

   !> Whether a wheel is compliant.
   logical function is_compliant(wheel)
      type(wheel_input), intent(in) :: wheel
      type(parameter_view_t) :: block

      is_compliant = wheel%has("compliance")
      if (.not. is_compliant) return
      call wheel%inner("compliance", block)
      is_compliant = block%word("model") /= "none"
   end function is_compliant

   !> If the teeth of a mesh overlap by no more than rounding of the data can explain, make the teeth of its driven gear thinner.
   !> Other meshes of this gear get the corresponding backlash.
   subroutine remove_overlap(wheels, mesh, gears, overlap)
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: mesh
      type(gear_t), intent(inout) :: gears(:)
      real(wp), intent(out) :: overlap !! overlap removed from the driven gear; 0 if unchanged [m]
      type(gear_t) :: thinner
      type(status_t) :: status

      overlap = 0
      associate (a => mesh%driving, b => mesh%driven)
         if (.not. (wheels(a)%is_gear .and. wheels(b)%is_gear .and. mesh%has("centre_distance"))) return
         overlap = gear_mesh_overlap(gears(a), gears(b), mesh%number("centre_distance"))
         if (overlap > 0 .and. overlap <= rounded_data) then
            call gear_derive(wheels(b)%parameter_view_t, thinner, status, thinner_by(gears(b), overlap))
            if (.not. has_failed(status)) then
               gears(b) = thinner
               return
            end if
         end if
      end associate
      overlap = 0
   end subroutine remove_overlap

   !> Thickness allowance of a gear whose teeth are made thinner by an arc of its base circle [m].
   pure real(wp) function thinner_by(gear, arc) result(allowance)
      type(gear_t), intent(in) :: gear
      real(wp), intent(in) :: arc !! [m]

      allowance = gear%thickness_allowance - arc/cos(gear%pressure_angle)
   end function thinner_by

   !> Append a remedy to the error of a centre distance with tooth overlap: the thickness allowance of the driven wheel that fits,
   !> with enough digits. No change if such a wheel is not possible.
   subroutine name_remedy(driven, a, b, input, status)
      type(wheel_input), intent(in) :: driven
      type(gear_t), intent(in) :: a, b
      type(gear_mesh_input), intent(in) :: input
      type(status_t), intent(inout) :: status
      type(gear_t) :: thinner
      type(gear_mesh_t) :: mesh
      type(status_t) :: trial
      real(wp) :: overlap, allowance, digit

      overlap = 0
      if (input%has_centre_distance) overlap = gear_mesh_overlap(a, b, input%centre_distance)
      if (.not. overlap > 0) return
      allowance = thinner_by(b, overlap)
      digit = 10.0_wp**(floor(log10(-allowance)) - 5) ! last of six digits, as in messages
      allowance = -ceiling(-allowance/digit)*digit
      call gear_derive(driven%parameter_view_t, thinner, trial, allowance)
      if (.not. has_failed(trial)) call gear_mesh_derive(a, thinner, input, mesh, trial)
      if (.not. has_failed(trial)) &
         status%message = trim(status%message)//"; or teeth of the driven wheel with thickness_allowance "//quantity(allowance, "m")
   end subroutine name_remedy

   !> Mesh of two gears with basic racks, if they are; a mesh of one such gear with another wheel is rejected.
   subroutine build_mesh(wheels, gears, input, mesh, status)
      type(wheel_input), intent(in) :: wheels(:)
      type(gear_t), intent(in) :: gears(:)
      type(mesh_input), intent(in) :: input
      type(gear_mesh_t), intent(inout) :: mesh
      type(status_t), intent(inout) :: status
      type(gear_mesh_input) :: distances

      associate (a => input%driving, b => input%driven)
         if (wheels(a)%is_gear .neqv. wheels(b)%is_gear) then
            call refuse(status, "", "one of its wheels has a module and the other has none; give both a module, or none of them" &
                        //" and the mesh a pressure angle")
         else if (.not. wheels(a)%is_gear .and. input%has("centre_distance")) then
            call refuse(status, "centre_distance", "a centre distance is for two wheels with a module; the pitch radii of" &
                        //" these give theirs")
         else if (wheels(a)%is_gear .and. input%has("pressure_angle")) then
            call refuse(status, "pressure_angle", "a pressure angle of the mesh is for wheels without module; the working" &
                        //" pressure angle of these follows from their centre distance")
         else if (.not. (wheels(a)%is_gear .or. input%has("pressure_angle"))) then
            call refuse(status, "pressure_angle", "is missing (working pressure angle [deg] or paper_rule), or else the 'module'" &
                        //" of both wheels")
         else if (wheels(a)%is_gear) then
            distances = distances_of(input)
            call gear_mesh_derive(gears(a), gears(b), distances, mesh, status)
            if (has_failed(status)) call name_remedy(wheels(b), gears(a), gears(b), distances, status)
            call check_undercut(wheels, input, mesh, status)
            if (gears(a)%is_internal .or. gears(b)%is_internal) call check_internal(wheels, input, status)
         end if
      end associate
   end subroutine build_mesh

   !> Centre distance and backlash given for a mesh.
   type(gear_mesh_input) function distances_of(mesh) result(distances)
      type(mesh_input), intent(in) :: mesh

      distances = gear_mesh_input(mesh%has("centre_distance"), mesh%has("backlash"), mesh%number("centre_distance"), &
                                  mesh%number("backlash"))
   end function distances_of

   !> Check that a pitch radius given together with a module equals the reference radius.
   subroutine check_pitch_radius(wheel, gear, status)
      type(wheel_input), intent(in) :: wheel
      type(gear_t), intent(in) :: gear
      type(status_t), intent(inout) :: status
      real(wp) :: pitch_radius

      pitch_radius = wheel%number("pitch_radius")
      if (.not. wheel%has("pitch_radius")) return
      if (abs(pitch_radius - abs(gear%reference_radius)) <= agreement*pitch_radius) return
      call fail(status, code_invalid_input, "pitch radius "//quantity(pitch_radius, "m")//" does not agree with the" &
                //" reference radius "//quantity(abs(gear%reference_radius), "m")//", which teeth and module give", subject_wheel, &
                field="pitch_radius")
   end subroutine check_pitch_radius

   !> Report an invalid parameter of a mesh.
   pure subroutine refuse(status, field, message)
      type(status_t), intent(inout) :: status
      character(len=*), intent(in) :: field, message

      call fail(status, code_invalid_input, message, subject_mesh, field=field)
   end subroutine refuse

end module evl_gear_build
