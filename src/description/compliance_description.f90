!> Case parameters of the compliance of a wheel, and the compliance computed from them.
module evl_compliance_description
   use evl_analytic_compliance, only: analytic_samples, is_in_range, ring_range, root_range
   use evl_gear, only: gear_t, gear_tip_angle, gear_tip_curvature
   use evl_influence_functions, only: influence_t, n_own
   use evl_influence_store, only: influence_by_store, influence_store_t
   use evl_kinds, only: wp
   use evl_parameter_view, only: parameter_view_t
   use evl_plane_element, only: elasticity_t, plane_strain, plane_stress
use evl_row, only: not_negative, positive, range_t, row_t, span_t, type_at_knots, type_choice, type_integer, type_knots, type_number
   use evl_sector_mesh, only: depth_of_rings, least_ring
   use evl_status, only: code_invalid_input, degrees, fail, has_failed, quantity, status_t, subject_wheel, warn
   use evl_tooth_outline, only: outline_of_gear, tooth_outline_t
   use evl_wheel_compliance, only: compliance_from_influence, compliance_from_samples, compliance_from_table, wheel_compliance_t
   implicit none (type, external)
   private

   public :: compliance_create, find_hub

   real(wp), parameter :: thinnest_tip = 0.1_wp    !! [modules]
   real(wp), parameter :: shortest_flank = 0.3_wp  !! arc of the involute [modules]

   type(row_t), parameter, public :: &
      compliance_rows(*) = [ &
      row_t("model", type_choice, "", &
            "finite elements of the whole wheel; formulas of one tooth on a ring; a table; none: only the contact is compliant", &
            default="finite_elements", words="finite_elements analytic table none"), &
      row_t("hub_diameter", type_number, "m", &
            "diameter at which the wheel is held, solid from there to its teeth; otherwise its bore", range=positive, &
            variants="finite_elements analytic", plausible=span_t(1.0e-5_wp, 5.0_wp)), &
      row_t("state", type_choice, "", "plane strain for wide teeth, plane stress for a width of less than 2 modules", &
            default="plane_strain", words="plane_strain plane_stress", variants="finite_elements analytic"), &
      row_t("order", type_integer, "", "order of the elements; 8 gives c to 5e-5/E", range=range_t(4.0_wp, 16.0_wp), default="8", &
            variants="finite_elements"), &
      row_t("rho", type_knots, "m", "radii of curvature of the flank, strictly increasing, at least two", required=.true., &
            variants="table", plausible=span_t(0.0_wp, 2.5_wp)), &
      row_t("c", type_at_knots, "1/Pa", "c there: displacement of the loaded flank per line load, less that of Johnson's" &
            //" cylinder", &
            required=.true., variants="table", plausible=span_t(0.0_wp, 1.0e-7_wp)), &
      row_t("c_1", type_at_knots, "1/Pa", &
            "c_1 there: displacement of the flank next to one that is loaded at the same rho; otherwise no coupling", &
            range=not_negative, variants="table", plausible=span_t(0.0_wp, 1.0e-7_wp))]

contains

   !> Compliance of a wheel; a rigid one if the case has no `compliance`.
   !>
   !> Errors: code_invalid_input with subject_wheel, without index; those of the store.
   subroutine compliance_create(wheel, material, gear, store, compliance, warnings, status)
      type(parameter_view_t), intent(in) :: wheel, material
      type(gear_t), intent(in) :: gear
      class(influence_store_t), intent(inout) :: store !! cache of computed influence data
      type(wheel_compliance_t), intent(out) :: compliance
      type(status_t), allocatable, intent(inout) :: warnings(:) !! new warnings are appended
      type(status_t), intent(inout) :: status
      type(parameter_view_t) :: input, rack
      type(tooth_outline_t) :: outline
      type(elasticity_t) :: law
      type(influence_t) :: influence
      real(wp) :: hub, e, rho(0:n_own), c(0:n_own)

      if (.not. wheel%has("compliance")) return
      call wheel%inner("compliance", input)
      e = material%number("youngs_modulus")
      law = plane_strain(material%number("poisson_ratio"))
      if (input%word("state") == "plane_stress") law = plane_stress(material%number("poisson_ratio"))
      select case (input%word("model"))
      case ("none")
         return
      case ("table")
         call compliance_from_table(input%numbers("rho"), input%numbers("c"), input%numbers("c_1"), compliance)
         return
      end select
      call find_hub(input, gear, hub, status)
      if (.not. has_failed(status)) call check_tooth(gear, status)
      if (has_failed(status)) return
      call wheel%inner("rack", rack)
      outline = outline_of_gear(gear, rack%number("root_radius"))
      associate (m => gear%normal_module)
         if (input%word("model") == "analytic") then
            call analytic_samples(outline, hub/m, law, rho, c)
            call compliance_from_samples(m*rho, c/e, compliance)
            call warn_of_formulas(outline, hub/m, warnings)
         else
            call influence_by_store(store, outline, hub/m, input%whole("order"), law, influence, status)
            if (.not. has_failed(status)) call compliance_from_influence(influence, m, e, compliance)
         end if
      end associate
   end subroutine compliance_create

   !> Radius at which the wheel is fixed: between its bore and the material below the teeth.
   subroutine find_hub(input, gear, hub, status)
      type(parameter_view_t), intent(in) :: input
      type(gear_t), intent(in) :: gear
      real(wp), intent(out) :: hub !! radius [m]
      type(status_t), intent(inout) :: status
      real(wp) :: largest

      hub = gear%bore_radius
      if (input%has("hub_diameter")) hub = input%number("hub_diameter")/2
      largest = gear%root_radius - (depth_of_rings + least_ring)*gear%normal_module
      if (.not. hub > 0) then
         call refuse("a solid wheel without fixed hub has no compliance; give a hub_diameter, where it is held, or a bore", &
                     "compliance.hub_diameter", status)
      else if (hub < gear%bore_radius) then
         call refuse("hub_diameter "//quantity(2*hub, "m")//" is less than the bore of "//quantity(2*gear%bore_radius, "m") &
                     //"; give at least that", "compliance.hub_diameter", status)
      else if (.not. hub < largest) then
         call refuse("the wheel is held at a" &
                     //" diameter of "//quantity(2*hub, "m")//", too close to the root circle; give a hub_diameter of" &
                     //" less than "//quantity(2*largest, "m")//", 1.2 modules under it", &
                     "compliance.hub_diameter", status)
      end if
   end subroutine find_hub

   !> Reject teeth that neither the finite element mesh nor the formulas cover.
   subroutine check_tooth(gear, status)
      type(gear_t), intent(in) :: gear
      type(status_t), intent(inout) :: status
      real(wp) :: rho_form, arc, least, thickness

      associate (m => gear%normal_module)
         rho_form = sqrt((gear%form_radius - gear%base_radius)*(gear%form_radius + gear%base_radius))
         arc = (gear_tip_curvature(gear)**2 - rho_form**2)/(2*gear%base_radius)
         thickness = 2*gear%tip_radius*gear_tip_angle(gear)
         if (gear%is_undercut) then
            least = gear%undercut_shift - gear%generating_shift + gear%profile_shift
            call refuse("the teeth are undercut, which models finite_elements and analytic do not support; give a" &
                        //" profile_shift of at least "//quantity(least, "")//", or a table", "compliance.model", status)
         else if (thickness < thinnest_tip*m) then
            call refuse("the teeth are "//quantity(thickness, "m")//" thick at the tip, less than 0.1 modules; give a smaller" &
                        //" tip diameter, profile shift or tip_rounding, or a table", "compliance.model", &
                        status)
         else if (arc < shortest_flank*m) then
            call refuse("the involute is only "//quantity(arc, "m")//" long, less than 0.3 modules; give a table", &
                        "compliance.model", status)
         end if
      end associate
   end subroutine check_tooth

   !> Warn of effects that the formulas neglect, and of use outside their fitted range.
   subroutine warn_of_formulas(outline, hub, warnings)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: hub !! radius [modules]
      type(status_t), allocatable, intent(inout) :: warnings(:)
      real(wp) :: ratio

      call warn(warnings, "model analytic neglects that two loaded pairs share the wheel's body, so the mesh is 14 to 38 %" &
                //" too stiff; finite_elements includes this", subject_wheel, field="compliance.model")
      if (is_in_range(outline, hub)) return
      ratio = outline%root_radius/hub
      call warn(warnings, "model analytic is used outside the range of its fit: root over hub radius "//quantity(ratio, "") &
                //" of "//quantity(ring_range(1), "")//" to "//quantity(ring_range(2), "")//", half angle of the root " &
                //degrees(outline%root_angle)//" of "//degrees(root_range(1))//" to "//degrees(root_range(2)), subject_wheel, &
                field="compliance.model")
   end subroutine warn_of_formulas

   !> Report an invalid parameter of a wheel.
   subroutine refuse(message, field, status)
      character(len=*), intent(in) :: message, field
      type(status_t), intent(inout) :: status

      call fail(status, code_invalid_input, message, subject_wheel, field=field)
   end subroutine refuse

end module evl_compliance_description
