!> A body condensed onto some of its unknowns, by elimination along a front.
!>
!> Elements come group by group. An unknown whose last element has come is eliminated, unless it is kept; what is fixed never comes.
!> Loads ride along as further rows: of [K, f; f^T, 0] elimination leaves the stiffness of the kept unknowns, their share of the
!> loads, f_k - K_ke K_ee^-1 f_e, and -f_e^T K_ee^-1 f_e, the compliance with the kept unknowns held.
!>
!> Source: Irons 1970, frontal solution.
module evl_front
   use evl_condensation, only: cholesky, rows_below, subtract_products
   use evl_kinds, only: wp
   use evl_places, only: places
   use evl_plane_mesh, only: plane_mesh_t
   implicit none (type, external)
   private

   public :: condense

contains

   !> Matrix of the kept unknowns, then the loads; the lower triangle counts and both are filled.
   !> Unknowns are 2 node - 1 (x) and 2 node (y).
   subroutine condense(mesh, stiffness, is_fixed, kept, loads, condensed, is_definite)
      type(plane_mesh_t), intent(in) :: mesh
      real(wp), intent(in) :: stiffness(:, :, :)        !! of the rims (unknown, unknown, element)
      logical, intent(in) :: is_fixed(:)                !! of each unknown
      integer, intent(in) :: kept(:)                    !! unknowns
      real(wp), intent(in) :: loads(:, :)               !! (unknown, load)
      real(wp), allocatable, intent(out) :: condensed(:, :)
      logical, intent(out) :: is_definite               !! false: something moves freely, and there is no answer
      real(wp), allocatable :: front(:, :)
      integer, allocatable :: member(:)                 !! unknown at each place of the front; loads as -1, -2 ...
      integer :: place(size(is_fixed)), last(size(is_fixed)), group, e, n, k

      last = 0
      do e = 1, size(mesh%group)
         associate (nodes => mesh%node(:, e))
            last(2*nodes - 1) = max(last(2*nodes - 1), mesh%group(e))
            last(2*nodes) = max(last(2*nodes), mesh%group(e))
         end associate
      end do
      last(kept) = huge(1)
      place = 0
      n = size(loads, 2)
      allocate (front(n, n), source=0.0_wp)
      allocate (member(n))
      member = [(-k, k=1, n)]
      is_definite = .true.
      do group = 1, maxval(mesh%group)
         call grow(mesh, group, is_fixed, loads, front, member, place)
         do e = 1, size(mesh%group)
            if (mesh%group(e) == group) call assemble(mesh%node(:, e), stiffness(:, :, e), place, front)
         end do
         call eliminate(last, group, front, member, place, is_definite)
         if (.not. is_definite) return
      end do
      call put_in_order(kept, size(loads, 2), front, member, condensed)
   end subroutine condense

   !> Take the unknowns of a group's elements into the front, with their loads.
   subroutine grow(mesh, group, is_fixed, loads, front, member, place)
      type(plane_mesh_t), intent(in) :: mesh
      integer, intent(in) :: group
      logical, intent(in) :: is_fixed(:)
      real(wp), intent(in) :: loads(:, :)
      real(wp), allocatable, intent(inout) :: front(:, :)
      integer, allocatable, intent(inout) :: member(:)
      integer, intent(inout) :: place(:)
      real(wp), allocatable :: larger(:, :)
      integer :: fresh(size(place)), e, i, c, unknown, n, old

      old = size(member)
      n = 0
      do e = 1, size(mesh%group)
         if (mesh%group(e) /= group) cycle
         do i = 1, size(mesh%node, 1)
            do c = -1, 0
               unknown = 2*mesh%node(i, e) + c
               if (is_fixed(unknown) .or. place(unknown) > 0) cycle
               n = n + 1
               fresh(n) = unknown
               place(unknown) = old + n
            end do
         end do
      end do
      allocate (larger(old + n, old + n), source=0.0_wp)
      larger(:old, :old) = front
      do i = 1, old
         if (member(i) > 0) cycle
         larger(old + 1:, i) = loads(fresh(:n), -member(i))
         larger(i, old + 1:) = larger(old + 1:, i)
      end do
      call move_alloc(larger, front)
      member = [member, fresh(:n)]
   end subroutine grow

   !> Add an element.
   subroutine assemble(nodes, stiffness, place, front)
      integer, intent(in) :: nodes(:), place(:)
      real(wp), intent(in) :: stiffness(:, :)
      real(wp), intent(inout) :: front(:, :)
      integer :: at(2*size(nodes)), i, k

      at(1::2) = place(2*nodes - 1)
      at(2::2) = place(2*nodes)
      do k = 1, size(at)
         if (at(k) == 0) cycle
         do i = 1, size(at)
            if (at(i) > 0) front(at(i), at(k)) = front(at(i), at(k)) + stiffness(i, k)
         end do
      end do
   end subroutine assemble

   !> Eliminate all unknowns whose last group this is.
   subroutine eliminate(last, group, front, member, place, is_definite)
      integer, intent(in) :: last(:), group
      real(wp), allocatable, intent(inout) :: front(:, :)
      integer, allocatable, intent(inout) :: member(:)
      integer, intent(inout) :: place(:)
      logical, intent(out) :: is_definite
      real(wp), allocatable :: done(:, :), across(:, :), rest(:, :)
      integer, allocatable :: out(:), stay(:)
      logical :: goes(size(member))
      integer :: i

      goes = .false.
      do i = 1, size(member)
         if (member(i) > 0) goes(i) = last(member(i)) == group
      end do
      allocate (out, source=places(goes))
      allocate (stay, source=places(.not. goes))
      call gather(front, out, out, done)
      call gather(front, stay, out, across)
      call gather(front, stay, stay, rest)
      call cholesky(size(out), done, max(1, size(out)), is_definite)
      if (.not. is_definite) return
      call rows_below(size(stay), size(out), done, max(1, size(out)), across, max(1, size(stay)))
      call subtract_products(size(stay), size(out), across, max(1, size(stay)), rest, max(1, size(stay)))
      do i = 1, size(stay)
         rest(i, i:) = rest(i:, i)
      end do
      do i = 1, size(out)
         place(member(out(i))) = 0
      end do
      call move_alloc(rest, front)
      member = member(stay)
      do i = 1, size(member)
         if (member(i) > 0) place(member(i)) = i
      end do
   end subroutine eliminate

   !> Some rows and columns of a matrix.
   subroutine gather(matrix, rows, columns, part)
      real(wp), intent(in) :: matrix(:, :)
      integer, intent(in) :: rows(:), columns(:)
      real(wp), allocatable, intent(out) :: part(:, :)
      integer :: i, k

      allocate (part(size(rows), size(columns)))
      do k = 1, size(columns)
         do i = 1, size(rows)
            part(i, k) = matrix(rows(i), columns(k))
         end do
      end do
   end subroutine gather

   !> What is left: the kept unknowns as they are listed, then the loads.
   subroutine put_in_order(kept, n_loads, front, member, condensed)
      integer, intent(in) :: kept(:), n_loads, member(:)
      real(wp), intent(in) :: front(:, :)
      real(wp), allocatable, intent(out) :: condensed(:, :)
      integer :: order(size(kept) + n_loads), i

      do i = 1, size(kept)
         order(i) = findloc(member, kept(i), dim=1)
      end do
      do i = 1, n_loads
         order(size(kept) + i) = findloc(member, -i, dim=1)
      end do
      call gather(front, order, order, condensed)
   end subroutine put_in_order

end module evl_front
