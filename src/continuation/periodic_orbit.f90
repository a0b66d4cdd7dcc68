!> Periodic orbit, or an approximation of one: integration over one round, and its residual.
!>
!> Unknowns are the state y on the section, the period T of an autonomous system and, along a branch, the parameter p; all in
!> units of their scales, as u = (y, T, p).
module evl_periodic_orbit
   use evl_flow, only: flow_t, follow
   use evl_indices, only: indices
   use evl_kinds, only: wp
   use evl_orbit_model, only: must_repeat, orbit_model
   use evl_status, only: code_no_solution, fail, has_failed, status_t
   implicit none (type, external)
   private

   public :: orbit_options, orbit_t
   public :: compare_ends, go_round, closure_defect, move_orbit, own_multipliers, scaled_derivative

   !> User options.
   type :: orbit_options
      real(wp) :: tolerance = 1.0e-12_wp      !! of the integration, in 1e-13 .. 0.1
      real(wp) :: residual = 1.0e-10_wp       !! largest difference after a period, in units of the scales
      integer :: most_iterations = 20         !! of Newton's method
      integer :: most_damped = 20             !! consecutive ones in which a full step increased the residual
      integer :: most_halvings = 8            !! of such a step
      real(wp) :: parameter_scale = 1         !! > 0: the change of the parameter that counts as 1
      real(wp) :: parameter_change = 1.0e-6_wp !! finite difference for dP/dp, over that scale; P may have corners
   end type orbit_options

   !> A periodic orbit, or an approximation of one.
   type :: orbit_t
      real(wp) :: parameter = 0
      integer :: periods = 1                  !! of the excitation, until it repeats; of an autonomous orbit, those in `period`
      real(wp) :: period = 0                  !! time until it repeats
      real(wp), allocatable :: y(:)           !! [n] on the section
      type(flow_t) :: flow                    !! over one round
      real(wp) :: residual = huge(1.0_wp)     !! in units of the scales
      integer :: iterations = 0               !! Newton iterations used
      logical, allocatable :: active(:)       !! [n] unknown states: they must repeat, and are not constant
      complex(wp), allocatable :: multipliers(:) !! of these, by descending magnitude
      real(wp), allocatable :: by_parameter(:) !! [n] dP/dp
      real(wp), allocatable :: tangent(:)     !! [n + 2] of the branch: y, T, p in units of their scales, of length 1
   end type orbit_t

contains

   !> Change the unknowns of an orbit.
   pure subroutine move_orbit(model, options, orbit, change)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit
      real(wp), intent(in) :: change(:) !! [n + 2] in units of the scales

      associate (n => model%n)
         if (model%autonomous) orbit%period = orbit%period*(1 + change(n + 1))
         orbit%y = orbit%y + change(:n)*model%scale
         orbit%parameter = orbit%parameter + change(n + 2)*options%parameter_scale
      end associate
   end subroutine move_orbit

   !> Integrate an orbit over one round.
   subroutine go_round(model, options, orbit, status, differentiate)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(inout) :: orbit
      type(status_t), intent(inout) :: status
      logical, intent(in), optional :: differentiate !! false: the derivative remains unchanged
      real(wp), allocatable :: derivative(:, :)

      call model%set_parameter(orbit%parameter, status)
      if (has_failed(status)) return
      if (.not. model%autonomous) orbit%period = orbit%periods*model%period
      if (.not. orbit%period > 0) then
         call fail(status, code_no_solution, "the period of the orbit fell to zero", field="period")
         return
      end if
      if (present(differentiate)) then
         if (.not. differentiate) derivative = orbit%flow%derivative
      end if
      call follow(model, orbit%y, orbit%periods, orbit%period, options%tolerance,.not. allocated(derivative), orbit%flow, status)
      if (has_failed(status)) return
      if (allocated(derivative)) orbit%flow%derivative = derivative
      call compare_ends(model, orbit)
   end subroutine go_round

   !> Determine the unknown states, and their residual after a period. Unknown are those that must repeat and are not
   !> constant, unlike a memory that no event of the orbit sets.
   pure subroutine compare_ends(model, orbit)
      class(orbit_model), intent(in) :: model
      type(orbit_t), intent(inout) :: orbit
      real(wp) :: row(model%n)
      logical :: repeats(model%n)
      integer :: i

      repeats = must_repeat(model)
      if (.not. allocated(orbit%active)) allocate (orbit%active(model%n))
      do i = 1, model%n
         row = orbit%flow%derivative(i, :)
         row(i) = row(i) - 1
         orbit%active(i) = repeats(i) .and. (any(abs(row) > 0) .or. abs(orbit%flow%y(i) - orbit%y(i)) > 0)
      end do
      orbit%residual = maxval(abs(closure_defect(model, orbit))/model%scale, orbit%active)
   end subroutine compare_ends

   !> Residual of the state after a period. Equation O1.
   pure function closure_defect(model, orbit) result(defect)
      class(orbit_model), intent(in) :: model
      type(orbit_t), intent(in) :: orbit
      real(wp) :: defect(model%n)

      defect = orbit%flow%y - orbit%y
      if (allocated(model%advance)) defect = defect - orbit%periods*model%advance
   end function closure_defect

   !> Derivative over the period in units of the scales, of the active states.
   pure function scaled_derivative(model, orbit) result(matrix)
      class(orbit_model), intent(in) :: model
      type(orbit_t), intent(in) :: orbit
      real(wp) :: matrix(count(orbit%active), count(orbit%active))
      integer :: list(count(orbit%active)), i, j

      list = indices(orbit%active)
      do j = 1, size(list)
         do i = 1, size(list)
            matrix(i, j) = orbit%flow%derivative(list(i), list(j))*model%scale(list(j))/model%scale(list(i))
         end do
      end do
   end function scaled_derivative

   !> Multipliers without the trivial one of an autonomous orbit, which is 1.
   pure function own_multipliers(model, orbit) result(multipliers)
      class(orbit_model), intent(in) :: model
      type(orbit_t), intent(in) :: orbit
      complex(wp) :: multipliers(size(orbit%multipliers) - merge(1, 0, model%autonomous .and. size(orbit%multipliers) > 0))
      integer :: own

      own = size(orbit%multipliers) + 1
      if (size(multipliers) < size(orbit%multipliers)) own = minloc(abs(orbit%multipliers - 1), 1)
      multipliers(:own - 1) = orbit%multipliers(:own - 1)
      multipliers(own:) = orbit%multipliers(own + 1:)
   end function own_multipliers

end module evl_periodic_orbit
