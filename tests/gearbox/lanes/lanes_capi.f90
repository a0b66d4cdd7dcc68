!> Rates in lanes, for their tests: a C interface that the kernel does not export.
module lanes_capi
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_loc, c_ptr
   use evl_capi_types, only: c_status, status_to_c
   use evl_elementary, only: exponential, hyperbolic_tangent, natural_logarithm, real_power, sine_cosine
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_events, only: gearbox_root, gearbox_root_directions
   use evl_gearbox_lanes, only: supports_lanes, rates_in_lanes
   use evl_gearbox_ode, only: gearbox_ode, gearbox_ode_create, gearbox_ode_set, settle_slots
   use evl_gearbox_rates, only: gearbox_rates
   use evl_kinds, only: lanes
   use evl_roots_lanes, only: roots_in_lanes
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: lanes_count, lanes_rates, lanes_roots, lanes_root_by_root, lanes_roots_nearby
   public :: lanes_roots_live, lanes_scalar, lanes_serves
   public :: lanes_jacobian, lanes_model, lanes_sight
   public :: lanes_exponential, lanes_hyperbolic_tangent, lanes_logarithm, lanes_power, lanes_sine_cosine

contains

   !> Number of lanes.
   integer(c_int) function lanes_count() bind(c)
      lanes_count = lanes
   end function lanes_count

   !> Whether a gearbox is supported: 1 or 0.
   integer(c_int) function lanes_serves(handle) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(gearbox_t), pointer :: gearbox

      call c_f_pointer(handle, gearbox)
      lanes_serves = merge(1, 0, supports_lanes(gearbox))
   end function lanes_serves

   !> ln x of n numbers.
   subroutine lanes_logarithm(n, x, ln) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: x(n)
      real(c_double), intent(inout) :: ln(n)

      ln = natural_logarithm(x)
   end subroutine lanes_logarithm

   !> exp x of n numbers.
   subroutine lanes_exponential(n, x, y) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: x(n)
      real(c_double), intent(inout) :: y(n)

      y = exponential(x)
   end subroutine lanes_exponential

   !> tanh x of n numbers.
   subroutine lanes_hyperbolic_tangent(n, x, y) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: x(n)
      real(c_double), intent(inout) :: y(n)

      y = hyperbolic_tangent(x)
   end subroutine lanes_hyperbolic_tangent

   !> x**exponent of n numbers.
   subroutine lanes_power(n, x, exponent, y) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in), value :: exponent
      real(c_double), intent(in) :: x(n)
      real(c_double), intent(inout) :: y(n)

      y = real_power(x, exponent)
   end subroutine lanes_power

   !> Sine and cosine of n angles.
   subroutine lanes_sine_cosine(n, x, s, c) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: x(n)
      real(c_double), intent(inout) :: s(n), c(n)

      call sine_cosine(x, s, c)
   end subroutine lanes_sine_cosine

   !> f of eight states, evaluated `turns` times; the code of the status.
   integer(c_int) function lanes_rates(handle, turns, t, y, integers, reals, f) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: turns
      real(c_double), intent(in) :: t(lanes), y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(inout) :: f(*)

      code = evaluate(handle, turns, 0.0_c_double, t, y, integers, reals, f)
   end function lanes_rates

   !> The same, where each evaluation depends on the one before, as in Newton's iteration.
   integer(c_int) function lanes_rates_in_turn(handle, turns, t, y, integers, reals, f) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: turns
      real(c_double), intent(in) :: t(lanes), y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(inout) :: f(*)
      real(c_double), parameter :: unseen = 1.0e-200_c_double !! times f: negligible in a sum of ordinary numbers

      code = evaluate(handle, turns, unseen, t, y, integers, reals, f)
   end function lanes_rates_in_turn

   !> f at states that advance by `step` times the previous f.
   integer function evaluate(handle, turns, step, t, y, integers, reals, f) result(code)
      type(c_ptr), intent(in) :: handle
      integer, intent(in) :: turns
      real(c_double), intent(in) :: step, t(lanes), y(*), reals(*)
      integer, intent(in) :: integers(*)
      real(c_double), intent(inout) :: f(*)
      type(gearbox_t), pointer :: gearbox
      type(lane_slot), allocatable :: slots(:)
      real(c_double), allocatable :: moved(:)
      type(status_t) :: status
      integer :: i

      call c_f_pointer(handle, gearbox)
      allocate (slots(size(gearbox%contacts)))
      call settle_slots(gearbox, integers(:gearbox%n_integers), reals(:size(gearbox%contacts)), slots)
      associate (n => gearbox%n_states)
         moved = y(:lanes*n)
         do i = 1, turns
            if (step > 0) moved = moved + step*f(:lanes*n)
            call rates_in_lanes(gearbox, t, moved, integers(:gearbox%n_integers), reals(:size(gearbox%contacts)), slots, &
                                f(:lanes*n), status)
         end do
      end associate
      code = status%code
   end function evaluate

   !> Root functions of eight states; the code of the status.
   integer(c_int) function lanes_roots(handle, y, integers, reals, roots) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(inout) :: roots(*)
      type(gearbox_t), pointer :: gearbox
      type(lane_slot), allocatable :: slots(:), aside(:)
      type(status_t) :: first_look, status

      call c_f_pointer(handle, gearbox)
      allocate (slots(size(gearbox%contacts)))
      call settle_slots(gearbox, integers(:gearbox%n_integers), reals(:size(gearbox%contacts)), slots)
      aside = slots
      associate (n => gearbox%n_states, m => gearbox%n_roots)
         call roots_in_lanes(gearbox, y(:lanes*n), integers(:gearbox%n_integers), reals(:size(gearbox%contacts)), &
                             slots, aside, .true., roots(:lanes*m), first_look)
         call roots_in_lanes(gearbox, y(:lanes*n), integers(:gearbox%n_integers), reals(:size(gearbox%contacts)), &
                             slots, aside, .false., roots(:lanes*m), status)
      end associate
      code = status%code
   end function lanes_roots

   !> Root functions of eight states from the rates of eight others; the code of the status.
   integer(c_int) function lanes_roots_nearby(handle, t, y_before, y, integers, reals, roots) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: t(lanes), y_before(*), y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(inout) :: roots(*)
      type(gearbox_t), pointer :: gearbox
      type(lane_slot), allocatable :: slots(:), aside(:)
      real(c_double), allocatable :: f(:)
      type(status_t) :: status

      call c_f_pointer(handle, gearbox)
      allocate (slots(size(gearbox%contacts)), f(lanes*gearbox%n_states))
      associate (modes => integers(:gearbox%n_integers), speeds => reals(:size(gearbox%contacts)), &
                 n => gearbox%n_states, m => gearbox%n_roots)
         call settle_slots(gearbox, modes, speeds, slots)
         aside = slots
         call rates_in_lanes(gearbox, t, y_before(:lanes*n), modes, speeds, slots, f, status)
         call roots_in_lanes(gearbox, y(:lanes*n), modes, speeds, slots, aside, .true., roots(:lanes*m), status)
      end associate
      code = status%code
   end function lanes_roots_nearby

   !> Root functions of a state, each evaluated separately; the code of the status.
   integer(c_int) function lanes_root_by_root(handle, y, integers, reals, roots) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(inout) :: roots(*)
      type(gearbox_t), pointer :: gearbox
      type(status_t) :: status

      call c_f_pointer(handle, gearbox)
      block
         real(c_double) :: values(gearbox%n_roots)
         integer :: i

         do i = 1, gearbox%n_roots
            values = 0
            call gearbox_root(gearbox, i, y(:gearbox%n_states), integers(:gearbox%n_integers), &
                              reals(:size(gearbox%contacts)), values, status)
            roots(i) = values(i)
         end do
      end block
      code = status%code
   end function lanes_root_by_root

   !> Whether each root function can become zero in the discrete state: 1 or 0.
   subroutine lanes_roots_live(handle, integers, live) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in) :: integers(*)
      integer(c_int), intent(inout) :: live(*)
      type(gearbox_t), pointer :: gearbox

      call c_f_pointer(handle, gearbox)
      call gearbox_root_directions(gearbox, integers(:gearbox%n_integers), live(:gearbox%n_roots))
      live(:gearbox%n_roots) = abs(live(:gearbox%n_roots))
   end subroutine lanes_roots_live

   !> f of one state, evaluated `turns` times; the code of the status.
   integer(c_int) function lanes_scalar(handle, turns, t, y, integers, reals, f) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: turns
      real(c_double), intent(in), value :: t
      real(c_double), intent(in) :: y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(inout) :: f(*)
      type(gearbox_t), pointer :: gearbox
      type(status_t) :: status
      integer :: i

      call c_f_pointer(handle, gearbox)
      associate (n => gearbox%n_states)
         do i = 1, turns
            call gearbox_rates(gearbox, t, y(:n), integers(:gearbox%n_integers), reals(:size(gearbox%contacts)), f(:n), status)
         end do
      end associate
      code = status%code
   end function lanes_scalar

   !> Jacobian of one state in closed form, evaluated `turns` times; the code of the status.
   integer(c_int) function lanes_jacobian(handle, turns, t, y, integers, reals) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: turns
      real(c_double), intent(in), value :: t
      real(c_double), intent(in) :: y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      type(gearbox_t), pointer :: gearbox
      type(gearbox_ode) :: model
      type(status_t) :: status
      real(c_double), allocatable :: scale(:), values(:)
      integer :: i

      call c_f_pointer(handle, gearbox)
      allocate (scale(gearbox%n_states), source=1.0_c_double)
      call gearbox_ode_create(model, gearbox, scale)
      call gearbox_ode_set(model, integers, reals)
      allocate (values(size(model%jacobian_row)))
      do i = 1, turns
         call model%jacobian(t, y(:gearbox%n_states), values, status)
      end do
      code = status%code
   end function lanes_jacobian

   !> Input of integration steps: f of eight states in lanes, (state, lane) by rows, and df/dy at the first of them, by columns.
   subroutine lanes_model(handle, scale, t, y, integers, reals, f, jacobian, status) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: scale(*), t(lanes)
      real(c_double), intent(in), target :: y(*)
      real(c_double), intent(in) :: reals(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(inout), target :: f(*), jacobian(*)
      type(c_status), intent(out) :: status
      real(c_double), pointer :: y_lanes(:, :), f_lanes(:, :), matrix(:, :)
      real(c_double), allocatable :: values(:)
      type(gearbox_t), pointer :: gearbox
      type(gearbox_ode) :: model
      type(status_t) :: s
      integer :: p

      call c_f_pointer(handle, gearbox)
      call gearbox_ode_create(model, gearbox, scale(:gearbox%n_states))
      call c_f_pointer(c_loc(y), y_lanes, [lanes, model%n])
      call c_f_pointer(c_loc(f), f_lanes, [lanes, model%n])
      call c_f_pointer(c_loc(jacobian), matrix, [model%n, model%n])
      allocate (values(size(model%jacobian_row)))
      call gearbox_ode_set(model, integers, reals)
      call model%rhs_lanes(t, y_lanes, f_lanes, s)
      if (.not. has_failed(s)) call model%jacobian(t(1), y_lanes(1, :), values, s)
      matrix = 0
      do p = 1, size(values)
         if (.not. has_failed(s)) matrix(model%jacobian_row(p), model%jacobian_column(p)) = values(p)
      end do
      call status_to_c(s, status)
   end subroutine lanes_model

   !> Step limits from t: for each state, and in time [s].
   subroutine lanes_sight(handle, scale, t, reach, time) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: scale(*)
      real(c_double), intent(in), value :: t
      real(c_double), intent(inout) :: reach(*)
      real(c_double), intent(out) :: time
      type(gearbox_t), pointer :: gearbox
      type(gearbox_ode) :: model

      call c_f_pointer(handle, gearbox)
      call gearbox_ode_create(model, gearbox, scale(:gearbox%n_states))
      reach(:model%n) = model%reach
      time = model%resolved_time(t)
   end subroutine lanes_sight

end module lanes_capi
