!> Geometry of one real spur gear: ISO 21771, cut by the basic rack of ISO 53.
!>
!> Lengths are radii and arcs in the plane of rotation. The allowance of the tooth thickness is taken by the cutter going deeper,
!> so root and form circle belong to the generating profile shift x_E = x + A_s/(2 m tan alpha). With u = tan alpha_y =
!> rho/r_b at the radius r_y, the tooth thickness there is r_y (psi - 2 inv alpha_y), psi = s/r + 2 inv alpha being the angle that
!> the tooth fills on the base circle.
!>
!> Source: ISO 21771:2007, sections 4 and 5; ISO 53:1998, basic rack.
module evl_gear
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_bool, c_int
   use evl_involute_angle, only: involute_of_tangent
   use evl_kinds, only: pi, wp
   use evl_mesh_geometry, only: maximum_teeth, minimum_teeth
   use evl_rack_generation, only: involute_start
   use evl_status, only: clear, code_invalid_input, fail, has_failed, quantity, status_t, subject_wheel
   implicit none (type, external)
   private

   public :: gear_derive, gear_input, gear_radius_of_curvature, gear_t, gear_thickness
   public :: agreement, thin_tip

   real(wp), parameter :: agreement = 1.0e-9_wp   !! relative: two given lengths that differ less are the same
   real(wp), parameter :: thin_tip = 0.2_wp       !! tip thickness in modules: warn below
   real(wp), parameter :: least_angle = 5.0_wp    !! pressure angle of a rack [deg]
   real(wp), parameter :: greatest_angle = 45.0_wp !! the same
   real(wp), parameter :: degree = pi/180.0_wp    !! [rad]

   !> A gear as described; see `evl_gear` in the C header. Lengths of the rack, x and k in modules.
   type :: gear_input
      real(wp) :: normal_module = 0.0_wp, pressure_angle = 0.0_wp, profile_shift = 0.0_wp
      real(wp) :: rack_addendum = 1.0_wp, rack_dedendum = 1.25_wp, rack_root_radius = 0.38_wp
      logical :: has_tip_diameter = .false., has_tip_alteration = .false.
      real(wp) :: tip_diameter = 0.0_wp, tip_alteration = 0.0_wp, thickness_allowance = 0.0_wp, bore = 0.0_wp
   end type gear_input

   !> All that follows from it and the number of teeth; `evl_gear_geometry` in the C header.
   type, bind(c) :: gear_t
      integer(c_int) :: teeth = 0                !! z; 0: not a real gear
      real(wp) :: normal_module = 0.0_wp         !! m_n [m]
      real(wp) :: pressure_angle = 0.0_wp        !! alpha_n [rad]
      real(wp) :: profile_shift = 0.0_wp         !! x
      real(wp) :: generating_shift = 0.0_wp      !! x_E
      real(wp) :: undercut_shift = 0.0_wp        !! x_E below which there is undercut
      real(wp) :: tip_alteration = 0.0_wp        !! k
      real(wp) :: pitch = 0.0_wp                 !! p [m]
      real(wp) :: base_pitch = 0.0_wp            !! p_b [m]
      real(wp) :: reference_radius = 0.0_wp      !! r [m]
      real(wp) :: base_radius = 0.0_wp           !! r_b [m]
      real(wp) :: tip_radius = 0.0_wp            !! r_a [m]
      real(wp) :: root_radius = 0.0_wp           !! r_f [m]
      real(wp) :: form_radius = 0.0_wp           !! r_Ff, where the involute begins [m]
      real(wp) :: bore_radius = 0.0_wp           !! [m]
      real(wp) :: tooth_depth = 0.0_wp           !! h [m]
      real(wp) :: thickness = 0.0_wp             !! s on the reference circle, with its allowance [m]
      real(wp) :: thickness_allowance = 0.0_wp   !! A_s [m]
      real(wp) :: tip_thickness = 0.0_wp         !! s_a [m]
      real(wp) :: tooth_angle = 0.0_wp           !! psi [rad]
      logical(c_bool) :: is_undercut = .false.   !! whether the rack's tip cuts away a part of the involute
   end type gear_t

contains

   !> Derive the geometry of a gear.
   !>
   !> Errors: code_invalid_input with subject_wheel, without index, field as in the case file.
   pure subroutine gear_derive(teeth, given, gear, status)
      integer, intent(in) :: teeth            !! z, minimum_teeth to maximum_teeth
      type(gear_input), intent(in) :: given
      type(gear_t), intent(out) :: gear       !! initial values on error
      type(status_t), intent(inout) :: status !! filled on error, else cleared
      type(gear_t) :: g
      logical :: is_undercut

      call clear(status)
      call check_numbers(teeth, given, status)
      if (has_failed(status)) return
      call check_rack(given, status)
      if (has_failed(status)) return
      associate (m => given%normal_module, alpha => given%pressure_angle)
         g%teeth = teeth
         g%normal_module = m
         g%pressure_angle = alpha
         g%profile_shift = given%profile_shift
         g%thickness_allowance = given%thickness_allowance
         g%generating_shift = g%profile_shift + given%thickness_allowance/(2*m*tan(alpha))
         g%pitch = pi*m
         g%base_pitch = g%pitch*cos(alpha)
         g%reference_radius = m*teeth/2
         g%base_radius = g%reference_radius*cos(alpha)
         g%root_radius = g%reference_radius + m*(g%generating_shift - given%rack_dedendum)
         g%bore_radius = given%bore/2
         g%thickness = m*(pi/2 + 2*g%profile_shift*tan(alpha)) + given%thickness_allowance
         g%tooth_angle = g%thickness/g%reference_radius + 2*involute_of_tangent(tan(alpha))
         call derive_tip(given, g, status)
         if (has_failed(status)) return
         call involute_start(g%reference_radius, alpha, m*(given%rack_dedendum - given%rack_root_radius - g%generating_shift), &
                             m*given%rack_root_radius, g%form_radius, is_undercut)
         g%is_undercut = is_undercut
         g%form_radius = hypot(g%base_radius, g%form_radius)
         g%undercut_shift = given%rack_dedendum - given%rack_root_radius*(1 - sin(alpha)) - teeth*sin(alpha)**2/2
      end associate
      call check_gear(given, g, status)
      if (.not. has_failed(status)) gear = g
   end subroutine gear_derive

   !> Radius of curvature of the involute at a radius, sqrt(r^2 - r_b^2) [m].   Valid: radius >= base radius
   elemental real(wp) function gear_radius_of_curvature(gear, radius) result(rho)
      type(gear_t), intent(in) :: gear
      real(wp), intent(in) :: radius !! [m]

      rho = sqrt((radius - gear%base_radius)*(radius + gear%base_radius))
   end function gear_radius_of_curvature

   !> Tooth thickness, an arc of the circle with the radius [m].   Valid: radius >= base radius
   elemental real(wp) function gear_thickness(gear, radius) result(thickness)
      type(gear_t), intent(in) :: gear
      real(wp), intent(in) :: radius !! [m]

      thickness = radius*(gear%tooth_angle - 2*involute_of_tangent(gear_radius_of_curvature(gear, radius)/gear%base_radius))
   end function gear_thickness

   !> Tip circle and tooth depth. A tip diameter and a tip alteration that are both given have to agree.
   pure subroutine derive_tip(given, gear, status)
      type(gear_input), intent(in) :: given
      type(gear_t), intent(inout) :: gear
      type(status_t), intent(inout) :: status
      real(wp) :: without_alteration

      associate (m => gear%normal_module)
         without_alteration = gear%reference_radius + m*(gear%profile_shift + given%rack_addendum)
         gear%tip_alteration = given%tip_alteration
         gear%tip_radius = without_alteration + m*given%tip_alteration
         if (given%has_tip_diameter) then
            if (given%has_tip_alteration .and. &
                abs(given%tip_diameter - 2*gear%tip_radius) > agreement*given%tip_diameter) then
               call refuse(status, "tip_diameter", "tip diameter "//quantity(given%tip_diameter, "m")//" does not agree with " &
                           //quantity(2*gear%tip_radius, "m")//", which follows from the rack, the profile shift and" &
                           //" tip_alteration: give one of the two")
               return
            end if
            gear%tip_radius = given%tip_diameter/2
            if (.not. given%has_tip_alteration) gear%tip_alteration = (gear%tip_radius - without_alteration)/m
         end if
      end associate
      gear%tooth_depth = gear%tip_radius - gear%root_radius
      ! check_gear refuses a tip inside the base circle
      if (gear%tip_radius > gear%base_radius) gear%tip_thickness = gear_thickness(gear, gear%tip_radius)
   end subroutine derive_tip

   !> Every number is in its range.
   pure subroutine check_numbers(teeth, given, status)
      integer, intent(in) :: teeth
      type(gear_input), intent(in) :: given
      type(status_t), intent(inout) :: status
      character(len=80) :: text

      if (teeth < minimum_teeth .or. teeth > maximum_teeth) then
         write (text, "(a, i0, a, i0, a, i0)") "number of teeth ", teeth, " must be from ", minimum_teeth, " to ", maximum_teeth
         call refuse(status, "teeth", trim(text))
         return
      end if
      call check(given%normal_module, "module", "m", .false., status)
      call check(given%rack_addendum, "rack.addendum", "", .false., status)
      call check(given%rack_dedendum, "rack.dedendum", "", .false., status)
      call check(given%rack_root_radius, "rack.root_radius", "", .true., status)
      if (given%has_tip_diameter) call check(given%tip_diameter, "tip_diameter", "m", .false., status)
      call check(given%bore, "bore", "m", .true., status)
      if (has_failed(status)) return
      if (.not. (given%pressure_angle >= least_angle*degree*(1 - agreement) .and. &
                 given%pressure_angle <= greatest_angle*degree*(1 + agreement))) then
         call refuse(status, "pressure_angle", "pressure angle "//quantity(given%pressure_angle/degree, "deg") &
                     //" must be from "//quantity(least_angle, "")//" to "//quantity(greatest_angle, "deg"))
      else if (.not. ieee_is_finite(given%profile_shift)) then
         call refuse(status, "profile_shift", "profile_shift must be a finite number")
      else if (.not. ieee_is_finite(given%tip_alteration)) then
         call refuse(status, "tip_alteration", "tip_alteration must be a finite number")
      else if (.not. (ieee_is_finite(given%thickness_allowance) .and. given%thickness_allowance <= 0)) then
         call refuse(status, "thickness_allowance", "thickness_allowance "//quantity(given%thickness_allowance, "m") &
                     //" must be a finite number, not positive: teeth thicker than the profile shift gives have another shift")
      end if
   end subroutine check_numbers

   !> A finite number, greater than 0 or at least 0.
   pure subroutine check(value, field, unit, may_vanish, status)
      real(wp), intent(in) :: value
      character(len=*), intent(in) :: field, unit
      logical, intent(in) :: may_vanish
      type(status_t), intent(inout) :: status !! an earlier error stays

      if (has_failed(status) .or. (ieee_is_finite(value) .and. (value > 0 .or. (may_vanish .and. .not. value < 0)))) return
      call refuse(status, field, field//" = "//quantity(value, unit)//" must be a finite number" &
                  //trim(merge(", not negative ", " greater than 0", may_vanish)))
   end subroutine check

   !> The tip of the cutting rack is as wide as its two roundings at least.
   !>
   !> Half width of the rack's tooth at its tip, pi/4 - h_fP tan alpha, against rho_fP (1 - sin alpha)/cos alpha.
   pure subroutine check_rack(given, status)
      type(gear_input), intent(in) :: given
      type(status_t), intent(inout) :: status
      real(wp) :: half_width, largest

      associate (alpha => given%pressure_angle)
         half_width = pi/4 - given%rack_dedendum*tan(alpha)
         largest = half_width*cos(alpha)/(1 - sin(alpha))
         if (half_width < 0) then
            call refuse(status, "rack.dedendum", "dedendum "//quantity(given%rack_dedendum, "")//" of the rack is more than " &
                        //quantity(pi/4/tan(alpha), "")//", where the cutting rack's tooth ends in a point")
         else if (given%rack_root_radius > largest*(1 + agreement)) then
            call refuse(status, "rack.root_radius", "root fillet radius "//quantity(given%rack_root_radius, "") &
                        //" of the rack is more than "//quantity(largest, "")//", the full rounding of its space")
         end if
      end associate
   end subroutine check_rack

   !> What makes a gear impossible.
   pure subroutine check_gear(given, gear, status)
      type(gear_input), intent(in) :: given
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
      else if (gear%is_undercut .and. given%rack_dedendum - given%rack_root_radius <= gear%generating_shift) then
         call refuse(status, "rack.root_radius", "so few teeth and a root fillet radius of " &
                     //quantity(given%rack_root_radius, "")//" leave no part of the profile to the rack's straight flank")
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

   !> Refuse something of a wheel.
   pure subroutine refuse(status, field, message)
      type(status_t), intent(inout) :: status
      character(len=*), intent(in) :: field, message

      call fail(status, code_invalid_input, message, subject_wheel, field=field)
   end subroutine refuse

end module evl_gear
