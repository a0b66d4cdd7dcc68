!> What does not change of wheels and meshes: outputs that are told once, when the gearbox is built.
module evl_constant_outputs
   use evl_gearbox, only: wheel_t
   use evl_mesh_geometry, only: spur_pair_t
   use evl_mesh_reference, only: mesh_reference_t
   use evl_output, only: dims_mesh, dims_wheel, in_mesh_constants, in_wheel_constants
   use evl_teller, only: begin, tell, teller_t
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: tell_mesh_constants, tell_wheel_constants

contains

   subroutine tell_wheel_constants(teller, index, wheel)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      type(wheel_t), intent(in) :: wheel

      call begin(teller, in_wheel_constants, dims_wheel, index, is_static=.true.)
      call tell(teller, "teeth", "1", "z", "number of teeth", wheel%teeth)
      call tell(teller, "pitch_radius", "m", "r", "pitch radius; of a real gear its reference radius", wheel%pitch_radius)
      call tell(teller, "base_radius", "m", "r_b", "base radius", wheel%base_radius)
      call tell(teller, "tip_radius", "m", "r_a", "tip radius", wheel%tip_radius)
      call tell(teller, "mass", "kg", "m", "mass of the wheel", wheel%mass)
      call tell(teller, "inertia", "kg m2", "J", "moment of inertia about the axle", wheel%inertia)
      call tell(teller, "centre", "m", "O", "reference position of the axle", wheel%centre)
   end subroutine tell_wheel_constants

   subroutine tell_mesh_constants(teller, index, contact, pair, at)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      type(tooth_contact_t), intent(in) :: contact !! the first of the mesh
      type(spur_pair_t), intent(in) :: pair
      type(mesh_reference_t), intent(in) :: at     !! at the nominal load

      call begin(teller, in_mesh_constants, dims_mesh, index, is_static=.true.)
      call tell(teller, "driving_wheel", "1", "", "index of the driving wheel, from 0", contact%wheel_a - 1)
      call tell(teller, "driven_wheel", "1", "", "index of the driven wheel, from 0", contact%wheel_b - 1)
      call tell(teller, "flank", "1", "sigma", "+1: driving wheel nominally clockwise, -1: counterclockwise", pair%sigma)
      call tell(teller, "tracking", "1", "", "contact tracking: 0 closed form, 1 algebraic, 2 differential", contact%tracking)
      call tell(teller, "centre_line_angle", "rad", "chi", "direction from the driving to the driven axle", pair%chi)
      call tell(teller, "working_pressure_angle", "rad", "alpha_w", "working pressure angle", pair%alpha_w)
      call tell(teller, "base_pitch", "m", "p_b", "base pitch", contact%base_pitch)
      call tell(teller, "line_of_action_length", "m", "rho", "length of the line of action between the base circles", &
                contact%pair%rho_0)
      call tell(teller, "rho_start_driving", "m", "rho_A", "radius of curvature of the driving flank at the start of contact", &
                pair%rho_start_a)
      call tell(teller, "rho_start_driven", "m", "rho_B", "radius of curvature of the driven flank at the start of contact", &
                pair%rho_start_b)
      call tell(teller, "common_width", "m", "b", "common face width", contact%width)
      call tell(teller, "effective_modulus", "Pa", "E_star", "effective modulus of elasticity", contact%e_star)
      call tell(teller, "elastic_share_driving", "1", "w_A", "share of the driving wheel in the elastic compliance", &
                contact%pair%share_a)
      call tell(teller, "reference_force", "N", "F_0", "normal force that the loads suggest", contact%force_scale)
      call tell(teller, "reference_penetration", "m", "h_0", "penetration under the reference force", contact%h_scale)
      call tell(teller, "rigid_contact", "1", "", "1 if the contact is rigid: a constraint without penetration", contact%rigid)
      call tell(teller, "reference_stiffness", "N m-1", "k", "stiffness of one tooth pair under the reference force", at%stiffness)
      call tell(teller, "reference_mass", "kg", "m", "mass of the two wheels along the line of action", at%mass)
      call tell(teller, "natural_frequency", "Hz", "f_0", "natural frequency of the mesh with one tooth pair in contact", &
                at%frequency)
      call tell(teller, "damping_coefficient", "N s m-1", "c", "coefficient of the damper of one tooth pair", at%damping)
      call tell(teller, "damping_ratio", "1", "zeta", "damping ratio of the mesh with one tooth pair in contact", at%ratio)
   end subroutine tell_mesh_constants

end module evl_constant_outputs
