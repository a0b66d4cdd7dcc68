!> Where the period of orbits doubles: from there to the branch of twice the period, and to see that such a branch has come back.
!>
!> Source: R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed., ch. 7.
module evl_branch_doubling
   use evl_flow, only: flow_t, follow
   use evl_kinds, only: wp
   use evl_lapack, only: dgesvd
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: move_orbit, orbit_options, orbit_t, scaled_derivative
   use evl_places, only: places
   use evl_shooting, only: correct_orbit
   use evl_shooting_system, only: find_tangent
   use evl_status, only: code_no_solution, fail, has_failed, quantity, status_t
   implicit none (type, external)
   private

   public :: repeats_sooner, switch_at_doubling

contains

   !> From an orbit with a multiplier -1 to one of twice the period.
   subroutine switch_at_doubling(model, options, doubling, distance, orbit, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: doubling  !! located
      real(wp), intent(in) :: distance       !! of the new orbit from it, along the multiplier's vector, in units of the scales
      type(orbit_t), intent(out) :: orbit    !! with a tangent away from the doubling
      type(status_t), intent(inout) :: status
      real(wp) :: away(model%n + 2)

      call find_direction(model, doubling, away, status)
      if (has_failed(status)) return
      orbit%parameter = doubling%parameter
      orbit%periods = 2*doubling%periods
      orbit%period = 2*doubling%period
      orbit%y = doubling%y
      call move_orbit(model, options, orbit, distance*away)
      call correct_orbit(model, options, orbit, status, away)
      if (.not. has_failed(status)) call find_tangent(model, options, orbit, away, status)
   end subroutine switch_at_doubling

   !> The vector of the multiplier -1: the last right singular vector of D + 1.
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
      away(places(doubling%active)) = vectors(m, :)*sign(1.0_wp, vectors(m, maxloc(abs(vectors(m, :)), 1)))
   end subroutine find_direction

   !> Whether an orbit repeats after half its periods, as where a branch of twice the period ends.
   subroutine repeats_sooner(model, options, orbit, sooner, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: orbit
      logical, intent(out) :: sooner
      type(status_t), intent(inout) :: status
      real(wp), parameter :: near = 1.0e-3_wp !! of the scales: orbits leave such a point with the root of the parameter
      type(flow_t) :: flow
      real(wp) :: lack(model%n)

      sooner = .false.
      if (modulo(orbit%periods, 2) /= 0) return
      call model%set_parameter(orbit%parameter, status)
      if (.not. has_failed(status)) &
         call follow(model, orbit%y, orbit%periods/2, orbit%period/2, options%tolerance, .false., flow, status)
      if (has_failed(status)) return
      lack = flow%y - orbit%y
      if (allocated(model%advance)) lack = lack - (orbit%periods/2)*model%advance
      sooner = maxval(abs(lack)/model%scale, orbit%active) < near
   end subroutine repeats_sooner

end module evl_branch_doubling
