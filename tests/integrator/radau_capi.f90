!> The integrator and its parts for tests, as C functions; no part of the kernel's interface.
!>
!> Indices count from 0 in C. Each function that can fail returns a code of `evl_status`; rt_message gives the words.
module radau_capi
   use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_double, c_f_pointer, c_funptr, c_int, c_loc, c_null_char, c_ptr
   use callback_model, only: callback_model_create, callback_model_t, check_model
   use chain_run, only: run_chain
   use evl_collocation, only: lagrange_at
   use evl_condensed_systems, only: condensed_create, condensed_factor, condensed_solve, condensed_solve_first, condensed_t
   use evl_dense_lu, only: dense_lu_create, dense_lu_factor, dense_lu_solve, dense_lu_solve_first, dense_lu_t
   use evl_eigenvalues, only: find_eigenvalues
   use evl_kinds, only: lanes, wp
   use evl_ode_model, only: ode_model
   use evl_radau, only: radau_advance, radau_counts, radau_create, radau_get_counts, radau_get_growth, radau_growth, &
                        radau_interpolate, radau_options, radau_restart, radau_start, radau_t
   use evl_radau_coefficients, only: barycentric, from_stage, integral_to_node, n_systems, node, shift_im, shift_re, &
                                     slope_at_node, to_chebyshev, to_stage
   use evl_status, only: clear, has_failed, status_t
   use oscillator_chain, only: oscillator_chain_create, oscillator_chain_t
   implicit none (type, external)
   private

   public :: rt_tables, rt_basis, rt_sparse_solve, rt_dense_solve
   public :: rt_new, rt_new_chain, rt_delete, rt_start, rt_advance, rt_state, rt_interpolate, rt_restart, rt_counts, rt_message
   public :: rt_eigenvalues, rt_growth
   public :: rt_integrate_chain

   !> A model and its solver.
   type :: session_t
      class(ode_model), allocatable :: model
      type(radau_t) :: solver
      type(status_t) :: status
   end type session_t

contains

   !> The tables, matrices by columns.
   subroutine rt_tables(c, t, t_inverse, re, im, weights, slopes, chebyshev, integral) bind(c)
      real(c_double), intent(out) :: c(lanes), t(lanes, lanes), t_inverse(lanes, lanes), re(n_systems), im(n_systems)
      real(c_double), intent(out) :: weights(lanes), slopes(lanes, lanes), chebyshev(lanes, lanes), &
                                     integral(lanes, lanes)

      c = node
      t = to_stage
      t_inverse = from_stage
      re = shift_re
      im = shift_im
      weights = barycentric
      slopes = slope_at_node
      chebyshev = to_chebyshev
      integral = integral_to_node
   end subroutine rt_tables

   !> Lagrange polynomials at tau.
   subroutine rt_basis(tau, basis) bind(c)
      real(c_double), value :: tau
      real(c_double), intent(out) :: basis(lanes)

      call lagrange_at(tau, basis)
   end subroutine rt_basis

   !> Solve the four systems, and the first of them alone for b_first; returns the entries of the factors, 0 if refused.
   integer(c_int) function rt_sparse_solve(n, nnz, row, column, jacobian, re, im, b, b_first) result(entries) bind(c)
      integer(c_int), value :: n, nnz
      integer(c_int), intent(in) :: row(nnz), column(nnz)
      real(c_double), intent(in) :: jacobian(nnz), re(n_systems), im(n_systems)
      real(c_double), intent(inout) :: b(lanes, n), b_first(n)
      type(condensed_t) :: systems
      logical :: good

      call condensed_create(systems, n, row + 1, column + 1)
      call condensed_factor(systems, reshape([re, im], [n_systems, 2]), jacobian, good)
      entries = 0
      if (.not. good) return
      call condensed_solve(systems, b)
      call condensed_solve_first(systems, b_first)
      entries = condensed_entries(systems)
   end function rt_sparse_solve

   !> The same with row exchanges; returns 0 if a matrix is singular.
   integer(c_int) function rt_dense_solve(n, nnz, row, column, jacobian, re, im, b, b_first) result(good) bind(c)
      integer(c_int), value :: n, nnz
      integer(c_int), intent(in) :: row(nnz), column(nnz)
      real(c_double), intent(in) :: jacobian(nnz), re(n_systems), im(n_systems)
      real(c_double), intent(inout) :: b(lanes, n), b_first(n)
      type(dense_lu_t) :: lu
      logical :: regular

      call dense_lu_create(lu, n)
      call dense_lu_factor(lu, re, im, row + 1, column + 1, jacobian, regular)
      good = merge(1, 0, regular)
      if (.not. regular) return
      call dense_lu_solve(lu, b)
      call dense_lu_solve_first(lu, b_first)
   end function rt_dense_solve

   !> Eigenvalues of a matrix, by columns; returns 0 if they were not found.
   integer(c_int) function rt_eigenvalues(n, matrix, re, im) result(found) bind(c)
      integer(c_int), value :: n
      real(c_double), intent(inout) :: matrix(n, n) !! destroyed
      real(c_double), intent(out) :: re(n), im(n)
      logical :: all_found

      call find_eigenvalues(n, matrix, re, im, all_found)
      found = merge(1, 0, all_found)
   end function rt_eigenvalues

   !> A solver for a model of C functions.
   type(c_ptr) function rt_new(n, nnz, row, column, scale, n_roots, f, df_dy, g, directions, tolerance, max_step, &
                               first_step, growth, reach, cycle) result(handle) bind(c)
      integer(c_int), value :: n, nnz, n_roots
      integer(c_int), intent(in) :: row(nnz), column(nnz)
      real(c_double), intent(in) :: scale(n)
      type(c_funptr), value :: f, df_dy, g, directions
      real(c_double), value :: tolerance, max_step, first_step
      integer(c_int), value :: growth
      real(c_double), intent(in) :: reach(n)
      real(c_double), value :: cycle
      type(session_t), pointer :: session
      type(callback_model_t) :: model

      call callback_model_create(model, row, column, scale, n_roots, f, df_dy, g, directions)
      model%growth = growth
      model%reach = reach
      model%cycle = cycle
      allocate (session)
      allocate (session%model, source=model)
      call check_model(session%model, session%status)
      if (.not. has_failed(session%status)) &
         call radau_create(session%solver, session%model, radau_options(tolerance, max_step, first_step), session%status)
      handle = c_loc(session)
   end function rt_new

   !> A solver for a chain of oscillators.
   type(c_ptr) function rt_new_chain(masses, stiffness, hardening, damping, with_roots, kick_interval, &
                                     tolerance) result(handle) bind(c)
      integer(c_int), value :: masses
      real(c_double), value :: stiffness, hardening, damping, kick_interval, tolerance
      logical(c_bool), value :: with_roots
      type(session_t), pointer :: session
      type(oscillator_chain_t) :: model

      call oscillator_chain_create(model, masses, stiffness, hardening, damping, logical(with_roots), kick_interval)
      allocate (session)
      allocate (session%model, source=model)
      call radau_create(session%solver, session%model, radau_options(tolerance=tolerance), session%status)
      handle = c_loc(session)
   end function rt_new_chain

   subroutine rt_delete(handle) bind(c)
      type(c_ptr), value :: handle
      type(session_t), pointer :: session

      call c_f_pointer(handle, session)
      deallocate (session)
   end subroutine rt_delete

   integer(c_int) function rt_start(handle, t, y) result(code) bind(c)
      type(c_ptr), value :: handle
      real(c_double), value :: t
      real(c_double), intent(in) :: y(*)
      type(session_t), pointer :: session

      call c_f_pointer(handle, session)
      call clear(session%status)
      call radau_start(session%solver, session%model, t, y(:session%model%n), session%status)
      code = session%status%code
   end function rt_start

   integer(c_int) function rt_advance(handle, t_stop, outcome) result(code) bind(c)
      type(c_ptr), value :: handle
      real(c_double), value :: t_stop
      integer(c_int), intent(out) :: outcome
      type(session_t), pointer :: session

      call c_f_pointer(handle, session)
      call radau_advance(session%solver, session%model, t_stop, outcome, session%status)
      code = session%status%code
   end function rt_advance

   subroutine rt_state(handle, t_before, t, y, fired) bind(c)
      type(c_ptr), value :: handle
      real(c_double), intent(out) :: t_before, t
      real(c_double), intent(out) :: y(*)
      integer(c_int), intent(out) :: fired(*)
      type(session_t), pointer :: session

      call c_f_pointer(handle, session)
      t_before = session%solver%t_before
      t = session%solver%t
      y(:session%model%n) = session%solver%y
      fired(:session%model%n_roots) = session%solver%fired
   end subroutine rt_state

   subroutine rt_interpolate(handle, t, y) bind(c)
      type(c_ptr), value :: handle
      real(c_double), value :: t
      real(c_double), intent(out) :: y(*)
      type(session_t), pointer :: session

      call c_f_pointer(handle, session)
      call radau_interpolate(session%solver, t, y(:session%model%n))
   end subroutine rt_interpolate

   subroutine rt_restart(handle, t, y) bind(c)
      type(c_ptr), value :: handle
      real(c_double), value :: t
      real(c_double), intent(in) :: y(*)
      type(session_t), pointer :: session

      call c_f_pointer(handle, session)
      call radau_restart(session%solver, session%model, t, y(:session%model%n))
   end subroutine rt_restart

   !> Steps, rejections, evaluations lane-wise and scalar, Jacobians, factorisations, dense ones, root evaluations, events.
   subroutine rt_counts(handle, numbers) bind(c)
      type(c_ptr), value :: handle
      integer(c_int), intent(out) :: numbers(10)
      type(session_t), pointer :: session
      type(radau_counts) :: counts

      call c_f_pointer(handle, session)
      counts = radau_get_counts(session%solver)
      numbers = [counts%steps, counts%rejections, counts%iterations, counts%evaluations, counts%jacobians, &
                 counts%factorisations, counts%dense, counts%root_evaluations, counts%events, &
                 counts%growth_cuts]
   end subroutine rt_counts

   !> The fastest growth for which steps were cut: its time, rate and angular frequency.
   subroutine rt_growth(handle, numbers) bind(c)
      type(c_ptr), value :: handle
      real(c_double), intent(out) :: numbers(3)
      type(session_t), pointer :: session
      type(radau_growth) :: growth

      call c_f_pointer(handle, session)
      growth = radau_get_growth(session%solver)
      numbers = [growth%t, growth%re, growth%im]
   end subroutine rt_growth

   !> The last error, as a C string of at most 400 characters; empty if there is none.
   subroutine rt_message(handle, message) bind(c)
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
   end subroutine rt_message

   !> Integrate a chain with output on a grid of n_rows points into rows[n_rows, n]; t and y are where it ended.
   integer(c_int) function rt_integrate_chain(handle, t, y, t_end, interval, n_rows, rows) result(code) bind(c)
      type(c_ptr), value :: handle
      real(c_double), intent(inout) :: t
      real(c_double), intent(inout) :: y(*)
      real(c_double), value :: t_end, interval
      integer(c_int), value :: n_rows
      real(c_double), intent(out), target :: rows(*)
      real(wp), pointer :: grid(:, :)
      type(session_t), pointer :: session

      call c_f_pointer(handle, session)
      grid(1:session%model%n, 1:n_rows) => rows(1:session%model%n*n_rows)
      select type (chain => session%model)
      type is (oscillator_chain_t)
         call run_chain(session%solver, chain, t, y(:chain%n), t_end, interval, grid, session%status)
      end select
      code = session%status%code
   end function rt_integrate_chain

   !> Entries of what solves the condensed systems.
   pure integer function condensed_entries(self) result(entries)
      type(condensed_t), intent(in) :: self

      entries = size(self%retained)**2
      if (.not. self%is_inverted) entries = size(self%factors%column)
   end function condensed_entries

end module radau_capi
