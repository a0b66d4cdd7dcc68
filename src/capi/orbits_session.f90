!> Session of a continuation of periodic orbits behind the C interface: callbacks, results so far, the saved points of an
!> interrupted continuation, and its resumption.
!>
!> The header's section "orbits" documents the C procedures.
module evl_orbits_session
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_null_ptr, c_ptr
   use evl_branch, only: append_point, branch_options, branch_state
   use evl_branch_point, only: branch_point, orbit_recorder
   use evl_capi_types, only: c_status, gearbox_of, return_code, status_from_c
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_orbits, only: gearbox_family, gearbox_orbits, gearbox_orbits_arrive, gearbox_orbits_state
   use evl_kinds, only: wp
   use evl_periodic_orbit, only: orbit_t
   use evl_shooting, only: correct_orbit
   use evl_status, only: code_no_solution, code_ok, fail, has_failed, status_t
   implicit none (type, external)
   private

   public :: add_branch, c_take, c_record, complete, evl_orbits_go_on, evl_orbits_save, evl_orbits_record_length, evl_orbits_put, &
             evl_orbits_walk, orbits_t

   abstract interface
      integer(c_int) function c_take(self, value, gearbox, scale, status) bind(c)
         import :: c_double, c_int, c_ptr, c_status
         implicit none (type, external)
         type(c_ptr), value :: self
         real(c_double), value :: value
         type(c_ptr), intent(out) :: gearbox, scale
         type(c_status), intent(inout) :: status
      end function c_take

      integer(c_int) function c_record(self, number, periods, period, t, y, integers, reals, status) bind(c)
         import :: c_double, c_int, c_ptr, c_status
         implicit none (type, external)
         type(c_ptr), value :: self
         integer(c_int), value :: number, periods
         real(c_double), intent(inout) :: period, y(*), reals(*)
         real(c_double), value :: t
         integer(c_int), intent(inout) :: integers(*)
         type(c_status), intent(inout) :: status
      end function c_record
   end interface

   type, extends(gearbox_family) :: callers_family
      type(c_ptr) :: self = c_null_ptr
      procedure(c_take), pointer, nopass :: ask => null()
   contains
      procedure :: take
   end type callers_family

   type, extends(orbit_recorder) :: callers_recorder
      type(c_ptr) :: self = c_null_ptr
      procedure(c_record), pointer, nopass :: ask => null()
      type(gearbox_orbits), pointer :: model => null()
   contains
      procedure :: record => record_by_caller
   end type callers_recorder

   type :: points_t
      type(branch_point), allocatable :: points(:)
      integer :: n = 0 !! number of points
   end type points_t

   !> evl_orbits
   type :: orbits_t
      type(callers_family) :: family
      type(callers_recorder) :: recorder
      type(gearbox_orbits) :: model
      type(branch_options) :: options
      type(orbit_t) :: orbit                      !! the last one found, or switched to
      type(points_t), allocatable :: branches(:)
      integer :: n_branches = 0
      type(branch_state) :: walk                   !! continuation of the last branch
      integer :: before = 0                       !! number of the ordinary point before the last; 0: none
   end type orbits_t

   !> evl_orbits_progress
   type, bind(c) :: c_walk
      real(c_double) :: step
      integer(c_int) :: crawls, n_ordinary, before, is_smooth
   end type c_walk

   integer, parameter :: n_fixed = 9 !! length of the saved record of a point, without its arrays; the last number is not used

contains

   !> Get a gearbox from the caller.
   subroutine take(self, value, gearbox, scale, status)
      class(callers_family), intent(inout) :: self
      real(wp), intent(in) :: value
      type(gearbox_t), pointer, intent(out) :: gearbox
      real(wp), allocatable, intent(out) :: scale(:)
      type(status_t), intent(inout) :: status
      type(c_ptr) :: handle, scale_handle
      real(c_double), pointer :: of_caller(:)
      type(c_status) :: refusal

      gearbox => null()
      if (self%ask(self%self, value, handle, scale_handle, refusal) /= code_ok) then
         status = status_from_c(refusal)
         return
      end if
      gearbox => gearbox_of(handle)
      call c_f_pointer(scale_handle, of_caller, [gearbox%n_states])
      scale = of_caller
   end subroutine take

   !> Let the caller integrate a candidate orbit and record its results.
   subroutine record_by_caller(self, number, orbit, status)
      class(callers_recorder), intent(inout) :: self
      integer, intent(in) :: number
      type(orbit_t), intent(inout) :: orbit
      type(status_t), intent(inout) :: status
      type(c_status) :: refusal

      associate (model => self%model, g => self%model%gearbox)
         block
            real(c_double) :: y(g%n_states), reals(size(g%contacts))
            integer(c_int) :: integers(g%n_integers)

            call gearbox_orbits_state(model, orbit%y, y, integers, reals, status)
            if (has_failed(status)) return
            if (self%ask(self%self, number, orbit%periods, orbit%period, model%phase, y, integers, reals, refusal) /= code_ok) then
               call fail(status, code_no_solution, "its result could not be reported")
               return
            end if
            call gearbox_orbits_arrive(model, y, integers, reals, orbit%flow%y, orbit%flow%same_modes)
            call model%rhs(model%phase, orbit%flow%y, orbit%flow%rate, status)
         end block
      end associate
   end subroutine record_by_caller

   !> Append an empty branch.
   subroutine add_branch(self)
      type(orbits_t), intent(inout) :: self
      type(points_t), allocatable :: more(:)
      integer :: i

      if (self%n_branches == size(self%branches)) then
         allocate (more(2*self%n_branches))
         do i = 1, self%n_branches
            call move_alloc(self%branches(i)%points, more(i)%points)
            more(i)%n = self%branches(i)%n
         end do
         call move_alloc(more, self%branches)
      end if
      self%n_branches = self%n_branches + 1
      allocate (self%branches(self%n_branches)%points(64))
   end subroutine add_branch

   !> Recompute the data of a point that are not saved: its flow and derived quantities.
   subroutine complete(self, point, status)
      type(orbits_t), intent(inout) :: self
      type(branch_point), intent(inout) :: point
      type(status_t), intent(inout) :: status
      integer :: iterations

      if (allocated(point%orbit%multipliers)) return
      iterations = point%orbit%iterations
      call correct_orbit(self%model, self%options%orbits, point%orbit, status) ! already converged: no correction is needed
      point%orbit%iterations = iterations
   end subroutine complete

   integer(c_int) function evl_orbits_record_length(handle) result(n) bind(c)
      include "capi/orbits_of_handle.inc"

      n = n_fixed + 3*self%model%n + 2
   end function evl_orbits_record_length

   subroutine evl_orbits_save(handle, branch, point, numbers) bind(c)
      integer(c_int), intent(in), value :: branch, point
      real(c_double), intent(inout) :: numbers(*)
      include "capi/orbits_of_handle.inc"

      associate (at => self%branches(branch + 1)%points(point + 1), n => self%model%n)
         associate (o => at%orbit)
            numbers(:n_fixed) = [real(wp) :: o%parameter, o%period, o%residual, at%arclength, o%periods, o%iterations, at%kind, &
                                 at%root, 0]
            numbers(n_fixed + 1:n_fixed + n) = o%y
            numbers(n_fixed + n + 1:n_fixed + 3*n + 2) = 0
            if (allocated(o%by_parameter)) numbers(n_fixed + n + 1:n_fixed + 2*n) = o%by_parameter
            if (allocated(o%tangent)) numbers(n_fixed + 2*n + 1:n_fixed + 3*n + 2) = o%tangent
         end associate
      end associate
   end subroutine evl_orbits_save

   subroutine evl_orbits_put(handle, branch, numbers) bind(c)
      integer(c_int), intent(in), value :: branch
      real(c_double), intent(in), optional :: numbers(*)
      type(branch_point) :: at
      include "capi/orbits_of_handle.inc"

      if (branch >= self%n_branches) call add_branch(self)
      if (.not. present(numbers)) return
      associate (n => self%model%n, o => at%orbit)
         o%parameter = numbers(1)
         o%period = numbers(2)
         o%residual = numbers(3)
         at%arclength = numbers(4)
         o%periods = nint(numbers(5))
         o%iterations = nint(numbers(6))
         at%kind = nint(numbers(7))
         at%root = nint(numbers(8))
         o%y = numbers(n_fixed + 1:n_fixed + n)
         o%by_parameter = numbers(n_fixed + n + 1:n_fixed + 2*n)
         o%tangent = numbers(n_fixed + 2*n + 1:n_fixed + 3*n + 2)
      end associate
      associate (to => self%branches(branch + 1))
         call append_point(to%points, to%n, at)
      end associate
   end subroutine evl_orbits_put

   subroutine evl_orbits_walk(handle, walk) bind(c)
      type(c_walk), intent(out) :: walk
      include "capi/orbits_of_handle.inc"

      walk = c_walk(self%walk%step, self%walk%crawls, self%walk%n_ordinary, self%before, merge(1, 0, self%walk%is_smooth))
   end subroutine evl_orbits_walk

   integer(c_int) function evl_orbits_go_on(handle, walk, status) result(code) bind(c)
      type(c_walk), intent(in) :: walk
      type(c_status), intent(inout), optional :: status
      type(status_t) :: s
      include "capi/orbits_of_handle.inc"

      associate (branch => self%branches(self%n_branches))
         call complete(self, branch%points(1), s)
         if (.not. has_failed(s)) call complete(self, branch%points(branch%n), s)
         self%walk%first = branch%points(1)
         self%walk%now = branch%points(branch%n)
         self%walk%step = walk%step
         self%walk%crawls = walk%crawls
         self%walk%n_ordinary = walk%n_ordinary
         self%walk%is_smooth = walk%is_smooth /= 0
         self%walk%is_over = .false.
         self%before = walk%before
         if (self%before > 0 .and. .not. has_failed(s)) then
            call complete(self, branch%points(self%before), s)
            self%walk%before = branch%points(self%before)%orbit
         end if
      end associate
      code = return_code(s, status)
   end function evl_orbits_go_on

end module evl_orbits_session
