!> Derivatives of the forces of a tooth contact with respect to the local variables.
module evl_contact_gradient
   use evl_closed_form, only: gradient_along, point_on_line
   use evl_contact_point, only: contact_gradient, contact_point
   use evl_contact_tracking, only: gradient_points
   use evl_deviating_flanks, only: deviate_gradient, flank_value, flanks_turned
   use evl_edge_contact, only: edge_gradient, lift_of
   use evl_flank, only: flank_t
   use evl_friction_law, only: by_curvature, by_load, by_rolling, by_sliding
   use evl_kinds, only: wp
   use evl_local_variables, only: at_omega, at_psi_dot_a, at_psi_dot_b, n_local
   use evl_tangent_line, only: tangent_line_t
   use evl_tooth_contact, only: beyond_flank, contact_state, flank_values, flanks_unloaded, tooth_contact_t, tracking_closed_form
   implicit none (type, external)
   private

   public :: force_gradient, mesh_force_gradient, point_gradient

   !> Derivatives of the forces with respect to the local variables.
   type :: mesh_force_gradient
      real(wp) :: torque_a(n_local), torque_b(n_local), on_a(n_local, 2), dissipation(n_local)
   end type mesh_force_gradient

contains

   !> Derivatives of the forces of one contact of a flank.
   pure subroutine force_gradient(flank, contacts, at, d, k, gradient)
      class(flank_t), intent(in) :: flank
      type(tooth_contact_t), intent(in) :: contacts(*)
      type(contact_state), intent(in) :: at(*)   !! with their forces
      type(contact_gradient), intent(in) :: d(*) !! of the points of the contacts that touch
      integer, intent(in) :: k                   !! index of the contact; it must touch
      type(mesh_force_gradient), intent(out) :: gradient
      real(wp), dimension(n_local) :: d_elastic, d_viscous, loss

      call flank%force_changes(contacts, at, d, k, d_elastic, d_viscous)
      loss = flank%loss_change(at(k)%point, at(k)%elastic, d(k))
      call plain_gradient(contacts(k), at(k), d(k), d_elastic, d_viscous, loss, gradient)
      call flank%add_compliant_changes(contacts, at, d, k, d_elastic, gradient%torque_a, gradient%torque_b, gradient%on_a)
   end subroutine force_gradient

   !> Derivatives of the forces of flanks without the terms that `add_compliant_changes` adds.
   pure subroutine plain_gradient(contact, at, d, d_elastic, d_viscous, loss, gradient)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      type(contact_gradient), intent(in) :: d
      real(wp), intent(in), dimension(n_local) :: d_elastic, d_viscous !! of both forces
      real(wp), intent(in) :: loss(n_local)                           !! from `loss_change`
      type(mesh_force_gradient), intent(out) :: gradient
      real(wp) :: d_normal(n_local), d_tangential(n_local), d_factor(n_local), d_friction, slip
      integer :: j

      associate (point => at%point, force => at%force, elastic => at%elastic, viscous => at%viscous, sigma => contact%pair%sigma)
         if (at%mode%flanks == flanks_unloaded) then
            gradient%torque_a = 0
            gradient%torque_b = 0
            gradient%on_a = 0
            gradient%dissipation = -loss - point%h_dot*d_elastic - elastic%force*d%h_dot
            return
         end if
         d_normal = d_elastic + d_viscous
         d_factor = 0
         if (contact%friction%is_local()) d_factor = local_changes(contact, at, d, d_normal)
         slip = force%normal*at%d_factor(by_sliding)
         do j = 1, n_local
            d_friction = -at%factor*d_normal(j) - slip*d%v_t(j) - force%normal*d_factor(j)
            gradient%dissipation(j) = -loss(j) + point%h_dot*d_viscous(j) + viscous%force*d%h_dot(j) - point%v_t*d_friction &
                                      - force%friction*d%v_t(j)
            gradient%torque_a(j) = sigma*(point%arm_a*d_normal(j) + point%l_a*d_friction + force%friction*d%l_a(j))
            gradient%torque_b(j) = sigma*(point%arm_b*d_normal(j) + point%l_b*d_friction + force%friction*d%l_b(j))
            d_tangential(j) = d_friction
         end do
         if (contact%deviates) then
            gradient%torque_a = gradient%torque_a + (sigma*force%normal)*d%arm_a
            gradient%torque_b = gradient%torque_b + (sigma*force%normal)*d%arm_b
            d_tangential = d_tangential + point%tilt*d_normal + force%normal*d%tilt
         end if
         do j = 1, n_local
            gradient%on_a(j, 1) = point%s*d_normal(j) + point%c*d_tangential(j) - force%on_a(2)*d%angle(j)
            gradient%on_a(j, 2) = -point%c*d_normal(j) + point%s*d_tangential(j) + force%on_a(1)*d%angle(j)
         end do
         if (.not. beyond_flank(at%mode)) return
         d_normal = lift_of(at%edge)*d_normal + force%normal*d%lift
         gradient%on_a(:, 1) = gradient%on_a(:, 1) + point%s*d_normal
         gradient%on_a(:, 2) = gradient%on_a(:, 2) - point%c*d_normal
      end associate
   end subroutine plain_gradient

   !> Derivatives of the friction factor, except those by the sliding velocity.
   pure function local_changes(contact, at, d, d_normal) result(change)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      type(contact_gradient), intent(in) :: d
      real(wp), intent(in) :: d_normal(n_local)
      real(wp) :: change(n_local), d_rolling(n_local)

      associate (point => at%point, pair => contact%pair)
         d_rolling = pair%sigma*(point%omega_a*d%l_a - point%omega_b*d%l_b)
         d_rolling(at_omega) = d_rolling(at_omega) + pair%sigma*(pair%ratio_a*point%l_a - pair%ratio_b*point%l_b)
         d_rolling(at_psi_dot_a) = d_rolling(at_psi_dot_a) + pair%sigma*point%l_a
         d_rolling(at_psi_dot_b) = d_rolling(at_psi_dot_b) - pair%sigma*point%l_b
         change = at%d_factor(by_rolling)*d_rolling + at%d_factor(by_load)/contact%width*d_normal &
                  - at%d_factor(by_curvature)*(d%rho_a/point%rho_a**2 + d%rho_b/point%rho_b**2)
      end associate
   end function local_changes

   !> Derivatives of a contact point.
   pure subroutine point_gradient(contact, line, at, gradient)
      type(tooth_contact_t), intent(in) :: contact
      type(tangent_line_t), intent(in) :: line   !! line of action; not used for tracked points
      type(contact_state), intent(in) :: at      !! with its point; it touches
      type(contact_gradient), intent(out) :: gradient
      type(contact_point) :: perfect
      type(flank_value) :: a, b
      type(flanks_turned) :: turned

      if (contact%tracking /= tracking_closed_form) then
         call gradient_points(contact%pair, at%rho_a0, at%q, at%point, gradient)
         return
      end if
      if (.not. contact%deviates) then ! tracked flanks never deviate
         call gradient_along(contact%pair, at%q, line, at%point, gradient)
         return
      end if
      call point_on_line(contact%pair, at%rho_a0, at%q, line, perfect)
      call gradient_along(contact%pair, at%q, line, perfect, gradient)
      if (beyond_flank(at%mode)) then
         call edge_gradient(contact%pair, at%edge, at%q, perfect, at%point, gradient)
         return
      end if
      call flank_values(contact, at%mode, perfect, a, b, turned)
      call deviate_gradient(contact%pair, a, b, turned, at%q, perfect, at%point, gradient)
   end subroutine point_gradient

end module evl_contact_gradient
