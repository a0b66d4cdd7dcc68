!> Stiffness, resonance speed and dynamic factor of a data sheet, by ISO 6336-1 and with the case's compliance and inertia.
module evl_datasheet_dynamics
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use evl_datasheet_inspection, only: tolerances_of
   use evl_datasheet_rows, only: add_row, no_load, no_rack, sheet_t
   use evl_dynamic_factor, only: dynamic_factor, mesh_stiffness_factor, reduced_mass, resonance_speed
   use evl_flank_tolerances, only: flank_tolerances_t
   use evl_gear, only: gear_t
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: nan, pi, wp
   use evl_mesh_stiffness, only: iso_stiffness, mesh_stiffness, mesh_stiffness_t, reference_circle_load
   implicit none (type, external)
   private

   public :: add_stiffness

   ! Range of steels: E/(1 - nu^2), 206 GPa and 0.3 give 226 GPa, and density
   real(wp), parameter :: steel_modulus(2) = [2.0e11_wp, 2.5e11_wp]  !! [Pa]
   real(wp), parameter :: steel_density(2) = [7.4e3_wp, 8.2e3_wp]    !! [kg/m^3]

contains

   !> Stiffness by ISO 6336-1 and by the case's compliance, then resonance speeds and K_V.
   subroutine add_stiffness(gearbox, mesh, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(sheet_t), intent(inout) :: to
      character(len=*), parameter :: solid = "ISO 6336-1:2006, method B, solid wheels"
      character(len=*), parameter :: body = "of the case's compliance, body included"
      character(len=*), parameter :: rigid = "the gears have no compliance"
      type(mesh_stiffness_t) :: elastic
      character(len=64) :: reason
      real(wp) :: line_load, c

      line_load = abs(gearbox%nominal%force(mesh))/gearbox%contacts(gearbox%first(mesh))%width
      c = nan
      reason = no_load
      if (.not. gearbox%gear_meshes(mesh)%exists) then
         reason = no_rack
      else if (line_load > 0) then
         c = iso_stiffness(gearbox, mesh, line_load)
         reason = "an internal gear"
      end if
      to%section = "Stiffness per width"
      call add_row(to, "single_stiffness_iso", "c'", "Pa", "single stiffness", [c], note=solid, reason=reason)
      call add_row(to, "mesh_stiffness_iso", "c_gamma", "Pa", "mesh stiffness", &
                   [c*mesh_stiffness_factor(gearbox%pairs(mesh)%contact_ratio)], note=solid, reason=reason)
      call mesh_stiffness(gearbox, mesh, elastic)
      call add_row(to, "single_stiffness", "", "Pa", "one tooth pair at the pitch point", [present_value(elastic%single_pair)], &
                   note=body, reason=rigid)
      if (elastic%single_pair > 0) &
         call add_row(to, "double_stiffness", "", "Pa", "two pairs, half a base pitch before and after it", &
                      [present_value(elastic%double_pair)], note=body, &
                      reason="the path of contact is too short for two pairs")
      to%section = "Dynamics"
      call add_resonance(gearbox, mesh, c, reason, to)
   end subroutine add_stiffness

   !> Resonance speed by ISO 6336-1, and its ratio to the speed.
   subroutine add_resonance(gearbox, mesh, c, no_stiffness, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp), intent(in) :: c !! c'; NaN: not applicable [Pa]
      character(len=*), intent(in) :: no_stiffness !! reason of this NaN
      type(sheet_t), intent(inout) :: to
      character(len=*), parameter :: iso = "ISO 6336-1:2006, method B"
      character(len=64) :: reason
      real(wp) :: speed, iso_speed, case_speed, stiffness, radii(2)
      integer :: wheels(2)

      associate (contact => gearbox%contacts(gearbox%first(mesh)), pair => gearbox%pairs(mesh))
         wheels = [contact%wheel_a, contact%wheel_b]
         radii = [pair%base_radius_a, pair%base_radius_b]
         stiffness = c*mesh_stiffness_factor(pair%contact_ratio)*contact%width
         reason = no_stiffness
         if (max(count_meshes(gearbox, wheels(1)), count_meshes(gearbox, wheels(2))) > 1) then
            if (.not. ieee_is_nan(c)) reason = "a wheel of this mesh has several meshes"
            stiffness = nan
         end if
         iso_speed = nan
         case_speed = nan
         if (.not. ieee_is_nan(stiffness)) then
            iso_speed = resonance_speed(stiffness, reduced_mass(disc_inertia(gearbox, wheels, contact%width), radii), pair%teeth_a)
            case_speed = resonance_speed(stiffness, reduced_mass(gearbox%wheels(wheels)%inertia, radii), pair%teeth_a)
         end if
         call add_row(to, "resonance_speed_iso", "n_E1", "rad/s", "resonance speed of the driving gear", [iso_speed], &
                      note=iso//", c_gamma and discs of (d_a + d_f)/2 with bores, d_f from x", reason=reason)
         call add_row(to, "resonance_speed_case", "n_E1", "rad/s", "the same with the inertia of the case", [case_speed], &
                      note="c_gamma of ISO 6336-1, inertia of the case", reason=reason)
         speed = abs(gearbox%wheels(wheels(1))%ratio*gearbox%nominal%speed)
         if (.not. speed > 0) then
            if (.not. ieee_is_nan(stiffness)) reason = "no nominal speed"
            speed = nan
         end if
         if (.not. pair%contact_ratio > 1) then
            if (.not. ieee_is_nan(stiffness)) reason = "contact ratio not above 1"
            speed = nan
         end if
      end associate
      call add_row(to, "resonance_ratio", "N", "1", "speed over resonance speed", [speed/iso_speed], &
                   note=iso//", ISO (d_a + d_f)/2 inertia", reason=reason)
      if (.not. ieee_is_nan(speed/iso_speed) .and. .not. are_steel(gearbox, mesh)) then
         speed = nan
         reason = "method B for gears of steel; E or density of a gear differs"
      end if
      call add_dynamic_factors(gearbox, mesh, c, speed/iso_speed, reason, to)
   end subroutine add_resonance

   !> K_V without deviations, and with those of the tolerance classes. Equation DS14.
   subroutine add_dynamic_factors(gearbox, mesh, c, ratio, reason, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp), intent(in) :: c         !! c' [Pa]
      real(wp), intent(in) :: ratio     !! N; NaN: not applicable
      character(len=*), intent(in) :: reason !! of this NaN
      type(sheet_t), intent(inout) :: to
      character(len=*), parameter :: without = "ISO 6336-1:2006, method B, f = 0, C_a = 0, ISO (d_a + d_f)/2 inertia"
      character(len=*), parameter :: with = "ISO 6336-1:2006, method B, ISO 1328-1:2013 classes (the standard refers to" &
                                     //" ISO 1328-1:1995), without running-in"
      type(flank_tolerances_t) :: t(2)
      real(wp) :: load, contact_ratio, factor, b_k, relief(2)
      integer :: wheels(2), classes(2)
      logical :: is_defined

      is_defined = .not. ieee_is_nan(ratio)
      factor = nan
      load = nan
      contact_ratio = gearbox%pairs(mesh)%contact_ratio
      associate (contact => gearbox%contacts(gearbox%first(mesh)))
         wheels = [contact%wheel_a, contact%wheel_b]
         if (is_defined) load = reference_circle_load(gearbox, mesh, abs(gearbox%nominal%force(mesh))/contact%width)
      end associate
      if (is_defined) factor = dynamic_factor(ratio, load, contact_ratio, 0.0_wp, 0.0_wp, 1.0_wp)
      call add_row(to, "dynamic_factor", "K_V", "1", "dynamic factor without deviations", [factor], note=without, reason=reason)
      classes = gearbox%wheels(wheels)%tolerance_class
      if (any(classes == 0)) return
      factor = nan
      relief = gearbox%wheels(wheels)%deviation%tip%amount
      if (maxval(classes) <= 5 .and. abs(relief(1) - relief(2)) > 0) then
         call add_row(to, "dynamic_factor_of_class", "K_V", "1", "dynamic factor with tolerances", [factor], &
                      reason="the tip reliefs of the two gears differ")
         return
      end if
      if (is_defined) then
         t = [tolerances_of(gearbox, wheels(1)), tolerances_of(gearbox, wheels(2))]
         b_k = 1
         if (maxval(classes) <= 5) b_k = abs(1 - c*relief(1)/load)
         factor = dynamic_factor(ratio, load, contact_ratio, &
                                 c*maxval(t%single_pitch)*cos(gearbox%gears(wheels(1))%pressure_angle)/load, &
                                 c*maxval(t%profile_form)/load, b_k)
      end if
      call add_row(to, "dynamic_factor_of_class", "K_V", "1", "dynamic factor with tolerances", [factor], &
                   note=with, reason=reason)
   end subroutine add_dynamic_factors

   !> Whether both gears of a mesh are of steel, by their elastic constants and densities.
   pure logical function are_steel(gearbox, mesh)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp) :: modulus(2), density(2) ! E/(1 - nu^2)

      associate (contact => gearbox%contacts(gearbox%first(mesh)))
         modulus = contact%e_star/[contact%pair%share_a, contact%pair%share_b]
         density = gearbox%wheels([contact%wheel_a, contact%wheel_b])%density
      end associate
      are_steel = all(modulus >= steel_modulus(1) .and. modulus <= steel_modulus(2) .and. &
                      density >= steel_density(1) .and. density <= steel_density(2))
   end function are_steel

   !> Inertia of a disc of the diameter (d_a + d_f)/2 with the bore, d_f without allowance [kg m2]. Equation DS12.
   elemental real(wp) function disc_of(gear, density, width) result(inertia)
      type(gear_t), intent(in) :: gear
      real(wp), intent(in) :: density, width !! [kg/m^3], [m]

      associate (root => gear%reference_radius - gear%normal_module*(gear%rack_dedendum - gear%profile_shift))
         inertia = density*width*pi/2*(((gear%tip_radius + root)/2)**4 - gear%bore_radius**4)
      end associate
   end function disc_of

   !> Discs of both wheels with the common width.
   pure function disc_inertia(gearbox, wheels, width) result(inertia)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: wheels(2)
      real(wp), intent(in) :: width !! [m]
      real(wp) :: inertia(2)

      inertia = disc_of(gearbox%gears(wheels), gearbox%wheels(wheels)%density, width)
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

end module evl_datasheet_dynamics
