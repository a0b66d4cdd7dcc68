!> The description of a gearbox as C gives it, and its passage to the kernel. Indices count from 0 in C, from 1 here.
module evl_capi_description
   use, intrinsic :: iso_c_binding, only: c_associated, c_bool, c_double, c_f_pointer, c_int, c_ptr
   use evl_capi_deviation, only: c_flank_deviation
   use evl_capi_types, only: c_law_choice, c_max_parameters, choice_from_c
   use evl_gear, only: gear_input
   use evl_gearbox_description, only: mesh_input, shaft_input, wheel_input
   use evl_gearbox_initial, only: initial_t
   use evl_housing_description, only: housing_input
   use evl_housing_motion, only: motion_term
   use evl_load, only: load_input
   use evl_status, only: code_invalid_input, fail, status_t, subject_housing, subject_load, subject_wheel
   use evl_support, only: support_input
   implicit none (type, external)
   private

   public :: c_gear, c_wheel, c_load, c_mesh, c_shaft, c_initial, c_housing
   public :: gear_from_c, wheel_from_c, support_from_c, load_from_c, mesh_from_c, shaft_from_c, initial_from_c, housing_from_c

   !> evl_gear
   type, bind(c) :: c_gear
      real(c_double) :: normal_module, pressure_angle, profile_shift, rack_addendum, rack_dedendum, rack_root_radius
      logical(c_bool) :: has_tip_diameter
      real(c_double) :: tip_diameter
      logical(c_bool) :: has_tip_alteration
      real(c_double) :: tip_alteration, thickness_allowance, bore
   end type c_gear

   !> evl_support
   type, bind(c) :: c_support
      integer(c_int) :: kind
      integer(c_int) :: counts(c_max_parameters)
      type(c_ptr) :: numbers
   end type c_support

   !> evl_wheel
   type, bind(c) :: c_wheel
      integer(c_int) :: teeth
      logical(c_bool) :: has_pitch_radius
      real(c_double) :: pitch_radius, width
      logical(c_bool) :: has_centre
      real(c_double) :: centre(2), youngs_modulus, poisson_ratio, density
      logical(c_bool) :: has_inertia
      real(c_double) :: inertia
      logical(c_bool) :: has_mass
      real(c_double) :: mass
      type(c_support) :: support
      logical(c_bool) :: has_transverse_inertia
      real(c_double) :: transverse_inertia, axial_position
      logical(c_bool) :: has_gear
      type(c_gear) :: gear
      type(c_flank_deviation) :: deviation
   end type c_wheel

   !> evl_load
   type, bind(c) :: c_load
      integer(c_int) :: wheel, kind
      logical(c_bool) :: against_housing
      integer(c_int) :: counts(c_max_parameters)
      type(c_ptr) :: numbers
   end type c_load

   !> evl_motion_term
   type, bind(c) :: c_motion_term
      integer(c_int) :: coordinate, kind
      real(c_double) :: value, frequency, phase
      integer(c_int) :: n
      type(c_ptr) :: time, values
   end type c_motion_term

   !> evl_housing
   type, bind(c) :: c_housing
      integer(c_int) :: kind
      real(c_double) :: gravity(3)
      integer(c_int) :: n_terms
      type(c_ptr) :: terms
      real(c_double) :: mass
      real(c_double), dimension(3) :: centre_of_mass, inertia, products_of_inertia
      real(c_double), dimension(3) :: mount_point, stiffness, damping, rotational_stiffness, rotational_damping
      real(c_double), dimension(3) :: force, moment
      real(c_double) :: position(3), orientation(4), velocity(3), angular_velocity(3)
   end type c_housing

   !> evl_mesh
   type, bind(c) :: c_mesh
      integer(c_int) :: driving, driven, driving_rotation
      logical(c_bool) :: has_centre_line_angle
      real(c_double) :: centre_line_angle
      logical(c_bool) :: paper_rule
      real(c_double) :: pressure_angle
      type(c_law_choice) :: contact, damping, friction
      integer(c_int) :: tracking
      logical(c_bool) :: has_centre_distance
      real(c_double) :: centre_distance
      logical(c_bool) :: has_backlash
      real(c_double) :: backlash
   end type c_mesh

   !> evl_shaft
   type, bind(c) :: c_shaft
      integer(c_int) :: wheel_a, wheel_b
      logical(c_bool) :: rigid
      real(c_double) :: stiffness, damping
   end type c_shaft

   !> evl_initial
   type, bind(c) :: c_initial
      integer(c_int) :: kind
      type(c_ptr) :: speeds, gaps
      real(c_double) :: mesh_position
   end type c_initial

contains

   !> All but the support and the deviations, which are not copied by value.
   elemental type(wheel_input) function wheel_from_c(c) result(wheel)
      type(c_wheel), intent(in) :: c

      wheel = wheel_input(teeth=c%teeth, has_pitch_radius=logical(c%has_pitch_radius), pitch_radius=c%pitch_radius, &
                          width=c%width, has_centre=logical(c%has_centre), centre=c%centre, &
                          youngs_modulus=c%youngs_modulus, poisson_ratio=c%poisson_ratio, density=c%density, &
                          has_inertia=logical(c%has_inertia), inertia=c%inertia, has_mass=logical(c%has_mass), mass=c%mass, &
                          has_transverse_inertia=logical(c%has_transverse_inertia), transverse_inertia=c%transverse_inertia, &
                          axial_position=c%axial_position, has_gear=logical(c%has_gear), gear=gear_from_c(c%gear))
   end function wheel_from_c

   elemental type(gear_input) function gear_from_c(c) result(gear)
      type(c_gear), intent(in) :: c

      gear = gear_input(normal_module=c%normal_module, pressure_angle=c%pressure_angle, profile_shift=c%profile_shift, &
                        rack_addendum=c%rack_addendum, rack_dedendum=c%rack_dedendum, rack_root_radius=c%rack_root_radius, &
                        has_tip_diameter=logical(c%has_tip_diameter), tip_diameter=c%tip_diameter, &
                        has_tip_alteration=logical(c%has_tip_alteration), tip_alteration=c%tip_alteration, &
                        thickness_allowance=c%thickness_allowance, bore=c%bore)
   end function gear_from_c

   !> A support with a copy of its numbers. Errors: code_invalid_input if they are announced but not there.
   subroutine support_from_c(c, index, support, status)
      type(c_support), intent(in) :: c
      integer, intent(in) :: index !! of the wheel, from 1, for the message
      type(support_input), intent(out) :: support
      type(status_t), intent(inout) :: status

      support%kind = c%kind
      support%counts = max(c%counts, 0)
      support%numbers = array_from_c(c%numbers, sum(support%counts))
      if (size(support%numbers) < sum(support%counts)) &
         call fail(status, code_invalid_input, "the numbers of a support are missing", subject_wheel, index, "support")
   end subroutine support_from_c

   !> A load with a copy of its numbers. Errors: code_invalid_input if they are announced but not there.
   subroutine load_from_c(c, index, load, status)
      type(c_load), intent(in) :: c
      integer, intent(in) :: index !! of the load, from 1, for the message
      type(load_input), intent(out) :: load
      type(status_t), intent(inout) :: status

      load%wheel = c%wheel + 1
      load%kind = c%kind
      load%against_housing = logical(c%against_housing)
      load%counts = max(c%counts, 0)
      load%numbers = array_from_c(c%numbers, sum(load%counts))
      if (size(load%numbers) < sum(load%counts)) &
         call fail(status, code_invalid_input, "the numbers of a load are missing", subject_load, index)
   end subroutine load_from_c

   elemental type(mesh_input) function mesh_from_c(c) result(mesh)
      type(c_mesh), intent(in) :: c

      mesh = mesh_input(driving=c%driving + 1, driven=c%driven + 1, driving_rotation=c%driving_rotation, &
                        has_centre_line_angle=logical(c%has_centre_line_angle), centre_line_angle=c%centre_line_angle, &
                        paper_rule=logical(c%paper_rule), pressure_angle=c%pressure_angle, &
                        contact=choice_from_c(c%contact), damping=choice_from_c(c%damping), &
                        friction=choice_from_c(c%friction), tracking=c%tracking, &
                        has_centre_distance=logical(c%has_centre_distance), centre_distance=c%centre_distance, &
                        has_backlash=logical(c%has_backlash), backlash=c%backlash)
   end function mesh_from_c

   elemental type(shaft_input) function shaft_from_c(c) result(shaft)
      type(c_shaft), intent(in) :: c

      shaft = shaft_input(wheel_a=c%wheel_a + 1, wheel_b=c%wheel_b + 1, rigid=logical(c%rigid), stiffness=c%stiffness, &
                          damping=c%damping)
   end function shaft_from_c

   !> A housing with copies of its tables. Errors: code_invalid_input if terms or tables are announced but not there.
   subroutine housing_from_c(c, housing, status)
      type(c_housing), intent(in) :: c
      type(housing_input), intent(out) :: housing
      type(status_t), intent(inout) :: status
      type(c_motion_term), pointer :: terms(:)
      integer :: i

      housing%kind = c%kind
      housing%gravity = c%gravity
      housing%mass = c%mass
      housing%centre_of_mass = c%centre_of_mass
      housing%inertia = c%inertia
      housing%products = c%products_of_inertia
      housing%mount_point = c%mount_point
      housing%stiffness = c%stiffness
      housing%damping = c%damping
      housing%turn_stiffness = c%rotational_stiffness
      housing%turn_damping = c%rotational_damping
      housing%force = c%force
      housing%moment = c%moment
      housing%position = c%position
      housing%orientation = c%orientation
      housing%velocity = c%velocity
      housing%angular_velocity = c%angular_velocity
      allocate (housing%terms(max(c%n_terms, 0)))
      if (c%n_terms < 1) return
      if (.not. c_associated(c%terms)) then
         call fail(status, code_invalid_input, "the terms of the housing's motion are missing", subject_housing)
         return
      end if
      call c_f_pointer(c%terms, terms, [c%n_terms])
      do i = 1, c%n_terms
         call term_from_c(terms(i), housing%terms(i), status)
      end do
   end subroutine housing_from_c

   !> A term of a prescribed motion.
   subroutine term_from_c(c, term, status)
      type(c_motion_term), intent(in) :: c
      type(motion_term), intent(out) :: term
      type(status_t), intent(inout) :: status
      real(c_double), pointer :: time(:), values(:)

      term%coordinate = c%coordinate + 1
      term%kind = c%kind
      term%value = c%value
      term%frequency = c%frequency
      term%phase = c%phase
      if (c%n < 1) then
         allocate (term%time(0), term%values(0))
      else if (c_associated(c%time) .and. c_associated(c%values)) then
         call c_f_pointer(c%time, time, [c%n])
         call c_f_pointer(c%values, values, [c%n])
         term%time = time
         term%values = values
      else
         call fail(status, code_invalid_input, "the table of a term of the housing's motion is missing", subject_housing)
      end if
   end subroutine term_from_c

   type(initial_t) function initial_from_c(c, n_wheels, n_meshes) result(initial)
      type(c_initial), intent(in) :: c
      integer, intent(in) :: n_wheels, n_meshes

      initial%kind = c%kind
      initial%mesh_position = c%mesh_position
      allocate (initial%speeds, source=array_from_c(c%speeds, n_wheels))
      allocate (initial%gaps, source=array_from_c(c%gaps, n_meshes))
   end function initial_from_c

   !> A copy of a C array; size 0 for NULL.
   function array_from_c(pointer, n) result(array)
      type(c_ptr), intent(in) :: pointer
      integer, intent(in) :: n
      real(c_double), allocatable :: array(:)
      real(c_double), pointer :: view(:)

      allocate (array(merge(n, 0, c_associated(pointer))))
      if (.not. c_associated(pointer)) return
      call c_f_pointer(pointer, view, [n])
      array(:) = view
   end function array_from_c

end module evl_capi_description
