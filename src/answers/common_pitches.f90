!> Pitches of one mesh in which all meshes of a gearbox pass whole pitches.
module evl_common_pitches
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_rational, only: divisor_of
   implicit none (type, external)
   private

   public :: most_common_pitches, whole_pitches

   integer(int64), parameter :: most_common_pitches = 10000 !! whole pitches of all meshes may need more

contains

   !> Pitches of a mesh in which every mesh passes whole pitches, or most_common_pitches if that is less.
   pure integer(int64) function whole_pitches(gearbox, mesh) result(pitches)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      integer(int64) :: above, below
      integer :: m

      pitches = 1
      associate (first => gearbox%contacts(gearbox%first(mesh))%pitches_per_turn)
         do m = 1, size(gearbox%pairs)
            associate (other => gearbox%contacts(gearbox%first(m))%pitches_per_turn)
               ! the denominator of other/first in lowest terms, as two factors
               above = abs(first%above)/divisor_of(first%above, other%above)
               below = other%below/divisor_of(first%below, other%below)
            end associate
            if (real(above, wp)*real(below, wp) > real(most_common_pitches, wp)) then
               pitches = most_common_pitches
            else
               pitches = min(most_common_pitches, pitches/divisor_of(pitches, above*below)*above*below)
            end if
         end do
      end associate
   end function whole_pitches

end module evl_common_pitches
