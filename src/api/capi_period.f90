!> C interface of the common period, and of states of which only their place in it counts.
!>
!> The header's section "common period" documents each procedure; here is only the passage from C to Fortran.
module evl_capi_period
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_int, c_ptr
   use evl_capi_types, only: answer, c_status, gearbox_of
   use evl_carried_state, only: state_distance, take_back, take_over
   use evl_common_period, only: common_period, period_t
   use evl_gearbox, only: gearbox_t
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: evl_gearbox_distance, evl_gearbox_period, evl_gearbox_take_back, evl_gearbox_take_over

   !> evl_period
   type, bind(c) :: c_period
      integer(c_int) :: pitches, sense
      logical(c_bool) :: by_time
      real(c_double) :: time
   end type c_period

contains

   integer(c_int) function evl_gearbox_period(handle, period, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(c_period), intent(out) :: period
      type(c_status), intent(inout), optional :: status
      type(period_t) :: p
      type(status_t) :: s

      call common_period(gearbox_of(handle), p, s)
      period = c_period(p%pitches, p%sense, logical(p%by_time, c_bool), p%time)
      code = answer(s, status)
   end function evl_gearbox_period

   subroutine evl_gearbox_take_back(handle, period, periods, y, integers, reals) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(c_period), intent(in) :: period
      integer(c_int), intent(in), value :: periods
      real(c_double), intent(inout) :: y(*), reals(*)
      integer(c_int), intent(inout) :: integers(*)
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      call take_back(g, period_t(period%pitches, logical(period%by_time), period%sense, period%time), periods, &
                     y(:g%n_states), integers(:g%n_integers), reals(:size(g%contacts)))
   end subroutine evl_gearbox_take_back

   real(c_double) function evl_gearbox_distance(handle, scale, y_a, integers_a, reals_a, y_b, integers_b, reals_b) &
      result(distance) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: scale(*), y_a(*), reals_a(*), y_b(*), reals_b(*)
      integer(c_int), intent(in) :: integers_a(*), integers_b(*)

      distance = state_distance(gearbox_of(handle), scale, y_a, integers_a, reals_a, y_b, integers_b, reals_b)
   end function evl_gearbox_distance

   integer(c_int) function evl_gearbox_take_over(handle, alike, t, y, yp, integers, reals, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      logical(c_bool), intent(in), value :: alike
      real(c_double), intent(in), value :: t
      real(c_double), intent(inout) :: y(*), yp(*), reals(*)
      integer(c_int), intent(inout) :: integers(*)
      type(c_status), intent(inout), optional :: status
      type(status_t) :: s

      call take_over(gearbox_of(handle), logical(alike), t, y, yp, integers, reals, s)
      code = answer(s, status)
   end function evl_gearbox_take_over

end module evl_capi_period
