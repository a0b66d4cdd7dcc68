!> C interface of outputs: tables of outputs, all outputs at a state, selected outputs at many states (a sampler; its handle is the
!> address of a sampler_t), extremes, and positions.
!>
!> The header's sections "outputs", "extremes" and "outputs by position" document each procedure; this module converts between
!> Fortran and C.
module evl_capi_outputs
   use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_double, c_f_pointer, c_int, c_loc, c_null_ptr, c_ptr
   use evl_capi_types, only: c_name_length, c_status, c_text_length, gearbox_of, return_code, to_c
   use evl_extrema_monitor, only: mesh_states, monitored_at, monitored_of_mesh, n_cached
   use evl_friction_limits, only: check_friction_limits, has_local_friction
   use evl_gearbox, only: gearbox_t
   use evl_output, only: output_t
   use evl_output_list, only: list_extremes, list_outputs
   use evl_outputs, only: gearbox_outputs, output_sampler, sample_outputs, sampler_create
   use evl_root_points, only: most_root_teeth, root_points
   use evl_root_stress, only: n_root_points
   use evl_start_positions, only: can_turn, pitches_turned, turns_made
   use evl_static_outputs, only: list_static
   use evl_status, only: code_ok, status_t
   implicit none (type, external)
   private

   public :: c_output, evl_gearbox_can_turn, evl_gearbox_constants, evl_gearbox_driving_wheel, evl_gearbox_friction_limits, &
             evl_gearbox_has_local_friction, evl_gearbox_mesh_states, &
             evl_gearbox_output_layout, evl_gearbox_outputs, evl_gearbox_pitches, evl_gearbox_root_teeth, &
             evl_gearbox_roots_and_monitored, &
             evl_gearbox_turns, evl_gearbox_monitored, evl_gearbox_monitored_mesh, evl_sampler_ask, evl_sampler_create, &
             evl_sampler_delete, evl_sampler_in_lanes, evl_sampler_root_points, evl_table, output_to_c

   !> evl_output
   type, bind(c) :: c_output
      character(kind=c_char) :: name(c_name_length), units(c_name_length), symbol(c_name_length), long_name(c_text_length)
      integer(c_int) :: dims
      logical(c_bool) :: is_static, is_integer, is_largest
      integer(c_int) :: monitored, n
      real(c_double) :: value(2)
      character(kind=c_char) :: rate_of(c_name_length), no_rate(c_text_length)
   end type c_output

   integer, parameter :: of_static = 1, of_extremes = 2 !! evl_table_of

   !> evl_sampler
   type :: sampler_t
      type(gearbox_t), pointer :: gearbox => null()
      type(output_sampler) :: outputs
      type(status_t) :: status !! clear between calls: creating one in each call takes time
   end type sampler_t

contains

   integer(c_int) function evl_table(of, most, outputs) result(n) bind(c)
      integer(c_int), intent(in), value :: of, most
      type(c_output), intent(out) :: outputs(most)
      type(output_t), allocatable :: table(:)

      select case (of)
      case (of_extremes)
         call list_extremes(table)
      case (of_static)
         call list_static(table)
      case default
         call list_outputs(table)
      end select
      n = size(table)
      call output_to_c(table(:min(n, most)), outputs(:min(n, most)))
   end function evl_table

   subroutine evl_gearbox_output_layout(handle, offsets, counts) bind(c)
      integer(c_int), intent(out) :: offsets(*), counts(*)
      include "capi/gearbox_of_handle.inc"

      offsets(:size(g%output_offsets)) = g%output_offsets
      counts(:size(g%output_counts)) = g%output_counts
   end subroutine evl_gearbox_output_layout

   subroutine evl_gearbox_constants(handle, values) bind(c)
      real(c_double), intent(out) :: values(*)
      include "capi/gearbox_of_handle.inc"

      values(:g%n_values) = g%constants
   end subroutine evl_gearbox_constants

   integer(c_int) function evl_gearbox_outputs(handle, t, y, integers, reals, check, values, status) result(code) bind(c)
      include "capi/at_state.inc"
      real(c_double), intent(in), value :: t
      logical(c_bool), intent(in), value :: check
      real(c_double), intent(inout) :: values(*)

      call gearbox_outputs(gearbox_of(handle), t, y, integers, reals, logical(check), values, s)
      code = return_code(s, status)
   end function evl_gearbox_outputs

   elemental subroutine output_to_c(entry, output)
      type(output_t), intent(in) :: entry
      type(c_output), intent(out) :: output

      call to_c(entry%name, output%name)
      call to_c(entry%units, output%units)
      call to_c(entry%symbol, output%symbol)
      call to_c(entry%long_name, output%long_name)
      output%dims = entry%dims
      output%is_static = logical(entry%is_static, c_bool)
      output%is_integer = logical(entry%is_integer, c_bool)
      output%is_largest = logical(entry%is_largest, c_bool)
      output%monitored = entry%monitored - 1
      output%n = entry%length
      output%value = entry%value(:2)
      call to_c(entry%rate_of, output%rate_of)
      call to_c(entry%no_rate, output%no_rate)
   end subroutine output_to_c

   integer(c_int) function evl_gearbox_driving_wheel(handle, mesh) result(wheel) bind(c)
      integer(c_int), intent(in), value :: mesh
      include "capi/gearbox_of_handle.inc"

      wheel = g%contacts(g%first(mesh + 1))%wheel_a - 1
   end function evl_gearbox_driving_wheel

   logical(c_bool) function evl_gearbox_can_turn(handle, wheel, y, yp) result(may) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel
      real(c_double), intent(in) :: y(*), yp(*)

      may = logical(can_turn(gearbox_of(handle), wheel + 1, y, yp), c_bool)
   end function evl_gearbox_can_turn

   real(c_double) function evl_gearbox_pitches(handle, mesh, y, integers) result(pitches) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      real(c_double), intent(in) :: y(*)
      integer(c_int), intent(in) :: integers(*)

      pitches = pitches_turned(gearbox_of(handle), mesh + 1, y, integers)
   end function evl_gearbox_pitches

   real(c_double) function evl_gearbox_turns(handle, wheel, y, integers) result(turns) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel
      real(c_double), intent(in) :: y(*)
      integer(c_int), intent(in) :: integers(*)

      turns = turns_made(gearbox_of(handle), wheel + 1, y, integers)
   end function evl_gearbox_turns

   integer(c_int) function evl_gearbox_monitored(handle, y, integers, reals, values, status) result(code) bind(c)
      include "capi/at_state.inc"
      real(c_double), intent(inout) :: values(*)

      call monitored_at(gearbox_of(handle), y, integers, reals, values, s)
      code = return_code(s, status)
   end function evl_gearbox_monitored

   integer(c_int) function evl_gearbox_monitored_mesh(handle, mesh, y, integers, reals, values, status) result(code) bind(c)
      include "capi/at_state.inc"
      integer(c_int), intent(in), value :: mesh
      real(c_double), intent(inout) :: values(*)

      call monitored_of_mesh(gearbox_of(handle), mesh + 1, y, integers, reals, values, s)
      code = return_code(s, status)
   end function evl_gearbox_monitored_mesh

   logical(c_bool) function evl_gearbox_has_local_friction(handle) result(has) bind(c)
      include "capi/gearbox_of_handle.inc"

      has = logical(has_local_friction(g), c_bool)
   end function evl_gearbox_has_local_friction

   integer(c_int) function evl_gearbox_friction_limits(handle, y, integers, reals, status) result(code) bind(c)
      include "capi/at_state.inc"

      call check_friction_limits(gearbox_of(handle), y, integers, reals, s)
      code = return_code(s, status)
   end function evl_gearbox_friction_limits

   integer(c_int) function evl_gearbox_mesh_states(handle, mesh, states) result(n) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      integer(c_int), intent(inout) :: states(*)
      integer, allocatable :: found(:)

      call mesh_states(gearbox_of(handle), mesh + 1, found)
      n = size(found)
      states(:n) = found - 1
   end function evl_gearbox_mesh_states

   integer(c_int) function evl_gearbox_roots_and_monitored(handle, y, integers, reals, near, highest, cached, roots, values, &
                                                           status) result(code) bind(c)
      include "capi/at_state.inc"
      real(c_double), intent(in) :: highest(*)
      real(c_double), intent(in), value :: near
      real(c_double), intent(inout) :: cached(n_cached, *), roots(*), values(*)

      call monitored_at(gearbox_of(handle), y, integers, reals, values, s, roots, near, highest, cached)
      code = return_code(s, status)
   end function evl_gearbox_roots_and_monitored

   type(c_ptr) function evl_sampler_create(gearbox_handle, n, requested) result(handle) bind(c)
      type(c_ptr), intent(in), value :: gearbox_handle
      integer(c_int), intent(in), value :: n
      integer(c_int), intent(in) :: requested(n)
      type(sampler_t), pointer :: self

      allocate (self)
      self%gearbox => gearbox_of(gearbox_handle)
      call sampler_create(self%outputs, self%gearbox, requested + 1)
      handle = c_loc(self)
   end function evl_sampler_create

   logical(c_bool) function evl_sampler_in_lanes(handle) result(in_lanes) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(sampler_t), pointer :: self

      call c_f_pointer(handle, self)
      in_lanes = logical(self%outputs%states%in_lanes, c_bool)
   end function evl_sampler_in_lanes

   subroutine evl_sampler_delete(handle) bind(c)
      type(sampler_t), pointer :: self
      include "capi/delete_of_handle.inc"
   end subroutine evl_sampler_delete

   integer(c_int) function evl_sampler_ask(handle, n, n_meant, t, y, integers, reals, check, values, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: n, n_meant
      logical(c_bool), intent(in), value :: check
      real(c_double), intent(in) :: t(n), reals(*)
      real(c_double), intent(in), target :: y(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(inout), target :: values(*)
      type(c_status), intent(inout), optional :: status
      real(c_double), pointer, contiguous :: rows(:, :), states(:, :)
      type(sampler_t), pointer :: self

      call c_f_pointer(handle, self)
      associate (g => self%gearbox, n_values => self%outputs%before(size(self%outputs%before)))
         rows(1:n, 1:n_values) => values(:n*n_values)
         states(1:n, 1:g%n_states) => y(:g%n_states*n)
         call sample_outputs(self%outputs, g, n_meant, t, states, integers, reals, logical(check), rows, self%status)
      end associate
      code = return_code(self%status, status)
      if (code /= code_ok) self%status = status_t()
   end function evl_sampler_ask

   integer(c_int) function evl_gearbox_root_teeth(handle) result(n) bind(c)
      include "capi/gearbox_of_handle.inc"

      n = most_root_teeth(g)
   end function evl_gearbox_root_teeth

   integer(c_int) function evl_sampler_root_points(handle, wheel, most, n, values) result(n_teeth) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel, most, n
      real(c_double), intent(inout) :: values(n, n_root_points, 2, most)
      type(sampler_t), pointer :: self

      call c_f_pointer(handle, self)
      call root_points(self%gearbox, self%outputs%states, wheel + 1, values, n_teeth)
   end function evl_sampler_root_points

end module evl_capi_outputs
