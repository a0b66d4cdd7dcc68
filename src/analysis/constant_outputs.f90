!> Constant outputs of wheels and meshes, evaluated when the gearbox is created.
module evl_constant_outputs
   use evl_flank_deviation, only: relief_t
   use evl_gear, only: gear_t
   use evl_gearbox, only: gearbox_t, wheel_t
   use evl_kinds, only: nan, pi, wp
   use evl_mesh_geometry, only: spur_pair_t
   use evl_mesh_reference, only: mesh_reference_t
   use evl_output, only: dims_mesh, dims_wheel, in_mesh_constants, in_mesh_teeth, in_wheel_constants, in_wheel_teeth
   use evl_output_registry, only: add_components, add_output, begin_section, registry_t, stores
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: add_mesh_constants, add_wheel_constants
   public :: active_radius, add_mesh_teeth, add_wheel_teeth

contains

   subroutine add_wheel_constants(registry, index, wheel)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      type(wheel_t), intent(in) :: wheel

      call begin_section(registry, in_wheel_constants, dims_wheel, index, is_static=.true.)
      call add_output(registry, "teeth", "1", "z", "number of teeth; negative for an internal gear, as its radii", &
                      merge(-wheel%teeth, wheel%teeth, wheel%base_radius < 0))
      call add_output(registry, "pitch_radius", "m", "r", "pitch radius; reference radius of a gear with a" &
                      //" module", wheel%pitch_radius)
      call add_output(registry, "base_radius", "m", "r_b", "base radius; NaN for a wheel without mesh", known(wheel%base_radius))
      call add_output(registry, "tip_radius", "m", "r_a", "tip radius; NaN for a wheel without mesh", known(wheel%tip_radius))
      call add_output(registry, "mass", "kg", "m", "mass of the wheel", wheel%mass)
      call add_output(registry, "inertia", "kg m2", "J", "moment of inertia about the axle", wheel%inertia)
      call add_components(registry, "centre", "m", "O", "reference position of the axle", wheel%centre)
   end subroutine add_wheel_constants

   subroutine add_mesh_constants(registry, index, contact, couples, pair, at)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      type(tooth_contact_t), intent(in) :: contact !! first contact of the mesh
      logical, intent(in) :: couples               !! the compliance of its tooth pairs is coupled
      type(spur_pair_t), intent(in) :: pair
      type(mesh_reference_t), intent(in) :: at     !! at the nominal load

      call begin_section(registry, in_mesh_constants, dims_mesh, index, is_static=.true.)
      call add_output(registry, "driving_wheel", "1", "", "index of the driving wheel, from 0", contact%wheel_a - 1)
      call add_output(registry, "driven_wheel", "1", "", "index of the driven wheel, from 0", contact%wheel_b - 1)
      call add_output(registry, "flank", "1", "sigma", "+1: driving wheel nominally clockwise, -1: counterclockwise;" &
                      //" reversed if it is internal", pair%sigma)
      call add_output(registry, "tracking", "1", "", "contact tracking: 0 closed form, 1 algebraic, 2 differential", &
                      contact%tracking)
      call add_output(registry, "centre_line_angle", "rad", "chi", "direction from the driving to the driven axle", pair%chi)
      call add_output(registry, "working_pressure_angle", "rad", "alpha_w", "working pressure angle", pair%alpha_w)
      call add_output(registry, "base_pitch", "m", "p_b", "base pitch", contact%base_pitch)
      call add_output(registry, "line_of_action_length", "m", "rho", "length of the line of action between the base circles", &
                      contact%pair%rho_0)
      call add_output(registry, "rho_start_driving", "m", "rho_A", &
                      "radius of curvature of the driving flank at the start of contact", pair%rho_start_a)
      call add_output(registry, "rho_start_driven", "m", "rho_B", &
                      "radius of curvature of the driven flank at the start of contact", pair%rho_start_b)
      call add_output(registry, "common_width", "m", "b", "common face width", contact%width)
      call add_output(registry, "effective_modulus", "Pa", "E_star", "effective modulus of elasticity", contact%e_star)
      call add_output(registry, "elastic_share_driving", "1", "w_A", "share of the driving wheel in the elastic compliance", &
                      contact%pair%share_a)
      call add_output(registry, "reference_force", "N", "F_0", "normal force at the nominal operating point", contact%force_scale)
      call add_output(registry, "reference_penetration", "m", "h_0", "penetration under the reference force", contact%h_scale)
      call add_output(registry, "rigid_contact", "1", "", "1 if the contact is rigid: a constraint without penetration", &
                      contact%rigid)
      call add_output(registry, "tooth_coupling", "1", "", "1 if tooth pairs deflect under each other's loads, else 0", couples)
      call add_output(registry, "reference_stiffness", "N m-1", "k", "stiffness of one tooth pair under the reference force", &
                      at%stiffness)
      call add_output(registry, "reference_mass", "kg", "m", "mass of the two wheels along the line of action", at%mass)
      call add_output(registry, "natural_frequency", "Hz", "f_0", "natural frequency of the mesh with one tooth pair in contact", &
                      at%frequency)
      call add_output(registry, "damping_coefficient", "N s m-1", "c", "coefficient of the damper of one tooth pair", at%damping)
      call add_output(registry, "damping_ratio", "1", "zeta", "damping ratio of the mesh with one tooth pair in contact", at%ratio)
   end subroutine add_mesh_constants

   !> Constants of the teeth of a wheel.
   subroutine add_wheel_teeth(registry, index, wheel, gear, active)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      type(wheel_t), intent(in) :: wheel
      type(gear_t), intent(in) :: gear !! initial values if the wheel has no basic rack
      real(wp), intent(in) :: active   !! its active radius [m]

      call begin_section(registry, in_wheel_teeth, dims_wheel, index, is_static=.true.)
      call add_output(registry, "root_radius", "m", "r_f", "root radius; NaN if unknown", known(gear%root_radius))
      call add_output(registry, "form_radius", "m", "r_Ff", "radius where the involute begins; NaN if unknown", &
                      known(gear%form_radius))
      call add_output(registry, "tip_rounding", "m", "r_t", "radius of the arcs that round the tips; 0: sharp edges", &
                      gear%tip_rounding)
      call add_output(registry, "active_radius", "m", "r_Nf", &
                      "radius where the active profile begins, the smallest over its meshes; NaN without a mesh", active)
      call add_output(registry, "tooth_angle", "rad", "psi", "angle of a tooth on the base circle; NaN if unknown", &
                      known(gear%tooth_angle))
      associate (tip => wheel%deviation%tip, root => wheel%deviation%root)
         call add_output(registry, "tip_relief", "m", "C_a", "tip relief at the tip circle", max(tip%amount, 0.0_wp))
         call add_output(registry, "tip_relief_start", "m", "", "radius where tip relief begins; NaN without", &
                         relief_start(wheel, tip))
         call add_output(registry, "tip_relief_power", "1", "", "1 linear, 2 parabolic tip relief; 0 without", relief_power(tip))
         call add_output(registry, "root_relief", "m", "C_f", "root relief at the start of the active profile", &
                         max(root%amount, 0.0_wp))
         call add_output(registry, "root_relief_start", "m", "", "radius where root relief begins; NaN without", &
                         relief_start(wheel, root))
         call add_output(registry, "root_relief_power", "1", "", "1 linear, 2 parabolic root relief; 0 without", relief_power(root))
      end associate
      call add_output(registry, "profile_crowning", "m", "C_alpha", "crowning at both ends of the active profile", &
                      wheel%deviation%crowning)
   end subroutine add_wheel_teeth

   !> Length or angle of a gear; NaN if 0, which means unknown.
   pure real(wp) function known(value)
      real(wp), intent(in) :: value

      known = merge(value, nan, abs(value) > 0)
   end function known

   !> Constants of the teeth of a mesh.
   subroutine add_mesh_teeth(registry, index, contact, pair)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: index
      type(tooth_contact_t), intent(in) :: contact !! first contact of the mesh
      type(spur_pair_t), intent(in) :: pair
      real(wp) :: position, root

      call begin_section(registry, in_mesh_teeth, dims_mesh, index, is_static=.true.)
      call add_output(registry, "contact_ratio", "1", "eps_alpha", "path of contact over base pitch", pair%contact_ratio)
      call add_output(registry, "backlash", "m", "j_bn", "normal backlash; NaN without coast flanks", &
                      merge(pair%backlash, nan, pair%has_coast))
      call add_output(registry, "has_coast_flanks", "1", "", "1 if the flanks on the other side of the teeth can touch, else 0", &
                      pair%has_coast)
      root = 0
      if (stores(registry)) root = pair%chi + pair%sigma*(pair%alpha_w - contact%rho_start/pair%base_radius_a)
      call add_output(registry, "flank_root_driving", "rad", "phi_A", &
                      "direction in which the driving flank of tooth pair 0 meets the base circle at the start", root)
      if (stores(registry)) root = pair%chi + pair%sigma*(pi + pair%alpha_w - &
                                                          (pair%rho - contact%rho_start - contact%pair%gap_0)/pair%base_radius_b)
      call add_output(registry, "flank_root_driven", "rad", "phi_B", &
                      "direction in which the driven flank of tooth pair 0 meets the base circle at the start", root)
      position = 0
      if (stores(registry)) position = (contact%rho_start - contact%rho_entry)/contact%base_pitch
      call add_output(registry, "start_position", "1", "xi_0", &
                      "pitches of tooth pair 0 from its start of contact where angles are 0", position)
   end subroutine add_mesh_teeth

   !> Radius at the start of the active profile of a wheel, the minimum over its meshes; NaN without a mesh [m].
   pure real(wp) function active_radius(gearbox, wheel) result(smallest)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: wheel
      integer :: m

      smallest = nan
      do m = 1, size(gearbox%pairs)
         associate (contact => gearbox%contacts(gearbox%first(m)), pair => gearbox%pairs(m))
            if (contact%wheel_a == wheel) &
               call take_smallest(sign(hypot(pair%base_radius_a, pair%rho - pair%rho_tip_b), pair%base_radius_a), smallest)
            if (contact%wheel_b == wheel) &
               call take_smallest(sign(hypot(pair%base_radius_b, pair%rho - pair%rho_tip_a), pair%base_radius_b), smallest)
         end associate
      end do
   end function active_radius

   !> Minimum of two radii, where NaN means none so far.
   pure subroutine take_smallest(value, smallest)
      real(wp), intent(in) :: value
      real(wp), intent(inout) :: smallest

      if (.not. value >= smallest) smallest = value
   end subroutine take_smallest

   !> Radius at the start of a relief; NaN without relief [m].
   pure real(wp) function relief_start(wheel, relief) result(radius)
      type(wheel_t), intent(in) :: wheel
      type(relief_t), intent(in) :: relief

      radius = nan
      if (relief%amount > 0) radius = sign(hypot(wheel%base_radius, relief%border), wheel%base_radius)
   end function relief_start

   !> 1 linear, 2 parabolic, 0 without a relief.
   pure integer function relief_power(relief) result(power)
      type(relief_t), intent(in) :: relief

      power = 0
      if (relief%amount > 0) power = merge(2, 1, relief%parabolic)
   end function relief_power

end module evl_constant_outputs
