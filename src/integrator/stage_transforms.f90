!> Operations of the stage solver on all stages of a component: one vector of eight lanes.
!>
!> Sums over lanes have seven terms, since lane 8 of an increment and lane 5 of a transformed vector are 0. They are written
!> as independent pairs, and each loop over lanes is vectorised.
module evl_stage_transforms
   use evl_kinds, only: lanes, wp
   use evl_radau_coefficients, only: from_stage, integral_to_node, n_systems, shift_im, shift_re, to_stage
   implicit none (type, external)
   private

   public :: begin_with_change, continue_polynomial, linear_residual, start_stages
   public :: residual, add_change, change_of_stages, integrate, of_stages

   real(wp), parameter :: re(n_systems, lanes) = spread(shift_re, 2, lanes), im(n_systems, lanes) = spread(shift_im, 2, lanes)
   real(wp), parameter :: real_rows(n_systems, lanes) = re*from_stage(:n_systems, :) - im*from_stage(n_systems + 1:, :)
   real(wp), parameter :: imaginary_rows(n_systems, lanes) = im*from_stage(:n_systems, :) + re*from_stage(n_systems + 1:, :)
   !> Lambda T^-1
   real(wp), parameter :: to_shifted(lanes, lanes) = &
                          transpose(reshape([transpose(real_rows), transpose(imaginary_rows)], [lanes, lanes]))
   integer :: row
   real(wp), parameter :: of_constant(lanes) = [(sum(from_stage(row, :lanes - 1)), row=1, lanes)] !! T^-1 1

contains

   !> Increments of the next step from those of another one, and their transformation.
   pure subroutine continue_polynomial(n, matrix, old_z, h, z, shifted)
      integer, intent(in) :: n                     !! components
      real(wp), intent(in) :: matrix(lanes, lanes) !! from the increments at its nodes to those of the next step
      real(wp), intent(in) :: old_z(lanes, n)
      real(wp), intent(in) :: h                    !! next step
      real(wp), intent(out) :: z(lanes, n)
      real(wp), intent(out) :: shifted(lanes, n)   !! Lambda/h w
      real(wp) :: per_step
      integer :: i, l

      per_step = 1/h
      do i = 1, n
         !$omp simd
         do l = 1, lanes
            z(l, i) = of_stages(matrix, l, old_z(:, i))
         end do
      end do
      do i = 1, n
         !$omp simd
         do l = 1, lanes
            shifted(l, i) = per_step*of_stages(to_shifted, l, z(:, i))
         end do
      end do
   end subroutine continue_polynomial

   !> Right-hand sides of the systems for z' = f(start) + J z: T^-1 f, the same f at all stages. Equation R3.
   pure subroutine linear_residual(n, f, r)
      integer, intent(in) :: n
      real(wp), intent(in) :: f(n)
      real(wp), intent(out) :: r(lanes, n)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            r(l, i) = of_constant(l)*f(i)
         end do
      end do
   end subroutine linear_residual

   !> States at the stages before the first iteration; integrals count as constant until the coupled states are solved.
   pure subroutine start_stages(n, n_coupled, y, z, stage_y)
      integer, intent(in) :: n, n_coupled
      real(wp), intent(in) :: y(n)
      real(wp), intent(in) :: z(lanes, n_coupled)
      real(wp), intent(out) :: stage_y(lanes, n)
      integer :: i

      do i = 1, n_coupled
         stage_y(:, i) = y(i) + z(:, i)
      end do
      do i = n_coupled + 1, n
         stage_y(:, i) = y(i)
      end do
   end subroutine start_stages

   !> Right-hand sides of an iteration: T^-1 f - Lambda/h w. Equation R1.
   pure subroutine residual(n, f, shifted, r)
      integer, intent(in) :: n
      real(wp), intent(in) :: f(lanes, n)       !! at the stages
      real(wp), intent(in) :: shifted(lanes, n) !! Lambda/h w
      real(wp), intent(out) :: r(lanes, n)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            r(l, i) = of_stages(from_stage, l, f(:, i)) - shifted(l, i)
         end do
      end do
   end subroutine residual

   !> Add the change of an iteration: to Lambda/h w, to the increments and to the states.
   pure subroutine add_change(n, re, im, y, weight, dw, shifted, z, stage_y, square)
      integer, intent(in) :: n
      real(wp), intent(in) :: re(n_systems), im(n_systems) !! eigenvalues over h
      real(wp), intent(in) :: y(n), weight(n)
      real(wp), intent(in) :: dw(lanes, n)
      real(wp), intent(inout) :: shifted(lanes, n), z(lanes, n)
      real(wp), intent(out) :: stage_y(lanes, n)
      real(wp), intent(out) :: square !! sum of the weighted squares of the change of z
      real(wp) :: dz, total(lanes)
      integer :: i, l

      total = 0
      do i = 1, n
         !$omp simd private(dz)
         do l = 1, lanes
            dz = of_systems(to_stage, l, dw(:, i))
            z(l, i) = z(l, i) + dz
            stage_y(l, i) = y(i) + z(l, i)
            total(l) = total(l) + (dz*weight(i))**2
         end do
         !$omp simd
         do l = 1, n_systems
            shifted(l, i) = shifted(l, i) + (re(l)*dw(l, i) - im(l)*dw(l + n_systems, i))
            shifted(l + n_systems, i) = shifted(l + n_systems, i) + (im(l)*dw(l, i) + re(l)*dw(l + n_systems, i))
         end do
      end do
      square = ((total(1) + total(2)) + (total(3) + total(4))) + ((total(5) + total(6)) + (total(7) + total(8)))
   end subroutine add_change

   !> `add_change` without a prediction: the change is the whole increment.
   pure subroutine begin_with_change(n, n_coupled, re, im, y, dw, shifted, z, stage_y)
      integer, intent(in) :: n, n_coupled
      real(wp), intent(in) :: re(n_systems), im(n_systems) !! eigenvalues over h
      real(wp), intent(in) :: y(n)
      real(wp), intent(in) :: dw(lanes, n_coupled)
      real(wp), intent(out) :: shifted(lanes, n_coupled), z(lanes, n_coupled)
      real(wp), intent(out) :: stage_y(lanes, n) !! integrals count as constant until the coupled states are solved
      integer :: i, l

      do i = 1, n_coupled
         !$omp simd
         do l = 1, lanes
            z(l, i) = of_systems(to_stage, l, dw(:, i))
            stage_y(l, i) = y(i) + z(l, i)
         end do
         !$omp simd
         do l = 1, n_systems
            shifted(l, i) = re(l)*dw(l, i) - im(l)*dw(l + n_systems, i)
            shifted(l + n_systems, i) = im(l)*dw(l, i) + re(l)*dw(l + n_systems, i)
         end do
      end do
      do i = n_coupled + 1, n
         stage_y(:, i) = y(i)
      end do
   end subroutine begin_with_change

   !> Change of the increments, from that of the transformed vector.
   pure subroutine change_of_stages(n, dw, dz)
      integer, intent(in) :: n
      real(wp), intent(in) :: dw(lanes, n)
      real(wp), intent(out) :: dz(lanes, n)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            dz(l, i) = of_systems(to_stage, l, dw(:, i))
         end do
      end do
   end subroutine change_of_stages

   !> Increments of integrals from the values of f at the stages. Equation R11.
   pure subroutine integrate(n, h, f, z)
      integer, intent(in) :: n
      real(wp), intent(in) :: h
      real(wp), intent(in) :: f(lanes, n)
      real(wp), intent(out) :: z(lanes, n)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            z(l, i) = h*of_stages(integral_to_node, l, f(:, i))
         end do
      end do
   end subroutine integrate

   !> Row l of a matrix times a vector; lane 8 of the vector, or of the row, is 0.
   pure real(wp) function of_stages(matrix, l, x) result(total)
      real(wp), intent(in) :: matrix(lanes, lanes)
      integer, intent(in) :: l
      real(wp), intent(in) :: x(lanes)

      total = ((matrix(l, 1)*x(1) + matrix(l, 2)*x(2)) + (matrix(l, 3)*x(3) + matrix(l, 4)*x(4))) &
              + ((matrix(l, 5)*x(5) + matrix(l, 6)*x(6)) + matrix(l, 7)*x(7))
   end function of_stages

   !> Row l of a matrix times a transformed vector: 0 in lane 5, the imaginary part of the real system.
   pure real(wp) function of_systems(matrix, l, x) result(total)
      real(wp), intent(in) :: matrix(lanes, lanes)
      integer, intent(in) :: l
      real(wp), intent(in) :: x(lanes)

      total = ((matrix(l, 1)*x(1) + matrix(l, 2)*x(2)) + (matrix(l, 3)*x(3) + matrix(l, 4)*x(4))) &
              + ((matrix(l, 6)*x(6) + matrix(l, 7)*x(7)) + matrix(l, 8)*x(8))
   end function of_systems

end module evl_stage_transforms
