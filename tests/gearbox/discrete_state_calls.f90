!> The discrete state for the tests: C calls that the kernel does not export.
module discrete_state_calls
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_name_length, c_status, status_to_c, to_c
   use evl_discrete_state, only: name_integer
   use evl_gearbox, only: gearbox_t
   use evl_mode_check, only: check_modes
   use evl_root_kinds, only: root_rows
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: test_check_modes, test_integer_name, test_root_name

contains

   !> Name of a root function, from 0, and the tooth contact that has it; -1 if none has.
   subroutine test_root_name(handle, index, name, contact) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: index
      character(kind=c_char), intent(out) :: name(c_name_length)
      integer(c_int), intent(out) :: contact
      type(gearbox_t), pointer :: g
      integer :: i

      call c_f_pointer(handle, g)
      contact = -1
      call to_c("revolution", name)
      do i = 1, size(g%contacts)
         associate (k => index + 1 - g%contacts(i)%i_root)
            if (k < 1 .or. k > g%contacts(i)%n_roots) cycle
            contact = i - 1
            call to_c(root_rows(g%contacts(i)%roots(k))%name, name)
         end associate
      end do
   end subroutine test_root_name

   !> The same of an integer of the discrete state.
   subroutine test_integer_name(handle, index, name, contact) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: index
      character(kind=c_char), intent(out) :: name(c_name_length)
      integer(c_int), intent(out) :: contact
      character(len=c_name_length) :: text
      type(gearbox_t), pointer :: g
      integer :: owner

      call c_f_pointer(handle, g)
      call name_integer(g, index + 1, text, owner)
      call to_c(text, name)
      contact = owner - 1
   end subroutine test_integer_name

   !> Whether the discrete state agrees with y.
   integer(c_int) function test_check_modes(handle, y, integers, reals, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      type(c_status), intent(out) :: status
      type(status_t) :: s
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      call check_modes(g, y(:g%n_states), integers(:g%n_integers), reals(:size(g%contacts)), s)
      code = s%code
      call status_to_c(s, status)
   end function test_check_modes

end module discrete_state_calls
