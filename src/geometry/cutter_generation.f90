!> Root of an internal gear cut by a pinion-type cutter: root circle, form circle and the fillet between them.
!>
!> The cutter, index 0, has z_0 teeth and rolls in the gear, z < 0, like a pinion in a tight mesh. q is the radius of its tip
!> rounding, r_M = r_a0 - q the radius of the centre M of this rounding, and rho_M = sqrt(r_M^2 - r_b0^2):
!>
!>    inv alpha_0 = inv alpha + 2 tan alpha (x_0 + x_E)/(z_0 + z)    R_0 = m (z_0 + z)/2 cos alpha    a_0 = R_0/cos alpha_0 < 0
!>    r_f = a_0 - r_a0    rho_Ff = R_0 tan alpha_0 - q - rho_M    r_w0 = a_0 z_0/(z_0 + z) > 0    r_w = a_0 z/(z_0 + z) < 0
!>    delta_M = psi_b0/2 - (q + rho_M)/r_b0 + atan(rho_M/r_b0)    theta_F = atan(rho_M/r_b0) - alpha_0
!>
!> delta_M is the angle of M from the middle of the cutter's tooth. While M is at the angle theta from the centre line, the normal
!> of the envelope of the rounding passes through the pitch point. In the frame of the gear, with the real axis from its centre
!> through the middle of the space,
!>
!>    zeta(theta) = exp(i (z_0/z)(theta - delta_M)) [-r_w + (1 + q/L) v]    v = r_M exp(i theta) - r_w0    L = |v|
!>
!> from theta = 0 on the root circle to theta_F on the form circle. The root circle is left between |arg| <= (z_0/|z|) delta_M.
!>
!> Source: derived here from the law of gearing; ISO 21771:2007 for a gear cut by a pinion-type cutter.
module evl_cutter_generation
   use evl_involute_angle, only: involute_of_tangent, tangent_of_involute
   use evl_kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: cutter_fillet, cutter_fit, cutter_fit_t, cutter_t

   !> A pinion-type cutter.
   type :: cutter_t
      integer :: teeth = 0               !! z_0
      real(wp) :: shift = 0.0_wp         !! x_0
      real(wp) :: tip_radius = 0.0_wp    !! r_a0 [m]
      real(wp) :: rounding = 0.0_wp      !! q [m]
   end type cutter_t

   !> The cutter in the gear. Lengths of the gear are negative.
   type :: cutter_fit_t
      real(wp) :: involute = 0.0_wp      !! inv alpha_0 [rad]; the rest is defined if it is positive
      real(wp) :: tangent = 0.0_wp       !! tan alpha_0
      real(wp) :: base_radius = 0.0_wp   !! r_b0 [m]
      real(wp) :: line = 0.0_wp          !! R_0 tan alpha_0 [m]
      real(wp) :: distance = 0.0_wp      !! a_0 [m]
      real(wp) :: pitch_radius = 0.0_wp  !! r_w0 [m]
      real(wp) :: gear_pitch_radius = 0.0_wp !! r_w [m]
      real(wp) :: centre = 0.0_wp        !! r_M [m]
      real(wp) :: centre_curvature = 0.0_wp !! rho_M [m]; NaN if M lies inside the base circle
      real(wp) :: root_radius = 0.0_wp   !! r_f [m]
      real(wp) :: form_curvature = 0.0_wp !! rho_Ff [m]
      real(wp) :: delta = 0.0_wp         !! delta_M [rad]
      real(wp) :: last = 0.0_wp          !! theta_F [rad]
   end type cutter_fit_t

contains

   !> Fit a cutter into a gear with the module and pressure angle of both. Equations I10, I11.
   pure type(cutter_fit_t) function cutter_fit(cutter, teeth, module, alpha, generating_shift) result(fit)
      type(cutter_t), intent(in) :: cutter
      integer, intent(in) :: teeth             !! |z| > z_0
      real(wp), intent(in) :: module           !! m [m]
      real(wp), intent(in) :: alpha            !! pressure angle [rad]
      real(wp), intent(in) :: generating_shift !! x_E
      real(wp) :: r_0, tooth_angle
      integer :: z

      z = cutter%teeth - teeth ! z_0 + z < 0
      fit%involute = involute_of_tangent(tan(alpha)) + 2*tan(alpha)*(cutter%shift + generating_shift)/z
      if (.not. fit%involute > 0) return
      fit%tangent = tangent_of_involute(fit%involute)
      r_0 = module*z/2*cos(alpha)
      fit%distance = r_0*hypot(1.0_wp, fit%tangent)
      fit%line = r_0*fit%tangent
      fit%pitch_radius = fit%distance*cutter%teeth/z
      fit%gear_pitch_radius = -fit%distance*teeth/z
      fit%base_radius = module*cutter%teeth/2*cos(alpha)
      fit%root_radius = fit%distance - cutter%tip_radius
      fit%centre = cutter%tip_radius - cutter%rounding
      fit%centre_curvature = sqrt((fit%centre - fit%base_radius)*(fit%centre + fit%base_radius))
      fit%form_curvature = fit%line - cutter%rounding - fit%centre_curvature
      tooth_angle = module*(pi/2 + 2*cutter%shift*tan(alpha))/(module*cutter%teeth/2) + 2*involute_of_tangent(tan(alpha))
      fit%delta = tooth_angle/2 - (cutter%rounding + fit%centre_curvature)/fit%base_radius &
                  + atan(fit%centre_curvature/fit%base_radius)
      fit%last = atan(fit%centre_curvature/fit%base_radius) - atan(fit%tangent)
   end function cutter_fit

   !> Point of the fillet, from the middle of the space on the x axis [m]. Equation I12.
   pure function cutter_fillet(cutter, fit, teeth, share) result(point)
      type(cutter_t), intent(in) :: cutter
      type(cutter_fit_t), intent(in) :: fit
      integer, intent(in) :: teeth      !! |z|
      real(wp), intent(in) :: share     !! theta/theta_F: 0 on the root circle, 1 on the form circle
      real(wp) :: point(2)
      complex(wp) :: v, zeta
      real(wp) :: theta

      theta = share*fit%last
      v = fit%centre*cmplx(cos(theta), sin(theta), wp) - fit%pitch_radius
      zeta = -fit%gear_pitch_radius + (1 + cutter%rounding/abs(v))*v
      associate (turn => -(real(cutter%teeth, wp)/teeth)*(theta - fit%delta))
         zeta = zeta*cmplx(cos(turn), sin(turn), wp)
      end associate
      point = [real(zeta), aimag(zeta)]
   end function cutter_fillet

end module evl_cutter_generation
