!> Measures of the tooth thickness: base tangent length over k teeth, of an internal gear over k spaces; dimension over two balls,
!> of an internal gear between them (negative, as its diameters).
!>
!> The base tangent length is the distance of two parallel planes that touch opposite flanks, a line tangent to the base circle.
!> With the base pitch p_b and the arc r_b psi of a tooth on the base circle
!>
!>    W_k = (k - 1) p_b + r_b psi     of an internal gear, over k spaces: k p_b - r_b psi
!>
!> A ball of the diameter D_M in a space touches both flanks; its centre lies on an involute D_M/2 outside each, at
!>
!>    inv alpha_K = D_M/d_b - eta    eta = pi/z - psi/2, half of the angle of the space on the base circle
!>
!> and the ball touches at the radius of curvature r_b tan alpha_K - D_M/2.
!>
!> Source: ISO 21771:2007, base tangent length and dimension over balls.
module evl_tooth_measures
   use evl_gear, only: gear_radius_of_curvature, gear_t, signed_teeth
   use evl_involute_angle, only: tangent_of_involute
   use evl_kinds, only: nan, pi, wp
   implicit none (type, external)
   private

   public :: ball_diameter, ball_measure, span_measure, span_teeth
   public :: measure_above, measure_below, measure_in_root, measure_in_space, measure_valid

   integer, parameter :: measure_valid = 0
   integer, parameter :: measure_below = 1    !! touches below the form circle, where there is no involute
   integer, parameter :: measure_above = 2    !! touches above the tip form circle
   integer, parameter :: measure_in_space = 3 !! a ball that does not project beyond the tip circle
   integer, parameter :: measure_in_root = 4  !! a ball that touches the root circle

   real(wp), parameter :: ball_step = 0.05_wp    !! default ball diameters are multiples of this, in modules
   real(wp), parameter :: rounding = 1.0e-9_wp   !! relative: a diameter this close to a multiple is that multiple

contains

   !> Number of teeth for a base tangent length that touches the flanks near the circle d + 2 x m. Equation DS1.
   pure integer function span_teeth(gear) result(k)
      type(gear_t), intent(in) :: gear

      if (gear%is_internal) then
         k = max(1, nint((gear%base_radius*gear%tooth_angle - 2*middle_curvature(gear))/gear%base_pitch))
      else
         k = max(1, nint((2*middle_curvature(gear) - gear%base_radius*gear%tooth_angle)/gear%base_pitch + 1))
      end if
   end function span_teeth

   !> Base tangent length over k teeth [m]; NaN if it does not touch the involutes. Equation DS2.
   pure subroutine span_measure(gear, k, length, validity)
      type(gear_t), intent(in) :: gear
      integer, intent(in) :: k          !! > 0
      real(wp), intent(out) :: length   !! W_k [m]
      integer, intent(out) :: validity  !! measure_valid, measure_below or measure_above

      if (gear%is_internal) then
         length = k*gear%base_pitch - gear%base_radius*gear%tooth_angle
      else
         length = (k - 1)*gear%base_pitch + gear%base_radius*gear%tooth_angle
      end if
      validity = on_involute(gear, sign(length/2, gear%base_radius))
      if (validity /= measure_valid) length = nan
   end subroutine span_measure

   !> Ball that touches the flanks on the circle d + 2 x m, rounded up to a multiple of 0.05 modules [m]. Equation DS3.
   pure real(wp) function ball_diameter(gear) result(diameter)
      type(gear_t), intent(in) :: gear
      real(wp) :: tangent, steps

      tangent = middle_curvature(gear)/gear%base_radius
      steps = 2*gear%base_radius*(tan(tangent + half_space(gear)) - tangent)/(ball_step*gear%normal_module)
      diameter = ceiling(steps*(1 - rounding))*ball_step*gear%normal_module
   end function ball_diameter

   !> Dimension over two balls [m]; NaN if they do not measure the involutes. Equations DS4, DS5.
   pure subroutine ball_measure(gear, diameter, dimension, validity)
      type(gear_t), intent(in) :: gear
      real(wp), intent(in) :: diameter   !! D_M [m], > 0
      real(wp), intent(out) :: dimension !! M_dK [m]
      integer, intent(out) :: validity   !! one of the above
      real(wp) :: involute, tangent, radius

      dimension = nan
      validity = measure_below
      involute = diameter/(2*gear%base_radius) - half_space(gear)
      if (.not. involute > 0) return
      tangent = tangent_of_involute(involute)
      validity = on_involute(gear, gear%base_radius*tangent - diameter/2)
      if (validity /= measure_valid) return
      radius = gear%base_radius*hypot(1.0_wp, tangent)
      if (radius + diameter/2 <= gear%tip_radius) validity = measure_in_space
      if (radius - diameter/2 <= gear%root_radius) validity = measure_in_root
      if (validity /= measure_valid) return
      dimension = 2*radius + diameter
      ! opposite spaces of an odd number of teeth are half a pitch off the diameter
      if (mod(gear%teeth, 2) /= 0) dimension = 2*radius*cos(pi/(2*gear%teeth)) + diameter
   end subroutine ball_measure

   !> Half of the angle of a space on the base circle, eta [rad]. Equation DS4.
   pure real(wp) function half_space(gear)
      type(gear_t), intent(in) :: gear

      half_space = pi/signed_teeth(gear) - gear%tooth_angle/2
   end function half_space

   !> Radius of curvature on the circle d + 2 x m, or at the nearer end of the involute [m].
   pure real(wp) function middle_curvature(gear) result(rho)
      type(gear_t), intent(in) :: gear

      rho = gear_radius_of_curvature(gear, min(max(gear%reference_radius + gear%profile_shift*gear%normal_module, &
                                                   gear%form_radius), gear%tip_form_radius))
   end function middle_curvature

   !> Whether a radius of curvature belongs to the involute.
   pure integer function on_involute(gear, rho) result(validity)
      type(gear_t), intent(in) :: gear
      real(wp), intent(in) :: rho !! [m]

      validity = measure_valid
      if (rho < gear_radius_of_curvature(gear, gear%form_radius)) validity = measure_below
      if (rho > gear_radius_of_curvature(gear, gear%tip_form_radius)) validity = measure_above
   end function on_involute

end module evl_tooth_measures
