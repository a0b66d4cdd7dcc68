!> Error estimates of a step of the stage solver, and the step size that they allow.
!>
!> Sources: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., IV.8; docs/theory/radau.md.
submodule(evl_stage_solver) evl_stage_errors
   use evl_condensed_systems, only: condensed_solve_first
   use evl_dense_lu, only: dense_lu_solve_first
   use evl_jacobian_entries, only: apply_entries
   use evl_quadrature_states, only: integrate_error
   use evl_radau_coefficients, only: barycentric, slope_at_node, to_chebyshev
   use evl_stage_transforms, only: of_stages
   implicit none (type, external)

   integer :: row
   !> From the increments at the nodes: the slopes of the polynomial at the start and at the end, per step, and in lanes 5 to
   !> 8 the last Chebyshev coefficients.
   real(wp), parameter :: estimates(lanes, lanes) = &
                          transpose(reshape([slope_at_node(lanes, :), slope_at_node(n_stages, :), &
                                             (to_chebyshev(row, :), row=3, lanes)], [lanes, lanes]))
   real(wp), parameter :: nodes_over_chebyshev = 2.3_wp !! largest prod|tau - node| over that of Chebyshev's points

contains

   !> Weighted norm of the error estimate of the step just solved. NaN is preserved: max() may drop it. Equation R5.
   module procedure estimate_error
      real(wp) :: output_error

      self%error_weight = min(self%weight, self%most_weight)
      call examine(self%n, self%z, self%error_weight, self%slope, self%slope_at_end, self%last, self%before, &
                   self%next_coefficient)
      output_error = self%output_factor*nodes_over_chebyshev*self%next_coefficient
      call filter(self, self%start, h, error)
      if (error < 1) error = max(error, output_error)
      if (error < 1 .or. .not. again) return
      self%moved = y + self%error
      call model%rhs(t, self%moved, self%moved_f, status)
      self%counts%evaluations = self%counts%evaluations + 1
      if (has_failed(status)) then
         error = huge(error)
         return
      end if
      call filter(self, self%moved_f, h, error)
      if (error < output_error) error = output_error
   end procedure estimate_error

   !> Slopes of the polynomial at its ends, and the weighted norm of the next Chebyshev coefficients if the last pairs
   !> continue as a geometric series. Pairs are used because every other coefficient of an even or odd solution is 0. Equation R5.
   pure subroutine examine(n, z, weight, slope, slope_at_end, last, before, next)
      integer, intent(in) :: n
      real(wp), intent(in) :: z(lanes, n), weight(n)
      real(wp), intent(out) :: slope(n), slope_at_end(n)
      real(wp), intent(out) :: last(n), before(n) !! squares of the last pair and of the pair before it
      real(wp), intent(out) :: next
      real(wp) :: of(lanes)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            of(l) = of_stages(estimates, l, z(:, i))
         end do
         slope(i) = of(1)
         slope_at_end(i) = of(2)
         before(i) = of(5)**2 + of(6)**2
         last(i) = of(7)**2 + of(8)**2
      end do
      next = sqrt(sum(last*min(1.0_wp, last/max(before, tiny(1.0_wp)))*weight**2)/n)
   end subroutine examine

   !> Step size with an error of about 1, before any step is made: the eighth derivative of y is J^7 f if J hardly changes.
   !> Equation R8.
   !>
   !> The polynomial of degree 7 through the nodes c then differs from y by h^8 y''''''''/8! prod(tau - c). Its slope at the
   !> start differs by the product of the seven other nodes; the estimate is that divided by the real eigenvalue. Stiff
   !> components, which the filter would damp, make the result too small, not too large.
   module procedure predict_step
      real(wp), parameter :: factorial_8 = 40320
      real(wp), parameter :: at_start = 1/(shift_re(1)*abs(barycentric(lanes))*factorial_8)
      real(wp), parameter :: inside = nodes_over_chebyshev/(2.0_wp**15*factorial_8)
      real(wp) :: error
      integer :: turn

      self%moved_f = self%start
      do turn = 1, n_stages
         self%moved = self%moved_f
         call apply_entries(self%n, size(self%jacobian), model%jacobian_row, model%jacobian_column, self%jacobian, self%moved, &
                            self%moved_f)
      end do
      error = max(at_start, inside*self%output_factor)*sqrt(weighted_square(self%n, self%moved_f, self%weight)/self%n)
      h = 0
      if (error <= huge(error)) h = 1/real_power(max(error, tiny(1.0_wp)), 1.0_wp/8)
   end procedure predict_step

   !> (gamma/h I - J)^-1 (rate - p'(t)) and its weighted norm. Equation R4.
   pure subroutine filter(self, rate, h, error)
      type(stage_solver_t), intent(inout) :: self  !! slopes of the polynomial in `slope`
      real(wp), intent(in) :: rate(self%n) !! f at the start
      real(wp), intent(in) :: h
      real(wp), intent(out) :: error

      call subtract_slopes(self%n, rate, self%slope, 1/h, self%error)
      if (self%is_dense) then
         call dense_lu_solve_first(self%dense, self%error)
      else
         call condensed_solve_first(self%condensed, self%error)
      end if
      call integrate_error(self%integrals, self%n, h, self%jacobian, self%error)
      error = sqrt(weighted_square(self%n, self%error, self%error_weight)/self%n)
      if (error < 1.0e-10_wp) error = 1.0e-10_wp
   end subroutine filter

   !> f at the start minus the slope of the polynomial there.
   pure subroutine subtract_slopes(n, rate, slope, per_step, difference)
      integer, intent(in) :: n
      real(wp), intent(in) :: rate(n), slope(n), per_step
      real(wp), intent(out) :: difference(n)

      difference = rate - slope*per_step
   end subroutine subtract_slopes

   !> Sum of the squares of x in units of 1/weight.
   pure real(wp) function weighted_square(n, x, weight) result(square)
      integer, intent(in) :: n
      real(wp), intent(in) :: x(n), weight(n)

      square = sum((x*weight)**2)
   end function weighted_square

end submodule evl_stage_errors
