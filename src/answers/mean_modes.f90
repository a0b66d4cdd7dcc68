!> Natural modes of the mean over the positions of the meshes.
!>
!> The stiffness of a mesh changes as tooth pairs come and go; vibrations that are faster than neither feel its mean. Meshes of
!> several stages have pitches of their own. The positions are spread evenly over the least number of pitches of the first mesh in
!> which every mesh passes whole pitches; since their number is prime and does not divide that of the pitches, every mesh is met
!> at as many places of its own pitch, evenly spread too.
module evl_mean_modes
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_common_period, only: whole_pitches
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_initial, only: gearbox_start, initial_at, initial_equilibrium
   use evl_kinds, only: wp
   use evl_modes, only: linearised_matrix, modes_of_matrix
   use evl_outputs, only: gearbox_outputs
   use evl_status, only: clear, has_failed, status_t
   use evl_steady_position, only: first_mesh
   implicit none (type, external)
   private

   public :: gearbox_mean_modes

   !> Places in the part of a position, the first that has a steady state counts: where a damper's force jumps as flanks close, some
   !> have none.
   real(wp), parameter :: places(3) = [1/2.0_wp, 1/6.0_wp, 5/6.0_wp]
   integer, parameter :: primes(2) = [997, 1009]        !! positions; the second if the first divides the number of pitches

contains

   !> Eigenvalues and eigenvectors of the mean of A over the steady states, as gearbox_modes gives them, and the mean outputs.
   subroutine gearbox_mean_modes(gearbox, t, n_positions, y, integers, reals, n_modes, n_rigid, eigenvalues, vectors, values, &
                                 status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t                         !! [s]
      integer, intent(in) :: n_positions                !! over which the mean is taken; 0: 997, or 1009
      real(wp), intent(out) :: y(gearbox%n_states)      !! the steady state half a pitch from the start of contact
      integer, intent(out) :: integers(gearbox%n_integers), n_modes, n_rigid
      real(wp), intent(out) :: reals(size(gearbox%contacts))
      complex(wp), intent(out) :: eigenvalues(gearbox%n_states), vectors(gearbox%n_states, gearbox%n_states)
      real(wp), intent(out) :: values(gearbox%n_values) !! outputs
      type(status_t), intent(inout) :: status           !! as gearbox_modes, and of a steady start
      real(wp) :: matrix(gearbox%n_states, gearbox%n_states), yp(gearbox%n_states), outputs(gearbox%n_values), span
      real(wp), allocatable :: there(:, :)
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
      do i = 1, n
         do try = 1, size(places)
            call clear(status)
            call start_at((i - places(try))/n*span)
            if (.not. has_failed(status)) exit
         end do
         if (has_failed(status)) return
         call linearised_matrix(gearbox, t, y, integers, reals, there, status)
         if (.not. has_failed(status)) call gearbox_outputs(gearbox, t, y, integers, reals, .false., outputs, status)
         if (has_failed(status)) return
         matrix = matrix + there/n
         values = values + outputs/n
      end do
      call start_at(0.5_wp)
      if (.not. has_failed(status)) call modes_of_matrix(gearbox, y, matrix, n_modes, n_rigid, eigenvalues, vectors, status)

   contains

      !> The steady state so many pitches of the first mesh from the start of contact.
      subroutine start_at(pitches)
         real(wp), intent(in) :: pitches

         call gearbox_start(gearbox, initial_at(initial_equilibrium, pitches), t, y, yp, integers, reals, status)
      end subroutine start_at

   end subroutine gearbox_mean_modes

end module evl_mean_modes
