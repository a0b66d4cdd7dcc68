!> C interface of the integrator for gearboxes in closed form.
!>
!> The header's section "integration" documents each procedure; this module converts between C and Fortran. A handle is the
!> address of a model and its integrator.
module evl_capi_radau
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   use evl_archive, only: archive_fits, archive_measures, archive_t
   use evl_capi_types, only: c_status, gearbox_of, return_code
   use evl_extreme_finder, only: candidate_t, most_candidates
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_ode, only: gearbox_ode, gearbox_ode_create, gearbox_ode_serves, gearbox_ode_set, serialize_gearbox_ode
   use evl_kinds, only: lanes, wp
   use evl_radau, only: radau_advance, radau_counts, radau_create, radau_get_counts, radau_get_growth, radau_growth, &
                        radau_interpolate, radau_interpolate_lanes, radau_interpolate_some, radau_look, radau_options, radau_redo, &
                        radau_restart, radau_start, radau_step, radau_t, serialize_radau
   use evl_radau_coefficients, only: n_stages
   use evl_status, only: clear, code_no_memory, code_ok, fail, has_failed, status_t
   implicit none (type, external)
   private

   public :: evl_radau_serves, evl_radau_create, evl_radau_delete, evl_radau_start, evl_radau_advance, evl_radau_interpolate, &
             evl_radau_candidate, evl_radau_interpolate_lanes, evl_radau_interpolate_some, evl_radau_look, evl_radau_restart, &
             evl_radau_redo, evl_radau_get_counts, evl_radau_serialize

   !> evl_radau
   type :: integration_t
      type(gearbox_ode) :: model
      type(radau_t) :: solver
      type(candidate_t), allocatable :: found(:) !! buffer for the extremes found in a step
      type(status_t) :: status !! of the last advance: creating one in each call takes longer than checking it
   end type integration_t

   !> evl_radau_counts
   type, bind(c) :: c_counts
      integer(c_int) :: steps, rejections, evaluations, iterations, jacobians, factorisations, root_evaluations
      real(c_double) :: growth_t, growth_rate, growth_frequency
   end type c_counts

   !> evl_candidate
   type, bind(c) :: c_candidate
      integer(c_int) :: channel, sense
      real(c_double) :: t, left, right, value
   end type c_candidate

contains

   integer(c_int) function evl_radau_serves(handle, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(c_status), intent(inout), optional :: status
      type(status_t) :: s

      call gearbox_ode_serves(gearbox_of(handle), s)
      code = return_code(s, status)
   end function evl_radau_serves

   type(c_ptr) function evl_radau_create(gearbox_handle, scale, tolerance, max_step, status) result(handle) bind(c)
      type(c_ptr), intent(in), value :: gearbox_handle
      real(c_double), intent(in) :: scale(*)
      real(c_double), intent(in), value :: tolerance, max_step
      type(c_status), intent(inout), optional :: status
      type(gearbox_t), pointer :: gearbox
      type(integration_t), pointer :: self
      type(status_t) :: s
      integer :: stat, code

      handle = c_null_ptr
      self => null()
      gearbox => gearbox_of(gearbox_handle)
      call gearbox_ode_serves(gearbox, s)
      if (.not. has_failed(s)) then
         allocate (self, stat=stat)
         if (stat /= 0) call fail(s, code_no_memory, "there is not enough memory for an integrator")
      end if
      if (.not. has_failed(s)) then
         call gearbox_ode_create(self%model, gearbox, scale(:gearbox%n_states))
         call radau_create(self%solver, self%model, radau_options(tolerance=tolerance, max_step=max_step), s)
         allocate (self%found(most_candidates*self%model%n_rows))
      end if
      code = return_code(s, status)
      if (code == code_ok) then
         handle = c_loc(self)
      else if (associated(self)) then
         deallocate (self)
      end if
   end function evl_radau_create

   subroutine evl_radau_delete(handle) bind(c)
      type(integration_t), pointer :: self
      include "capi/delete_of_handle.inc"
   end subroutine evl_radau_delete

   integer(c_int) function evl_radau_start(handle, t, y, integers, reals, status) result(code) bind(c)
      include "capi/at_state.inc"
      real(c_double), intent(in), value :: t
      type(integration_t), pointer :: self

      call c_f_pointer(handle, self)
      call gearbox_ode_set(self%model, integers, reals)
      call radau_start(self%solver, self%model, t, y(:self%model%n), s)
      code = return_code(s, status)
   end function evl_radau_start

   integer(c_int) function evl_radau_advance(handle, t_stop, t, y, fired, outcome, status) result(code) bind(c)
      real(c_double), intent(in), value :: t_stop
      real(c_double), intent(out) :: t
      real(c_double), intent(inout) :: y(*)
      integer(c_int), intent(inout) :: fired(*)
      integer(c_int), intent(out) :: outcome
      type(c_status), intent(inout), optional :: status
      include "capi/integration_of_handle.inc"

      if (has_failed(self%status)) call clear(self%status)
      call radau_advance(self%solver, self%model, t_stop, outcome, self%status)
      t = self%solver%t
      y(:self%model%n) = self%solver%y
      fired(:self%model%n_roots) = self%solver%fired
      code = self%status%code
      if (code /= code_ok) code = return_code(self%status, status)
   end function evl_radau_advance

   subroutine evl_radau_interpolate(handle, t, y) bind(c)
      real(c_double), intent(in), value :: t
      real(c_double), intent(inout) :: y(*)
      include "capi/integration_of_handle.inc"

      call radau_interpolate(self%solver, t, y(:self%model%n))
   end subroutine evl_radau_interpolate

   subroutine evl_radau_interpolate_some(handle, t, n, states, y) bind(c)
      real(c_double), intent(in), value :: t
      integer(c_int), intent(in), value :: n
      integer(c_int), intent(in) :: states(n)
      real(c_double), intent(inout) :: y(*)
      include "capi/integration_of_handle.inc"

      call radau_interpolate_some(self%solver, t, n, states, y)
   end subroutine evl_radau_interpolate_some

   subroutine evl_radau_interpolate_lanes(handle, t, y) bind(c)
      real(c_double), intent(in) :: t(lanes)
      real(c_double), intent(out) :: y(lanes, *)
      include "capi/integration_of_handle.inc"

      call radau_interpolate_lanes(self%solver, t, y(:, :self%model%n))
   end subroutine evl_radau_interpolate_lanes

   integer(c_int) function evl_radau_look(handle, high, low) result(n) bind(c)
      real(c_double), intent(in) :: high(*), low(*)
      include "capi/integration_of_handle.inc"

      call radau_look(self%solver, self%model, high(:self%model%n_monitored), low(:self%model%n_monitored), n, self%found)
   end function evl_radau_look

   subroutine evl_radau_candidate(handle, index, candidate) bind(c)
      integer(c_int), intent(in), value :: index
      type(c_candidate), intent(out) :: candidate
      real(wp) :: h
      include "capi/integration_of_handle.inc"

      h = radau_step(self%solver)
      associate (one => self%found(index + 1), before => self%solver%t_before, now => self%solver%t)
         candidate = c_candidate(one%channel - 1, one%sense, min(before + one%tau*h, now), min(before + one%left*h, now), &
                                 min(before + one%right*h, now), one%value)
      end associate
   end subroutine evl_radau_candidate

   subroutine evl_radau_restart(handle, t, y, integers, reals) bind(c)
      real(c_double), intent(in), value :: t
      real(c_double), intent(in) :: y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      include "capi/integration_of_handle.inc"

      call gearbox_ode_set(self%model, integers, reals)
      call radau_restart(self%solver, self%model, t, y(:self%model%n))
   end subroutine evl_radau_restart

   subroutine evl_radau_redo(handle, t, y) bind(c)
      real(c_double), intent(out) :: t
      real(c_double), intent(inout) :: y(*)
      include "capi/integration_of_handle.inc"

      call radau_redo(self%solver, self%model)
      t = self%solver%t
      y(:self%model%n) = self%solver%y
   end subroutine evl_radau_redo

   subroutine evl_radau_get_counts(handle, counts) bind(c)
      type(c_counts), intent(out) :: counts
      type(radau_counts) :: c
      type(radau_growth) :: g
      include "capi/integration_of_handle.inc"

      c = radau_get_counts(self%solver)
      g = radau_get_growth(self%solver)
      counts = c_counts(c%steps, c%rejections, c%evaluations + n_stages*c%iterations, c%iterations, c%jacobians, &
                        c%factorisations, c%root_evaluations, g%t, g%re, g%im)
   end subroutine evl_radau_get_counts

   integer(c_int64_t) function evl_radau_serialize(handle, direction, n, words) result(n_words) bind(c)
      integer(c_int), intent(in), value :: direction
      integer(c_int64_t), intent(in), value :: n
      integer(c_int64_t), intent(inout), target, optional :: words(n)
      type(archive_t) :: archive
      include "capi/integration_of_handle.inc"

      archive%direction = direction
      if (direction /= archive_measures) archive%words => words
      call serialize_gearbox_ode(archive, self%model)
      call serialize_radau(archive, self%solver)
      n_words = merge(archive%n, -1_c_int64_t, archive_fits(archive))
   end function evl_radau_serialize

end module evl_capi_radau
