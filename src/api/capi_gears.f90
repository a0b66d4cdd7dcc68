!> C interface of real gears: their geometry alone and in a gearbox, and the involute function.
!>
!> The header documents each procedure; here is only the passage from C to Fortran.
module evl_capi_gears
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_f_pointer, c_int, c_ptr
   use evl_capi_description, only: c_gear, gear_from_c
   use evl_capi_types, only: c_status, first_error, status_to_c
   use evl_gear, only: gear_derive, gear_t, gear_thickness
   use evl_gearbox, only: gearbox_t
   use evl_gears_in_mesh, only: gear_mesh_derive, gear_mesh_input, gear_mesh_t
   use evl_involute_angle, only: involute_of_tangent, tangent_of_involute
   use evl_status, only: code_ok, code_out_of_domain, status_t
   implicit none (type, external)
   private

   public :: evl_gear_derive, evl_gear_mesh_derive, evl_gear_tooth_thickness, evl_gearbox_gear, evl_gearbox_gear_mesh
   public :: evl_involute_inverse, evl_involute_value

   !> evl_gear
   type, bind(c) :: c_gear_geometry
      integer(c_int) :: teeth
      real(c_double) :: normal_module, pressure_angle, profile_shift, generating_shift, undercut_shift, tip_alteration
      real(c_double) :: pitch, base_pitch
      real(c_double) :: reference_radius, base_radius, tip_radius, root_radius, form_radius, bore_radius, tooth_depth
      real(c_double) :: thickness, thickness_allowance, tip_thickness, tooth_angle
      logical(c_bool) :: is_undercut
   end type c_gear_geometry

   !> evl_gears_in_mesh
   type, bind(c) :: c_gear_mesh
      real(c_double) :: centre_distance, reference_distance, tight_distance, working_pressure_angle
      real(c_double) :: pitch_radius_a, pitch_radius_b, line_of_action, base_pitch
      real(c_double) :: path_of_contact, approach, recess, contact_ratio, rho_tip_a, rho_tip_b
      real(c_double) :: active_radius_a, active_radius_b, clearance_a, clearance_b
      real(c_double) :: backlash, circumferential_backlash, radial_backlash
   end type c_gear_mesh

contains

   integer(c_int) function evl_gear_derive(teeth, gear, geometry, status) bind(c)
      integer(c_int), intent(in), value :: teeth
      type(c_gear), intent(in) :: gear
      type(c_gear_geometry), intent(out) :: geometry
      type(c_status), intent(out), optional :: status
      type(gear_t) :: g
      type(status_t) :: s

      call gear_derive(teeth, gear_from_c(gear), g, s)
      geometry = gear_to_c(g)
      if (present(status)) call status_to_c(s, status)
      evl_gear_derive = s%code
   end function evl_gear_derive

   integer(c_int) function evl_gear_tooth_thickness(geometry, n, radii, thickness, codes) bind(c)
      type(c_gear_geometry), intent(in) :: geometry
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: radii(n)
      real(c_double), intent(out) :: thickness(n)
      integer(c_int), intent(out) :: codes(n)
      type(gear_t) :: gear

      gear = gear_of_c(geometry)
      codes = merge(code_ok, code_out_of_domain, radii >= gear%base_radius)
      thickness = merge(gear_thickness(gear, max(radii, gear%base_radius)), 0.0_c_double, codes == code_ok)
      evl_gear_tooth_thickness = first_error(codes)
   end function evl_gear_tooth_thickness

   integer(c_int) function evl_gear_mesh_derive(a, b, has_centre_distance, centre_distance, has_backlash, backlash, mesh, &
                                                status) bind(c)
      type(c_gear_geometry), intent(in) :: a, b
      logical(c_bool), intent(in), value :: has_centre_distance, has_backlash
      real(c_double), intent(in), value :: centre_distance, backlash
      type(c_gear_mesh), intent(out) :: mesh
      type(c_status), intent(out), optional :: status
      type(gear_mesh_t) :: m
      type(status_t) :: s

      call gear_mesh_derive(gear_of_c(a), gear_of_c(b), gear_mesh_input(logical(has_centre_distance), logical(has_backlash), &
                                                                        centre_distance, backlash), m, s)
      mesh = mesh_to_c(m)
      if (present(status)) call status_to_c(s, status)
      evl_gear_mesh_derive = s%code
   end function evl_gear_mesh_derive

   logical(c_bool) function evl_gearbox_gear(handle, wheel, geometry) result(is_gear) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel
      type(c_gear_geometry), intent(out) :: geometry
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      geometry = gear_to_c(g%gears(wheel + 1))
      is_gear = g%gears(wheel + 1)%teeth > 0
   end function evl_gearbox_gear

   logical(c_bool) function evl_gearbox_gear_mesh(handle, mesh, geometry) result(is_mesh) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      type(c_gear_mesh), intent(out) :: geometry
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      geometry = mesh_to_c(g%gear_meshes(mesh + 1))
      is_mesh = g%gear_meshes(mesh + 1)%exists
   end function evl_gearbox_gear_mesh

   subroutine evl_involute_value(n, angles, involutes) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: angles(n)
      real(c_double), intent(out) :: involutes(n)

      involutes = involute_of_tangent(tan(angles))
   end subroutine evl_involute_value

   subroutine evl_involute_inverse(n, involutes, angles) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: involutes(n)
      real(c_double), intent(out) :: angles(n)

      angles = atan(tangent_of_involute(involutes))
   end subroutine evl_involute_inverse

   pure type(c_gear_geometry) function gear_to_c(g) result(c)
      type(gear_t), intent(in) :: g

      c = c_gear_geometry( &
          teeth=g%teeth, normal_module=g%normal_module, pressure_angle=g%pressure_angle, profile_shift=g%profile_shift, &
          generating_shift=g%generating_shift, undercut_shift=g%undercut_shift, tip_alteration=g%tip_alteration, &
          pitch=g%pitch, base_pitch=g%base_pitch, reference_radius=g%reference_radius, base_radius=g%base_radius, &
          tip_radius=g%tip_radius, root_radius=g%root_radius, form_radius=g%form_radius, bore_radius=g%bore_radius, &
          tooth_depth=g%tooth_depth, thickness=g%thickness, thickness_allowance=g%thickness_allowance, &
          tip_thickness=g%tip_thickness, tooth_angle=g%tooth_angle, is_undercut=logical(g%is_undercut, c_bool))
   end function gear_to_c

   pure type(gear_t) function gear_of_c(c) result(g)
      type(c_gear_geometry), intent(in) :: c

      g = gear_t( &
          teeth=c%teeth, normal_module=c%normal_module, pressure_angle=c%pressure_angle, profile_shift=c%profile_shift, &
          generating_shift=c%generating_shift, undercut_shift=c%undercut_shift, tip_alteration=c%tip_alteration, &
          pitch=c%pitch, base_pitch=c%base_pitch, reference_radius=c%reference_radius, base_radius=c%base_radius, &
          tip_radius=c%tip_radius, root_radius=c%root_radius, form_radius=c%form_radius, bore_radius=c%bore_radius, &
          tooth_depth=c%tooth_depth, thickness=c%thickness, thickness_allowance=c%thickness_allowance, &
          tip_thickness=c%tip_thickness, tooth_angle=c%tooth_angle, is_undercut=logical(c%is_undercut))
   end function gear_of_c

   pure type(c_gear_mesh) function mesh_to_c(m) result(c)
      type(gear_mesh_t), intent(in) :: m

      c = c_gear_mesh( &
          centre_distance=m%centre_distance, reference_distance=m%reference_distance, tight_distance=m%tight_distance, &
          working_pressure_angle=m%working_pressure_angle, pitch_radius_a=m%pitch_radius_a, pitch_radius_b=m%pitch_radius_b, &
          line_of_action=m%line_of_action, base_pitch=m%base_pitch, path_of_contact=m%path_of_contact, approach=m%approach, &
          recess=m%recess, contact_ratio=m%contact_ratio, rho_tip_a=m%rho_tip_a, rho_tip_b=m%rho_tip_b, &
          active_radius_a=m%active_radius_a, active_radius_b=m%active_radius_b, clearance_a=m%clearance_a, &
          clearance_b=m%clearance_b, backlash=m%backlash, circumferential_backlash=m%circumferential_backlash, &
          radial_backlash=m%radial_backlash)
   end function mesh_to_c

end module evl_capi_gears
