!> Natural modes of the mean over the mesh positions, and the modal distance of a start from the steady motion.
!>
!> The stiffness of a mesh varies as tooth pairs enter and leave; vibrations slower than this variation respond to its mean. Meshes
!> of several stages have different pitches. The positions are evenly spaced over the smallest number of pitches of the first mesh
!> in which every mesh passes whole pitches. Their number is prime and does not divide the number of pitches. So every mesh is
!> evaluated at as many evenly spaced positions of its own pitch.
!>
!> Distance of a start from the steady motion, in natural modes of the mean stiffness:
!>
!> Near the steady motion x' = A (x - x_s(t)). A is the mean of the linearised gearbox over one pitch of the first mesh, x_s the
!> static equilibrium at the current mesh positions, with the mean speeds. In the modes A v_k = lambda_k v_k of the mean the
!> harmonic n of x_s, of amplitude z_n in mode k, has the response z_n H_n, H_n = -lambda_k/(i n Omega - lambda_k). The motion is
!> this response plus sum a_k v_k exp(lambda_k t), which decays: a_k is the start minus the mean minus the response at the start.
!> Rigid-body modes, with eigenvalue 0, are excluded.
module evl_mean_modes
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_common_period, only: whole_pitches
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_initial, only: gearbox_start, initial_at, initial_equilibrium, initial_steady
   use evl_gearbox_scaling, only: gearbox_state_scales
   use evl_housing, only: at_orientation, small_turns
   use evl_indices, only: indices
   use evl_kinds, only: pi, wp
   use evl_lapack, only: dgesv
   use evl_local_variables, only: i_omega, i_theta
   use evl_modes, only: linearised_matrix, modes_of_matrix
   use evl_outputs, only: output_sampler, request_all, sample_state
   use evl_start_positions, only: mesh_position
   use evl_status, only: clear, code_no_solution, fail, has_failed, quantity, status_t
   use evl_steady_position, only: first_mesh
   implicit none (type, external)
   private

   public :: gearbox_mean_modes, gearbox_start_distance

   integer, parameter :: primes(2) = [997, 1009]        !! numbers of positions; the second if the first divides that of the pitches

   integer, parameter :: n_harmonics = 8
   integer, parameter :: n_positions = 2*n_harmonics + 1 !! over the pitch
   integer, parameter :: most_states = 300  !! above this limit the eigenvalues take too long
   !> Fractions of a position interval, tried in this order until a steady state exists: if a damper's force jumps as flanks close,
   !> it may not exist.
   real(wp), parameter :: parts(3) = [1/2.0_wp, 1/6.0_wp, 5/6.0_wp]

contains

   !> Eigenvalues and eigenvectors of the mean of A over the steady states, as from gearbox_modes, and the mean outputs.
   subroutine gearbox_mean_modes(gearbox, t, n_positions, y, integers, reals, n_modes, n_rigid, eigenvalues, vectors, values, &
                                 status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t                         !! [s]
      integer, intent(in) :: n_positions                !! of the mean; 0: 997, or 1009 if 997 divides the number of pitches
      real(wp), intent(out) :: y(gearbox%n_states)      !! the steady state half a pitch from the start of contact
      integer, intent(out) :: integers(gearbox%n_integers), n_modes, n_rigid
      real(wp), intent(out) :: reals(size(gearbox%contacts))
      complex(wp), intent(out) :: eigenvalues(gearbox%n_states), vectors(gearbox%n_states, gearbox%n_states)
      real(wp), intent(out) :: values(gearbox%n_values) !! outputs
      type(status_t), intent(inout) :: status           !! as for gearbox_modes, and for a steady start
      real(wp) :: matrix(gearbox%n_states, gearbox%n_states), yp(gearbox%n_states), outputs(gearbox%n_values), span
      real(wp), allocatable :: there(:, :)
      type(output_sampler) :: sampler
      integer(int64) :: pitches
      integer :: i, n, try

      n_modes = 0
      n_rigid = 0
      eigenvalues = 0
      vectors = 0
      matrix = 0
      values = 0
      pitches = whole_pitches(gearbox, first_mesh(gearbox))
      span = real(pitches, wp)
      n = n_positions
      if (n <= 0) n = primes(merge(2, 1, modulo(pitches, int(primes(1), int64)) == 0))
      call request_all(sampler, gearbox)
      do i = 1, n
         do try = 1, size(parts)
            call clear(status)
            call start_at((i - parts(try))/n*span)
            if (.not. has_failed(status)) exit
         end do
         if (has_failed(status)) return
         call linearised_matrix(gearbox, t, y, integers, reals, there, status)
         if (.not. has_failed(status)) call sample_state(sampler, gearbox, t, y, integers, reals, .false., outputs, status)
         if (has_failed(status)) return
         matrix = matrix + there/n
         values = values + outputs/n
      end do
      call start_at(0.5_wp)
      if (.not. has_failed(status)) call modes_of_matrix(gearbox, y, matrix, n_modes, n_rigid, eigenvalues, vectors, status)

   contains

      !> Steady state at a position in pitches of the first mesh from the start of contact.
      subroutine start_at(pitches)
         real(wp), intent(in) :: pitches

         call gearbox_start(gearbox, initial_at(initial_equilibrium, pitches), t, y, yp, integers, reals, status)
      end subroutine start_at

   end subroutine gearbox_mean_modes

   !> Modes, and the amplitude of each at the start.
   subroutine gearbox_start_distance(gearbox, t, start, turns, y, integers, reals, n_modes, eigenvalues, vectors, amplitudes, &
                                     status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t                             !! [s]
      real(wp), intent(in) :: start(gearbox%n_states)
      integer, intent(in) :: turns                          !! revolutions of the reference wheel at the start
      real(wp), intent(out) :: y(gearbox%n_states)          !! a steady state half a pitch from the start
      integer, intent(out) :: integers(gearbox%n_integers), n_modes
      real(wp), intent(out) :: reals(size(gearbox%contacts))
      complex(wp), intent(out) :: eigenvalues(gearbox%n_states) !! [1/s]
      complex(wp), intent(out) :: vectors(gearbox%n_states, gearbox%n_states) !! mode k; largest entry: one scale of the states
      complex(wp), intent(out) :: amplitudes(gearbox%n_states) !! a_k
      type(status_t), intent(inout) :: status               !! as for gearbox_modes, and for a steady start
      real(wp) :: samples(gearbox%n_states, n_positions + 1), matrix(gearbox%n_states, gearbox%n_states)
      real(wp) :: mean(gearbox%n_states), position, rate
      integer :: i, n_rigid

      n_modes = 0
      eigenvalues = 0
      vectors = 0
      amplitudes = 0
      if (gearbox%n_states > most_states) then
         call fail(status, code_no_solution, "its "//quantity(real(gearbox%n_states, wp), "")//" states are too many for modes")
         return
      end if
      position = mesh_position(gearbox, first_mesh(gearbox), start, turns)
      call sample_steady(gearbox, t, position, y, integers, reals, samples(:, :n_positions), matrix, status)
      if (has_failed(status)) return
      mean = sum(samples(:, :n_positions), dim=2)/n_positions
      call modes_of_matrix(gearbox, mean, matrix, n_modes, n_rigid, eigenvalues, vectors, status)
      if (has_failed(status) .or. n_modes == 0) return
      do i = 1, n_positions
         samples(:, i) = static_part(gearbox, samples(:, i) - mean)
      end do
      samples(:, n_positions + 1) = start - mean
      associate (contact => gearbox%contacts(gearbox%first(first_mesh(gearbox))))
         rate = 2*pi*mean(i_omega)*contact%pair%advance/contact%base_pitch
      end associate
      call find_amplitudes(gearbox, mean, samples, rate, n_modes, eigenvalues, vectors, amplitudes, status)
   end subroutine gearbox_start_distance

   !> Steady states over one pitch, and the mean of A; y is set to the state in the middle.
   subroutine sample_steady(gearbox, t, position, y, integers, reals, samples, matrix, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, position                   !! position: of the start [pitches]
      real(wp), intent(out) :: y(gearbox%n_states)
      integer, intent(out) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: reals(size(gearbox%contacts)), samples(:, :), matrix(:, :)
      type(status_t), intent(inout) :: status
      real(wp) :: yp(gearbox%n_states), here(gearbox%n_states), here_reals(size(gearbox%contacts))
      real(wp), allocatable :: there(:, :)
      integer :: here_integers(gearbox%n_integers), i, try

      matrix = 0
      do i = 1, n_positions
         do try = 1, size(parts)
            call clear(status)
            call gearbox_start(gearbox, initial_at(initial_steady, position + (i - parts(try))/n_positions), t, here, yp, &
                               here_integers, here_reals, status)
            if (.not. has_failed(status)) exit
         end do
         if (.not. has_failed(status)) call linearised_matrix(gearbox, t, here, here_integers, here_reals, there, status)
         if (has_failed(status)) return
         matrix = matrix + there/n_positions
         samples(:, i) = here
         if (i /= n_harmonics + 1) cycle
         y = here
         integers = here_integers
         reals = here_reals
      end do
   end subroutine sample_steady

   !> Change of the state without the speeds, which are the mean ones.
   pure function static_part(gearbox, change) result(part)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: change(gearbox%n_states)
      real(wp) :: part(gearbox%n_states)
      integer :: i

      part = change
      part(i_omega) = 0
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i), support => gearbox%wheels(i)%support)
            if (wheel%i_psi > 0) part(wheel%i_psi + 1) = 0
            part(support%i_state(:support%n) + 1) = 0
         end associate
      end do
   end function static_part

   !> Amplitudes of the last sample minus the response to the others. Equation N3.
   subroutine find_amplitudes(gearbox, mean, samples, rate, n_modes, eigenvalues, vectors, amplitudes, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: mean(:), samples(:, :), rate  !! rate: Omega of the mesh [rad/s]
      integer, intent(in) :: n_modes
      complex(wp), intent(in) :: eigenvalues(:)
      complex(wp), intent(inout) :: vectors(:, :), amplitudes(:)
      type(status_t), intent(inout) :: status
      real(wp) :: basis(n_modes, n_modes), right(n_modes, n_positions + 1)
      real(wp), dimension(gearbox%n_states) :: scale, row_scale
      integer, allocatable :: moving(:)
      integer :: info, k, pivots(n_modes)

      call gearbox_state_scales(gearbox, [real(wp) ::], scale, row_scale)
      call normalise(vectors(:, :n_modes), scale)
      call free_rows(gearbox, vectors(:, :n_modes), moving)
      if (size(moving) /= n_modes) then
         call fail(status, code_no_solution, "its modes do not span all motions")
         return
      end if
      do k = 1, n_modes
         if (eigenvalues(k)%im < 0) then
            basis(:, k) = aimag(rows_of(conjg(vectors(:, k))))
         else
            basis(:, k) = real(rows_of(vectors(:, k)), wp)
         end if
      end do
      do k = 1, n_positions + 1
         right(:, k) = real(rows_of(cmplx(samples(:, k), 0, wp)), wp)
      end do
      call dgesv(n_modes, n_positions + 1, basis, n_modes, pivots, right, n_modes, info)
      if (info /= 0) then
         call fail(status, code_no_solution, "its modes are not independent of each other")
         return
      end if
      do k = 1, n_modes
         if (eigenvalues(k)%im < 0 .or. .not. abs(eigenvalues(k)) > 0) cycle
         if (eigenvalues(k)%im > 0) then ! x = 2 Re(a v); the basis contains the real and the imaginary part of v
            amplitudes(k) = less_response(cmplx(right(k, :), -right(k + 1, :), wp)/2, eigenvalues(k), rate)
            amplitudes(k + 1) = conjg(amplitudes(k))
         else
            amplitudes(k) = less_response(cmplx(right(k, :), 0, wp), eigenvalues(k), rate)
         end if
      end do

   contains

      !> Free components of a change of the state, in units of the scales; small rotations for the orientation of a housing.
      function rows_of(change) result(rows)
         complex(wp), intent(in) :: change(:)
         complex(wp) :: rows(n_modes), turned(size(change))

         turned = change/scale
         associate (p => gearbox%housing%i_state + at_orientation)
            if (gearbox%housing%is_mounted) &
               turned(p + 1:p + 3) = 4*matmul(transpose(small_turns(mean(p:p + 3))), change(p:p + 3))/scale(p + 1:p + 3)
         end associate
         rows = turned(moving)
      end function rows_of

   end subroutine find_amplitudes

   !> Scale modes so that the largest entry is one scale of the states, without the angular position, which is not part of the
   !> distance.
   pure subroutine normalise(vectors, scale)
      complex(wp), intent(inout) :: vectors(:, :)
      real(wp), intent(in) :: scale(:)
      real(wp) :: size_of
      integer :: i, k

      do k = 1, size(vectors, 2)
         size_of = maxval(abs(vectors(:, k))/scale, mask=[(i /= i_theta, i=1, size(scale))])
         if (size_of > 0) vectors(:, k) = vectors(:, k)/size_of
         vectors(i_theta, k) = 0
      end do
   end subroutine normalise

   !> State indices moved by any mode, except the angle, which the speed determines, and the scalar part of the orientation.
   pure subroutine free_rows(gearbox, shapes, rows)
      type(gearbox_t), intent(in) :: gearbox
      complex(wp), intent(in) :: shapes(:, :)
      integer, allocatable, intent(out) :: rows(:)
      logical :: is_free(size(shapes, 1))
      integer :: i

      is_free = [(any(abs(shapes(i, :)) > 0), i=1, size(is_free))]
      is_free(i_theta) = .false.
      associate (p => gearbox%housing%i_state + at_orientation)
         if (gearbox%housing%is_mounted) then
            is_free(p) = .false.
            is_free(p + 1:p + 3) = .true.
         end if
      end associate
      rows = indices(is_free)
   end subroutine free_rows

   !> Amplitude at the start minus the response to the static path there. Equations N2, N3.
   pure complex(wp) function less_response(of_samples, lambda, rate) result(amplitude)
      complex(wp), intent(in) :: of_samples(n_positions + 1) !! those of the path, followed by that of the start
      complex(wp), intent(in) :: lambda
      real(wp), intent(in) :: rate
      complex(wp), parameter :: i_unit = (0.0_wp, 1.0_wp)
      complex(wp) :: harmonic
      integer :: j, n

      amplitude = of_samples(n_positions + 1)
      do n = -n_harmonics, n_harmonics
         harmonic = sum(of_samples(:n_positions)*exp(-i_unit*2*pi*n*[((j - 0.5_wp)/n_positions, j=1, n_positions)]))/n_positions
         amplitude = amplitude + harmonic*lambda/(i_unit*n*rate - lambda)
      end do
   end function less_response

end module evl_mean_modes
