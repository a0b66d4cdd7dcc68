!> Structs of the C header in Fortran, and conversion of strings and statuses.
module evl_capi_types
   use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_int, c_null_char, c_ptr
   use evl_gearbox, only: gearbox_t
   use evl_status, only: code_ok, status_t
   implicit none (type, external)
   private

   public :: c_status
   public :: c_field_length, c_message_length, c_name_length, c_text_length
   public :: return_code, gearbox_of, status_from_c, status_to_c, take_text, to_c

   integer, parameter :: c_name_length = 32       !! EVL_SHORT_LENGTH
   integer, parameter :: c_text_length = 96       !! three times that
   integer, parameter :: c_field_length = 48      !! EVL_FIELD_LENGTH
   integer, parameter :: c_message_length = 320   !! EVL_MESSAGE_LENGTH

   !> evl_status
   type, bind(c) :: c_status
      integer(c_int) :: code, subject, index
      character(kind=c_char) :: field(c_field_length)
      character(kind=c_char) :: message(c_message_length)
   end type c_status

contains

   !> The gearbox of a handle.
   function gearbox_of(handle) result(gearbox)
      type(c_ptr), intent(in) :: handle
      type(gearbox_t), pointer :: gearbox

      call c_f_pointer(handle, gearbox)
   end function gearbox_of

   !> A blank-padded string as a C string.
   pure subroutine to_c(text, c_text)
      character(len=*), intent(in) :: text                !! truncated to the length of c_text
      character(kind=c_char), intent(out) :: c_text(:)    !! NUL-terminated
      integer :: i, n

      n = min(len_trim(text), size(c_text) - 1)
      c_text = c_null_char
      do i = 1, n
         c_text(i) = text(i:i)
      end do
   end subroutine to_c

   !> Convert a status to C; indices are 0-based there.
   pure subroutine status_to_c(status, c)
      type(status_t), intent(in) :: status !! of the kernel
      type(c_status), intent(out) :: c     !! result

      c%code = status%code
      c%subject = status%subject
      c%index = status%index - 1
      call to_c(status%field, c%field)
      call to_c(status%message, c%message)
   end subroutine status_to_c

   !> Convert a status from C.
   pure type(status_t) function status_from_c(c) result(status)
      type(c_status), intent(in) :: c
      character(len=:), allocatable :: field, message

      call take_text(c%field, field)
      call take_text(c%message, message)
      status = status_t(code=c%code, subject=c%subject, index=c%index + 1, field=field, message=message)
   end function status_from_c

   !> Convert a C string to a string. Not a function, for the reason given at `quantity`.
   pure subroutine take_text(c, text)
      character(kind=c_char), intent(in) :: c(:) !! ends with NUL
      character(len=:), allocatable, intent(out) :: text
      integer :: i

      allocate (character(len=findloc(c, c_null_char, dim=1) - 1) :: text)
      do i = 1, len(text)
         text(i:i) = c(i)
      end do
   end subroutine take_text

   !> Code of a call; on failure also the status for C.
   integer(c_int) function return_code(status, c) result(code)
      type(status_t), intent(in) :: status
      type(c_status), intent(inout), optional :: c

      code = status%code
      if (code /= code_ok .and. present(c)) call status_to_c(status, c)
   end function return_code

end module evl_capi_types
