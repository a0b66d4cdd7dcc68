!> C interface of the caller's cache of compliant wheels, accessed through the caller's procedures.
module evl_capi_store
   use, intrinsic :: iso_c_binding, only: c_double, c_f_procpointer, c_funptr, c_int, c_null_funptr, c_null_ptr, c_ptr
   use evl_influence_store, only: influence_store_t
   use evl_kinds, only: wp
   use evl_status, only: code_store_failed, fail, status_t, subject_wheel
   implicit none (type, external)
   private

   public :: c_store_t, c_wheel_store

   !> evl_wheel_store
   type, bind(c) :: c_wheel_store
      type(c_ptr) :: self = c_null_ptr
      type(c_funptr) :: find = c_null_funptr, put = c_null_funptr
   end type c_wheel_store

   !> The same as a store of the kernel.
   type, extends(influence_store_t) :: c_store_t
      type(c_wheel_store) :: c
   contains
      procedure :: find
      procedure :: put
   end type c_store_t

   abstract interface
      integer(c_int) function c_call(self, n_key, key, n, numbers) bind(c)
         import :: c_double, c_int, c_ptr
         implicit none (type, external)
         type(c_ptr), intent(in), value :: self
         integer(c_int), intent(in), value :: n_key, n
         real(c_double), intent(in) :: key(*)
         real(c_double), intent(inout) :: numbers(*)
      end function c_call
   end interface

contains

   subroutine find(self, key, numbers, is_known, status)
      class(c_store_t), intent(inout) :: self
      real(wp), intent(in) :: key(:)
      real(wp), intent(out) :: numbers(:)
      logical, intent(out) :: is_known
      type(status_t), intent(inout) :: status

      numbers = 0
      is_known = call_store(self%c%self, self%c%find, key, numbers, status) == 1
   end subroutine find

   subroutine put(self, key, numbers, status)
      class(c_store_t), intent(inout) :: self
      real(wp), intent(in) :: key(:)
      real(wp), intent(inout) :: numbers(:)
      type(status_t), intent(inout) :: status
      integer :: is_stored

      is_stored = call_store(self%c%self, self%c%put, key, numbers, status)
   end subroutine put

   !> Return value of a procedure of the caller.
   integer function call_store(self, procedure, key, numbers, status)
      type(c_ptr), intent(in) :: self
      type(c_funptr), intent(in) :: procedure
      real(wp), intent(in) :: key(:)
      real(wp), intent(inout) :: numbers(:)
      type(status_t), intent(inout) :: status
      procedure(c_call), pointer :: call_back

      call c_f_procpointer(procedure, call_back)
      call_store = call_back(self, size(key), key, size(numbers), numbers)
      if (call_store < 0) call fail(status, code_store_failed, "stored compliances of wheels could not be read or written", &
                                    subject_wheel, field="compliance")
   end function call_store

end module evl_capi_store
