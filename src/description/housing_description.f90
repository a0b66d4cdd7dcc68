!> Case parameters of a housing, and their validation.
module evl_housing_description
   use evl_accelerometer, only: accelerometer_take
   use evl_housing, only: housing_fixed, housing_mounted, housing_prescribed, housing_t
   use evl_housing_motion, only: motion_take, n_coordinates
   use evl_kinds, only: wp
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: not_negative, positive, range_t, row_t, span_t, type_block, type_choice, type_list, type_number, &
                      type_quaternion, type_triple
   use evl_status, only: code_invalid_input, fail, has_failed, status_t, subject_housing
   implicit none (type, external)
   private

   public :: housing_create

   real(wp), parameter :: rounding = 1.0e-12_wp !! relative: a flat body meets the triangle inequality with equality

   ! rows of the housing and its mount
   type(row_t), parameter, public :: &
      housing_rows(*) = [ &
      row_t("kind", type_choice, "", "fixed; prescribed motion; a rigid body on a mount", default="fixed", &
            words="fixed prescribed mounted"), &
      row_t("translation", type_list, "", "position of the origin in the ground frame; terms are added", &
            range=range_t(0.0_wp, 100.0_wp), default="[]", holds="translation", variants="prescribed"), &
      row_t("rotation", type_list, "", "rotation vector from the ground to the housing frame; terms are added", &
            range=range_t(0.0_wp, 100.0_wp), default="[]", holds="rotation", variants="prescribed"), &
      row_t("mass", type_number, "kg", "mass without wheels and supports", range=positive, required=.true., variants="mounted", &
            plausible=span_t(1.0e-3_wp, 1.0e6_wp)), &
      row_t("centre_of_mass", type_triple, "m", "centre of mass in the housing frame", default="[0, 0, 0]", variants="mounted", &
            plausible=span_t(0.0_wp, 20.0_wp)), &
      row_t("inertia", type_triple, "kg m2", "elements xx, yy, zz of the inertia tensor about the centre of mass, housing frame", &
            range=positive, required=.true., variants="mounted", plausible=span_t(1.0e-9_wp, 1.0e7_wp)), &
      row_t("products_of_inertia", type_triple, "kg m2", &
            "elements xy, yz, xz of the inertia tensor: minus the integrals of xy dm, yz dm, xz dm", &
            default="[0, 0, 0]", variants="mounted", &
            plausible=span_t(0.0_wp, 1.0e7_wp)), &
      row_t("mount", type_block, "", "springs and dampers to the ground", default="{}", holds="mount", variants="mounted"), &
      row_t("force", type_triple, "N", "constant force at the centre of mass, ground frame", default="[0, 0, 0]", &
            variants="mounted", plausible=span_t(0.0_wp, 1.0e7_wp)), &
      row_t("moment", type_triple, "N m", "constant moment, ground frame", default="[0, 0, 0]", variants="mounted", &
            plausible=span_t(0.0_wp, 1.0e7_wp)), &
      row_t("position", type_triple, "m", "position of the origin at the start, ground frame", default="[0, 0, 0]", &
            variants="mounted", plausible=span_t(0.0_wp, 1000.0_wp)), &
      row_t("orientation", type_quaternion, "", &
            "quaternion at the start, of nonzero length; it rotates the ground frame into the housing frame", &
            default="[1, 0, 0, 0]", variants="mounted"), &
      row_t("velocity", type_triple, "m/s", "velocity of the origin at the start, ground frame", default="[0, 0, 0]", &
            variants="mounted", plausible=span_t(0.0_wp, 300.0_wp)), &
      row_t("angular_velocity", type_triple, "rad/s", "angular velocity at the start, housing frame", default="[0, 0, 0]", &
            variants="mounted", plausible=span_t(0.0_wp, 1000.0_wp)), &
      row_t("accelerometers", type_list, "", "points whose acceleration is an" &
            //" output", range=range_t(0.0_wp, 100.0_wp), default="[]", &
            holds="accelerometer", variants="prescribed mounted")]

   type(row_t), parameter, public :: &
      mount_rows(*) = [ &
      row_t("point", type_triple, "m", &
            "attachment point, housing frame; the mount is unloaded if housing and ground frame coincide", &
            default="[0, 0, 0]", plausible=span_t(0.0_wp, 20.0_wp)), &
      row_t("stiffness", type_triple, "N/m", "components along the axes of the ground frame", &
            range=not_negative, default="[0, 0, 0]", &
            plausible=span_t(1.0_wp, 1.0e12_wp)), &
      row_t("damping", type_triple, "N s/m", "components along the axes of the ground frame", &
            range=not_negative, default="[0, 0, 0]", &
            plausible=span_t(1.0e-3_wp, 1.0e9_wp)), &
      row_t("rotational_stiffness", type_triple, "N m/rad", "components about x, y, z", range=not_negative, default="[0, 0, 0]", &
            plausible=span_t(1.0e-3_wp, 1.0e10_wp)), &
      row_t("rotational_damping", type_triple, "N m s/rad", "components about the axes of the housing frame", range=not_negative, &
            default="[0, 0, 0]", plausible=span_t(1.0e-6_wp, 1.0e8_wp))]

contains

   !> Create a housing from the checked description of a case. Errors: code_invalid_input with the field.
   subroutine housing_create(root, housing, status)
      type(parameter_view_t), intent(in) :: root
      type(housing_t), intent(out) :: housing
      type(status_t), intent(inout) :: status
      type(parameter_view_t) :: input

      housing%gravity = root%numbers("gravity")
      call root%inner("housing", input)
      select case (input%word("kind"))
      case ("prescribed")
         housing%kind = housing_prescribed
         call take_motion(input, housing)
      case ("mounted")
         housing%kind = housing_mounted
         call take_mounted(input, housing, status)
      end select
      call take_accelerometers(input, housing, status)
      housing%acts = housing%kind /= housing_fixed .or. any(abs(housing%gravity) > 0)
   end subroutine housing_create

   !> Accelerometers of the housing; a direction of zero length is invalid.
   subroutine take_accelerometers(input, housing, status)
      type(parameter_view_t), intent(in) :: input
      type(housing_t), intent(inout) :: housing
      type(status_t), intent(inout) :: status
      type(parameter_view_t), allocatable :: blocks(:)
      character(len=40) :: field
      integer :: i

      call input%elements("accelerometers", blocks)
      allocate (housing%accelerometers(size(blocks)))
      do i = 1, size(blocks)
         call accelerometer_take(blocks(i), housing%accelerometers(i))
         if (norm2(housing%accelerometers(i)%direction) > 0) cycle
         write (field, "(a, i0, a)") "accelerometers.", i - 1, ".direction"
         call refuse("a vector of zero length has no direction; give for instance [1, 0, 0], along x of the housing", trim(field), &
                     status)
      end do
   end subroutine take_accelerometers

   !> Report an invalid parameter, unless an error was reported before.
   subroutine refuse(message, field, status)
      character(len=*), intent(in) :: message, field
      type(status_t), intent(inout) :: status

      if (.not. has_failed(status)) call fail(status, code_invalid_input, message, subject_housing, field=field)
   end subroutine refuse

   !> Terms of a prescribed motion.
   subroutine take_motion(input, housing)
      type(parameter_view_t), intent(in) :: input
      type(housing_t), intent(inout) :: housing
      type(parameter_view_t), allocatable :: translation(:), rotation(:)
      integer :: i

      call input%elements("translation", translation)
      call input%elements("rotation", rotation)
      allocate (housing%motion(size(translation) + size(rotation)))
      do i = 1, size(translation)
         call motion_take(translation(i), 1, housing%motion(i))
      end do
      do i = 1, size(rotation)
         call motion_take(rotation(i), 1 + n_coordinates/2, housing%motion(size(translation) + i))
      end do
   end subroutine take_motion

   !> Inertia tensor from its diagonal and its elements xy, yz, xz.
   pure function tensor(diagonal, products) result(matrix)
      real(wp), intent(in) :: diagonal(3), products(3)
      real(wp) :: matrix(3, 3)

      matrix(:, 1) = [diagonal(1), products(1), products(3)]
      matrix(:, 2) = [products(1), diagonal(2), products(2)]
      matrix(:, 3) = [products(3), products(2), diagonal(3)]
   end function tensor

   !> Check that an inertia tensor is physical: positive definite, and no principal moment exceeds the sum of the others.
   !>
   !> The latter is equivalent to tr(I)/2 - I, the second moment of mass, being positive semidefinite.
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

   !> Parameters of a mounted housing.
   subroutine take_mounted(input, housing, status)
      type(parameter_view_t), intent(in) :: input
      type(housing_t), intent(inout) :: housing
      type(status_t), intent(inout) :: status
      type(parameter_view_t) :: mount

      housing%is_mounted = .true.
      housing%mass = input%number("mass")
      housing%centre = input%numbers("centre_of_mass")
      housing%inertia = tensor(input%numbers("inertia"), input%numbers("products_of_inertia"))
      call check_tensor(housing%inertia, status)
      call input%inner("mount", mount)
      housing%mount_point = mount%numbers("point")
      housing%stiffness = mount%numbers("stiffness")
      housing%damping = mount%numbers("damping")
      housing%turn_stiffness = mount%numbers("rotational_stiffness")
      housing%turn_damping = mount%numbers("rotational_damping")
      housing%force = input%numbers("force")
      housing%moment = input%numbers("moment")
      housing%position = input%numbers("position")
      housing%orientation = input%numbers("orientation")
      if (.not. norm2(housing%orientation) > 0) call refuse("a quaternion of zero length is not an" &
                                                            //" orientation", "orientation", status)
      housing%orientation = housing%orientation/norm2(housing%orientation)
      housing%velocity = input%numbers("velocity")
      housing%omega = input%numbers("angular_velocity")
   end subroutine take_mounted

end module evl_housing_description
