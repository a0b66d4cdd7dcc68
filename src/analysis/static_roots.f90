!> Root stress at a position of a quasi-static analysis: extremes of the loaded teeth of both wheels.
!>
!> The stress of one tooth is a smooth function of the position between the borders of its pairs; the largest one of all teeth is
!> not, because another tooth takes over.
module evl_static_roots
   use evl_coupled_pairs, only: most_pairs
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: nan, wp
   use evl_pair_point, only: by_a, by_b
   use evl_root_stress, only: root_stress_t
   use evl_static_mesh, only: static_state
   use evl_tooth_contact, only: tooth_contact_t, tooth_of_a, tooth_of_b
   use evl_tooth_root, only: include_tooth, loaded_flank, root_extremes_t, root_load_t
   implicit none (type, external)
   private

   public :: extremes_of_pairs, find_static_roots, root_record_t, static_loads, static_roots_t, wheels_with_roots

   !> Influence functions of the driving and the driven wheel; null: the wheel has none.
   type :: static_roots_t
      type(root_stress_t), pointer :: a => null(), b => null()
      integer :: n_pitches = 1 !! number of pitches after which the positions repeat
   end type static_roots_t

   !> An extreme of the root stress over the positions.
   type :: root_record_t
      real(wp) :: value = nan    !! [Pa]
      real(wp) :: arc = nan      !! from the form circle [m]
      real(wp) :: position = nan !! from 0 to below n_pitches [pitches]
      integer :: tooth = -1      !! -1: none
   end type root_record_t

contains

   !> Influence functions of the wheels of a contact, if they have any.
   subroutine wheels_with_roots(gearbox, contact, n_pitches, roots)
      type(gearbox_t), intent(in), target :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: n_pitches
      type(static_roots_t), intent(out) :: roots

      roots%n_pitches = n_pitches
      if (.not. allocated(gearbox%root_stresses)) return
      if (gearbox%root_stresses(contact%wheel_a)%exists) roots%a => gearbox%root_stresses(contact%wheel_a)
      if (gearbox%root_stresses(contact%wheel_b)%exists) roots%b => gearbox%root_stresses(contact%wheel_b)
   end subroutine wheels_with_roots

   !> Extremes of the tooth that each pair loads, on both wheels; zeros for pairs without load and wheels without root stress.
   !> Equation RS3.
   pure subroutine find_static_roots(roots, contact, turns, x, state, of_pairs)
      type(static_roots_t), intent(in) :: roots
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: turns !! +1 or -1: sense of the contact's pair numbers relative to those of the state
      real(wp), intent(in) :: x    !! position; below 0 it is the one a whole cycle later [pitches]
      type(static_state), intent(in) :: state
      type(root_extremes_t), intent(out) :: of_pairs(2, most_pairs)
      type(root_load_t) :: loads(2, most_pairs)
      integer :: i, n, pairs(most_pairs)

      call static_loads(contact, turns, merge(roots%n_pitches, 0, x < 0), state, loads, pairs, n)
      do i = 1, n
         if (associated(roots%a)) call include_tooth(roots%a, loads(by_a, :n), modulo(loads(by_a, i)%tooth, roots%a%teeth), &
                                                     of_pairs(by_a, pairs(i)))
         if (associated(roots%b)) call include_tooth(roots%b, loads(by_b, :n), modulo(loads(by_b, i)%tooth, roots%b%teeth), &
                                                     of_pairs(by_b, pairs(i)))
      end do
   end subroutine find_static_roots

   !> Loads of the pairs on both wheels.
   pure subroutine static_loads(contact, turns, shift, state, loads, pairs, n)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: turns !! +1 or -1: sense of the contact's pair numbers relative to those of the state
      integer, intent(in) :: shift !! added to the numbers of the state
      type(static_state), intent(in) :: state
      type(root_load_t), intent(inout) :: loads(2, most_pairs)
      integer, intent(out) :: pairs(most_pairs), n !! indices and number of the loaded pairs
      integer :: i, number

      n = 0
      pairs = 0
      do i = 1, state%n
         associate (feet => state%feet(i), line_load => state%potential%solution%force(i))
            if (.not. line_load > 0) cycle
            n = n + 1
            pairs(n) = i
            number = turns*(state%numbers(i) + shift)
            loads(by_a, n) = root_load_t(loaded_flank(contact), tooth_of_a(contact, number), feet%foot(by_a), line_load)
            loads(by_b, n) = root_load_t(loaded_flank(contact), tooth_of_b(contact, number), feet%foot(by_b), line_load)
         end associate
      end do
   end subroutine static_loads

   !> Extremes over all pairs.
   pure type(root_extremes_t) function extremes_of_pairs(of_pairs) result(extremes)
      type(root_extremes_t), intent(in) :: of_pairs(:)
      integer :: i

      extremes = root_extremes_t()
      do i = 1, size(of_pairs)
         if (of_pairs(i)%largest > extremes%largest) then
            extremes%largest = of_pairs(i)%largest
            extremes%arc_largest = of_pairs(i)%arc_largest
            extremes%tooth_largest = of_pairs(i)%tooth_largest
         end if
         if (of_pairs(i)%least < extremes%least) then
            extremes%least = of_pairs(i)%least
            extremes%arc_least = of_pairs(i)%arc_least
            extremes%tooth_least = of_pairs(i)%tooth_least
         end if
      end do
   end function extremes_of_pairs

end module evl_static_roots
