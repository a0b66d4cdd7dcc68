!> Geometry of a data sheet: basic rack, gears, mesh, points of the path of contact.
!>
!> Quantities that `evl_derived_geometry` lists keep its symbols, units, texts and values.
module evl_datasheet_geometry
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use evl_datasheet_rows, only: add_row, no_rack, sheet_t
   use evl_derived_geometry, only: gear_mesh_quantities, gear_quantities
   use evl_gear, only: gear_t
   use evl_gearbox, only: gearbox_t
   use evl_gears_in_mesh, only: gear_mesh_t
   use evl_kinds, only: nan, wp
   use evl_mesh_geometry, only: spur_pair_t
   use evl_output, only: output_t
   use evl_path_points, only: path_points_t, point_c
   implicit none (type, external)
   private

   public :: add_gears, add_mesh, add_points, add_rack, no_point
   public :: point_names, point_symbols

   character(len=*), parameter :: point_names(5) = ["a", "b", "c", "d", "e"], point_symbols(5) = ["A", "B", "C", "D", "E"]
   character(len=*), parameter :: point_texts(5) = [character(len=40) :: "start of contact", "one base pitch before E", &
                                                                          "pitch point", "one base pitch after A", "end of contact"]

contains

   subroutine add_rack(gears, to)
      type(gear_t), intent(in) :: gears(2)
      type(sheet_t), intent(inout) :: to
      type(output_t), allocatable :: a(:), b(:)

      call gear_quantities(gears(1), a)
      call gear_quantities(gears(2), b)
      to%section = "Basic rack"
      call add_listed(gears, a, b, "normal_module", to)
      call add_listed(gears, a, b, "pressure_angle", to)
      call add_of_racks(gears, "rack_addendum", "h_aP*", "1", "addendum, in modules", real(gears%rack_addendum, wp), to)
      call add_of_racks(gears, "rack_dedendum", "h_fP*", "1", "dedendum, in modules", real(gears%rack_dedendum, wp), to)
      call add_of_racks(gears, "rack_root_radius", "rho_fP*", "1", "root fillet radius, in modules", &
                        real(gears%rack_root_radius, wp), to)
   end subroutine add_rack

   subroutine add_gears(gearbox, mesh, gears, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(gear_t), intent(in) :: gears(2)
      type(sheet_t), intent(inout) :: to
      type(gear_mesh_t) :: g
      type(output_t), allocatable :: a(:), b(:)

      g = geometry_of(gearbox, mesh)
      call gear_quantities(gears(1), a)
      call gear_quantities(gears(2), b)
      to%section = "Gears"
      associate (pair => gearbox%pairs(mesh), contact => gearbox%contacts(gearbox%first(mesh)))
         call add_row(to, "teeth", "z", "1", "number of teeth", &
                      sign(real([pair%teeth_a, pair%teeth_b], wp), [pair%base_radius_a, pair%base_radius_b]))
         call add_listed(gears, a, b, "profile_shift", to)
         call add_listed(gears, a, b, "generating_shift", to)
         call add_listed(gears, a, b, "undercut_shift", to)
         call add_listed(gears, a, b, "thickness_allowance", to)
         call add_listed(gears, a, b, "tip_alteration", to)
         call add_listed(gears, a, b, "reference_diameter", to)
         call add_row(to, "base_diameter", "d_b", "m", "base diameter", 2*[pair%base_radius_a, pair%base_radius_b])
         call add_row(to, "pitch_diameter", "d_w", "m", "working pitch diameter", &
                      2*[real(g%pitch_radius_a, wp), real(g%pitch_radius_b, wp)])
         call add_row(to, "tip_diameter", "d_a", "m", "tip diameter", 2*[pair%tip_radius_a, pair%tip_radius_b], &
                      note=merge("                      ", "at the end of the path", all(gears%teeth > 0)))
         call add_listed(gears, a, b, "tip_form_diameter", to)
         call add_listed(gears, a, b, "root_diameter", to)
         call add_listed(gears, a, b, "form_diameter", to)
         call add_row(to, "active_diameter", "d_Nf", "m", "start of active profile", &
                      2*[real(g%active_radius_a, wp), real(g%active_radius_b, wp)])
         call add_listed(gears, a, b, "tooth_depth", to)
         call add_listed(gears, a, b, "thickness", to)
         call add_listed(gears, a, b, "tip_thickness", to)
         call add_of_racks(gears, "tip_thickness_modules", "s_an/m_n", "1", "tip thickness, in modules", &
                           in_modules(gears, real(gears%tip_thickness, wp)), to)
         call add_of_racks(gears, "tip_clearance", "c", "m", "tip clearance at the root", &
                           [real(g%clearance_a, wp), real(g%clearance_b, wp)], to)
         call add_of_racks(gears, "tip_clearance_modules", "c*", "1", "tip clearance, in modules", &
                           in_modules(gears, [real(g%clearance_a, wp), real(g%clearance_b, wp)]), to)
         call add_listed(gears, a, b, "bore", to)
         call add_row(to, "face_width", "b", "m", "face width", gearbox%wheels([contact%wheel_a, contact%wheel_b])%width)
      end associate
   end subroutine add_gears

   !> Add a row of `gear_quantities` of both gears.
   subroutine add_listed(gears, a, b, name, to)
      type(gear_t), intent(in) :: gears(2)
      type(output_t), intent(in) :: a(:), b(:) !! rows of the gears
      character(len=*), intent(in) :: name
      type(sheet_t), intent(inout) :: to
      integer :: i

      i = findloc(a%name, name, dim=1)
      call add_of_racks(gears, name, trim(a(i)%symbol), trim(a(i)%units), trim(a(i)%long_name), &
                        [a(i)%value(1), b(i)%value(1)], to)
   end subroutine add_listed

   !> Add a row that a gear without basic rack does not have.
   subroutine add_of_racks(gears, key, symbol, unit, text, value, to)
      type(gear_t), intent(in) :: gears(2)
      character(len=*), intent(in) :: key, symbol, unit, text
      real(wp), intent(in) :: value(2)
      type(sheet_t), intent(inout) :: to
      character(len=len(no_rack)), parameter :: internal = "an internal gear"

      call add_row(to, key, symbol, unit, text, merge(value, nan, gears%teeth > 0), &
                   reason=trim(merge(no_rack, internal, any(gears%teeth == 0))))
   end subroutine add_of_racks

   !> A length over the module; NaN for a gear without basic rack.
   elemental real(wp) function in_modules(gear, length)
      type(gear_t), intent(in) :: gear
      real(wp), intent(in) :: length

      in_modules = nan
      if (gear%teeth > 0) in_modules = length/gear%normal_module
   end function in_modules

   subroutine add_mesh(gearbox, mesh, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(sheet_t), intent(inout) :: to
      character(len=*), parameter :: one_flank = "no coast flanks: give the mesh a backlash"
      type(output_t), allocatable :: rows(:)

      call gear_mesh_quantities(geometry_of(gearbox, mesh), nan, rows)
      to%section = "Mesh"
      call add_row(to, "gear_ratio", "z_2/z_1", "1", "gear ratio, driven over driving", [gearbox%pairs(mesh)%ratio])
      call listed("centre_distance")
      call listed("reference_centre_distance", no_rack)
      call listed("working_pressure_angle")
      call listed("base_pitch")
      call listed("line_of_action")
      call listed("path_of_contact")
      call listed("approach")
      call listed("recess")
      call listed("contact_ratio")
      call add_row(to, "common_width", "b", "m", "common face width", [gearbox%contacts(gearbox%first(mesh))%width])
      call listed("backlash", one_flank)
      call listed("circumferential_backlash", one_flank)
      call listed("radial_backlash", one_flank)

   contains

      !> Add a row of `gear_mesh_quantities`.
      subroutine listed(name, reason)
         character(len=*), intent(in) :: name
         character(len=*), intent(in), optional :: reason
         integer :: i

         i = findloc(rows%name, name, dim=1)
         call add_row(to, name, trim(rows(i)%symbol), trim(rows(i)%units), trim(rows(i)%long_name), [rows(i)%value(1)], &
                      reason=reason)
      end subroutine listed

   end subroutine add_mesh

   !> Geometry of a mesh; that of gears without basic rack has NaN where it requires one.
   pure type(gear_mesh_t) function geometry_of(gearbox, mesh) result(g)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp) :: pitch_point

      g = gearbox%gear_meshes(mesh)
      if (g%exists) return
      associate (pair => gearbox%pairs(mesh))
         pitch_point = pair%base_radius_a*tan(pair%alpha_w)
         g%centre_distance = pair%centre_distance
         g%reference_distance = nan
         g%working_pressure_angle = pair%alpha_w
         g%pitch_radius_a = pair%pitch_radius_a
         g%pitch_radius_b = pair%pitch_radius_b
         g%line_of_action = pair%rho
         g%base_pitch = pair%base_pitch
         g%path_of_contact = pair%rho_tip_a - pair%rho_start_a
         g%approach = pitch_point - pair%rho_start_a
         g%recess = pair%rho_tip_a - pitch_point
         g%contact_ratio = pair%contact_ratio
         g%active_radius_a = hypot(pair%base_radius_a, pair%rho_start_a)
         g%active_radius_b = hypot(pair%base_radius_b, pair%rho - pair%rho_tip_a)
         g%clearance_a = nan
         g%clearance_b = nan
         g%backlash = merge(pair%backlash, nan, pair%has_coast)
         g%circumferential_backlash = g%backlash/cos(pair%alpha_w)
         g%radial_backlash = g%circumferential_backlash/(2*tan(pair%alpha_w))
      end associate
   end function geometry_of

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
         call add_row(to, "diameter_"//point_names(i), "d_"//point_symbols(i), "m", &
                      "diameter at "//point_symbols(i)//", "//trim(point_texts(i)), 2*points%radius(:, i), reason=no_point(i))
      end do
      do i = 1, 5
         call add_row(to, "curvature_"//point_names(i), "rho_"//point_symbols(i), "m", &
                      "radius of curvature at "//point_symbols(i), points%rho(:, i), reason=no_point(i))
      end do
      do i = 1, 5
         reason = no_point(i)
         if (.not. ieee_is_nan(points%rho(1, i))) reason = "the path ends on a base circle, where it is infinite"
         call add_row(to, "sliding_"//point_names(i), "zeta_"//point_symbols(i), "1", "specific sliding at "//point_symbols(i), &
                      points%sliding(:, i), reason=reason)
      end do
   end subroutine add_points

end module evl_datasheet_geometry
