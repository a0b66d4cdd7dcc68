!> Sequence of the tooth pairs of a flank: the pair that follows another one in a slot.
module evl_pair_sequence
   use evl_kinds, only: wp
   use evl_tooth_contact, only: contact_mode, flanks_off, tooth_contact_t
   implicit none (type, external)
   private

   public :: exactly_one, next_pair, pair_on_path

   real(wp), parameter :: most_pitches = 1.0e9_wp !! limit of integer conversion; only a diverged motion exceeds it
   real(wp), parameter :: exactly_one = 1.0e-9_wp !! contact ratios this near an integer count as that integer; at 1 pairs hand over

contains

   !> Tooth pair that replaces one that passes an end of the path, or that has advanced by a pitch.
   pure integer function next_pair(contact, mode, forward) result(pair)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode !! of the pair that passes
      logical, intent(in) :: forward         !! at the end where pairs leave in the nominal sense of rotation

      pair = mode%tooth_pair
      if (contact%handover) then
         pair = pair + merge(1, -1, forward)
      else if (forward) then
         pair = pair + merge(-contact%n_slots, contact%n_slots, mode%flanks == flanks_off)
      end if
   end function next_pair

   !> Tooth pair of a slot that is on the path or enters it next; the pairs of a slot are n_slots pitches apart.
   pure integer function pair_on_path(contact, pair, pitches) result(there)
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: pair     !! a pair of this slot
      real(wp), intent(in) :: pitches !! its distance from the point where pairs enter

      there = pair
      if (abs(pitches) < most_pitches) there = pair + contact%n_slots*floor(pitches/contact%n_slots)
   end function pair_on_path

end module evl_pair_sequence
