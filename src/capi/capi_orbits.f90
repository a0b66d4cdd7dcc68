!> C interface of the continuation of periodic orbits of a gearbox over one parameter.
!>
!> The header's section "orbits" documents each procedure; this module converts between C and Fortran.
module evl_capi_orbits
   use, intrinsic :: iso_c_binding, only: c_associated, c_bool, c_char, c_double, c_f_pointer, c_f_procpointer, c_funptr, c_int, &
                                                                             c_loc, c_null_char, c_null_ptr, c_ptr
   use evl_branch, only: advance_branch, append_point, begin_branch
   use evl_branch_doubling, only: switch_at_doubling
   use evl_branch_point, only: branch_point, kind_grazing, kind_grazing_fold
   use evl_capi_types, only: c_name_length, c_status, return_code, to_c
   use evl_gearbox_orbits, only: gearbox_orbits_create, gearbox_orbits_start, gearbox_orbits_state
   use evl_kinds, only: wp
   use evl_multipliers, only: are_inside
   use evl_orbits_session, only: add_branch, complete, orbits_t
   use evl_periodic_orbit, only: orbit_t, own_multipliers
   use evl_shooting, only: find_orbit
   use evl_status, only: code_no_memory, code_ok, fail, has_failed, status_t
   implicit none (type, external)
   private

   public :: evl_orbits_advance, evl_orbits_begin, evl_orbits_create, evl_orbits_delete, evl_orbits_find, evl_orbits_point, &
             evl_orbits_state, evl_orbits_switch

   !> evl_orbits_setup
   type, bind(c) :: c_setup
      type(c_ptr) :: self
      type(c_funptr) :: take, record
      real(c_double) :: from, to, position, tolerance, residual, first_step, smallest_step, largest_step, straight_step, &
                        largest_change
      integer(c_int) :: most_points, n_values
      type(c_ptr) :: values
   end type c_setup

   !> evl_orbit
   type, bind(c) :: c_orbit
      real(c_double) :: parameter, period, residual
      integer(c_int) :: periods, kind = 0, mesh = -1, iterations, n_multipliers, recorded = 0
      logical(c_bool) :: is_stable, whole_mesh = .false.
      character(kind=c_char) :: root(c_name_length) = c_null_char
   end type c_orbit

contains

   type(c_ptr) function evl_orbits_create(setup, value, status) result(handle) bind(c)
      type(c_setup), intent(in) :: setup
      real(c_double), intent(in), value :: value
      type(c_status), intent(inout), optional :: status
      type(orbits_t), pointer :: self
      real(c_double), pointer :: values(:)
      type(status_t) :: s
      integer :: stat, code

      handle = c_null_ptr
      allocate (self, stat=stat)
      if (stat /= 0) then
         call fail(s, code_no_memory, "there is not enough memory for orbits")
         code = return_code(s, status)
         return
      end if
      self%family%self = setup%self
      call c_f_procpointer(setup%take, self%family%ask)
      if (c_associated(setup%record)) then
         self%recorder%self = setup%self
         call c_f_procpointer(setup%record, self%recorder%ask)
         self%recorder%model => self%model
         self%options%recorder => self%recorder
      end if
      associate (o => self%options)
         o%from = min(setup%from, setup%to)
         o%to = max(setup%from, setup%to)
         o%first_step = setup%first_step
         o%smallest_step = setup%smallest_step
         o%largest_step = setup%largest_step
         o%straight_step = setup%straight_step
         o%largest_change = setup%largest_change
         o%most_points = setup%most_points
         o%orbits%tolerance = setup%tolerance
         o%orbits%residual = setup%residual
         o%orbits%parameter_scale = o%to - o%from
      end associate
      if (setup%n_values > 0) then
         call c_f_pointer(setup%values, values, [setup%n_values])
         self%options%values = values
         if (values(1) > values(setup%n_values)) self%options%values = values(setup%n_values:1:-1)
      end if
      allocate (self%branches(4))
      call gearbox_orbits_create(self%model, self%family, value, setup%position, s)
      code = return_code(s, status)
      if (code == code_ok) then
         handle = c_loc(self)
      else
         deallocate (self)
      end if
   end function evl_orbits_create

   subroutine evl_orbits_delete(handle) bind(c)
      type(orbits_t), pointer :: self
      include "capi/delete_of_handle.inc"
   end subroutine evl_orbits_delete

   integer(c_int) function evl_orbits_find(handle, value, periods, period, y, integers, reals, orbit, status) result(code) bind(c)
      include "capi/at_state.inc"
      real(c_double), intent(in), value :: value, period
      integer(c_int), intent(in), value :: periods
      type(c_orbit), intent(out) :: orbit
      type(orbits_t), pointer :: self

      call c_f_pointer(handle, self)
      call self%model%set_parameter(value, s)
      if (.not. has_failed(s)) then
         block
            real(wp) :: start(self%model%n)

            associate (g => self%model%gearbox)
               call gearbox_orbits_start(self%model, y(:g%n_states), integers(1), reals(:size(g%contacts)), start)
            end associate
            call find_orbit(self%model, self%options%orbits, value, periods, start, period, self%orbit, s)
         end block
      end if
      if (.not. has_failed(s)) call record(self, self%orbit, orbit)
      code = return_code(s, status)
   end function evl_orbits_find

   integer(c_int) function evl_orbits_begin(handle, rising, n, status) result(code) bind(c)
      logical(c_bool), intent(in), value :: rising
      integer(c_int), intent(out) :: n
      type(c_status), intent(inout), optional :: status
      type(status_t) :: s
      include "capi/orbits_of_handle.inc"

      call add_branch(self)
      self%options%rising = rising
      self%before = 0
      call begin_branch(self%model, self%options, self%orbit, self%walk, s)
      associate (branch => self%branches(self%n_branches))
         if (.not. has_failed(s)) call append_point(branch%points, branch%n, self%walk%first)
         n = branch%n
      end associate
      code = return_code(s, status)
   end function evl_orbits_begin

   integer(c_int) function evl_orbits_advance(handle, n, is_over, status) result(code) bind(c)
      integer(c_int), intent(out) :: n
      logical(c_bool), intent(out) :: is_over
      type(c_status), intent(inout), optional :: status
      type(branch_point), allocatable :: more(:)
      type(status_t) :: s
      integer :: i
      include "capi/orbits_of_handle.inc"

      call advance_branch(self%model, self%options, self%walk, more, s)
      associate (branch => self%branches(self%n_branches))
         self%before = merge(branch%n, 0, allocated(self%walk%before%tangent)) ! behind a grazing point the predictor starts anew
         do i = 1, size(more)
            call append_point(branch%points, branch%n, more(i))
         end do
         n = branch%n
      end associate
      is_over = self%walk%is_over
      code = return_code(s, status)
   end function evl_orbits_advance

   integer(c_int) function evl_orbits_switch(handle, branch, point, distance, status) result(code) bind(c)
      integer(c_int), intent(in), value :: branch, point
      real(c_double), intent(in), value :: distance
      type(c_status), intent(inout), optional :: status
      type(status_t) :: s
      include "capi/orbits_of_handle.inc"

      call complete(self, self%branches(branch + 1)%points(point + 1), s)
      associate (from => self%branches(branch + 1)%points(point + 1)%orbit)
         if (.not. has_failed(s)) call self%model%set_parameter(from%parameter, s)
         if (.not. has_failed(s)) call switch_at_doubling(self%model, self%options%orbits, from, distance, self%orbit, s)
      end associate
      code = return_code(s, status)
   end function evl_orbits_switch

   subroutine evl_orbits_point(handle, branch, point, orbit, multipliers) bind(c)
      integer(c_int), intent(in), value :: branch, point
      type(c_orbit), intent(out) :: orbit
      real(c_double), intent(inout) :: multipliers(2, *)
      complex(wp), allocatable :: mu(:)
      integer :: i
      include "capi/orbits_of_handle.inc"

      associate (at => self%branches(branch + 1)%points(point + 1))
         call record(self, at%orbit, orbit)
         orbit%kind = at%kind
         orbit%recorded = at%recorded
         if (at%kind == kind_grazing .or. at%kind == kind_grazing_fold) then
            orbit%mesh = self%model%root_list(at%root)%mesh - 1
            orbit%whole_mesh = logical(is_whole_mesh(self, at%root, at%orbit), c_bool)
            call to_c(trim(self%model%root_list(at%root)%name), orbit%root)
         end if
         allocate (mu, source=own_multipliers(self%model, at%orbit))
      end associate
      do i = 1, size(mu)
         multipliers(:, i) = [mu(i)%re, mu(i)%im]
      end do
   end subroutine evl_orbits_point

   integer(c_int) function evl_orbits_state(handle, branch, point, t, y, integers, reals, status) result(code) bind(c)
      include "capi/changes_state.inc"
      integer(c_int), intent(in), value :: branch, point
      real(c_double), intent(out) :: t
      type(orbits_t), pointer :: self

      call c_f_pointer(handle, self)
      if (branch < 0) then
         call state_of(self, self%orbit, t, y, integers, reals, s)
      else
         call state_of(self, self%branches(branch + 1)%points(point + 1)%orbit, t, y, integers, reals, s)
      end if
      code = return_code(s, status)
   end function evl_orbits_state

   !> State of an orbit on the section.
   subroutine state_of(self, orbit, t, y, integers, reals, status)
      type(orbits_t), intent(inout) :: self
      type(orbit_t), intent(in) :: orbit
      real(c_double), intent(out) :: t
      real(c_double), intent(inout) :: y(*), reals(*)
      integer(c_int), intent(inout) :: integers(*)
      type(status_t), intent(inout) :: status

      t = 0
      call self%model%set_parameter(orbit%parameter, status)
      if (has_failed(status)) return
      associate (g => self%model%gearbox)
         call gearbox_orbits_state(self%model, orbit%y, y(:g%n_states), integers(:g%n_integers), reals(:size(g%contacts)), status)
      end associate
      t = self%model%phase
   end subroutine state_of

   !> Data of an orbit for C.
   subroutine record(self, orbit, recorded)
      type(orbits_t), intent(in) :: self
      type(orbit_t), intent(in) :: orbit
      type(c_orbit), intent(out) :: recorded

      associate (mu => own_multipliers(self%model, orbit))
         recorded%n_multipliers = size(mu)
         recorded%is_stable = are_inside(mu)
      end associate
      recorded%parameter = orbit%parameter
      recorded%period = orbit%period
      recorded%residual = orbit%residual
      recorded%periods = orbit%periods
      recorded%iterations = orbit%iterations
   end subroutine record

   !> Whether a mesh loses or gains contact as a whole at a grazing point: no other tooth pair is in contact there, or all that are
   !> separate together with it, such as pairs that share a load evenly.
   pure logical function is_whole_mesh(self, root, orbit) result(whole)
      type(orbits_t), intent(in) :: self
      integer, intent(in) :: root
      type(orbit_t), intent(in) :: orbit
      real(wp), parameter :: near = 1.0e-6_wp, as_near = 100
      real(wp) :: theta(self%model%n_roots)
      logical :: same(self%model%n_roots)
      integer :: i

      whole = .true.
      if (.not. allocated(orbit%flow%others)) return
      theta = min(orbit%flow%nearest, orbit%flow%slowest)
      same = [(self%model%root_list(i)%mesh == self%model%root_list(root)%mesh .and. &
               self%model%root_list(i)%name == self%model%root_list(root)%name, i=1, self%model%n_roots)]
      same = same .and. theta < huge(theta)/2
      same = same .and. theta <= max(as_near*theta(root), near*maxval(theta, same))
      whole = orbit%flow%others(root) < max(1, count(same))
   end function is_whole_mesh

end module evl_capi_orbits
