!> When something happens to a tooth contact: its root functions, and where it lies on the path of contact.
module evl_mesh_roots
   use evl_closed_form, only: centre_line_turn, closed_form_gap
   use evl_contact_laws, only: friction_knee
   use evl_contact_point, only: contact_point
   use evl_flank_deviation, only: deviation_borders, flank_deviation_t, zone_root, zone_tip
   use evl_kinds, only: wp
   use evl_local_variables, only: at_psi_a, n_local
   use evl_mesh, only: contact_apart, contact_loaded, contact_off, contact_open, contact_t, contact_unloaded, flank_drive, &
                       mesh_mode, mesh_unclipped_force, touches, tracking_closed_form
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: mesh_roots, mesh_root_directions, mesh_ends
   public :: root_contact, root_force, root_friction_high, root_friction_low, root_forward, root_back, root_apart, root_borders_a, &
             root_borders_b

   integer, parameter :: root_contact = 1       !! the gap closes or opens
   integer, parameter :: root_force = 2         !! the unclipped force passes zero
   integer, parameter :: root_friction_high = 3 !! v_t passes the upper end of the linear part
   integer, parameter :: root_friction_low = 4  !! v_t passes the lower end
   integer, parameter :: root_forward = 5       !! the far end of the path is passed, or one pitch since the last switch
   integer, parameter :: root_back = 6          !! the near end of the path is passed, or one pitch back since the last switch
   integer, parameter :: root_apart = 7         !! the flanks part so far, or come so near, that tracking ends or begins
   integer, parameter :: root_borders_a = 8     !! the contact passes the border of A's tip relief; of its root relief
   integer, parameter :: root_borders_b = 10    !! the same for B

   !> Roots lie this far past the change of mode, relative to the size of the quantity: a root function never starts at zero.
   real(wp), parameter :: past = 1.0e-10_wp

contains

   !> Root functions, of order 1; those without meaning in the mode are 1.
   subroutine mesh_roots(mesh, mode, rho_a0, q, point, roots, status)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      real(wp), intent(in) :: rho_a0, q(n_local)
      type(contact_point), intent(in) :: point
      real(wp), intent(out) :: roots(mesh%n_roots)
      type(status_t), intent(inout) :: status
      real(wp) :: force, knee

      roots = 1
      if (mode%contact == contact_open) roots(root_contact) = point%h/mesh%h_scale - past
      if (touches(mode)) then
         if (.not. mesh%rigid) roots(root_contact) = point%h/mesh%h_scale + past
         call mesh_unclipped_force(mesh, mode, point, force, status)
         roots(root_force) = force/mesh%force_scale + merge(past, -past, mode%contact == contact_loaded)
      end if
      knee = friction_knee(mesh%friction)
      if (knee > 0 .and. mode%contact == contact_loaded) then
         select case (mode%friction)
         case (0)
            roots(root_friction_high) = point%v_t/knee - (1 + past)
            roots(root_friction_low) = point%v_t/knee + (1 + past)
         case (1)
            roots(root_friction_high) = point%v_t/knee - (1 - past)
         case (-1)
            roots(root_friction_low) = point%v_t/knee + (1 - past)
         end select
      end if
      call end_roots(mesh, mode, rho_a0, q, point, roots(root_forward), roots(root_back))
      if (mesh%deviates .and. mode%contact /= contact_off) then
         call border_roots(mesh%deviation_a, mode%zone_a, point%rho_a, mesh%base_pitch, roots(root_borders_a:root_borders_a + 1))
         call border_roots(mesh%deviation_b, mode%zone_b, point%rho_b, mesh%base_pitch, roots(root_borders_b:root_borders_b + 1))
      end if
      if (mesh%tracking == tracking_closed_form) return
      if (mode%contact == contact_open) roots(root_apart) = -point%h/mesh%gap_apart - 1
      if (mode%contact == contact_apart) roots(root_apart) = closed_form_gap(mesh%pair, q)/mesh%gap_apart - 1
   end subroutine mesh_roots

   !> Root functions of the borders of tip and root relief on one flank.
   pure subroutine border_roots(deviation, zone, rho, unit_length, roots)
      type(flank_deviation_t), intent(in) :: deviation
      integer, intent(in) :: zone
      real(wp), intent(in) :: rho, unit_length !! [m]
      real(wp), intent(inout) :: roots(2)      !! tip, root; stay as they are where they have no meaning
      real(wp) :: rho_root, rho_tip

      call deviation_borders(deviation, rho_root, rho_tip)
      if (rho_tip < huge(rho_tip) .and. zone /= zone_root) &
         roots(1) = (rho - rho_tip)/unit_length + merge(past, -past, zone == zone_tip)
      if (rho_root > -huge(rho_root) .and. zone /= zone_tip) &
         roots(2) = (rho - rho_root)/unit_length + merge(-past, past, zone == zone_root)
   end subroutine border_roots

   !> Root functions of the ends of the path.
   pure subroutine end_roots(mesh, mode, rho_a0, q, point, forward, back)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      real(wp), intent(in) :: rho_a0, q(n_local)
      type(contact_point), intent(in) :: point
      real(wp), intent(out) :: forward, back
      real(wp) :: moved, none

      if (mesh%handover) then
         moved = mesh_teeth_moved(mesh, rho_a0, q)
         forward = moved - 1
         back = moved + 1
      else if (mode%contact == contact_off) then
         ! the pair that waits may enter where pairs begin, and the one before it, turning back, where they end
         call mesh_ends(mesh, point, 0, back, none)
         call mesh_ends(mesh, point, mesh%n_slots, none, forward)
         back = back - past
         forward = forward - past
      else
         call mesh_ends(mesh, point, 0, back, forward)
         back = back + past
         forward = forward + past
      end if
   end subroutine end_roots

   !> The direction in which each root counts.
   pure subroutine mesh_root_directions(mesh, mode, directions)
      type(contact_t), intent(in) :: mesh
      type(mesh_mode), intent(in) :: mode
      integer, intent(out) :: directions(mesh%n_roots)

      directions(root_contact) = merge(1, -1, mode%contact == contact_open)
      directions(root_force) = merge(1, -1, mode%contact == contact_unloaded)
      directions(root_friction_high) = merge(-1, 1, mode%friction == 1)
      directions(root_friction_low) = merge(1, -1, mode%friction == -1)
      directions(root_forward) = merge(1, -1, mesh%handover .or. mode%contact == contact_off)
      directions(root_back) = merge(1, -1, mode%contact == contact_off)
      directions(root_apart) = merge(-1, 1, mode%contact == contact_apart)
      if (.not. mesh%deviates) return
      directions(root_borders_a) = merge(-1, 1, mode%zone_a == zone_tip)
      directions(root_borders_a + 1) = merge(1, -1, mode%zone_a == zone_root)
      directions(root_borders_b) = merge(-1, 1, mode%zone_b == zone_tip)
      directions(root_borders_b + 1) = merge(1, -1, mode%zone_b == zone_root)
   end subroutine mesh_root_directions

   !> How many pitches the driving wheel has moved on since a pair that hands over began [1].
   pure real(wp) function mesh_teeth_moved(mesh, rho_a0, q) result(moved)
      type(contact_t), intent(in) :: mesh
      real(wp), intent(in) :: rho_a0, q(n_local)

      moved = (rho_a0 - mesh%rho_entry - mesh%pair%sigma*mesh%pair%r_ba*(q(at_psi_a) - centre_line_turn(mesh%pair, q)))/mesh%step
   end function mesh_teeth_moved

   !> How far a tooth pair is from the ends of the path of contact, in pitches; not negative while it is on the path.
   pure subroutine mesh_ends(mesh, point, pitches, near, far)
      type(contact_t), intent(in) :: mesh
      type(contact_point), intent(in) :: point
      integer, intent(in) :: pitches     !! of the pair before that of the point: how many pitches ahead it is
      real(wp), intent(out) :: near, far !! from the end where pairs enter in the nominal sense of rotation, and from the other
      real(wp) :: from_tip_a, from_tip_b

      from_tip_a = (mesh%rho_tip_a - point%rho_a - pitches*mesh%step)/mesh%base_pitch
      from_tip_b = (mesh%rho_tip_b - point%rho_b + pitches*mesh%step)/mesh%base_pitch
      near = merge(from_tip_b, from_tip_a, mesh%flank == flank_drive)
      far = merge(from_tip_a, from_tip_b, mesh%flank == flank_drive)
   end subroutine mesh_ends

end module evl_mesh_roots
