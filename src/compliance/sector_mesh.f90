!> Mesh of half a tooth sector of a wheel: from the middle line of the tooth to the middle of the space, from the tip to the hub.
!>
!> The elements form a lattice of rows, from the tip down, and columns, from the middle line of the tooth outward:
!>
!>    rows 1 .. form         the tooth above the form circle       columns 1 .. tooth: the outline is their last line
!>    rows .. fillet         from there to the middle of the fillet
!>    rows .. deep           to 1.1 modules under the root circle  further columns: under the fillet, under the root's arc
!>    rows .. last           rings down to the hub, growing by 1.5
!>
!> A rounded tip has two more rows and one more column, without an element in their corner. There three elements meet at the point
!> (1, tooth - 1). The points (0, tooth - 1) and (1, tooth) are one, the middle of the rounding; (0, tooth - 2) and (2, tooth) are
!> its ends.
!>
!> The outline and the circles are exact on sides of elements; other sides are straight. Element borders are at jumps of the
!> outline's curvature. At both ends of the involute they are closer together, because a load that ends at the edge is narrow there.
!> The mesh is in modules. Order and border positions were chosen so that p = 8 is exact to 5e-5 of E c.
module evl_sector_mesh
   use evl_kinds, only: wp
   use evl_lobatto, only: lobatto_rule
   use evl_plane_mesh, only: mesh_create, number_nodes, plane_mesh_t, side_nodes
   use evl_tooth_outline, only: fillet_point, involute_curvature, involute_normal, involute_point, rounding_point, tooth_outline_t
   implicit none (type, external)
   private

   public :: sector_mesh, sector_mesh_t
   public :: end_rows, least_ring

   real(wp), parameter, public :: depth_of_rings = 1.1_wp        !! of the outermost ring under the root circle [modules]
   real(wp), parameter :: least_ring = 0.1_wp                    !! minimum thickness of all rings [modules]
   real(wp), parameter :: end_rows(4) = [0.04_wp, 0.04_wp, 0.08_wp, 0.18_wp] !! at the ends of the involute [modules]
   real(wp), parameter :: flank_row = 0.28_wp                    !! maximum of the other rows of the involute [modules]
   real(wp), parameter :: in_tooth(0:4) = [0.0_wp, 0.42_wp, 0.75_wp, 0.92_wp, 1.0_wp] !! columns, fractions of the half thickness
   real(wp), parameter :: in_body(0:4) = [0.0_wp, 0.3_wp, 0.58_wp, 0.8_wp, 1.0_wp]  !! likewise below the tooth
   real(wp), parameter :: under_rounding = 0.3_wp                    !! thickness of the rows under a rounding over its radius
   real(wp), parameter :: widest_rim = 0.1_wp                        !! its maximum relative to the half thickness
   real(wp), parameter :: in_fillet(3) = [0.15_wp, 0.45_wp, 1.0_wp]  !! rows of the upper half of the fillet
   real(wp), parameter :: under_root(3) = [0.2_wp, 0.5_wp, 1.0_wp]   !! rows below the fillet
   real(wp), parameter :: first_ring = 0.7_wp, growth = 1.5_wp       !! thickness [modules]; ratio to that of the previous ring
   real(wp), parameter :: thickest = 0.45_wp                         !! maximum thickness of a ring relative to its outer radius

   !> The mesh and the numbers of its special nodes and rows.
   type :: sector_mesh_t
      type(plane_mesh_t) :: mesh
      integer, allocatable :: axis(:), cut(:), hub(:) !! nodes on the middle line, on the cut (from the root down), on the hub
      integer :: n_flank = 0                          !! rows on the involute
      integer, allocatable :: flank(:, :)             !! nodes (0:p, row), in the direction of decreasing arc
      real(wp), allocatable :: flank_arc(:)           !! borders of those rows, arc from the base circle, decreasing (0:n_flank)
      integer, allocatable :: fillet(:, :)            !! nodes (0:p, side) of the sides on the fillet, from the involute to the root
      real(wp), allocatable :: fillet_points(:, :, :) !! their points (xy, 0:p, side)
      real(wp), allocatable :: fillet_beta(:)         !! beta at their ends, decreasing, from 0 to the number of sides
      integer, allocatable :: row(:)                  !! row of each element
      integer :: row_form = 0, row_fillet = 0, row_deep = 0 !! last rows of the upper parts, see the module header
   end type sector_mesh_t

   !> Positions of the lattice lines.
   type :: lattice_t
      type(tooth_outline_t) :: outline
      integer :: top = 0                 !! rows above the involute
      integer :: form = 0, fillet = 0, deep = 0, last = 0, n_tooth = 0, columns = 0
      real(wp), allocatable :: tooth(:)  !! columns of the tooth, fractions of its half thickness (0:n_tooth)
      real(wp) :: rim = 0, rim_part = 0  !! thickness of the rows under a rounding; over the half thickness of the tooth there
      real(wp), allocatable :: arc(:)    !! of the involute (top:form)
      real(wp), allocatable :: beta(:)   !! of the fillet (form:fillet)
      real(wp), allocatable :: axis(:)   !! x of the middle line's points (0:fillet)
      real(wp), allocatable :: radius(:) !! of the circles (deep:last)
      real(wp), allocatable :: angle(:)  !! of the columns on circles (0:columns)
      real(wp) :: middle = 0             !! beta in the middle of the fillet
   end type lattice_t

contains

   !> Mesh of a sector with a hub radius in modules. Valid: hub < root radius - depth_of_rings - least_ring
   subroutine sector_mesh(outline, hub_radius, p, sector)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: hub_radius
      integer, intent(in) :: p
      type(sector_mesh_t), intent(out) :: sector
      type(lattice_t) :: at
      real(wp) :: x(0:p), w(0:p), d(0:p, 0:p)
      integer :: i, j, n, e

      call set_lines(outline, hub_radius, at)
      call lobatto_rule(x, w, d)
      n = at%fillet*at%n_tooth + (at%last - at%fillet)*at%columns - merge(1, 0, at%top > 0)
      call mesh_create(p, n, sector%mesh)
      allocate (sector%row(n))
      e = 0
      do i = 1, at%last
         do j = 1, columns_of(at, i)
            e = e + 1
            associate (m => sector%mesh)
               m%group(e) = i
               sector%row(e) = i
               m%corner(:, e) = [vertex_of(i - 1, j - 1), vertex_of(i - 1, j), vertex_of(i, j), vertex_of(i, j - 1)]
               m%side(:, :, 1, e) = across(at, i - 1, j, x)
               m%side(:, :, 2, e) = down(at, i, j, x)
               m%side(:, :, 3, e) = across(at, i, j, x)
               m%side(:, :, 4, e) = down(at, i, j - 1, x)
            end associate
         end do
      end do
      call number_nodes(sector%mesh)
      call find_lines(at, sector)

   contains

      !> Number of a lattice point.
      pure integer function vertex_of(row, column)
         integer, intent(in) :: row, column

         vertex_of = row*(at%columns + 1) + column + 1
         if (at%top > 0 .and. row == 1 .and. column == at%n_tooth) vertex_of = column ! in the middle of the rounding
      end function vertex_of

   end subroutine sector_mesh

   !> Number of elements in a row.
   pure integer function columns_of(at, row) result(n)
      type(lattice_t), intent(in) :: at
      integer, intent(in) :: row

      n = merge(at%n_tooth, at%columns, row <= at%fillet)
      if (at%top > 0 .and. row == 1) n = n - 1
   end function columns_of

   !> Positions of rows and columns.
   subroutine set_lines(outline, hub_radius, at)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: hub_radius
      type(lattice_t), intent(out) :: at
      real(wp) :: form_point(2), tip_point(2), normal(2), middle(2), deep, part, lateral, closest
      integer :: i

      at%outline = outline
      at%top = merge(2, 0, outline%tip_rounding > 0)
      call set_flank_rows(outline, at%top, at%arc)
      at%form = ubound(at%arc, 1)
      call set_columns(outline, at)
      at%fillet = at%form + size(in_fillet)
      at%deep = at%fillet + size(under_root)
      at%columns = at%n_tooth + merge(2, 1, outline%has_root_arc)
      at%middle = outline%fillet_start/2
      allocate (at%beta(at%form:at%fillet))
      at%beta(at%form) = outline%fillet_start
      at%beta(at%form + 1:) = outline%fillet_start + in_fillet*(at%middle - outline%fillet_start)
      ! lines meet the outline as close to right angles as the blocks between them permit
      form_point = involute_point(outline, outline%rho_form)
      middle = fillet_point(outline, at%middle)
      allocate (at%axis(0:at%fillet))
      at%axis(at%form) = form_point(1) - 0.05_wp*form_point(2)
      at%axis(at%fillet) = middle(1) - 0.27_wp*middle(2)
      at%axis(0) = outline%tip_radius
      if (at%top > 0) then
         tip_point = rounding_point(outline, 1.0_wp)
         normal = involute_normal(outline, outline%rho_tip)
         at%axis(1:2) = [outline%tip_radius - at%rim, tip_point(1) + 0.5_wp*tip_point(2)*(normal(1)/abs(normal(2)))]
      end if
      associate (top => at%top, first => at%axis(at%top))
         do i = top, at%form
            part = 0.5_wp*((at%arc(i) - at%arc(top))/(at%arc(at%form) - at%arc(top)) + real(i - top, wp)/(at%form - top))
            at%axis(i) = first + part*(at%axis(at%form) - first)
         end do
      end associate
      at%axis(at%form + 1:) = at%axis(at%form) + in_fillet*(at%axis(at%fillet) - at%axis(at%form))
      deep = outline%root_radius - depth_of_rings
      call set_rings(deep, hub_radius, at%deep, at%radius)
      at%last = ubound(at%radius, 1)
      ! columns: those of the tooth lean inward below the fillet
      allocate (at%angle(0:at%columns))
      closest = 0.55_wp*outline%half_pitch
      lateral = middle(2) - 0.27_wp*(middle(1) - deep)
      at%angle(:at%n_tooth) = below_tooth(at%tooth)*min(max(lateral/deep, closest), 0.75_wp*outline%half_pitch)
      at%angle(at%columns) = outline%half_pitch
      if (outline%has_root_arc) at%angle(at%n_tooth + 1) = min(outline%root_angle, &
                                                               0.4_wp*at%angle(at%n_tooth) + 0.6_wp*outline%half_pitch)
   end subroutine set_lines

   !> Columns of the tooth.
   subroutine set_columns(outline, at)
      type(tooth_outline_t), intent(in) :: outline
      type(lattice_t), intent(inout) :: at
      real(wp) :: end_point(2)

      at%n_tooth = ubound(in_tooth, 1) + merge(1, 0, at%top > 0)
      allocate (at%tooth(0:at%n_tooth))
      at%tooth(:ubound(in_tooth, 1)) = in_tooth
      if (at%top == 0) return
      end_point = rounding_point(outline, 1.0_wp)
      at%rim = min(under_rounding*outline%tip_rounding, widest_rim*end_point(2))
      at%tooth(at%n_tooth - 2:) = 1 - [2, 1, 0]*(1 - in_tooth(ubound(in_tooth, 1) - 1))
      at%rim_part = at%rim/end_point(2)
   end subroutine set_columns

   !> Positions of the columns of the tooth below it, as fractions of their width there.
   elemental real(wp) function below_tooth(part) result(below)
      real(wp), intent(in) :: part
      integer :: k

      k = max(findloc(in_tooth >= part, .true., dim=1) - 1, 1) ! in_tooth starts at 0
      below = in_body(k)
      if (part < in_tooth(k)) below = in_body(k - 1) + (in_body(k) - in_body(k - 1))*((part - in_tooth(k - 1)) &
                                                                                      /(in_tooth(k) - in_tooth(k - 1)))
   end function below_tooth

   !> Borders of the rows on the involute, from its end: narrow at both ends; narrower still on a short flank.
   subroutine set_flank_rows(outline, top, arc)
      type(tooth_outline_t), intent(in) :: outline
      integer, intent(in) :: top                    !! rows above the involute
      real(wp), allocatable, intent(out) :: arc(:)  !! borders from there on
      real(wp) :: length, shrink, rest, from_end
      integer :: n, k

      length = outline%s_tip - outline%s_form
      shrink = min(1.0_wp, length/(2*sum(end_rows) + flank_row/2))
      rest = length - 2*shrink*sum(end_rows)
      n = max(1, ceiling(rest/flank_row))
      allocate (arc(top:top + 2*size(end_rows) + n))
      from_end = 0
      arc(top) = outline%s_tip
      arc(ubound(arc, 1)) = outline%s_form
      do k = 1, size(end_rows)
         from_end = from_end + shrink*end_rows(k)
         arc(top + k) = outline%s_tip - from_end
         arc(ubound(arc, 1) - k) = outline%s_form + from_end
      end do
      do k = 1, n - 1
         arc(top + size(end_rows) + k) = outline%s_tip - from_end - k*rest/n
      end do
   end subroutine set_flank_rows

   !> Radii of the borders of the rings.
   subroutine set_rings(outer, hub, row, radius)
      real(wp), intent(in) :: outer, hub
      integer, intent(in) :: row !! row of the outermost circle
      real(wp), allocatable, intent(out) :: radius(:)
      real(wp) :: inner, thickness, shrink
      integer :: n, k, turn

      shrink = 1
      n = 0
      do turn = 1, 2
         if (turn == 2) then
            shrink = (outer - hub)/(outer - inner)
            allocate (radius(row:row + n))
            radius(row) = outer
         end if
         inner = outer
         k = 0
         do while (merge(inner > hub, k < n, turn == 1))
            thickness = min(first_ring*growth**k, thickest*inner)
            if (turn == 1 .and. inner - thickness < 0.3_wp*thickness) thickness = inner - 0.9_wp*hub
            inner = inner - thickness
            k = k + 1
            if (turn == 2) radius(row + k) = outer - shrink*(outer - inner)
         end do
         n = k
      end do
      radius(row + n) = hub
   end subroutine set_rings

   !> A point of the lattice; next to a rounding, not every row has one.
   pure recursive function point(at, i, j) result(xy)
      type(lattice_t), intent(in) :: at
      integer, intent(in) :: i, j
      real(wp) :: xy(2), angle, part

      associate (o => at%outline)
         if (i < max(at%top, 1)) then
            if (at%top == 0) then
               angle = o%tip_angle*at%tooth(j)
            else if (j < at%n_tooth - 1) then
               angle = o%tip_angle*(at%tooth(j)/at%tooth(at%n_tooth - 2))
            else
               xy = rounding_point(o, 0.5_wp, merge(at%rim, 0.0_wp, i == 1 .and. j < at%n_tooth))
               return
            end if
            xy = (o%tip_radius - i*at%rim)*[cos(angle), sin(angle)]
         else if (i >= at%deep) then
            xy = at%radius(i)*[cos(at%angle(j)), sin(at%angle(j))]
         else if (i > at%fillet) then
            part = under_root(i - at%fillet)
            xy = (1 - part)*point(at, at%fillet, j) + part*point(at, at%deep, j)
         else if (j > at%n_tooth) then
            xy = fillet_point(o, 0.0_wp)
            if (j > at%n_tooth + 1) xy = o%root_radius*[cos(o%half_pitch), sin(o%half_pitch)]
         else
            if (i <= at%form) then
               xy = involute_point(o, involute_curvature(o, at%arc(i)))
            else
               xy = fillet_point(o, at%beta(i))
            end if
            part = column_at(at, i, j)
            xy = part*xy + (1 - part)*[at%axis(i), 0.0_wp]
         end if
      end associate
   end function point

   !> Position of a column of the tooth in a row line, as a fraction of the half thickness. Under a rounding the last two columns
   !> are as wide as the rows there, and widen along the involute.
   pure real(wp) function column_at(at, i, j) result(part)
      type(lattice_t), intent(in) :: at
      integer, intent(in) :: i, j

      part = at%tooth(j)
      if (at%top == 0 .or. i >= at%form .or. j < at%n_tooth - 2) return
      associate (down => (at%arc(i) - at%arc(at%top))/(at%arc(at%form) - at%arc(at%top)))
         part = 1 - (at%n_tooth - j)*at%rim_part + down*(part - (1 - (at%n_tooth - j)*at%rim_part))
      end associate
   end function column_at

   !> Points of the side in row line i from column line j-1 to j.
   pure function across(at, i, j, x) result(xy)
      type(lattice_t), intent(in) :: at
      integer, intent(in) :: i, j
      real(wp), intent(in) :: x(:)
      real(wp) :: xy(2, size(x)), start(2), end(2)
      integer :: k

      start = point(at, i, j - 1)
      end = point(at, i, j)
      do k = 1, size(x)
         associate (part => (1 + x(k))/2)
            if (at%top > 0 .and. i == 0 .and. j == at%n_tooth - 1) then
               xy(:, k) = rounding_point(at%outline, part/2)
            else if (i == at%fillet .and. j == at%n_tooth + 1) then
               xy(:, k) = fillet_point(at%outline, (1 - part)*at%middle)
            else if (i == 0 .or. i >= at%deep .or. (i == at%fillet .and. j > at%n_tooth)) then
               associate (from => atan2(start(2), start(1)), to => atan2(end(2), end(1)))
                  xy(:, k) = hypot(start(1), start(2))*[cos(from + part*(to - from)), sin(from + part*(to - from))]
               end associate
            else
               xy(:, k) = (1 - part)*start + part*end
            end if
         end associate
      end do
   end function across

   !> Points of the side in column line j from row line i-1 to i.
   pure function down(at, i, j, x) result(xy)
      type(lattice_t), intent(in) :: at
      integer, intent(in) :: i, j
      real(wp), intent(in) :: x(:)
      real(wp) :: xy(2, size(x))
      integer :: k

      do k = 1, size(x)
         associate (part => (1 + x(k))/2, o => at%outline)
            if (j == at%n_tooth .and. i <= at%top) then
               xy(:, k) = rounding_point(o, (1 + part)/2)
            else if (j == at%n_tooth .and. i <= at%form) then
               xy(:, k) = involute_point(o, involute_curvature(o, at%arc(i - 1) + part*(at%arc(i) - at%arc(i - 1))))
            else if (j == at%n_tooth .and. i <= at%fillet) then
               xy(:, k) = fillet_point(o, at%beta(i - 1) + part*(at%beta(i) - at%beta(i - 1)))
            else
               xy(:, k) = (1 - part)*point(at, i - 1, j) + part*point(at, i, j)
            end if
         end associate
      end do
   end function down

   !> Nodes on the middle line, the cut, the hub and the flank.
   subroutine find_lines(at, sector)
      type(lattice_t), intent(in) :: at
      type(sector_mesh_t), intent(inout) :: sector
      integer :: p, e, j, columns, side, n_fillet

      p = sector%mesh%order
      n_fillet = at%fillet - at%form + 1
      allocate (sector%fillet(0:p, n_fillet), sector%fillet_points(2, 0:p, n_fillet), sector%fillet_beta(0:n_fillet))
      sector%fillet_beta = [at%beta, 0.0_wp]
      sector%n_flank = at%form - at%top
      sector%row_form = at%form
      sector%row_fillet = at%fillet
      sector%row_deep = at%deep
      allocate (sector%flank_arc(0:sector%n_flank), source=at%arc)
      allocate (sector%flank(0:p, sector%n_flank), sector%axis(0), sector%cut(0), sector%hub(0))
      e = 0
      do while (e < size(sector%row))
         columns = columns_of(at, sector%row(e + 1))
         do j = 1, columns
            e = e + 1
            associate (node => sector%mesh%node(:, e), i => sector%row(e))
               if (j == 1) call append(sector%axis, node(side_nodes(p, 4)))
               if (j == columns .and. i > at%fillet) call append(sector%cut, node(side_nodes(p, 2)))
               if (j == at%n_tooth .and. i > at%top .and. i <= at%form) sector%flank(:, i - at%top) = node(side_nodes(p, 2))
               if (i == at%last) call append(sector%hub, node(side_nodes(p, 3)))
               side = 0
               if (j == at%n_tooth .and. i > at%form .and. i <= at%fillet) side = 2
               if (j == at%n_tooth + 1 .and. i == at%fillet + 1) side = 1
               if (side > 0) then
                  sector%fillet(:, i - at%form) = node(side_nodes(p, side))
                  sector%fillet_points(:, :, i - at%form) = sector%mesh%side(:, :, side, e)
               end if
            end associate
         end do
      end do
   end subroutine find_lines

   !> Append the nodes of a side to those of a line; the node shared by two sides is included once.
   subroutine append(line, nodes)
      integer, allocatable, intent(inout) :: line(:)
      integer, intent(in) :: nodes(:)

      if (size(line) == 0) then
         line = nodes
      else
         line = [line, nodes(2:)]
      end if
   end subroutine append

end module evl_sector_mesh
