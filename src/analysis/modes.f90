!> Natural modes: the gearbox linearised at a state, with its eigenvalues and mode shapes.
!>
!> The motion is x' = A x with x = (omega, psi_i, psi_i', s_j, s_j') and A = -dF/dy of the explicit system, analytic. Not in x are:
!> the energies, on which nothing depends; the variables of tracked contact points, which follow the wheels, so every mesh is
!> evaluated in closed form; the angle of the driving wheel of the first mesh, which is fixed; prescribed speeds.
!> Contact modes and friction branches are fixed: events are excluded. A mounted housing adds its 12 states.
module evl_modes
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use evl_closed_form, only: centre_line_turn_gradient, error_of_turns, gradient_closed_form, track_closed_form
   use evl_contact_point, only: contact_gradient, contact_point
   use evl_dae_jacobian, only: gearbox_jacobian
   use evl_dae_residual, only: gearbox_derivative
   use evl_gearbox, only: gearbox_local, gearbox_t
   use evl_gearbox_scaling, only: gearbox_state_scales
   use evl_housing, only: at_omega, at_orientation, at_position, at_velocity, frame_t, housing_frame, is_balance, small_turns
   use evl_housing_dynamics, only: housing_coupling
   use evl_kinds, only: wp
   use evl_lapack, only: dgeevx, dgesv, dgesvd
   use evl_local_variables, only: at_psi_a, at_psi_b, i_omega, i_theta, n_local
   use evl_rotation, only: identity, skew
   use evl_status, only: code_no_solution, code_out_of_domain, code_singular, fail, has_failed, status_t, subject_mesh
   use evl_steady_position, only: first_mesh
   use evl_support, only: axle_deviation
   use evl_tooth_contact, only: tooth_contact_t
   use evl_wheel_loads, only: hold_still
   implicit none (type, external)
   private

   public :: free_states, gearbox_modes, hold_driving_wheel, linearised_matrix, modes_of_matrix, still_matrix
   public :: gearbox_shape

   real(wp), parameter :: rounding = 10*epsilon(1.0_wp) !! relative rounding error of a decomposition, per order of the matrix

contains

   !> Eigenvalues and eigenvectors of the gearbox at a state, in ascending magnitude, with complex pairs adjacent.
   !>
   !> An eigenvalue within rounding error of 0 is set to 0. In the vectors the angle theta follows from the speed, theta =
   !> omega/lambda; it is 0 if lambda is 0. Rigid-body modes are the independent motions without a restoring force. Rotation of the
   !> whole gearbox by theta is one of them unless its speed is prescribed.
   subroutine gearbox_modes(gearbox, t, y, integers, reals, n_modes, n_rigid, eigenvalues, vectors, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t                      !! [s]
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      integer, intent(out) :: n_modes                !! number of eigenvalues, at most n_states
      integer, intent(out) :: n_rigid                !! number of rigid-body modes
      complex(wp), intent(out) :: eigenvalues(gearbox%n_states) !! [1/s]; 0 past n_modes
      complex(wp), intent(out) :: vectors(gearbox%n_states, gearbox%n_states) !! column k in the states' units; 0 past n_modes
      type(status_t), intent(inout) :: status        !! code_out_of_domain, code_singular, code_no_solution
      real(wp), allocatable :: matrix(:, :)

      n_modes = 0
      n_rigid = 0
      eigenvalues = 0
      vectors = 0
      call linearised_matrix(gearbox, t, y, integers, reals, matrix, status)
      if (.not. has_failed(status)) call modes_of_matrix(gearbox, y, matrix, n_modes, n_rigid, eigenvalues, vectors, status)
   end subroutine gearbox_modes

   !> Modes of A, with each state in units of its scale, as from gearbox_modes.
   subroutine modes_of_matrix(gearbox, y, matrix, n_modes, n_rigid, eigenvalues, vectors, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states)
      real(wp), intent(in) :: matrix(:, :) !! from linearised_matrix
      integer, intent(out) :: n_modes, n_rigid
      complex(wp), intent(inout) :: eigenvalues(gearbox%n_states), vectors(gearbox%n_states, gearbox%n_states) !! input: 0
      type(status_t), intent(inout) :: status
      integer, allocatable :: speeds(:), positions(:), moving(:)
      complex(wp), allocatable :: shapes(:, :)
      real(wp) :: scale(gearbox%n_states)
      integer :: k, p

      n_modes = 0
      n_rigid = 0
      scale = state_scales(gearbox)
      call free_states(gearbox, speeds, positions)
      call find_nullity(matrix(speeds, positions), n_rigid, status)
      if (has_failed(status)) return
      if (gearbox%wheels(gearbox%reference)%prescribed == 0) n_rigid = n_rigid + 1
      n_modes = size(speeds) + size(positions)
      allocate (moving(n_modes), shapes(n_modes, n_modes))
      moving(:) = [speeds, positions]
      call decompose(matrix(moving, moving), eigenvalues(:n_modes), shapes, status)
      if (has_failed(status)) return
      call sort_by_size(eigenvalues(:n_modes), shapes)
      p = gearbox%housing%i_state + at_orientation
      do k = 1, n_modes
         vectors(moving, k) = shapes(:, k)*scale(moving)
         if (gearbox%housing%is_mounted) vectors(p:p + 3, k) = matmul(small_turns(y(p:p + 3)), vectors(p + 1:p + 3, k))
         if (abs(eigenvalues(k)) > 0) vectors(i_theta, k) = vectors(i_omega, k)/eigenvalues(k)
      end do
   end subroutine modes_of_matrix

   !> Scales of the states in the matrix.
   function state_scales(gearbox) result(scale)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), dimension(gearbox%n_states) :: scale, row_scale

      call gearbox_state_scales(gearbox, [real(wp) ::], scale, row_scale)
   end function state_scales

   !> State indices of the free speeds and positions.
   subroutine free_states(gearbox, speeds, positions)
      type(gearbox_t), intent(in) :: gearbox
      integer, allocatable, intent(out) :: speeds(:), positions(:)
      integer :: i

      allocate (speeds(0), positions(0))
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i), support => gearbox%wheels(i)%support)
            if (wheel%prescribed == 0 .and. wheel%leader == i) then
               speeds = [speeds, wheel%i_speed]
               if (wheel%i_psi > 0) positions = [positions, wheel%i_psi]
            end if
            positions = [positions, support%i_state(:support%n)]
            speeds = [speeds, support%i_state(:support%n) + 1]
         end associate
      end do
      if (.not. gearbox%housing%is_mounted) return
      associate (first => gearbox%housing%i_state)
         positions = [positions, (first + at_position + i, i=0, 2), (first + at_orientation + i, i=1, 3)]
         speeds = [speeds, (first + at_velocity + i, i=0, 2), (first + at_omega + i, i=0, 2)]
      end associate
   end subroutine free_states

   !> -dF/dy of the closed form, each state in units of its scale [1/s]. Equation M1.
   subroutine linearised_matrix(gearbox, t, y, integers, reals, matrix, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), reals(:)
      integer, intent(in) :: integers(:)
      real(wp), allocatable, intent(out) :: matrix(:, :)
      type(status_t), intent(inout) :: status
      type(gearbox_t) :: closed
      real(wp) :: scale(gearbox%n_states)
      integer :: i, k, n

      k = findloc(gearbox%contacts(gearbox%first(:size(gearbox%pairs)))%rigid, .true., dim=1)
      if (k > 0) then
         call fail(status, code_no_solution, "natural modes require a stiffness, but this contact is rigid; give it an" &
                   //" elastic law", &
                   subject_mesh, k, "contact.law")
         return
      end if
      n = gearbox%n_states
      scale = state_scales(gearbox)
      closed = gearbox
      call hold_still(closed)
      allocate (matrix(n, n))
      call still_matrix(closed, t, y, integers, reals, matrix, status)
      if (has_failed(status)) return
      call hold_driving_wheel(gearbox, matrix)
      do i = 1, n
         matrix(:, i) = matrix(:, i)*scale(i)/scale
      end do
   end subroutine linearised_matrix

   !> Derivatives at a constant angle of the driving wheel of the first mesh instead of the reference wheel, theta = -psi/g. Then
   !> the modes do not depend on the choice of the reference wheel. A wheel with a prescribed speed is always the reference wheel.
   pure subroutine hold_driving_wheel(gearbox, matrix)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(inout) :: matrix(:, :) !! from still_matrix

      associate (wheel => gearbox%wheels(gearbox%contacts(gearbox%first(first_mesh(gearbox)))%wheel_a))
         if (wheel%i_psi == 0 .or. gearbox%wheels(gearbox%reference)%prescribed > 0) return
         matrix(:, wheel%i_psi) = matrix(:, wheel%i_psi) - matrix(:, i_theta)/wheel%ratio
      end associate
   end subroutine hold_driving_wheel

   !> The same for a gearbox prepared by `hold_still`, in the units of the states. Equation M1.
   subroutine still_matrix(closed, t, y, integers, reals, matrix, status)
      type(gearbox_t), intent(in) :: closed
      real(wp), intent(in) :: t, y(closed%n_states), reals(:)
      integer, intent(in) :: integers(:)
      real(wp), intent(out) :: matrix(closed%n_states, closed%n_states)
      type(status_t), intent(inout) :: status
      real(wp) :: yp(closed%n_states)

      yp = 0 ! F is y' - f, independent of y' except for a mounted housing
      if (closed%housing%is_mounted) call gearbox_derivative(closed, t, y, integers, reals, yp, status)
      if (.not. has_failed(status)) call gearbox_jacobian(closed, t, 0.0_wp, y, yp, integers, reals, matrix, status)
      if (has_failed(status)) return
      if (closed%housing%is_mounted) call explicit_matrix(closed, t, y, yp, matrix, status)
      if (has_failed(status)) return
      matrix = -matrix
      if (.not. all(ieee_is_finite(matrix))) &
         call fail(status, code_out_of_domain, "the forces have no finite derivatives at this state")
   end subroutine still_matrix

   !> Eigenvalues and right eigenvectors of a matrix.
   !>
   !> Source: LAPACK Users' Guide, 3rd ed., section 4.8: rounding changes an eigenvalue by eps |A|/s, s its reciprocal condition
   !> number; those of a double zero by sqrt(eps) |A|.
   subroutine decompose(matrix, eigenvalues, shapes, status)
      real(wp), intent(in) :: matrix(:, :)
      complex(wp), intent(out) :: eigenvalues(:), shapes(:, :)
      type(status_t), intent(inout) :: status
      real(wp), dimension(size(matrix, 1)) :: re, im, balance, condition, condition_vectors
      real(wp), dimension(size(matrix, 1), size(matrix, 1)) :: a, left, right
      real(wp) :: norm, slack, work(size(matrix, 1)*(size(matrix, 1) + 6))
      integer :: n, i, low, high, info, unused(1)

      n = size(matrix, 1)
      if (n == 0) return
      a = matrix
      call dgeevx("B", "V", "V", "E", n, a, n, re, im, left, n, right, n, low, high, balance, norm, condition, &
                  condition_vectors, work, size(work), unused, info)
      if (info /= 0) then
         call fail(status, code_no_solution, "the eigenvalues were not found: the QR algorithm did not converge")
         return
      end if
      eigenvalues = cmplx(re, im, wp)
      shapes = cmplx(right, 0, wp)
      do i = 1, n - 1
         if (.not. im(i) > 0) cycle
         shapes(:, i) = cmplx(right(:, i), right(:, i + 1), wp)
         shapes(:, i + 1) = conjg(shapes(:, i))
      end do
      slack = n*rounding
      where (abs(eigenvalues) <= norm*min(slack/max(condition, tiny(norm)), sqrt(slack))) eigenvalues = 0
   end subroutine decompose

   !> Number of independent columns x with matrix x = 0; the entries have similar magnitudes.
   subroutine find_nullity(matrix, nullity, status)
      real(wp), intent(in) :: matrix(:, :)
      integer, intent(out) :: nullity
      type(status_t), intent(inout) :: status
      real(wp) :: a(size(matrix, 1), size(matrix, 2)), values(min(size(matrix, 1), size(matrix, 2))), u(1, 1), vt(1, 1)
      real(wp) :: work(5*(size(matrix, 1) + size(matrix, 2)))
      integer :: info

      nullity = size(matrix, 2)
      if (size(values) == 0) return
      a = matrix
      call dgesvd("N", "N", size(a, 1), size(a, 2), a, size(a, 1), values, u, 1, vt, 1, work, size(work), info)
      if (info /= 0) call fail(status, code_no_solution, "the singular values of the stiffness matrix were not found")
      nullity = nullity - count(values > maxval(shape(a))*rounding*values(1))
   end subroutine find_nullity

   !> Sort by ascending magnitude; the sort is stable, so complex pairs remain adjacent.
   pure subroutine sort_by_size(eigenvalues, shapes)
      complex(wp), intent(inout) :: eigenvalues(:), shapes(:, :)
      integer :: new_index(size(eigenvalues)), i

      do i = 1, size(new_index) ! equal magnitudes keep their order
         new_index(i) = count(abs(eigenvalues(:i)) <= abs(eigenvalues(i))) + count(abs(eigenvalues(i + 1:)) < abs(eigenvalues(i)))
      end do
      eigenvalues(new_index) = eigenvalues
      shapes(:, new_index) = shapes
   end subroutine sort_by_size

   !> First-order changes due to a change dy of the state y; linear in dy.
   pure subroutine gearbox_shape(gearbox, y, dy, arcs, displacements, penetrations, transmission_errors)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states), dy(gearbox%n_states)
      real(wp), intent(out) :: arcs(size(gearbox%wheels))             !! r_b phi, or r phi without a mesh, counterclockwise [m]
      real(wp), intent(out) :: displacements(2, size(gearbox%wheels)) !! x, y of each axle [m]
      real(wp), intent(out) :: penetrations(size(gearbox%pairs))     !! h of each mesh [m]
      real(wp), intent(out) :: transmission_errors(size(gearbox%pairs)) !! Delta of each mesh [m]
      integer :: i

      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            arcs(i) = wheel%ratio*dy(i_theta)
            if (wheel%i_psi > 0) arcs(i) = arcs(i) + dy(wheel%i_psi)
            arcs(i) = merge(wheel%base_radius, wheel%pitch_radius, abs(wheel%base_radius) > 0)*arcs(i)
            displacements(:, i) = axle_deviation(wheel%support, dy, 0)
         end associate
      end do
      do i = 1, size(gearbox%pairs)
         call mesh_shape(gearbox, gearbox%contacts(gearbox%first(i)), y, dy, penetrations(i), transmission_errors(i))
      end do
   end subroutine gearbox_shape

   !> Changes of penetration and transmission error of one mesh.
   pure subroutine mesh_shape(gearbox, contact, y, dy, penetration, transmission_error)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: y(:), dy(:)
      real(wp), intent(out) :: penetration, transmission_error
      real(wp), dimension(n_local) :: q, dq
      type(contact_point) :: point
      type(contact_gradient) :: gradient

      call gearbox_local(gearbox, contact, y, q)
      call gearbox_local(gearbox, contact, dy, dq)
      associate (pair => contact%pair)
         call track_closed_form(pair, contact%rho_start, q, point) ! neither h nor Delta depends on the position on the path
         call gradient_closed_form(pair, q, point, gradient)
         penetration = dot_product(gradient%h, dq)
         transmission_error = error_of_turns(pair, dq(at_psi_a), dq(at_psi_b), dot_product(centre_line_turn_gradient(pair, q), dq))
      end associate
   end subroutine mesh_shape

   !> Transform dF/dy to (dF/dy')^-1 dF/dy. Three small rotations about the housing's axes replace the vector part of the
   !> quaternion, and its scalar part is eliminated: with p o (1, turn/2), turn' = dOmega - Omega x turn. Equation M1.
   subroutine explicit_matrix(gearbox, t, y, yp, matrix, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), yp(gearbox%n_states)
      real(wp), intent(inout) :: matrix(gearbox%n_states, gearbox%n_states)
      type(status_t), intent(inout) :: status
      real(wp) :: mass(gearbox%n_states, gearbox%n_states)
      type(frame_t) :: frame
      integer :: pivots(gearbox%n_states), info, i, n

      n = gearbox%n_states
      call housing_frame(gearbox%housing, t, y, frame, yp)
      associate (p => gearbox%housing%i_state + at_orientation, o => gearbox%housing%i_state + at_omega)
         matrix(:, p + 1:p + 3) = matmul(matrix(:, p:p + 3), small_turns(frame%orientation))
         matrix(:, p) = 0
         matrix(p:p + 3, :) = 0
         matrix(p + 1:p + 3, p + 1:p + 3) = skew(frame%omega)
         matrix(p + 1:p + 3, o:o + 2) = -identity
      end associate
      call housing_coupling(gearbox, frame, y, mass)
      do i = 1, n
         if (.not. is_balance(gearbox%housing, i)) mass(i, i) = mass(i, i) + 1
      end do
      call dgesv(n, n, mass, n, pivots, matrix, n, info)
      if (info /= 0) call fail(status, code_singular, "the accelerations of the housing are not determined at this state")
   end subroutine explicit_matrix

end module evl_modes
