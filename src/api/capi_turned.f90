!> C interface of how far wheels have turned.
!>
!> The header's section "outputs by position" documents each procedure; here is only the passage from Fortran to C.
module evl_capi_turned
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_int, c_ptr
   use evl_capi_types, only: gearbox_of
   use evl_gearbox, only: gearbox_t
   use evl_turned, only: can_turn, pitches_turned, turns_made
   implicit none (type, external)
   private

   public :: evl_gearbox_can_turn, evl_gearbox_driving_wheel, evl_gearbox_pitches, evl_gearbox_turns

contains

   integer(c_int) function evl_gearbox_driving_wheel(handle, mesh) result(wheel) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      wheel = g%contacts(g%first(mesh + 1))%wheel_a - 1
   end function evl_gearbox_driving_wheel

   logical(c_bool) function evl_gearbox_can_turn(handle, wheel, y, yp) result(may) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel
      real(c_double), intent(in) :: y(*), yp(*)
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      may = logical(can_turn(g, wheel + 1, y(:g%n_states), yp(:g%n_states)), c_bool)
   end function evl_gearbox_can_turn

   real(c_double) function evl_gearbox_pitches(handle, mesh, y, integers) result(pitches) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      real(c_double), intent(in) :: y(*)
      integer(c_int), intent(in) :: integers(*)
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      pitches = pitches_turned(g, mesh + 1, y(:g%n_states), integers(:g%n_integers))
   end function evl_gearbox_pitches

   real(c_double) function evl_gearbox_turns(handle, wheel, y, integers) result(turns) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel
      real(c_double), intent(in) :: y(*)
      integer(c_int), intent(in) :: integers(*)
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      turns = turns_made(g, wheel + 1, y(:g%n_states), integers(:g%n_integers))
   end function evl_gearbox_turns

end module evl_capi_turned
