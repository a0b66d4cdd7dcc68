!> Root of an internal gear: an arc tangent to the root circle and to the involute.
!>
!> No rack cuts an internal gear. With the positive radii |r_f| and |r_b| and the radius q of the arc, its centre lies at the radius
!> |r_f| - q, at rho_M = sqrt((|r_f| - q)^2 - r_b^2) on the involute's normal, so the involute ends at the radius of curvature
!>
!>    rho_Ff = -(q + rho_M)
!>
!> Half the angle of the root circle that is left between the two arcs of a space is
!>
!>    pi/|z| + psi/2 - (q + rho_M)/|r_b| + atan(rho_M/|r_b|)
!>
!> with the tooth angle psi of an internal gear, see evl_gear. It is 0 for the full round q_max.
!>
!> Source: derived here from the involute's normal, a tangent to the base circle; signs as in ISO 21771:2007.
module evl_ring_root
   use evl_kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: largest_fillet, ring_form_curvature, ring_root_arc

contains

   !> rho_Ff of the ring, < 0 [m]. Equation I3.   Valid: q <= largest_fillet
   elemental real(wp) function ring_form_curvature(base_radius, root_radius, arc) result(rho)
      real(wp), intent(in) :: base_radius, root_radius !! |r_b|, |r_f| [m], > 0
      real(wp), intent(in) :: arc                      !! q [m]

      rho = -(arc + centre_curvature(base_radius, root_radius, arc))
   end function ring_form_curvature

   !> Half the angle of the root circle between the arcs of a space [rad]. Equation I4.
   elemental real(wp) function ring_root_arc(teeth, base_radius, root_radius, tooth_angle, arc) result(angle)
      integer, intent(in) :: teeth                     !! |z|
      real(wp), intent(in) :: base_radius, root_radius !! |r_b|, |r_f| [m]
      real(wp), intent(in) :: tooth_angle              !! psi [rad]
      real(wp), intent(in) :: arc                      !! q [m]
      real(wp) :: rho

      rho = centre_curvature(base_radius, root_radius, arc)
      angle = pi/teeth + tooth_angle/2 - (arc + rho)/base_radius + atan(rho/base_radius)
   end function ring_root_arc

   !> q_max: the full round, by bisection to the last digit [m]; 0 or less if the space is closed at the root circle. Equation I4.
   pure real(wp) function largest_fillet(teeth, base_radius, root_radius, tooth_angle) result(largest)
      integer, intent(in) :: teeth                     !! |z|
      real(wp), intent(in) :: base_radius, root_radius !! |r_b| < |r_f| [m]
      real(wp), intent(in) :: tooth_angle              !! psi [rad]
      real(wp) :: high, middle

      largest = 0
      if (.not. ring_root_arc(teeth, base_radius, root_radius, tooth_angle, 0.0_wp) > 0) return
      high = root_radius - base_radius
      do
         middle = 0.5_wp*(largest + high)
         if (.not. (middle > largest .and. middle < high)) exit
         if (ring_root_arc(teeth, base_radius, root_radius, tooth_angle, middle) > 0) then
            largest = middle
         else
            high = middle
         end if
      end do
   end function largest_fillet

   !> rho_M [m].
   elemental real(wp) function centre_curvature(base_radius, root_radius, arc) result(rho)
      real(wp), intent(in) :: base_radius, root_radius, arc !! as above

      rho = sqrt(max((root_radius - arc - base_radius)*(root_radius - arc + base_radius), 0.0_wp))
   end function centre_curvature

end module evl_ring_root
