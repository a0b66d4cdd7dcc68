!> What an integrator has to know of a model: y' = f(t, y) with discrete states, root functions and events.
!>
!> Nothing here knows what is being modelled. A model extends `ode_model`, keeps its discrete state in its own components, and
!> overrides what it has: right-hand side and Jacobian always, root functions if there are any.
!>
!> A procedure that has no answer for a trial state (outside a law's domain) reports `code_out_of_domain`: the integrator tries
!> a smaller step. But a step reaches beyond an event before that is located: in each discrete state f has to go on smoothly for
!> some way past the event that ends it. Any other code ends the integration with the model's message. Procedures should not
!> allocate.
module evl_ode_model
   use evl_kinds, only: lanes, wp
   use evl_status, only: code_invalid_input, fail, status_t
   implicit none (type, external)
   private

   public :: never, ode_model
   public :: growth_by_coupling, growth_by_damping, growth_never

   integer, parameter :: never = 2 !! as a direction: the root function has no zero in this discrete state and is not looked at

   integer, parameter :: growth_never = 0       !! no eigenvalue of J has a positive real part, but for slow motions
   integer, parameter :: growth_by_coupling = 1 !! some may have, since forces do not all come from a potential
   integer, parameter :: growth_by_damping = 2  !! and since damping can become negative along the motion

   !> A model; the components are set before the integrator is created and stay.
   type, abstract :: ode_model
      integer :: n = 0                        !! states
      integer :: n_roots = 0                  !! root functions
      integer :: n_watched = 0                !! channels whose extremes may be asked for
      integer :: n_rows = 0                   !! most rows of `watched_nearby`
      logical, allocatable :: is_rough(:)     !! [n_watched] what it tells of these is an estimate. Not allocated: of none
      integer, allocatable :: jacobian_row(:) !! [nnz] row of each entry that df/dy may have, from 1; no entry twice
      integer, allocatable :: jacobian_column(:) !! [nnz] its column
      !> States on which each root function depends: from root_first(i) to root_last(i) of the list. Not allocated: on all of them
      integer, allocatable :: root_first(:), root_last(:), root_states(:)
      real(wp), allocatable :: scale(:)       !! [n] unit in which an error of y(i) counts, > 0
      integer :: growth = growth_never        !! whether modes may grow, one of the constants above
      !> [n] how far each state may move in a step, > 0, so that eight nodes still see how f and the root functions go with it: a
      !> cycle of what repeats. Not allocated: as far as the error allows
      real(wp), allocatable :: reach(:)
   contains
      procedure(rhs_interface), deferred :: rhs
      procedure(rhs_lanes_interface), deferred :: rhs_lanes
      procedure(jacobian_interface), deferred :: jacobian
      procedure :: roots => no_roots
      procedure :: roots_lanes => no_roots_lanes
      procedure :: watched_nearby => nothing_watched
      procedure :: root_directions => no_directions
      procedure :: time_in_sight => all_time
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

      !> f of eight states at once: the lanes are independent of each other, and each gives what `rhs` gives.
      subroutine rhs_lanes_interface(self, t, y, f, status)
         import :: lanes, ode_model, status_t, wp
         implicit none (type, external)
         class(ode_model), intent(inout) :: self !! scratch of its own may change
         real(wp), intent(in) :: t(lanes)
         real(wp), intent(in) :: y(lanes, self%n)
         real(wp), intent(out) :: f(lanes, self%n)
         type(status_t), intent(inout) :: status !! touched on failure only; no answer for one lane is a failure
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

   !> Values of the root functions: an event is where one of them passes through zero. Each must be smooth between events.
   subroutine no_roots(self, t, y, values, status, only)
      class(ode_model), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(inout) :: values(self%n_roots)
      type(status_t), intent(inout) :: status !! touched on failure only
      integer, intent(in), optional :: only   !! the one that is wanted, 1 .. n_roots: the others need not be found, and of y
                                              !! no more is known than this one depends on

      values = 0
      if (self%n_roots > 0) call fail(status, code_invalid_input, "the model counts root functions but has none")
   end subroutine no_roots

   !> Root functions of eight states at once, which are almost those of the last `rhs_lanes`. For a first look they need not be
   !> exact: a model that knows most of them from there may give them as they were there. Where one comes near zero the exact ones
   !> are asked for as well, in the same states, with the values of the first look.
   subroutine no_roots_lanes(self, t, y, exact, values, status)
      class(ode_model), intent(inout) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      logical, intent(inout) :: exact !! whether they have to be; on return, whether they are
      real(wp), intent(inout) :: values(lanes, self%n_roots)
      type(status_t), intent(inout) :: status !! touched on failure only

      values = 0
      exact = .true.
      if (self%n_roots > 0) call fail(status, code_invalid_input, "the model counts root functions but has none")
   end subroutine no_roots_lanes

   !> Watched channels in eight states that are almost those of the last `rhs_lanes`, in rows that are smooth between events: a
   !> channel is the largest of its rows. What is 0 may be left out.
   subroutine nothing_watched(self, y, n, channels, values)
      class(ode_model), intent(inout) :: self
      real(wp), intent(in) :: y(lanes, self%n)
      integer, intent(out) :: n
      integer, intent(inout) :: channels(:)       !! [n_rows] the first n of these: to which channel a row belongs
      real(wp), intent(inout) :: values(lanes, *) !! [n_rows] of these

      n = 0
   end subroutine nothing_watched

   !> The same of time: how long a step from t may be, so that its nodes see what f does by time alone.
   pure real(wp) function all_time(self, t) result(longest)
      class(ode_model), intent(in) :: self
      real(wp), intent(in) :: t

      longest = huge(t)
   end function all_time

   !> Which crossings count in the present discrete state: +1 rising, -1 falling, 0 both, or `never`.
   subroutine no_directions(self, directions)
      class(ode_model), intent(in) :: self
      integer, intent(out) :: directions(self%n_roots)

      directions = 0
   end subroutine no_directions

end module evl_ode_model
