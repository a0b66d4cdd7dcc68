!> Derivation of a gear from its description: circles, tip, root, and the checks that it can be made. Formulas: evl_gear.
module evl_gear_derivation
   use evl_gear, only: agreement, gear_radius_of_curvature, gear_t, gear_thickness, gear_tip_angle, gear_tip_curvature, &
                       is_outside, signed_teeth
   use evl_involute_angle, only: involute_of_tangent
   use evl_kinds, only: pi, wp
   use evl_parameter_view, only: parameter_view_t
   use evl_rack_generation, only: involute_start
   use evl_ring_derivation, only: derive_ring_root
   use evl_status, only: clear, code_invalid_input, fail, has_failed, quantity, status_t, subject_wheel
   implicit none (type, external)
   private

   public :: gear_derive

   real(wp), parameter :: ring_addendum = 0.8_wp  !! default h_aP of a ring: with 1 its tip would meet the fillet of most mates

   !> Basic rack, in modules.
   type :: rack_t
      real(wp) :: addendum, dedendum, root_radius
   end type rack_t

contains

   !> Derive the geometry of a gear from a checked description. Equations G1, G2, G3, G4, I1.
   !>
   !> Errors: code_invalid_input with subject_wheel, without index, field as in the case file.
   subroutine gear_derive(input, gear, status, allowance)
      type(parameter_view_t), intent(in) :: input      !! block of the wheel
      type(gear_t), intent(out) :: gear       !! initial values on error
      type(status_t), intent(inout) :: status !! filled on error, else cleared
      real(wp), intent(in), optional :: allowance !! of the tooth thickness, instead of the given one [m]
      type(parameter_view_t) :: block
      type(rack_t) :: rack
      type(gear_t) :: g
      logical :: is_undercut

      call clear(status)
      g%is_internal = input%word("internal") == "true"
      call input%inner("rack", block)
      rack = rack_t(merge(ring_addendum, 1.0_wp, g%is_internal), block%number("dedendum"), block%number("root_radius"))
      if (block%has("addendum")) rack%addendum = block%number("addendum")
      g%rack_addendum = rack%addendum
      g%rack_dedendum = rack%dedendum
      g%rack_root_radius = rack%root_radius
      g%teeth = input%whole("teeth")
      g%normal_module = input%number("module")
      g%pressure_angle = input%number("pressure_angle")
      g%profile_shift = input%number("profile_shift")
      g%thickness_allowance = input%number("thickness_allowance")
      if (present(allowance)) g%thickness_allowance = allowance
      g%bore_radius = input%number("bore")/2
      if (input%has("rim_diameter")) g%rim_radius = -input%number("rim_diameter")/2
      g%tip_rounding = input%number("tip_rounding")
      if (input%has("span_teeth")) g%span_teeth = input%whole("span_teeth")
      if (input%has("ball_diameter")) g%ball_diameter = input%number("ball_diameter")
      call check_form(input, logical(g%is_internal), status)
      if (.not. (has_failed(status) .or. g%is_internal)) call check_rack(rack, g%pressure_angle, status)
      if (has_failed(status)) return
      associate (m => g%normal_module, alpha => g%pressure_angle)
         g%generating_shift = g%profile_shift + g%thickness_allowance/(2*m*tan(alpha))
         g%pitch = pi*m
         g%base_pitch = g%pitch*cos(alpha)
         g%reference_radius = m*signed_teeth(g)/2
         g%base_radius = g%reference_radius*cos(alpha)
         g%root_radius = g%reference_radius + m*(g%generating_shift - rack%dedendum)
         g%thickness = m*(pi/2 + 2*g%profile_shift*tan(alpha)) + g%thickness_allowance
         g%tooth_angle = g%thickness/g%reference_radius + 2*involute_of_tangent(tan(alpha))
         call derive_tip(input, rack, g, status)
         if (has_failed(status)) return
         if (g%is_internal) then
            call derive_ring_root(input, m*rack%root_radius, g, status)
            if (has_failed(status)) return
            g%rack_dedendum = g%generating_shift - (g%root_radius - g%reference_radius)/m
         else
            g%tool_depth = m*(rack%dedendum - rack%root_radius - g%generating_shift)
            g%tool_rounding = m*rack%root_radius
            call involute_start(g%reference_radius, alpha, g%tool_depth, g%tool_rounding, g%form_radius, is_undercut)
            g%is_undercut = is_undercut
            g%form_radius = hypot(g%base_radius, g%form_radius)
            g%undercut_shift = rack%dedendum - rack%root_radius*(1 - sin(alpha)) - g%teeth*sin(alpha)**2/2
         end if
      end associate
      call check_gear(rack, g, status)
      if (has_failed(status)) return
      call round_tip(g, status)
      if (.not. has_failed(status)) gear = g
   end subroutine gear_derive

   !> Check that the keys given fit an internal or an external gear.
   subroutine check_form(input, is_internal, status)
      type(parameter_view_t), intent(in) :: input
      logical, intent(in) :: is_internal
      type(status_t), intent(inout) :: status

      if (.not. is_internal) then
         if (input%has("rim_diameter")) call refuse(status, "rim_diameter", "a rim diameter is that of an internal gear; give" &
                                                    //" internal: true, or 'bore'")
         if (input%has("fillet")) call refuse(status, "fillet", "'fillet' is the root of an internal gear; that of an external" &
                                              //" one follows from its rack")
         return
      end if
      if (input%number("bore") > 0) then
         call refuse(status, "bore", "an internal gear has no bore; give 'rim_diameter', its outer diameter")
      end if
   end subroutine check_form

   !> Tip circle and tooth depth. If a tip diameter and a tip alteration are both given, they must agree. Equation G3.
   subroutine derive_tip(input, rack, gear, status)
      type(parameter_view_t), intent(in) :: input
      type(rack_t), intent(in) :: rack
      type(gear_t), intent(inout) :: gear
      type(status_t), intent(inout) :: status
      real(wp) :: without_alteration, diameter

      diameter = input%number("tip_diameter")
      if (input%has("tip_alteration")) gear%tip_alteration = input%number("tip_alteration")
      associate (m => gear%normal_module)
         without_alteration = gear%reference_radius + m*(gear%profile_shift + rack%addendum)
         gear%tip_radius = without_alteration + m*gear%tip_alteration
         if (input%has("tip_diameter")) then
            if (input%has("tip_alteration") .and. abs(diameter - 2*abs(gear%tip_radius)) > agreement*diameter) then
               call refuse(status, "tip_diameter", "tip diameter "//quantity(diameter, "m")//" does not agree with " &
                           //quantity(2*abs(gear%tip_radius), "m")//", which follows from the rack, the profile shift and" &
                           //" tip_alteration; give one of the two")
               return
            end if
            gear%tip_radius = sign(diameter, gear%reference_radius)/2
            if (.not. input%has("tip_alteration")) gear%tip_alteration = (gear%tip_radius - without_alteration)/m
         end if
      end associate
      gear%tooth_depth = gear%tip_radius - gear%root_radius
      ! check_gear refuses a tip inside the base circle
      if (is_outside(gear, gear%tip_radius, gear%base_radius)) gear%tip_thickness = gear_thickness(gear, gear%tip_radius)
   end subroutine derive_tip

   !> Check that the tip of the cutting rack is at least as wide as its two roundings.
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

   !> Check that the gear is possible.
   pure subroutine check_gear(rack, gear, status)
      type(rack_t), intent(in) :: rack
      type(gear_t), intent(in) :: gear
      type(status_t), intent(inout) :: status

      if (.not. is_outside(gear, gear%root_radius, 0.0_wp)) then
         call refuse(status, "rack.dedendum", "the root radius "//quantity(gear%root_radius, "m")//" must be greater than 0")
      else if (.not. gear%thickness > 0) then
         call refuse(status, "thickness_allowance", "the tooth thickness on the reference circle "//quantity(gear%thickness, "m") &
                     //" must be greater than 0: profile shift and allowance remove the whole tooth")
      else if (.not. gear%thickness < gear%pitch) then
         call refuse(status, "profile_shift", "the tooth thickness on the reference circle "//quantity(gear%thickness, "m") &
                     //" must be less than the pitch "//quantity(gear%pitch, "m"))
      else if (.not. is_outside(gear, gear%tip_radius, gear%base_radius)) then
         call refuse(status, "tip_diameter", "the tip circle, diameter "//quantity(2*abs(gear%tip_radius), "m") &
                     //", lies inside the base circle, diameter "//quantity(2*abs(gear%base_radius), "m")//": there is no involute")
      else if (gear%is_undercut .and. rack%dedendum - rack%root_radius <= gear%generating_shift) then
         call refuse(status, "rack.root_radius", "so few teeth and a root fillet radius of " &
                     //quantity(rack%root_radius, "")//" leave no part of the profile to the rack's straight flank")
      else if (.not. gear%tip_radius > gear%form_radius) then
         call refuse(status, "tip_diameter", "the tip circle, diameter "//quantity(2*abs(gear%tip_radius), "m") &
                     //", lies "//trim(merge("outside", "inside ", logical(gear%is_internal)))//" the form circle, diameter " &
                     //quantity(2*abs(gear%form_radius), "m")//", where the involute" &
                     //" begins: there is no involute")
      else if (.not. gear%tip_thickness > 0) then
         call refuse(status, "tip_diameter", "the tooth is pointed: its thickness on the tip circle, diameter " &
                     //quantity(2*abs(gear%tip_radius), "m")//", would be "//quantity(gear%tip_thickness, "m") &
                     //"; choose a "//trim(merge("larger ", "smaller", logical(gear%is_internal)))//" tip diameter, or a smaller" &
                     //" profile shift")
      else if (gear%is_internal) then
         if (abs(gear%rim_radius) > 0 .and. .not. gear%rim_radius < gear%root_radius) &
            call refuse(status, "rim_diameter", "the rim diameter "//quantity(-2*gear%rim_radius, "m")//" must be greater than" &
                        //" the root diameter "//quantity(-2*gear%root_radius, "m"))
      else if (.not. gear%bore_radius < gear%root_radius) then
         call refuse(status, "bore", "the bore, diameter "//quantity(2*gear%bore_radius, "m")//", must be smaller than the root" &
                     //" circle, diameter "//quantity(2*gear%root_radius, "m"))
      end if
   end subroutine check_gear

   !> Compute the end of the involute. Roundings that remove all of it, or meet in the middle of the tip, are refused. Equation G5.
   pure subroutine round_tip(gear, status)
      type(gear_t), intent(inout) :: gear
      type(status_t), intent(inout) :: status
      type(gear_t) :: other
      real(wp) :: largest, too_large, middle

      gear%tip_form_radius = gear%tip_radius
      if (.not. gear%tip_rounding > 0) return
      if (leaves_flank(gear) .and. leaves_tip(gear)) then
         gear%tip_form_radius = sign(hypot(gear%base_radius, gear_tip_curvature(gear)), gear%base_radius)
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
                     //", overlap on a tooth that is "//quantity(gear%tip_thickness, "m")//" thick on the tip circle; give less" &
                     //" than "//quantity(largest, "m"))
      else
         call refuse(status, "tip_rounding", "a tip rounding of "//quantity(gear%tip_rounding, "m") &
                     //" passes the form circle, diameter "//quantity(2*abs(gear%form_radius), "m") &
                     //", and leaves no involute; give less than "//quantity(largest, "m"))
      end if
   end subroutine round_tip

   !> Whether a rounding leaves some of the involute above the form circle.
   pure logical function leaves_flank(gear)
      type(gear_t), intent(in) :: gear

      leaves_flank = is_outside(gear, gear%tip_radius - gear%tip_rounding, gear%base_radius)
      if (leaves_flank) leaves_flank = gear_tip_curvature(gear) > gear_radius_of_curvature(gear, gear%form_radius)
   end function leaves_flank

   !> Whether two roundings leave some of the tip's arc.
   pure logical function leaves_tip(gear)
      type(gear_t), intent(in) :: gear

      leaves_tip = gear_tip_angle(gear) > 0
   end function leaves_tip

   !> Report an error of a wheel.
   pure subroutine refuse(status, field, message)
      type(status_t), intent(inout) :: status
      character(len=*), intent(in) :: field, message

      call fail(status, code_invalid_input, message, subject_wheel, field=field)
   end subroutine refuse

end module evl_gear_derivation
