!> Root functions of a tooth contact with their directions, and its position on the path of contact.
module evl_contact_roots
   use evl_closed_form, only: centre_line_turn
   use evl_contact_point, only: contact_point
   use evl_flank, only: flank_t
   use evl_flank_deviation, only: has_corner, relief_t, zone_edge, zone_end, zone_none, zone_root, zone_root_corner, zone_tip, &
                                  zone_tip_corner
   use evl_kinds, only: wp
   use evl_local_variables, only: at_psi_a
   use evl_pair_point, only: by_a, by_b, tip_t
   use evl_root_kinds, only: live_bends_a, live_bends_b, live_loaded, live_on_path, live_one_sided, live_touching, moves_pair, &
                             n_discrete, n_held, n_root_kinds, n_sides, root_of, root_rows
   use evl_tooth_contact, only: contact_mode, contact_state, feet_of, flank_drive, flanks_apart, flanks_loaded, flanks_off, &
                                flanks_open, flanks_unloaded, tooth_contact_t, touches, tracking_closed_form, unclipped
   implicit none (type, external)
   private

 public :: by_kind, contact_root_direction, contact_root_directions, contact_roots, ends_of_path, find_sides, is_past, list_roots, &
             pitches_since_handover, share_roots

   integer, parameter :: width = 1 !! states evaluated at once by the included formulas

contains

   !> Root functions of a contact, of order 1; those without meaning in the mode are 1.
   pure subroutine contact_roots(flank, contact, at, directions, roots)
      class(flank_t), intent(in) :: flank
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at           !! with the results of its flank
      integer, intent(out) :: directions(contact%n_roots) !! crossing directions that count
      real(wp), intent(out) :: roots(contact%n_roots)
      real(wp) :: foot(2), moved(width)

      moved = 0
      if (contact%handover) moved = pitches_since_handover(contact, at)
      call contact_root_directions(contact, at%mode, directions)
      foot = feet_of(at)
      associate (point => at%point)
         call closed_form_roots(flank, contact, at%mode, directions, [at%overlap], [point%h_dot], [point%v_t], [point%rho_a], &
                                [point%rho_b], [foot(by_a)], [foot(by_b)], [unclipped(at)], moved, roots)
      end associate
   end subroutine contact_roots

   include "contact/contact_roots.inc"

   !> Crossing directions of the root functions of a contact: +1 rising, -1 falling, 0 without meaning in the mode.
   pure subroutine contact_root_directions(contact, mode, directions)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      integer, intent(out) :: directions(contact%n_roots)
      integer :: branches(n_discrete), i

      branches = [0, 0, mode%friction, mode%zone_a, mode%zone_b, mode%sides]
      do i = 1, contact%n_roots
         directions(i) = contact%directions(branches(contact%moved(i)), mode%flanks, i)
      end do
   end subroutine contact_root_directions

   !> The same for one kind. The direction depends only on the flanks and on the integer that the kind changes.
   pure integer function contact_root_direction(contact, mode, kind) result(direction)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      integer, intent(in) :: kind

      direction = 0
      if (.not. can_fire(contact, kind)) return
      if (mode%flanks == flanks_off .and. root_rows(kind)%moves /= moves_pair) return ! only entering is possible
      select case (kind)
      case (root_of%contact)
         if (mode%flanks == flanks_open) direction = 1
         if (touches(mode) .and. .not. contact%rigid) direction = -1
      case (root_of%force)
         if (touches(mode)) direction = merge(1, -1, mode%flanks == flanks_unloaded)
      case (root_of%friction_high)
         if (mode%flanks == flanks_loaded .and. mode%friction /= -1) direction = merge(-1, 1, mode%friction == 1)
      case (root_of%friction_low)
         if (mode%flanks == flanks_loaded .and. mode%friction /= 1) direction = merge(1, -1, mode%friction == -1)
      case (root_of%forward, root_of%back)
         direction = merge(1, -1, mode%flanks == flanks_off)
      case (root_of%switch)
         direction = 1
      case (root_of%switch_back)
         direction = -1
      case (root_of%apart)
         if (mode%flanks == flanks_open) direction = 1
         if (mode%flanks == flanks_apart) direction = -1
      case (root_of%tip_a)
         direction = border_direction(contact%deviation_a%tip, 1, mode%zone_a, zone_tip, zone_tip_corner)
      case (root_of%root_a)
         direction = border_direction(contact%deviation_a%root, 1, mode%zone_a, zone_root, zone_root_corner)
      case (root_of%tip_b)
         direction = border_direction(contact%deviation_b%tip, 1, mode%zone_b, zone_tip, zone_tip_corner)
      case (root_of%root_b)
         direction = border_direction(contact%deviation_b%root, 1, mode%zone_b, zone_root, zone_root_corner)
      case (root_of%tip_corner_a)
         direction = border_direction(contact%deviation_a%tip, 2, mode%zone_a, zone_tip, zone_tip_corner)
      case (root_of%root_corner_a)
         direction = border_direction(contact%deviation_a%root, 2, mode%zone_a, zone_root, zone_root_corner)
      case (root_of%tip_corner_b)
         direction = border_direction(contact%deviation_b%tip, 2, mode%zone_b, zone_tip, zone_tip_corner)
      case (root_of%root_corner_b)
         direction = border_direction(contact%deviation_b%root, 2, mode%zone_b, zone_root, zone_root_corner)
      case (root_of%end_a)
         direction = end_direction(mode%zone_a)
      case (root_of%edge_a)
         direction = edge_direction(contact%tips(by_a), mode%zone_a)
      case (root_of%end_b)
         direction = end_direction(mode%zone_b)
      case (root_of%edge_b)
         direction = edge_direction(contact%tips(by_b), mode%zone_b)
      case default
         if (has_side(mode, root_rows(kind)%live)) &
            direction = merge(-1, 1, mode%sides(kind - (n_root_kinds - n_sides)) > 0)
      end select
   end function contact_root_direction

   !> Whether a kind can have a meaning in any mode of a contact, given the features of the contact.
   pure logical function can_fire(contact, kind)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: kind

      select case (kind)
      case (root_of%friction_high, root_of%friction_low)
         can_fire = contact%friction%knee() > 0
      case (root_of%forward, root_of%back)
         can_fire = .not. contact%handover
      case (root_of%switch, root_of%switch_back)
         can_fire = contact%handover
      case (root_of%apart)
         can_fire = contact%tracking /= tracking_closed_form
      case (root_of%tip_a)
         can_fire = contact%deviation_a%tip%amount > 0
      case (root_of%root_a)
         can_fire = contact%deviation_a%root%amount > 0
      case (root_of%tip_b)
         can_fire = contact%deviation_b%tip%amount > 0
      case (root_of%root_b)
         can_fire = contact%deviation_b%root%amount > 0
      case (root_of%tip_corner_a)
         can_fire = contact%deviation_a%tip%amount > 0 .and. has_corner(contact%deviation_a%tip)
      case (root_of%root_corner_a)
         can_fire = contact%deviation_a%root%amount > 0 .and. has_corner(contact%deviation_a%root)
      case (root_of%tip_corner_b)
         can_fire = contact%deviation_b%tip%amount > 0 .and. has_corner(contact%deviation_b%tip)
      case (root_of%root_corner_b)
         can_fire = contact%deviation_b%root%amount > 0 .and. has_corner(contact%deviation_b%root)
      case (root_of%end_a)
         can_fire = contact%has_edges .and. contact%tips(by_a)%takes_over > 0
      case (root_of%end_b)
         can_fire = contact%has_edges .and. contact%tips(by_b)%takes_over > 0
      case (root_of%edge_a, root_of%edge_b)
         can_fire = contact%has_edges
      case default
         select case (root_rows(kind)%live)
         case (live_one_sided)
            can_fire = contact%one_sided
         case (live_bends_a)
            can_fire = contact%smooth(2, by_a) > 0
         case (live_bends_b)
            can_fire = contact%smooth(2, by_b) > 0
         case default
            can_fire = .true.
         end select
      end select
   end function can_fire

   !> Direction at a border of a relief. A pair on the relief can leave it, a pair on the profile between the reliefs can enter it,
   !> in both cases through the corner.
   pure integer function border_direction(relief, border, zone, mine, corner) result(direction)
      type(relief_t), intent(in) :: relief
      integer, intent(in) :: border             !! 1: profile before the relief; 2: relief, beyond its corner
      integer, intent(in) :: zone, mine, corner !! zones of the contact, of the relief, of its corner
      integer :: inner, outer

      direction = 0
      inner = merge(zone_none, corner, border == 1)
      outer = merge(corner, mine, border == 1 .and. has_corner(relief))
      if (zone == inner) direction = mine
      if (zone == outer) direction = -mine
   end function border_direction

   !> Direction at the end of a flank that is extended up to its edge contact.
   pure integer function end_direction(zone) result(direction)
      integer, intent(in) :: zone

      direction = 0
      if (zone < zone_edge) direction = merge(-1, 1, zone == zone_end)
   end function end_direction

   !> Direction at the start of edge contact, from the flank or from its extension.
   pure integer function edge_direction(tip, zone) result(direction)
      type(tip_t), intent(in) :: tip
      integer, intent(in) :: zone

      direction = 0
      if (zone == zone_edge) direction = -1
      if (zone == zone_end .or. (zone < zone_end .and. .not. tip%takes_over > 0)) direction = 1
   end function edge_direction

   !> Whether a kind with a side has a meaning in a mode.
   pure logical function has_side(mode, live)
      type(contact_mode), intent(in) :: mode
      integer, intent(in) :: live !! as in the kind's row

      select case (live)
      case (live_touching, live_one_sided, live_bends_a, live_bends_b)
         has_side = touches(mode)
      case (live_loaded)
         has_side = mode%flanks == flanks_loaded
      case (live_on_path)
         has_side = mode%flanks /= flanks_off .and. mode%flanks /= flanks_apart
      case default
         has_side = .false.
      end select
   end function has_side

   !> List the root functions of a contact that have a meaning in at least one of its modes, with their directions in each mode.
   pure subroutine list_roots(contact)
      type(tooth_contact_t), intent(inout) :: contact !! complete except for the list
      integer :: directions(zone_tip_corner:zone_edge, flanks_open:flanks_off), kind, flanks, branch

      contact%n_roots = 0
      do kind = 1, n_root_kinds
         if (.not. can_fire(contact, kind)) cycle
         do flanks = flanks_open, flanks_off
            do branch = zone_tip_corner, zone_edge ! of friction, the zones or the sides
               directions(branch, flanks) = contact_root_direction( &
                                            contact, contact_mode(0, flanks, branch, branch, branch, branch, 1.0_wp, 0.0_wp), kind)
            end do
         end do
         if (all(directions == 0)) cycle
         contact%n_roots = contact%n_roots + 1
         associate (n => contact%n_roots)
            contact%roots(n) = kind
            contact%moved(n) = root_rows(kind)%moves
            if (kind > n_root_kinds - n_sides) contact%moved(n) = n_held + kind - (n_root_kinds - n_sides)
            contact%directions(:, :, n) = directions
         end associate
      end do
   end subroutine list_roots

   !> Copy the root functions of another contact of the same flank, which has the same laws, wheels and deviations.
   pure subroutine share_roots(other, contact)
      type(tooth_contact_t), intent(in) :: other
      type(tooth_contact_t), intent(inout) :: contact

      contact%n_roots = other%n_roots
      contact%roots = other%roots
      contact%moved = other%moved
      contact%directions = other%directions
   end subroutine share_roots

   !> Whether a root function is past the zero that ends its mode.
   elemental logical function is_past(direction, root, by)
      integer, intent(in) :: direction !! as from `contact_root_directions`
      real(wp), intent(in) :: root
      real(wp), intent(in) :: by !! least distance past the zero, in units of the root function; < 0: largest distance before it

      is_past = direction /= 0 .and. direction*root > by
   end function is_past

   !> Root functions of a contact that passed zero, by kind; false for kinds that it does not have.
   pure function by_kind(contact, fired) result(marks)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: fired(:) !! of the gearbox: not 0 where a root function passed zero
      logical :: marks(n_root_kinds)
      integer :: i

      marks = .false.
      do i = 1, contact%n_roots
         marks(contact%roots(i)) = fired(contact%i_root + i) /= 0
      end do
   end function by_kind

   !> The sides on which a contact point lies.
   pure subroutine find_sides(flank, contact, at)
      class(flank_t), intent(in) :: flank
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(inout) :: at !! with the results of its flank, if it touches
      real(wp) :: quantity(width), foot(2)
      integer :: i, kind

      foot = feet_of(at)
      associate (point => at%point)
         do i = 1, n_sides
            kind = n_root_kinds - n_sides + i
            call root_quantity(flank, contact, at%mode, kind, [at%overlap], [point%h_dot], [point%v_t], [point%rho_a], &
                               [point%rho_b], [foot(by_a)], [foot(by_b)], [unclipped(at)], [0.0_wp], quantity)
            at%mode%sides(i) = merge(1, -1, quantity(1) > root_rows(kind)%border)
         end do
      end associate
   end subroutine find_sides

   !> Pitches by which the driving wheel has advanced since a pair with handover took over [1].
   pure real(wp) function pitches_since_handover(contact, at) result(pitches)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      real(wp) :: moved(width)

      moved = pitches_moved(contact, [at%rho_a0], [at%q(at_psi_a)], [centre_line_turn(contact%pair, at%q)])
      pitches = moved(1)
   end function pitches_since_handover

   !> Distances of a tooth pair from the ends of the path of contact, in pitches; not negative while it is on the path.
   pure subroutine ends_of_path(flank, contact, point, near, far)
      class(flank_t), intent(in) :: flank
      type(tooth_contact_t), intent(in) :: contact
      type(contact_point), intent(in) :: point
      real(wp), intent(out) :: near, far !! from the end where pairs enter in the nominal sense of rotation, and from the other
      real(wp), dimension(width) :: distance

      call path_end(flank, contact, [point%rho_a], [point%rho_b], 0, .false., distance)
      near = distance(1)
      call path_end(flank, contact, [point%rho_a], [point%rho_b], 0, .true., distance)
      far = distance(1)
   end subroutine ends_of_path

end module evl_contact_roots
