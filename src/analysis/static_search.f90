!> Search for the extremes of a quasi-static analysis: the extremes found so far, and candidates for larger ones.
!>
!> A parabola through three neighbouring positions without a border between them predicts where an extreme may exceed those found so
!> far. The mesh is solved there, repeatedly until the extreme converges.
module evl_static_search
   use evl_kinds, only: wp
   use evl_static_mesh, only: solve_static, static_mesh_t, static_state
   use evl_pair_point, only: by_a, by_b
   use evl_static_node, only: n_quantities, node_of, of_force, of_h, of_less_h, of_less_root, of_root, quantity_at, &
                              static_node
   use evl_static_roots, only: root_record_t, static_roots_t
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: close, follow_candidates, list_candidates, record, rho_at, solve_at, static_search, vertex

   real(wp), parameter :: close = 1.0e-9_wp   !! distance of both sides of a located border [pitches]
   real(wp), parameter :: enough = 1.0e-6_wp  !! minimum gain of a new extreme, relative to its value, or to the range for h
   integer, parameter :: most_steps = 12      !! maximum number of iterations for an extreme

   !> Three neighbours between which a quantity may exceed its extreme.
   type :: candidate_t
      integer :: quantity = 0, pair = 0
      type(static_node) :: nodes(3)
      real(wp) :: most = 0.0_wp !! estimate of the maximum
   end type candidate_t

   !> State of a search.
   type :: static_search
      type(tooth_contact_t), pointer :: contact => null()
      type(static_mesh_t), pointer :: mesh => null()
      type(static_roots_t) :: roots
      real(wp) :: rho_a = 0.0_wp !! of pair 0 at position 0 [m]
      integer :: turns = 1       !! +1 or -1: sense of its motion
      real(wp) :: force = 0.0_wp !! total tooth force [N]
      real(wp) :: at = 0.0_wp    !! last position solved [pitches]
      real(wp) :: records(n_quantities) = -huge(1.0_wp)
      type(root_record_t) :: largest(2), least(2) !! root stress of both wheels
      type(static_node) :: piece(3) !! the last nodes of the current piece
      integer :: n_in_piece = 0     !! their number, at most 3
      integer :: n_candidates = 0
      type(candidate_t), allocatable :: candidates(:)
   end type static_search

contains

   !> rho_A of pair 0 at a position [m].
   pure real(wp) function rho_at(self, x)
      type(static_search), intent(in) :: self
      real(wp), intent(in) :: x

      rho_at = self%rho_a + self%turns*(x*self%mesh%base_pitch)
   end function rho_at

   !> Solve the mesh at a position between two others.
   subroutine solve_at(self, x, left, right, node, status)
      type(static_search), intent(inout) :: self
      real(wp), intent(in) :: x
      type(static_node), intent(in) :: left, right
      type(static_node), intent(out) :: node
      type(status_t), intent(inout) :: status
      type(static_state) :: state

      self%at = x
      if (self%mesh%reach > 0) then
         call solve_static(self%mesh, rho_at(self, x), self%force, state, status, &
                           left%h + (right%h - left%h)*(x - left%x)/(right%x - left%x))
      else ! two states may exist at an end of the path: start as at the positions
         call solve_static(self%mesh, rho_at(self, x), self%force, state, status)
      end if
      if (.not. has_failed(status)) node = node_of(x, rho_at(self, x), self%turns, self%contact, self%mesh, self%roots, state)
   end subroutine solve_at

   !> Vertex of a parabola with a maximum.
   pure subroutine vertex(x, f, at, most, interval)
      real(wp), intent(in) :: x(3), f(3)
      real(wp), intent(out) :: at, most
      integer, intent(out) :: interval !! interval 1 or 2 that contains it; 0: none
      real(wp) :: bend, slope

      interval = 0
      at = x(2)
      most = maxval(f)
      slope = (f(2) - f(1))/(x(2) - x(1))
      bend = ((f(3) - f(2))/(x(3) - x(2)) - slope)/(x(3) - x(1))
      if (.not. bend < 0) return
      at = (x(1) + x(2))/2 - slope/(2*bend)
      if (.not. (x(1) < at .and. at < x(3))) return
      most = max(most, f(1) + (at - x(1))*(slope + bend*(at - x(2))))
      interval = merge(1, 2, at < x(2))
   end subroutine vertex

   !> Process the candidates in descending order of gain until none can exceed an extreme.
   subroutine follow_candidates(self, status)
      type(static_search), intent(inout) :: self
      type(status_t), intent(inout) :: status
      type(candidate_t) :: candidate
      integer :: i, best

      do
         best = 0
         do i = 1, self%n_candidates
            if (.not. may_exceed(self, self%candidates(i)%quantity, self%candidates(i)%most)) cycle
            if (best > 0) then
               if (gain(self, self%candidates(i)) <= gain(self, self%candidates(best))) cycle
            end if
            best = i
         end do
         if (best == 0) exit
         candidate = self%candidates(best)
         self%candidates(best) = self%candidates(self%n_candidates)
         self%n_candidates = self%n_candidates - 1
         call follow(self, candidate, status)
         if (has_failed(status)) return
      end do
   end subroutine follow_candidates

   !> Update the extremes with the values at a node.
   pure subroutine record(self, node)
      type(static_search), intent(inout) :: self
      type(static_node), intent(in) :: node
      integer :: i, quantity

      do quantity = 1, of_force - 1
         self%records(quantity) = max(self%records(quantity), quantity_at(node, quantity, 0))
      end do
      do quantity = of_force, n_quantities
         do i = 1, node%n
            associate (value => quantity_at(node, quantity, node%numbers(i)))
               if (quantity >= of_root(by_a) .and. value > self%records(quantity)) call record_root(self, node, quantity, i)
               self%records(quantity) = max(self%records(quantity), value)
            end associate
         end do
      end do
   end subroutine record

   !> Store where the root stress has an extreme.
   pure subroutine record_root(self, node, quantity, i)
      type(static_search), intent(inout) :: self
      type(static_node), intent(in) :: node
      integer, intent(in) :: quantity !! of `of_root` or `of_less_root`
      integer, intent(in) :: i        !! index of the pair
      real(wp) :: position

      position = modulo(node%x, real(self%roots%n_pitches, wp))
      if (quantity <= of_root(by_b)) then
         associate (wheel => quantity - of_root(by_a) + 1)
            if (node%roots(wheel, i)%largest > 0) self%largest(wheel) = &
               root_record_t(node%roots(wheel, i)%largest, node%roots(wheel, i)%arc_largest, position, &
                             node%roots(wheel, i)%tooth_largest)
         end associate
      else
         associate (wheel => quantity - of_less_root(by_a) + 1)
            if (node%roots(wheel, i)%least < 0) self%least(wheel) = &
               root_record_t(node%roots(wheel, i)%least, node%roots(wheel, i)%arc_least, position, &
                             node%roots(wheel, i)%tooth_least)
         end associate
      end if
   end subroutine record_root

   !> Whether a value exceeds an extreme significantly.
   pure logical function may_exceed(self, quantity, value)
      type(static_search), intent(in) :: self
      integer, intent(in) :: quantity
      real(wp), intent(in) :: value

      may_exceed = value > self%records(quantity) + enough*scale_of(self, quantity)
   end function may_exceed

   !> Scale of an extreme: its value, or the range for h.
   pure real(wp) function scale_of(self, quantity) result(scale)
      type(static_search), intent(in) :: self
      integer, intent(in) :: quantity

      scale = abs(self%records(quantity))
      if (quantity <= of_less_h) scale = self%records(of_h) + self%records(of_less_h)
   end function scale_of

   !> Predicted gain of a candidate, relative to the scale of its extreme.
   pure real(wp) function gain(self, candidate)
      type(static_search), intent(in) :: self
      type(candidate_t), intent(in) :: candidate

      associate (quantity => candidate%quantity)
         gain = (candidate%most - self%records(quantity))/max(scale_of(self, quantity), tiny(gain))
      end associate
   end function gain

   !> List the candidates between three nodes of a piece.
   subroutine list_candidates(self, nodes)
      type(static_search), intent(inout) :: self
      type(static_node), intent(in) :: nodes(3)
      integer :: i, quantity

      do quantity = 1, of_force - 1
         call list_candidate(self, nodes, quantity, 0)
      end do
      do i = 1, nodes(2)%n
         if (.not. nodes(2)%force(i) > 0) cycle
         do quantity = of_force, n_quantities
            call list_candidate(self, nodes, quantity, nodes(2)%numbers(i))
         end do
      end do
   end subroutine list_candidates

   !> List a candidate if it can exceed its extreme.
   subroutine list_candidate(self, nodes, quantity, pair)
      type(static_search), intent(inout) :: self
      type(static_node), intent(in) :: nodes(3)
      integer, intent(in) :: quantity, pair
      type(candidate_t), allocatable :: more(:)
      type(candidate_t) :: found
      real(wp) :: values(3), x
      integer :: i, interval

      values = [(quantity_at(nodes(i), quantity, pair), i=1, 3)]
      call vertex(nodes%x, values, x, found%most, interval)
      if (interval == 0) return
      found%most = found%most + (found%most - maxval(values))
      if (.not. may_exceed(self, quantity, found%most)) return
      found%quantity = quantity
      found%pair = pair
      found%nodes = nodes
      if (.not. allocated(self%candidates)) allocate (self%candidates(16))
      if (self%n_candidates == size(self%candidates)) then
         allocate (more(2*size(self%candidates)))
         more(:self%n_candidates) = self%candidates
         call move_alloc(more, self%candidates)
      end if
      self%n_candidates = self%n_candidates + 1
      self%candidates(self%n_candidates) = found
   end subroutine list_candidate

   !> Iterate to the extreme between three nodes with the vertices of parabolas.
   subroutine follow(self, candidate, status)
      type(static_search), intent(inout) :: self
      type(candidate_t), intent(in) :: candidate
      type(status_t), intent(inout) :: status
      type(static_node) :: nodes(3), node
      real(wp) :: values(3), most, x
      integer :: best, i, interval, step

      nodes = candidate%nodes
      do step = 1, most_steps
         values = [(quantity_at(nodes(i), candidate%quantity, candidate%pair), i=1, 3)]
         call vertex(nodes%x, values, x, most, interval)
         if (interval == 0) return
         most = most + (most - maxval(values))
         if (.not. may_exceed(self, candidate%quantity, most)) return
         if (minval(abs(x - nodes%x)) <= close) return
         call solve_at(self, x, nodes(1), nodes(3), node, status)
         if (has_failed(status)) return
         call record(self, node)
         best = maxloc(values, dim=1)
         if (best /= 2 .or. quantity_at(node, candidate%quantity, candidate%pair) > values(2)) then ! between its neighbours
            nodes = merge_three(nodes(interval), node, nodes(interval + 1))
         else if (interval == 1) then
            nodes = merge_three(node, nodes(2), nodes(3))
         else
            nodes = merge_three(nodes(1), nodes(2), node)
         end if
      end do
   end subroutine follow

   !> Three nodes as an array.
   pure function merge_three(left, middle, right) result(nodes)
      type(static_node), intent(in) :: left, middle, right
      type(static_node) :: nodes(3)

      nodes(1) = left
      nodes(2) = middle
      nodes(3) = right
   end function merge_three

end module evl_static_search
