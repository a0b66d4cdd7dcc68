!> What does not change of a gearbox among its outputs: wheels, meshes, teeth. Found once, when the gearbox is built.
module evl_constant_outputs
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_output, only: dims_mesh, dims_wheel, dims_wheel_axis, output_t
   use evl_tooth_outputs, only: n_mesh_teeth, n_wheel_teeth, put_mesh_teeth, put_wheel_teeth, tooth_outputs
   implicit none (type, external)
   private

   public :: n_constant_outputs, constant_outputs, put_constants

   integer, parameter :: n_wheel_constants = 7, n_mesh_constants = 21
   integer, parameter :: n_constant_outputs = n_wheel_constants + n_mesh_constants + n_wheel_teeth + n_mesh_teeth

contains

   !> Their entries of the table of outputs.
   pure function constant_outputs() result(t)
      type(output_t) :: t(n_constant_outputs)

      t = [wheel_constants(), mesh_constants(), tooth_outputs()]
   end function constant_outputs

   pure function wheel_constants() result(t)
      type(output_t) :: t(n_wheel_constants)

      t(1) = output_t("teeth", "1", "z", "number of teeth", dims_wheel, .true., .true.)
      t(2) = output_t("pitch_radius", "m", "r", "pitch radius; of a real gear its reference radius", dims_wheel, .true.)
      t(3) = output_t("base_radius", "m", "r_b", "base radius", dims_wheel, .true.)
      t(4) = output_t("tip_radius", "m", "r_a", "tip radius", dims_wheel, .true.)
      t(5) = output_t("mass", "kg", "m", "mass of the wheel", dims_wheel, .true.)
      t(6) = output_t("inertia", "kg m2", "J", "moment of inertia about the axle", dims_wheel, .true.)
      t(7) = output_t("centre", "m", "O", "reference position of the axle", dims_wheel_axis, .true.)
   end function wheel_constants

   pure function mesh_constants() result(t)
      type(output_t) :: t(n_mesh_constants)

      t(1) = output_t("driving_wheel", "1", "", "index of the driving wheel, from 0", dims_mesh, .true., .true.)
      t(2) = output_t("driven_wheel", "1", "", "index of the driven wheel, from 0", dims_mesh, .true., .true.)
      t(3) = output_t("flank", "1", "sigma", "+1: driving wheel nominally clockwise, -1: counterclockwise", dims_mesh, .true., &
                      .true.)
      t(4) = output_t("tracking", "1", "", "contact tracking: 0 closed form, 1 algebraic, 2 differential", dims_mesh, .true., &
                      .true.)
      t(5) = output_t("centre_line_angle", "rad", "chi", "direction from the driving to the driven axle", dims_mesh, .true.)
      t(6) = output_t("working_pressure_angle", "rad", "alpha_w", "working pressure angle", dims_mesh, .true.)
      t(7) = output_t("base_pitch", "m", "p_b", "base pitch", dims_mesh, .true.)
      t(8) = output_t("line_of_action_length", "m", "rho", "length of the line of action between the base circles", dims_mesh, &
                      .true.)
      t(9) = output_t("rho_start_driving", "m", "rho_A", "radius of curvature of the driving flank at the start of contact", &
                      dims_mesh, .true.)
      t(10) = output_t("rho_start_driven", "m", "rho_B", "radius of curvature of the driven flank at the start of contact", &
                       dims_mesh, .true.)
      t(11) = output_t("common_width", "m", "b", "common face width", dims_mesh, .true.)
      t(12) = output_t("effective_modulus", "Pa", "E_star", "effective modulus of elasticity", dims_mesh, .true.)
      t(13) = output_t("elastic_share_driving", "1", "w_A", "share of the driving wheel in the elastic compliance", dims_mesh, &
                       .true.)
      t(14) = output_t("reference_force", "N", "F_0", "normal force that the loads suggest", dims_mesh, .true.)
      t(15) = output_t("reference_penetration", "m", "h_0", "penetration under the reference force", dims_mesh, .true.)
      t(16) = output_t("rigid_contact", "1", "", "1 if the contact is rigid: a constraint without penetration", dims_mesh, &
                       .true., .true.)
      t(17) = output_t("reference_stiffness", "N m-1", "k", "stiffness of one tooth pair under the reference force", dims_mesh, &
                       .true.)
      t(18) = output_t("reference_mass", "kg", "m", "mass of the two wheels along the line of action", dims_mesh, .true.)
      t(19) = output_t("natural_frequency", "Hz", "f_0", "natural frequency of the mesh with one tooth pair in contact", &
                       dims_mesh, .true.)
      t(20) = output_t("damping_coefficient", "N s m-1", "c", "coefficient of the damper of one tooth pair", dims_mesh, .true.)
      t(21) = output_t("damping_ratio", "1", "zeta", "damping ratio of the mesh with one tooth pair in contact", dims_mesh, .true.)
   end function mesh_constants

   !> Their values, in the order of the entries.
   pure subroutine put_constants(gearbox, values)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(out) :: values(:) !! of the size that their entries add up to
      integer :: nw, nm, at_meshes, at_teeth, at_mesh_teeth

      nw = size(gearbox%wheels)
      nm = size(gearbox%pairs)
      at_meshes = nw*(n_wheel_constants + 1)
      at_teeth = at_meshes + nm*n_mesh_constants
      at_mesh_teeth = at_teeth + nw*n_wheel_teeth
      call put_wheel_constants(gearbox, nw, values(:at_meshes))
      call put_mesh_constants(gearbox, nm, values(at_meshes + 1:at_teeth))
      call put_wheel_teeth(gearbox, nw, values(at_teeth + 1:at_mesh_teeth))
      call put_mesh_teeth(gearbox, nm, values(at_mesh_teeth + 1:))
   end subroutine put_constants

   !> What does not change of the wheels.
   pure subroutine put_wheel_constants(gearbox, n, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: n !! wheels
      real(wp), intent(inout) :: values(n, n_wheel_constants + 1)
      integer :: i

      do i = 1, n
         associate (wheel => gearbox%wheels(i))
            values(i, :6) = [real(wheel%teeth, wp), wheel%pitch_radius, wheel%base_radius, wheel%tip_radius, wheel%mass, &
                             wheel%inertia]
            call put_pair(wheel%centre, i, n, values(1, 7))
         end associate
      end do
   end subroutine put_wheel_constants

   !> Components x and y of wheel or mesh i.
   pure subroutine put_pair(pair, i, n, values)
      real(wp), intent(in) :: pair(2)
      integer, intent(in) :: i, n
      real(wp), intent(inout) :: values(2, n)

      values(:, i) = pair
   end subroutine put_pair

   !> What does not change of the meshes.
   pure subroutine put_mesh_constants(gearbox, n, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: n !! meshes
      real(wp), intent(inout) :: values(n, n_mesh_constants)
      integer :: i

      do i = 1, n
         associate (contact => gearbox%contacts(gearbox%first(i)), pair => gearbox%pairs(i), at => gearbox%references(i))
            values(i, :) = [real(contact%wheel_a - 1, wp), real(contact%wheel_b - 1, wp), contact%pair%sigma, &
                            real(contact%tracking, wp), &
                            pair%chi, pair%alpha_w, contact%base_pitch, contact%pair%rho_0, pair%rho_start_a, pair%rho_start_b, &
                            contact%width, contact%e_star, contact%pair%share_a, contact%force_scale, contact%h_scale, &
                            merge(1.0_wp, 0.0_wp, contact%rigid), at%stiffness, at%mass, at%frequency, at%damping, at%ratio]
         end associate
      end do
   end subroutine put_mesh_constants

end module evl_constant_outputs
