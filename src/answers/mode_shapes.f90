!> What a small change of the state moves: wheels, axles, and the flanks of each mesh.
module evl_mode_shapes
   use evl_closed_form, only: centre_line_turn_gradient, error_of_turns, gradient_closed_form, track_closed_form
   use evl_contact_point, only: contact_gradient, contact_point
   use evl_gearbox, only: gearbox_local, gearbox_t
   use evl_kinds, only: wp
   use evl_local_variables, only: at_psi_a, at_psi_b, i_theta, n_local
   use evl_support, only: axle_deviation
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: gearbox_shape

contains

   !> First-order changes that belong to a change dy of the state y; linear in dy.
   pure subroutine gearbox_shape(gearbox, y, dy, arcs, displacements, penetrations, transmission_errors)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states), dy(gearbox%n_states)
      real(wp), intent(out) :: arcs(size(gearbox%wheels))             !! r_b phi, or r phi without a mesh, counterclockwise [m]
      real(wp), intent(out) :: displacements(2, size(gearbox%wheels)) !! x, y of each axle [m]
      real(wp), intent(out) :: penetrations(size(gearbox%pairs))     !! h of each mesh [m]
      real(wp), intent(out) :: transmission_errors(size(gearbox%pairs)) !! Delta of each mesh [m]
      integer :: i

      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            arcs(i) = wheel%ratio*dy(i_theta)
            if (wheel%i_psi > 0) arcs(i) = arcs(i) + dy(wheel%i_psi)
            arcs(i) = merge(wheel%base_radius, wheel%pitch_radius, wheel%base_radius > 0)*arcs(i)
            displacements(:, i) = axle_deviation(wheel%support, dy, 0)
         end associate
      end do
      do i = 1, size(gearbox%pairs)
         call mesh_shape(gearbox, gearbox%contacts(gearbox%first(i)), y, dy, penetrations(i), transmission_errors(i))
      end do
   end subroutine gearbox_shape

   !> Changes of penetration and transmission error of one mesh.
   pure subroutine mesh_shape(gearbox, contact, y, dy, penetration, transmission_error)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: y(:), dy(:)
      real(wp), intent(out) :: penetration, transmission_error
      real(wp), dimension(n_local) :: q, dq
      type(contact_point) :: point
      type(contact_gradient) :: gradient

      call gearbox_local(gearbox, contact, y, q)
      call gearbox_local(gearbox, contact, dy, dq)
      associate (pair => contact%pair)
         call track_closed_form(pair, contact%rho_start, q, point) ! neither h nor Delta depends on the place on the path
         call gradient_closed_form(pair, q, point, gradient)
         penetration = dot_product(gradient%h, dq)
         transmission_error = error_of_turns(pair, dq(at_psi_a), dq(at_psi_b), dot_product(centre_line_turn_gradient(pair, q), dq))
      end associate
   end subroutine mesh_shape

end module evl_mode_shapes
