!> C interface of the search for periodic orbits of a gearbox over one parameter.
!>
!> The header's section "orbits" documents each procedure; here is only the passage from C to Fortran.
module evl_capi_orbits
   use, intrinsic :: iso_c_binding, only: c_associated, c_bool, c_char, c_double, c_double_complex, c_f_pointer, c_f_procpointer, &
                                                                             c_funptr, c_int, c_loc, c_null_ptr, c_ptr
   use evl_branch, only: advance_branch, begin_branch, branch_options, branch_walk, keep_point, switch_at_doubling, told_before_end
   use evl_capi_types, only: answer, c_name_length, c_status, gearbox_of, status_from_c, to_c
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_orbits, only: gearbox_family, gearbox_orbits, gearbox_orbits_arrive, gearbox_orbits_create, &
                                 gearbox_orbits_start, gearbox_orbits_state
   use evl_kinds, only: wp
   use evl_orbit_teller, only: orbit_teller
   use evl_shooting, only: correct_orbit, find_orbit, orbit_t, own_multipliers
   use evl_special_points, only: branch_point, kind_touch, kind_touch_fold
   use evl_status, only: code_no_memory, code_no_solution, code_ok, fail, has_failed, status_t
   implicit none (type, external)
   private

   public :: evl_orbits_advance, evl_orbits_begin, evl_orbits_create, evl_orbits_delete, evl_orbits_find, evl_orbits_go_on, &
             evl_orbits_keep, evl_orbits_kept, evl_orbits_point, evl_orbits_put, evl_orbits_state, evl_orbits_switch, &
             evl_orbits_walk

   !> evl_orbits_setup
   type, bind(c) :: c_setup
      type(c_ptr) :: self
      type(c_funptr) :: take, tell
      real(c_double) :: from, to, place, tolerance, residual, first_step, smallest_step, largest_step, &
                        straight_step, largest_change
      integer(c_int) :: most_points, n_values
      type(c_ptr) :: values
   end type c_setup

   !> evl_orbit
   type, bind(c) :: c_orbit
      real(c_double) :: parameter, period, residual
      integer(c_int) :: periods, kind, mesh, iterations, n_multipliers, told
      logical(c_bool) :: is_stable
      character(kind=c_char) :: root(c_name_length)
   end type c_orbit

   abstract interface
      integer(c_int) function c_take(self, value, gearbox, scale, status) bind(c)
         import :: c_double, c_int, c_ptr, c_status
         implicit none (type, external)
         type(c_ptr), value :: self
         real(c_double), value :: value
         type(c_ptr), intent(out) :: gearbox, scale
         type(c_status), intent(inout) :: status
      end function c_take

      integer(c_int) function c_tell(self, number, periods, period, t, y, integers, reals, status) bind(c)
         import :: c_double, c_int, c_ptr, c_status
         implicit none (type, external)
         type(c_ptr), value :: self
         integer(c_int), value :: number, periods
         real(c_double), intent(inout) :: period
         real(c_double), value :: t
         real(c_double), intent(inout) :: y(*), reals(*)
         integer(c_int), intent(inout) :: integers(*)
         type(c_status), intent(inout) :: status
      end function c_tell
   end interface

   type, extends(gearbox_family) :: callers_family
      type(c_ptr) :: self = c_null_ptr
      procedure(c_take), pointer, nopass :: ask => null()
   contains
      procedure :: take
   end type callers_family

   type, extends(orbit_teller) :: callers_teller
      type(c_ptr) :: self = c_null_ptr
      procedure(c_tell), pointer, nopass :: ask => null()
      type(gearbox_orbits), pointer :: model => null()
   contains
      procedure :: tell => tell_caller
   end type callers_teller

   !> evl_orbits_progress
   type, bind(c) :: c_walk
      real(c_double) :: step
      integer(c_int) :: crawls, n_ordinary, before, is_smooth
   end type c_walk

   integer, parameter :: n_kept = 8 !! numbers that are kept of a point beside its arrays

   type :: points_t
      type(branch_point), allocatable :: points(:)
      integer :: n = 0 !! of them
   end type points_t

   !> evl_orbits
   type :: orbits_t
      type(callers_family) :: family
      type(callers_teller) :: teller
      type(gearbox_orbits) :: model
      type(branch_options) :: options
      type(orbit_t) :: orbit                      !! the last that was found, or switched to
      type(points_t), allocatable :: branches(:)
      integer :: n_branches = 0
      type(branch_walk) :: walk                   !! along the last one
      integer :: before = 0                       !! which of its points is the ordinary one before the last; 0: none
   end type orbits_t

contains

   !> Ask the caller for a gearbox.
   subroutine take(self, value, gearbox, scale, status)
      class(callers_family), intent(inout) :: self
      real(wp), intent(in) :: value
      type(gearbox_t), pointer, intent(out) :: gearbox
      real(wp), allocatable, intent(out) :: scale(:)
      type(status_t), intent(inout) :: status
      type(c_ptr) :: handle, scale_handle
      real(c_double), pointer :: of_caller(:)
      type(c_status) :: refusal
      character(len=size(refusal%message)) :: message
      integer :: i

      gearbox => null()
      if (self%ask(self%self, value, handle, scale_handle, refusal) /= code_ok) then
         message = ""
         do i = 1, size(refusal%message)
            if (iachar(refusal%message(i)) == 0) exit
            message(i:i) = refusal%message(i)
         end do
         status = status_from_c(refusal)
         call fail(status, refusal%code, trim(message))
         return
      end if
      gearbox => gearbox_of(handle)
      call c_f_pointer(scale_handle, of_caller, [gearbox%n_states])
      scale = of_caller
   end subroutine take

   !> Let the caller follow what is to be an orbit.
   subroutine tell_caller(self, number, orbit, status)
      class(callers_teller), intent(inout) :: self
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
               call fail(status, code_no_solution, "it could not be told")
               return
            end if
            call gearbox_orbits_arrive(model, y, integers, reals, orbit%flow%y, orbit%flow%same_modes)
            call model%rhs(model%phase, orbit%flow%y, orbit%flow%rate, status)
         end block
      end associate
   end subroutine tell_caller

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
         call fail(s, code_no_memory, "there is no memory for orbits")
         code = answer(s, status)
         return
      end if
      self%family%self = setup%self
      call c_f_procpointer(setup%take, self%family%ask)
      if (c_associated(setup%tell)) then
         self%teller%self = setup%self
         call c_f_procpointer(setup%tell, self%teller%ask)
         self%teller%model => self%model
         self%options%teller => self%teller
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
      call gearbox_orbits_create(self%model, self%family, value, setup%place, s)
      code = answer(s, status)
      if (code == code_ok) then
         handle = c_loc(self)
      else
         deallocate (self)
      end if
   end function evl_orbits_create

   subroutine evl_orbits_delete(handle) bind(c)
      type(c_ptr), intent(inout), optional :: handle
      type(orbits_t), pointer :: self

      if (.not. present(handle)) return
      call c_f_pointer(handle, self)
      if (associated(self)) deallocate (self)
      handle = c_null_ptr
   end subroutine evl_orbits_delete

   integer(c_int) function evl_orbits_find(handle, value, periods, period, y, integers, reals, orbit, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in), value :: value, period
      integer(c_int), intent(in), value :: periods
      real(c_double), intent(in) :: y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      type(c_orbit), intent(out) :: orbit
      type(c_status), intent(inout), optional :: status
      type(orbits_t), pointer :: self
      type(status_t) :: s

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
      if (.not. has_failed(s)) call tell(self, self%orbit, orbit)
      code = answer(s, status)
   end function evl_orbits_find

   integer(c_int) function evl_orbits_begin(handle, rising, n, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      logical(c_bool), intent(in), value :: rising
      integer(c_int), intent(out) :: n
      type(c_status), intent(inout), optional :: status
      type(orbits_t), pointer :: self
      type(status_t) :: s

      call c_f_pointer(handle, self)
      call add_branch(self)
      self%options%rising = rising
      self%before = 0
      call begin_branch(self%model, self%options, self%orbit, self%walk, s)
      associate (branch => self%branches(self%n_branches))
         if (.not. has_failed(s)) call keep_point(branch%points, branch%n, self%walk%first)
         n = branch%n
      end associate
      code = answer(s, status)
   end function evl_orbits_begin

   integer(c_int) function evl_orbits_advance(handle, n, is_over, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(out) :: n
      logical(c_bool), intent(out) :: is_over
      type(c_status), intent(inout), optional :: status
      type(orbits_t), pointer :: self
      type(branch_point), allocatable :: more(:)
      type(status_t) :: s
      integer :: i

      call c_f_pointer(handle, self)
      call advance_branch(self%model, self%options, self%walk, more, s)
      associate (branch => self%branches(self%n_branches))
         self%before = merge(branch%n, 0, allocated(self%walk%before%tangent)) ! behind a touch the curve begins anew
         do i = 1, size(more)
            call keep_point(branch%points, branch%n, more(i))
         end do
         n = branch%n
      end associate
      is_over = self%walk%is_over
      code = answer(s, status)
   end function evl_orbits_advance

   !> Room for a new branch, which is empty.
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

   integer(c_int) function evl_orbits_kept(handle) result(n) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(orbits_t), pointer :: self

      call c_f_pointer(handle, self)
      n = n_kept + 3*self%model%n + 2
   end function evl_orbits_kept

   subroutine evl_orbits_keep(handle, branch, point, numbers) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: branch, point
      real(c_double), intent(inout) :: numbers(*)
      type(orbits_t), pointer :: self

      call c_f_pointer(handle, self)
      associate (at => self%branches(branch + 1)%points(point + 1), n => self%model%n)
         associate (o => at%orbit)
            numbers(:n_kept) = [real(wp) :: o%parameter, o%period, o%residual, at%way, o%periods, o%iterations, at%kind, at%root]
            numbers(n_kept + 1:n_kept + n) = o%y
            numbers(n_kept + n + 1:n_kept + 3*n + 2) = 0
            if (allocated(o%by_parameter)) numbers(n_kept + n + 1:n_kept + 2*n) = o%by_parameter
            if (allocated(o%tangent)) numbers(n_kept + 2*n + 1:n_kept + 3*n + 2) = o%tangent
         end associate
      end associate
   end subroutine evl_orbits_keep

   subroutine evl_orbits_put(handle, branch, numbers) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: branch
      real(c_double), intent(in), optional :: numbers(*)
      type(orbits_t), pointer :: self
      type(branch_point) :: at

      call c_f_pointer(handle, self)
      if (branch >= self%n_branches) call add_branch(self)
      if (.not. present(numbers)) return
      associate (n => self%model%n, o => at%orbit)
         o%parameter = numbers(1)
         o%period = numbers(2)
         o%residual = numbers(3)
         at%way = numbers(4)
         o%periods = nint(numbers(5))
         o%iterations = nint(numbers(6))
         at%kind = nint(numbers(7))
         at%root = nint(numbers(8))
         o%y = numbers(n_kept + 1:n_kept + n)
         o%by_parameter = numbers(n_kept + n + 1:n_kept + 2*n)
         o%tangent = numbers(n_kept + 2*n + 1:n_kept + 3*n + 2)
      end associate
      associate (to => self%branches(branch + 1))
         call keep_point(to%points, to%n, at)
      end associate
   end subroutine evl_orbits_put

   subroutine evl_orbits_walk(handle, walk) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(c_walk), intent(out) :: walk
      type(orbits_t), pointer :: self

      call c_f_pointer(handle, self)
      walk%step = self%walk%step
      walk%crawls = self%walk%crawls
      walk%n_ordinary = self%walk%n_ordinary
      walk%before = self%before
      walk%is_smooth = merge(1, 0, self%walk%is_smooth)
   end subroutine evl_orbits_walk

   integer(c_int) function evl_orbits_go_on(handle, walk, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(c_walk), intent(in) :: walk
      type(c_status), intent(inout), optional :: status
      type(orbits_t), pointer :: self
      type(status_t) :: s

      call c_f_pointer(handle, self)
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
         self%walk%told = told_before_end(branch%points(max(1, self%before + 1):branch%n))
         if (self%before > 0 .and. .not. has_failed(s)) then
            call complete(self, branch%points(self%before), s)
            self%walk%before = branch%points(self%before)%orbit
         end if
      end associate
      code = answer(s, status)
   end function evl_orbits_go_on

   !> Find what was not kept of a point: its flow and what follows from that.
   subroutine complete(self, point, status)
      type(orbits_t), intent(inout) :: self
      type(branch_point), intent(inout) :: point
      type(status_t), intent(inout) :: status
      integer :: iterations

      if (allocated(point%orbit%multipliers)) return
      iterations = point%orbit%iterations
      call correct_orbit(self%model, self%options%orbits, point%orbit, status) ! there is nothing left to correct
      point%orbit%iterations = iterations
   end subroutine complete

   integer(c_int) function evl_orbits_switch(handle, branch, point, distance, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: branch, point
      real(c_double), intent(in), value :: distance
      type(c_status), intent(inout), optional :: status
      type(orbits_t), pointer :: self
      type(status_t) :: s

      call c_f_pointer(handle, self)
      call complete(self, self%branches(branch + 1)%points(point + 1), s)
      associate (from => self%branches(branch + 1)%points(point + 1)%orbit)
         if (.not. has_failed(s)) call self%model%set_parameter(from%parameter, s)
         if (.not. has_failed(s)) call switch_at_doubling(self%model, self%options, from, distance, self%orbit, s)
      end associate
      code = answer(s, status)
   end function evl_orbits_switch

   subroutine evl_orbits_point(handle, branch, point, orbit, multipliers) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: branch, point
      type(c_orbit), intent(out) :: orbit
      real(c_double), intent(inout) :: multipliers(2, *)
      type(orbits_t), pointer :: self
      complex(wp), allocatable :: mu(:)
      integer :: i

      call c_f_pointer(handle, self)
      associate (at => self%branches(branch + 1)%points(point + 1))
         call tell(self, at%orbit, orbit)
         orbit%kind = at%kind
         orbit%told = at%told
         if (at%kind == kind_touch .or. at%kind == kind_touch_fold) call tell_root(self, at%root, orbit)
         allocate (mu, source=own_multipliers(self%model, at%orbit))
      end associate
      do i = 1, size(mu)
         multipliers(:, i) = [mu(i)%re, mu(i)%im]
      end do
   end subroutine evl_orbits_point

   integer(c_int) function evl_orbits_state(handle, branch, point, t, y, integers, reals, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: branch, point
      real(c_double), intent(out) :: t
      real(c_double), intent(inout) :: y(*), reals(*)
      integer(c_int), intent(inout) :: integers(*)
      type(c_status), intent(inout), optional :: status
      type(orbits_t), pointer :: self
      type(status_t) :: s

      call c_f_pointer(handle, self)
      if (branch < 0) then
         call state_of(self, self%orbit, t, y, integers, reals, s)
      else
         call state_of(self, self%branches(branch + 1)%points(point + 1)%orbit, t, y, integers, reals, s)
      end if
      code = answer(s, status)
   end function evl_orbits_state

   !> The state of an orbit on the section.
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

   !> What an orbit is.
   subroutine tell(self, orbit, told)
      type(orbits_t), intent(in) :: self
      type(orbit_t), intent(in) :: orbit
      type(c_orbit), intent(out) :: told

      associate (mu => own_multipliers(self%model, orbit))
         told%n_multipliers = size(mu)
         told%is_stable = all(abs(mu) < 1)
      end associate
      told%parameter = orbit%parameter
      told%period = orbit%period
      told%residual = orbit%residual
      told%periods = orbit%periods
      told%iterations = orbit%iterations
      told%kind = 0
      told%told = 0
      told%mesh = -1
      call to_c("", told%root)
   end subroutine tell

   !> What a root function is that touches zero.
   subroutine tell_root(self, root, told)
      type(orbits_t), intent(in) :: self
      integer, intent(in) :: root
      type(c_orbit), intent(inout) :: told

      told%mesh = self%model%root_list(root)%mesh - 1
      call to_c(trim(self%model%root_list(root)%name), told%root)
   end subroutine tell_root

end module evl_capi_orbits
