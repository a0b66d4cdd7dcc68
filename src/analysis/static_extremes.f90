!> Extremes of a quasi-static analysis over all positions, including extremes between the positions evaluated.
!>
!> Positions are processed in order. If a tooth pair crosses a border between two of them, the border is located, and the limits
!> from both sides are included. A pair that touches only between two positions is found from the parabola of its overlap. The
!> smooth pieces between borders are passed to evl_static_search.
!>
!> Source: docs/guides/static_analysis.md.
module evl_static_extremes
   use evl_kinds, only: wp
   use evl_static_mesh, only: static_state
   use evl_static_node, only: border_of, border_t, index_of, node_of, of_edge_force, of_force, of_h, of_less_h, of_less_stiffness, &
                              of_pressure, of_sharp_force, of_stiffness, passes, static_node, value_at
   use evl_static_search, only: close, follow_candidates, list_candidates, record, rho_at, solve_at, static_search, vertex
   use evl_static_roots, only: root_record_t
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: extremes_t, finish_extremes, n_before, take_position

   integer, parameter :: n_before = 2 !! positions before the first one: parabolas include it and, by periodicity, the end

   integer, parameter :: most_turns = 60      !! maximum number of iterations to locate a border
   integer, parameter :: deepest = 40         !! maximum number of borders between two positions

   !> Extreme values.
   type :: extremes_t
      real(wp) :: lowest_h = 0.0_wp, highest_h = 0.0_wp !! transmission error minus backlash [m]
      real(wp) :: softest = 0.0_wp, stiffest = 0.0_wp   !! tangent stiffness [N/m]
      real(wp) :: force = 0.0_wp      !! largest force of a tooth pair [N]
      real(wp) :: pressure = 0.0_wp   !! largest known contact pressure [Pa]
      real(wp) :: edge_force = 0.0_wp !! largest force of a tip edge [N]
      real(wp) :: sharp_force = 0.0_wp !! largest force of a tip edge without a contact pressure [N]
      type(root_record_t) :: largest_root(2), least_root(2) !! root stress of the driving and the driven wheel
   end type extremes_t

contains

   !> Process the next position, whose state has been computed.
   subroutine take_position(self, x, state, node, status)
      type(static_search), intent(inout) :: self
      real(wp), intent(in) :: x !! [pitches]
      type(static_state), intent(in) :: state
      type(static_node), intent(out) :: node
      type(status_t), intent(inout) :: status
      type(static_node) :: last

      node = node_of(x, rho_at(self, x), self%turns, self%contact, self%mesh, self%roots, state)
      if (self%n_in_piece == 0) then
         call push(self, node, .false., status)
      else
         last = self%piece(self%n_in_piece)
         call pass(self, last, node, .true., 0, status)
      end if
   end subroutine take_position

   !> Return the extremes after the last position.
   subroutine finish_extremes(self, extremes, status)
      type(static_search), intent(inout) :: self
      type(extremes_t), intent(out) :: extremes
      type(status_t), intent(inout) :: status

      call follow_candidates(self, status)
      if (has_failed(status)) return
      extremes = extremes_t(-self%records(of_less_h), self%records(of_h), -self%records(of_less_stiffness), &
                            self%records(of_stiffness), max(self%records(of_force), 0.0_wp), &
                            max(self%records(of_pressure), 0.0_wp), max(self%records(of_edge_force), 0.0_wp), &
                            max(self%records(of_sharp_force), 0.0_wp), self%largest, self%least)
   end subroutine finish_extremes

   !> Step from one node to the next one, locating all borders between them.
   recursive subroutine pass(self, left, right, looks, depth, status)
      type(static_search), intent(inout) :: self
      type(static_node), intent(in) :: left  !! the last node of the current piece
      type(static_node), intent(in) :: right
      logical, intent(in) :: looks           !! check for pairs that touch only between the nodes
      integer, intent(in) :: depth
      type(status_t), intent(inout) :: status
      type(border_t) :: border
      type(static_node) :: before, behind
      real(wp) :: x

      border = border_of(left, right)
      if (.not. border%exists) then
         if (looks) then
            if (touches_between(self, right, x)) then
               call solve_at(self, x, left, right, before, status)
               if (.not. has_failed(status)) call pass(self, left, before, .false., depth + 1, status)
               if (.not. has_failed(status)) call pass(self, before, right, .false., depth + 1, status)
               return
            end if
         end if
         call push(self, right, .false., status)
      else if (right%x - left%x <= close .or. depth > deepest) then
         call push(self, right, .true., status)
      else
         before = left
         behind = right
         call locate(self, border, before, behind, status)
         if (has_failed(status)) return
         if (before%x > left%x) call approach(self, left, before, ends_steeply(border, before), .false., depth + 1, status)
         if (.not. has_failed(status)) call pass(self, before, behind, .false., depth + 1, status)
         if (behind%x < right%x .and. .not. has_failed(status)) &
            call approach(self, behind, right, .false., ends_steeply(border, behind), depth + 1, status)
      end if
   end subroutine pass

   !> Whether quantities are steep at a border: where a pair starts to carry load, its stiffness grows from 0 as 1/ln(1/force).
   pure logical function ends_steeply(border, node)
      type(border_t), intent(in) :: border
      type(static_node), intent(in) :: node !! at the border

      ends_steeply = border%wheel == 0 .and. passes(node, border)
   end function ends_steeply

   !> Step from one node to the next one, with additional nodes near a steep end.
   recursive subroutine approach(self, left, right, right_is_steep, left_is_steep, depth, status)
      type(static_search), intent(inout) :: self
      type(static_node), intent(in) :: left, right
      logical, intent(in) :: right_is_steep, left_is_steep
      integer, intent(in) :: depth
      type(status_t), intent(inout) :: status
      real(wp), parameter :: parts(2) = [0.05_wp, 0.3_wp]
      type(static_node) :: last, node
      real(wp) :: x
      integer :: i

      last = left
      if ((right_is_steep .or. left_is_steep) .and. right%x - left%x > sqrt(close)) then
         do i = 1, size(parts)
            x = left%x + (right%x - left%x)*merge(1 - parts(size(parts) + 1 - i), parts(i), right_is_steep)
            call solve_at(self, x, left, right, node, status)
            if (.not. has_failed(status)) call pass(self, last, node, .false., depth + 1, status)
            if (has_failed(status)) return
            last = node
         end do
      end if
      call pass(self, last, right, .false., depth + 1, status)
   end subroutine approach

   !> Locate a border: regula falsi with halving of the value at a retained end (Illinois), bisection if that stalls.
   subroutine locate(self, border, left, right, status)
      type(static_search), intent(inout) :: self
      type(border_t), intent(in) :: border
      type(static_node), intent(inout) :: left, right !! nodes on both sides of it
      type(status_t), intent(inout) :: status
      type(static_node) :: node
      real(wp) :: at_left, at_right, x, width
      logical :: side
      integer :: turn, stays

      side = passes(left, border)
      at_left = value_at(left, border, self%contact, self%mesh)
      at_right = value_at(right, border, self%contact, self%mesh)
      stays = 0
      do turn = 1, most_turns
         width = right%x - left%x
         if (width <= close) return
         x = (left%x + right%x)/2
         if (at_left*at_right < 0 .and. mod(turn, 8) > 0) &
            x = min(max(left%x - at_left*(width/(at_right - at_left)), left%x + close/2), right%x - close/2)
         call solve_at(self, x, left, right, node, status)
         if (has_failed(status)) return
         if (passes(node, border) .eqv. side) then
            left = node
            at_left = value_at(node, border, self%contact, self%mesh)
            if (stays > 0) at_right = at_right/2
            stays = 1
         else
            right = node
            at_right = value_at(node, border, self%contact, self%mesh)
            if (stays < 0) at_left = at_left/2
            stays = -1
         end if
      end do
   end subroutine locate

   !> Whether, and where, a pair may touch or separate between the last node and another one although it does not at either.
   logical function touches_between(self, right, x)
      type(static_search), intent(in) :: self
      type(static_node), intent(in) :: right
      real(wp), intent(out) :: x
      real(wp) :: most, side, values(3)
      integer :: i, k, n, indices(3)

      touches_between = .false.
      x = 0
      n = self%n_in_piece
      if (n < 2) return
      associate (first => self%piece(n - 1), left => self%piece(n))
         do i = 1, right%n
            indices = [index_of(first, right%numbers(i)), index_of(left, right%numbers(i)), i]
            if (any(indices == 0)) cycle
            values = [first%overlap(indices(1)), left%overlap(indices(2)), right%overlap(i)]
            side = merge(-1.0_wp, 1.0_wp, right%force(i) > 0)
            values = side*values
            if (any(values >= 0)) cycle
            call vertex([first%x, left%x, right%x], values, x, most, k)
            if (k /= 2) cycle ! not between the last two
            touches_between = most + (most - max(values(2), values(3))) > 0
            if (touches_between) return
         end do
      end associate
   end function touches_between

   !> Append a node to the current piece, or start a new piece with it.
   subroutine push(self, node, starts, status)
      type(static_search), intent(inout) :: self
      type(static_node), intent(in) :: node
      logical, intent(in) :: starts !! start a new piece: a border lies before the node
      type(status_t), intent(inout) :: status
      type(static_node) :: nodes(3)

      call record(self, node)
      if (starts) then
         if (self%n_in_piece == 2) then ! no node was evaluated between its borders
            nodes(1) = self%piece(1)
            nodes(3) = self%piece(2)
            if (nodes(3)%x - nodes(1)%x > sqrt(close)) then
               call solve_at(self, (nodes(1)%x + nodes(3)%x)/2, nodes(1), nodes(3), nodes(2), status)
               if (has_failed(status)) return
               call record(self, nodes(2))
               call list_candidates(self, nodes)
            end if
         end if
         self%n_in_piece = 0
      else if (self%n_in_piece == 3) then
         self%piece(:2) = self%piece(2:)
         self%n_in_piece = 2
      end if
      self%n_in_piece = self%n_in_piece + 1
      self%piece(self%n_in_piece) = node
      if (self%n_in_piece == 3) call list_candidates(self, self%piece)
   end subroutine push

end module evl_static_extremes
