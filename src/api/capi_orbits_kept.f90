!> C interface: what is kept of a search for orbits that is stopped, and how it goes on.
!>
!> The header's section "orbits" documents each procedure.
module evl_capi_orbits_kept
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_ptr
   use evl_branch, only: keep_point, before_end
   use evl_branch_point, only: branch_point
   use evl_capi_types, only: answer, c_status
   use evl_kinds, only: wp
   use evl_orbits_session, only: add_branch, complete, orbits_t
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: evl_orbits_go_on, evl_orbits_keep, evl_orbits_kept, evl_orbits_put, evl_orbits_walk

   !> evl_orbits_progress
   type, bind(c) :: c_walk
      real(c_double) :: step
      integer(c_int) :: crawls, n_ordinary, before, is_smooth
   end type c_walk

   integer, parameter :: n_kept = 9 !! numbers that are kept of a point beside its arrays

contains

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
            numbers(:n_kept) = [real(wp) :: o%parameter, o%period, o%residual, at%way, o%periods, o%iterations, at%kind, at%root, &
                                merge(1, 0, at%begins_anew)]
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
         at%begins_anew = nint(numbers(9)) /= 0
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
         self%walk%told = before_end([branch_point ::], branch%points(:branch%n))
         if (self%before > 0 .and. .not. has_failed(s)) then
            call complete(self, branch%points(self%before), s)
            self%walk%before = branch%points(self%before)%orbit
         end if
      end associate
      code = answer(s, status)
   end function evl_orbits_go_on

end module evl_capi_orbits_kept
