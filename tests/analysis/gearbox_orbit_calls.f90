!> Flows of a gearbox as a dynamical system, as C functions for tests; not part of the kernel's interface.
module gearbox_orbit_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_ptr
   use evl_capi_types, only: gearbox_of
   use evl_flow, only: flow_t, follow
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_orbits, only: gearbox_family, gearbox_orbits, gearbox_orbits_create, gearbox_orbits_start
   use evl_kinds, only: wp
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: test_orbit_flow, test_orbit_size

   !> One gearbox, independent of the parameter.
   type, extends(gearbox_family) :: one_gearbox
      type(gearbox_t), pointer :: gearbox => null()
      real(wp), allocatable :: scale(:)
   contains
      procedure :: take
   end type one_gearbox

contains

   subroutine take(self, value, gearbox, scale, status)
      class(one_gearbox), intent(inout) :: self
      real(wp), intent(in) :: value
      type(gearbox_t), pointer, intent(out) :: gearbox
      real(wp), allocatable, intent(out) :: scale(:)
      type(status_t), intent(inout) :: status

      gearbox => self%gearbox
      scale = self%scale
   end subroutine take

   subroutine make(handle, scale, section, family, model, status)
      type(c_ptr), intent(in) :: handle
      real(c_double), intent(in) :: scale(*), section
      type(one_gearbox), intent(inout), target :: family
      type(gearbox_orbits), intent(out) :: model
      type(status_t), intent(inout) :: status

      family%gearbox => gearbox_of(handle)
      family%scale = scale(:family%gearbox%n_states)
      call gearbox_orbits_create(model, family, 0.0_wp, section, status)
   end subroutine make

   !> Number of states of the system; -1 if it is not supported.
   integer(c_int) function test_orbit_size(handle, scale) result(n) bind(c)
      type(c_ptr), value :: handle
      real(c_double), intent(in) :: scale(*)
      type(one_gearbox), target :: family
      type(gearbox_orbits) :: model
      type(status_t) :: status

      call make(handle, scale, 0.0_c_double, family, model, status)
      n = merge(-1, model%n, has_failed(status))
   end function test_orbit_size

   !> End of a flow that starts at y (where y is NaN, at the state of the gearbox), and its derivative.
   integer(c_int) function test_orbit_flow(handle, scale, section, y_gears, turns, reals, change, periods, duration, end, &
                                           derivative, units, numbers) result(code) bind(c)
      type(c_ptr), value :: handle
      real(c_double), intent(in) :: scale(*), y_gears(*), reals(*)
      real(c_double), value :: section, duration           !! duration 0: the common periods
      integer(c_int), value :: turns, periods
      real(c_double), intent(in) :: change(*)            !! added to the start, in units of the scales
      real(c_double), intent(out) :: end(*), derivative(*), units(*) !! of the system; units of periodic states are positive
      integer(c_int), intent(out) :: numbers(3)          !! whether the modes are equal, ties, crossings
      type(one_gearbox), target :: family
      type(gearbox_orbits) :: model
      type(flow_t) :: flow
      type(status_t) :: status
      real(wp), allocatable :: start(:)

      numbers = 0
      call make(handle, scale, section, family, model, status)
      if (.not. has_failed(status)) then
         allocate (start(model%n))
         call gearbox_orbits_start(model, y_gears(:family%gearbox%n_states), turns, reals(:size(family%gearbox%contacts)), start)
         start = start + change(:model%n)*model%scale
         call follow(model, start, periods, merge(duration, periods*model%period, duration > 0), 1.0e-12_wp, .true., flow, &
                     status)
      end if
      if (.not. has_failed(status)) then
         end(:model%n) = flow%y
         derivative(:model%n**2) = reshape(flow%derivative, [model%n**2])
         units(:model%n) = merge(model%scale, 0.0_wp, model%repeats)
         numbers = [merge(1, 0, flow%same_modes), flow%ties, sum(flow%crossings)]
      end if
      code = status%code
   end function test_orbit_flow

end module gearbox_orbit_calls
