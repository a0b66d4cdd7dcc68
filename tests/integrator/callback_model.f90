!> A model whose procedures are C functions, so that a test can write its problem where it writes its claim.
module callback_model
   use, intrinsic :: iso_c_binding, only: c_double, c_f_procpointer, c_funptr, c_int
   use evl_kinds, only: lanes, wp
   use evl_ode_model, only: ode_model
   use evl_status, only: code_ok, fail, status_t
   implicit none (type, external)
   private

   public :: callback_model_t, callback_model_create

   type, extends(ode_model) :: callback_model_t
      procedure(vector_callback), pointer, nopass :: f => null()
      procedure(vector_callback), pointer, nopass :: df_dy => null()
      procedure(vector_callback), pointer, nopass :: g => null()
      procedure(directions_callback), pointer, nopass :: directions => null()
   contains
      procedure :: rhs
      procedure :: rhs_lanes
      procedure :: jacobian
      procedure :: roots
      procedure :: roots_lanes
      procedure :: root_directions
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
      class(callback_model_t), intent(in) :: self
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

   subroutine roots(self, t, y, values, status)
      class(callback_model_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: values(self%n_roots)
      type(status_t), intent(inout) :: status

      call answer(self%g(t, y, values), status)
   end subroutine roots

   subroutine roots_lanes(self, t, y, values, status)
      class(callback_model_t), intent(in) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      real(wp), intent(out) :: values(lanes, self%n_roots)
      type(status_t), intent(inout) :: status
      real(wp) :: state(self%n), here(self%n_roots)
      integer :: k

      do k = 1, lanes
         state = y(k, :)
         call answer(self%g(t(k), state, here), status)
         values(k, :) = here
      end do
   end subroutine roots_lanes

   subroutine root_directions(self, directions)
      class(callback_model_t), intent(in) :: self
      integer, intent(out) :: directions(self%n_roots)

      call self%directions(directions)
   end subroutine root_directions

end module callback_model
