!> Loads of the meshes and shafts of a gear train under given torques on its rotors.
!>
!> Every rotor is in equilibrium: the torques on it, and those of its meshes and shafts, add up to zero. A rotor of prescribed speed
!> transfers the remainder to the ground; without one, the torques must balance over the whole train. In a tree of meshes and shafts
!> each load is the sum of the torques on one side. In closed loops, as in a power split, the equilibrium leaves one unknown per
!> loop, and the minimum of the complementary energy applies: sum of F^2/(2k) over the meshes plus sum of T^2/(2c) over the elastic
!> shafts, with k = (pi/4) E* b of each mesh. Source: docs/theory/theory.md, "Nominal operating point".
module evl_train_statics
   use evl_gearbox, only: gearbox_t
   use evl_indices, only: indices
   use evl_kinds, only: pi, wp
   use evl_lapack, only: dgesv
   implicit none (type, external)
   private

   public :: lay_out_train, train_carries, train_t

   !> The train as a graph. Nodes are the leading wheels of the rotors, and the ground. Edges are the meshes, the shafts, and the
   !> connections of rotors to the ground, in this order. Rigid shafts have no effective edge: their arms are 0.
   type :: train_t
      integer :: n_meshes = 0, n_shafts = 0
      integer, allocatable :: ends(:, :)      !! (2, edge): nodes at its ends
      real(wp), allocatable :: arms(:, :)     !! (2, edge): torque on each node per load of the edge [m], or 1
      real(wp), allocatable :: compliance(:)  !! of each edge [m/N], [rad/(N m)]; 0 to the ground
      integer, allocatable :: order(:)        !! nodes except the ground, each after its parent
      integer, allocatable :: up(:)           !! of each node: its edge towards the ground
      real(wp), allocatable :: loops(:, :)    !! (edge, loop): self-equilibrated loads
      real(wp), allocatable :: energies(:, :) !! (loop, loop): complementary energies of their products
   end type train_t

contains

   !> Graph of a gearbox, and its loops. Equation T68.
   subroutine lay_out_train(gearbox, train)
      type(gearbox_t), intent(in) :: gearbox !! including contacts and rotors
      type(train_t), intent(out) :: train
      integer, allocatable :: grounded(:), chords(:)
      integer :: ground, n_edges, i, k

      ground = size(gearbox%wheels) + 1
      grounded = indices([(gearbox%wheels(i)%prescribed > 0 .and. gearbox%wheels(i)%leader == i, i=1, size(gearbox%wheels))])
      if (size(grounded) == 0) grounded = [gearbox%reference]
      train%n_meshes = size(gearbox%pairs)
      train%n_shafts = size(gearbox%shafts)
      n_edges = train%n_meshes + train%n_shafts + size(grounded)
      allocate (train%ends(2, n_edges), train%arms(2, n_edges), train%compliance(n_edges))
      train%compliance = 0
      do i = 1, train%n_meshes
         associate (contact => gearbox%contacts(gearbox%first(i)))
            train%ends(:, i) = gearbox%wheels([contact%wheel_a, contact%wheel_b])%leader
            train%arms(:, i) = contact%pair%sigma*[contact%pair%r_ba, contact%pair%r_bb]
            train%compliance(i) = 4/(pi*contact%e_star*contact%width)
         end associate
      end do
      do i = 1, train%n_shafts
         associate (shaft => gearbox%shafts(i), k => train%n_meshes + i)
            train%ends(:, k) = gearbox%wheels([shaft%wheel_a, shaft%wheel_b])%leader
            train%arms(:, k) = merge([0.0_wp, 0.0_wp], [-1.0_wp, 1.0_wp], shaft%rigid)
            if (.not. shaft%rigid) train%compliance(k) = 1/shaft%stiffness
         end associate
      end do
      do i = 1, size(grounded)
         k = train%n_meshes + train%n_shafts + i
         train%ends(:, k) = [grounded(i), ground]
         train%arms(:, k) = [1.0_wp, 0.0_wp]
      end do
      call grow_tree(train, ground, chords)
      call close_loops(train, chords)
   end subroutine lay_out_train

   !> Spanning tree from the ground; each edge outside it closes a loop.
   subroutine grow_tree(train, ground, chords)
      type(train_t), intent(inout) :: train
      integer, intent(in) :: ground
      integer, allocatable, intent(out) :: chords(:)
      logical :: joined(ground)
      integer :: before, node, e, n

      allocate (train%order(ground), train%up(ground), source=0)
      joined = .false.
      joined(ground) = .true.
      n = 0
      do
         before = n
         do e = 1, size(train%ends, 2)
            if (joined(train%ends(1, e)) .eqv. joined(train%ends(2, e))) cycle
            node = merge(train%ends(2, e), train%ends(1, e), joined(train%ends(1, e)))
            joined(node) = .true.
            train%up(node) = e
            n = n + 1
            train%order(n) = node
         end do
         if (n == before) exit
      end do
      train%order = train%order(:n)
      chords = indices([(abs(train%arms(1, e)) > 0 .and. all(train%up(train%ends(:, e)) /= e), e=1, size(train%ends, 2))])
   end subroutine grow_tree

   !> Loads of each loop, and their complementary energies. Equation T68.
   subroutine close_loops(train, chords)
      type(train_t), intent(inout) :: train
      integer, intent(in) :: chords(:) !! edges that close the loops
      real(wp) :: torque(size(train%up))
      integer :: i, j

      allocate (train%loops(size(train%ends, 2), size(chords)), train%energies(size(chords), size(chords)))
      do i = 1, size(chords)
         torque = 0
         torque(train%ends(:, chords(i))) = train%arms(:, chords(i))
         call tree_carries(train, torque, train%loops(:, i))
         train%loops(chords(i), i) = 1
      end do
      do i = 1, size(chords)
         do j = 1, size(chords)
            train%energies(i, j) = sum(train%compliance*train%loops(:, i)*train%loops(:, j))
         end do
      end do
   end subroutine close_loops

   !> Load of every edge under torques that balance, or with prescribed speeds that supply the remainder. Equation T68.
   subroutine train_carries(train, torque, transmitted)
      type(train_t), intent(in) :: train
      real(wp), intent(in) :: torque(:)   !! on each node, the ground included [N m]
      real(wp), intent(out) :: transmitted(:) !! of each edge: normal force [N], torque on the second wheel [N m]
      real(wp) :: matrix(size(train%loops, 2), size(train%loops, 2)), shares(size(train%loops, 2), 1)
      integer :: pivots(size(train%loops, 2)), info

      call tree_carries(train, torque, transmitted)
      if (size(train%loops, 2) == 0) return
      matrix = train%energies
      shares(:, 1) = -matmul(train%compliance*transmitted, train%loops)
      call dgesv(size(shares), 1, matrix, size(shares), pivots, shares, size(shares), info)
      if (info == 0) transmitted = transmitted + matmul(train%loops, shares(:, 1))
   end subroutine train_carries

   !> The same for the spanning tree only: from the leaves to the ground, every edge transmits the torques of its subtree.
   !> Equation T67.
   pure subroutine tree_carries(train, torque, transmitted)
      type(train_t), intent(in) :: train
      real(wp), intent(in) :: torque(:)
      real(wp), intent(out) :: transmitted(:)
      real(wp) :: behind(size(torque))
      integer :: i, k

      transmitted = 0
      behind = torque
      do i = size(train%order), 1, -1
         associate (node => train%order(i), e => train%up(train%order(i)))
            k = merge(1, 2, train%ends(1, e) == node)
            transmitted(e) = -behind(node)/train%arms(k, e)
            associate (next => train%ends(3 - k, e))
               behind(next) = behind(next) + train%arms(3 - k, e)*transmitted(e)
            end associate
         end associate
      end do
   end subroutine tree_carries

end module evl_train_statics
