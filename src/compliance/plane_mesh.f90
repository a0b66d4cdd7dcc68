!> Plane mesh of curved quadrilaterals, and the numbers of the nodes on their sides.
!>
!> An element has the corners (-1,-1), (1,-1), (1,1), (-1,1) of local coordinates (xi, eta) and the sides eta = -1, xi = 1, eta = 1,
!> xi = -1, each in the direction of the increasing coordinate. Nodes inside an element belong to it alone and have no number here:
!> they follow from the sides by transfinite interpolation.
!>
!> Source: Gordon & Hall 1973.
module evl_plane_mesh
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: element_points, mesh_create, number_nodes, rim_index, plane_mesh_t, side_nodes

   !> Elements, their sides and nodes.
   type :: plane_mesh_t
      integer :: order = 0                        !! p
      integer :: n_nodes = 0                      !! on sides
      integer, allocatable :: corner(:, :)        !! vertex (corner, element)
      integer, allocatable :: group(:)            !! of each element, from 1: elimination proceeds from group to group
      integer, allocatable :: node(:, :)          !! number (index on the rim, element)
      real(wp), allocatable :: side(:, :, :, :)   !! coordinates (xy, 0:p, side, element)
   end type plane_mesh_t

   integer, parameter :: side_start(4) = [1, 2, 4, 1], side_end(4) = [2, 3, 3, 4] !! corners

contains

   !> Allocate a mesh of n elements of order p.
   subroutine mesh_create(p, n, mesh)
      integer, intent(in) :: p, n
      type(plane_mesh_t), intent(out) :: mesh

      mesh%order = p
      allocate (mesh%corner(4, n), mesh%group(n), mesh%node(4*p, n), mesh%side(2, 0:p, 4, n))
   end subroutine mesh_create

   !> Index on the rim of an element, 1 to 4p, of a node (a, b), 0 to p each; 0 inside.
   elemental integer function rim_index(p, a, b) result(i_rim)
      integer, intent(in) :: p, a, b

      i_rim = 0
      if (b == 0) then
         i_rim = 1 + a
      else if (a == p) then
         i_rim = 1 + p + b
      else if (b == p) then
         i_rim = 1 + 3*p - a
      else if (a == 0) then
         i_rim = 1 + 4*p - b
      end if
   end function rim_index

   !> Rim indices of the nodes of a side, in its direction.
   pure function side_nodes(p, side) result(indices)
      integer, intent(in) :: p, side
      integer :: indices(0:p), i

      select case (side)
      case (1)
         indices = [(rim_index(p, i, 0), i=0, p)]
      case (2)
         indices = [(rim_index(p, p, i), i=0, p)]
      case (3)
         indices = [(rim_index(p, i, p), i=0, p)]
      case default
         indices = [(rim_index(p, 0, i), i=0, p)]
      end select
   end function side_nodes

   !> Number all nodes on sides: a vertex is one node, and so is each node of a side shared by two elements.
   subroutine number_nodes(mesh)
      type(plane_mesh_t), intent(inout) :: mesh
      integer, allocatable :: vertex(:), first(:, :), ends(:, :)
      integer :: p, e, side, from, to, known, n_sides, k, start, indices(0:mesh%order)

      p = mesh%order
      allocate (vertex(maxval(mesh%corner)), source=0)
      allocate (ends(2, 4*size(mesh%group)), first(1, 4*size(mesh%group)))
      mesh%n_nodes = 0
      n_sides = 0
      do e = 1, size(mesh%group)
         do side = 1, 4
            from = mesh%corner(side_start(side), e)
            to = mesh%corner(side_end(side), e)
            do known = n_sides, 1, -1
               if (ends(1, known) == min(from, to) .and. ends(2, known) == max(from, to)) exit
            end do
            if (known == 0) then
               n_sides = n_sides + 1
               known = n_sides
               ends(:, known) = [min(from, to), max(from, to)]
               first(1, known) = mesh%n_nodes
               mesh%n_nodes = mesh%n_nodes + p - 1
            end if
            indices = side_nodes(p, side)
            call give_number(from, indices(0))
            call give_number(to, indices(p))
            start = first(1, known)
            do k = 1, p - 1
               mesh%node(indices(k), e) = start + merge(k, p - k, from < to)
            end do
         end do
      end do

   contains

      !> Assign the number of a vertex.
      subroutine give_number(v, i_rim)
         integer, intent(in) :: v, i_rim

         if (vertex(v) == 0) then
            mesh%n_nodes = mesh%n_nodes + 1
            vertex(v) = mesh%n_nodes
         end if
         mesh%node(i_rim, e) = vertex(v)
      end subroutine give_number

   end subroutine number_nodes

   !> All points of an element, from its sides.
   pure subroutine element_points(mesh, e, x, xy)
      type(plane_mesh_t), intent(in) :: mesh
      integer, intent(in) :: e
      real(wp), intent(in) :: x(0:mesh%order)                             !! Gauss-Lobatto points
      real(wp), intent(out) :: xy(2, 0:mesh%order, 0:mesh%order)          !! (xy, along xi, along eta)
      integer :: p, a, b

      p = mesh%order
      do b = 0, p
         do a = 0, p
            associate (l => (1 - x(a))/2, r => (1 + x(a))/2, d => (1 - x(b))/2, u => (1 + x(b))/2)
               xy(:, a, b) = d*mesh%side(:, a, 1, e) + u*mesh%side(:, a, 3, e) + l*mesh%side(:, b, 4, e) &
                             + r*mesh%side(:, b, 2, e) - l*d*mesh%side(:, 0, 1, e) - r*d*mesh%side(:, p, 1, e) &
                             - l*u*mesh%side(:, 0, 3, e) - r*u*mesh%side(:, p, 3, e)
            end associate
         end do
      end do
   end subroutine element_points

end module evl_plane_mesh
