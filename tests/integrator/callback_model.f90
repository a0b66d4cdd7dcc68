!> A model whose procedures are C functions, so that a test can write its problem where it writes its claim.
module callback_model
   use, intrinsic :: iso_c_binding, only: c_double, c_f_procpointer, c_funptr, c_int
   use evl_kinds, only: lanes, wp
   use evl_ode_model, only: ode_model
   use evl_status, only: code_invalid_input, code_ok, fail, has_failed, quantity, status_t
   implicit none (type, external)
   private

   public :: callback_model_t, callback_model_create, check_model

   type, extends(ode_model) :: callback_model_t
      procedure(vector_callback), pointer, nopass :: f => null()
      procedure(vector_callback), pointer, nopass :: df_dy => null()
      procedure(vector_callback), pointer, nopass :: g => null()
      procedure(directions_callback), pointer, nopass :: directions => null()
      real(wp) :: cycle = huge(1.0_wp) !! of f, by time
   contains
      procedure :: rhs
      procedure :: rhs_lanes
      procedure :: jacobian
      procedure :: roots
      procedure :: roots_lanes
      procedure :: root_directions
      procedure :: resolved_time
   end type callback_model_t

   abstract interface
      !> Values at (t, y); 0 or a code of `evl_status`.
      integer(c_int) function vector_callback(t, y, values) bind(c)
         import :: c_double, c_int
         implicit none (type, external)
         real(c_double), value :: t
         real(c_double), intent(in) :: y(*)
         real(c_double), intent(out) :: values(*)
      end function vector_callback

      !> Directions of the crossings that count.
      subroutine directions_callback(directions) bind(c)
         import :: c_int
         implicit none (type, external)
         integer(c_int), intent(out) :: directions(*)
      end subroutine directions_callback
   end interface

contains

   !> Take sizes, pattern, scales and procedures.
   subroutine callback_model_create(model, row, column, scale, n_roots, f, df_dy, g, directions)
      type(callback_model_t), intent(out) :: model
      integer(c_int), intent(in) :: row(:), column(:) !! from 0
      real(c_double), intent(in) :: scale(:)
      integer(c_int), intent(in) :: n_roots
      type(c_funptr), intent(in) :: f, df_dy, g, directions

      model%n = size(scale)
      model%n_roots = n_roots
      model%jacobian_row = row + 1
      model%jacobian_column = column + 1
      model%scale = scale
      call c_f_procpointer(f, model%f)
      call c_f_procpointer(df_dy, model%df_dy)
      call c_f_procpointer(g, model%g)
      call c_f_procpointer(directions, model%directions)
   end subroutine callback_model_create

   subroutine answer(code, status)
      integer(c_int), intent(in) :: code
      type(status_t), intent(inout) :: status

      if (code /= code_ok) call fail(status, int(code), "the test's model refuses")
   end subroutine answer

   subroutine rhs(self, t, y, f, status)
      class(callback_model_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: f(self%n)
      type(status_t), intent(inout) :: status

      call answer(self%f(t, y, f), status)
   end subroutine rhs

   subroutine rhs_lanes(self, t, y, f, status)
      class(callback_model_t), intent(inout) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      real(wp), intent(out) :: f(lanes, self%n)
      type(status_t), intent(inout) :: status
      real(wp) :: state(self%n), rate(self%n)
      integer :: k

      do k = 1, lanes
         state = y(k, :)
         call answer(self%f(t(k), state, rate), status)
         f(k, :) = rate
      end do
   end subroutine rhs_lanes

   subroutine jacobian(self, t, y, values, status)
      class(callback_model_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: values(:)
      type(status_t), intent(inout) :: status

      call answer(self%df_dy(t, y, values), status)
   end subroutine jacobian

   subroutine roots(self, t, y, values, status, only)
      class(callback_model_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(inout) :: values(self%n_roots)
      type(status_t), intent(inout) :: status
      integer, intent(in), optional :: only

      call answer(self%g(t, y, values), status)
   end subroutine roots

   subroutine roots_lanes(self, t, y, exact, values, status)
      class(callback_model_t), intent(inout) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      logical, intent(inout) :: exact
      real(wp), intent(inout) :: values(lanes, self%n_roots)
      type(status_t), intent(inout) :: status
      real(wp) :: state(self%n), here(self%n_roots)
      integer :: k

      exact = .true.
      do k = 1, lanes
         state = y(k, :)
         call answer(self%g(t(k), state, here), status)
         values(k, :) = here
      end do
   end subroutine roots_lanes

   pure real(wp) function resolved_time(self, t) result(longest)
      class(callback_model_t), intent(in) :: self
      real(wp), intent(in) :: t

      longest = self%cycle
   end function resolved_time

   subroutine root_directions(self, directions)
      class(callback_model_t), intent(in) :: self
      integer, intent(out) :: directions(self%n_roots)

      call self%directions(directions)
   end subroutine root_directions

   !> Refuse a model that the integrator could not work with.
   subroutine check_model(model, status)
      class(ode_model), intent(in) :: model
      type(status_t), intent(inout) :: status
      integer :: i, p
      logical :: taken(model%n, model%n)

      if (model%n < 1) then
         call fail(status, code_invalid_input, "the model has no states")
         return
      end if
      if (.not. (allocated(model%scale) .and. allocated(model%jacobian_row) .and. allocated(model%jacobian_column))) then
         call fail(status, code_invalid_input, "the model lacks its scales or the pattern of its Jacobian")
         return
      end if
      if (size(model%scale) /= model%n .or. size(model%jacobian_row) /= size(model%jacobian_column)) then
         call fail(status, code_invalid_input, "the model's scales or the pattern of its Jacobian have the wrong length")
         return
      end if
      do i = 1, model%n
         if (.not. (model%scale(i) > 0 .and. model%scale(i) <= huge(1.0_wp))) then
            call fail(status, code_invalid_input, "scale "//quantity(model%scale(i), "")//" of a state is not positive", &
                      index=i, field="scale")
            return
         end if
      end do
      taken = .false.
      do p = 1, size(model%jacobian_row)
         associate (i => model%jacobian_row(p), j => model%jacobian_column(p))
            if (min(i, j) < 1 .or. max(i, j) > model%n) then
               call fail(status, code_invalid_input, "an entry of the Jacobian lies outside the matrix", index=p, &
                         field="jacobian_row")
            else if (taken(i, j)) then
               call fail(status, code_invalid_input, "an entry of the Jacobian is listed twice", index=p, field="jacobian_row")
            else
               taken(i, j) = .true.
            end if
         end associate
         if (has_failed(status)) return
      end do
   end subroutine check_model

end module callback_model
