!> Some of the outputs for the tests: a C call that the kernel does not export.
module wanted_calls
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_status, status_to_c
   use evl_gearbox, only: gearbox_t
   use evl_outputs, only: needed_outputs
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: test_wanted_outputs

contains

   !> Values of the wanted outputs at n states that share their discrete state; the others stay as they are.
   integer(c_int) function test_wanted_outputs(handle, n, t, y, integers, reals, wanted, values, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: t(*), y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      logical(c_bool), intent(in) :: wanted(*)
      real(c_double), intent(inout), target :: values(*)
      type(c_status), intent(out) :: status
      real(c_double), pointer, contiguous :: rows(:, :)
      type(status_t) :: s
      type(gearbox_t), pointer :: g
      real(c_double), allocatable :: told(:)
      integer :: i, k, needed

      call c_f_pointer(handle, g)
      rows(1:g%n_values, 1:n) => values(:g%n_values*n)
      needed = iany(g%output_needs, mask=logical(wanted(:size(g%output_counts))))
      allocate (told(g%n_values))
      do k = 1, n
         call needed_outputs(g, t(k), y((k - 1)*g%n_states + 1:k*g%n_states), integers(:g%n_integers), reals(:size(g%contacts)), &
                             needed, .false., told, s)
         if (has_failed(s)) exit
         do i = 1, size(g%output_counts)
            associate (first => g%output_offsets(i) + 1, last => g%output_offsets(i) + g%output_counts(i))
               if (wanted(i)) rows(first:last, k) = told(first:last)
            end associate
         end do
      end do
      call status_to_c(s, status)
      code = s%code
   end function test_wanted_outputs

end module wanted_calls
