!> Gears, gears in mesh and the involute function for the tests: C calls that the kernel does not export.
module gear_calls
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_int, c_ptr
   use evl_capi_types, only: c_status, status_to_c
   use evl_cutter_generation, only: cutter_fillet
   use evl_gear, only: gear_cutter, gear_cutter_fit, gear_t, gear_thickness
   use evl_gear_derivation, only: gear_derive
   use evl_gears_in_mesh, only: gear_mesh_derive, gear_mesh_geometry, gear_mesh_input, gear_mesh_t
   use evl_involute_angle, only: involute_of_tangent, tangent_of_involute
   use evl_status, only: code_ok, code_out_of_domain, status_t
   use evl_tip_interference, only: tip_gap
   use first_wheel_of, only: first_wheel
   implicit none (type, external)
   private

   public :: test_cutter_fillet, test_gear_derive, test_gear_mesh_derive, test_gear_mesh_geometry, test_gear_tooth_thickness
   public :: test_involute_inverse, test_involute_value, test_tip_gap

contains

   !> Point of the fillet that the cutter of an internal gear cuts [m].
   subroutine test_cutter_fillet(gear, share, point) bind(c)
      type(gear_t), intent(in) :: gear
      real(c_double), intent(in), value :: share
      real(c_double), intent(out) :: point(2)

      point = cutter_fillet(gear_cutter(gear), gear_cutter_fit(gear), int(gear%teeth), share)
   end subroutine test_cutter_fillet

   !> Geometry of the first wheel of a description as a real gear.
   subroutine test_gear_derive(description, gear, status) bind(c)
      type(c_ptr), intent(in), value :: description
      type(gear_t), intent(out) :: gear
      type(c_status), intent(out) :: status
      type(status_t) :: s

      call gear_derive(first_wheel(description), gear, s)
      call status_to_c(s, status)
   end subroutine test_gear_derive

   !> Tooth thickness [m] at radii [m]; code_out_of_domain inside the base circle.
   subroutine test_gear_tooth_thickness(gear, n, radii, thickness, codes) bind(c)
      type(gear_t), intent(in) :: gear
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: radii(n)
      real(c_double), intent(out) :: thickness(n)
      integer(c_int), intent(out) :: codes(n)

      codes = merge(code_ok, code_out_of_domain, radii >= gear%base_radius)
      thickness = merge(gear_thickness(gear, max(radii, gear%base_radius)), 0.0_c_double, codes == code_ok)
   end subroutine test_gear_tooth_thickness

   !> Geometry of two real gears in mesh, A driving B.
   subroutine test_gear_mesh_derive(a, b, has_centre_distance, centre_distance, has_backlash, backlash, mesh, status) bind(c)
      type(gear_t), intent(in) :: a, b
      logical(c_bool), intent(in), value :: has_centre_distance, has_backlash
      real(c_double), intent(in), value :: centre_distance, backlash
      type(gear_mesh_t), intent(out) :: mesh
      type(c_status), intent(out) :: status
      type(status_t) :: s

      call gear_mesh_derive(a, b, gear_mesh_input(logical(has_centre_distance), logical(has_backlash), centre_distance, &
                                                  backlash), mesh, s)
      call status_to_c(s, status)
   end subroutine test_gear_mesh_derive

   !> The same at a centre distance, unchecked.
   subroutine test_gear_mesh_geometry(a, b, centre_distance, mesh) bind(c)
      type(gear_t), intent(in) :: a, b
      real(c_double), intent(in), value :: centre_distance
      type(gear_mesh_t), intent(out) :: mesh
      type(status_t) :: ignored

      call gear_mesh_geometry(a, b, gear_mesh_input(.true., .false., centre_distance, 0.0_c_double), mesh, ignored)
   end subroutine test_gear_mesh_geometry

   !> Smallest gap between the tip of a mate and an undercut gear [m].
   real(c_double) function test_tip_gap(gear, mate, centre_distance, working_pressure_angle, rho_tip) bind(c)
      type(gear_t), intent(in) :: gear, mate
      real(c_double), intent(in), value :: centre_distance, working_pressure_angle, rho_tip

      test_tip_gap = tip_gap(gear, mate, centre_distance, working_pressure_angle, rho_tip)
   end function test_tip_gap

   !> inv alpha = tan alpha - alpha of angles [rad].
   subroutine test_involute_value(n, angles, involutes) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: angles(n)
      real(c_double), intent(out) :: involutes(n)

      involutes = involute_of_tangent(tan(angles))
   end subroutine test_involute_value

   !> Its inverse.
   subroutine test_involute_inverse(n, involutes, angles) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: involutes(n)
      real(c_double), intent(out) :: angles(n)

      angles = atan(tangent_of_involute(involutes))
   end subroutine test_involute_inverse

end module gear_calls
