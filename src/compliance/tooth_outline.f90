!> The outline of half a tooth that a rack cuts: arc of the tip, its rounding, involute, fillet, arc of the root, in modules.
!>
!> The tooth stands on the x axis, the wheel's centre is the origin; the half with y > 0 is described, and its flank is the loaded
!> one. A point of the involute with the radius of curvature rho is r_b (cos t, sin t) + rho (-sin t, cos t), t = psi/2 - rho/r_b;
!> its arc from the base circle is s = rho^2/(2 r_b). The fillet is cut by the round tip of the rack: where its normal makes the
!> angle beta with the line of centres, it lies D = depth/cos beta + rounding from the pitch point along that normal, while the
!> wheel has turned by depth tan beta/r. It begins at beta = pi/2 - alpha, with the involute, and ends at 0 on the root circle.
!>
!> Source: ISO 21771; ISO 53; the law of gearing.
module evl_tooth_outline
   use evl_gear, only: gear_radius_of_curvature, gear_t, gear_tip_angle, gear_tip_curvature
   use evl_kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: fillet_point, involute_arc, involute_curvature, involute_normal, involute_point, outline_of_gear, rounding_point, &
             tooth_outline_t

   real(wp), parameter :: no_arc = 1.0e-3_wp !! a root arc shorter than this, in modules, is none

   !> Half a tooth and half a space, in modules.
   type :: tooth_outline_t
      integer :: teeth = 0                     !! z
      real(wp) :: pressure_angle = 0           !! of the rack [rad]
      real(wp) :: half_pitch = 0               !! pi/z [rad]
      real(wp) :: half_tooth = 0               !! psi/2, half the angle that a tooth fills on the base circle [rad]
      real(wp) :: reference_radius = 0, base_radius = 0, tip_radius = 0, root_radius = 0
      real(wp) :: tip_angle = 0                !! half the angle of the tip's arc [rad]
      real(wp) :: tip_rounding = 0             !! radius of the arc between the tip's and the involute; 0: a sharp edge
      real(wp) :: root_angle = 0               !! where the fillet meets the root circle [rad]
      real(wp) :: rho_form = 0, rho_tip = 0    !! radii of curvature at both ends of the involute
      real(wp) :: s_form = 0, s_tip = 0        !! its arcs from the base circle
      real(wp) :: depth = 0                    !! of the centre of the rack's round tip below its rolling line
      real(wp) :: rounding = 0                 !! radius of the rack's tip
      real(wp) :: fillet_start = 0             !! beta at the involute [rad]
      logical :: has_root_arc = .true.         !! false: two fillets meet
   end type tooth_outline_t

contains

   !> Outline of a gear.   Valid: no undercut
   pure type(tooth_outline_t) function outline_of_gear(gear, rounding) result(o)
      type(gear_t), intent(in) :: gear
      real(wp), intent(in) :: rounding !! radius of the rack's tip, in modules

      associate (m => gear%normal_module)
         o%teeth = gear%teeth
         o%pressure_angle = gear%pressure_angle
         o%half_pitch = pi/gear%teeth
         o%half_tooth = gear%tooth_angle/2
         o%reference_radius = gear%reference_radius/m
         o%base_radius = gear%base_radius/m
         o%tip_radius = gear%tip_radius/m
         o%root_radius = gear%root_radius/m
         o%tip_angle = gear%tip_thickness/(2*gear%tip_radius)
         o%tip_rounding = gear%tip_rounding/m
         if (gear%tip_rounding > 0) o%tip_angle = gear_tip_angle(gear)
         o%rho_form = gear_radius_of_curvature(gear, gear%form_radius)/m
         o%rho_tip = gear_tip_curvature(gear)/m
      end associate
      o%s_form = involute_arc(o, o%rho_form)
      o%s_tip = involute_arc(o, o%rho_tip)
      o%rounding = rounding
      o%depth = o%reference_radius - o%root_radius - rounding
      o%fillet_start = pi/2 - o%pressure_angle
      o%root_angle = o%half_tooth + o%pressure_angle - o%rho_form/o%base_radius &
                     - o%depth/(tan(o%pressure_angle)*o%reference_radius)
      o%has_root_arc = (o%half_pitch - o%root_angle)*o%root_radius > no_arc
   end function outline_of_gear

   !> Arc of the involute from the base circle to a radius of curvature.
   elemental real(wp) function involute_arc(outline, rho) result(s)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: rho

      s = rho**2/(2*outline%base_radius)
   end function involute_arc

   !> Radius of curvature of the involute at an arc from the base circle.
   elemental real(wp) function involute_curvature(outline, s) result(rho)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: s

      rho = sqrt(2*outline%base_radius*s)
   end function involute_curvature

   !> A point of the involute.
   pure function involute_point(outline, rho) result(point)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: rho
      real(wp) :: point(2)

      associate (t => outline%half_tooth - rho/outline%base_radius)
         point = outline%base_radius*[cos(t), sin(t)] + rho*[-sin(t), cos(t)]
      end associate
   end function involute_point

   !> The involute's normal into the tooth.
   pure function involute_normal(outline, rho) result(normal)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: rho
      real(wp) :: normal(2)

      associate (t => outline%half_tooth - rho/outline%base_radius)
         normal = [sin(t), -cos(t)]
      end associate
   end function involute_normal

   !> A point of the tip's rounding, or inward of it.
   pure function rounding_point(outline, part, inward) result(point)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: part !! 0: on the tip circle; 1: on the involute
      real(wp), intent(in), optional :: inward
      real(wp) :: point(2), radius

      radius = outline%tip_rounding
      if (present(inward)) radius = radius - inward

      associate (o => outline)
         associate (to_involute => o%half_tooth - o%rho_tip/o%base_radius + pi/2)
            associate (angle => o%tip_angle + part*(to_involute - o%tip_angle))
               point = (o%tip_radius - o%tip_rounding)*[cos(o%tip_angle), sin(o%tip_angle)] &
                       + radius*[cos(angle), sin(angle)]
            end associate
         end associate
      end associate
   end function rounding_point

   !> A point of the fillet. Where there is no root arc, it ends in the middle of the space exactly.
   pure function fillet_point(outline, beta) result(point)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: beta !! 0: on the root circle; outline%fillet_start: on the involute [rad]
      real(wp) :: point(2), along, height, distance, angle

      distance = outline%depth/cos(beta) + outline%rounding
      along = distance*sin(beta)
      height = outline%reference_radius - distance*cos(beta)
      angle = outline%root_angle - atan2(along, height) + outline%depth*tan(beta)/outline%reference_radius
      if (.not. outline%has_root_arc) &
         angle = angle + (outline%half_pitch - outline%root_angle)*(1 - beta/outline%fillet_start)
      point = hypot(along, height)*[cos(angle), sin(angle)]
   end function fillet_point

end module evl_tooth_outline
