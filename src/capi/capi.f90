!> C interface of the gearbox: creation, warnings, states, residual, events, inputs and build information.
!>
!> The header documents each procedure; this module converts between C and Fortran. A handle is the address of a gearbox.
module evl_capi
   use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
   use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_double, c_f_pointer, c_int, c_loc, c_null_char, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: compiler_options, compiler_version
   use evl_capi_description, only: c_initial, initial_from_c
   use evl_capi_store, only: c_store_t, c_wheel_store
   use evl_capi_types, only: c_name_length, c_status, gearbox_of, return_code, status_to_c, to_c
   use evl_dae_jacobian, only: gearbox_jacobian
   use evl_dae_residual, only: gearbox_derivative, gearbox_residual
   use evl_event_log, only: event_log
   use evl_extrema_monitor, only: n_cached
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_build, only: gearbox_create
   use evl_gearbox_events, only: gearbox_apply_event, gearbox_most_events, gearbox_next_time_event, gearbox_root_directions, &
                                 gearbox_roots
   use evl_gearbox_initial, only: gearbox_initial_speeds, gearbox_start
   use evl_gearbox_root_stress, only: gearbox_add_root_stress
   use evl_gearbox_thermal, only: gearbox_add_temperatures
   use evl_gearbox_scaling, only: gearbox_state_scales
   use evl_gearbox_warnings, only: warn_of_speeds
   use evl_influence_store, only: influence_store_t
   use evl_load, only: load_point, load_t
   use evl_output_list, only: set_output_offsets
   use evl_parameter_view, only: description_t
   use evl_state_names, only: gearbox_state_name
   use evl_status, only: code_no_memory, fail, has_failed, status_t
   use evl_wheel_loads, only: followed_speed
   implicit none (type, external)
   private

   public :: evl_gearbox_add_root_outputs, evl_gearbox_add_root_stress, evl_gearbox_add_temperatures, evl_gearbox_apply_event, &
             evl_gearbox_create, evl_gearbox_delete, evl_gearbox_derivative, evl_gearbox_feed, evl_gearbox_initial_state, &
             evl_gearbox_input, evl_gearbox_jacobian, evl_gearbox_next_time_event, evl_gearbox_residual, &
             evl_gearbox_root_directions, evl_gearbox_roots, evl_gearbox_scales, evl_gearbox_sizes, evl_gearbox_state_name, &
             evl_gearbox_warning, evl_gearbox_wheel_speed, evl_kernel_compiler, evl_kernel_processor

   !> evl_sizes
   type, bind(c) :: c_sizes
      integer(c_int) :: n_wheels, n_meshes, n_loads, n_states, n_integers, n_reals, n_roots, n_outputs, n_values, n_warnings, &
                        n_pair_slots, n_drive_slots, n_shafts, n_events, n_cached
   end type c_sizes

   !> evl_event
   type, bind(c) :: c_event
      integer(c_int) :: kind, mesh, tooth_pair, flank
   end type c_event

   ! The compiler reports -march even if it is its own default; of several options the last one applies.
   character(len=*), parameter :: options = compiler_options()//" ", key = "-march="
   integer, parameter :: before = index(options, key, back=.true.)
   integer, parameter :: first = merge(before + len(key), 1, before > 0)
   integer, parameter :: length = merge(index(options(first:), " ") - 1, 0, before > 0)

   ! Set at compile time; C gets their addresses.
   character(len=len(compiler_version()) + 1, kind=c_char), target, protected :: compiler = compiler_version()//c_null_char
   character(len=length + 1, kind=c_char), target, protected :: processor = options(first:first + length - 1)//c_null_char

   !> evl_input
   type, bind(c) :: c_input
      integer(c_int) :: load, wheel, index
      logical(c_bool) :: is_speed
      real(c_double) :: value
   end type c_input

contains

   type(c_ptr) function evl_gearbox_create(description, store, status) result(handle) bind(c)
      type(c_ptr), intent(in), value :: description
      type(c_wheel_store), intent(in), optional :: store
      type(c_status), intent(out), optional :: status
      type(description_t), pointer :: d
      type(gearbox_t), pointer :: gearbox
      type(c_store_t) :: elsewhere
      type(influence_store_t) :: own
      type(status_t) :: s
      integer :: stat

      handle = c_null_ptr
      allocate (gearbox, stat=stat)
      if (stat /= 0) then
         call fail(s, code_no_memory, "there is not enough memory for a gearbox")
         if (present(status)) call status_to_c(s, status)
         return
      end if
      call c_f_pointer(description, d)
      if (present(store)) then
         elsewhere%c = store
         call gearbox_create(d, elsewhere, gearbox, s)
      else
         call gearbox_create(d, own, gearbox, s)
      end if
      if (has_failed(s)) then
         deallocate (gearbox)
      else
         handle = c_loc(gearbox)
      end if
      if (present(status)) call status_to_c(s, status)
   end function evl_gearbox_create

   integer(c_int) function evl_gearbox_add_root_stress(handle, description, store, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle, description
      type(c_wheel_store), intent(in), optional :: store
      type(c_status), intent(inout), optional :: status
      type(description_t), pointer :: d
      type(gearbox_t), pointer :: gearbox
      type(c_store_t) :: elsewhere
      type(influence_store_t) :: own
      type(status_t) :: s

      call c_f_pointer(description, d)
      call c_f_pointer(handle, gearbox)
      if (present(store)) then
         elsewhere%c = store
         call gearbox_add_root_stress(d, elsewhere, gearbox, s)
      else
         call gearbox_add_root_stress(d, own, gearbox, s)
      end if
      code = return_code(s, status)
   end function evl_gearbox_add_root_stress

   logical(c_bool) function evl_gearbox_add_root_outputs(handle) result(has_any) bind(c)
      include "capi/gearbox_of_handle.inc"

      has_any = .false._c_bool
      if (allocated(g%root_stresses)) has_any = logical(any(g%root_stresses%exists), c_bool)
      if (.not. has_any) return
      g%has_root_outputs = .true.
      call set_output_offsets(g)
   end function evl_gearbox_add_root_outputs

   integer(c_int) function evl_gearbox_add_temperatures(handle, description, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle, description
      type(c_status), intent(inout), optional :: status
      type(description_t), pointer :: d
      type(gearbox_t), pointer :: gearbox
      type(status_t) :: s

      call c_f_pointer(description, d)
      call c_f_pointer(handle, gearbox)
      call gearbox_add_temperatures(d, gearbox, s)
      code = return_code(s, status)
   end function evl_gearbox_add_temperatures

   subroutine evl_gearbox_delete(handle) bind(c)
      type(gearbox_t), pointer :: self
      include "capi/delete_of_handle.inc"
   end subroutine evl_gearbox_delete

   subroutine evl_gearbox_sizes(handle, sizes) bind(c)
      type(c_sizes), intent(out) :: sizes
      include "capi/gearbox_of_handle.inc"

      sizes = c_sizes(size(g%wheels), size(g%pairs), size(g%loads), g%n_states, g%n_integers, size(g%contacts), &
                      g%n_roots, size(g%output_counts), g%n_values, size(g%warnings), g%n_pair_slots, g%n_drive_slots, &
                      size(g%shafts), gearbox_most_events(g), n_cached*size(g%contacts))
   end subroutine evl_gearbox_sizes

   integer(c_int) function evl_gearbox_initial_state(handle, initial, t, y, yp, integers, reals, status) result(code) bind(c)
      include "capi/changes_state.inc"
      type(c_initial), intent(in) :: initial
      real(c_double), intent(in), value :: t
      real(c_double), intent(inout) :: yp(*)
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      call gearbox_start(g, initial_from_c(initial, g), t, y, yp, integers, reals, s)
      code = return_code(s, status)
   end function evl_gearbox_initial_state

   subroutine evl_gearbox_scales(handle, initial, duration, state, row) bind(c)
      type(c_initial), intent(in) :: initial
      real(c_double), intent(in), value :: duration
      real(c_double), intent(inout) :: state(*), row(*)
      include "capi/gearbox_of_handle.inc"

      call gearbox_state_scales(g, gearbox_initial_speeds(g, initial_from_c(initial, g)), state, row, duration)
   end subroutine evl_gearbox_scales

   subroutine evl_gearbox_state_name(handle, index, name, units) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: index
      character(kind=c_char), intent(out) :: name(c_name_length), units(c_name_length)
      character(len=c_name_length) :: text, unit

      call gearbox_state_name(gearbox_of(handle), index + 1, text, unit)
      call to_c(text, name)
      call to_c(unit, units)
   end subroutine evl_gearbox_state_name

   integer(c_int) function evl_gearbox_residual(handle, t, y, yp, integers, reals, residual, status) result(code) bind(c)
      include "capi/at_state.inc"
      real(c_double), intent(in), value :: t
      real(c_double), intent(in) :: yp(*)
      real(c_double), intent(inout) :: residual(*)

      call gearbox_residual(gearbox_of(handle), t, y, yp, integers, reals, residual, s)
      code = return_code(s, status)
   end function evl_gearbox_residual

   integer(c_int) function evl_gearbox_jacobian(handle, t, cj, y, yp, integers, reals, jacobian, status) result(code) bind(c)
      include "capi/at_state.inc"
      real(c_double), intent(in), value :: t, cj
      real(c_double), intent(in) :: yp(*)
      real(c_double), intent(inout) :: jacobian(*)

      call gearbox_jacobian(gearbox_of(handle), t, cj, y, yp, integers, reals, jacobian, s)
      code = return_code(s, status)
   end function evl_gearbox_jacobian

   integer(c_int) function evl_gearbox_derivative(handle, t, y, integers, reals, yp, status) result(code) bind(c)
      include "capi/at_state.inc"
      real(c_double), intent(in), value :: t
      real(c_double), intent(inout) :: yp(*)

      call gearbox_derivative(gearbox_of(handle), t, y, integers, reals, yp, s)
      code = return_code(s, status)
   end function evl_gearbox_derivative

   integer(c_int) function evl_gearbox_roots(handle, y, integers, reals, values, status) result(code) bind(c)
      include "capi/at_state.inc"
      real(c_double), intent(inout) :: values(*)

      call gearbox_roots(gearbox_of(handle), y, integers, reals, values, s)
      code = return_code(s, status)
   end function evl_gearbox_roots

   subroutine evl_gearbox_root_directions(handle, integers, directions) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in) :: integers(*)
      integer(c_int), intent(inout) :: directions(*)

      call gearbox_root_directions(gearbox_of(handle), integers, directions)
   end subroutine evl_gearbox_root_directions

   real(c_double) function evl_gearbox_next_time_event(handle, integers) result(time) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in) :: integers(*)

      time = gearbox_next_time_event(gearbox_of(handle), integers)
      if (time >= huge(time)) time = ieee_value(time, ieee_positive_inf)
   end function evl_gearbox_next_time_event

   integer(c_int) function evl_gearbox_apply_event(handle, t, fired, time_event, y, yp, integers, reals, events, n_events, &
                                                   status) result(code) bind(c)
      include "capi/changes_state.inc"
      real(c_double), intent(in), value :: t
      integer(c_int), intent(in) :: fired(*)
      logical(c_bool), intent(in), value :: time_event
      real(c_double), intent(inout) :: yp(*)
      type(c_event), intent(inout) :: events(*)
      integer(c_int), intent(out) :: n_events
      type(event_log) :: log
      integer :: i
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      call gearbox_apply_event(g, t, fired, logical(time_event), y, yp, integers, reals, log, s)
      n_events = min(log%n, gearbox_most_events(g))
      do i = 1, n_events
         associate (event => log%events(i))
            events(i) = c_event(event%kind, event%mesh - 1, event%tooth_pair, event%flank)
         end associate
      end do
      code = return_code(s, status)
   end function evl_gearbox_apply_event

   logical(c_bool) function evl_gearbox_warning(handle, initial, index, warning) result(exists) bind(c)
      type(c_initial), intent(in), optional :: initial
      integer(c_int), intent(in), value :: index
      type(c_status), intent(out) :: warning
      type(status_t), allocatable :: warnings(:)
      include "capi/gearbox_of_handle.inc"

      allocate (warnings, source=g%warnings)
      if (present(initial)) call warn_of_speeds(g, gearbox_initial_speeds(g, initial_from_c(initial, g)), warnings)
      exists = logical(index >= 0 .and. index < size(warnings), c_bool)
      call status_to_c(status_t(), warning)
      if (exists) call status_to_c(warnings(index + 1), warning)
   end function evl_gearbox_warning

   type(c_ptr) function evl_kernel_compiler() bind(c)
      evl_kernel_compiler = c_loc(compiler)
   end function evl_kernel_compiler

   type(c_ptr) function evl_kernel_processor() bind(c)
      evl_kernel_processor = c_loc(processor)
   end function evl_kernel_processor

   logical(c_bool) function evl_gearbox_input(handle, index, input) result(found) bind(c)
      integer(c_int), intent(in), value :: index
      type(c_input), intent(out) :: input
      integer :: w, k, before
      include "capi/gearbox_of_handle.inc"

      found = .false.
      input = c_input(0, 0, 0, .false._c_bool, 0)
      before = 0
      do w = 1, size(g%wheels)
         do k = 1, size(g%wheels(w)%loads)
            associate (load => g%loads(g%wheels(w)%loads(k))%load)
               if (.not. load%is_input) cycle
               if (before == index) then
                  input = c_input(g%wheels(w)%loads(k) - 1, w - 1, k - 1, logical(load%prescribes, c_bool), value_of(load))
                  found = .true.
                  return
               end if
               before = before + 1
            end associate
         end do
      end do
   end function evl_gearbox_input

   pure real(c_double) function value_of(load) result(value)
      class(load_t), intent(in) :: load
      real(c_double) :: damping, stiffness

      if (load%prescribes) then
         value = load%speed(0.0_c_double, 0)
      else
         call load%ask(load_point(), value, damping, stiffness)
      end if
   end function value_of

   subroutine evl_gearbox_feed(handle, load, value, rate) bind(c)
      integer(c_int), intent(in), value :: load
      real(c_double), intent(in), value :: value, rate
      include "capi/gearbox_of_handle.inc"

      call g%loads(load + 1)%load%feed(value, rate)
   end subroutine evl_gearbox_feed

   real(c_double) function evl_gearbox_wheel_speed(handle, wheel, t, y) result(speed) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel
      real(c_double), intent(in), value :: t
      real(c_double), intent(in) :: y(*)

      speed = followed_speed(gearbox_of(handle), wheel + 1, t, y)
   end function evl_gearbox_wheel_speed

end module evl_capi
