!> C interface of the common period, of states relative to it, and of the start on a periodic orbit.
!>
!> The header's sections "common period" and "the periodic start" document each procedure; this module converts between C and
!> Fortran.
module evl_capi_periodic
   use, intrinsic :: iso_c_binding, only: c_associated, c_bool, c_double, c_f_procpointer, c_funptr, c_int, c_null_ptr, c_ptr
   use evl_capi_description, only: c_initial, initial_from_c
   use evl_capi_types, only: c_status, gearbox_of, return_code
   use evl_common_period, only: common_period, period_t
   use evl_gearbox, only: gearbox_t
   use evl_periodic_search, only: periodic_search, periodic_start_t
   use evl_periodic_start, only: begin_periodic_start, periodic_start
   use evl_state_transfer, only: state_distance, take_back, take_over
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: evl_gearbox_distance, evl_gearbox_period, evl_gearbox_periodic_check, evl_gearbox_periodic_start, &
             evl_gearbox_take_back, evl_gearbox_take_over

   abstract interface
      logical(c_bool) function c_is_over(self) bind(c)
         import :: c_bool, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: self
      end function c_is_over
   end interface

   !> evl_periodic_setup
   type, bind(c) :: c_setup
      type(c_ptr) :: self
      type(c_funptr) :: is_over
      integer(c_int) :: most_flows
   end type c_setup

   !> evl_periodic
   type, bind(c) :: c_periodic
      integer(c_int) :: pitches, flows, periods, ties
      real(c_double) :: time, residual, multiplier(2), time_constant
      logical(c_bool) :: has_multiplier, is_stable, is_reached, is_interrupted, has_searched
   end type c_periodic

   type, extends(periodic_search) :: callers_search
      type(c_ptr) :: self = c_null_ptr
      procedure(c_is_over), pointer, nopass :: is_over => null()
   contains
      procedure :: is_interrupted
   end type callers_search

   !> evl_period
   type, bind(c) :: c_period
      integer(c_int) :: pitches, sense
      logical(c_bool) :: by_time
      real(c_double) :: time
   end type c_period

contains

   logical function is_interrupted(self)
      class(callers_search), intent(in) :: self

      is_interrupted = .false.
      if (associated(self%is_over)) is_interrupted = logical(self%is_over(self%self))
   end function is_interrupted

   integer(c_int) function evl_gearbox_periodic_start(handle, initial, setup, found, y, yp, integers, reals, status) &
      result(code) bind(c)
      include "capi/changes_state.inc"
      type(c_initial), intent(in) :: initial
      type(c_setup), intent(in) :: setup
      type(c_periodic), intent(out) :: found
      real(c_double), intent(inout) :: yp(*)
      type(callers_search) :: search
      type(periodic_start_t) :: orbit
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      search%self = setup%self
      search%most_flows = setup%most_flows
      if (c_associated(setup%is_over)) call c_f_procpointer(setup%is_over, search%is_over)
      call periodic_start(g, initial_from_c(initial, g), search, orbit, y, yp, integers, reals, s)
      found = to_c(orbit)
      code = return_code(s, status)
   end function evl_gearbox_periodic_start

   integer(c_int) function evl_gearbox_periodic_check(handle, initial, found, y, yp, integers, reals, status) result(code) bind(c)
      include "capi/changes_state.inc"
      type(c_initial), intent(in) :: initial
      type(c_periodic), intent(out) :: found
      real(c_double), intent(inout) :: yp(*)
      type(periodic_start_t) :: orbit
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      call begin_periodic_start(g, initial_from_c(initial, g), orbit, y, yp, integers, reals, s)
      found = to_c(orbit)
      code = return_code(s, status)
   end function evl_gearbox_periodic_check

   pure type(c_periodic) function to_c(found)
      type(periodic_start_t), intent(in) :: found

      to_c%pitches = found%pitches
      to_c%flows = found%flows
      to_c%periods = found%periods
      to_c%ties = found%ties
      to_c%time = found%time
      to_c%residual = found%residual
      to_c%multiplier = [found%multiplier%re, found%multiplier%im]
      to_c%time_constant = found%time_constant
      to_c%has_multiplier = found%has_multiplier
      to_c%is_stable = found%is_stable
      to_c%is_reached = found%is_reached
      to_c%is_interrupted = found%is_interrupted
      to_c%has_searched = found%has_searched
   end function to_c

   integer(c_int) function evl_gearbox_period(handle, period, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(c_period), intent(out) :: period
      type(c_status), intent(inout), optional :: status
      type(period_t) :: p
      type(status_t) :: s

      call common_period(gearbox_of(handle), p, s)
      period = c_period(p%pitches, p%sense, logical(p%by_time, c_bool), p%time)
      code = return_code(s, status)
   end function evl_gearbox_period

   subroutine evl_gearbox_take_back(handle, period, periods, y, integers, reals) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(c_period), intent(in) :: period
      integer(c_int), intent(in), value :: periods
      real(c_double), intent(inout) :: y(*), reals(*)
      integer(c_int), intent(inout) :: integers(*)

      call take_back(gearbox_of(handle), period_t(period%pitches, logical(period%by_time), period%sense, period%time), periods, &
                     y, integers, reals)
   end subroutine evl_gearbox_take_back

   real(c_double) function evl_gearbox_distance(handle, scale, y_a, integers_a, reals_a, y_b, integers_b, reals_b) &
      result(distance) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: scale(*), y_a(*), reals_a(*), y_b(*), reals_b(*)
      integer(c_int), intent(in) :: integers_a(*), integers_b(*)

      distance = state_distance(gearbox_of(handle), scale, y_a, integers_a, reals_a, y_b, integers_b, reals_b)
   end function evl_gearbox_distance

   integer(c_int) function evl_gearbox_take_over(handle, alike, t, y, yp, integers, reals, status) result(code) bind(c)
      include "capi/changes_state.inc"
      logical(c_bool), intent(in), value :: alike
      real(c_double), intent(in), value :: t
      real(c_double), intent(inout) :: yp(*)

      call take_over(gearbox_of(handle), logical(alike), t, y, yp, integers, reals, s)
      code = return_code(s, status)
   end function evl_gearbox_take_over

end module evl_capi_periodic
