!> C interface of what follows from a description: geometry, directions of supports, damping. The header documents each procedure.
module evl_capi_geometry
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_law_choice, c_name_length, c_text_length, to_c
   use evl_derived_geometry, only: derived_t, pitch_errors_of, quantities_of
   use evl_gearbox, only: gearbox_t
   implicit none (type, external)
   private

   public :: evl_gearbox_damping, evl_gearbox_geometry, evl_gearbox_pitch_errors, evl_gearbox_support_directions

   !> evl_quantity
   type, bind(c) :: c_quantity
      character(kind=c_char) :: name(c_name_length), units(c_name_length), symbol(c_name_length), long_name(c_text_length)
      integer(c_int) :: n
      real(c_double) :: value(2)
   end type c_quantity

contains

   integer(c_int) function evl_gearbox_geometry(handle, of, index, quantities) result(n) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: of, index
      type(c_quantity), intent(inout) :: quantities(*)
      type(gearbox_t), pointer :: g
      type(derived_t) :: derived

      call c_f_pointer(handle, g)
      call quantities_of(g, int(of), index + 1, derived)
      do n = 1, derived%n
         associate (from => derived%rows(n), to => quantities(n))
            call to_c(from%name, to%name)
            call to_c(from%units, to%units)
            call to_c(from%symbol, to%symbol)
            call to_c(from%text, to%long_name)
            to%n = from%n
            to%value = from%value
         end associate
      end do
      n = derived%n
   end function evl_gearbox_geometry

   integer(c_int) function evl_gearbox_pitch_errors(handle, wheel, most, errors) result(n) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel, most
      real(c_double), intent(inout) :: errors(*)
      type(gearbox_t), pointer :: g
      real(c_double), allocatable :: found(:)

      call c_f_pointer(handle, g)
      call pitch_errors_of(g, wheel + 1, found)
      n = size(found)
      errors(:min(n, most)) = found(:min(n, most))
   end function evl_gearbox_pitch_errors

   integer(c_int) function evl_gearbox_support_directions(handle, wheel, directions) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel
      real(c_double), intent(out) :: directions(4)
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      associate (support => g%wheels(wheel + 1)%support)
         directions = [support%direction(:, 1), support%direction(:, 2)]
         evl_gearbox_support_directions = support%n
      end associate
   end function evl_gearbox_support_directions

   subroutine evl_gearbox_damping(handle, mesh, choice) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      type(c_law_choice), intent(out) :: choice
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      choice = c_law_choice(g%references(mesh + 1)%law%law, g%references(mesh + 1)%law%parameters)
   end subroutine evl_gearbox_damping

end module evl_capi_geometry
