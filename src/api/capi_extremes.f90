!> C interface of the watched outputs.
!>
!> The header's section "extremes" documents each procedure; here is only the passage from Fortran to C.
module evl_capi_extremes
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_ptr
   use evl_capi_types, only: answer, c_status, gearbox_of
   use evl_gearbox_watch, only: mesh_states, n_kept, watched_at, watched_of_mesh
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: evl_gearbox_mesh_states, evl_gearbox_roots_and_watched, evl_gearbox_watched, evl_gearbox_watched_mesh

contains

   integer(c_int) function evl_gearbox_watched(handle, y, integers, reals, values, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(inout) :: values(*)
      type(c_status), intent(inout), optional :: status
      type(status_t) :: s

      call watched_at(gearbox_of(handle), y, integers, reals, values, s)
      code = answer(s, status)
   end function evl_gearbox_watched

   integer(c_int) function evl_gearbox_watched_mesh(handle, mesh, y, integers, reals, values, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      real(c_double), intent(in) :: y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(inout) :: values(*)
      type(c_status), intent(inout), optional :: status
      type(status_t) :: s

      call watched_of_mesh(gearbox_of(handle), mesh + 1, y, integers, reals, values, s)
      code = answer(s, status)
   end function evl_gearbox_watched_mesh

   integer(c_int) function evl_gearbox_mesh_states(handle, mesh, states) result(n) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      integer(c_int), intent(inout) :: states(*)
      integer, allocatable :: found(:)

      call mesh_states(gearbox_of(handle), mesh + 1, found)
      n = size(found)
      states(:n) = found - 1
   end function evl_gearbox_mesh_states

   integer(c_int) function evl_gearbox_roots_and_watched(handle, y, integers, reals, near, highest, kept, roots, values, status) &
      result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: y(*), reals(*), highest(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(in), value :: near
      real(c_double), intent(inout) :: kept(n_kept, *), roots(*), values(*)
      type(c_status), intent(inout), optional :: status
      type(status_t) :: s

      call watched_at(gearbox_of(handle), y, integers, reals, values, s, roots, near, highest, kept)
      code = answer(s, status)
   end function evl_gearbox_roots_and_watched

end module evl_capi_extremes
