!> Condensation of a body onto some of its unknowns, by frontal elimination, for several supports at once.
!>
!> Elements are assembled group by group. Unknowns that belong to a single group and are free under all supports are eliminated
!> first, once for all supports. The group is then added to the front of each support. There an unknown is eliminated after its last
!> group, unless it is retained; fixed unknowns are never added. Loads are additional rows, starting with the first group on which
!> they act. From [K, f; f^T, 0], elimination leaves the stiffness of the retained unknowns, their share of the loads, f_k - K_ke
!> K_ee^-1 f_e, and -f_e^T K_ee^-1 f_e, the compliance with the retained unknowns fixed.
!>
!> Source: Irons 1970, frontal solution; Duff, Reid 1983, multifrontal solution.
module evl_front
   use evl_condensation, only: symmetric_t
   use evl_indices, only: indices
   use evl_kinds, only: wp
   use evl_lobatto, only: lobatto_rule
   use evl_plane_element, only: elasticity_t, element_stiffness
   use evl_plane_mesh, only: element_points, plane_mesh_t
   implicit none (type, external)
   private

   public :: condense

   integer, parameter, public :: moves_freely = -1

   integer, parameter :: never = 0, always = huge(1) !! last group of fixed unknowns, of retained unknowns

   !> Stiffness of a part of the body.
   type :: part_t
      integer, allocatable :: member(:) !! unknown of each row; loads are numbered after the unknowns
      type(symmetric_t) :: matrix       !! its matrix, or the Schur complement after elimination
   end type part_t

contains

   !> Matrix of the retained unknowns, then the loads, for each support. Unknowns are 2 node - 1 (x) and 2 node (y).
   subroutine condense(mesh, law, is_fixed, retained, loads, condensed, failed)
      type(plane_mesh_t), intent(in) :: mesh
      type(elasticity_t), intent(in) :: law
      logical, intent(in) :: is_fixed(:, :)             !! (unknown, support)
      integer, intent(in) :: retained(:)                    !! retained unknowns
      real(wp), intent(in) :: loads(:, :)               !! (unknown, load)
      real(wp), intent(out) :: condensed(:, :, :)       !! (row, column, support)
      integer, intent(out) :: failed                    !! 0; number of a degenerate element; moves_freely
      type(part_t) :: part, front(0:size(is_fixed, 2))   !! one for each support, and a spare one for the next step
      integer, dimension(size(loads, 1)) :: first, last !! group of an unknown
      integer :: until(sum(shape(loads)), 0:size(is_fixed, 2)) !! last group, within a group (0) and in the front of each support
      integer :: row_of(sum(shape(loads)))               !! row in the current matrix; 0: none
      type(symmetric_t) :: stiffness
      logical, allocatable :: acts(:, :)                !! whether a load acts on the new unknowns of a group
      integer :: which(0:size(is_fixed, 2))             !! index of the front of each support; 0: of the spare one
      integer :: n_supports, n_groups, group, e, i, k, s

      first = always
      last = never
      do e = 1, size(mesh%group)
         associate (at => unknowns(mesh%node(:, e)))
            first(at) = min(first(at), mesh%group(e))
            last(at) = max(last(at), mesh%group(e))
         end associate
      end do
      n_groups = maxval(mesh%group)
      n_supports = size(is_fixed, 2)
      allocate (acts(size(loads, 2), n_groups), source=.false.)
      do k = 1, size(loads, 2)
         do i = 1, size(loads, 1)
            if (abs(loads(i, k)) > 0) acts(k, first(i)) = .true.
         end do
      end do
      last(retained) = always
      until = always
      do i = 1, size(last)
         until(i, 1:) = merge(never, last(i), is_fixed(i, :))
         associate (least => minval(until(i, 1:)), most => maxval(until(i, 1:)))
            if (least == most .and. (first(i) == last(i) .or. most == never)) until(i, 0) = most
         end associate
      end do
      do s = 0, ubound(front, 1)
         allocate (front(s)%member(0))
         which(s) = s
      end do
      row_of = 0
      do group = 1, n_groups
         call condense_group(mesh, law, group, first == group, until(:, 0), loads, indices(acts(:, group)), row_of, stiffness, &
                             part, failed)
         do s = 1, n_supports
            if (failed /= 0) return
            call join(front(which(s)), part, group, until(:, s), row_of, front(which(0)), failed)
            which([0, s]) = which([s, 0])
         end do
      end do
      condensed = 0
      row_of(retained) = [(i, i=1, size(retained))]
      row_of(size(last) + 1:) = [(size(retained) + i, i=1, size(loads, 2))]
      do s = 1, n_supports
         if (failed /= 0) return
         associate (at => row_of(front(which(s))%member), matrix => front(which(s))%matrix)
            do k = 1, size(at)
               do i = k, size(at)
                  condensed(at(i), at(k), s) = matrix%element(matrix%n_out + i, matrix%n_out + k)
                  condensed(at(k), at(i), s) = condensed(at(i), at(k), s)
               end do
            end do
         end associate
      end do
   end subroutine condense

   !> Unknowns of nodes.
   pure function unknowns(nodes) result(list)
      integer, intent(in) :: nodes(:)
      integer :: list(2*size(nodes))

      list(1::2) = 2*nodes - 1
      list(2::2) = 2*nodes
   end function unknowns

   !> Assemble the elements of a group, with the loads on its new unknowns, and eliminate.
   subroutine condense_group(mesh, law, group, is_new, until, loads, acting, row_of, stiffness, part, failed)
      type(plane_mesh_t), intent(in) :: mesh
      type(elasticity_t), intent(in) :: law
      integer, intent(in) :: group, until(:), acting(:) !! loads on new unknowns
      logical, intent(in) :: is_new(:)
      real(wp), intent(in) :: loads(:, :)
      integer, intent(inout) :: row_of(:)
      type(symmetric_t), intent(inout) :: stiffness !! of elements
      type(part_t), intent(inout) :: part
      integer, intent(out) :: failed
      integer :: list(8*mesh%order*count(mesh%group == group)), n, n_out, e
      real(wp) :: x(0:mesh%order), w(0:mesh%order), d(0:mesh%order, 0:mesh%order), xy(2, 0:mesh%order, 0:mesh%order)
      logical :: is_valid

      n = 0
      do e = 1, size(mesh%group)
         if (mesh%group(e) /= group) cycle
         list(n + 1:n + 8*mesh%order) = unknowns(mesh%node(:, e))
         n = n + 8*mesh%order
      end do
      call arrange([list, size(loads, 1) + acting], group, until, row_of, part%member, n_out)
      call part%matrix%create(n_out, size(part%member))
      call lobatto_rule(x, w, d)
      do e = 1, size(mesh%group)
         if (mesh%group(e) /= group) cycle
         failed = e
         call element_points(mesh, e, x, xy)
         call element_stiffness(mesh%order, w, d, xy, law, stiffness, is_valid)
         if (.not. is_valid) return
         call part%matrix%add(stiffness, row_of(unknowns(mesh%node(:, e))))
      end do
      do e = 1, size(part%member) - size(acting)
         if (is_new(part%member(e))) call part%matrix%set(size(part%member) - size(acting) + 1, e, &
                                                          loads(part%member(e), acting))
      end do
      call finish(n_out, row_of, part, failed)
   end subroutine condense_group

   !> Add a group to a front and eliminate.
   subroutine join(before, part, group, until, row_of, front, failed)
      type(part_t), intent(in) :: before, part
      integer, intent(in) :: group, until(:)
      integer, intent(inout) :: row_of(:)
      type(part_t), intent(inout) :: front !! front with the group; its memory is reused
      integer, intent(out) :: failed
      integer :: n_out

      call arrange([before%member, part%member], group, until, row_of, front%member, n_out)
      call front%matrix%create(n_out, size(front%member))
      call front%matrix%add(before%matrix, row_of(before%member))
      call front%matrix%add(part%matrix, row_of(part%member))
      call finish(n_out, row_of, front, failed)
   end subroutine join

   !> Rows of a matrix: each unknown of a list once, those eliminated with this group first.
   subroutine arrange(list, group, until, row_of, member, n_out)
      integer, intent(in) :: list(:), group, until(:)
      integer, intent(inout) :: row_of(:)
      integer, allocatable, intent(inout) :: member(:)
      integer, intent(out) :: n_out
      integer :: rows(size(list)), i, n, turn

      n = 0
      do turn = 1, 2
         do i = 1, size(list)
            if (row_of(list(i)) > 0 .or. until(list(i)) == never .or. (turn == 1 .and. until(list(i)) /= group)) cycle
            n = n + 1
            rows(n) = list(i)
            row_of(list(i)) = n
         end do
         if (turn == 1) n_out = n
      end do
      member = rows(:n)
   end subroutine arrange

   !> Eliminate the first n_out rows.
   subroutine finish(n_out, row_of, part, failed)
      integer, intent(in) :: n_out
      integer, intent(inout) :: row_of(:)
      type(part_t), intent(inout) :: part     !! in: all members; out: the remaining ones
      integer, intent(out) :: failed
      logical :: is_definite

      row_of(part%member) = 0
      call part%matrix%eliminate(is_definite)
      failed = merge(0, moves_freely, is_definite)
      part%member = part%member(n_out + 1:)
   end subroutine finish

end module evl_front
