!> Description of a gearbox: wheels, meshes and shafts, their case parameters, and their validation.
module evl_gearbox_description
   use evl_damping_law, only: damping_law_t
   use evl_deviation_description, only: deviation_rows
   use evl_elastic_law, only: elastic_law_t
   use evl_force_law, only: force_law_t
   use evl_friction_law, only: friction_law_t
   use evl_gear, only: gear_rows
   use evl_kind_finder, only: kind_finder
   use evl_kinds, only: wp
   use evl_law_table, only: damping_law, elastic_law, friction_law
   use evl_lubricated_friction, only: lubricated_friction_t
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: kind_t, not_negative, positive, range_t, row_t, short_length, span_t, type_block, type_choice, type_integer, &
                      type_list, type_name, type_number, type_pair, type_reference
   use evl_shaft, only: shaft_t
   use evl_status, only: code_invalid_input, fail, has_failed, message_length, status_t, subject_mesh, subject_none, &
                         subject_shaft, subject_wheel
   use evl_tooth_contact, only: tracking_algebraic, tracking_closed_form, tracking_differential
   implicit none (type, external)
   private

   public :: lubricant_number, mesh_input, read_description, wheel_input

   type(row_t), parameter, public :: &
      wheel_rows(*) = [ &
      row_t("name", type_name, "", "name in references, paths and the history", required=.true.), &
      row_t("teeth", type_integer, "", "number of teeth z; a wheel without teeth is a disc on a shaft", &
            range=range_t(3.0_wp, 10000.0_wp)), &
      row_t("pitch_radius", type_number, "m", &
            "pitch radius r; if not given, it follows from a mesh, or from the reference diameter of a gear with a module", &
            range=positive, &
            plausible=span_t(1.0e-4_wp, 2.5_wp)), &
      gear_rows, &
      deviation_rows, &
      row_t("compliance", type_block, "", "compliance of teeth and wheel body; without it only the contact is compliant", &
            holds="compliance", &
            variants="+module"), &
      row_t("width", type_number, "m", "face width", range=positive, required=.true., plausible=span_t(1.0e-5_wp, 1.0_wp)), &
      row_t("centre", type_pair, "m", "reference position of the axle; if not given, it follows from a mesh", &
            plausible=span_t(0.0_wp, 20.0_wp)), &
      row_t("material", type_reference, "", "name of the material", required=.true., holds="materials"), &
      row_t("inertia", type_number, "kg m2", &
            "moment of inertia about the axle; if not given, that of a disc with the pitch radius and the bore, of an internal" &
            //" gear that of the rim", range=positive, &
            plausible=span_t(1.0e-12_wp, 1.0e4_wp)), &
      row_t("mass", type_number, "kg", "mass; if not given, that of a disc with the pitch radius and the bore, of an internal" &
            //" gear that of the rim between pitch radius and rim_diameter", range=positive, &
            plausible=span_t(1.0e-7_wp, 5000.0_wp)), &
      row_t("transverse_inertia", type_number, "kg m2", &
            "moment of inertia about a diameter; if not given, that of a disc or ring with the same mass and inertia", &
            range=positive, &
            plausible=span_t(1.0e-12_wp, 1.0e4_wp)), &
      row_t("axial_position", type_number, "m", "axial position z of the middle of the face width; the face widths of wheels in" &
            //" mesh must overlap", &
            default="0", plausible=span_t(0.0_wp, 20.0_wp)), &
      row_t("support", type_block, "", "support of the axle", default="{kind: fixed}", holds="support"), &
      row_t("loads", type_list, "", "loads on the wheel; their torques add up", range=range_t(0.0_wp, 100.0_wp), default="[]", &
            holds="load"), &
      row_t("radius", type_number, "m", "radius of a disc; used for mass and inertia if these are not given", range=positive, &
            plausible=span_t(1.0e-4_wp, 5.0_wp))]

   type(row_t), parameter, public :: material_rows(*) = [ &
                                  row_t("youngs_modulus", type_number, "Pa", "Young's modulus E", range=positive, required=.true., &
                                           plausible=span_t(1.0e7_wp, 2.0e12_wp)), &
                                     row_t("poisson_ratio", type_number, "", "Poisson's ratio nu", &
                                           range=range_t(minimum=0.0_wp, maximum=0.5_wp, maximum_open=.true.), required=.true.), &
                               row_t("density", type_number, "kg/m3", "density; used for mass and inertia if these are not given", &
                                           range=positive, &
                                           required=.true., &
                                           plausible=span_t(100.0_wp, 25000.0_wp)), &
                                     row_t("thermal_conductivity", type_number, "W/(m K)", &
                                           "thermal conductivity, for the flash temperature", range=positive, &
                                           plausible=span_t(0.1_wp, 500.0_wp)), &
                                     row_t("specific_heat", type_number, "J/(kg K)", &
                                           "specific heat capacity, for the flash temperature", range=positive, &
                                           plausible=span_t(100.0_wp, 5000.0_wp)), &
                                     row_t("strength", type_block, "", &
                                           "S-N line and permissible stresses, for load spectra and safety factors", &
                                           holds="strength")]

   type(row_t), parameter, public :: &
      mesh_rows(*) = [ &
      row_t("name", type_name, "", "name in paths and the history", default="{driving}-{driven}"), &
      row_t("driving", type_reference, "", "name of the driving wheel", required=.true., holds="wheels"), &
      row_t("driven", type_reference, "", "name of the driven wheel", required=.true., holds="wheels"), &
      row_t("driving_rotation", type_choice, "", "nominal sense of rotation of the driving wheel; selects the drive flanks", &
            required=.true., &
            words="clockwise counterclockwise"), &
      row_t("centre_line_angle", type_number, "deg", &
            "direction from the driving to the driven axle; if not given, it follows from the centres", &
            range=range_t(-360.0_wp, 360.0_wp), plausible=span_t(0.0_wp, 360.0_wp)), &
      row_t("pressure_angle", type_number, "deg", &
            "working pressure angle of wheels without a module; paper_rule: 1.05 times the smallest possible angle", &
            range=range_t(minimum=0.0_wp, maximum=90.0_wp, minimum_open=.true., maximum_open=.true.), words="paper_rule", &
            plausible=span_t(5.0_wp, 45.0_wp)), &
      row_t("centre_distance", type_number, "m", &
            "centre distance a_w of two gears with a module; if not given, from backlash, or else from the profile shifts", &
            range=positive, &
            plausible=span_t(2.0e-4_wp, 10.0_wp)), &
      row_t("backlash", type_number, "m", &
            "normal backlash j_bn; defines the centre distance of two gears with a module; adds coast flanks to wheels without a" &
            //" module", range=not_negative, &
            plausible=span_t(0.0_wp, 0.01_wp)), &
      row_t("contact", type_block, "", "normal elastic force", default="{law: johnson}", holds="contact"), &
      row_t("damping", type_block, "", "normal viscous force", default="{law: none}", holds="damping"), &
      row_t("friction", type_block, "", "tangential force", default="{law: none}", holds="friction"), &
      row_t("lubricant", type_block, "", "lubricant of this mesh; keys that are not given are those of the case", &
            holds="lubricant"), &
      row_t("tooth_coupling", type_choice, "", &
            "deflection of teeth under the loads of neighbouring teeth; default: true if the wheels' compliances include it", &
            words="true false"), &
      row_t("edge_contact", type_choice, "", &
            "corner contact of tip edges before and after the path of contact; default: true if a wheel has a compliance", &
            words="true false"), &
      row_t("tracking", type_choice, "", "computation method of the contact points", default="closed_form", &
            words="closed_form algebraic differential")]

   type(row_t), parameter, public :: &
      lubricant_rows(*) = [ &
      row_t("viscosity", type_number, "Pa s", "dynamic viscosity at the temperature of the oil", range=positive, &
            plausible=span_t(1.0e-4_wp, 10.0_wp)), &
      row_t("roughness", type_number, "m", "arithmetic mean roughness Ra, the mean of both flanks", range=positive, &
            plausible=span_t(1.0e-8_wp, 2.0e-5_wp)), &
      row_t("bulk_temperature", type_number, "K", "bulk temperature of the teeth, absolute, for the contact temperature", &
            range=positive, plausible=span_t(200.0_wp, 600.0_wp))]

   !> A wheel as given, with frequently used parameters.
   type, extends(parameter_view_t) :: wheel_input
      integer :: teeth = 0          !! 0: a disc
      logical :: is_gear = .false.  !! its radii are computed from a module, not from a pitch radius
      integer :: side = 1           !! -1: internal; sign of its radii
      type(parameter_view_t) :: material
      real(wp) :: compliance = 0.0_wp !! of its material: (1 - nu^2)/E [1/Pa]
   end type wheel_input

   !> A mesh as given.
   type, extends(parameter_view_t) :: mesh_input
      integer :: driving = 0, driven = 0       !! indices of wheels, from 1
      integer :: driving_rotation = -1         !! +1: counterclockwise
      class(elastic_law_t), allocatable :: contact
      class(damping_law_t), allocatable :: damping
      class(friction_law_t), allocatable :: friction
      integer :: tracking = tracking_closed_form
   end type mesh_input

contains

   !> Wheels, meshes and shafts of a checked case. Errors: code_invalid_input with subject, index and field.
   subroutine read_description(root, wheels, meshes, shafts, status)
      type(parameter_view_t), intent(in) :: root
      type(wheel_input), allocatable, intent(out) :: wheels(:)
      type(mesh_input), allocatable, intent(out) :: meshes(:)
      type(shaft_t), allocatable, intent(out) :: shafts(:)
      type(status_t), intent(inout) :: status
      type(parameter_view_t), allocatable :: blocks(:), materials(:)
      integer :: i

      call root%elements("materials", materials)
      call root%elements("wheels", blocks)
      if (size(blocks) < 1) call fail(status, code_invalid_input, "a gearbox needs at least one wheel", subject_none)
      allocate (wheels(size(blocks)))
      do i = 1, size(wheels)
         wheels(i)%parameter_view_t = blocks(i)
         if (.not. has_failed(status)) call read_wheel(wheels(i), i, materials, status)
      end do
      call root%elements("meshes", blocks)
      allocate (meshes(size(blocks)))
      do i = 1, size(meshes)
         meshes(i)%parameter_view_t = blocks(i)
         if (.not. has_failed(status)) call read_mesh(meshes(i), i, wheels, status)
         if (.not. has_failed(status)) call read_lubricant(root, meshes(i), i, status)
      end do
      call root%elements("shafts", blocks)
      allocate (shafts(size(blocks)))
      do i = 1, size(shafts)
         if (.not. has_failed(status)) call read_shaft(blocks(i), i, wheels, shafts(i), status)
      end do
   end subroutine read_description

   !> Read a wheel. One without teeth is a disc and needs a radius, or mass and inertia.
   subroutine read_wheel(wheel, index, materials, status)
      type(wheel_input), intent(inout) :: wheel
      integer, intent(in) :: index
      type(parameter_view_t), intent(in) :: materials(:)
      type(status_t), intent(inout) :: status
      integer :: i

      wheel%teeth = wheel%whole("teeth")
      wheel%is_gear = wheel%has("module")
      if (wheel%is_gear .and. wheel%word("internal") == "true") wheel%side = -1
      i = named(wheel%word("material"), materials)
      if (i > 0) then
         wheel%material = materials(i)
         wheel%compliance = (1 - materials(i)%number("poisson_ratio")**2)/materials(i)%number("youngs_modulus")
      end if
      if (i == 0) then
         call fail(status, code_invalid_input, "there is no such material", subject_wheel, index, "material")
      else if (wheel%teeth > 0) then
         if (wheel%has("radius")) call fail(status, code_invalid_input, "'radius' is that of a disc without teeth; give" &
                                            //" 'pitch_radius'", subject_wheel, index, "radius")
      else if (wheel%is_gear .or. wheel%has("pitch_radius")) then
         call fail(status, code_invalid_input, "a wheel without teeth has no pitch radius and no module; give 'radius', or" &
                   //" 'teeth'", subject_wheel, index, trim(merge("module      ", "pitch_radius", wheel%is_gear)))
      else if (.not. (wheel%has("radius") .or. (wheel%has("inertia") .and. wheel%has("mass")))) then
         call fail(status, code_invalid_input, "a wheel without teeth is a disc: it needs a radius, or its inertia and its mass", &
                   subject_wheel, index)
      end if
   end subroutine read_wheel

   !> Index of the block with a name; 0 if there is none.
   pure integer function named(name, blocks) result(i)
      character(len=*), intent(in) :: name
      class(parameter_view_t), intent(in) :: blocks(:)

      do i = 1, size(blocks)
         if (blocks(i)%name == name) return
      end do
      i = 0
   end function named

   !> Read a shaft, which connects two different wheels.
   subroutine read_shaft(input, index, wheels, shaft, status)
      type(parameter_view_t), intent(in) :: input
      integer, intent(in) :: index
      type(wheel_input), intent(in) :: wheels(:)
      type(shaft_t), intent(out) :: shaft !! without its state indices
      type(status_t), intent(inout) :: status
      type(parameter_view_t), allocatable :: ends(:)

      shaft%rigid = input%word("kind") == "rigid"
      if (.not. shaft%rigid) then
         shaft%stiffness = input%number("stiffness")
         shaft%damping = input%number("damping")
      end if
      call input%elements("wheels", ends)
      if (size(ends) == 2) then
         shaft%wheel_a = named(ends(1)%name, wheels)
         shaft%wheel_b = named(ends(2)%name, wheels)
      end if
      if (shaft%wheel_a == 0 .or. shaft%wheel_b == 0) then
         call fail(status, code_invalid_input, "there is no such wheel", subject_shaft, index, "wheels")
      else if (shaft%wheel_a == shaft%wheel_b) then
         call fail(status, code_invalid_input, "a shaft joins two different wheels", subject_shaft, index, "wheels")
      end if
   end subroutine read_shaft

   !> Read a mesh, which connects two different wheels; its laws must exist and have valid parameters.
   subroutine read_mesh(mesh, index, wheels, status)
      type(mesh_input), intent(inout) :: mesh
      integer, intent(in) :: index
      type(wheel_input), intent(in) :: wheels(:)
      type(status_t), intent(inout) :: status

      mesh%driving = named(mesh%word("driving"), wheels)
      mesh%driven = named(mesh%word("driven"), wheels)
      mesh%driving_rotation = merge(-1, 1, mesh%word("driving_rotation") == "clockwise")
      select case (mesh%word("tracking"))
      case ("algebraic")
         mesh%tracking = tracking_algebraic
      case ("differential")
         mesh%tracking = tracking_differential
      end select
      if (mesh%driving == 0) then
         call fail(status, code_invalid_input, "there is no such driving wheel", subject_mesh, index, "driving")
      else if (mesh%driven == 0) then
         call fail(status, code_invalid_input, "there is no such driven wheel", subject_mesh, index, "driven")
      else if (mesh%driving == mesh%driven) then
         call fail(status, code_invalid_input, "a wheel cannot mesh with itself", subject_mesh, index, "driven")
      else if (any(wheels([mesh%driving, mesh%driven])%teeth == 0)) then
         call fail(status, code_invalid_input, "a wheel without teeth cannot mesh", subject_mesh, index, &
                   merge("driving", "driven ", wheels(mesh%driving)%teeth == 0))
      end if
      if (.not. has_failed(status)) call read_laws(mesh, index, status)
      if (has_failed(status)) return
      if (mesh%contact%is_rigid() .and. mesh%friction%is_local()) then
         call fail(status, code_invalid_input, "a rigid contact has no friction law whose coefficient depends on its force;" &
                   //" choose coulomb, tanh, stribeck, schlenk or mean_roughness", subject_mesh, index, "friction.law")
         return
      end if
      if (.not. mesh%contact%is_rigid() .or. mesh%damping%is_none()) return
      call fail(status, code_invalid_input, "a rigid contact has no penetration that could be damped; choose the damping law" &
                //" none", subject_mesh, index, "damping.law")
   end subroutine read_mesh

   !> Read the lubricant of a mesh whose friction law needs one.
   subroutine read_lubricant(root, mesh, index, status)
      type(parameter_view_t), intent(in) :: root
      type(mesh_input), intent(inout) :: mesh
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status
      character(len=short_length) :: key

      select type (law => mesh%friction)
      class is (lubricated_friction_t)
         law%lubricant%viscosity = lubricant_number(root, mesh, "viscosity")
         law%lubricant%roughness = lubricant_number(root, mesh, "roughness")
         key = law%missing()
         if (key /= "") call fail(status, code_invalid_input, "the friction law of this mesh needs '"//trim(key) &
                                  //"' of the lubricant; give the case, or this mesh, lubricant: {viscosity: 20 mPa s," &
                                  //" roughness: 0.5 um}", subject_mesh, index, "friction.law")
      end select
   end subroutine read_lubricant

   !> Number of the lubricant of a mesh, or else of the case; NaN if neither gives it.
   real(wp) function lubricant_number(root, mesh, key) result(number)
      type(parameter_view_t), intent(in) :: root
      type(mesh_input), intent(in) :: mesh
      character(len=*), intent(in) :: key
      type(parameter_view_t) :: blocks(2)

      call mesh%inner("lubricant", blocks(1))
      call root%inner("lubricant", blocks(2))
      number = blocks(merge(1, 2, blocks(1)%has(key)))%number(key)
   end function lubricant_number

   !> Read the laws of a mesh with their parameters.
   subroutine read_laws(mesh, index, status)
      type(mesh_input), intent(inout) :: mesh
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status
      character(len=*), parameter :: keys(3) = [character(len=8) :: "contact", "damping", "friction"]
      type(parameter_view_t) :: blocks(3)
      type(kind_finder) :: finders(3)
      integer :: i

      call mesh%inner("contact", blocks(1))
      call mesh%inner("damping", blocks(2))
      call mesh%inner("friction", blocks(3))
      finders%index = [(blocks(i)%choice("law"), i=1, 3)]
      call elastic_law(finders(1), mesh%contact)
      call damping_law(finders(2), mesh%damping)
      call friction_law(finders(3), mesh%friction)
      i = findloc(finders%found%name, "", dim=1)
      if (i > 0) then
         call fail(status, code_invalid_input, "there is no such law", subject_mesh, index, trim(keys(i))//".law")
         return
      end if
      call take_parameters(mesh%contact, "contact", blocks(1), finders(1)%found, index, status)
      call take_parameters(mesh%damping, "damping", blocks(2), finders(2)%found, index, status)
      call take_parameters(mesh%friction, "friction", blocks(3), finders(3)%found, index, status)
   end subroutine read_laws

   !> Parameters of a law, NaN for those not given in its block; the field of an error is family.parameter.
   subroutine take_parameters(law, family, block, info, index, status)
      class(force_law_t), intent(inout) :: law
      character(len=*), intent(in) :: family
      type(parameter_view_t), intent(in) :: block
      type(kind_t), intent(in) :: info !! of the law
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status
      character(len=short_length) :: field
      character(len=message_length) :: message
      integer :: i

      if (has_failed(status)) return
      do i = 1, size(info%rows)
         law%parameters(i) = block%number(trim(info%rows(i)%key))
      end do
      call law%check(field, message)
      if (message /= "") call fail(status, code_invalid_input, trim(message)//" (law "//trim(info%name)//")", subject_mesh, index, &
                                   family//"."//field)
   end subroutine take_parameters

end module evl_gearbox_description
