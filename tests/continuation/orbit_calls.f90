!> The search for orbits as C functions, for tests; no part of the kernel's interface.
module orbit_calls
   use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_double, c_f_pointer, c_int, c_loc, c_null_char, c_ptr
   use evl_branch, only: branch_options, follow_branch
   use evl_branch_doubling, only: switch_at_doubling
   use evl_branch_point, only: branch_point, orbit_recorder
   use evl_flow, only: flow_t, follow
   use evl_kinds, only: wp
   use evl_periodic_orbit, only: orbit_t
   use evl_shooting, only: find_orbit
   use evl_status, only: clear, has_failed, status_t
   use orbit_systems, only: orbit_system, orbit_system_create
   implicit none (type, external)
   private

   public :: ot_new, ot_delete, ot_message, ot_flow, ot_find, ot_follow, ot_switch, ot_point, ot_options
   public :: ot_values, ot_is_recorded

   !> Tells nothing of an orbit, but follows it once round, as one does who tells of it.
   type, extends(orbit_recorder) :: silent_recorder
      type(orbit_system), pointer :: model => null()
      real(wp) :: tolerance = 0
   contains
      procedure :: record => follow_round
   end type silent_recorder

   !> A system and the points of a branch.
   type :: session_t
      type(orbit_system) :: model
      type(branch_options) :: options
      type(silent_recorder) :: recorder
      type(branch_point), allocatable :: points(:)
      type(status_t) :: status
   end type session_t

contains

   type(c_ptr) function ot_new(kind, n, p, varied) result(handle) bind(c)
      integer(c_int), value :: kind, n
      real(c_double), intent(in) :: p(n)
      integer(c_int), value :: varied !! from 0
      type(session_t), pointer :: session

      allocate (session)
      call orbit_system_create(session%model, int(kind), p, varied + 1)
      allocate (session%points(0))
      handle = c_loc(session)
   end function ot_new

   subroutine ot_delete(handle) bind(c)
      type(c_ptr), value :: handle
      type(session_t), pointer :: session

      call c_f_pointer(handle, session)
      deallocate (session)
   end subroutine ot_delete

   !> The last error, empty if there is none.
   subroutine ot_message(handle, message) bind(c)
      type(c_ptr), value :: handle
      character(kind=c_char), intent(out) :: message(401)
      type(session_t), pointer :: session
      integer :: i

      call c_f_pointer(handle, session)
      message = c_null_char
      if (.not. has_failed(session%status)) return
      do i = 1, min(400, len_trim(session%status%message))
         message(i) = session%status%message(i:i)
      end do
   end subroutine ot_message

   subroutine ot_options(handle, tolerance, scale, from, to, rising, first, smallest, largest, most) bind(c)
      type(c_ptr), value :: handle
      real(c_double), value :: tolerance, scale, from, to, first, smallest, largest
      logical(c_bool), value :: rising
      integer(c_int), value :: most
      type(session_t), pointer :: session

      call c_f_pointer(handle, session)
      session%options%orbits%tolerance = tolerance
      session%options%orbits%parameter_scale = scale
      session%options%from = from
      session%options%to = to
      session%options%rising = rising
      session%options%first_step = first
      session%options%smallest_step = smallest
      session%options%largest_step = largest
      session%options%most_points = most
   end subroutine ot_options

   !> Ask for the stable orbits at these values of the parameter, rising; they are told of.
   subroutine ot_values(handle, n, values) bind(c)
      type(c_ptr), value :: handle
      integer(c_int), value :: n
      real(c_double), intent(in) :: values(n)
      type(session_t), pointer :: session

      call c_f_pointer(handle, session)
      session%options%values = values
      session%recorder%model => session%model
      session%recorder%tolerance = session%options%orbits%tolerance
      session%options%recorder => session%recorder
   end subroutine ot_values

   !> Once round, without a derivative.
   subroutine follow_round(self, number, orbit, status)
      class(silent_recorder), intent(inout) :: self
      integer, intent(in) :: number
      type(orbit_t), intent(inout) :: orbit
      type(status_t), intent(inout) :: status
      type(flow_t) :: flow

      call follow(self%model, orbit%y, orbit%periods, orbit%period, self%tolerance, .false., flow, status)
      if (has_failed(status)) return
      orbit%flow%y = flow%y
      orbit%flow%rate = flow%rate
      orbit%flow%same_modes = flow%same_modes
   end subroutine follow_round

   !> A flow and its derivative; numbers: steps, ties, whether the modes repeat, crossings.
   integer(c_int) function ot_flow(handle, parameter, y, duration, end, derivative, numbers) result(code) bind(c)
      type(c_ptr), value :: handle
      real(c_double), value :: parameter, duration
      real(c_double), intent(in) :: y(*)
      real(c_double), intent(out) :: end(*), derivative(*)
      integer(c_int), intent(out) :: numbers(4)
      type(session_t), pointer :: session
      type(flow_t) :: flow

      call c_f_pointer(handle, session)
      call clear(session%status)
      associate (n => session%model%n)
         call session%model%set_parameter(parameter, session%status)
         if (.not. has_failed(session%status)) &
            call follow(session%model, y(:n), 1, duration, session%options%orbits%tolerance, .true., flow, session%status)
         code = session%status%code
         if (has_failed(session%status)) return
         end(:n) = flow%y
         derivative(:n*n) = reshape(flow%derivative, [n*n])
         numbers = [flow%steps, flow%ties, merge(1, 0, flow%same_modes), sum(flow%crossings)]
      end associate
   end function ot_flow

   !> Newton's iteration; the orbit is the only point then.
   integer(c_int) function ot_find(handle, parameter, periods, y, period) result(code) bind(c)
      type(c_ptr), value :: handle
      real(c_double), value :: parameter, period
      integer(c_int), value :: periods
      real(c_double), intent(in) :: y(*)
      type(session_t), pointer :: session
      type(orbit_t) :: orbit

      call c_f_pointer(handle, session)
      call clear(session%status)
      call find_orbit(session%model, session%options%orbits, parameter, int(periods), y(:session%model%n), period, orbit, &
                      session%status)
      code = session%status%code
      if (has_failed(session%status)) return
      deallocate (session%points)
      allocate (session%points(1))
      session%points(1)%orbit = orbit
   end function ot_find

   !> Follow the branch of a point; those found replace all.
   integer(c_int) function ot_follow(handle, index, with_tangent, n) result(code) bind(c)
      type(c_ptr), value :: handle
      integer(c_int), value :: index !! from 0
      logical(c_bool), value :: with_tangent !! on the way that it has
      integer(c_int), intent(out) :: n
      type(session_t), pointer :: session
      type(orbit_t) :: orbit

      call c_f_pointer(handle, session)
      call clear(session%status)
      orbit = session%points(index + 1)%orbit
      if (.not. with_tangent .and. allocated(orbit%tangent)) deallocate (orbit%tangent)
      call follow_branch(session%model, session%options, orbit, session%points, session%status)
      n = size(session%points)
      code = session%status%code
   end function ot_follow

   !> From a doubling to the orbit of twice the period, which is the only point then.
   integer(c_int) function ot_switch(handle, index, distance) result(code) bind(c)
      type(c_ptr), value :: handle
      integer(c_int), value :: index !! from 0
      real(c_double), value :: distance
      type(session_t), pointer :: session
      type(orbit_t) :: orbit

      call c_f_pointer(handle, session)
      call clear(session%status)
      call switch_at_doubling(session%model, session%options%orbits, session%points(index + 1)%orbit, distance, orbit, &
                              session%status)
      code = session%status%code
      if (has_failed(session%status)) return
      deallocate (session%points)
      allocate (session%points(1))
      session%points(1)%orbit = orbit
   end function ot_switch

   !> Whether a point was told of, and has no derivative.
   integer(c_int) function ot_is_recorded(handle, index) result(recorded) bind(c)
      type(c_ptr), value :: handle
      integer(c_int), value :: index !! from 0
      type(session_t), pointer :: session

      call c_f_pointer(handle, session)
      recorded = merge(1, 0, session%points(index + 1)%recorded > 0)
   end function ot_is_recorded

   !> numbers: parameter, period, residual, way; counts: kind, root from 1, iterations, periods, multipliers.
   subroutine ot_point(handle, index, y, numbers, counts, re, im, tangent) bind(c)
      type(c_ptr), value :: handle
      integer(c_int), value :: index !! from 0
      real(c_double), intent(out) :: y(*), numbers(4), re(*), im(*), tangent(*)
      integer(c_int), intent(out) :: counts(5)
      type(session_t), pointer :: session

      call c_f_pointer(handle, session)
      associate (point => session%points(index + 1), orbit => session%points(index + 1)%orbit, n => session%model%n)
         y(:n) = orbit%y
         numbers = [orbit%parameter, orbit%period, orbit%residual, point%arclength]
         counts = [point%kind, point%root, orbit%iterations, orbit%periods, size(orbit%multipliers)]
         re(:counts(5)) = real(orbit%multipliers, wp)
         im(:counts(5)) = aimag(orbit%multipliers)
         tangent(:n + 2) = 0
         if (allocated(orbit%tangent)) tangent(:n + 2) = orbit%tangent
      end associate
   end subroutine ot_point

end module orbit_calls
