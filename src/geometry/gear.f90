!> Geometry of one real spur gear: ISO 21771, cut by the basic rack of ISO 53.
!>
!> Lengths are radii and arcs in the plane of rotation. The allowance of the tooth thickness is taken by the cutter going deeper,
!> so root and form circle belong to the generating profile shift x_E = x + A_s/(2 m tan alpha). With u = tan alpha_y =
!> rho/r_b at the radius r_y, the tooth thickness there is r_y (psi - 2 inv alpha_y), psi = s/r + 2 inv alpha being the angle that
!> the tooth fills on the base circle.
!>
!> A tip rounded by r_t touches the tip circle and the involute from inside: its centre lies at the radius r_a - r_t on the
!> involute's normal, so the involute ends at the radius of curvature
!>
!>    rho_Fa = r_t + sqrt((r_a - r_t)^2 - r_b^2)
!>
!> and half the angle that is left of the tip's arc is psi/2 - r_t/r_b - inv alpha_M, cos alpha_M = r_b/(r_a - r_t).
!>
!> Source: ISO 21771:2007, sections 4 and 5; ISO 53:1998, basic rack.
module evl_gear
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_int
   use evl_given, only: given_t
   use evl_involute_angle, only: involute_of_tangent
   use evl_kinds, only: pi, wp
   use evl_rack_generation, only: involute_start
   use evl_row, only: not_negative, positive, range_t, row_t, span_t, type_block, type_number
   use evl_status, only: clear, code_invalid_input, fail, has_failed, quantity, status_t, subject_wheel
   implicit none (type, external)
   private

   public :: gear_derive, gear_radius_of_curvature, gear_t, gear_thickness, gear_tip_angle, gear_tip_curvature
   public :: agreement, thin_tip

   real(wp), parameter :: agreement = 1.0e-9_wp   !! relative: two given lengths that differ less are the same
   real(wp), parameter :: thin_tip = 0.2_wp       !! tip thickness in modules: warn below

   ! what a case says of a wheel that is a real gear, and of its rack; lengths of the rack, x and k in modules
   type(row_t), parameter, public :: &
      gear_rows(*) = [ &
      row_t("module", type_number, "m", &
            "normal module m_n: makes the wheel a real gear, ISO 21771; otherwise its radii follow from pitch_radius", &
            range=positive, plausible=span_t(1.0e-5_wp, 0.1_wp)), &
      row_t("pressure_angle", type_number, "deg", "pressure angle alpha_n of the basic rack", range=range_t(5.0_wp, 45.0_wp), &
            default="20", variants="+module", plausible=span_t(10.0_wp, 35.0_wp)), &
      row_t("profile_shift", type_number, "", "profile shift coefficient x, in modules", range=range_t(-5.0_wp, 5.0_wp), &
            default="0", variants="+module"), &
      row_t("rack", type_block, "", "basic rack, ISO 53", default="{}", holds="rack", variants="+module"), &
      row_t("tip_diameter", type_number, "m", "tip diameter d_a; otherwise from the rack, the profile shift and tip_alteration", &
            range=positive, variants="+module", plausible=span_t(1.0e-4_wp, 5.0_wp)), &
      row_t("tip_alteration", type_number, "", "tip alteration coefficient k, in modules; 0 unless given", &
            range=range_t(-5.0_wp, 5.0_wp), variants="+module"), &
      row_t("tip_rounding", type_number, "m", "radius r_t of the arcs that round the tips; 0: sharp edges", range=not_negative, &
            default="0", variants="+module", plausible=span_t(1.0e-7_wp, 0.02_wp)), &
      row_t("thickness_allowance", type_number, "m", &
            "change of the tooth thickness on the reference circle; negative: thinner teeth, backlash", &
            range=range_t(maximum=0.0_wp), default="0", variants="+module", plausible=span_t(1.0e-8_wp, 0.01_wp)), &
      row_t("bore", type_number, "m", "diameter of the bore", range=not_negative, default="0", variants="+module", &
            plausible=span_t(1.0e-5_wp, 5.0_wp))]

   type(row_t), parameter, public :: rack_rows(*) = [ &
                                     row_t("addendum", type_number, "", "addendum h_aP, in modules", range=positive, default="1"), &
                                  row_t("dedendum", type_number, "", "dedendum h_fP, in modules", range=positive, default="1.25"), &
                 row_t("root_radius", type_number, "", "root fillet radius rho_fP, in modules", range=not_negative, default="0.38")]

   !> The basic rack, in modules.
   type :: rack_t
      real(wp) :: addendum, dedendum, root_radius
   end type rack_t

   !> All that follows from it and the number of teeth. Interoperable for the tests.
   type, bind(c) :: gear_t
      integer(c_int) :: teeth = 0                !! z; 0: not a real gear
      real(c_double) :: normal_module = 0.0_wp         !! m_n [m]
      real(c_double) :: pressure_angle = 0.0_wp        !! alpha_n [rad]
      real(c_double) :: profile_shift = 0.0_wp         !! x
      real(c_double) :: generating_shift = 0.0_wp      !! x_E
      real(c_double) :: undercut_shift = 0.0_wp        !! x_E below which there is undercut
      real(c_double) :: tip_alteration = 0.0_wp        !! k
      real(c_double) :: pitch = 0.0_wp                 !! p [m]
      real(c_double) :: base_pitch = 0.0_wp            !! p_b [m]
      real(c_double) :: reference_radius = 0.0_wp      !! r [m]
      real(c_double) :: base_radius = 0.0_wp           !! r_b [m]
      real(c_double) :: tip_radius = 0.0_wp            !! r_a [m]
      real(c_double) :: tip_rounding = 0.0_wp          !! r_t [m]
      real(c_double) :: tip_form_radius = 0.0_wp       !! r_Fa, where the involute ends [m]
      real(c_double) :: root_radius = 0.0_wp           !! r_f [m]
      real(c_double) :: form_radius = 0.0_wp           !! r_Ff, where the involute begins [m]
      real(c_double) :: bore_radius = 0.0_wp           !! [m]
      real(c_double) :: tooth_depth = 0.0_wp           !! h [m]
      real(c_double) :: thickness = 0.0_wp             !! s on the reference circle, with its allowance [m]
      real(c_double) :: thickness_allowance = 0.0_wp   !! A_s [m]
      real(c_double) :: tip_thickness = 0.0_wp         !! s_a [m]
      real(c_double) :: tooth_angle = 0.0_wp           !! psi [rad]
      real(c_double) :: tool_depth = 0.0_wp            !! of the centre of the rack's tip rounding below the rolling line [m]
      real(c_double) :: tool_rounding = 0.0_wp         !! radius of that rounding [m]
      logical(c_bool) :: is_undercut = .false.   !! whether the rack's tip cuts away a part of the involute
   end type gear_t

contains

   !> Derive the geometry of a gear from a checked description.
   !>
   !> Errors: code_invalid_input with subject_wheel, without index, field as in the case file.
   subroutine gear_derive(given, gear, status, allowance)
      type(given_t), intent(in) :: given      !! block of the wheel
      type(gear_t), intent(out) :: gear       !! initial values on error
      type(status_t), intent(inout) :: status !! filled on error, else cleared
      real(wp), intent(in), optional :: allowance !! of the tooth thickness, instead of the given one [m]
      type(given_t) :: block
      type(rack_t) :: rack
      type(gear_t) :: g
      logical :: is_undercut

      call clear(status)
      call given%inner("rack", block)
      rack = rack_t(block%number("addendum"), block%number("dedendum"), block%number("root_radius"))
      g%teeth = given%whole("teeth")
      g%normal_module = given%number("module")
      g%pressure_angle = given%number("pressure_angle")
      g%profile_shift = given%number("profile_shift")
      g%thickness_allowance = given%number("thickness_allowance")
      if (present(allowance)) g%thickness_allowance = allowance
      g%bore_radius = given%number("bore")/2
      g%tip_rounding = given%number("tip_rounding")
      call check_rack(rack, g%pressure_angle, status)
      if (has_failed(status)) return
      associate (m => g%normal_module, alpha => g%pressure_angle)
         g%generating_shift = g%profile_shift + g%thickness_allowance/(2*m*tan(alpha))
         g%pitch = pi*m
         g%base_pitch = g%pitch*cos(alpha)
         g%reference_radius = m*g%teeth/2
         g%base_radius = g%reference_radius*cos(alpha)
         g%root_radius = g%reference_radius + m*(g%generating_shift - rack%dedendum)
         g%thickness = m*(pi/2 + 2*g%profile_shift*tan(alpha)) + g%thickness_allowance
         g%tooth_angle = g%thickness/g%reference_radius + 2*involute_of_tangent(tan(alpha))
         call derive_tip(given, rack, g, status)
         if (has_failed(status)) return
         g%tool_depth = m*(rack%dedendum - rack%root_radius - g%generating_shift)
         g%tool_rounding = m*rack%root_radius
         call involute_start(g%reference_radius, alpha, g%tool_depth, g%tool_rounding, g%form_radius, is_undercut)
         g%is_undercut = is_undercut
         g%form_radius = hypot(g%base_radius, g%form_radius)
         g%undercut_shift = rack%dedendum - rack%root_radius*(1 - sin(alpha)) - g%teeth*sin(alpha)**2/2
      end associate
      call check_gear(rack, g, status)
      if (has_failed(status)) return
      call round_tip(g, status)
      if (.not. has_failed(status)) gear = g
   end subroutine gear_derive

   !> Radius of curvature of the involute at a radius, sqrt(r^2 - r_b^2) [m].   Valid: radius >= base radius
   elemental real(wp) function gear_radius_of_curvature(gear, radius) result(rho)
      type(gear_t), intent(in) :: gear
      real(wp), intent(in) :: radius !! [m]

      rho = sqrt((radius - gear%base_radius)*(radius + gear%base_radius))
   end function gear_radius_of_curvature

   !> Radius of curvature where the involute ends, rho_Fa [m].   Valid: the rounding leaves some involute
   elemental real(wp) function gear_tip_curvature(gear) result(rho)
      type(gear_t), intent(in) :: gear

      rho = gear%tip_rounding + gear_radius_of_curvature(gear, gear%tip_radius - gear%tip_rounding)
   end function gear_tip_curvature

   !> Tooth thickness, an arc of the circle with the radius [m].   Valid: radius >= base radius
   elemental real(wp) function gear_thickness(gear, radius) result(thickness)
      type(gear_t), intent(in) :: gear
      real(wp), intent(in) :: radius !! [m]

      thickness = radius*(gear%tooth_angle - 2*involute_of_tangent(gear_radius_of_curvature(gear, radius)/gear%base_radius))
   end function gear_thickness

   !> Tip circle and tooth depth. A tip diameter and a tip alteration that are both given have to agree.
   subroutine derive_tip(given, rack, gear, status)
      type(given_t), intent(in) :: given
      type(rack_t), intent(in) :: rack
      type(gear_t), intent(inout) :: gear
      type(status_t), intent(inout) :: status
      real(wp) :: without_alteration, diameter

      diameter = given%number("tip_diameter")
      if (given%has("tip_alteration")) gear%tip_alteration = given%number("tip_alteration")
      associate (m => gear%normal_module)
         without_alteration = gear%reference_radius + m*(gear%profile_shift + rack%addendum)
         gear%tip_radius = without_alteration + m*gear%tip_alteration
         if (given%has("tip_diameter")) then
            if (given%has("tip_alteration") .and. abs(diameter - 2*gear%tip_radius) > agreement*diameter) then
               call refuse(status, "tip_diameter", "tip diameter "//quantity(diameter, "m")//" does not agree with " &
                           //quantity(2*gear%tip_radius, "m")//", which follows from the rack, the profile shift and" &
                           //" tip_alteration: give one of the two")
               return
            end if
            gear%tip_radius = diameter/2
            if (.not. given%has("tip_alteration")) gear%tip_alteration = (gear%tip_radius - without_alteration)/m
         end if
      end associate
      gear%tooth_depth = gear%tip_radius - gear%root_radius
      ! check_gear refuses a tip inside the base circle
      if (gear%tip_radius > gear%base_radius) gear%tip_thickness = gear_thickness(gear, gear%tip_radius)
   end subroutine derive_tip

   !> The tip of the cutting rack is as wide as its two roundings at least.
   !>
   !> Half width of the rack's tooth at its tip, pi/4 - h_fP tan alpha, against rho_fP (1 - sin alpha)/cos alpha.
   pure subroutine check_rack(rack, alpha, status)
      type(rack_t), intent(in) :: rack
      real(wp), intent(in) :: alpha !! pressure angle [rad]
      type(status_t), intent(inout) :: status
      real(wp) :: half_width, largest

      half_width = pi/4 - rack%dedendum*tan(alpha)
      largest = half_width*cos(alpha)/(1 - sin(alpha))
      if (half_width < 0) then
         call refuse(status, "rack.dedendum", "dedendum "//quantity(rack%dedendum, "")//" of the rack is more than " &
                     //quantity(pi/4/tan(alpha), "")//", where the cutting rack's tooth ends in a point")
      else if (rack%root_radius > largest*(1 + agreement)) then
         call refuse(status, "rack.root_radius", "root fillet radius "//quantity(rack%root_radius, "") &
                     //" of the rack is more than "//quantity(largest, "")//", the full rounding of its space")
      end if
   end subroutine check_rack

   !> What makes a gear impossible.
   pure subroutine check_gear(rack, gear, status)
      type(rack_t), intent(in) :: rack
      type(gear_t), intent(in) :: gear
      type(status_t), intent(inout) :: status

      if (.not. gear%root_radius > 0) then
         call refuse(status, "rack.dedendum", "the root radius "//quantity(gear%root_radius, "m")//" must be greater than 0")
      else if (.not. gear%thickness > 0) then
         call refuse(status, "thickness_allowance", "the tooth thickness on the reference circle "//quantity(gear%thickness, "m") &
                     //" must be greater than 0: profile shift and allowance leave nothing of the tooth")
      else if (.not. gear%thickness < gear%pitch) then
         call refuse(status, "profile_shift", "the tooth thickness on the reference circle "//quantity(gear%thickness, "m") &
                     //" must be less than the pitch "//quantity(gear%pitch, "m"))
      else if (.not. gear%tip_radius > gear%base_radius) then
         call refuse(status, "tip_diameter", "the tip circle, diameter "//quantity(2*gear%tip_radius, "m") &
                     //", lies inside the base circle, diameter "//quantity(2*gear%base_radius, "m")//": there is no involute")
      else if (gear%is_undercut .and. rack%dedendum - rack%root_radius <= gear%generating_shift) then
         call refuse(status, "rack.root_radius", "so few teeth and a root fillet radius of " &
                     //quantity(rack%root_radius, "")//" leave no part of the profile to the rack's straight flank")
      else if (.not. gear%tip_radius > gear%form_radius) then
         call refuse(status, "tip_diameter", "the tip circle, diameter "//quantity(2*gear%tip_radius, "m") &
                     //", lies inside the form circle, diameter "//quantity(2*gear%form_radius, "m")//", where the involute" &
                     //" begins: there is no involute")
      else if (.not. gear%tip_thickness > 0) then
         call refuse(status, "tip_diameter", "the tooth is pointed: its thickness on the tip circle, diameter " &
                     //quantity(2*gear%tip_radius, "m")//", would be "//quantity(gear%tip_thickness, "m") &
                     //": a smaller tip diameter or profile shift is needed")
      else if (.not. gear%bore_radius < gear%root_radius) then
         call refuse(status, "bore", "the bore, diameter "//quantity(2*gear%bore_radius, "m")//", must be smaller than the root" &
                     //" circle, diameter "//quantity(2*gear%root_radius, "m"))
      end if
   end subroutine check_gear

   !> Where the involute ends. Roundings that take all of it, or meet in the middle of the tip, are refused.
   pure subroutine round_tip(gear, status)
      type(gear_t), intent(inout) :: gear
      type(status_t), intent(inout) :: status
      type(gear_t) :: other
      real(wp) :: largest, too_large, middle

      gear%tip_form_radius = gear%tip_radius
      if (.not. gear%tip_rounding > 0) return
      if (leaves_flank(gear) .and. leaves_tip(gear)) then
         gear%tip_form_radius = hypot(gear%base_radius, gear_tip_curvature(gear))
         return
      end if
      other = gear
      largest = 0
      too_large = gear%tip_rounding
      do
         middle = 0.5_wp*(largest + too_large)
         if (.not. too_large - largest > agreement*too_large) exit
         other%tip_rounding = middle
         if (leaves_flank(other) .and. leaves_tip(other)) then
            largest = middle
         else
            too_large = middle
         end if
      end do
      other%tip_rounding = too_large
      if (leaves_flank(other)) then
         call refuse(status, "tip_rounding", "the two roundings of the tip, "//quantity(gear%tip_rounding, "m") &
                     //", overlap on a tooth that is "//quantity(gear%tip_thickness, "m")//" thick on the tip circle: give less" &
                     //" than "//quantity(largest, "m"))
      else
         call refuse(status, "tip_rounding", "a tip rounding of "//quantity(gear%tip_rounding, "m") &
                     //" passes the form circle, diameter "//quantity(2*gear%form_radius, "m") &
                     //", and leaves no involute: give less than "//quantity(largest, "m"))
      end if
   end subroutine round_tip

   !> Whether a rounding leaves some of the involute above the form circle.
   pure logical function leaves_flank(gear)
      type(gear_t), intent(in) :: gear

      leaves_flank = gear%tip_radius - gear%tip_rounding > gear%base_radius
      if (leaves_flank) leaves_flank = gear_tip_curvature(gear) > gear_radius_of_curvature(gear, gear%form_radius)
   end function leaves_flank

   !> Whether two roundings leave some of the tip's arc.
   pure logical function leaves_tip(gear)
      type(gear_t), intent(in) :: gear

      leaves_tip = gear_tip_angle(gear) > 0
   end function leaves_tip

   !> Half the angle of the tip's arc [rad].   Valid: tip radius less rounding >= base radius
   elemental real(wp) function gear_tip_angle(gear) result(angle)
      type(gear_t), intent(in) :: gear

      angle = gear%tooth_angle/2 - gear%tip_rounding/gear%base_radius &
              - involute_of_tangent(gear_radius_of_curvature(gear, gear%tip_radius - gear%tip_rounding)/gear%base_radius)
   end function gear_tip_angle

   !> Refuse something of a wheel.
   pure subroutine refuse(status, field, message)
      type(status_t), intent(inout) :: status
      character(len=*), intent(in) :: field, message

      call fail(status, code_invalid_input, message, subject_wheel, field=field)
   end subroutine refuse

end module evl_gear
