!> Full geometry of a gearbox from its components, for `tests/kernel/gearbox.py` and `tests/kernel/gears.py`.
module evl_test_geometry_calls
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_f_pointer, c_int, c_ptr
   use evl_gear, only: gear_t
   use evl_gearbox, only: gearbox_t
   use evl_gears_in_mesh, only: gear_mesh_t
   use evl_kinds, only: pi
   implicit none (type, external)
   private

   public :: test_gear_of, test_mesh_geometry, test_mesh_of, test_wheel_geometry

   !> WheelGeometry
   type, bind(c) :: c_wheel_geometry
      real(c_double) :: pitch_radius, base_radius, tip_radius, angular_pitch, mass, inertia, centre(2), speed_ratio, nominal_speed
      logical(c_bool) :: is_reference
   end type c_wheel_geometry

   !> MeshGeometry
   type, bind(c) :: c_mesh_geometry
      integer(c_int) :: sigma
      real(c_double) :: transmission_ratio, centre_distance, centre_line_angle, minimum_pressure_angle, working_pressure_angle
      real(c_double) :: base_pitch, contact_ratio, line_of_action_length
      real(c_double), dimension(2) :: point_k_a, point_k_b, point_a, point_b, pitch_point
      real(c_double) :: tip_radius_driving, tip_radius_driven, rho_start_driving, rho_start_driven
      real(c_double) :: common_width, effective_modulus, elastic_share_driving, nominal_force, reference_force
      real(c_double) :: reference_penetration
      real(c_double) :: reference_stiffness, reference_mass, natural_frequency, damping_coefficient, damping_ratio
   end type c_mesh_geometry

contains

   subroutine test_wheel_geometry(handle, index, geometry) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: index
      type(c_wheel_geometry), intent(out) :: geometry
      type(gearbox_t), pointer :: g
      real(c_double) :: pitch

      call c_f_pointer(handle, g)
      associate (wheel => g%wheels(index + 1))
         pitch = 0
         if (wheel%teeth > 0) pitch = 2*pi/wheel%teeth
         geometry = c_wheel_geometry(wheel%pitch_radius, wheel%base_radius, wheel%tip_radius, pitch, wheel%mass, wheel%inertia, &
                                     wheel%centre, wheel%ratio, wheel%ratio*g%nominal%speed, &
                                     logical(index + 1 == g%reference, c_bool))
      end associate
   end subroutine test_wheel_geometry

   subroutine test_mesh_geometry(handle, index, geometry) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: index
      type(c_mesh_geometry), intent(out) :: geometry
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      associate (contact => g%contacts(g%first(index + 1)), pair => g%pairs(index + 1), at => g%references(index + 1))
         geometry = c_mesh_geometry( &
                    sigma=pair%sigma, transmission_ratio=pair%ratio, centre_distance=pair%centre_distance, &
                    centre_line_angle=pair%chi, minimum_pressure_angle=pair%alpha_inf, &
                    working_pressure_angle=pair%alpha_w, base_pitch=pair%base_pitch, &
                    contact_ratio=norm2(pair%point_b - pair%point_a)/pair%base_pitch, line_of_action_length=pair%rho, &
                    point_k_a=pair%point_k_a, point_k_b=pair%point_k_b, point_a=pair%point_a, point_b=pair%point_b, &
                    pitch_point=pair%pitch_point, tip_radius_driving=pair%tip_radius_a, &
                    tip_radius_driven=pair%tip_radius_b, rho_start_driving=pair%rho_start_a, &
                    rho_start_driven=pair%rho_start_b, common_width=contact%width, effective_modulus=contact%e_star, &
                    elastic_share_driving=contact%pair%share_a, nominal_force=g%nominal%force(index + 1), &
                    reference_force=contact%force_scale, &
                    reference_penetration=contact%h_scale, reference_stiffness=at%stiffness, reference_mass=at%mass, &
                    natural_frequency=at%frequency, damping_coefficient=at%damping, damping_ratio=at%ratio)
      end associate
   end subroutine test_mesh_geometry

   logical(c_bool) function test_gear_of(handle, wheel, geometry) result(is_gear) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel
      type(gear_t), intent(out) :: geometry
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      geometry = g%gears(wheel + 1)
      is_gear = geometry%teeth > 0
   end function test_gear_of

   logical(c_bool) function test_mesh_of(handle, mesh, geometry) result(is_mesh) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      type(gear_mesh_t), intent(out) :: geometry
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      geometry = g%gear_meshes(mesh + 1)
      is_mesh = geometry%exists
   end function test_mesh_of

end module evl_test_geometry_calls
