!> Inspection dimensions, tolerances and dynamic factors for the tests: C calls that the kernel does not export.
module measure_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use evl_dynamic_factor, only: dynamic_factor, mesh_stiffness_factor, reduced_mass, resonance_speed
   use evl_flank_tolerances, only: flank_tolerances_of, flank_tolerances_t
   use evl_gear, only: gear_t
   use evl_tooth_measures, only: ball_diameter, ball_measure, span_measure, span_teeth
   implicit none (type, external)
   private

   public :: test_ball_diameter, test_ball_measure, test_dynamic_factor, test_flank_tolerances, test_resonance, &
             test_span_measure, test_span_teeth

contains

   integer(c_int) function test_span_teeth(gear) bind(c)
      type(gear_t), intent(in) :: gear

      test_span_teeth = span_teeth(gear)
   end function test_span_teeth

   !> W_k [m], and its validity.
   integer(c_int) function test_span_measure(gear, k, length) result(validity) bind(c)
      type(gear_t), intent(in) :: gear
      integer(c_int), intent(in), value :: k
      real(c_double), intent(out) :: length

      call span_measure(gear, int(k), length, validity)
   end function test_span_measure

   real(c_double) function test_ball_diameter(gear) bind(c)
      type(gear_t), intent(in) :: gear

      test_ball_diameter = ball_diameter(gear)
   end function test_ball_diameter

   !> M_dK [m], and its validity.
   integer(c_int) function test_ball_measure(gear, diameter, dimension) result(validity) bind(c)
      type(gear_t), intent(in) :: gear
      real(c_double), intent(in), value :: diameter
      real(c_double), intent(out) :: dimension

      call ball_measure(gear, diameter, dimension, validity)
   end function test_ball_measure

   !> f_pT, F_pT, f_HaT, f_faT, F_aT, f_HbT, f_fbT, F_bT [m].
   subroutine test_flank_tolerances(teeth, module, width, class, tolerances) bind(c)
      integer(c_int), intent(in), value :: teeth, class
      real(c_double), intent(in), value :: module, width
      real(c_double), intent(out) :: tolerances(8)
      type(flank_tolerances_t) :: t

      t = flank_tolerances_of(int(teeth), module, width, int(class))
      tolerances = [t%single_pitch, t%total_pitch, t%profile_slope, t%profile_form, t%total_profile, t%helix_slope, &
                    t%helix_form, t%total_helix]
   end subroutine test_flank_tolerances

   !> Resonance speed of wheel 1 [rad/s] from the single stiffness per width of two wheels of this width.
   real(c_double) function test_resonance(single, contact_ratio, width, inertia, base_radius, teeth) result(speed) bind(c)
      real(c_double), intent(in), value :: single, contact_ratio, width
      real(c_double), intent(in) :: inertia(2), base_radius(2)
      integer(c_int), intent(in), value :: teeth

      speed = resonance_speed(single*mesh_stiffness_factor(contact_ratio)*width, reduced_mass(inertia, base_radius), int(teeth))
   end function test_resonance

   real(c_double) function test_dynamic_factor(speed, load, contact_ratio, b_p, b_f, b_k) result(factor) bind(c)
      real(c_double), intent(in), value :: speed, load, contact_ratio, b_p, b_f, b_k

      factor = dynamic_factor(speed, load, contact_ratio, b_p, b_f, b_k)
   end function test_dynamic_factor

end module measure_calls
