!> C interface of derived quantities: geometry, support directions, damping. The header documents each procedure.
module evl_capi_geometry
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_ptr
   use evl_capi_outputs, only: c_output, output_to_c
   use evl_capi_types, only: gearbox_of
   use evl_derived_geometry, only: of_gear, of_gear_mesh, pitch_errors_of, quantities_of
   use evl_force_law, only: max_law_parameters
   use evl_gear_build, only: gearbox_sketch
   use evl_gearbox, only: gearbox_t
   use evl_output, only: output_t
   use evl_parameter_view, only: description_t
   implicit none (type, external)
   private

   public :: evl_description_geometry, evl_gearbox_damping, evl_gearbox_geometry, evl_gearbox_pitch_errors, &
             evl_gearbox_support_directions

contains

   integer(c_int) function evl_gearbox_geometry(handle, of, index, quantities) result(n) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: of, index
      type(c_output), intent(inout) :: quantities(*)
      type(output_t), allocatable :: table(:)

      call quantities_of(gearbox_of(handle), int(of), index + 1, table)
      n = size(table)
      call output_to_c(table, quantities(:n))
   end function evl_gearbox_geometry

   integer(c_int) function evl_description_geometry(handle, of, index, quantities) result(n) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: of, index
      type(c_output), intent(inout) :: quantities(*)
      type(description_t), pointer :: description
      type(gearbox_t) :: sketch
      type(output_t), allocatable :: table(:)

      n = 0
      if (of /= of_gear .and. of /= of_gear_mesh) return
      call c_f_pointer(handle, description)
      call gearbox_sketch(description, sketch)
      call quantities_of(sketch, int(of), index + 1, table)
      n = size(table)
      call output_to_c(table, quantities(:n))
   end function evl_description_geometry

   integer(c_int) function evl_gearbox_pitch_errors(handle, wheel, most, errors) result(n) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel, most
      real(c_double), intent(inout) :: errors(*)
      real(c_double), allocatable :: found(:)

      call pitch_errors_of(gearbox_of(handle), wheel + 1, found)
      n = size(found)
      errors(:min(n, most)) = found(:min(n, most))
   end function evl_gearbox_pitch_errors

   integer(c_int) function evl_gearbox_support_directions(handle, wheel, directions) bind(c)
      integer(c_int), intent(in), value :: wheel
      real(c_double), intent(out) :: directions(4)
      include "capi/gearbox_of_handle.inc"

      associate (support => g%wheels(wheel + 1)%support)
         directions = [support%direction(:, 1), support%direction(:, 2)]
         evl_gearbox_support_directions = support%n
      end associate
   end function evl_gearbox_support_directions

   subroutine evl_gearbox_damping(handle, mesh, parameters) bind(c)
      integer(c_int), intent(in), value :: mesh
      real(c_double), intent(out) :: parameters(max_law_parameters)
      include "capi/gearbox_of_handle.inc"

      parameters = g%references(mesh + 1)%law%parameters
   end subroutine evl_gearbox_damping

end module evl_capi_geometry
