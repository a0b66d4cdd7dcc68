!> The forces of a tooth contact with their derivatives.
module evl_contact_gradient
   use evl_closed_form, only: gradient_along, place_contact
   use evl_contact_point, only: contact_gradient, contact_point
   use evl_contact_tracking, only: gradient_points, track_points
   use evl_damping_law, only: viscous_result
   use evl_deviating_flanks, only: deviate, deviate_gradient, flank_value
   use evl_elastic_law, only: elastic_result
   use evl_kinds, only: wp
   use evl_local_variables, only: at_normal, n_local, unit
   use evl_status, only: has_failed, status_t
   use evl_tangent_line, only: tangent_line_t
   use evl_tooth_contact, only: contact_force, contact_law, contact_mode, flank_values, flanks_loaded, flanks_unloaded, &
                                forces_of_laws, left_involute, on_involutes, tooth_contact_t, tracking_closed_form
   implicit none (type, external)
   private

   public :: mesh_force_gradient, contact_gradient_at

   !> Derivatives of the forces with respect to the local variables.
   type :: mesh_force_gradient
      real(wp) :: torque_a(n_local), torque_b(n_local), on_a(n_local, 2), dissipation(n_local)
   end type mesh_force_gradient

contains

   !> Forces of flanks that overlap, and their derivatives with respect to the local variables.
   subroutine contact_gradient_at(contact, mode, rho_a0, q, line, force, gradient, status)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode   !! one in which the flanks touch
      real(wp), intent(in) :: rho_a0, q(n_local)
      type(tangent_line_t), intent(in) :: line   !! of action, at q; tracked points do not use it
      type(contact_force), intent(out) :: force
      type(mesh_force_gradient), intent(out) :: gradient
      type(status_t), intent(inout) :: status !! as of contact_forces; on failure the results are of no use
      type(contact_point) :: point
      type(contact_gradient) :: d
      type(elastic_result) :: elastic
      type(viscous_result) :: viscous
      real(wp) :: factor, d_v
      real(wp), dimension(n_local) :: d_energy, d_elastic, d_viscous, d_normal, d_friction, d_tangential

      call contact_with_gradient(contact, mode, rho_a0, q, line, point, d)
      if (.not. on_involutes(point)) then
         call left_involute(contact, point, status)
         return
      end if
      call contact_law(contact, mode, point, elastic, viscous, status)
      if (has_failed(status)) return
      factor = 0
      d_v = 0
      if (mode%flanks == flanks_loaded) call contact%friction%factor(mode%friction, point%v_t, factor, d_v)
      call forces_of_laws(contact, mode, point, elastic, viscous%force, factor, force)
      d_elastic = force_change(elastic%d_h, elastic%d_rho_a, elastic%d_rho_b, d)
      associate (r => point%rho_a + point%rho_b - point%h, d_rho => (elastic%d_rho_a + elastic%d_rho_b)/2)
         ! dV/dr changes with h as the force does with r, and is homogeneous in both; `excess` is constant enough
         d_energy = d_rho*d%h + (elastic%d_energy - point%h*d_rho)/r*(d%rho_a + d%rho_b - d%h)
         gradient%dissipation = -point%rho_dot*d_energy - elastic%d_energy*d%rho_dot - elastic%excess*d%h_dot
         if (mode%flanks == flanks_unloaded) then
            gradient%torque_a = 0
            gradient%torque_b = 0
            gradient%on_a = 0
            gradient%dissipation = gradient%dissipation - point%h_dot*d_elastic - elastic%force*d%h_dot
            return
         end if
         if (contact%rigid) d_elastic = unit(at_normal, mode%share)
         d_viscous = force_change(viscous%d_h, viscous%d_rho_a, viscous%d_rho_b, d) + viscous%d_h_dot*d%h_dot
         d_normal = d_elastic + d_viscous
         d_friction = -factor*d_normal - (force%normal*d_v)*d%v_t
         gradient%dissipation = gradient%dissipation + point%h_dot*d_viscous + viscous%force*d%h_dot - point%v_t*d_friction &
                                - force%friction*d%v_t
      end associate
      associate (sigma => contact%pair%sigma)
         gradient%torque_a = sigma*(point%arm_a*d_normal + point%l_a*d_friction + force%friction*d%l_a)
         gradient%torque_b = sigma*(point%arm_b*d_normal + point%l_b*d_friction + force%friction*d%l_b)
         d_tangential = d_friction
         if (contact%deviates) then
            gradient%torque_a = gradient%torque_a + (sigma*force%normal)*d%arm_a
            gradient%torque_b = gradient%torque_b + (sigma*force%normal)*d%arm_b
            d_tangential = d_friction + point%tilt*d_normal + force%normal*d%tilt
         end if
      end associate
      gradient%on_a(:, 1) = point%s*d_normal + point%c*d_tangential - force%on_a(2)*d%angle
      gradient%on_a(:, 2) = -point%c*d_normal + point%s*d_tangential + force%on_a(1)*d%angle
   end subroutine contact_gradient_at

   !> How a force changes with the penetration and both radii of curvature. Where it depends on their sum alone, as most laws have it,
   !> what one radius gains by the motion of the axles and the other loses cancels before it is multiplied.
   pure function force_change(d_h, d_rho_a, d_rho_b, d) result(change)
      real(wp), intent(in) :: d_h, d_rho_a, d_rho_b !! derivatives of the force [N/m]
      type(contact_gradient), intent(in) :: d
      real(wp) :: change(n_local)

      change = d_h*d%h + d_rho_a*(d%rho_a + d%rho_b) + (d_rho_b - d_rho_a)*d%rho_b
   end function force_change

   !> The contact as the mesh's tracking sees it, with its derivatives.
   pure subroutine contact_with_gradient(contact, mode, rho_a0, q, line, point, gradient)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      real(wp), intent(in) :: rho_a0, q(n_local)
      type(tangent_line_t), intent(in) :: line
      type(contact_point), intent(out) :: point
      type(contact_gradient), intent(out) :: gradient
      type(contact_point) :: perfect
      type(flank_value) :: a, b

      if (contact%tracking /= tracking_closed_form) then
         call track_points(contact%pair, rho_a0, q, point)
         call gradient_points(contact%pair, rho_a0, q, point, gradient)
         return
      end if
      call place_contact(contact%pair, rho_a0, q, line, point)
      call gradient_along(contact%pair, q, line, point, gradient)
      if (.not. contact%deviates) return ! as no tracked flank does
      perfect = point
      call flank_values(contact, mode, perfect, a, b)
      call deviate(contact%pair, a, b, q, point)
      call deviate_gradient(contact%pair, a, b, q, perfect, point, gradient)
   end subroutine contact_with_gradient

end module evl_contact_gradient
