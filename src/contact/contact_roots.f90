!> When something happens to a tooth contact: its root functions, and where it lies on the path of contact.
module evl_contact_roots
   use evl_closed_form, only: centre_line_turn, closed_form_gap
   use evl_contact_point, only: contact_point
   use evl_flank_deviation, only: deviation_borders, flank_deviation_t, zone_root, zone_tip
   use evl_kinds, only: wp
   use evl_local_variables, only: at_psi_a, n_local
   use evl_status, only: status_t
   use evl_tooth_contact, only: contact_mode, flank_drive, flanks_apart, flanks_loaded, flanks_off, flanks_open, &
                                flanks_unloaded, n_border_roots, n_contact_roots, tooth_contact_t, touches, &
                                tracking_closed_form, unclipped_force
   implicit none (type, external)
   private

   public :: contact_roots, contact_roots_of_force, contact_root_directions, ends_of_path, mark_idle_roots, most_contact_roots, past
   public :: root_contact, root_force, root_friction_high, root_friction_low, root_forward, root_back, root_apart, root_side, &
             root_borders_a, root_borders_b, standstill

   integer, parameter :: root_contact = 1       !! the gap closes or opens
   integer, parameter :: root_force = 2         !! the unclipped force passes zero
   integer, parameter :: root_friction_high = 3 !! v_t passes the upper end of the linear part
   integer, parameter :: root_friction_low = 4  !! v_t passes the lower end
   integer, parameter :: root_forward = 5       !! the far end of the path is passed, or one pitch since the last switch
   integer, parameter :: root_back = 6          !! the near end of the path is passed, or one pitch back since the last switch
   integer, parameter :: root_apart = 7         !! the flanks part so far, or come so near, that tracking ends or begins
   integer, parameter :: root_side = 8          !! the rate of the penetration passes zero, where a damping law changes
   integer, parameter :: root_borders_a = 9     !! the contact passes the border of A's tip relief; of its root relief
   integer, parameter :: root_borders_b = 11    !! the same for B

   !> Roots lie this far past the change of mode, relative to the size of the quantity: a root function never starts at zero.
   real(wp), parameter :: past = 1.0e-10_wp

   !> The same for the side of a damping law, relative to the rate scale: a damper's force on the wrong side is nothing there, and
   !> it is above what integration leaves of a rate that has come to rest, or sides would change for ever.
   real(wp), parameter :: standstill = 1.0e-6_wp

   integer, parameter :: most_contact_roots = n_contact_roots + n_border_roots !! of one tooth contact
   integer, parameter :: width = 1 !! states that the included formulas take at once

contains

   !> Root functions, of order 1; those without meaning in the mode are 1.
   subroutine contact_roots(contact, mode, rho_a0, q, point, roots, status, unclipped)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      real(wp), intent(in) :: rho_a0, q(n_local)
      type(contact_point), intent(in) :: point
      real(wp), intent(out) :: roots(contact%n_roots)
      type(status_t), intent(inout) :: status
      real(wp), intent(out), optional :: unclipped !! elastic + viscous force where flanks overlap, else 0 [N]
      real(wp) :: force

      force = 0
      if (touches(mode)) call unclipped_force(contact, mode, point, force, status)
      if (present(unclipped)) unclipped = force
      call contact_roots_of_force(contact, mode, rho_a0, q, point, force, roots)
   end subroutine contact_roots

   !> The same where the force is known.
   pure subroutine contact_roots_of_force(contact, mode, rho_a0, q, point, force, roots)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      real(wp), intent(in) :: rho_a0, q(n_local)
      type(contact_point), intent(in) :: point
      real(wp), intent(in) :: force                !! elastic + viscous, unclipped; of no meaning where flanks do not overlap [N]
      real(wp), intent(out) :: roots(contact%n_roots)
      real(wp) :: moved(width)

      moved = 0
      if (contact%handover) moved = pitches_moved(contact, [rho_a0], [q(at_psi_a)], [centre_line_turn(contact%pair, q)])
      call closed_form_roots(contact, mode, [point%h], [point%h_dot], [point%v_t], [point%rho_a], [point%rho_b], [force], moved, &
                             roots)
      if (contact%tracking == tracking_closed_form) return
      if (mode%flanks == flanks_open) roots(root_apart) = -point%h/contact%gap_apart - 1
      if (mode%flanks == flanks_apart) roots(root_apart) = closed_form_gap(contact%pair, q)/contact%gap_apart - 1
   end subroutine contact_roots_of_force

   include "contact/contact_roots.inc"

   !> The direction in which each root counts.
   pure subroutine contact_root_directions(contact, mode, directions)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      integer, intent(out) :: directions(contact%n_roots)

      directions(root_contact) = merge(1, -1, mode%flanks == flanks_open)
      directions(root_force) = merge(1, -1, mode%flanks == flanks_unloaded)
      directions(root_friction_high) = merge(-1, 1, mode%friction == 1)
      directions(root_friction_low) = merge(1, -1, mode%friction == -1)
      directions(root_forward) = merge(1, -1, contact%handover .or. mode%flanks == flanks_off)
      directions(root_back) = merge(1, -1, mode%flanks == flanks_off)
      directions(root_side) = merge(-1, 1, mode%side > 0)
      directions(root_apart) = merge(-1, 1, mode%flanks == flanks_apart)
      if (.not. contact%deviates) return
      directions(root_borders_a) = merge(-1, 1, mode%zone_a == zone_tip)
      directions(root_borders_a + 1) = merge(1, -1, mode%zone_a == zone_root)
      directions(root_borders_b) = merge(-1, 1, mode%zone_b == zone_tip)
      directions(root_borders_b + 1) = merge(1, -1, mode%zone_b == zone_root)
   end subroutine contact_root_directions

   !> Mark the root functions without meaning in the mode, which are 1 at any state.
   pure subroutine mark_idle_roots(contact, mode, mark, directions)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      integer, intent(in) :: mark                        !! put in place of their direction
      integer, intent(inout) :: directions(contact%n_roots)
      logical :: slides

      if (.not. (mode%flanks == flanks_open .or. (touches(mode) .and. .not. contact%rigid))) directions(root_contact) = mark
      if (.not. touches(mode)) directions(root_force) = mark
      if (contact%i_side == 0 .or. .not. touches(mode)) directions(root_side) = mark
      slides = contact%friction%knee() > 0 .and. mode%flanks == flanks_loaded
      if (.not. slides .or. mode%friction == -1) directions(root_friction_high) = mark
      if (.not. slides .or. mode%friction == 1) directions(root_friction_low) = mark
      if (contact%tracking == tracking_closed_form .or. touches(mode) .or. mode%flanks == flanks_off) directions(root_apart) = mark
      if (.not. contact%deviates) return
      if (mode%flanks == flanks_off) then
         directions(root_borders_a:root_borders_b + 1) = mark
         return
      end if
      call mark_idle_borders(contact%deviation_a, mode%zone_a, mark, directions(root_borders_a:root_borders_a + 1))
      call mark_idle_borders(contact%deviation_b, mode%zone_b, mark, directions(root_borders_b:root_borders_b + 1))
   end subroutine mark_idle_roots

   !> The same for the borders of tip and root relief on one flank.
   pure subroutine mark_idle_borders(deviation, zone, mark, directions)
      type(flank_deviation_t), intent(in) :: deviation
      integer, intent(in) :: zone, mark
      integer, intent(inout) :: directions(2) !! tip, root
      real(wp) :: rho_root, rho_tip

      call deviation_borders(deviation, rho_root, rho_tip)
      if (.not. rho_tip < huge(rho_tip) .or. zone == zone_root) directions(1) = mark
      if (.not. rho_root > -huge(rho_root) .or. zone == zone_tip) directions(2) = mark
   end subroutine mark_idle_borders

   !> How far a tooth pair is from the ends of the path of contact, in pitches; not negative while it is on the path.
   pure subroutine ends_of_path(contact, point, near, far)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_point), intent(in) :: point
      real(wp), intent(out) :: near, far !! from the end where pairs enter in the nominal sense of rotation, and from the other
      real(wp), dimension(width) :: to_near, to_far

      call path_ends(contact, [point%rho_a], [point%rho_b], 0, to_near, to_far)
      near = to_near(1)
      far = to_far(1)
   end subroutine ends_of_path

end module evl_contact_roots
