!> Two gears defined by basic racks in mesh: working pressure angle, path of contact, contact ratio, backlash, mesh checks.
!>
!> Gear A drives gear B; r_b their base radii, R = r_bA + r_bB, psi their tooth angles, p_b their common base pitch:
!>
!>    cos alpha_w = R/a_w    j_bn = p_b + 2 R inv alpha_w - r_bA psi_A - r_bB psi_B    T1T2 = a_w sin alpha_w
!>    g_alpha = rho_aA + rho_aB - T1T2, eps_alpha = g_alpha/p_b,   rho_a = rho_Fa: sqrt(r_a^2 - r_b^2) of a sharp tip
!>
!> With the same module and pressure angle, and without allowances, j_bn = 0 is inv alpha_w = inv alpha + 2 tan alpha
!> (x_A + x_B)/(z_A + z_B).
!>
!> With an internal gear (ring) the same formulas hold with its signs, evl_gear: R, a_w and T1T2 are negative, and the checks are
!> those of evl_ring_interference.
!>
!> Undercut that leaves less involute than the mate's tip requires shortens the path of contact: it begins at the form circle
!> of A, or ends at that of B. Each rho_a above is then T1T2 - rho_Ff of the other gear, if that is less.
!>
!> Source: ISO 21771:2007, section 5.
module evl_gears_in_mesh
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_bool, c_double
   use evl_gear, only: agreement, gear_radius_of_curvature, gear_t, gear_tip_curvature, signed_teeth
   use evl_involute_angle, only: involute_of_tangent, tangent_of_involute
   use evl_kinds, only: pi, wp
   use evl_mesh_geometry, only: spur_pair_locate, spur_pair_t
   use evl_ring_interference, only: check_ring
   use evl_status, only: clear, code_invalid_input, fail, has_failed, quantity, status_t, subject_mesh
   use evl_tip_interference, only: tip_gap
   implicit none (type, external)
   private

   public :: gear_mesh_derive, gear_mesh_geometry, gear_mesh_input, gear_mesh_overlap, gear_mesh_t
   public :: gear_pair_derive

   real(wp), parameter :: vanishing = 16*epsilon(1.0_wp) !! backlash over the centre distance that counts as rounding

   !> Given data of a mesh: none of both, one, or both if they agree.
   type :: gear_mesh_input
      logical :: has_centre_distance = .false., has_backlash = .false.
      real(wp) :: centre_distance = 0.0_wp !! a_w [m]
      real(wp) :: backlash = 0.0_wp        !! j_bn [m]
   end type gear_mesh_input

   !> Geometry derived from two gears and their centre distance. Radii of an internal gear, and a_w, a, R and T1T2 of its mesh, are
   !> negative. Interoperable for the tests.
   type, bind(c) :: gear_mesh_t
      real(c_double) :: centre_distance = 0.0_wp        !! a_w [m]
      real(c_double) :: reference_distance = 0.0_wp     !! a, sum of the reference radii [m]
      real(c_double) :: tight_distance = 0.0_wp         !! zero-backlash centre distance of the profile shifts [m]
      real(c_double) :: base_radius_sum = 0.0_wp        !! R = r_bA + r_bB [m]
      real(c_double) :: working_pressure_angle = 0.0_wp !! alpha_w [rad]
      real(c_double) :: pitch_radius_a = 0.0_wp         !! r_w of A [m]
      real(c_double) :: pitch_radius_b = 0.0_wp         !! the same of B [m]
      real(c_double) :: line_of_action = 0.0_wp         !! T1T2 [m]
      real(c_double) :: base_pitch = 0.0_wp             !! p_b [m]
      real(c_double) :: path_of_contact = 0.0_wp        !! g_alpha [m]
      real(c_double) :: approach = 0.0_wp               !! g_f, path before the pitch point if A drives [m]
      real(c_double) :: recess = 0.0_wp                 !! g_a, path behind it [m]
      real(c_double) :: contact_ratio = 0.0_wp          !! eps_alpha
      real(c_double) :: rho_tip_a = 0.0_wp              !! radius of curvature at the end of the involute of A [m]
      real(c_double) :: rho_tip_b = 0.0_wp              !! the same of B [m]
      real(c_double) :: rho_end_a = 0.0_wp              !! radius of curvature of A at the end of the path: rho_tip_a or less [m]
      real(c_double) :: rho_end_b = 0.0_wp              !! that of B at the start of the path: rho_tip_b or less [m]
      real(c_double) :: active_radius_a = 0.0_wp        !! r_Nf, start of the active profile of A [m]
      real(c_double) :: active_radius_b = 0.0_wp        !! the same of B [m]
      real(c_double) :: clearance_a = 0.0_wp            !! c, from the tip of B to the root circle of A [m]
      real(c_double) :: clearance_b = 0.0_wp            !! from the tip of A to the root circle of B [m]
      real(c_double) :: backlash = 0.0_wp               !! j_bn, normal [m]
      real(c_double) :: circumferential_backlash = 0.0_wp !! j_wt, on the working pitch circles [m]
      real(c_double) :: radial_backlash = 0.0_wp        !! j_r, about the approach of the axles that removes it [m]
      logical(c_bool) :: exists = .false.         !! whether this mesh is one of two gears with basic racks
   end type gear_mesh_t

contains

   !> Derive the geometry of a mesh and check it.
   !>
   !> The centre distance is the given one, or that of the given backlash. Otherwise it is the zero-backlash distance of the
   !> profile shifts, at which thickness allowances leave a backlash.
   !> Errors: code_invalid_input with subject_mesh, without index; field centre_distance, backlash or none.
   pure subroutine gear_mesh_derive(a, b, input, mesh, status)
      type(gear_t), intent(in) :: a, b        !! the driving and the driven gear
      type(gear_mesh_input), intent(in) :: input
      type(gear_mesh_t), intent(out) :: mesh  !! initial values on error
      type(status_t), intent(inout) :: status !! filled on error, else cleared
      type(gear_mesh_t) :: m

      call gear_mesh_geometry(a, b, input, m, status)
      if (.not. has_failed(status) .and. input%has_centre_distance) call check_backlash(input, m, status)
      if (.not. has_failed(status)) call check_path(a, b, m, status)
      if (.not. has_failed(status)) mesh = m
   end subroutine gear_mesh_derive

   !> Compute the geometry alone: also of gears that cannot mesh, whose teeth overlap or which have no path of contact.
   !> Errors: as above, where there is no working pressure angle.
   !> Equations G7, G8, G10, G11, G12.
   pure subroutine gear_mesh_geometry(a, b, input, mesh, status)
      type(gear_t), intent(in) :: a, b
      type(gear_mesh_input), intent(in) :: input
      type(gear_mesh_t), intent(out) :: mesh  !! initial values on error
      type(status_t), intent(inout) :: status !! filled on error, else cleared
      type(gear_mesh_t) :: m
      real(wp) :: tangent

      call clear(status)
      if (abs(a%base_pitch - b%base_pitch) > agreement*a%base_pitch) then
         call refuse(status, "", "its wheels cannot mesh: the base pitch pi m cos(alpha) of the driving wheel is " &
                     //quantity(a%base_pitch, "m")//", that of the driven wheel "//quantity(b%base_pitch, "m"))
         return
      end if
      if (a%is_internal .and. b%is_internal) then
         call refuse(status, "", "its wheels are both internal; an internal gear meshes with an external one")
         return
      end if
      if (a%is_internal .or. b%is_internal) call check_teeth(a, b, status)
      if (has_failed(status)) return
      m%exists = .true.
      m%base_pitch = a%base_pitch
      m%reference_distance = a%reference_radius + b%reference_radius
      m%base_radius_sum = base_sum(a, b)
      call find_distance(a, b, input, m, tangent, status)
      if (has_failed(status)) return
      m%working_pressure_angle = atan(tangent)
      associate (z_a => signed_teeth(a), z_b => signed_teeth(b))
         m%pitch_radius_a = m%centre_distance*z_a/(z_a + z_b)
         m%pitch_radius_b = m%centre_distance*z_b/(z_a + z_b)
      end associate
      m%line_of_action = m%base_radius_sum*tangent
      m%circumferential_backlash = m%backlash*hypot(1.0_wp, tangent)
      m%radial_backlash = m%circumferential_backlash/(2*tangent)
      m%rho_tip_a = gear_tip_curvature(a)
      m%rho_tip_b = gear_tip_curvature(b)
      m%rho_end_a = path_end(b, m%line_of_action, m%rho_tip_a)
      m%rho_end_b = path_end(a, m%line_of_action, m%rho_tip_b)
      m%path_of_contact = m%rho_end_a + m%rho_end_b - m%line_of_action
      m%recess = m%rho_end_a - a%base_radius*tangent
      m%approach = m%rho_end_b - b%base_radius*tangent
      m%contact_ratio = m%path_of_contact/m%base_pitch
      m%active_radius_a = sign(hypot(a%base_radius, m%line_of_action - m%rho_end_b), a%base_radius)
      m%active_radius_b = sign(hypot(b%base_radius, m%line_of_action - m%rho_end_a), b%base_radius)
      m%clearance_a = m%centre_distance - b%tip_radius - a%root_radius
      m%clearance_b = m%centre_distance - a%tip_radius - b%root_radius
      mesh = m
   end subroutine gear_mesh_geometry

   !> Radius of curvature of a mate at the end of the path of contact: at its tip, or where undercut ends the gear's involute [m].
   !> Equation G13.
   pure real(wp) function path_end(gear, line_of_action, rho_tip) result(rho)
      type(gear_t), intent(in) :: gear
      real(wp), intent(in) :: line_of_action !! T1T2 [m]
      real(wp), intent(in) :: rho_tip        !! of the mate [m]

      rho = rho_tip
      if (.not. gear%is_undercut) return
      ! a tip that reaches past T1 requires more than all of the involute
      if (rho_tip <= line_of_action .and. &
          hypot(gear%base_radius, line_of_action - rho_tip) >= gear%form_radius*(1 - agreement)) return
      rho = line_of_action - gear_radius_of_curvature(gear, gear%form_radius)
   end function path_end

   !> Centre distance, backlash and tan alpha_w. Equation G9.
   pure subroutine find_distance(a, b, input, mesh, tangent, status)
      type(gear_t), intent(in) :: a, b
      type(gear_mesh_input), intent(in) :: input
      type(gear_mesh_t), intent(inout) :: mesh
      real(wp), intent(out) :: tangent !! tan alpha_w
      type(status_t), intent(inout) :: status
      real(wp) :: allowances, tight, involute

      tangent = 0
      allowances = allowed_arc(a, b)
      tight = tight_arc(a, b)
      involute = tight/(2*mesh%base_radius_sum)
      if (involute > 0) mesh%tight_distance = mesh%base_radius_sum*hypot(1.0_wp, tangent_of_involute(involute))
      if (input%has_centre_distance) then
         mesh%centre_distance = sign(input%centre_distance, mesh%base_radius_sum)
         if (.not. input%centre_distance > abs(mesh%base_radius_sum)) then
            call refuse(status, "centre_distance", "centre distance "//quantity(input%centre_distance, "m")//" must be greater" &
                        //" than "//quantity(abs(mesh%base_radius_sum), "m")//", the " &
                        //trim(merge("difference", "sum       ", mesh%base_radius_sum < 0))//" of the base radii")
            return
         end if
         tangent = tangent_at(mesh%base_radius_sum, mesh%centre_distance)
         mesh%backlash = backlash_at(a, b, tangent)
         if (mesh%backlash >= -agreement*input%centre_distance .and. mesh%backlash < vanishing*input%centre_distance) &
            mesh%backlash = 0
         return
      end if
      mesh%backlash = allowances
      if (input%has_backlash) mesh%backlash = input%backlash
      involute = (tight - allowances + mesh%backlash)/(2*mesh%base_radius_sum)
      if (.not. involute > 0) then
         call refuse(status, "", "no centre distance gives this backlash: the involute of the working pressure angle would be " &
                     //quantity(involute, "")//"; choose larger profile shifts, of an internal gear a smaller sum of them")
         return
      end if
      tangent = tangent_of_involute(involute)
      mesh%centre_distance = mesh%base_radius_sum*hypot(1.0_wp, tangent)
   end subroutine find_distance

   !> R = r_bA + r_bB [m].
   pure real(wp) function base_sum(a, b)
      type(gear_t), intent(in) :: a, b

      base_sum = a%base_radius + b%base_radius
   end function base_sum

   !> Check the numbers of teeth of an internal pair.
   pure subroutine check_teeth(a, b, status)
      type(gear_t), intent(in) :: a, b
      type(status_t), intent(inout) :: status
      character(len=12) :: pinion, ring

      if ((a%teeth < b%teeth) .eqv. logical(b%is_internal)) then
         if (a%teeth /= b%teeth) return
      end if
      write (pinion, "(i0)") merge(a%teeth, b%teeth, logical(b%is_internal))
      write (ring, "(i0)") merge(b%teeth, a%teeth, logical(b%is_internal))
      call refuse(status, "", "an internal gear of "//trim(ring)//" teeth needs a mate with fewer teeth, not "//trim(pinion))
   end subroutine check_teeth

   !> tan alpha_w at a centre distance, whose magnitude is more than that of R. Equation G7.
   pure real(wp) function tangent_at(r, centre_distance) result(tangent)
      real(wp), intent(in) :: r, centre_distance !! R, a_w [m]

      tangent = sqrt((centre_distance - r)*(centre_distance + r))/abs(r)
   end function tangent_at

   !> Normal backlash for this tangent of the working pressure angle; negative if the teeth overlap [m]. Equation G8.
   pure real(wp) function backlash_at(a, b, tangent) result(backlash)
      type(gear_t), intent(in) :: a, b
      real(wp), intent(in) :: tangent

      backlash = 2*base_sum(a, b)*involute_of_tangent(tangent) - tight_arc(a, b) + allowed_arc(a, b)
   end function backlash_at

   !> Overlap of the teeth at a given centre distance, beyond rounding: minus the normal backlash, at least 0 [m].
   pure real(wp) function gear_mesh_overlap(a, b, centre_distance) result(overlap)
      type(gear_t), intent(in) :: a, b            !! gears of the same base pitch
      real(wp), intent(in) :: centre_distance     !! as given, > 0 [m]
      real(wp) :: r

      overlap = 0
      r = base_sum(a, b)
      if (.not. (ieee_is_finite(centre_distance) .and. centre_distance > abs(r))) return
      overlap = -backlash_at(a, b, tangent_at(r, centre_distance))
      if (.not. overlap > agreement*centre_distance) overlap = 0
   end function gear_mesh_overlap

   !> 2 R inv alpha_w of teeth without allowance at zero backlash [m]. Equations G8, G9.
   pure real(wp) function tight_arc(a, b)
      type(gear_t), intent(in) :: a, b

      tight_arc = full_arc(a) + full_arc(b) - a%base_pitch
   end function tight_arc

   !> Reduction of the teeth by the allowances, on the base circles [m]. Equation G8.
   pure real(wp) function allowed_arc(a, b)
      type(gear_t), intent(in) :: a, b

      allowed_arc = abs(a%thickness_allowance)*cos(a%pressure_angle) + abs(b%thickness_allowance)*cos(b%pressure_angle)
   end function allowed_arc

   !> Arc of the base circle under a tooth without allowance [m]. Equation G8.
   pure real(wp) function full_arc(gear)
      type(gear_t), intent(in) :: gear

      full_arc = gear%base_radius*gear%tooth_angle - gear%thickness_allowance*cos(gear%pressure_angle)
   end function full_arc

   !> Check that the backlash at a given centre distance is not negative, and equal to the given one if there is one, within
   !> rounding of the given numbers.
   pure subroutine check_backlash(input, mesh, status)
      type(gear_mesh_input), intent(in) :: input
      type(gear_mesh_t), intent(in) :: mesh
      type(status_t), intent(inout) :: status

      associate (rounding => agreement*abs(mesh%centre_distance))
         if (mesh%backlash < -rounding) then
            call refuse(status, "centre_distance", "the teeth do not fit at the centre distance " &
                        //quantity(abs(mesh%centre_distance), "m")//": the normal backlash would be " &
                        //quantity(mesh%backlash, "m")//"; the zero-backlash centre distance is " &
                        //quantity(abs(mesh%tight_distance), "m"))
         else if (input%has_backlash .and. abs(input%backlash - mesh%backlash) > rounding) then
            call refuse(status, "backlash", "backlash "//quantity(input%backlash, "m")//" does not agree with " &
                        //quantity(mesh%backlash, "m")//", which follows from the centre distance; give one of the two")
         end if
      end associate
   end subroutine check_backlash

   !> Check that involutes are in contact all along the path of contact, and nothing else is.
   pure subroutine check_path(a, b, mesh, status)
      type(gear_t), intent(in) :: a, b
      type(gear_mesh_t), intent(in) :: mesh
      type(status_t), intent(inout) :: status

      if (.not. mesh%rho_tip_a + mesh%rho_tip_b > mesh%line_of_action) then
         call refuse(status, "", "its teeth do not reach each other: the path of contact would be " &
                     //quantity(mesh%rho_tip_a + mesh%rho_tip_b - mesh%line_of_action, "m")//" long at the centre distance " &
                     //quantity(abs(mesh%centre_distance), "m"))
         return
      end if
      if (a%is_internal) then
         call check_ring(b, a, mesh%line_of_action, mesh%centre_distance, mesh%working_pressure_angle, mesh%base_pitch, status)
      else if (b%is_internal) then
         call check_ring(a, b, mesh%line_of_action, mesh%centre_distance, mesh%working_pressure_angle, mesh%base_pitch, status)
      end if
      if (a%is_internal .or. b%is_internal) return
      call check_foot(a, b, mesh, mesh%rho_tip_b, mesh%rho_end_b, mesh%clearance_a, "driving", "driven", status)
      call check_foot(b, a, mesh, mesh%rho_tip_a, mesh%rho_end_a, mesh%clearance_b, "driven", "driving", status)
      if (has_failed(status) .or. mesh%contact_ratio >= 1) return
      if (mesh%rho_end_a < mesh%rho_tip_a .or. mesh%rho_end_b < mesh%rho_tip_b) &
         call refuse(status, "", "undercut leaves it a contact" &
                     //" ratio of "//quantity(mesh%contact_ratio, "")//", which must be at least 1; choose larger profile shifts," &
                     //" which lengthen the involute")
   end subroutine check_path

   !> Check that a mate's tip meets involute of a gear, or space cleared by undercut; not its fillet and not its root circle.
   pure subroutine check_foot(gear, mate, mesh, rho_tip, rho_end, clearance, name, mate_name, status)
      type(gear_t), intent(in) :: gear, mate
      type(gear_mesh_t), intent(in) :: mesh
      real(wp), intent(in) :: rho_tip        !! radius of curvature at the mate's tip [m]
      real(wp), intent(in) :: rho_end        !! that at the end of the path of contact on the mate [m]
      real(wp), intent(in) :: clearance      !! from the mate's tip to the gear's root circle [m]
      character(len=*), intent(in) :: name, mate_name
      type(status_t), intent(inout) :: status !! an earlier error is preserved
      real(wp) :: active_radius, gap

      if (has_failed(status)) return
      active_radius = hypot(gear%base_radius, mesh%line_of_action - rho_tip)
      if (rho_tip > mesh%line_of_action*(1 + agreement) .and. .not. gear%is_undercut) then
         call refuse(status, "", "the path of contact leaves the line of action: the tip of the "//mate_name//" wheel, diameter " &
                     //quantity(2*mate%tip_radius, "m")//", reaches past the point where that line touches the base circle of" &
                     //" the "//name//" wheel; a tip diameter of at most " &
                     //quantity(2*hypot(mate%base_radius, mesh%line_of_action), "m")//" avoids it")
      else if (active_radius < gear%form_radius*(1 - agreement) .and. .not. gear%is_undercut) then
         call refuse(status, "", "tip interference: the tip of the "//mate_name//" wheel meets the "//name//" wheel at the" &
                     //" diameter "//quantity(2*active_radius, "m")//", in the fillet below its form diameter " &
                     //quantity(2*gear%form_radius, "m")//", where the involute begins")
      else if (.not. clearance > 0) then
         call refuse(status, "", "the tip of the "//mate_name//" wheel runs into the root circle of the "//name//" wheel: the tip" &
                     //" clearance would be "//quantity(clearance, "m"))
      else if (rho_end < rho_tip) then
         gap = tip_gap(gear, mate, mesh%centre_distance, mesh%working_pressure_angle, rho_tip)
         if (gap < -agreement*mesh%centre_distance) &
          call refuse(status, "", "tip interference: the tip of the "//mate_name//" wheel enters the undercut tooth of the "//name &
                        //" wheel by "//quantity(-gap, "m")//"; a smaller tip diameter of the "//mate_name//" wheel, or a larger" &
                        //" centre distance, avoids it")
      end if
   end subroutine check_foot

   !> Report an error of a mesh.
   pure subroutine refuse(status, field, message)
      type(status_t), intent(inout) :: status
      character(len=*), intent(in) :: field, message

      call fail(status, code_invalid_input, message, subject_mesh, field=field)
   end subroutine refuse

   !> Fill a pair: lengths from the gears and their mesh, points from its position.
   !>
   !> The path of contact goes from the tip of B to the tip of A, shortened by undercut.
   !> Valid: gears and mesh accepted by gear_derive and gear_mesh_derive
   pure subroutine gear_pair_derive(gear_a, gear_b, mesh, chi, sigma, centre_a, pair)
      type(gear_t), intent(in) :: gear_a, gear_b !! the driving and the driven gear
      type(gear_mesh_t), intent(in) :: mesh      !! of the two
      real(wp), intent(in) :: chi                !! direction from O_A to O_B [rad]
      integer, intent(in) :: sigma               !! +1 or -1, see evl_mesh_geometry
      real(wp), intent(in) :: centre_a(2)        !! O_A in the housing frame [m]
      type(spur_pair_t), intent(out) :: pair

      pair%teeth_a = gear_a%teeth
      pair%teeth_b = gear_b%teeth
      pair%sigma = sigma
      pair%ratio = real(signed_teeth(gear_b), wp)/real(signed_teeth(gear_a), wp)
      pair%pitch_radius_a = mesh%pitch_radius_a
      pair%pitch_radius_b = mesh%pitch_radius_b
      pair%centre_distance = mesh%centre_distance
      pair%chi = chi
      pair%gamma_a = 2*pi/signed_teeth(gear_a)
      pair%alpha_inf = atan(2*pi/abs(signed_teeth(gear_a) + signed_teeth(gear_b)))
      pair%alpha_w = mesh%working_pressure_angle
      pair%base_radius_a = gear_a%base_radius
      pair%base_radius_b = gear_b%base_radius
      pair%base_radius_sum = mesh%base_radius_sum
      pair%rho = mesh%line_of_action
      pair%base_pitch = mesh%base_pitch
      pair%tip_radius_a = gear_a%tip_radius
      pair%tip_radius_b = gear_b%tip_radius
      pair%rho_tip_a = mesh%rho_end_a
      pair%rho_tip_b = mesh%rho_end_b
      pair%rho_start_a = mesh%line_of_action - mesh%rho_end_b
      pair%rho_start_b = mesh%rho_end_b
      pair%contains_pitch_point = mesh%approach >= 0 .and. mesh%recess >= 0
      pair%handover = .false.
      pair%contact_ratio = mesh%contact_ratio
      pair%has_coast = .true.
      pair%backlash = mesh%backlash
      pair%tooth_angle_a = gear_a%tooth_angle
      pair%tooth_angle_b = gear_b%tooth_angle
      pair%centre_a = centre_a
      call spur_pair_locate(pair)
   end subroutine gear_pair_derive

end module evl_gears_in_mesh
