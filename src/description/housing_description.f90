!> The description that a housing is made from, and whether its numbers are in range.
module evl_housing_description
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use evl_housing, only: housing_fixed, housing_mounted, housing_prescribed, housing_t
   use evl_housing_motion, only: motion_prepare, motion_term, n_coordinates, term_constant, term_table
   use evl_kinds, only: wp
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t, subject_housing, subject_none
   implicit none (type, external)
   private

   public :: housing_input, housing_create

   real(wp), parameter :: rounding = 1.0e-12_wp !! relative: a flat body meets the triangle inequality with equality

   !> A housing as described; see `evl_housing` in the C header.
   type :: housing_input
      integer :: kind = housing_fixed
      real(wp) :: gravity(3) = 0.0_wp
      type(motion_term), allocatable :: terms(:)
      real(wp) :: mass = 0.0_wp, centre_of_mass(3) = 0.0_wp
      real(wp) :: inertia(3) = 0.0_wp, products(3) = 0.0_wp !! diagonal of the tensor; its elements xy, yz, xz
      real(wp) :: mount_point(3) = 0.0_wp
      real(wp) :: stiffness(3) = 0.0_wp, damping(3) = 0.0_wp, turn_stiffness(3) = 0.0_wp, turn_damping(3) = 0.0_wp
      real(wp) :: force(3) = 0.0_wp, moment(3) = 0.0_wp
      real(wp) :: position(3) = 0.0_wp, orientation(4) = 0.0_wp, velocity(3) = 0.0_wp, angular_velocity(3) = 0.0_wp
   end type housing_input

contains

   !> Make a housing. Errors: code_invalid_input with the field.
   subroutine housing_create(given, housing, status)
      type(housing_input), intent(in) :: given
      type(housing_t), intent(out) :: housing
      type(status_t), intent(inout) :: status

      if (.not. all(ieee_is_finite(given%gravity))) then
         call fail(status, code_invalid_input, "gravity must be three finite numbers", subject_none, field="gravity")
         return
      end if
      housing%kind = given%kind
      housing%gravity = given%gravity
      housing%acts = given%kind /= housing_fixed .or. any(abs(given%gravity) > 0)
      select case (given%kind)
      case (housing_fixed)
      case (housing_prescribed)
         call take_motion(given, housing, status)
      case (housing_mounted)
         call check_mounted(given, status)
         if (.not. has_failed(status)) call take_mounted(given, housing)
      case default
         call refuse("there is no such kind of housing", "kind", status)
      end select
   end subroutine housing_create

   !> Write a refusal down.
   subroutine refuse(message, field, status)
      character(len=*), intent(in) :: message, field
      type(status_t), intent(inout) :: status

      if (.not. has_failed(status)) call fail(status, code_invalid_input, message, subject_housing, field=field)
   end subroutine refuse

   !> The terms of a prescribed motion, checked.
   subroutine take_motion(given, housing, status)
      type(housing_input), intent(in) :: given
      type(housing_t), intent(inout) :: housing
      type(status_t), intent(inout) :: status
      character(len=11) :: field
      integer :: i, k

      housing%motion = given%terms
      do i = 1, size(housing%motion)
         associate (term => housing%motion(i))
            field = merge("rotation   ", "translation", term%coordinate > n_coordinates/2)
            if (term%coordinate < 1 .or. term%coordinate > n_coordinates) then
               call refuse("there is no such coordinate", trim(field), status)
            else if (term%kind < term_constant .or. term%kind > term_table) then
               call refuse("there is no such kind of term", trim(field), status)
            else if (.not. all(ieee_is_finite([term%value, term%frequency, term%phase]))) then
               call refuse("the numbers of a term must be finite", trim(field), status)
            else if (term%frequency < 0) then
               call refuse("frequency "//quantity(term%frequency, "Hz")//" must not be negative", trim(field), status)
            end if
            if (has_failed(status)) return
            if (term%kind /= term_table) cycle
            if (size(term%time) < 2 .or. size(term%values) /= size(term%time)) then
               call refuse("a table needs at least two knots, and as many values as times", trim(field), status)
            else if (.not. (all(ieee_is_finite(term%time)) .and. all(ieee_is_finite(term%values)))) then
               call refuse("times and values of a table must be finite numbers", trim(field), status)
            end if
            do k = 2, size(term%time)
               if (term%time(k) > term%time(k - 1)) cycle
               call refuse("the times of a table must increase, but "//quantity(term%time(k), "s")//" follows " &
                           //quantity(term%time(k - 1), "s"), trim(field), status)
            end do
            if (has_failed(status)) return
            call motion_prepare(term)
         end associate
      end do
   end subroutine take_motion

   !> Every number of a mounted housing is in its range.
   subroutine check_mounted(given, status)
      type(housing_input), intent(in) :: given
      type(status_t), intent(inout) :: status

      if (.not. (ieee_is_finite(given%mass) .and. given%mass > 0)) &
         call refuse("mass = "//quantity(given%mass, "kg")//" must be a finite number greater than 0", "mass", status)
      call check_finite(given%centre_of_mass, "centre_of_mass", status)
      call check_finite(given%inertia, "inertia", status)
      call check_finite(given%products, "products_of_inertia", status)
      if (.not. has_failed(status)) call check_tensor(tensor(given%inertia, given%products), status)
      call check_finite(given%mount_point, "mount.point", status)
      call check_not_negative(given%stiffness, "mount.stiffness", "N/m", status)
      call check_not_negative(given%damping, "mount.damping", "N s/m", status)
      call check_not_negative(given%turn_stiffness, "mount.rotational_stiffness", "N m/rad", status)
      call check_not_negative(given%turn_damping, "mount.rotational_damping", "N m s/rad", status)
      call check_finite(given%force, "force", status)
      call check_finite(given%moment, "moment", status)
      call check_finite(given%position, "position", status)
      call check_finite(given%orientation, "orientation", status)
      if (.not. norm2(given%orientation) > 0) call refuse("a quaternion of zero length is no orientation", "orientation", status)
      call check_finite(given%velocity, "velocity", status)
      call check_finite(given%angular_velocity, "angular_velocity", status)
   end subroutine check_mounted

   !> Finite numbers.
   subroutine check_finite(values, field, status)
      real(wp), intent(in) :: values(:)
      character(len=*), intent(in) :: field
      type(status_t), intent(inout) :: status

      if (.not. all(ieee_is_finite(values))) call refuse("must be finite numbers", field, status)
   end subroutine check_finite

   !> Finite numbers not less than 0.
   subroutine check_not_negative(values, field, unit, status)
      real(wp), intent(in) :: values(:)
      character(len=*), intent(in) :: field, unit
      type(status_t), intent(inout) :: status

      call check_finite(values, field, status)
      if (any(values < 0)) call refuse(quantity(minval(values), unit)//" must not be negative", field, status)
   end subroutine check_not_negative

   !> The inertia tensor from its diagonal and its elements xy, yz, xz.
   pure function tensor(diagonal, products) result(matrix)
      real(wp), intent(in) :: diagonal(3), products(3)
      real(wp) :: matrix(3, 3)

      matrix(:, 1) = [diagonal(1), products(1), products(3)]
      matrix(:, 2) = [products(1), diagonal(2), products(2)]
      matrix(:, 3) = [products(3), products(2), diagonal(3)]
   end function tensor

   !> Some body has this inertia tensor: it is positive definite, and no principal moment exceeds the sum of the others.
   !>
   !> The latter is the same as that tr(I)/2 - I, the second moment of the mass, is positive semidefinite.
   subroutine check_tensor(inertia, status)
      real(wp), intent(in) :: inertia(3, 3)
      type(status_t), intent(inout) :: status
      real(wp) :: second(3, 3), trace
      integer :: i

      trace = inertia(1, 1) + inertia(2, 2) + inertia(3, 3)
      if (.not. (inertia(1, 1) > 0 .and. minor(inertia, 1, 2) > 0 .and. determinant(inertia) > 0)) then
         call refuse("the inertia tensor is not positive definite", "inertia", status)
         return
      end if
      second = -inertia/trace
      do i = 1, 3
         second(i, i) = second(i, i) + 0.5_wp
      end do
      if (min(second(1, 1), second(2, 2), second(3, 3), minor(second, 1, 2), minor(second, 2, 3), minor(second, 1, 3), &
              determinant(second)) < -rounding) &
         call refuse("the inertia tensor breaks the triangle inequality: a principal moment of inertia exceeds the sum of the" &
                     //" two others, which no body has", "inertia", status)
   end subroutine check_tensor

   !> Principal minor of rows and columns i, j.
   pure real(wp) function minor(matrix, i, j)
      real(wp), intent(in) :: matrix(3, 3)
      integer, intent(in) :: i, j

      minor = matrix(i, i)*matrix(j, j) - matrix(i, j)*matrix(j, i)
   end function minor

   !> Determinant of a symmetric matrix.
   pure real(wp) function determinant(m)
      real(wp), intent(in) :: m(3, 3)

      determinant = m(1, 1)*minor(m, 2, 3) - m(1, 2)*(m(1, 2)*m(3, 3) - m(2, 3)*m(1, 3)) &
                    + m(1, 3)*(m(1, 2)*m(2, 3) - m(2, 2)*m(1, 3))
   end function determinant

   !> A mounted housing from its checked description.
   subroutine take_mounted(given, housing)
      type(housing_input), intent(in) :: given
      type(housing_t), intent(inout) :: housing

      housing%is_mounted = .true.
      housing%mass = given%mass
      housing%centre = given%centre_of_mass
      housing%inertia = tensor(given%inertia, given%products)
      housing%mount_point = given%mount_point
      housing%stiffness = given%stiffness
      housing%damping = given%damping
      housing%turn_stiffness = given%turn_stiffness
      housing%turn_damping = given%turn_damping
      housing%force = given%force
      housing%moment = given%moment
      housing%position = given%position
      housing%orientation = given%orientation/norm2(given%orientation)
      housing%velocity = given%velocity
      housing%omega = given%angular_velocity
   end subroutine take_mounted

end module evl_housing_description
