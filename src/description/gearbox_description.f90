!> The description that a gearbox is made from, and whether its numbers are in range.
module evl_gearbox_description
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use evl_damping_law, only: damping_law_t
   use evl_deviation_description, only: deviation_input
   use evl_elastic_law, only: elastic_law_t
   use evl_force_law, only: law_choice
   use evl_gear, only: gear_input
   use evl_kinds, only: wp
   use evl_law_table, only: damping_law, elastic_law, law_validate, laws_contact, laws_damping, laws_friction
   use evl_mesh_geometry, only: maximum_teeth, minimum_teeth
   use evl_status, only: code_invalid_input, fail, has_failed, message_length, quantity, status_t, subject_mesh, subject_none, &
                         subject_shaft, subject_wheel
   use evl_support, only: support_input
   use evl_support_build, only: check_support
   use evl_tooth_contact, only: tracking_closed_form, tracking_differential
   implicit none (type, external)
   private

   public :: wheel_input, mesh_input, shaft_input, check_description

   !> A wheel as described; see `evl_wheel` in the C header.
   type :: wheel_input
      integer :: teeth = 0
      logical :: has_pitch_radius = .false., has_centre = .false., has_inertia = .false., has_mass = .false.
      real(wp) :: pitch_radius = 0.0_wp, width = 0.0_wp, centre(2) = 0.0_wp
      real(wp) :: youngs_modulus = 0.0_wp, poisson_ratio = 0.0_wp, density = 0.0_wp, inertia = 0.0_wp, mass = 0.0_wp
      logical :: has_transverse_inertia = .false.
      real(wp) :: transverse_inertia = 0.0_wp, axial_position = 0.0_wp
      type(support_input) :: support
      logical :: has_gear = .false. !! its radii follow from the next, not from a pitch radius
      type(gear_input) :: gear
      type(deviation_input) :: deviation
   end type wheel_input

   !> A mesh as described; wheels from 1. See `evl_tooth_contact` in the C header.
   type :: mesh_input
      integer :: driving = 0, driven = 0, driving_rotation = -1
      logical :: has_centre_line_angle = .false., paper_rule = .true.
      real(wp) :: centre_line_angle = 0.0_wp, pressure_angle = 0.0_wp
      type(law_choice) :: contact, damping, friction
      integer :: tracking = tracking_closed_form
      logical :: has_centre_distance = .false., has_backlash = .false.
      real(wp) :: centre_distance = 0.0_wp, backlash = 0.0_wp
   end type mesh_input

   !> A shaft as described; wheels from 1. See `evl_shaft` in the C header.
   type :: shaft_input
      integer :: wheel_a = 0, wheel_b = 0
      logical :: rigid = .false.
      real(wp) :: stiffness = 0.0_wp, damping = 0.0_wp
   end type shaft_input

contains

   !> Every number is in its range, and every reference leads somewhere.
   subroutine check_description(wheels, meshes, shafts, status)
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: meshes(:)
      type(shaft_input), intent(in) :: shafts(:)
      type(status_t), intent(inout) :: status
      integer :: i

      if (size(wheels) < 1) call fail(status, code_invalid_input, "a gearbox needs at least one wheel", subject_none)
      do i = 1, size(wheels)
         if (.not. has_failed(status)) call check_wheel(wheels(i), i, status)
      end do
      do i = 1, size(meshes)
         if (.not. has_failed(status)) call check_mesh(meshes(i), i, wheels, status)
      end do
      do i = 1, size(shafts)
         if (.not. has_failed(status)) call check_shaft(shafts(i), i, size(wheels), status)
      end do
   end subroutine check_description

   !> Every number of a wheel is in its range.
   subroutine check_wheel(wheel, index, status)
      type(wheel_input), intent(in) :: wheel
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status
      character(len=80) :: text

      if (wheel%teeth == 0) then
         call check_disc(wheel, index, status)
      else if (wheel%teeth < minimum_teeth .or. wheel%teeth > maximum_teeth) then
         write (text, "(a, i0, a, i0, a, i0)") "number of teeth ", wheel%teeth, " must be from ", minimum_teeth, " to ", &
            maximum_teeth
         call fail(status, code_invalid_input, trim(text), subject_wheel, index, "teeth")
      end if
      if (wheel%has_pitch_radius) call check(wheel%pitch_radius, "pitch_radius", "m", index, status)
      call check(wheel%width, "width", "m", index, status)
      call check(wheel%youngs_modulus, "youngs_modulus", "Pa", index, status)
      call check(wheel%density, "density", "kg/m^3", index, status)
      if (wheel%has_inertia) call check(wheel%inertia, "inertia", "kg m^2", index, status)
      if (wheel%has_mass) call check(wheel%mass, "mass", "kg", index, status)
      if (wheel%has_transverse_inertia) call check(wheel%transverse_inertia, "transverse_inertia", "kg m^2", index, status)
      if (has_failed(status)) return
      if (.not. (wheel%poisson_ratio > -1 .and. wheel%poisson_ratio < 0.5_wp)) then
         call fail(status, code_invalid_input, "Poisson ratio "//quantity(wheel%poisson_ratio, "")//" must lie between -1 and" &
                   //" 0.5, ends excluded", subject_wheel, index, "poisson_ratio")
      else if (.not. ieee_is_finite(wheel%axial_position)) then
         call fail(status, code_invalid_input, "axial_position must be a finite number", subject_wheel, index, "axial_position")
      else if (wheel%has_centre .and. .not. all(ieee_is_finite(wheel%centre))) then
         call fail(status, code_invalid_input, "centre must be two finite numbers", subject_wheel, index, "centre")
      end if
      if (.not. has_failed(status)) call check_support(wheel%support, index, status)
   end subroutine check_wheel

   !> A wheel without teeth is a disc: it needs a size.
   subroutine check_disc(wheel, index, status)
      type(wheel_input), intent(in) :: wheel
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status

      if (wheel%has_gear) then
         call fail(status, code_invalid_input, "a wheel without teeth has no module", subject_wheel, index, "module")
         return
      end if
      if (wheel%has_pitch_radius .or. (wheel%has_inertia .and. wheel%has_mass)) return
      call fail(status, code_invalid_input, "a wheel without teeth is a disc: it needs a radius, or its inertia and its mass", &
                subject_wheel, index)
   end subroutine check_disc

   !> A shaft joins two different wheels; an elastic one has a stiffness.
   subroutine check_shaft(shaft, index, n_wheels, status)
      type(shaft_input), intent(in) :: shaft
      integer, intent(in) :: index, n_wheels
      type(status_t), intent(inout) :: status

      if (min(shaft%wheel_a, shaft%wheel_b) < 1 .or. max(shaft%wheel_a, shaft%wheel_b) > n_wheels) then
         call fail(status, code_invalid_input, "there is no such wheel", subject_shaft, index, "wheels")
      else if (shaft%wheel_a == shaft%wheel_b) then
         call fail(status, code_invalid_input, "a shaft joins two different wheels", subject_shaft, index, "wheels")
      else if (shaft%rigid) then
         return
      else if (.not. (ieee_is_finite(shaft%stiffness) .and. shaft%stiffness > 0)) then
         call fail(status, code_invalid_input, "stiffness = "//quantity(shaft%stiffness, "N m/rad")//" must be a finite number" &
                   //" greater than 0", subject_shaft, index, "stiffness")
      else if (.not. (ieee_is_finite(shaft%damping) .and. shaft%damping >= 0)) then
         call fail(status, code_invalid_input, "damping = "//quantity(shaft%damping, "N m s/rad")//" must be a finite number, not" &
                   //" negative", subject_shaft, index, "damping")
      end if
   end subroutine check_shaft

   !> A finite number greater than 0.
   subroutine check(value, field, unit, index, status)
      real(wp), intent(in) :: value
      character(len=*), intent(in) :: field, unit
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status

      if (has_failed(status) .or. (ieee_is_finite(value) .and. value > 0)) return
      call fail(status, code_invalid_input, field//" = "//quantity(value, unit)//" must be a finite number greater than 0", &
                subject_wheel, index, field)
   end subroutine check

   !> A mesh joins two different wheels, and its laws exist and have valid parameters.
   subroutine check_mesh(mesh, index, wheels, status)
      type(mesh_input), intent(in) :: mesh
      integer, intent(in) :: index
      type(wheel_input), intent(in) :: wheels(:)
      type(status_t), intent(inout) :: status
      class(elastic_law_t), allocatable :: elastic
      class(damping_law_t), allocatable :: damping

      if (mesh%driving < 1 .or. mesh%driving > size(wheels)) then
         call fail(status, code_invalid_input, "there is no such driving wheel", subject_mesh, index, "driving")
      else if (mesh%driven < 1 .or. mesh%driven > size(wheels)) then
         call fail(status, code_invalid_input, "there is no such driven wheel", subject_mesh, index, "driven")
      else if (mesh%driving == mesh%driven) then
         call fail(status, code_invalid_input, "a wheel cannot mesh with itself", subject_mesh, index, "driven")
      else if (any(wheels([mesh%driving, mesh%driven])%teeth == 0)) then
         call fail(status, code_invalid_input, "a wheel without teeth cannot mesh", subject_mesh, index, &
                   merge("driving", "driven ", wheels(mesh%driving)%teeth == 0))
      else if (mesh%tracking < tracking_closed_form .or. mesh%tracking > tracking_differential) then
         call fail(status, code_invalid_input, "there is no such tracking", subject_mesh, index, "tracking")
      end if
      call check_law(laws_contact, mesh%contact, "contact", index, status)
      call check_law(laws_damping, mesh%damping, "damping", index, status)
      call check_law(laws_friction, mesh%friction, "friction", index, status)
      if (has_failed(status)) return
      call elastic_law(mesh%contact, elastic)
      call damping_law(mesh%damping, damping)
      if (.not. elastic%is_rigid() .or. damping%is_none()) return
      call fail(status, code_invalid_input, "a rigid contact has no penetration that could be damped: choose the damping law" &
                //" none", subject_mesh, index, "damping.law")
   end subroutine check_mesh

   !> A law of a mesh; the field is named family.parameter.
   subroutine check_law(family, choice, name, index, status)
      integer, intent(in) :: family, index
      type(law_choice), intent(in) :: choice
      character(len=*), intent(in) :: name
      type(status_t), intent(inout) :: status
      character(len=32) :: field
      character(len=message_length) :: message
      integer :: code

      if (has_failed(status)) return
      call law_validate(family, choice, code, field, message)
      if (code == code_invalid_input) call fail(status, code, message, subject_mesh, index, name//"."//field)
   end subroutine check_law

end module evl_gearbox_description
