!> State between the ends of the last step.
submodule(evl_radau) evl_radau_interpolation
   use evl_collocation, only: interpolate, lagrange_at, lagrange_matrix, weighted_sum
   implicit none (type, external)

contains

   !> State at time t in the last step: the collocation polynomial, of order 8 inside the step.
   module procedure radau_interpolate
      real(wp) :: basis(lanes)
      integer :: i

      if (.not. self%old_h > 0) then
         y = self%y
         return
      end if
      call lagrange_at((t - self%t_before)/self%old_h, basis)
      do i = 1, size(y)
         y(i) = self%y_before(i) + weighted_sum(basis, self%old_z(:, i))
      end do
   end procedure radau_interpolate

   !> `radau_interpolate` for some of the states.
   module procedure radau_interpolate_some
      real(wp) :: basis(lanes)
      integer :: i

      basis = 0
      if (self%old_h > 0) call lagrange_at((t - self%t_before)/self%old_h, basis)
      do i = 1, n
         associate (state => states(i) + 1)
            if (self%old_h > 0) then
               y(state - 1) = self%y_before(state) + weighted_sum(basis, self%old_z(:, state))
            else
               y(state - 1) = self%y(state)
            end if
         end associate
      end do
   end procedure radau_interpolate_some

   !> `radau_interpolate` at eight times, bitwise equal.
   module procedure radau_interpolate_lanes
      real(wp) :: matrix(lanes, lanes)
      integer :: i, l

      if (.not. self%old_h > 0) then
         do l = 1, lanes
            y(l, :) = self%y
         end do
         return
      end if
      call lagrange_matrix((t - self%t_before)/self%old_h, matrix)
      call interpolate(size(self%y), matrix, self%old_z, y)
      do i = 1, size(self%y)
         !$omp simd
         do l = 1, lanes
            y(l, i) = y(l, i) + self%y_before(i)
         end do
      end do
   end procedure radau_interpolate_lanes

end submodule evl_radau_interpolation
