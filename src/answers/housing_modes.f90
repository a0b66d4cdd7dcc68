!> A mounted housing among the natural modes: its implicit equations made explicit, and small turns in place of a quaternion.
module evl_housing_modes
   use evl_gearbox, only: gearbox_t
   use evl_housing, only: at_omega, at_orientation, frame_t, housing_frame, housing_t, small_turns
   use evl_housing_dynamics, only: housing_coupling
   use evl_kinds, only: wp
   use evl_lapack, only: dgesv
   use evl_rotation, only: identity, skew
   use evl_status, only: code_singular, fail, status_t
   implicit none (type, external)
   private

   public :: explicit_matrix, quaternion_shape

contains

   !> From dF/dy to (dF/dy')^-1 dF/dy. Three small turns about the housing's axes stand in the places of the quaternion's vector
   !> part, and its scalar part takes no part: with p o (1, turn/2), turn' = dOmega - Omega x turn.
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
         mass(i, i) = mass(i, i) + 1
      end do
      call dgesv(n, n, mass, n, pivots, matrix, n, info)
      if (info /= 0) call fail(status, code_singular, "the accelerations of the housing are not determined at this state")
   end subroutine explicit_matrix

   !> Put the change of the quaternion in the place of the small turns of a mode shape.
   pure subroutine quaternion_shape(housing, y, shape)
      type(housing_t), intent(in) :: housing
      real(wp), intent(in) :: y(:)
      complex(wp), intent(inout) :: shape(:)
      real(wp) :: gradient(4, 3)

      associate (p => housing%i_state + at_orientation)
         gradient = small_turns(y(p:p + 3))
         shape(p:p + 3) = matmul(gradient, shape(p + 1:p + 3))
      end associate
   end subroutine quaternion_shape

end module evl_housing_modes
