!> C interface of the sparse Jacobian.
!>
!> The header documents each procedure; this module converts between C and Fortran. A handle is the address of a pattern.
module evl_capi_pattern
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_loc, c_null_ptr, c_ptr
   use evl_capi_types, only: c_status, gearbox_of, return_code
   use evl_dae_jacobian, only: find_dae_pattern, gearbox_jacobian_entries
   use evl_gearbox, only: gearbox_t
   use evl_jacobian_entries, only: jacobian_entries, listed_entries
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: evl_pattern_create, evl_pattern_delete, evl_pattern_jacobian, evl_pattern_indices

   !> evl_pattern
   type :: pattern_t
      type(gearbox_t), pointer :: gearbox => null()
      integer, allocatable :: rows(:), columns(:) !! indices of each entry
      type(jacobian_entries) :: entries
   end type pattern_t

contains

   type(c_ptr) function evl_pattern_create(gearbox, n_entries) result(handle) bind(c)
      type(c_ptr), intent(in), value :: gearbox
      integer(c_int), intent(out) :: n_entries
      type(pattern_t), pointer :: self

      handle = c_null_ptr
      n_entries = 0
      allocate (self)
      self%gearbox => gearbox_of(gearbox)
      if (self%gearbox%housing%is_mounted) then
         deallocate (self)
         return
      end if
      call find_dae_pattern(self%gearbox, self%rows, self%columns)
      call listed_entries(self%gearbox%n_states, self%rows, self%columns, self%entries)
      n_entries = size(self%rows)
      handle = c_loc(self)
   end function evl_pattern_create

   subroutine evl_pattern_delete(handle) bind(c)
      type(pattern_t), pointer :: self
      include "capi/delete_of_handle.inc"
   end subroutine evl_pattern_delete

   subroutine evl_pattern_indices(handle, rows, columns) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(inout) :: rows(*), columns(*)
      type(pattern_t), pointer :: self

      call c_f_pointer(handle, self)
      rows(:size(self%rows)) = self%rows - 1
      columns(:size(self%columns)) = self%columns - 1
   end subroutine evl_pattern_indices

   integer(c_int) function evl_pattern_jacobian(handle, t, cj, y, yp, integers, reals, values, status) result(code) bind(c)
      include "capi/at_state.inc"
      real(c_double), intent(in), value :: t, cj
      real(c_double), intent(in) :: yp(*)
      real(c_double), intent(inout) :: values(*)
      type(pattern_t), pointer :: self

      call c_f_pointer(handle, self)
      call gearbox_jacobian_entries(self%gearbox, t, cj, y, yp, integers, reals, self%entries, values, s)
      code = return_code(s, status)
   end function evl_pattern_jacobian

end module evl_capi_pattern
