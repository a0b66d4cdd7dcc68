!> A position of a mesh for the search for quasi-static extremes: the transmission error, and for each tooth pair its force, contact
!> pressure and zones between the borders of both flanks.
!>
!> Between two positions the quantities are smooth functions unless a tooth pair crosses a border. There it starts or stops
!> carrying load, or it passes the end of a relief, of its corner, of a flank, or of the defined range of its tip corner. Each
!> border has a function of the position that changes sign there.
module evl_static_node
   use evl_contact_curvature, only: contact_curvature, pressure_at
   use evl_contact_point, only: contact_point
   use evl_coupled_pairs, only: most_pairs
   use evl_flank_deviation, only: zone_edge, zone_end, zone_none, zone_root, zone_root_corner, zone_tip, zone_tip_corner
   use evl_kinds, only: wp
   use evl_pair_point, only: by_a, by_b, edge_of
   use evl_static_mesh, only: static_mesh_t, static_state
   use evl_static_roots, only: find_static_roots, static_roots_t
   use evl_tooth_contact, only: contact_mode, no_mode, settle_zones, tooth_contact_t
   use evl_tooth_root, only: root_extremes_t
   implicit none (type, external)
   private

   public :: border_of, border_t, index_of, node_of, passes, quantity_at, static_node, touch, value_at
   public :: n_quantities, of_edge_force, of_force, of_h, of_less_h, of_less_root, of_less_stiffness, of_pressure, of_root, &
             of_sharp_force, of_stiffness

   !> Zones of a flank in ascending order of their radii of curvature, and the number of borders between them.
   integer, parameter :: in_order(7) = [zone_root, zone_root_corner, zone_none, zone_tip_corner, zone_tip, zone_end, zone_edge]
   integer, parameter :: n_borders = size(in_order) - 1

   ! Quantities to be maximised: of the mesh, then of its tooth pairs.
   integer, parameter :: of_h = 1, of_less_h = 2, of_stiffness = 3, of_less_stiffness = 4, of_force = 5, of_pressure = 6, &
                         of_edge_force = 7, of_sharp_force = 8
   ! Root stress of the teeth of a pair, and minus the least one: both wheels.
   integer, parameter :: of_root(2) = [9, 10], of_less_root(2) = [11, 12], n_quantities = 12

   !> Data at a position.
   type :: static_node
      real(wp) :: x = 0.0_wp          !! position [pitches]
      real(wp) :: h = 0.0_wp          !! transmission error [m]
      real(wp) :: stiffness = 0.0_wp  !! dF/dh [N/m]
      real(wp) :: rho_a = 0.0_wp      !! of pair 0 [m]
      integer :: n = 0                !! number of pairs
      integer :: numbers(most_pairs) = 0
      logical :: on_edge(most_pairs) = .false.
      logical :: is_bare(most_pairs) = .false. !! no contact pressure exists, as on a sharp edge
      integer :: ranks(2, most_pairs) = 0      !! zones of A and B as indices in `in_order`; 0: the pair carries no load
      integer :: bends(2, most_pairs) = 0      !! number of ends of the smooth range of c that the contact has passed; 0: no load
      real(wp) :: force(most_pairs) = 0.0_wp   !! normal force [N]
      real(wp) :: pressure(most_pairs) = 0.0_wp !! contact pressure; 0 if unknown [Pa]
      real(wp) :: overlap(most_pairs) = 0.0_wp !! as in `static_state` [m]
      real(wp) :: foot(2, most_pairs) = 0.0_wp !! roll lengths of the loaded points on A and B [m]
      type(root_extremes_t) :: roots(2, most_pairs) !! of the pairs' teeth; zeros without root stress
   end type static_node

   !> A border that a tooth pair crosses between two positions.
   type :: border_t
      logical :: exists = .false.
      integer :: pair = 0    !! number of the tooth pair
      integer :: wheel = 0   !! by_a or by_b; 0: the pair starts or stops carrying load
      integer :: number = 0  !! border between zone `number` and the next one; or an end of the smooth range of c
      logical :: of_path = .false. !! the pair starts or stops carrying load at the end of its path
   end type border_t

contains

   !> Node of a state.
   pure type(static_node) function node_of(x, rho_a, turns, contact, mesh, roots, state) result(node)
      real(wp), intent(in) :: x               !! [pitches]
      real(wp), intent(in) :: rho_a           !! of pair 0 there [m]
      integer, intent(in) :: turns            !! +1 or -1: sense of the contact's pair numbers relative to those of the mesh
      type(tooth_contact_t), intent(in) :: contact
      type(static_mesh_t), intent(in) :: mesh
      type(static_roots_t), intent(in) :: roots
      type(static_state), intent(in) :: state
      type(contact_mode) :: mode
      real(wp) :: pressure
      integer :: i

      node%x = x
      node%h = state%h
      node%stiffness = state%stiffness
      node%rho_a = rho_a
      node%n = state%n
      node%numbers = state%numbers
      node%overlap = state%overlap
      do i = 1, state%n
         node%foot(:, i) = state%feet(i)%foot
         node%force(i) = state%potential%solution%force(i)*mesh%width
         if (.not. node%force(i) > 0) cycle
         node%on_edge(i) = state%feet(i)%zone >= edge_of(by_a)
         call touch(contact, turns*state%numbers(i), mesh, state, i, mode, pressure)
         if (pressure > 0) node%pressure(i) = pressure
         node%is_bare(i) = .not. pressure > 0
         node%bends(by_a, i) = count(node%foot(by_a, i) > contact%smooth(:, by_a))
         node%bends(by_b, i) = count(node%foot(by_b, i) > contact%smooth(:, by_b))
         node%ranks(:, i) = [findloc(in_order, mode%zone_a, dim=1), findloc(in_order, mode%zone_b, dim=1)]
      end do
      if (associated(roots%a) .or. associated(roots%b)) call find_static_roots(roots, contact, turns, x, state, node%roots)
   end function node_of

   !> Zones and maximum contact pressure of a loaded pair.
   pure subroutine touch(contact, number, mesh, state, i, mode, pressure)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: number !! of the contact's tooth pair
      type(static_mesh_t), intent(in) :: mesh
      type(static_state), intent(in) :: state
      integer, intent(in) :: i
      type(contact_mode), intent(out) :: mode
      real(wp), intent(out) :: pressure !! NaN on a sharp edge [Pa]
      type(contact_point) :: point

      associate (feet => state%feet(i), force => state%potential%solution%force(i)*mesh%width)
         point%rho_a = feet%rho(by_a)
         point%rho_b = feet%rho(by_b)
         mode = no_mode
         mode%tooth_pair = number
         call settle_zones(contact, mesh%line, point, mode)
         pressure = pressure_at(contact, force, contact_curvature(contact, mode, point, feet%foot))
      end associate
   end subroutine touch

   !> Index of a tooth pair among the pairs of a node; 0: not found.
   pure integer function index_of(node, pair) result(i)
      type(static_node), intent(in) :: node
      integer, intent(in) :: pair

      i = 0
      if (node%n > 0) i = findloc(node%numbers(:node%n), pair, dim=1)
   end function index_of

   !> Whether a pair carries load.
   pure logical function carries(node, pair)
      type(static_node), intent(in) :: node
      integer, intent(in) :: pair
      integer :: i

      i = index_of(node, pair)
      carries = .false.
      if (i > 0) carries = node%force(i) > 0
   end function carries

   !> Value of a quantity at a node; 0 for a pair that is not there.
   pure real(wp) function quantity_at(node, quantity, pair) result(value)
      type(static_node), intent(in) :: node
      integer, intent(in) :: quantity, pair
      integer :: i

      value = 0
      i = 0
      if (quantity >= of_force) then
         i = index_of(node, pair)
         if (i == 0) return
      end if
      select case (quantity)
      case (of_h)
         value = node%h
      case (of_less_h)
         value = -node%h
      case (of_stiffness)
         value = node%stiffness
      case (of_less_stiffness)
         value = -node%stiffness
      case (of_force)
         value = node%force(i)
      case (of_pressure)
         value = node%pressure(i)
      case (of_edge_force)
         value = merge(node%force(i), 0.0_wp, node%on_edge(i))
      case (of_sharp_force)
         value = merge(node%force(i), 0.0_wp, node%on_edge(i) .and. node%is_bare(i))
      case (of_root(by_a), of_root(by_b))
         value = node%roots(quantity - of_root(by_a) + 1, i)%largest
      case (of_less_root(by_a), of_less_root(by_b))
         value = -node%roots(quantity - of_less_root(by_a) + 1, i)%least
      end select
   end function quantity_at

   !> A border between two nodes, if any.
   pure type(border_t) function border_of(left, right) result(border)
      type(static_node), intent(in) :: left, right
      integer :: i, j, pair, w

      do pair = min(minval(left%numbers(:left%n)), minval(right%numbers(:right%n))), &
         max(maxval(left%numbers(:left%n)), maxval(right%numbers(:right%n)))
         i = index_of(left, pair)
         j = index_of(right, pair)
         if (carries(left, pair) .neqv. carries(right, pair)) then
            border = border_t(.true., pair, of_path=i == 0 .or. j == 0)
            return
         end if
         if (.not. carries(left, pair)) cycle
         do w = by_a, by_b
            if (left%ranks(w, i) /= right%ranks(w, j)) then
               border = border_t(.true., pair, w, min(left%ranks(w, i), right%ranks(w, j)))
               return
            else if (left%bends(w, i) /= right%bends(w, j)) then
               border = border_t(.true., pair, w, n_borders + 1 + min(left%bends(w, i), right%bends(w, j)))
               return
            end if
         end do
      end do
      border = border_t()
   end function border_of

   !> Side of a border on which a node lies: true if the pair carries load, or is in a zone beyond the border.
   pure logical function passes(node, border)
      type(static_node), intent(in) :: node
      type(border_t), intent(in) :: border
      integer :: i

      passes = carries(node, border%pair)
      if (border%wheel == 0 .or. .not. passes) return
      i = index_of(node, border%pair)
      if (border%number <= n_borders) then
         passes = node%ranks(border%wheel, i) > border%number
      else
         passes = node%bends(border%wheel, i) > border%number - n_borders - 1
      end if
   end function passes

   !> Function of a border: positive where a node passes it, except for rounding [m].
   pure real(wp) function value_at(node, border, contact, mesh) result(value)
      type(static_node), intent(in) :: node
      type(border_t), intent(in) :: border
      type(tooth_contact_t), intent(in) :: contact
      type(static_mesh_t), intent(in) :: mesh
      real(wp) :: rho(2), borders(n_borders + 2)
      integer :: i

      i = index_of(node, border%pair)
      rho(by_a) = node%rho_a - border%pair*mesh%base_pitch
      rho(by_b) = mesh%line + node%h - rho(by_a)
      if (border%wheel > 0 .and. i > 0) then
         associate (w => border%wheel)
            borders = [borders_of(contact, w), contact%smooth(:, w)]
            value = merge(rho(w), node%foot(w, i), border%number == 5 .or. border%number == 6) - borders(border%number)
         end associate
      else if (border%of_path .or. i == 0) then
         value = minval(mesh%tips%edge%rho_end + mesh%reach - rho)
      else
         value = node%overlap(i)
      end if
   end function value_at

   !> Radii of curvature at the borders of a wheel's flank [m]; missing borders are set to the next one outwards.
   pure function borders_of(contact, wheel) result(borders)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: wheel
      real(wp) :: borders(n_borders)

      associate (tip => contact%tips(wheel))
         borders(5:) = [tip%leaves, tip%edge%rho_end + tip%takes_over]
         borders(:4) = tip%leaves
      end associate
      if (wheel == by_a) then
         associate (of => contact%deviation_a)
            if (of%root%amount > 0) borders(:2) = of%root%taken(2:1:-1)
            if (of%tip%amount > 0) borders(3:4) = of%tip%taken
         end associate
      else
         associate (of => contact%deviation_b)
            if (of%root%amount > 0) borders(:2) = of%root%taken(2:1:-1)
            if (of%tip%amount > 0) borders(3:4) = of%tip%taken
         end associate
      end if
   end function borders_of

end module evl_static_node
