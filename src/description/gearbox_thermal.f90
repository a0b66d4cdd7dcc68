!> Thermal data of the meshes of a gearbox. Gearboxes are created without them; they are added on request.
module evl_gearbox_thermal
   use evl_flash_temperature, only: mesh_thermal_t, thermal_contact_coefficient
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_description, only: lubricant_number, mesh_input, read_description, wheel_input
   use evl_kinds, only: wp
   use evl_output_list, only: set_output_offsets
   use evl_parameter_view, only: description_t, parameter_view_t
   use evl_shaft, only: shaft_t
   use evl_status, only: code_invalid_input, fail, has_failed, status_t, subject_mesh, subject_wheel
   implicit none (type, external)
   private

   public :: gearbox_add_temperatures

contains

   !> Add the thermal data of all meshes and the outputs of the temperatures; n_values and the layout of the outputs change.
   !>
   !> Errors: code_invalid_input for a mesh without friction or bulk temperature, and for a material without thermal data.
   subroutine gearbox_add_temperatures(description, gearbox, status)
      type(description_t), target, intent(in) :: description !! of the gearbox
      type(gearbox_t), intent(inout) :: gearbox
      type(status_t), intent(inout) :: status
      type(parameter_view_t) :: root
      type(wheel_input), allocatable :: wheels(:)
      type(mesh_input), allocatable :: meshes(:)
      type(shaft_t), allocatable :: shafts(:)
      type(mesh_thermal_t), allocatable :: thermal(:)
      integer :: i

      if (allocated(gearbox%thermal)) return
      call root%all_of(description)
      call read_description(root, wheels, meshes, shafts, status)
      if (has_failed(status)) return
      allocate (thermal(size(meshes)))
      do i = 1, size(meshes)
         if (meshes(i)%friction%is_none()) then
            call fail(status, code_invalid_input, "the flash temperature needs the friction of this mesh, whose law is none;" &
                      //" choose a law, such as friction: {law: coulomb, coefficient: 0.05}", subject_mesh, i, "friction.law")
            return
         end if
         thermal(i)%bulk_temperature = lubricant_number(root, meshes(i), "bulk_temperature")
         if (.not. thermal(i)%bulk_temperature > 0) then
            call fail(status, code_invalid_input, "the contact temperature needs the bulk temperature of the teeth; give the" &
                      //" case, or this mesh, lubricant: {bulk_temperature: 90 degC}", subject_mesh, i, &
                      "lubricant.bulk_temperature")
            return
         end if
         call find_coefficient(wheels, meshes(i)%driving, thermal(i)%coefficient_a, status)
         call find_coefficient(wheels, meshes(i)%driven, thermal(i)%coefficient_b, status)
         if (has_failed(status)) return
      end do
      call move_alloc(thermal, gearbox%thermal)
      call set_output_offsets(gearbox)
   end subroutine gearbox_add_temperatures

   !> Thermal contact coefficient of a wheel's material.
   subroutine find_coefficient(wheels, wheel, coefficient, status)
      type(wheel_input), intent(in) :: wheels(:)
      integer, intent(in) :: wheel
      real(wp), intent(inout) :: coefficient !! unchanged on failure
      type(status_t), intent(inout) :: status

      if (has_failed(status)) return
      associate (material => wheels(wheel)%material)
         if (.not. material%has("thermal_conductivity")) then
            call fail(status, code_invalid_input, "the flash temperature needs the thermal conductivity of material '" &
                      //trim(material%name)//"'; give it thermal_conductivity, for steel about 45 W/(m K)", subject_wheel, &
                      wheel, "material")
         else if (.not. material%has("specific_heat")) then
            call fail(status, code_invalid_input, "the flash temperature needs the specific heat of material '" &
                      //trim(material%name)//"'; give it specific_heat, for steel about 460 J/(kg K)", subject_wheel, wheel, &
                      "material")
         else
            coefficient = thermal_contact_coefficient(material%number("thermal_conductivity"), material%number("density"), &
                                                      material%number("specific_heat"))
         end if
      end associate
   end subroutine find_coefficient

end module evl_gearbox_thermal
