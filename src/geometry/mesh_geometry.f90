!> Geometry of one pair of meshing spur wheels, from teeth, one pitch radius and the pressure angle.
!>
!> Wheel A drives wheel B. c = O_B - O_A has the direction chi; sigma = +1 if A turns clockwise (or B drives with the
!> other flank), -1 for the mirror image. With e along the line of action and t across it:
!>
!>    t = T(chi) (cos alpha_w, sigma sin alpha_w)   e = T(chi) (sin alpha_w, -sigma cos alpha_w)
!>    K_A = O_A + r_bA t   K_B = O_B - r_bB t   K_B - K_A = rho e
!>
!> With an internal gear the radii, radii of curvature and the line of action of its side have a negative sign, and so has the
!> centre distance: chi then points from O_B to O_A, and sigma = +1 if an internal driving wheel turns counterclockwise.
!>
!> The path of contact a-b is one base pitch long, centred on K_A K_B: the contact ratio is exactly 1.
!>
!> Source: I. Kosenko, I. Gusev, Implementation of the spur involute gear model on Modelica, 2011, section 7.1.
module evl_mesh_geometry
   use evl_kinds, only: pi, wp
   use evl_status, only: clear, code_invalid_input, degrees, fail, status_t
   implicit none (type, external)
   private

   public :: spur_pair_derive, spur_pair_least_radius, spur_pair_locate, spur_pair_t

   real(wp), parameter :: paper_factor = 1.05_wp !! alpha_w/alpha_inf of the paper

   !> Geometry derived from teeth, pitch radius, pressure angle and position of the pair. Points in the housing frame.
   type :: spur_pair_t
      integer :: teeth_a = 0, teeth_b = 0      !! z
      integer :: sigma = 1                     !! flank, see above
      real(wp) :: ratio = 0.0_wp               !! n = z_B/z_A
      real(wp) :: pitch_radius_a = 0.0_wp      !! r_A [m]
      real(wp) :: pitch_radius_b = 0.0_wp      !! r_B = n r_A [m]
      real(wp) :: centre_distance = 0.0_wp     !! L = r_A + r_B [m]
      real(wp) :: chi = 0.0_wp                 !! direction of the centre line [rad]
      real(wp) :: gamma_a = 0.0_wp             !! angular pitch 2 pi/z_A [rad]
      real(wp) :: alpha_inf = 0.0_wp           !! pressure angle at which K_A K_B is one base pitch long [rad]
      real(wp) :: alpha_w = 0.0_wp             !! working pressure angle [rad]
      real(wp) :: base_radius_a = 0.0_wp       !! r_bA = r_A cos alpha_w [m]
      real(wp) :: base_radius_b = 0.0_wp       !! r_bB [m]
      real(wp) :: base_radius_sum = 0.0_wp     !! R = r_bA + r_bB [m]
      real(wp) :: rho = 0.0_wp                 !! |K_A K_B|, length of the line of action [m]
      real(wp) :: base_pitch = 0.0_wp          !! |ab| = r_bA gamma_A = r_bB gamma_B [m]
      real(wp) :: tip_radius_a = 0.0_wp        !! |b - O_A| [m]
      real(wp) :: tip_radius_b = 0.0_wp        !! |a - O_B| [m]
      real(wp) :: rho_start_a = 0.0_wp         !! radius of curvature of A at a, (rho - |ab|)/2 [m]
      real(wp) :: rho_start_b = 0.0_wp         !! radius of curvature of B at a, (rho + |ab|)/2 [m]
      real(wp) :: centre_a(2) = 0.0_wp         !! O_A [m]
      real(wp) :: centre_b(2) = 0.0_wp         !! O_B [m]
      real(wp) :: t(2) = 0.0_wp                !! unit vector across the line of action, from O_A to K_A
      real(wp) :: e(2) = 0.0_wp                !! unit vector along it, from K_A to K_B: A pushes B along e
      real(wp) :: point_k_a(2) = 0.0_wp        !! K_A, where the line of action touches A's base circle [m]
      real(wp) :: point_k_b(2) = 0.0_wp        !! K_B [m]
      real(wp) :: point_a(2) = 0.0_wp          !! start of contact [m]
      real(wp) :: point_b(2) = 0.0_wp          !! end of contact [m]
      real(wp) :: pitch_point(2) = 0.0_wp      !! where the pitch circles touch [m]
      logical :: contains_pitch_point = .false. !! whether a-b does
      logical :: handover = .true.             !! contact ratio exactly 1: a pair hands its load to the next after one pitch
      real(wp) :: contact_ratio = 1.0_wp       !! path of contact over base pitch
      real(wp) :: rho_tip_a = 0.0_wp           !! that of A at the end of the path: its tip, or undercut of B [m]
      real(wp) :: rho_tip_b = 0.0_wp           !! that of B at its start: its tip, or undercut of A [m]
      logical :: has_coast = .false.           !! whether the coast flanks can touch
      real(wp) :: backlash = 0.0_wp            !! normal backlash j_bn at the reference centre distance [m]
      real(wp) :: tooth_angle_a = 0.0_wp       !! tooth angle of A on the base circle [rad]; 0 if unknown
      real(wp) :: tooth_angle_b = 0.0_wp       !! the same of B [rad]
   end type spur_pair_t

contains

   !> Derive the geometry of a pair. Equation T4.
   !>
   !> Source: Kosenko & Gusev 2011, section 7.1, for any direction of the centre line and either flank.
   !> Errors: code_invalid_input with field pressure_angle. Other arguments must be in the ranges of their rows.
   pure subroutine spur_pair_derive(teeth_a, teeth_b, pitch_radius_a, paper_rule, alpha_w, chi, sigma, centre_a, pair, status)
      integer, intent(in) :: teeth_a         !! z_A
      integer, intent(in) :: teeth_b         !! z_B, the same
      real(wp), intent(in) :: pitch_radius_a !! operating pitch radius of A [m], > 0
      logical, intent(in) :: paper_rule      !! alpha_w = 1.05 alpha_inf; the given alpha_w is ignored
      real(wp), intent(in) :: alpha_w        !! working pressure angle [rad], alpha_inf < alpha_w < pi/2
      real(wp), intent(in) :: chi            !! direction from O_A to O_B [rad]
      integer, intent(in) :: sigma           !! +1 or -1
      real(wp), intent(in) :: centre_a(2)    !! O_A in the housing frame [m]
      type(spur_pair_t), intent(out) :: pair !! initial values on error
      type(status_t), intent(inout) :: status !! filled on error, else cleared
      real(wp) :: alpha_inf, angle

      call clear(status)
      alpha_inf = atan(2.0_wp*pi/(real(teeth_a, wp) + real(teeth_b, wp)))
      angle = alpha_w
      if (paper_rule) angle = paper_factor*alpha_inf
      if (.not. (angle > alpha_inf .and. angle < 0.5_wp*pi)) then
         call fail(status, code_invalid_input, "working pressure angle alpha_w = "//degrees(angle) &
                   //" must be greater than alpha_inf = "//degrees(alpha_inf)//", tan(alpha_inf) = 2 pi/(z_A + z_B)," &
                   //" and less than 90 deg", field="pressure_angle")
         return
      end if

      pair%teeth_a = teeth_a
      pair%teeth_b = teeth_b
      pair%sigma = sigma
      pair%chi = chi
      pair%pitch_radius_a = pitch_radius_a
      pair%alpha_inf = alpha_inf
      pair%alpha_w = angle
      pair%centre_a = centre_a
      call derive_lengths(pair)
      call spur_pair_locate(pair)
   end subroutine spur_pair_derive

   !> Lengths and angles that do not depend on the position of the pair. Equations T1, T2, T3, T81.
   pure subroutine derive_lengths(pair)
      type(spur_pair_t), intent(inout) :: pair !! in: teeth, pitch_radius_a and alpha_w

      pair%ratio = real(pair%teeth_b, wp)/real(pair%teeth_a, wp)
      pair%pitch_radius_b = pair%ratio*pair%pitch_radius_a
      pair%centre_distance = pair%pitch_radius_a + pair%pitch_radius_b
      pair%gamma_a = 2.0_wp*pi/real(pair%teeth_a, wp)
      pair%base_radius_a = pair%pitch_radius_a*cos(pair%alpha_w)
      pair%base_radius_b = pair%pitch_radius_b*cos(pair%alpha_w)
      pair%base_radius_sum = pair%base_radius_a + pair%base_radius_b
      pair%rho = pair%centre_distance*sin(pair%alpha_w)
      pair%base_pitch = pair%base_radius_a*pair%gamma_a
      pair%rho_start_a = 0.5_wp*(pair%rho - pair%base_pitch)
      pair%rho_start_b = 0.5_wp*(pair%rho + pair%base_pitch)
      pair%rho_tip_a = pair%rho_start_b
      pair%rho_tip_b = pair%rho_start_b
      ! at b the radii of curvature are those at a, exchanged
      pair%tip_radius_a = hypot(pair%base_radius_a, pair%rho_start_b)
      pair%tip_radius_b = hypot(pair%base_radius_b, pair%rho_start_b)
      associate (rho_pitch => pair%pitch_radius_a*sin(pair%alpha_w))
         pair%contains_pitch_point = rho_pitch >= pair%rho_start_a .and. rho_pitch <= pair%rho_start_b
      end associate
   end subroutine derive_lengths

   !> Points and directions in the housing frame, from the lengths. Equations T5, T6.
   pure subroutine spur_pair_locate(pair)
      type(spur_pair_t), intent(inout) :: pair !! in: all lengths, chi, sigma and centre_a

      associate (direction => pair%chi + pair%sigma*pair%alpha_w)
         pair%t = [cos(direction), sin(direction)]
         pair%e = pair%sigma*[sin(direction), -cos(direction)]
      end associate
      associate (centre_line => [cos(pair%chi), sin(pair%chi)])
         pair%centre_b = pair%centre_a + pair%centre_distance*centre_line
         pair%pitch_point = pair%centre_a + pair%pitch_radius_a*centre_line
      end associate
      pair%point_k_a = pair%centre_a + pair%base_radius_a*pair%t
      pair%point_k_b = pair%centre_b - pair%base_radius_b*pair%t
      pair%point_a = pair%point_k_a + pair%rho_start_a*pair%e
      pair%point_b = pair%point_k_a + pair%rho_tip_a*pair%e
   end subroutine spur_pair_locate

   !> Smallest radius of curvature of either flank on the path of contact, as a magnitude [m]: that of an external gear A at its
   !> start, or B at its end; of an internal gear at its tip.
   pure real(wp) function spur_pair_least_radius(pair) result(least)
      type(spur_pair_t), intent(in) :: pair

      least = min(abs(pair%rho_start_a), abs(pair%rho - pair%rho_tip_a))
      if (pair%base_radius_a < 0) least = min(abs(pair%rho_tip_a), least)
      if (pair%base_radius_b < 0) least = min(abs(pair%rho_tip_b), least)
   end function spur_pair_least_radius

end module evl_mesh_geometry
