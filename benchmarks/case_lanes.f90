!> One iteration of Newton's method for eight integrations, by two layouts of their stages.
!>
!> Stages in lanes, as the integrator has it: a vector is one component of one integration at its stages. Or cases in lanes: a
!> vector is one component at one stage of eight integrations. Both add up in the same order; if they do not end in the same bits,
!> the program says so. The pattern is that of a gear pair: three angles or positions, and three speeds that depend on everything.
!>
!> It prints nanoseconds of an iteration of one integration: stages in lanes; cases in lanes; and the change between the layouts,
!> which the second one needs since f is evaluated at the stages of one case.
program case_lanes
   use evl_condensed_systems, only: condensed_create, condensed_factor, condensed_solve, condensed_t
   use evl_kinds, only: lanes, wp
   use evl_radau_coefficients, only: from_stage, n_systems, shift_im, shift_re, to_stage
   use evl_stage_transforms, only: add_change, residual
   implicit none (type, external)

   integer, parameter :: n = 6, m = n/2          !! states, of which every second one is a speed
   integer, parameter :: cases = lanes
   integer, parameter :: turns = 20000, repetitions = 25
   integer, parameter :: row(m + m*n) = [1, 3, 5, spread(2, 1, n), spread(4, 1, n), spread(6, 1, n)]
   integer, parameter :: column(m + m*n) = [2, 4, 6, 1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 6]
   real(wp), parameter :: h = 0.01_wp

   type(condensed_t) :: systems(cases)
   !> [case, ...] the same factors as the systems have: inverse (.., entry, row), reciprocals of the shifts, J_vq and C
   real(wp) :: inverse(cases, n_systems, 2, m, m), per_shift(cases, n_systems, 2), coupling(cases, m, m), rate(cases, m)
   real(wp), dimension(lanes, n, cases) :: f, shifted, z, change, y           ! stages in lanes
   real(wp), dimension(cases, lanes, n) :: f_c, shifted_c, z_c, change_c, y_c ! cases in lanes
   real(wp) :: start(n, cases), start_c(cases, n), weight(n), square(cases), square_c(cases)
   real(wp) :: re(n_systems), im(n_systems) !! eigenvalues over h
   real(wp) :: best(3)
   integer :: repetition

   call make_cases
   re = shift_re/h
   im = shift_im/h
   call iterate_stages(1)
   call iterate_cases(1)
   if (.not. same_bits()) error stop "the two layouts give different numbers"
   re = 0 ! each iteration starts from the same Lambda/h w: what it changes does not wander off
   im = 0
   best = huge(best)
   do repetition = 1, repetitions
      call measure(iterate_stages, best(1))
      call measure(iterate_cases, best(2))
      call measure(exchange, best(3))
   end do
   print "(3f8.1)", best

contains

   !> Eight random matrices that decay, and what an iteration starts from.
   subroutine make_cases
      real(wp) :: jacobian(size(row))
      logical :: good
      integer :: c, i

      do c = 1, cases
         call condensed_create(systems(c), n, row, column)
         call random_number(jacobian)
         jacobian(m + 1:) = -100*jacobian(m + 1:)
         jacobian(:m) = 1
         call condensed_factor(systems(c), reshape([shift_re, shift_im], [n_systems, 2])/h, jacobian, good)
         if (.not. good) error stop "a matrix is singular"
         inverse(c, :, :, :, :) = systems(c)%inverse
         per_shift(c, :, :) = systems(c)%inverse_shift
         coupling(c, :, :) = reshape(systems(c)%coupling, [m, m])
         rate(c, :) = systems(c)%rate
      end do
      call random_number(f)
      f(lanes, :, :) = 0
      call random_number(shifted)
      shifted(n_systems + 1, :, :) = 0
      call random_number(start)
      z = 0
      weight = 1
      do c = 1, cases
         do i = 1, n
            f_c(c, :, i) = f(:, i, c)
            shifted_c(c, :, i) = shifted(:, i, c)
            start_c(c, i) = start(i, c)
         end do
      end do
      z_c = 0
   end subroutine make_cases

   !> CPU time of one of many turns for one case [ns], if it is shorter than what was found before.
   subroutine measure(what, shortest)
      interface
         subroutine what(times)
            implicit none (type, external)
            integer, intent(in) :: times
         end subroutine what
      end interface
      real(wp), intent(inout) :: shortest
      real(wp) :: before, after

      call cpu_time(before)
      call what(turns)
      call cpu_time(after)
      shortest = min(shortest, 1.0e9_wp*(after - before)/turns/cases)
   end subroutine measure

   !> Iterations with the stages in lanes, one case after the other.
   subroutine iterate_stages(times)
      integer, intent(in) :: times
      integer :: c, turn

      do turn = 1, times
         do c = 1, cases
            call residual(n, f(:, :, c), shifted(:, :, c), change(:, :, c))
            call condensed_solve(systems(c), change(:, :, c))
            call add_change(n, re, im, start(:, c), weight, change(:, :, c), shifted(:, :, c), z(:, :, c), y(:, :, c), square(c))
         end do
      end do
   end subroutine iterate_stages

   !> The same with the cases in lanes.
   subroutine iterate_cases(times)
      integer, intent(in) :: times
      integer :: turn

      do turn = 1, times
         call residual_of_cases(f_c, shifted_c, change_c)
         call solve_of_cases(change_c)
         call add_change_of_cases(change_c, shifted_c, z_c, y_c)
      end do
   end subroutine iterate_cases

   !> f of each case from its stages to lanes of cases, and the states back.
   subroutine exchange(times)
      integer, intent(in) :: times
      integer :: c, i, l, turn

      do turn = 1, times
         do i = 1, n
            do l = 1, lanes
               do c = 1, cases
                  f_c(c, l, i) = f(l, i, c)
               end do
            end do
            do c = 1, cases
               do l = 1, lanes
                  y(l, i, c) = y_c(c, l, i)
               end do
            end do
         end do
      end do
   end subroutine exchange

   !> As `residual`.
   subroutine residual_of_cases(f, shifted, r)
      real(wp), intent(in) :: f(cases, lanes, n), shifted(cases, lanes, n)
      real(wp), intent(out) :: r(cases, lanes, n)
      integer :: c, i, l

      do i = 1, n
         do l = 1, lanes
            !$omp simd
            do c = 1, cases
               r(c, l, i) = (((from_stage(l, 1)*f(c, 1, i) + from_stage(l, 2)*f(c, 2, i)) &
                              + (from_stage(l, 3)*f(c, 3, i) + from_stage(l, 4)*f(c, 4, i))) &
                             + ((from_stage(l, 5)*f(c, 5, i) + from_stage(l, 6)*f(c, 6, i)) &
                                + from_stage(l, 7)*f(c, 7, i))) - shifted(c, l, i)
            end do
         end do
      end do
   end subroutine residual_of_cases

   !> As `condensed_solve`, one system after the other.
   subroutine solve_of_cases(b)
      real(wp), intent(inout) :: b(cases, n_systems, 2, n) !! real and imaginary parts
      real(wp), dimension(cases, 2, m) :: q, x, v
      real(wp) :: re, im
      integer :: c, i, j, k

      do k = 1, n_systems
         do i = 1, m
            !$omp simd
            do c = 1, cases
               q(c, 1, i) = per_shift(c, k, 1)*b(c, k, 1, 2*i - 1) - per_shift(c, k, 2)*b(c, k, 2, 2*i - 1)
               q(c, 2, i) = per_shift(c, k, 1)*b(c, k, 2, 2*i - 1) + per_shift(c, k, 2)*b(c, k, 1, 2*i - 1)
            end do
         end do
         do i = 1, m
            !$omp simd private(re, im)
            do c = 1, cases
               re = b(c, k, 1, 2*i)
               im = b(c, k, 2, 2*i)
               do j = 1, m
                  re = re + coupling(c, j, i)*q(c, 1, j)
                  im = im + coupling(c, j, i)*q(c, 2, j)
               end do
               x(c, 1, i) = re
               x(c, 2, i) = im
            end do
         end do
         do i = 1, m
            !$omp simd private(re, im)
            do c = 1, cases
               re = 0
               im = 0
               do j = 1, m
                  re = re + (inverse(c, k, 1, j, i)*x(c, 1, j) - inverse(c, k, 2, j, i)*x(c, 2, j))
                  im = im + (inverse(c, k, 1, j, i)*x(c, 2, j) + inverse(c, k, 2, j, i)*x(c, 1, j))
               end do
               v(c, 1, i) = re
               v(c, 2, i) = im
            end do
         end do
         do i = 1, m
            !$omp simd private(re, im)
            do c = 1, cases
               b(c, k, 1, 2*i) = v(c, 1, i)
               b(c, k, 2, 2*i) = v(c, 2, i)
               re = per_shift(c, k, 1)*v(c, 1, i) - per_shift(c, k, 2)*v(c, 2, i)
               im = per_shift(c, k, 1)*v(c, 2, i) + per_shift(c, k, 2)*v(c, 1, i)
               b(c, k, 1, 2*i - 1) = q(c, 1, i) + rate(c, i)*re
               b(c, k, 2, 2*i - 1) = q(c, 2, i) + rate(c, i)*im
            end do
         end do
      end do
   end subroutine solve_of_cases

   !> As `add_change`.
   subroutine add_change_of_cases(dw, shifted, z, y)
      real(wp), intent(in) :: dw(cases, lanes, n)
      real(wp), intent(inout) :: shifted(cases, lanes, n), z(cases, lanes, n)
      real(wp), intent(out) :: y(cases, lanes, n)
      real(wp) :: total(cases, lanes), dz
      integer :: c, i, k, l

      total = 0
      do i = 1, n
         do l = 1, lanes
            !$omp simd private(dz)
            do c = 1, cases
               dz = ((to_stage(l, 1)*dw(c, 1, i) + to_stage(l, 2)*dw(c, 2, i)) &
                     + (to_stage(l, 3)*dw(c, 3, i) + to_stage(l, 4)*dw(c, 4, i))) &
                    + ((to_stage(l, 6)*dw(c, 6, i) + to_stage(l, 7)*dw(c, 7, i)) + to_stage(l, 8)*dw(c, 8, i))
               z(c, l, i) = z(c, l, i) + dz
               y(c, l, i) = start_c(c, i) + z(c, l, i)
               total(c, l) = total(c, l) + (dz*weight(i))**2
            end do
         end do
         do k = 1, n_systems
            !$omp simd
            do c = 1, cases
               shifted(c, k, i) = shifted(c, k, i) + (re(k)*dw(c, k, i) - im(k)*dw(c, k + n_systems, i))
               shifted(c, k + n_systems, i) = shifted(c, k + n_systems, i) &
                                              + (im(k)*dw(c, k, i) + re(k)*dw(c, k + n_systems, i))
            end do
         end do
      end do
      square_c = ((total(:, 1) + total(:, 2)) + (total(:, 3) + total(:, 4))) &
                 + ((total(:, 5) + total(:, 6)) + (total(:, 7) + total(:, 8)))
   end subroutine add_change_of_cases

   !> Whether both have found the same numbers.
   logical function same_bits()
      integer :: c

      same_bits = .not. any(abs(square - square_c) > 0) .and. all(square > 0)
      do c = 1, cases
         same_bits = same_bits .and. .not. any(abs(z(:, :, c) - z_c(c, :, :)) > 0) .and. &
                     .not. any(abs(y(:, :, c) - y_c(c, :, :)) > 0) .and. &
                     .not. any(abs(shifted(:, :, c) - shifted_c(c, :, :)) > 0)
      end do
   end function same_bits

end program case_lanes
