!> Period doubling: switch to the branch of doubled period, and detect the end of such a branch.
!>
!> Source: R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed., ch. 7.
module evl_branch_doubling
   use evl_branch_curve, only: chord_to
   use evl_flow, only: flow_t, follow
   use evl_indices, only: indices
   use evl_kinds, only: wp
   use evl_lapack, only: dgesvd
   use evl_multipliers, only: product_over_minus_one, product_over_pairs
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: move_orbit, orbit_options, orbit_t, own_multipliers, scaled_derivative
   use evl_shooting, only: correct_orbit
   use evl_shooting_system, only: find_tangent
   use evl_status, only: clear, code_no_solution, fail, has_failed, quantity, status_t
   implicit none (type, external)
   private

   public :: repeats_sooner, switch_at_doubling

contains

   !> Switch from an orbit with a multiplier -1 to one of doubled period, at a distance without special points between them. A
   !> branch whose period soon doubles again is small, and the iteration converges on it only if the distance is small, too.
   !> If no converged orbit is that near, the first converged one is returned.
   subroutine switch_at_doubling(model, options, doubling, distance, orbit, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: doubling  !! located
      real(wp), intent(in) :: distance       !! largest distance of the new orbit along the eigenvector, in units of the scales
      type(orbit_t), intent(out) :: orbit    !! with a tangent away from the doubling
      type(status_t), intent(inout) :: status
      integer, parameter :: most_attempts = 5
      real(wp), parameter :: shorter = 0.25_wp
      type(orbit_t) :: trial
      type(status_t) :: refusal
      real(wp) :: away(model%n + 2), length
      logical :: found, is_near
      integer :: attempt

      call find_direction(model, doubling, away, status)
      if (has_failed(status)) return
      found = .false.
      length = distance
      do attempt = 1, most_attempts
         call clear(refusal)
         call enter_branch(model, options, doubling, length*away, trial, is_near, refusal)
         if (.not. has_failed(refusal)) then
            if (is_near .or. .not. found) orbit = trial
            found = .true.
            if (is_near) return
         end if
         length = shorter*length
      end do
      if (.not. found) status = refusal
   end subroutine switch_at_doubling

   !> Compute an orbit of doubled period at a distance from the doubling.
   subroutine enter_branch(model, options, doubling, displacement, orbit, is_near, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: doubling
      real(wp), intent(in) :: displacement(:)         !! [n + 2] displacement along the eigenvector
      type(orbit_t), intent(out) :: orbit    !! with a tangent
      logical, intent(out) :: is_near        !! no special point lies between
      type(status_t), intent(inout) :: status
      real(wp), parameter :: beside = 0.5_wp !! of the displacement: the deviation due to curvature grows with its square
      real(wp), parameter :: upright = 1.0e-8_wp !! a branch at a constant parameter, as of a linear system
      real(wp), parameter :: little = 0.1_wp !! of the displacement: after half the periods, the orbit is about twice as far away
      type(orbit_t) :: start
      complex(wp) :: mu(size(own_multipliers(model, doubling)))
      real(wp) :: half(model%n)

      is_near = .false.
      start%parameter = doubling%parameter
      start%periods = 2*doubling%periods
      start%period = 2*doubling%period
      start%y = doubling%y
      call move_orbit(model, options, start, displacement)
      orbit = start
      call correct_orbit(model, options, orbit, status, displacement/norm2(displacement))
      if (.not. has_failed(status)) call find_tangent(model, options, orbit, displacement, status)
      if (.not. has_failed(status)) call find_half_defect(model, options, orbit, half, status)
      if (has_failed(status)) return
      if (norm2(half) < little*norm2(displacement)) then
         call fail(status, code_no_solution, "near the doubling at "//quantity(doubling%parameter, "")// &
                   " only the orbit of half the period was found")
         return
      end if
      if (size(own_multipliers(model, orbit)) /= size(mu)) return
      mu = own_multipliers(model, doubling)**2
      associate (now => own_multipliers(model, orbit), along => orbit%tangent(model%n + 2))
         is_near = norm2(chord_to(model, options, orbit, start)) <= beside*norm2(displacement) .and. &
                   sum(orbit%flow%crossings) == 2*sum(doubling%flow%crossings) .and. & ! sums, since memory slots are permuted
                   (abs(along) < upright .or. along*(orbit%parameter - doubling%parameter) > 0) .and. &
                   product_over_minus_one(mu)*product_over_minus_one(now) > 0 .and. &
                   product_over_pairs(mu)*product_over_pairs(now) > 0
      end associate
   end subroutine enter_branch

   !> Eigenvector of the multiplier -1: the last right singular vector of D + 1.
   subroutine find_direction(model, doubling, away, status)
      class(orbit_model), intent(in) :: model
      type(orbit_t), intent(in) :: doubling
      real(wp), intent(out) :: away(:) !! [n + 2]
      type(status_t), intent(inout) :: status
      real(wp), parameter :: near = 1.0e-3_wp
      real(wp), allocatable :: a(:, :), sizes(:), vectors(:, :), work(:)
      real(wp) :: no_vectors(1, 1)
      integer :: i, m, info

      m = count(doubling%active)
      allocate (a, source=scaled_derivative(model, doubling))
      do i = 1, m
         a(i, i) = a(i, i) + 1
      end do
      allocate (sizes(m), vectors(m, m), work(8*m))
      call dgesvd("N", "A", m, m, a, m, sizes, no_vectors, 1, vectors, m, work, size(work), info)
      if (info /= 0 .or. minval(abs(doubling%multipliers + 1)) > near) then
         call fail(status, code_no_solution, "the orbit at "//quantity(doubling%parameter, "")//" has no multiplier -1")
         return
      end if
      away = 0
      away(indices(doubling%active)) = vectors(m, :)*sign(1.0_wp, vectors(m, maxloc(abs(vectors(m, :)), 1)))
   end subroutine find_direction

   !> Whether an orbit repeats after half its periods, as at the end of a branch of doubled period.
   subroutine repeats_sooner(model, options, orbit, sooner, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit
      logical, intent(out) :: sooner
      type(status_t), intent(inout) :: status
      real(wp), parameter :: near = 1.0e-3_wp !! of the scales: near such a point orbits change with the root of the parameter
      real(wp) :: defect(model%n)

      sooner = .false.
      if (modulo(orbit%periods, 2) /= 0) return
      call find_half_defect(model, options, orbit, defect, status)
      sooner = .not. has_failed(status) .and. maxval(abs(defect)) < near
   end subroutine repeats_sooner

   !> Residual of the state of an orbit after half its periods.
   subroutine find_half_defect(model, options, orbit, defect, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit
      real(wp), intent(out) :: defect(:) !! [n] in units of the scales
      type(status_t), intent(inout) :: status
      type(flow_t) :: flow

      defect = 0
      call model%set_parameter(orbit%parameter, status)
      if (.not. has_failed(status)) &
         call follow(model, orbit%y, orbit%periods/2, orbit%period/2, options%tolerance, .false., flow, status)
      if (has_failed(status)) return
      defect = flow%y - orbit%y
      if (allocated(model%advance)) defect = defect - (orbit%periods/2)*model%advance
      defect = merge(defect/model%scale, 0.0_wp, orbit%active)
   end subroutine find_half_defect

end module evl_branch_doubling
