!> Derived geometry of a description, as rows for display: name, unit, symbol, text, value.
module evl_derived_geometry
   use, intrinsic :: iso_c_binding, only: c_double
   use evl_gear, only: gear_t, signed_teeth
   use evl_gearbox, only: gearbox_t
   use evl_gears_in_mesh, only: gear_mesh_t
   use evl_indices, only: indices
   use evl_kinds, only: nan, pi, wp
   use evl_mesh_geometry, only: spur_pair_t
   use evl_mesh_reference, only: mesh_reference_t
   use evl_mesh_root_stress, only: mesh_root_stress, mesh_root_t
   use evl_mesh_stiffness, only: mesh_stiffness, mesh_stiffness_t
   use evl_output, only: output_t
   use evl_output_registry, only: add_components, add_output, registry_t, take_rows
   use evl_path_points, only: tooth_loss_factor
   use evl_pitch_errors, only: single_pitch_deviation, total_pitch_deviation
   use evl_row, only: kind_t
   use evl_tooth_contact, only: tooth_contact_t, tracking_closed_form
   implicit none (type, external)
   private

   public :: gear_mesh_quantities, gear_quantities, quantities_of
   public :: of_compliance, of_deviation, of_gear, of_gear_mesh, of_mesh, of_root_stress, of_wheel
   public :: pitch_errors_of

   integer, parameter :: of_wheel = 0     !! a wheel
   integer, parameter :: of_mesh = 1      !! a mesh
   integer, parameter :: of_gear = 2      !! a gear defined by a basic rack, ISO 21771
   integer, parameter :: of_gear_mesh = 3 !! a mesh of two such gears
   integer, parameter :: of_deviation = 4 !! flank deviations of a wheel
   integer, parameter :: of_compliance = 5 !! compliance of the gears of a mesh, and the resulting stiffness
   integer, parameter :: of_root_stress = 6 !! root stress of a wheel in a mesh; index: 2 mesh - 1 driving, 2 mesh driven wheel

contains

   !> Rows of a wheel or mesh; none if it is not of that kind.
   subroutine quantities_of(gearbox, of, index, table)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: of, index
      type(output_t), allocatable, intent(out) :: table(:) !! at most EVL_MOST_QUANTITIES rows
      real(wp) :: loss_factor
      type(registry_t) :: to

      select case (of)
      case (of_wheel)
         call add_wheel(gearbox, index, to)
      case (of_mesh)
         call add_mesh(gearbox%contacts(gearbox%first(index)), gearbox%pairs(index), gearbox%nominal%force(index), &
                       gearbox%references(index), to)
         call add_output(to, "gives_way", "1", "", "1: its wheels are compliant, 0: they can have a compliance", &
                         is_compliant(gearbox, index))
      case (of_gear)
         if (gearbox%gears(index)%teeth > 0) call add_gear(gearbox%gears(index), any(logical(gearbox%gears%is_internal)), to)
      case (of_gear_mesh)
         if (gearbox%gear_meshes(index)%exists) then
            loss_factor = nan ! of a refused case
            if (allocated(gearbox%pairs)) loss_factor = tooth_loss_factor(gearbox%pairs(index))
            call add_gear_mesh(gearbox%gear_meshes(index), loss_factor, to)
         end if
      case (of_deviation)
         if (gearbox%wheels(index)%deviation%exists) call add_deviation(gearbox, index, to)
      case (of_compliance)
         call add_compliance(gearbox, index, to)
      case (of_root_stress)
         call add_root_stress(gearbox, (index + 1)/2, modulo(index, 2) == 0, to)
      end select
      call take_rows(to, table)
      if (of == of_compliance) table = table(indices(abs(table%value(1)) > 0))
   end subroutine quantities_of

   !> Rows of a gear. Those of an empty gear have the same names and texts as those of an external one, which are
   !> the first rows of an internal one.
   subroutine gear_quantities(gear, table)
      type(gear_t), intent(in) :: gear
      type(output_t), allocatable, intent(out) :: table(:)
      type(registry_t) :: to

      call add_gear(gear, logical(gear%is_internal), to)
      call take_rows(to, table)
   end subroutine gear_quantities

   !> Rows of a mesh of two gears.
   subroutine gear_mesh_quantities(mesh, loss_factor, table)
      type(gear_mesh_t), intent(in) :: mesh
      real(wp), intent(in) :: loss_factor !! H_V
      type(output_t), allocatable, intent(out) :: table(:)
      type(registry_t) :: to

      call add_gear_mesh(mesh, loss_factor, to)
      call take_rows(to, table)
   end subroutine gear_mesh_quantities

   subroutine add_wheel(gearbox, index, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      type(registry_t), intent(inout) :: to

      associate (wheel => gearbox%wheels(index))
         if (wheel%has_radius) call add_output(to, "pitch_radius", "m", "r", &
                                               merge("pitch radius", "radius      ", wheel%teeth > 0), wheel%pitch_radius)
         if (abs(wheel%base_radius) > 0) then
            call add_output(to, "base_radius", "m", "r_b", "base radius", wheel%base_radius)
            call add_output(to, "tip_radius", "m", "r_a", "tip radius, the largest over its meshes", wheel%tip_radius)
         end if
         if (wheel%teeth > 0) call add_output(to, "angular_pitch", "rad", "gamma", "angular pitch", 2*pi/wheel%teeth)
         call add_output(to, "mass", "kg", "m", "mass of the wheel", wheel%mass)
         call add_output(to, "inertia", "kg m2", "J", "moment of inertia about the axle", wheel%inertia)
         call add_components(to, "centre", "m", "O", "reference position of the axle", wheel%centre)
         call add_output(to, "speed_ratio", "1", "g", "nominal speed over that of the reference wheel", wheel%ratio)
         call add_output(to, "nominal_speed", "rad/s", "", "speed at the nominal operating point, counterclockwise positive", &
                         wheel%ratio*gearbox%nominal%speed)
      end associate
   end subroutine add_wheel

   subroutine add_mesh(contact, pair, nominal_force, at, to)
      type(tooth_contact_t), intent(in) :: contact !! first contact of the mesh
      type(spur_pair_t), intent(in) :: pair
      real(wp), intent(in) :: nominal_force        !! [N]
      type(mesh_reference_t), intent(in) :: at     !! at the nominal load
      type(registry_t), intent(inout) :: to

      call add_output(to, "flank", "1", "sigma", "+1: the driving wheel turns clockwise, -1: counterclockwise", &
                      merge(-pair%sigma, pair%sigma, pair%base_radius_a < 0))
      call add_output(to, "transmission_ratio", "1", "n", "teeth of the driven over the driving wheel", pair%ratio)
      call add_output(to, "centre_distance", "m", "d", "distance of the axles; below 0: internal pair", pair%centre_distance)
      call add_output(to, "centre_line_angle", "rad", "chi", "direction from the driving to the driven axle", &
                      merge(pair%chi - pi, pair%chi, pair%centre_distance < 0))
      call add_output(to, "minimum_pressure_angle", "rad", "alpha_inf", "least working pressure angle", pair%alpha_inf)
      call add_output(to, "working_pressure_angle", "rad", "alpha_w", "working pressure angle", pair%alpha_w)
      call add_output(to, "base_pitch", "m", "p_b", "base pitch", pair%base_pitch)
      call add_output(to, "contact_ratio", "1", "epsilon_alpha", "transverse contact ratio", pair%contact_ratio)
      call add_output(to, "line_of_action_length", "m", "rho", "length |K_A K_B| of the line of action", pair%rho)
      call add_components(to, "point_k_a", "m", "K_A", "line of action at the driving wheel's base circle", pair%point_k_a)
      call add_components(to, "point_k_b", "m", "K_B", "line of action at the driven wheel's base circle", pair%point_k_b)
      call add_components(to, "point_a", "m", "a", "nominal start of contact", pair%point_a)
      call add_components(to, "point_b", "m", "b", "nominal end of contact", pair%point_b)
      call add_components(to, "pitch_point", "m", "C", "pitch point", pair%pitch_point)
      call add_output(to, "tip_radius_driving", "m", "r_aA", "tip radius of the driving wheel", pair%tip_radius_a)
      call add_output(to, "tip_radius_driven", "m", "r_aB", "tip radius of the driven wheel", pair%tip_radius_b)
      call add_output(to, "rho_start_driving", "m", "rho_A", "radius of curvature of the driving flank at a", pair%rho_start_a)
      call add_output(to, "rho_start_driven", "m", "rho_B", "radius of curvature of the driven flank at a", pair%rho_start_b)
      call add_output(to, "common_width", "m", "b", "common face width", contact%width)
      call add_output(to, "effective_modulus", "Pa", "E*", "effective modulus of elasticity", contact%e_star)
      call add_output(to, "elastic_share_driving", "1", "w_A", "share of the driving wheel in the compliance", contact%pair%share_a)
      call add_output(to, "nominal_force", "N", "F_N", "normal force at the nominal operating point; below 0 on the coast flanks", &
                      nominal_force)
      call add_output(to, "reference_force", "N", "F_0", "its magnitude; for an unloaded mesh that of the others", &
                      contact%force_scale)
      call add_output(to, "reference_penetration", "m", "h_0", "its penetration", contact%h_scale)
      call add_output(to, "reference_stiffness", "N/m", "k", "stiffness of one tooth pair there", at%stiffness)
      call add_output(to, "reference_mass", "kg", "m", "mass of the wheels along the line of action", at%mass)
      call add_output(to, "natural_frequency", "Hz", "f_0", "natural frequency with one tooth pair", at%frequency)
      call add_output(to, "damping_coefficient", "N s/m", "c", "coefficient of its damper", at%damping)
      call add_output(to, "damping_ratio", "1", "zeta", "damping ratio with one tooth pair", at%ratio)
      if (at%friction > 0) call add_output(to, "friction_coefficient", "1", "mu_m", &
                                           "coefficient of friction of the nominal operating point", at%friction)
   end subroutine add_mesh

   !> 1 if a wheel of the mesh is compliant; 0 if none is although the contact would support it; else NaN.
   real(wp) function is_compliant(gearbox, index)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      type(kind_t) :: law

      is_compliant = nan
      associate (contact => gearbox%contacts(gearbox%first(index)))
         call contact%elastic%describe(law)
         if (law%name /= "johnson" .or. contact%tracking /= tracking_closed_form) return
         associate (mesh => gearbox%gear_meshes(index)) ! undercut in the active profile excludes compliance
            if (.not. mesh%exists .or. mesh%centre_distance < 0) return
            if (mesh%rho_end_a < mesh%rho_tip_a .or. mesh%rho_end_b < mesh%rho_tip_b) return
         end associate
         is_compliant = merge(1, 0, gearbox%flanks(contact%i_flank)%flank%bends)
      end associate
   end function is_compliant

   !> Rows of a gear; in a gearbox with internal gears all gears have the same rows.
   subroutine add_gear(g, with_internal, to)
      type(gear_t), intent(in) :: g
      logical, intent(in) :: with_internal
      type(registry_t), intent(inout) :: to

      call add_output(to, "teeth", "1", "z", "number of teeth", signed_teeth(g))
      call add_output(to, "normal_module", "m", "m_n", "normal module", g%normal_module)
      call add_output(to, "pressure_angle", "rad", "alpha_n", "normal pressure angle", g%pressure_angle)
      call add_output(to, "profile_shift", "1", "x", "profile shift coefficient", g%profile_shift)
      call add_output(to, "generating_shift", "1", "x_E", "generating profile shift coefficient", g%generating_shift)
      call add_output(to, "undercut_shift", "1", "x_Emin", "undercut limit of the generating shift", external(g%undercut_shift))
      call add_output(to, "tip_alteration", "1", "k", "tip alteration coefficient", g%tip_alteration)
      call add_output(to, "reference_diameter", "m", "d", "reference diameter", 2*g%reference_radius)
      call add_output(to, "base_diameter", "m", "d_b", "base diameter", 2*g%base_radius)
      call add_output(to, "tip_diameter", "m", "d_a", "tip diameter", 2*g%tip_radius)
      call add_output(to, "tip_form_diameter", "m", "d_Fa", "tip form diameter", 2*g%tip_form_radius)
      call add_output(to, "tip_rounding", "m", "r_t", "rounding of the tip", g%tip_rounding)
      call add_output(to, "root_diameter", "m", "d_f", "root diameter", 2*g%root_radius)
      call add_output(to, "form_diameter", "m", "d_Ff", "root form diameter", 2*g%form_radius)
      call add_output(to, "bore", "m", "d_i", "bore", external(2*g%bore_radius))
      call add_output(to, "tooth_depth", "m", "h", "tooth depth", g%tooth_depth)
      call add_output(to, "pitch", "m", "p_n", "normal pitch", g%pitch)
      call add_output(to, "base_pitch", "m", "p_bt", "transverse base pitch", g%base_pitch)
      call add_output(to, "thickness", "m", "s_n", "tooth thickness, reference circle", g%thickness)
      call add_output(to, "thickness_allowance", "m", "A_sn", "tooth thickness allowance", g%thickness_allowance)
      call add_output(to, "tip_thickness", "m", "s_an", "tooth thickness, tip circle", g%tip_thickness)
      call add_output(to, "tooth_angle", "rad", "psi_b", "angle of a tooth, base circle", g%tooth_angle)
      if (.not. with_internal) return
      call add_output(to, "fillet_radius", "m", "", "radius of the fillet arc", internal(g%fillet_radius))
      call add_output(to, "rim_diameter", "m", "", "rim diameter", internal(2*g%rim_radius))

   contains

      !> A number of external gears only; of an internal one NaN.
      pure real(wp) function external(value)
         real(c_double), intent(in) :: value

         external = merge(nan, real(value, wp), logical(g%is_internal))
      end function external

      !> A number of internal gears only; of others, or if it is 0 because unknown, NaN.
      pure real(wp) function internal(value)
         real(c_double), intent(in) :: value

         internal = merge(real(value, wp), nan, g%is_internal .and. abs(value) > 0)
      end function internal

   end subroutine add_gear

   subroutine add_gear_mesh(g, loss_factor, to)
      type(gear_mesh_t), intent(in) :: g
      real(wp), intent(in) :: loss_factor
      type(registry_t), intent(inout) :: to

      call add_output(to, "centre_distance", "m", "a_w", "centre distance", g%centre_distance)
      call add_output(to, "reference_centre_distance", "m", "a", "reference centre distance", g%reference_distance)
      call add_output(to, "tight_centre_distance", "m", "", "zero-backlash centre distance", g%tight_distance)
      call add_output(to, "working_pressure_angle", "rad", "alpha_wt", "working pressure angle", g%working_pressure_angle)
      call add_output(to, "pitch_diameter_driving", "m", "d_w1", "working pitch diameter, driving", 2*g%pitch_radius_a)
      call add_output(to, "pitch_diameter_driven", "m", "d_w2", "working pitch diameter, driven", 2*g%pitch_radius_b)
      call add_output(to, "active_diameter_driving", "m", "d_Nf1", "start of active profile, driving", 2*g%active_radius_a)
      call add_output(to, "active_diameter_driven", "m", "d_Nf2", "start of active profile, driven", 2*g%active_radius_b)
      call add_output(to, "line_of_action", "m", "T1T2", "length of the line of action", g%line_of_action)
      call add_output(to, "path_of_contact", "m", "g_alpha", "length of path of contact", g%path_of_contact)
      call add_output(to, "approach", "m", "g_f", "length of approach path", g%approach)
      call add_output(to, "recess", "m", "g_a", "length of recess path", g%recess)
      call add_output(to, "base_pitch", "m", "p_bt", "transverse base pitch", g%base_pitch)
      call add_output(to, "contact_ratio", "1", "eps_alpha", "transverse contact ratio", g%contact_ratio)
      call add_output(to, "loss_factor", "1", "H_V", "loss factor, equal load shares", loss_factor)
      call add_output(to, "tip_clearance_driving", "m", "c_1", "tip clearance at the root, driving", g%clearance_a)
      call add_output(to, "tip_clearance_driven", "m", "c_2", "tip clearance at the root, driven", g%clearance_b)
      call add_output(to, "backlash", "m", "j_bn", "normal backlash", g%backlash)
      call add_output(to, "circumferential_backlash", "m", "j_wt", "circumferential backlash", g%circumferential_backlash)
      call add_output(to, "radial_backlash", "m", "j_r", "radial backlash", g%radial_backlash)
   end subroutine add_gear_mesh

   !> Starts of reliefs and magnitudes of pitch errors; no rows for deviations that the wheel does not have.
   subroutine add_deviation(gearbox, index, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      type(registry_t), intent(inout) :: to
      real(wp) :: to_arc

      associate (d => gearbox%wheels(index)%deviation, r_b => gearbox%wheels(index)%base_radius)
         call add_output(to, "profile_start_diameter", "m", "d_Nf", "start of the modified active profile", &
                         sign(2*hypot(d%middle - d%half_length, r_b), r_b))
         call add_output(to, "profile_tip_diameter", "m", "d_a", "its end", sign(2*hypot(d%middle + d%half_length, r_b), r_b))
         if (d%tip%amount > 0) then
            call add_output(to, "tip_relief_diameter", "m", "", "start of tip relief", sign(2*hypot(d%tip%border, r_b), r_b))
            call add_output(to, "tip_relief_roll_angle", "rad", "", "its roll angle", d%tip%border/r_b)
         end if
         if (d%root%amount > 0) then
            call add_output(to, "root_relief_diameter", "m", "", "start of root relief", sign(2*hypot(d%root%border, r_b), r_b))
            call add_output(to, "root_relief_roll_angle", "rad", "", "its roll angle", d%root%border/r_b)
         end if
         if (.not. has_pitch_errors(gearbox, index)) return
         to_arc = abs(gearbox%gears(index)%reference_radius)/r_b
         call add_output(to, "single_pitch_deviation", "m", "f_p", "largest single pitch deviation", &
                         single_pitch_deviation(d%pitch)*to_arc)
         call add_output(to, "total_pitch_deviation", "m", "F_p", "total cumulative pitch deviation", &
                         total_pitch_deviation(d%pitch)*to_arc)
      end associate
   end subroutine add_deviation

   !> Compliances and stiffnesses of a mesh, per unit width; no rows if its gears are rigid.
   subroutine add_compliance(gearbox, index, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      type(registry_t), intent(inout) :: to
      type(mesh_stiffness_t) :: s

      call mesh_stiffness(gearbox, index, s)
      if (.not. s%line_load > 0) return
      call add_output(to, "driving_at_start", "1/Pa", "c_A", "driving wheel, flank at the start of the path", s%driving(1))
      call add_output(to, "driving_at_pitch_point", "1/Pa", "c_A", "at the pitch point", s%driving(2))
      call add_output(to, "driving_at_end", "1/Pa", "c_A", "at the end", s%driving(3))
      call add_output(to, "driving_next", "1/Pa", "c_A1", "the adjacent flank under a load there", s%next_driving)
      call add_output(to, "driven_at_start", "1/Pa", "c_B", "driven wheel, flank at the start of the path", s%driven(1))
      call add_output(to, "driven_at_pitch_point", "1/Pa", "c_B", "at the pitch point", s%driven(2))
      call add_output(to, "driven_at_end", "1/Pa", "c_B", "at the end", s%driven(3))
      call add_output(to, "driven_next", "1/Pa", "c_B1", "the adjacent flank under a load there", s%next_driven)
      call add_output(to, "line_load", "N/m", "w", "line load of the stiffnesses", s%line_load)
      call add_output(to, "single_pair", "Pa", "", "stiffness of one tooth pair, at the pitch point", s%single_pair)
      call add_output(to, "double_pair", "Pa", "", "of two pairs, half a base pitch before and after it", s%double_pair)
      call add_output(to, "iso_6336", "Pa", "c'", "ISO 6336-1 (pairs without body, not comparable)", s%iso)
   end subroutine add_compliance

   !> Root stress at the outer point of single contact; no rows if the wheel has none.
   subroutine add_root_stress(gearbox, mesh, is_driven, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      logical, intent(in) :: is_driven
      type(registry_t), intent(inout) :: to
      type(mesh_root_t) :: s

      call mesh_root_stress(gearbox, mesh, is_driven, s)
      if (.not. s%exists) return
      call add_output(to, "line_load", "N/m", "w", "nominal line load", s%line_load)
      call add_output(to, "load_position", "m", "rho", "radius of curvature, outer point of single contact", s%rho)
      call add_output(to, "form_factor", "1", "Y_F", "form factor, ISO 6336-3", unless_missing(s%nominal%form_factor, s%rho))
      call add_output(to, "stress_correction_factor", "1", "Y_S", "stress correction factor, ISO 6336-3", &
                      unless_missing(s%nominal%stress_correction, s%rho))
      call add_output(to, "notch_parameter", "1", "q_s", "notch parameter; Y_S is valid from 1 to 8", &
                      unless_missing(s%nominal%notch_parameter, s%rho))
      call add_output(to, "nominal_coefficient", "1", "", "Y_F Y_S cos(alpha) = m sigma_F0/w", s%nominal_coefficient)
      call add_output(to, "nominal_stress", "Pa", "sigma_F0", "nominal root stress, ISO 6336-3", s%nominal_stress)
      call add_output(to, "tension_coefficient", "1", "Sigma_F", "finite elements, largest m sigma/w", s%tension_coefficient)
      call add_output(to, "tension", "Pa", "sigma_F", "finite elements, largest stress", s%tension)
      call add_output(to, "compression_coefficient", "1", "Sigma_F-", "finite elements, least m sigma/w", &
                      s%compression_coefficient)
      call add_output(to, "compression", "Pa", "sigma_F-", "finite elements, least stress", s%compression)
   end subroutine add_root_stress

   !> A value, or NaN without its prerequisite.
   pure real(wp) function unless_missing(value, prerequisite)
      real(wp), intent(in) :: value, prerequisite

      unless_missing = value
      if (.not. prerequisite > 0) unless_missing = nan
   end function unless_missing

   !> Whether a wheel has pitch errors.
   logical function has_pitch_errors(gearbox, index)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index

      has_pitch_errors = .false.
      associate (d => gearbox%wheels(index)%deviation)
         if (d%exists .and. allocated(d%pitch)) has_pitch_errors = total_pitch_deviation(d%pitch) > 0
      end associate
   end function has_pitch_errors

   !> Cumulative pitch deviations of a wheel's teeth, arcs on the reference circle [m]; size 0 if it has no pitch errors.
   subroutine pitch_errors_of(gearbox, index, errors)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(out), allocatable :: errors(:)

      if (has_pitch_errors(gearbox, index)) then
         errors = gearbox%wheels(index)%deviation%pitch*(abs(gearbox%gears(index)%reference_radius) &
                                                         /gearbox%wheels(index)%base_radius)
      else
         allocate (errors(0))
      end if
   end subroutine pitch_errors_of

end module evl_derived_geometry
