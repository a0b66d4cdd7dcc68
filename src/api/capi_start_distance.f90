!> C interface of the distance of a start from the steady motion.
!>
!> The header's section "natural modes" documents the procedure; here is only the passage from C to Fortran.
module evl_capi_start_distance
   use, intrinsic :: iso_c_binding, only: c_double, c_double_complex, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: answer, c_status, gearbox_of
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_start_distance, only: gearbox_start_distance
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: evl_gearbox_start_distance

contains

   integer(c_int) function evl_gearbox_start_distance(handle, t, start, start_integers, y, integers, reals, n_modes, eigenvalues, &
                                                      vectors, amplitudes, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle, eigenvalues, vectors, amplitudes
      real(c_double), intent(in), value :: t
      real(c_double), intent(in) :: start(*)
      integer(c_int), intent(in) :: start_integers(*)
      real(c_double), intent(inout) :: y(*), reals(*)
      integer(c_int), intent(inout) :: integers(*)
      integer(c_int), intent(out) :: n_modes
      type(c_status), intent(inout), optional :: status
      complex(c_double_complex), pointer :: lambda(:), v(:, :), a(:)
      type(gearbox_t), pointer :: g
      type(status_t) :: s

      g => gearbox_of(handle)
      call c_f_pointer(eigenvalues, lambda, [g%n_states])
      call c_f_pointer(vectors, v, [g%n_states, g%n_states])
      call c_f_pointer(amplitudes, a, [g%n_states])
      call gearbox_start_distance(g, t, start(:g%n_states), start_integers(i_turns), y, integers, reals, n_modes, lambda, v, a, s)
      code = answer(s, status)
   end function evl_gearbox_start_distance

end module evl_capi_start_distance
