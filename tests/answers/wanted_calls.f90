!> Some of the outputs for the tests: a C call that the kernel does not export.
module wanted_calls
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_status, status_to_c
   use evl_gearbox, only: gearbox_t
   use evl_outputs, only: wanted_outputs
   use evl_status, only: status_t
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
      integer :: i

      call c_f_pointer(handle, g)
      rows(1:g%n_values, 1:n) => values(:g%n_values*n)
      call wanted_outputs(g, t(:n), reshape(y(:g%n_states*n), [g%n_states, n]), integers(:g%n_integers), &
                          reals(:size(g%contacts)), pack([(i, i=1, size(g%output_counts))], wanted(:size(g%output_counts))), &
                          .false., rows, s)
      call status_to_c(s, status)
      code = s%code
   end function test_wanted_outputs

end module wanted_calls
