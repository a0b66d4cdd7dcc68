!> Names of the discrete state variables and the root functions, for the tests: C calls that the kernel does not export.
module discrete_state_calls
   use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_name_length, to_c
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_root_kinds, only: n_held, n_root_kinds, n_sides, root_rows
   implicit none (type, external)
   private

   public :: test_integer_name, test_root_name

   character(len=*), parameter :: held_names(n_held) = [character(len=10) :: "tooth_pair", "flanks", "friction", "zone_a", "zone_b"]

contains

   !> Name of a root function, from 0, and its tooth contact; -1 if there is none.
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

   !> Name of an integer of the discrete state, from 0, and its tooth contact; -1 if there is none.
   subroutine test_integer_name(handle, index, name, contact) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: index
      character(kind=c_char), intent(out) :: name(c_name_length)
      integer(c_int), intent(out) :: contact
      type(gearbox_t), pointer :: g
      integer :: i, k

      call c_f_pointer(handle, g)
      contact = -1
      call to_c(merge("turns       ", "knots_passed", index + 1 == i_turns), name)
      do i = 1, size(g%contacts)
         k = findloc(g%contacts(i)%i_discrete, index + 1, dim=1)
         if (k == 0) cycle
         contact = i - 1
         if (k <= n_held) then
            call to_c(held_names(k), name)
         else
            call to_c(root_rows(n_root_kinds - n_sides + k - n_held)%name, name)
         end if
      end do
   end subroutine test_integer_name

end module discrete_state_calls
