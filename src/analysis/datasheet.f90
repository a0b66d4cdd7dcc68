!> Data sheet of a mesh: geometry, inspection, tolerances, nominal stress, stiffness and dynamics as rows.
!>
!> A row has a value per gear, driving gear first, or one of the mesh, in SI units and radians. A value that does not exist is NaN,
!> and the note of its row gives the reason. Otherwise the note names the source, or an assumption.
!>
!> Quantities under load are nominal: normal force F of the nominal operating point, without dynamics or load distribution over the
!> width (all application factors 1), and the geometric load share of the tooth pairs.
module evl_datasheet
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use evl_dynamic_factor, only: dynamic_factor, mesh_stiffness_factor, reduced_mass, resonance_speed
   use evl_flank_tolerances, only: flank_tolerances_of, flank_tolerances_t
   use evl_gear, only: gear_t
   use evl_gearbox, only: gearbox_t, sheet_data_t
   use evl_kinds, only: nan, pi, wp
   use evl_mesh_geometry, only: spur_pair_t
   use evl_mesh_stiffness, only: iso_stiffness, mesh_stiffness, mesh_stiffness_t
   use evl_path_points, only: nominal_pressures, path_points_of, path_points_t, point_c, tooth_loss_factor
   use evl_tooth_contact, only: tooth_contact_t
   use evl_tooth_measures, only: ball_diameter, ball_measure, measure_above, measure_below, measure_in_root, measure_in_space, &
                                 measure_valid, span_measure, span_teeth
   implicit none (type, external)
   private

   public :: datasheet_of, sheet_row_t

   character(len=*), parameter :: no_rack = "not defined: a gear without basic rack"
   character(len=*), parameter :: no_load = "no nominal load of this mesh"
   character(len=*), parameter :: point_names(5) = ["a", "b", "c", "d", "e"], point_symbols(5) = ["A", "B", "C", "D", "E"]
   character(len=*), parameter :: point_texts(5) = [character(len=40) :: "start of contact", "one base pitch before E", &
                                                                          "pitch point", "one base pitch after A", "end of contact"]

   !> A row of the sheet.
   type :: sheet_row_t
      character(len=32) :: section = "", key = "", symbol = "", unit = "" !! unit: UDUNITS; "1" if dimensionless
      character(len=96) :: text = ""
      character(len=160) :: note = ""     !! reason of a NaN, source or assumption; blank if none
      integer :: n = 1                    !! number of values: 2, one per gear; 1, of the mesh
      real(wp) :: value(2) = nan
   end type sheet_row_t

   !> The rows added so far, and the mesh.
   type :: sheet_t
      character(len=32) :: section = ""
      integer :: n = 0
      type(sheet_row_t), allocatable :: rows(:)
   end type sheet_t

contains

   !> Rows of a mesh.
   subroutine datasheet_of(gearbox, mesh, rows)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(sheet_row_t), allocatable, intent(out) :: rows(:)
      type(sheet_t) :: to
      type(path_points_t) :: points

      allocate (to%rows(160))
      associate (contact => gearbox%contacts(gearbox%first(mesh)), pair => gearbox%pairs(mesh))
         associate (a => gearbox%gears(contact%wheel_a), b => gearbox%gears(contact%wheel_b))
            points = path_points_of(pair)
            call add_rack(a, b, to)
            call add_gears(gearbox, mesh, contact, pair, a, b, to)
            call add_inspection([a, b], gearbox%sheet_data([contact%wheel_a, contact%wheel_b]), to)
            call add_tolerances([a, b], gearbox%sheet_data([contact%wheel_a, contact%wheel_b]), to)
            call add_pair(gearbox, mesh, pair, contact, to)
            call add_points(points, to)
            call add_load(gearbox, mesh, contact, pair, points, to)
            call add_stiffness(gearbox, mesh, contact, pair, to)
         end associate
      end associate
      rows = to%rows(:to%n)
   end subroutine datasheet_of

   !> Add a row. Without a reason, a note stands as it is; with one, only if a value is NaN, and the other note only if none is.
   subroutine add(to, key, symbol, unit, text, value, note, reason)
      type(sheet_t), intent(inout) :: to
      character(len=*), intent(in) :: key, symbol, unit, text
      real(wp), intent(in) :: value(:)
      character(len=*), intent(in), optional :: note, reason

      to%n = to%n + 1
      associate (row => to%rows(to%n))
         row%section = to%section
         row%key = key
         row%symbol = symbol
         row%unit = unit
         row%text = text
         row%n = size(value)
         row%value(:size(value)) = value
         if (present(note)) row%note = note
         if (present(reason) .and. any(ieee_is_nan(value))) row%note = reason
      end associate
   end subroutine add

   !> NaN for a gear without rack.
   pure real(wp) function of_rack(gear, value)
      type(gear_t), intent(in) :: gear
      real(wp), intent(in) :: value

      of_rack = merge(value, nan, gear%teeth > 0)
   end function of_rack

   subroutine add_rack(a, b, to)
      type(gear_t), intent(in) :: a, b
      type(sheet_t), intent(inout) :: to

      to%section = "Basic rack"
      call both("normal_module", "m_n", "m", "normal module", a%normal_module, b%normal_module)
      call both("pressure_angle", "alpha_n", "rad", "normal pressure angle", a%pressure_angle, b%pressure_angle)
      call both("rack_addendum", "h_aP*", "1", "addendum, in modules", a%rack_addendum, b%rack_addendum)
      call both("rack_dedendum", "h_fP*", "1", "dedendum, in modules", a%rack_dedendum, b%rack_dedendum)
      call both("rack_root_radius", "rho_fP*", "1", "root fillet radius, in modules", a%rack_root_radius, &
                b%rack_root_radius)

   contains

      subroutine both(key, symbol, unit, text, of_a, of_b)
         character(len=*), intent(in) :: key, symbol, unit, text
         real(wp), intent(in) :: of_a, of_b

         call add(to, key, symbol, unit, text, [of_rack(a, of_a), of_rack(b, of_b)], reason=no_rack)
      end subroutine both

   end subroutine add_rack

   subroutine add_gears(gearbox, mesh, contact, pair, a, b, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(tooth_contact_t), intent(in) :: contact
      type(spur_pair_t), intent(in) :: pair
      type(gear_t), intent(in) :: a, b
      type(sheet_t), intent(inout) :: to

      to%section = "Gears"
      call add(to, "teeth", "z", "1", "number of teeth", real([pair%teeth_a, pair%teeth_b], wp))
      call both("profile_shift", "x", "1", "profile shift coefficient", a%profile_shift, b%profile_shift)
      call both("generating_shift", "x_E", "1", "generating profile shift coefficient", a%generating_shift, b%generating_shift)
      call both("undercut_shift", "x_Emin", "1", "undercut limit of the generating shift", a%undercut_shift, b%undercut_shift)
      call both("thickness_allowance", "A_sn", "m", "tooth thickness allowance", a%thickness_allowance, b%thickness_allowance)
      call both("tip_alteration", "k", "1", "tip alteration coefficient", a%tip_alteration, b%tip_alteration)
      call both("reference_diameter", "d", "m", "reference diameter", 2*a%reference_radius, 2*b%reference_radius)
      call add(to, "base_diameter", "d_b", "m", "base diameter", 2*[pair%base_radius_a, pair%base_radius_b])
      call add(to, "pitch_diameter", "d_w", "m", "working pitch diameter", 2*[pair%pitch_radius_a, pair%pitch_radius_b])
      call add(to, "tip_diameter", "d_a", "m", "tip diameter", 2*[pair%tip_radius_a, pair%tip_radius_b], &
               note=merge("                      ", "at the end of the path", a%teeth > 0))
      call both("tip_form_diameter", "d_Fa", "m", "tip form diameter", 2*a%tip_form_radius, 2*b%tip_form_radius)
      call both("root_diameter", "d_f", "m", "root diameter, as generated", 2*a%root_radius, 2*b%root_radius)
      call both("form_diameter", "d_Ff", "m", "root form diameter", 2*a%form_radius, 2*b%form_radius)
      call add(to, "active_diameter", "d_Nf", "m", "start of active profile", &
               2*[hypot(pair%base_radius_a, pair%rho_start_a), hypot(pair%base_radius_b, pair%rho - pair%rho_tip_a)])
      call both("tooth_depth", "h", "m", "tooth depth", a%tooth_depth, b%tooth_depth)
      call both("tooth_thickness", "s_n", "m", "tooth thickness, reference circle", a%thickness, b%thickness)
      call both("tip_thickness", "s_an", "m", "tooth thickness, tip circle", a%tip_thickness, b%tip_thickness)
      call both("tip_thickness_modules", "s_an/m_n", "1", "tip thickness in modules", in_modules(a, a%tip_thickness), &
                in_modules(b, b%tip_thickness))
      call both("tip_clearance", "c", "m", "tip clearance at the root", gearbox%gear_meshes(mesh)%clearance_a, &
                gearbox%gear_meshes(mesh)%clearance_b)
      call both("tip_clearance_modules", "c*", "1", "the same in modules", in_modules(a, gearbox%gear_meshes(mesh)%clearance_a), &
                in_modules(b, gearbox%gear_meshes(mesh)%clearance_b))
      call both("bore", "d_i", "m", "bore", 2*a%bore_radius, 2*b%bore_radius)
      call add(to, "face_width", "b", "m", "face width", gearbox%sheet_data([contact%wheel_a, contact%wheel_b])%width)

   contains

      subroutine both(key, symbol, unit, text, of_a, of_b)
         character(len=*), intent(in) :: key, symbol, unit, text
         real(wp), intent(in) :: of_a, of_b

         call add(to, key, symbol, unit, text, [of_rack(a, of_a), of_rack(b, of_b)], reason=no_rack)
      end subroutine both

   end subroutine add_gears

   pure real(wp) function in_modules(gear, length)
      type(gear_t), intent(in) :: gear
      real(wp), intent(in) :: length

      in_modules = nan
      if (gear%teeth > 0) in_modules = length/gear%normal_module
   end function in_modules

   !> Base tangent length and dimension over balls, of the teeth with their allowance.
   subroutine add_inspection(gears, data, to)
      type(gear_t), intent(in) :: gears(2)
      type(sheet_data_t), intent(in) :: data(2)
      type(sheet_t), intent(inout) :: to
      real(wp), dimension(2) :: k, span, ball, over
      integer :: i, validity
      character(len=*), parameter :: actual = "of the teeth with their thickness allowance"
      character(len=160) :: span_note, ball_note

      k = nan
      span = nan
      ball = nan
      over = nan
      span_note = ""
      ball_note = ""
      do i = 1, 2
         if (gears(i)%teeth == 0) then
            call join(span_note, i, no_rack)
            call join(ball_note, i, no_rack)
            cycle
         end if
         k(i) = data(i)%span_teeth
         if (data(i)%span_teeth == 0) k(i) = span_teeth(gears(i))
         call span_measure(gears(i), nint(k(i)), span(i), validity)
         if (validity /= measure_valid) call join(span_note, i, "k "//trim(why_not(validity))//"; give span_teeth")
         ball(i) = data(i)%ball_diameter
         if (.not. data(i)%ball_diameter > 0) ball(i) = ball_diameter(gears(i))
         call ball_measure(gears(i), ball(i), over(i), validity)
         if (validity /= measure_valid) call join(ball_note, i, "D_M "//trim(why_not(validity))//"; give ball_diameter")
      end do
      if (all(gears%teeth == 0)) then
         span_note = no_rack
         ball_note = no_rack
      end if
      to%section = "Inspection"
      call add(to, "span_teeth", "k", "1", "teeth of the base tangent length", k, reason=no_rack)
      call add(to, "base_tangent_length", "W_k", "m", "base tangent length", span, note=actual, reason=trim(span_note))
      call add(to, "ball_diameter", "D_M", "m", "diameter of the measuring balls", ball, reason=no_rack)
      call add(to, "dimension_over_balls", "M_dK", "m", "dimension over balls", over, note=actual, &
               reason=trim(ball_note))
   end subroutine add_inspection

   !> Append a reason of one gear.
   subroutine join(note, side, reason)
      character(len=160), intent(inout) :: note
      integer, intent(in) :: side
      character(len=*), intent(in) :: reason

      if (len_trim(note) > 0) note = trim(note)//"; "
      note = trim(note)//" "//trim(merge("driving", "driven ", side == 1))//": "//reason
      note = adjustl(note)
   end subroutine join

   !> Why a measure does not exist.
   pure character(len=40) function why_not(validity) result(reason)
      integer, intent(in) :: validity

      select case (validity)
      case (measure_below)
         reason = "touches below the form circle"
      case (measure_above)
         reason = "touches above the tip form circle"
      case (measure_in_space)
         reason = "does not reach the tip circle"
      case (measure_in_root)
         reason = "touches the root circle"
      case default
         reason = ""
      end select
   end function why_not

   !> Tolerances of the flank tolerance classes; no rows if no gear has one.
   subroutine add_tolerances(gears, data, to)
      type(gear_t), intent(in) :: gears(2)
      type(sheet_data_t), intent(in) :: data(2)
      type(sheet_t), intent(inout) :: to
      character(len=*), parameter :: reason = "no tolerance class, or outside the limits of the standard"
      type(flank_tolerances_t) :: t(2)
      real(wp) :: classes(2)
      integer :: i

      if (all(data%tolerance_class == 0)) return
      classes = merge(real(data%tolerance_class, wp), nan, data%tolerance_class > 0)
      do i = 1, 2
         if (data(i)%tolerance_class > 0) &
            t(i) = flank_tolerances_of(int(gears(i)%teeth), gears(i)%normal_module, data(i)%width, data(i)%tolerance_class)
      end do
      to%section = "Tolerances, ISO 1328-1:2013"
      call add(to, "tolerance_class", "A", "1", "flank tolerance class", classes, reason=reason)
      call add(to, "single_pitch_tolerance", "f_pT", "m", "single pitch", t%single_pitch, reason=reason)
      call add(to, "total_pitch_tolerance", "F_pT", "m", "total cumulative pitch", t%total_pitch, reason=reason)
      call add(to, "profile_slope_tolerance", "f_HalphaT", "m", "profile slope", t%profile_slope, reason=reason)
      call add(to, "profile_form_tolerance", "f_falphaT", "m", "profile form", t%profile_form, reason=reason)
      call add(to, "total_profile_tolerance", "F_alphaT", "m", "total profile", t%total_profile, reason=reason)
      call add(to, "helix_slope_tolerance", "f_HbetaT", "m", "helix slope", t%helix_slope, reason=reason)
      call add(to, "helix_form_tolerance", "f_fbetaT", "m", "helix form", t%helix_form, reason=reason)
      call add(to, "total_helix_tolerance", "F_betaT", "m", "total helix", t%total_helix, reason=reason)
   end subroutine add_tolerances

   subroutine add_pair(gearbox, mesh, pair, contact, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(spur_pair_t), intent(in) :: pair
      type(tooth_contact_t), intent(in) :: contact
      type(sheet_t), intent(inout) :: to
      character(len=*), parameter :: one_flank = "no coast flanks: give the mesh a backlash"
      real(wp) :: pitch_point, backlash

      to%section = "Mesh"
      pitch_point = pair%base_radius_a*tan(pair%alpha_w)
      call add(to, "gear_ratio", "z_2/z_1", "1", "gear ratio, driven over driving", [pair%ratio])
      call add(to, "centre_distance", "a_w", "m", "centre distance", [pair%centre_distance])
      associate (g => gearbox%gear_meshes(mesh))
         call add(to, "reference_centre_distance", "a", "m", "reference centre distance", &
                  [merge(g%reference_distance, nan, g%exists)], reason=no_rack)
      end associate
      call add(to, "working_pressure_angle", "alpha_wt", "rad", "working pressure angle", [pair%alpha_w])
      call add(to, "base_pitch", "p_bt", "m", "transverse base pitch", [pair%base_pitch])
      call add(to, "line_of_action", "T1T2", "m", "length of the line of action", [pair%rho])
      call add(to, "path_of_contact", "g_alpha", "m", "length of the path of contact", [pair%rho_tip_a - pair%rho_start_a])
      call add(to, "approach", "g_f", "m", "approach path", [pitch_point - pair%rho_start_a])
      call add(to, "recess", "g_a", "m", "recess path", [pair%rho_tip_a - pitch_point])
      call add(to, "contact_ratio", "eps_alpha", "1", "transverse contact ratio", [pair%contact_ratio])
      call add(to, "common_width", "b", "m", "common face width", [contact%width])
      backlash = merge(pair%backlash, nan, pair%has_coast)
      call add(to, "normal_backlash", "j_bn", "m", "normal backlash", [backlash], reason=one_flank)
      call add(to, "circumferential_backlash", "j_wt", "m", "circumferential backlash", [backlash/cos(pair%alpha_w)], &
               reason=one_flank)
      call add(to, "radial_backlash", "j_r", "m", "radial backlash", [backlash/(2*sin(pair%alpha_w))], reason=one_flank)
   end subroutine add_pair

   !> Why a point of the path of contact does not exist.
   function no_point(i) result(reason)
      integer, intent(in) :: i
      character(len=64) :: reason

      reason = "contact ratio below 1"
      if (i == point_c) reason = "the pitch point is not on the path of contact"
   end function no_point

   subroutine add_points(points, to)
      type(path_points_t), intent(in) :: points
      type(sheet_t), intent(inout) :: to
      character(len=64) :: reason
      integer :: i

      to%section = "Path of contact"
      do i = 1, 5
         call add(to, "diameter_"//point_names(i), "d_"//point_symbols(i), "m", &
                  "diameter at "//point_symbols(i)//", "//trim(point_texts(i)), 2*points%radius(:, i), reason=no_point(i))
      end do
      do i = 1, 5
         call add(to, "curvature_"//point_names(i), "rho_"//point_symbols(i), "m", "radius of curvature at "//point_symbols(i), &
                  points%rho(:, i), reason=no_point(i))
      end do
      do i = 1, 5
         reason = no_point(i)
         if (.not. ieee_is_nan(points%rho(1, i))) reason = "the path ends on a base circle, where it is infinite"
         call add(to, "sliding_"//point_names(i), "zeta_"//point_symbols(i), "1", "specific sliding at "//point_symbols(i), &
                  points%sliding(:, i), reason=reason)
      end do
   end subroutine add_points

   !> Nominal load and Hertz pressure, and the tooth loss factor.
   subroutine add_load(gearbox, mesh, contact, pair, points, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(tooth_contact_t), intent(in) :: contact
      type(spur_pair_t), intent(in) :: pair
      type(path_points_t), intent(in) :: points
      type(sheet_t), intent(inout) :: to
      character(len=:), allocatable :: note, reason
      real(wp) :: force, line_load, pressures(5)
      integer :: i

      force = abs(gearbox%nominal%force(mesh))
      if (.not. force > 0) force = nan
      line_load = force/contact%width
      note = ""
      if (gearbox%nominal%force(mesh) < 0) note = "on the coast flanks"
      to%section = "Nominal load"
      call add(to, "torque", "T", "N m", "torque of the mesh", force*[pair%base_radius_a, pair%base_radius_b], &
               note=note, reason=no_load)
      call add(to, "speed", "n", "rad/s", "speed", abs(gearbox%wheels([contact%wheel_a, contact%wheel_b])%ratio &
                                                       *gearbox%nominal%speed))
      call add(to, "normal_force", "F_bt", "N", "normal force", [force], note=note, reason=no_load)
      call add(to, "line_load", "F_bt/b", "N/m", "normal force per common width", [line_load], reason=no_load)
      if (gearbox%gear_meshes(mesh)%exists) then
         call add(to, "tangential_force", "F_t", "N", "tangential force, reference circle", &
                  [tangential(gearbox, contact, pair, force)], reason=no_load)
      else
         call add(to, "tangential_force", "F_t", "N", "tangential force, reference circle", [nan], reason=no_rack)
      end if
      to%section = "Hertz pressure"
      pressures = nominal_pressures(points, pair, line_load, contact%e_star)
      do i = 1, 5
         reason = no_point(i)
         if (.not. ieee_is_nan(points%rho(1, i))) reason = "the path ends on a base circle, where it is infinite"
         if (ieee_is_nan(force)) reason = no_load
         call add(to, "pressure_"//point_names(i), "p_H"//point_symbols(i), "Pa", "nominal Hertz pressure at "//point_symbols(i), &
                  [pressures(i)], note=share_note(points%share(i)), reason=reason)
      end do
      to%section = "Losses"
      call add(to, "tooth_loss_factor", "H_V", "1", "tooth loss factor", &
               [tooth_loss_factor(pair)], note="Ohlendorf, equal shares in double contact", &
               reason="for contact ratios from 1 to 2 with the pitch point on the path")
   end subroutine add_load

   !> Number of pairs that share the load.
   pure character(len=24) function share_note(share) result(note)
      real(wp), intent(in) :: share
      character(len=8) :: text

      note = "single contact"
      if (.not. share < 1) return
      write (text, "(i0)") nint(1/share)
      note = "load share 1/"//trim(text)
   end function share_note

   !> F_t on the reference circle of the driving gear [N].
   pure real(wp) function tangential(gearbox, contact, pair, force)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      type(spur_pair_t), intent(in) :: pair
      real(wp), intent(in) :: force

      tangential = force*pair%base_radius_a/gearbox%gears(contact%wheel_a)%reference_radius
   end function tangential

   !> Stiffness by ISO 6336-1 and by finite elements, resonance speeds and K_V.
   subroutine add_stiffness(gearbox, mesh, contact, pair, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(tooth_contact_t), intent(in) :: contact
      type(spur_pair_t), intent(in) :: pair
      type(sheet_t), intent(inout) :: to
      character(len=*), parameter :: iso = "ISO 6336-1:2006, method B"
      character(len=*), parameter :: rigid = "the gears have no compliance"
      type(mesh_stiffness_t) :: elastic
      character(len=:), allocatable :: reason
      real(wp) :: line_load, c, c_gamma, speed, iso_speed, case_speed, masses(2), radii(2)
      integer :: i, wheels(2)

      wheels = [contact%wheel_a, contact%wheel_b]
      line_load = abs(gearbox%nominal%force(mesh))/contact%width
      c = nan
      reason = no_load
      if (.not. gearbox%gear_meshes(mesh)%exists) then
         reason = no_rack
      else if (line_load > 0) then
         c = iso_stiffness(gearbox, mesh, line_load)
      end if
      c_gamma = c*mesh_stiffness_factor(pair%contact_ratio)
      to%section = "Stiffness per width"
      call add(to, "single_stiffness_iso", "c'", "Pa", "single stiffness", [c], note=iso//", solid wheels", reason=reason)
      call add(to, "mesh_stiffness_iso", "c_gamma", "Pa", "mesh stiffness", [c_gamma], note=iso//", solid wheels", reason=reason)
      call mesh_stiffness(gearbox, mesh, elastic)
      call add(to, "single_stiffness", "", "Pa", "one tooth pair at the pitch point", [present_value(elastic%single_pair)], &
               note="of the case's compliance, body included", reason=rigid)
      if (elastic%single_pair > 0) &
         call add(to, "double_stiffness", "", "Pa", "two pairs, half a base pitch beside it", &
                  [present_value(elastic%double_pair)], note="of the case's compliance, body included", &
                  reason="the path of contact is too short for two pairs")
      to%section = "Dynamics"
      if (count_meshes(gearbox, wheels(1)) > 1 .or. count_meshes(gearbox, wheels(2)) > 1) then
         reason = "a wheel of this mesh has several meshes"
         c_gamma = nan
      end if
      iso_speed = nan
      case_speed = nan
      if (.not. ieee_is_nan(c_gamma)) then
         do i = 1, 2
            masses(i) = disc_inertia(gearbox%gears(wheels(i)), gearbox%sheet_data(wheels(i)), contact%width)
         end do
         radii = [pair%base_radius_a, pair%base_radius_b]
         iso_speed = resonance_speed(c_gamma*contact%width, reduced_mass(masses, radii), pair%teeth_a)
         case_speed = resonance_speed(c_gamma*contact%width, reduced_mass(gearbox%wheels(wheels)%inertia, radii), pair%teeth_a)
      end if
      call add(to, "resonance_speed_iso", "n_E1", "rad/s", "resonance speed of the driving gear", [iso_speed], &
               note=iso//", c_gamma and discs of (d_a + d_f)/2 with bores, d_f from x", reason=reason)
      call add(to, "resonance_speed_case", "n_E1", "rad/s", "the same with the inertia of the case", [case_speed], &
               note="c_gamma of ISO 6336-1, inertia of the case", reason=reason)
      speed = abs(gearbox%wheels(wheels(1))%ratio*gearbox%nominal%speed)
      if (.not. speed > 0) then
         if (.not. ieee_is_nan(c_gamma)) reason = "no nominal speed"
         speed = nan
      end if
      if (.not. pair%contact_ratio > 1) then
         if (.not. ieee_is_nan(c_gamma)) reason = "contact ratio not above 1"
         speed = nan
      end if
      call add(to, "resonance_ratio", "N", "1", "speed over resonance speed", [speed/iso_speed], &
               note=iso//", ISO (d_a + d_f)/2 inertia", reason=reason)
      call add_dynamic_factors(gearbox, contact, pair, c, line_load, speed/iso_speed, reason, to)
   end subroutine add_stiffness

   !> K_V without deviations, and with those of the tolerance classes. Equation DS14.
   subroutine add_dynamic_factors(gearbox, contact, pair, c, line_load, ratio, reason, to)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      type(spur_pair_t), intent(in) :: pair
      real(wp), intent(in) :: c         !! c' [Pa]
      real(wp), intent(in) :: line_load !! [N/m]
      real(wp), intent(in) :: ratio     !! N; NaN: not applicable
      character(len=*), intent(in) :: reason
      type(sheet_t), intent(inout) :: to
      character(len=*), parameter :: without = "ISO 6336-1:2006, method B, f = 0, C_a = 0, ISO (d_a + d_f)/2 inertia"
      character(len=*), parameter :: with = "ISO 6336-1:2006, method B, ISO 1328-1:2013 classes (the standard refers to" &
                                     //" ISO 1328-1:1995), without running-in"
      type(flank_tolerances_t) :: t(2)
      real(wp) :: load, factor, b_k, relief(2)
      integer :: i, wheels(2), classes(2)

      wheels = [contact%wheel_a, contact%wheel_b]
      factor = nan
      load = nan
      if (.not. ieee_is_nan(ratio)) then
         load = tangential(gearbox, contact, pair, line_load)
         factor = dynamic_factor(ratio, load, pair%contact_ratio, 0.0_wp, 0.0_wp, 1.0_wp)
      end if
      call add(to, "dynamic_factor", "K_V", "1", "dynamic factor without deviations", [factor], note=without, reason=reason)
      classes = gearbox%sheet_data(wheels)%tolerance_class
      if (any(classes == 0)) return
      do i = 1, 2
         t(i) = flank_tolerances_of(int(gearbox%gears(wheels(i))%teeth), gearbox%gears(wheels(i))%normal_module, &
                                    gearbox%sheet_data(wheels(i))%width, classes(i))
         relief(i) = gearbox%wheels(wheels(i))%deviation%tip%amount
      end do
      factor = nan
      if (maxval(classes) <= 5 .and. abs(relief(1) - relief(2)) > 0) then
         call add(to, "dynamic_factor_of_class", "K_V", "1", "dynamic factor with tolerances", [factor], &
                  reason="the tip reliefs of the two gears differ")
         return
      end if
      if (.not. ieee_is_nan(ratio)) then
         b_k = 1
         if (maxval(classes) <= 5) b_k = abs(1 - c*relief(1)/load)
         factor = dynamic_factor(ratio, load, pair%contact_ratio, &
                                 c*maxval(t%single_pitch)*cos(gearbox%gears(wheels(1))%pressure_angle)/load, &
                                 c*maxval(t%profile_form)/load, b_k)
      end if
      call add(to, "dynamic_factor_of_class", "K_V", "1", "dynamic factor with tolerances", [factor], &
               note=with, reason=reason)
   end subroutine add_dynamic_factors

   !> Inertia of a disc of the diameter (d_a + d_f)/2 with the bore, d_f without allowance [kg m2]. Equation DS12.
   pure real(wp) function disc_inertia(gear, data, width)
      type(gear_t), intent(in) :: gear
      type(sheet_data_t), intent(in) :: data
      real(wp), intent(in) :: width !! [m]

      associate (root => gear%reference_radius - gear%normal_module*(gear%rack_dedendum - gear%profile_shift))
         disc_inertia = data%density*width*pi/2*(((gear%tip_radius + root)/2)**4 - gear%bore_radius**4)
      end associate
   end function disc_inertia

   !> Number of meshes of a wheel.
   pure integer function count_meshes(gearbox, wheel)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: wheel
      integer :: i

      count_meshes = 0
      do i = 1, size(gearbox%pairs)
         associate (contact => gearbox%contacts(gearbox%first(i)))
            if (contact%wheel_a == wheel .or. contact%wheel_b == wheel) count_meshes = count_meshes + 1
         end associate
      end do
   end function count_meshes

   !> NaN for 0, which stands for a value that does not exist.
   elemental real(wp) function present_value(value)
      real(wp), intent(in) :: value

      present_value = merge(value, nan, value > 0)
   end function present_value

end module evl_datasheet
