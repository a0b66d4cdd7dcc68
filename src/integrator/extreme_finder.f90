!> Search for new extremes of monitored channels within a step.
!>
!> The channel values at the eight nodes of the step are known approximately and define an interpolant of degree 7. Three
!> tests follow, each sharper and more expensive than the one before:
!>
!> - A channel departs from its value at the start by at most `most_between` times its largest departure at the nodes.
!> - Between the nodes and `n_between` intermediate times, a polynomial of degree 7 exceeds its largest value there by at most
!>   `most_hidden` of the range of these values (found by linear programming).
!> - For each remaining maximum of the interpolant, the time is computed.
!>
!> Maxima that pass are candidates: the caller evaluates the model itself around that time. For a channel with estimated values
!> only, the whole step may have to be searched: the maximum of an estimate says little about the position of the channel's maximum.
module evl_extreme_finder
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_collocation, only: combine, extremum_between, lagrange_matrix, polynomial_at, slopes_of
   use evl_kinds, only: lanes, wp
   use evl_ode_model, only: ode_model
   use evl_radau_coefficients, only: n_stages, node
   implicit none (type, external)
   private

   public :: candidate_t, extreme_finder_t, extreme_finder_create, find_candidates, most_candidates

   integer, parameter :: n_between = lanes
   integer, parameter :: n_samples = lanes + n_between
   integer, parameter :: most_candidates = n_samples + 1 !! of one row: maxima and minima among the samples

   real(wp), parameter :: most_between = 2.33_wp !! largest sum of |Lagrange polynomial k| on the step, k = 1 .. 7
   real(wp), parameter :: most_hidden = 0.2_wp
   real(wp), parameter :: roughness = 0.01_wp    !! of the range: possible deviation of the interpolant from its channel

   real(wp), parameter :: nearly = 1.0e-5_wp !! of range and value: possible deviation of a value at a node from that of its state

   real(wp), parameter :: between(n_between) = [0.085_wp, 0.205_wp, 0.28_wp, 0.405_wp, 0.485_wp, 0.665_wp, 0.85_wp, 0.97_wp]
   !> Nodes and intermediate times from left to right, as indices of [node, between].
   integer, parameter :: in_time(n_samples) = [8, 1, 9, 2, 10, 11, 3, 12, 13, 4, 14, 5, 15, 6, 16, 7]
   real(wp), parameter :: sample_tau(n_samples) = [node, between]

   !> A maximum or minimum of the interpolant that may exceed the extreme so far.
   type :: candidate_t
      integer :: channel = 0
      integer :: sense = 1               !! 1 maximum, -1 minimum
      real(wp) :: tau = 0                !! in units of the step
      real(wp) :: left = 0, right = 0    !! bracket of the extremum
      real(wp) :: value = 0              !! of the interpolant
   end type candidate_t

   !> Buffers for the rows of a model's channels.
   type :: extreme_finder_t
      integer :: n = 0
      integer, allocatable :: channels(:) !! [n_rows] the first n of these: channel of each row
      logical, allocatable :: is_rough(:) !! [n_monitored] channels with estimated values only
      real(wp), allocatable :: values(:, :) !! [8, n_rows] the rows
      real(wp) :: to_between(lanes, lanes) = 0 !! from values at the nodes to those at the intermediate times
   end type extreme_finder_t

contains

   !> Allocate the buffers for a model.
   subroutine extreme_finder_create(self, model)
      type(extreme_finder_t), intent(out) :: self
      class(ode_model), intent(in) :: model

      allocate (self%channels(model%n_rows), self%values(lanes, model%n_rows), self%is_rough(model%n_monitored))
      self%channels = 0
      self%is_rough = .false.
      if (allocated(model%is_rough)) self%is_rough = model%is_rough
      call lagrange_matrix(between, self%to_between)
   end subroutine extreme_finder_create

   !> Find candidates among the rows that are filled.
   pure subroutine find_candidates(self, high, low, n, found)
      type(extreme_finder_t), intent(in) :: self
      real(wp), intent(in) :: high(:), low(:)     !! [n_monitored] extremes to be exceeded; +huge and -huge: not requested
      integer, intent(out) :: n
      type(candidate_t), intent(inout) :: found(:) !! [most_candidates n_rows] the first n of these
      real(wp) :: at_start, most
      integer(int64) :: others ! as long as a real: vectors of both have the same lanes
      integer :: k, l

      n = 0
      do k = 1, self%n
         associate (values => self%values(:, k), upper => high(self%channels(k)), lower => low(self%channels(k)))
            at_start = values(lanes)
            most = min(upper - at_start, at_start - lower)*(1/most_between)
            others = 0
            !$omp simd reduction(ior:others)
            do l = 1, lanes
               others = ior(others, merge(0_int64, 1_int64, abs(values(l) - at_start) <= most))
            end do
            if (others == 0) cycle
            call look_between(self, k, upper, lower, n, found)
         end associate
      end do
   end subroutine find_candidates

   !> Second test of one row, and the third if necessary.
   pure subroutine look_between(self, k, upper, lower, n, found)
      type(extreme_finder_t), intent(in) :: self
      integer, intent(in) :: k
      real(wp), intent(in) :: upper, lower
      integer, intent(inout) :: n
      type(candidate_t), intent(inout) :: found(:)
      real(wp) :: samples(n_samples), slopes(lanes, 1), most, least, hidden
      logical :: is_rough

      is_rough = self%is_rough(self%channels(k))
      samples(:lanes) = self%values(:, k)
      call combine(1, self%to_between, self%values(:, k), samples(lanes + 1:))
      most = maxval(samples)
      least = minval(samples)
      hidden = most_hidden*(most - least)
      if (most + hidden <= upper .and. least - hidden >= lower) return
      call combine(1, slopes_of, self%values(:, k), slopes)
      if (most + hidden > upper) &
         call list_maxima(1, self%channels(k), is_rough, upper, samples, self%values(:, k), slopes(:, 1), n, found)
      if (least - hidden < lower) &
         call list_maxima(-1, self%channels(k), is_rough, lower, samples, self%values(:, k), slopes(:, 1), n, found)
   end subroutine look_between

   !> Third test: maxima or minima of the interpolant that come near the limit.
   pure subroutine list_maxima(sense, channel, is_rough, limit, samples, values, slopes, n, found)
      integer, intent(in) :: sense, channel
      logical, intent(in) :: is_rough !! the channel has estimated values only
      real(wp), intent(in) :: limit, samples(n_samples), values(lanes), slopes(lanes)
      integer, intent(inout) :: n
      type(candidate_t), intent(inout) :: found(:)
      real(wp) :: here, range, enough
      type(candidate_t) :: candidate
      integer :: i

      range = maxval(samples) - minval(samples)
      enough = sense*limit - most_hidden*range
      do i = 1, n_samples
         here = sense*samples(in_time(i))
         if (here < enough) cycle
         if (sense*samples(in_time(max(i - 1, 1))) > here) cycle
         if (i < n_samples .and. sense*samples(in_time(min(i + 1, n_samples))) >= here) cycle
         candidate = candidate_t(channel=channel, sense=sense, tau=sample_tau(in_time(i)), &
                                 left=sample_tau(in_time(max(i - 1, 1))), right=sample_tau(in_time(min(i + 1, n_samples))))
         if (ends_outward()) then
            if (here + nearly*(range + abs(here)) <= sense*limit) cycle
            n = n + 1
            candidate%left = merge(0.0_wp, candidate%tau, is_rough)
            candidate%right = merge(1.0_wp, candidate%tau, is_rough)
            candidate%value = sense*here
            found(n) = candidate
            cycle
         end if
         if (rises(candidate%left) .and. .not. rises(candidate%right)) &
            candidate%tau = extremum_between(candidate%left, candidate%right, slopes)
         candidate%value = polynomial_at(candidate%tau, values)
         if (sense*candidate%value < here) then ! the interpolant has several extrema here
            candidate%tau = sample_tau(in_time(i))
            candidate%value = samples(in_time(i))
         end if
         if (sense*candidate%value + roughness*range <= sense*limit) cycle
         if (is_rough) then
            candidate%left = 0
            candidate%right = 1
         end if
         n = n + 1
         found(n) = candidate
      end do

   contains

      !> Whether the step starts or ends within a slope; then no larger value is near.
      pure logical function ends_outward()
         real(wp) :: slope

         ends_outward = .false.
         if (i > 1 .and. i < n_samples) return
         slope = sense*slopes(merge(lanes, n_stages, i == 1))*merge(-1.0_wp, 1.0_wp, i == 1)
         ends_outward = slope*(candidate%right - candidate%left) > roughness*range
      end function ends_outward

      !> Whether the interpolant rises at tau, in the sense of the search.
      pure logical function rises(tau)
         real(wp), intent(in) :: tau

         rises = sense*polynomial_at(tau, slopes) > 0
      end function rises

   end subroutine list_maxima

end module evl_extreme_finder
