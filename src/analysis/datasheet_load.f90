!> Nominal load of a data sheet: forces, Hertz pressure, root stress, tooth loss factor.
!>
!> The force is that of the nominal operating point, without dynamics and uniform over the face width (all factors K are 1), with
!> the geometric load share of the tooth pairs.
module evl_datasheet_load
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use evl_datasheet_geometry, only: no_point, point_names, point_symbols
   use evl_datasheet_rows, only: add_row, no_load, no_rack, note_length, sheet_t
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: nan, wp
   use evl_mesh_root_stress, only: mesh_root_nominal, mesh_root_stress, mesh_root_t
   use evl_mesh_stiffness, only: reference_circle_load
   use evl_path_points, only: nominal_pressures, path_points_t, tooth_loss_factor
   implicit none (type, external)
   private

   character(len=*), parameter :: no_single = "contact ratio of 2 or more: no position with a single pair"

   public :: add_load, add_loss_factor, add_pressures, add_root_stress, sheet_force

contains

   !> Magnitude of the nominal normal force of a mesh; NaN without load [N].
   pure real(wp) function sheet_force(gearbox, mesh) result(force)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh

      force = abs(gearbox%nominal%force(mesh))
      if (.not. force > 0) force = nan
   end function sheet_force

   subroutine add_load(gearbox, mesh, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(sheet_t), intent(inout) :: to
      character(len=:), allocatable :: note
      real(wp) :: force, tangential
      logical :: has_racks

      force = sheet_force(gearbox, mesh)
      note = ""
      if (gearbox%nominal%force(mesh) < 0) note = "on the coast flanks"
      has_racks = gearbox%gear_meshes(mesh)%exists
      tangential = nan
      if (has_racks) tangential = reference_circle_load(gearbox, mesh, force)
      to%section = "Nominal load"
      associate (contact => gearbox%contacts(gearbox%first(mesh)), pair => gearbox%pairs(mesh))
         call add_row(to, "torque", "T", "N m", "torque of the mesh", force*abs([pair%base_radius_a, pair%base_radius_b]), &
                      note=note, reason=no_load)
         call add_row(to, "speed", "n", "rad/s", "speed", abs(gearbox%wheels([contact%wheel_a, contact%wheel_b])%ratio &
                                                              *gearbox%nominal%speed))
         call add_row(to, "normal_force", "F_bt", "N", "normal force", [force], note=note, reason=no_load)
         call add_row(to, "line_load", "F_bt/b", "N/m", "normal force per common width", [force/contact%width], reason=no_load)
         call add_row(to, "tangential_force", "F_t", "N", "tangential force, reference circle", [tangential], &
                      reason=trim(merge(no_load//repeat(" ", len(no_rack) - len(no_load)), no_rack, has_racks)))
      end associate
   end subroutine add_load

   !> Hertz pressure at the points of the path of contact.
   subroutine add_pressures(gearbox, mesh, points, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(path_points_t), intent(in) :: points
      type(sheet_t), intent(inout) :: to
      character(len=64) :: reason
      real(wp) :: line_load, pressures(5)
      integer :: i

      to%section = "Hertz pressure"
      associate (contact => gearbox%contacts(gearbox%first(mesh)), pair => gearbox%pairs(mesh))
         line_load = sheet_force(gearbox, mesh)/contact%width
         pressures = nominal_pressures(points, pair, line_load, contact%e_star)
         do i = 1, 5
            reason = no_point(i)
            if (.not. ieee_is_nan(points%rho(1, i))) reason = "the path ends on a base circle, where it is infinite"
            if (ieee_is_nan(line_load)) reason = no_load
            call add_row(to, "pressure_"//point_names(i), "p_H"//point_symbols(i), "Pa", &
                         "nominal Hertz pressure at "//point_symbols(i), [pressures(i)], note=share_note(points%share(i)), &
                         reason=reason)
         end do
      end associate
   end subroutine add_pressures

   !> Number of pairs that share the load.
   pure character(len=24) function share_note(share) result(note)
      real(wp), intent(in) :: share
      character(len=8) :: text

      note = "single contact"
      if (.not. share < 1) return
      write (text, "(i0)") nint(1/share)
      note = "load share 1/"//trim(text)
   end function share_note

   !> Root stress under a single pair at the outer point of single contact: nominal, and of the finite elements if a gear has them.
   subroutine add_root_stress(gearbox, mesh, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(sheet_t), intent(inout) :: to
      character(len=*), parameter :: load_case = "one pair at the outer point of single contact, uniform over the face width"
      character(len=*), parameter :: iso = "ISO 6336-3:2006, method B, "//load_case, &
                                     elements = "finite elements, "//load_case//", without friction"
      type(mesh_root_t) :: root(2)
      character(len=note_length) :: reason
      real(wp) :: loaded(2)
      integer :: i

      loaded = merge(1.0_wp, nan, sheet_force(gearbox, mesh) > 0)
      do i = 1, 2
         call mesh_root_stress(gearbox, mesh, i == 2, root(i))
         if (.not. root(i)%exists) call mesh_root_nominal(gearbox, mesh, i == 2, root(i))
      end do
      reason = why_no_nominal(gearbox, mesh, root)
      to%section = "Root stress"
      associate (valid => merge(1.0_wp, nan, root%nominal%is_valid))
         call add_row(to, "form_factor", "Y_F", "1", "form factor", root%nominal%form_factor*valid, note=iso, reason=reason)
         call add_row(to, "stress_correction_factor", "Y_S", "1", "stress correction factor", &
                      root%nominal%stress_correction*valid, note=iso, reason=reason)
         if (all(root%nominal%is_valid)) reason = no_load
         call add_row(to, "nominal_stress", "sigma_F0", "Pa", "nominal root stress", root%nominal_stress*valid*loaded, note=iso, &
                      reason=reason)
      end associate
      if (.not. any(root%exists)) return
      reason = no_load
      if (.not. all(root%exists)) reason = "a gear without finite elements"
      if (all(ieee_is_nan(root%rho))) reason = no_single
      call add_row(to, "root_tension", "sigma_F", "Pa", "largest root stress", root%tension*loaded, note=elements, reason=reason)
      call add_row(to, "root_compression", "sigma_F-", "Pa", "least root stress", root%compression*loaded, note=elements, &
                   reason=reason)
   end subroutine add_root_stress

   !> Why a gear has no nominal root stress.
   pure character(len=note_length) function why_no_nominal(gearbox, mesh, root) result(reason)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(mesh_root_t), intent(in) :: root(2)

      associate (contact => gearbox%contacts(gearbox%first(mesh)))
         associate (gears => gearbox%gears([contact%wheel_a, contact%wheel_b]))
            reason = "q_s outside 1 to 8, or no tangent of 30 degrees at the fillet"
            if (any(gears%is_undercut)) reason = "no formula for an undercut gear"
            if (any(gears%is_internal)) reason = "no formula for an internal gear"
            if (all(ieee_is_nan(root%rho))) reason = no_single
            if (any(gears%teeth == 0)) reason = no_rack
         end associate
      end associate
   end function why_no_nominal

   !> Tooth loss factor.
   subroutine add_loss_factor(gearbox, mesh, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(sheet_t), intent(inout) :: to

      to%section = "Losses"
      call add_row(to, "loss_factor", "H_V", "1", "tooth loss factor", [tooth_loss_factor(gearbox%pairs(mesh))], &
                   note="Ohlendorf, equal shares in double contact", &
                   reason="for contact ratios from 1 to 2 with the pitch point on the path")
   end subroutine add_loss_factor

end module evl_datasheet_load
