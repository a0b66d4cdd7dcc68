!> Interference of a pinion A with an internal gear (ring) B, in the order in which it is reported.
!>
!> With the signs of evl_gear, rho = T1T2 < 0 and a = a_w < 0, the active flank of the pinion begins at rho_NfA = rho - rho_FaB and
!> that of the ring at rho_NfB = rho - rho_FaA:
!>
!>    1 undercut of the pinion    rho_NfA < rho_FfA, a rack has undercut it
!>    2 involute                  rho_NfA < 0: the ring's tip passes the point where the line of action touches A's base circle
!>    3 fillet of the pinion      rho_NfA < rho_FfA
!>    4 root of the pinion        c_A = a - r_aB - r_fA <= 0
!>    5 fouling of the tips       beside the path of contact, (mu_A + inv alpha_aA - inv alpha_w) z_A/|z_B| + inv alpha_w
!>                                - inv alpha_aB - mu_B <= 0
!>                                cos mu_A = (r_aB^2 - a^2 - r_aA^2)/(2 |a| r_aA)
!>                                cos mu_B = (a^2 + r_aB^2 - r_aA^2)/(2 |a| |r_aB|)
!>    6 fillet of the ring        |rho_NfB| > |rho_FfB|, or its root: c_B = a - r_aA - r_fB <= 0
!>
!> The remedy of 1 to 5 is the smallest tip diameter of the ring that fits: twice the largest of
!>
!>    hypot(r_bB, |rho| + max(rho_FfA, 0) + r_t) - r_t    |a| + r_fA    the |r_aB| at which 5 is 0
!>
!> Sources: ISO 21771:2007; the conditions 2 and 5 as published for involute interference and trochoid (fouling) interference of
!> internal gears by KHK and others, written with signs and derived again here.
module evl_ring_interference
   use evl_cutter_generation, only: cutter_fit_t
   use evl_gear, only: agreement, gear_cutter_fit, gear_radius_of_curvature, gear_t, gear_tip_curvature
   use evl_involute_angle, only: involute_of_tangent
   use evl_kinds, only: wp
   use evl_status, only: code_invalid_input, fail, quantity, status_t, subject_mesh, subject_wheel
   implicit none (type, external)
   private

   public :: check_cutter, check_ring, trimming_angle

contains

   !> Check an internal pair. Equation I5.
   !> Errors: code_invalid_input with subject_mesh, without index and field
   pure subroutine check_ring(pinion, ring, line, distance, alpha_w, base_pitch, status)
      type(gear_t), intent(in) :: pinion, ring
      real(wp), intent(in) :: line       !! T1T2, < 0 [m]
      real(wp), intent(in) :: distance   !! a_w, < 0 [m]
      real(wp), intent(in) :: alpha_w    !! working pressure angle [rad]
      real(wp), intent(in) :: base_pitch !! [m]
      type(status_t), intent(inout) :: status
      real(wp) :: start, form, clearance, angle, end_on_ring, ring_form, largest

      start = line - gear_tip_curvature(ring)
      form = gear_radius_of_curvature(pinion, pinion%form_radius)
      clearance = distance - ring%tip_radius - pinion%root_radius
      angle = fouling_angle(pinion, ring, distance, alpha_w, -ring%tip_radius)
      if (start < form*(1 - agreement) .and. pinion%is_undercut) then
         call refuse("the pinion is undercut: its involute begins at the diameter "//quantity(2*pinion%form_radius, "m") &
                     //", and the tip of the internal gear, diameter "//quantity(-2*ring%tip_radius, "m")//", needs it" &
                     //" from "//quantity(2*at_curvature(start), "m")//" on", status)
      else if (start < -agreement*abs(line)) then
         call refuse("involute interference: the tip of the internal gear, diameter "//quantity(-2*ring%tip_radius, "m") &
                     //", reaches past the point where the line of action touches the base circle of its mate", status)
      else if (start < form*(1 - agreement)) then
         call refuse("fillet interference: the tip of the internal gear, diameter "//quantity(-2*ring%tip_radius, "m") &
                     //", meets its mate at the diameter "//quantity(2*at_curvature(start), "m")//", in the fillet below its" &
                     //" form diameter "//quantity(2*pinion%form_radius, "m"), status)
      else if (.not. clearance > 0) then
         call refuse("the tip of the internal gear, diameter "//quantity(-2*ring%tip_radius, "m")//", runs into the root circle" &
                     //" of its mate: the tip clearance would be "//quantity(clearance, "m"), status)
      else if (.not. angle > 0) then
         call refuse("the tips of the teeth foul each other beside the path of contact, by an angle of " &
                     //quantity(-angle, "rad"), status)
      else
         end_on_ring = line - gear_tip_curvature(pinion)
         ring_form = gear_radius_of_curvature(ring, ring%form_radius)
         clearance = distance - pinion%tip_radius - ring%root_radius
         if (-end_on_ring > -ring_form*(1 + agreement) .or. .not. clearance > 0) then
            largest = min(hypot(pinion%base_radius, line - ring_form - pinion%tip_rounding) + pinion%tip_rounding, &
                          distance - ring%root_radius)
            call fail(status, code_invalid_input, "the tip of the wheel inside, diameter "//quantity(2*pinion%tip_radius, "m") &
                      //", runs into "//trim(merge("the root circle", "the fillet     ",.not. clearance > 0)) &
                      //" of the internal gear, whose involute ends at the diameter "//quantity(-2*ring%form_radius, "m") &
                      //" and whose root diameter is "//quantity(-2*ring%root_radius, "m")//"; a tip diameter of the wheel inside" &
                      //" below "//quantity(2*largest, "m")//", or a smaller rack.root_radius of the internal gear, avoids it", &
                      subject_mesh)
         end if
      end if

   contains

      !> Radius of the pinion at a radius of curvature [m].
      pure real(wp) function at_curvature(rho)
         real(wp), intent(in) :: rho

         at_curvature = hypot(pinion%base_radius, max(rho, 0.0_wp))
      end function at_curvature

      !> Report, with the tip diameter that fits and what it gives, if it leaves a pair in contact.
      pure subroutine refuse(message, status)
         character(len=*), intent(in) :: message
         type(status_t), intent(inout) :: status
         real(wp) :: tip, ratio, addendum, digit

         tip = 2*smallest_ring_tip(pinion, ring, line, distance, alpha_w)
         digit = 10.0_wp**(floor(log10(tip)) - 5) ! last of six digits, as in messages
         tip = ceiling(tip/digit)*digit
         associate (r_t => ring%tip_rounding)
            ratio = (gear_tip_curvature(pinion) + r_t - sqrt((tip/2 + r_t)**2 - ring%base_radius**2) - line)/base_pitch
         end associate
         addendum = (-tip/2 - ring%reference_radius)/ring%normal_module - ring%profile_shift
         if (tip < -2*ring%root_radius .and. ratio >= 1) then
            call fail(status, code_invalid_input, message//"; the smallest tip diameter of the internal gear that fits is " &
                      //quantity(tip, "m")//": an addendum of "//quantity(addendum, "")//" modules, contact ratio " &
                      //quantity(ratio, ""), subject_mesh)
         else
            call fail(status, code_invalid_input, message//"; no tip diameter of the internal gear leaves a contact ratio of 1:" &
                      //" choose a larger profile shift or more teeth of its mate", subject_mesh)
         end if
      end subroutine refuse

   end subroutine check_ring

   !> Check that a pinion-type cutter does not cut the tips of its ring. Equations I5, I6.
   !> Errors: code_invalid_input with subject_wheel, without index
   pure subroutine check_cutter(ring, status)
      type(gear_t), intent(in) :: ring !! with a cutter
      type(status_t), intent(inout) :: status
      type(gear_t) :: cutter
      type(cutter_fit_t) :: fit
      real(wp) :: angle

      fit = gear_cutter_fit(ring)
      cutter%teeth = ring%cutter_teeth
      cutter%base_radius = fit%base_radius
      cutter%tip_radius = ring%cutter_tip_radius
      angle = fouling_angle(cutter, ring, fit%distance, atan(fit%tangent), real(-ring%tip_radius, wp))
      if (fit%line - gear_tip_curvature(ring) < 0) then
         call fail(status, code_invalid_input, "the cutter would cut the tips of this internal gear, diameter " &
                   //quantity(-2*ring%tip_radius, "m")//", which reach past its base circle; choose a cutter with more teeth or a" &
                   //" larger profile shift, or a larger tip diameter of the gear", subject_wheel, field="fillet.cutter.teeth")
      else if (.not. angle > 0) then
         call fail(status, code_invalid_input, "the cutter would cut the tips of this internal gear beside the path of" &
                   //" contact, by an angle of "//quantity(-angle, "rad")//"; choose a cutter with fewer teeth, or a larger" &
                   //" tip diameter of the gear", subject_wheel, field="fillet.cutter.teeth")
      end if
   end subroutine check_cutter

   !> Angle that is left for a radial feed of the pinion or cutter into the ring [rad]; negative: its tips trim those of the ring.
   !> Equation I13. Source: KHK, from memory, trimming of internal gears
   pure real(wp) function trimming_angle(pinion_teeth, pinion_tip, pinion_base, ring, alpha_w) result(angle)
      integer, intent(in) :: pinion_teeth
      real(wp), intent(in) :: pinion_tip, pinion_base !! r_aA, r_bA [m]
      type(gear_t), intent(in) :: ring
      real(wp), intent(in) :: alpha_w                 !! [rad]
      real(wp) :: ratio, cosines, involute

      angle = huge(angle)
      ratio = real(ring%teeth, wp)/pinion_teeth
      associate (tip => -real(ring%tip_radius, wp), base => -real(ring%base_radius, wp))
         cosines = (pinion_base/pinion_tip)/(base/tip)
         if (.not. cosines < 1) return
         involute = involute_of_tangent(tan(alpha_w))
         angle = asin(min(sqrt((1 - cosines**2)/(1 - 1/ratio**2)), 1.0_wp)) + involute_at(pinion_tip, pinion_base) - involute &
                 - ratio*(asin(min(sqrt((1/cosines**2 - 1)/(ratio**2 - 1)), 1.0_wp)) + involute_at(tip, base) - involute)
      end associate
   end function trimming_angle

   !> Angle by which the tips pass each other beside the path of contact [rad]; huge where the tip circles do not meet. Equation I6.
   pure real(wp) function fouling_angle(pinion, ring, distance, alpha_w, ring_tip) result(angle)
      type(gear_t), intent(in) :: pinion, ring
      real(wp), intent(in) :: distance !! a_w, < 0 [m]
      real(wp), intent(in) :: alpha_w  !! [rad]
      real(wp), intent(in) :: ring_tip !! |r_aB| [m]
      real(wp) :: cos_a, cos_b, involute

      angle = huge(angle)
      associate (a => abs(distance), tip => real(pinion%tip_radius, wp))
         cos_a = (ring_tip**2 - a**2 - tip**2)/(2*a*tip)
         cos_b = (a**2 + ring_tip**2 - tip**2)/(2*a*ring_tip)
         if (max(abs(cos_a), abs(cos_b)) > 1) return
         involute = involute_of_tangent(tan(alpha_w))
         angle = (acos(cos_a) + involute_at(tip, real(pinion%base_radius, wp)) - involute)*pinion%teeth/ring%teeth + involute &
                 - involute_at(ring_tip, -real(ring%base_radius, wp)) - acos(cos_b)
      end associate
   end function fouling_angle

   !> inv alpha_y at a radius [rad].
   pure real(wp) function involute_at(radius, base_radius)
      real(wp), intent(in) :: radius, base_radius !! > 0 [m]

      involute_at = involute_of_tangent(sqrt(max((radius - base_radius)*(radius + base_radius), 0.0_wp))/base_radius)
   end function involute_at

   !> Smallest tip radius of the ring, as a magnitude, that avoids interference 1 to 5 [m]. Equation I7.
   pure real(wp) function smallest_ring_tip(pinion, ring, line, distance, alpha_w) result(tip)
      type(gear_t), intent(in) :: pinion, ring
      real(wp), intent(in) :: line, distance, alpha_w !! as in `check_ring`
      real(wp) :: low, high, middle, form

      form = 0
      if (pinion%form_radius > pinion%base_radius) form = gear_radius_of_curvature(pinion, pinion%form_radius)
      associate (r_t => ring%tip_rounding)
         tip = hypot(ring%base_radius, abs(line) + form + r_t) - r_t
      end associate
      tip = max(tip, abs(distance) + pinion%root_radius)
      if (fouling_angle(pinion, ring, distance, alpha_w, tip) > 0) return
      ! the angle is 0 between here and where the tip circles touch
      low = tip
      high = abs(distance) + pinion%tip_radius
      do
         middle = 0.5_wp*(low + high)
         if (.not. (middle > low .and. middle < high)) exit
         if (fouling_angle(pinion, ring, distance, alpha_w, middle) > 0) then
            high = middle
         else
            low = middle
         end if
      end do
      tip = high
   end function smallest_ring_tip

end module evl_ring_interference
