!> C interface of the static analysis of a mesh.
!>
!> The header's section "static analysis" documents each procedure; this module converts between C and Fortran.
module evl_capi_static
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_ptr
   use evl_capi_types, only: c_status, gearbox_of, return_code
   use evl_gearbox, only: gearbox_t
   use evl_static_analysis, only: find_largest, plan_static, solve_static_mesh, static_plan_t
   use evl_static_extremes, only: extremes_t
   use evl_static_outputs, only: static_counts, youngest
   use evl_static_wheel_root, only: find_wheel_root
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: evl_gearbox_static, evl_gearbox_static_largest, evl_gearbox_static_plan, evl_gearbox_static_layout, &
             evl_gearbox_static_root

   !> evl_static_plan
   type, bind(c) :: c_plan
      integer(c_int) :: n_pitches, n_positions, n_pairs, first_pair, n_wheels, n_values
      real(c_double) :: torque
   end type c_plan

contains

   integer(c_int) function evl_gearbox_static_plan(handle, mesh, points, plan, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh, points
      type(c_plan), intent(out) :: plan
      type(c_status), intent(inout), optional :: status
      type(static_plan_t) :: p
      type(status_t) :: s

      call plan_static(gearbox_of(handle), mesh + 1, points, p, s)
      plan = c_plan(p%n_pitches, p%n_positions, p%n_pairs, youngest, p%n_wheels, p%n_values, p%torque)
      code = return_code(s, status)
   end function evl_gearbox_static_plan

   subroutine evl_gearbox_static_layout(plan, offsets, counts) bind(c)
      type(c_plan), intent(in) :: plan
      integer(c_int), intent(inout) :: offsets(*), counts(*)
      integer, allocatable :: n(:)
      integer :: i

      call static_counts(plan%n_positions, plan%n_pairs, plan%n_wheels, n)
      counts(:size(n)) = n
      offsets(:size(n)) = [(sum(n(:i - 1)), i=1, size(n))]
   end subroutine evl_gearbox_static_layout

   integer(c_int) function evl_gearbox_static(handle, mesh, points, torque, speed, values, status) result(code) bind(c)
      integer(c_int), intent(in), value :: mesh, points
      real(c_double), intent(in), value :: torque, speed
      real(c_double), intent(inout) :: values(*)
      type(c_status), intent(inout), optional :: status
      type(static_plan_t) :: p
      type(status_t) :: s
      include "capi/gearbox_of_handle.inc"

      call plan_static(g, mesh + 1, points, p, s)
      if (.not. has_failed(s)) call solve_static_mesh(g, mesh + 1, p, torque, speed, values(:p%n_values), s)
      code = return_code(s, status)
   end function evl_gearbox_static

   integer(c_int) function evl_gearbox_static_largest(handle, mesh, first, pitches, torque, pair_force, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh, first, pitches
      real(c_double), intent(in), value :: torque
      real(c_double), intent(out) :: pair_force
      type(c_status), intent(inout), optional :: status
      type(extremes_t) :: extremes
      type(status_t) :: s

      call find_largest(gearbox_of(handle), mesh + 1, first, pitches, torque, .false., extremes, s)
      pair_force = extremes%force
      code = return_code(s, status)
   end function evl_gearbox_static_largest

   integer(c_int) function evl_gearbox_static_root(handle, wheel, first, pitches, torques, stress, status) result(code) bind(c)
      integer(c_int), intent(in), value :: wheel
      integer(c_int), intent(in) :: first(*), pitches(*)
      real(c_double), intent(in) :: torques(*)
      real(c_double), intent(out) :: stress
      type(c_status), intent(inout), optional :: status
      type(status_t) :: s
      include "capi/gearbox_of_handle.inc"

      associate (n => size(g%pairs))
         call find_wheel_root(g, wheel + 1, first(:n), pitches(:n), torques(:n), stress, s)
      end associate
      code = return_code(s, status)
   end function evl_gearbox_static_root

end module evl_capi_static
