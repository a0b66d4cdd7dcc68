!> Interface of a model to the integrator: y' = f(t, y) with discrete states, root functions and events.
!>
!> The interface is independent of the modelled system. A model extends `ode_model`, stores its discrete state in its own
!> components, and overrides the procedures that apply: right-hand side and Jacobian always, root functions if there are any.
!>
!> A procedure that cannot be evaluated at a trial state (outside a law's domain) reports `code_out_of_domain`: the integrator
!> tries a smaller step. A step extends beyond an event before that is located: in each discrete state f must continue
!> smoothly for some distance past the event that ends it. Any other code ends the integration with the model's message.
!> Procedures should not allocate.
module evl_ode_model
   use evl_kinds, only: lanes, wp
   use evl_status, only: code_invalid_input, fail, status_t
   implicit none (type, external)
   private

   public :: never, ode_model
   public :: growth_by_coupling, growth_by_damping, growth_never

   integer, parameter :: never = 2 !! as a direction: the root function has no zero in this discrete state and is skipped

   integer, parameter :: growth_never = 0       !! no eigenvalue of J has a positive real part, except for slow motions
   integer, parameter :: growth_by_coupling = 1 !! some may have, since not all forces derive from a potential
   integer, parameter :: growth_by_damping = 2  !! and since damping can become negative along the motion

   !> A model; the components are set before the integrator is created and remain constant.
   type, abstract :: ode_model
      integer :: n = 0                        !! states
      integer :: n_roots = 0                  !! root functions
      integer :: n_monitored = 0                !! channels whose extremes can be requested
      integer :: n_rows = 0                   !! largest number of rows of `monitored_nearby`
      logical, allocatable :: is_rough(:)     !! [n_monitored] channels with estimated values only. Not allocated: none
      integer, allocatable :: jacobian_row(:) !! [nnz] row of each entry that df/dy may have, from 1; no entry twice
      integer, allocatable :: jacobian_column(:) !! [nnz] its column
      !> States on which each root function depends: root_states(root_first(i):root_last(i)). Not allocated: all states
      integer, allocatable :: root_first(:), root_last(:), root_states(:)
      real(wp), allocatable :: scale(:)       !! [n] unit of an error of y(i), > 0
      integer :: growth = growth_never        !! whether modes may grow, one of the constants above
      !> [n] largest movement of each state in a step, > 0, for which eight nodes resolve the variation of f and the root
      !> functions: one period of a periodic dependence. Not allocated: limited by the error only
      real(wp), allocatable :: reach(:)
   contains
      procedure(rhs_interface), deferred :: rhs
      procedure(rhs_lanes_interface), deferred :: rhs_lanes
      procedure(jacobian_interface), deferred :: jacobian
      procedure :: roots => no_roots
      procedure :: roots_lanes => no_roots_lanes
      procedure :: monitored_nearby => nothing_monitored
      procedure :: root_directions => no_directions
      procedure :: resolved_time => all_time
   end type ode_model

   abstract interface
      !> f(t, y)
      subroutine rhs_interface(self, t, y, f, status)
         import :: ode_model, status_t, wp
         implicit none (type, external)
         class(ode_model), intent(in) :: self
         real(wp), intent(in) :: t
         real(wp), intent(in) :: y(self%n)
         real(wp), intent(out) :: f(self%n)
         type(status_t), intent(inout) :: status !! touched on failure only
      end subroutine rhs_interface

      !> f of eight states at once; the lanes are independent of each other, and each equals the result of `rhs`.
      subroutine rhs_lanes_interface(self, t, y, f, status)
         import :: lanes, ode_model, status_t, wp
         implicit none (type, external)
         class(ode_model), intent(inout) :: self !! its scratch may change
         real(wp), intent(in) :: t(lanes)
         real(wp), intent(in) :: y(lanes, self%n)
         real(wp), intent(out) :: f(lanes, self%n)
         type(status_t), intent(inout) :: status !! touched on failure only; failure of one lane is a failure
      end subroutine rhs_lanes_interface

      !> df/dy, the entries in the order of `jacobian_row` and `jacobian_column`
      subroutine jacobian_interface(self, t, y, values, status)
         import :: ode_model, status_t, wp
         implicit none (type, external)
         class(ode_model), intent(in) :: self
         real(wp), intent(in) :: t
         real(wp), intent(in) :: y(self%n)
         real(wp), intent(out) :: values(:) !! [nnz]
         type(status_t), intent(inout) :: status !! touched on failure only
      end subroutine jacobian_interface
   end interface

contains

   !> Values of the root functions: an event is a zero crossing of one of them. Each must be smooth between events.
   subroutine no_roots(self, t, y, values, status, only)
      class(ode_model), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(inout) :: values(self%n_roots)
      type(status_t), intent(inout) :: status !! touched on failure only
      integer, intent(in), optional :: only   !! index of the requested function, 1 .. n_roots: the others need not be computed, and
                                              !! only the states on which this one depends are set in y

      values = 0
      if (self%n_roots > 0) call fail(status, code_invalid_input, "the model has a number of root functions, but no procedure" &
                                      //" for them")
   end subroutine no_roots

   !> Root functions of eight states at once, which are nearly those of the last `rhs_lanes`. A first evaluation need not be
   !> exact: a model may return the values it has from there. If one comes near zero, exact values are requested as well, in
   !> the same states, with the values of the first evaluation as input.
   subroutine no_roots_lanes(self, t, y, exact, values, status)
      class(ode_model), intent(inout) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      logical, intent(inout) :: exact !! in: exact values are required; out: the values are exact
      real(wp), intent(inout) :: values(lanes, self%n_roots)
      type(status_t), intent(inout) :: status !! touched on failure only

      values = 0
      exact = .true.
      if (self%n_roots > 0) call fail(status, code_invalid_input, "the model has a number of root functions, but no procedure" &
                                      //" for them")
   end subroutine no_roots_lanes

   !> Monitored channels in eight states that are nearly those of the last `rhs_lanes`, in rows that are smooth between
   !> events. A channel is the largest of its rows; rows that are 0 may be omitted.
   subroutine nothing_monitored(self, y, n, channels, values)
      class(ode_model), intent(inout) :: self
      real(wp), intent(in) :: y(lanes, self%n)
      integer, intent(out) :: n
      integer, intent(inout) :: channels(:)       !! [n_rows] the first n of these: channel of each row
      real(wp), intent(inout) :: values(lanes, *) !! [n_rows] the rows

      n = 0
   end subroutine nothing_monitored

   !> Longest step from t whose nodes resolve the explicit time dependence of f.
   pure real(wp) function all_time(self, t) result(longest)
      class(ode_model), intent(in) :: self
      real(wp), intent(in) :: t

      longest = huge(t)
   end function all_time

   !> Crossing directions that count in the present discrete state: +1 rising, -1 falling, 0 both, or `never`.
   subroutine no_directions(self, directions)
      class(ode_model), intent(in) :: self
      integer, intent(out) :: directions(self%n_roots)

      directions = 0
   end subroutine no_directions

end module evl_ode_model
