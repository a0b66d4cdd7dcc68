!> Access to the discrete state of tooth contacts. No other module depends on the layout of their integers.
!>
!> The table of root kinds defines them: n_held named integers, and a side for each kind that has one.
module evl_discrete_state
   use evl_flank_deviation, only: zone_end
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_root_kinds, only: moves_flanks, moves_pair, moves_zone_a, moves_zone_b, n_discrete, n_held, n_root_kinds, n_sides
   use evl_tooth_contact, only: contact_mode, flanks_loaded, flanks_off, tooth_contact_t
   implicit none (type, external)
   private

   public :: carries_points, carrying_contact, first_pair, flanks_of, gearbox_store_mode, is_closed, leading_contact
   public :: number_integers, pairs_with, put_flanks, put_pair, take_mode, tooth_pair_of

contains

   !> Assign indices in the discrete state to the integers of all tooth contacts.
   pure subroutine number_integers(contacts, n)
      type(tooth_contact_t), intent(inout) :: contacts(:) !! with their root functions
      integer, intent(inout) :: n !! length of the discrete state
      integer :: i, k

      do i = 1, size(contacts)
         do k = 1, n_discrete
            if (.not. has_integer(contacts(i), k)) cycle
            n = n + 1
            contacts(i)%i_discrete(k) = n
         end do
      end do
   end subroutine number_integers

   !> Whether a contact has integer k.
   pure logical function has_integer(contact, k)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: k !! index in the table

      select case (k)
      case (:n_held)
         has_integer = contact%deviates .or. all(k /= [moves_zone_a, moves_zone_b])
      case default
         has_integer = any(contact%roots == n_root_kinds - n_sides + k - n_held)
      end select
   end function has_integer

   !> Read the mode of a tooth contact from the discrete state.
   pure subroutine take_mode(gearbox, index, integers, reals, mode)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      type(contact_mode), intent(out) :: mode
      integer :: k, n

      associate (contact => gearbox%contacts(index), at => gearbox%contacts(index)%i_discrete)
         mode%tooth_pair = integers(at(1))
         mode%flanks = integers(at(2))
         mode%friction = integers(at(3))
         mode%zone_a = 0
         mode%zone_b = 0
         if (contact%deviates) then
            mode%zone_a = integers(at(4))
            mode%zone_b = integers(at(5))
         end if
         do k = 1, n_sides
            mode%sides(k) = 0
            if (at(n_held + k) > 0) mode%sides(k) = integers(at(n_held + k))
         end do
         mode%v0 = reals(index)
         mode%share = 1
         if (.not. contact%rigid) return
      end associate
      n = pairs_with(gearbox, index, flanks_loaded, integers)
      if (n > 1) mode%share = 1/real(n, wp)
   end subroutine take_mode

   !> Store the mode of a tooth contact in the discrete state.
   pure subroutine gearbox_store_mode(gearbox, index, mode, integers, reals)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      type(contact_mode), intent(in) :: mode
      integer, intent(inout) :: integers(gearbox%n_integers)
      real(wp), intent(inout) :: reals(size(gearbox%contacts))
      integer :: k, values(n_discrete)

      values = [mode%tooth_pair, mode%flanks, mode%friction, mode%zone_a, mode%zone_b, mode%sides]
      do k = 1, n_discrete
         if (gearbox%contacts(index)%i_discrete(k) > 0) integers(gearbox%contacts(index)%i_discrete(k)) = values(k)
      end do
      reals(index) = mode%v0
   end subroutine gearbox_store_mode

   !> Tooth pair of a contact: pitches since the start.
   pure integer function tooth_pair_of(contact, integers) result(pair)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: integers(*)

      pair = integers(contact%i_discrete(moves_pair))
   end function tooth_pair_of

   !> Whether the flanks of a contact are open, loaded, unloaded, apart or off the path.
   pure integer function flanks_of(contact, integers) result(flanks)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: integers(*)

      flanks = integers(contact%i_discrete(moves_flanks))
   end function flanks_of

   !> Set the tooth pair and the flanks of a contact.
   pure subroutine put_pair(contact, tooth_pair, flanks, integers)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: tooth_pair, flanks
      integer, intent(inout) :: integers(*)

      integers(contact%i_discrete(moves_pair)) = tooth_pair
      call put_flanks(contact, flanks, integers)
   end subroutine put_pair

   !> Set the flanks of a contact.
   pure subroutine put_flanks(contact, flanks, integers)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: flanks
      integer, intent(inout) :: integers(*)

      integers(contact%i_discrete(moves_flanks)) = flanks
   end subroutine put_flanks

   !> Number of tooth pairs of a contact's flank in a given state of contact.
   pure integer function pairs_with(gearbox, index, flanks, integers) result(n)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index    !! any tooth contact of the flank
      integer, intent(in) :: flanks   !! flanks_open, ...
      integer, intent(in) :: integers(gearbox%n_integers)
      integer :: m

      n = 0
      associate (first => index - gearbox%contacts(index)%slot)
         do m = first, first + gearbox%contacts(index)%n_slots - 1
            if (flanks_of(gearbox%contacts(m), integers) == flanks) n = n + 1
         end do
      end associate
   end function pairs_with

   !> Whether the tracked points of a flank are those of this contact's tooth pair. This is the first pair of the flank on the path.
   !> If none is on the path, it is the next to enter, since the involutes of the others may not reach.
   pure logical function carries_points(gearbox, index, integers)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index    !! the tooth contact
      integer, intent(in) :: integers(gearbox%n_integers)
      integer :: m

      carries_points = .false.
      if (gearbox%contacts(index)%i_track == 0) return
      associate (first => index - gearbox%contacts(index)%slot, n => gearbox%contacts(index)%n_slots)
         do m = first, first + n - 1
            if (flanks_of(gearbox%contacts(m), integers) == flanks_off) cycle
            carries_points = m == index
            return
         end do
         carries_points = tooth_pair_of(gearbox%contacts(index), integers) &
                          == minval([(tooth_pair_of(gearbox%contacts(m), integers), m=first, first + n - 1)])
      end associate
   end function carries_points

   !> Tooth contact that represents a mesh: the pair that has been longest on the path of the drive flank, or waits for it.
   pure integer function leading_contact(gearbox, mesh, integers) result(index)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      integer, intent(in) :: integers(gearbox%n_integers)
      integer :: best_rank, m, rank

      index = gearbox%first(mesh)
      best_rank = rank_of(gearbox%contacts(index), integers)
      do m = index + 1, gearbox%first(mesh) + gearbox%contacts(index)%n_slots - 1
         associate (mine => gearbox%contacts(m), best => gearbox%contacts(index))
            rank = rank_of(mine, integers)
            if (rank < best_rank) cycle
            if (rank == best_rank .and. tooth_pair_of(mine, integers) > tooth_pair_of(best, integers)) cycle
         end associate
         index = m
         best_rank = rank
      end do
   end function leading_contact

   !> Loaded tooth contact of a mesh: the leading one, or the first other one if the leading one is not loaded; the leading one if
   !> none is loaded.
   pure integer function carrying_contact(gearbox, mesh, integers) result(index)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      integer, intent(in) :: integers(gearbox%n_integers)
      integer :: leader, m

      leader = leading_contact(gearbox, mesh, integers)
      index = leader
      if (flanks_of(gearbox%contacts(leader), integers) == flanks_loaded) return
      do m = gearbox%first(mesh), gearbox%first(mesh + 1) - 1
         if (flanks_of(gearbox%contacts(m), integers) /= flanks_loaded) cycle
         index = m
         return
      end do
   end function carrying_contact

   !> Rank of a pair. 2: between the ends of its flanks; 1: past one of them, within reach of an edge; 0: off the path.
   pure integer function rank_of(contact, integers) result(rank)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: integers(*)

      rank = merge(0, 2, flanks_of(contact, integers) == flanks_off)
      if (rank == 0 .or. .not. contact%has_edges) return
      if (maxval(integers(contact%i_discrete(moves_zone_a:moves_zone_b))) >= zone_end) rank = 1
   end function rank_of

   !> Whether a tooth contact is the leading one of a closed rigid flank.
   pure logical function is_closed(gearbox, index, integers)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      integer, intent(in) :: integers(gearbox%n_integers)

      is_closed = gearbox%contacts(index)%leads
      if (is_closed) is_closed = pairs_with(gearbox, index, flanks_loaded, integers) > 0
   end function is_closed

   !> Tooth pair of a flank that has been longest on the path; that of the first slot if none is on the path.
   pure integer function first_pair(gearbox, leader, integers) result(pair)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: leader, integers(gearbox%n_integers)
      integer :: m

      pair = huge(pair)
      do m = leader, leader + gearbox%contacts(leader)%n_slots - 1
         if (flanks_of(gearbox%contacts(m), integers) /= flanks_off) pair = min(pair, tooth_pair_of(gearbox%contacts(m), integers))
      end do
      if (pair == huge(pair)) pair = tooth_pair_of(gearbox%contacts(leader), integers)
   end function first_pair

end module evl_discrete_state
