!> Extremes of the root stress over all teeth of a wheel, under the loads of its tooth pairs. Equation RS3.
!>
!> The right flank of a tooth faces counterclockwise; teeth are counted counterclockwise. Extremes are searched in the fillets of
!> loaded teeth: a load stresses any other tooth at most 0.4 times as much as its own (19 teeth).
module evl_tooth_root
   use evl_kinds, only: nan, wp
   use evl_root_stress, only: fillet_extremes, fillet_extremes_t, left_flank, right_flank, root_stress, root_stress_t
   use evl_stress_samples, only: n_arcs
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: include_tooth, loaded_flank, root_extremes, root_extremes_t, root_load_t, tooth_stresses

   !> Load of a tooth pair on a wheel.
   type :: root_load_t
      integer :: flank = right_flank
      integer :: tooth = 0           !! modulo the number of teeth
      real(wp) :: rho = 0.0_wp       !! radius of curvature at the load [m]
      real(wp) :: line_load = 0.0_wp !! > 0 [N/m]
   end type root_load_t

   !> Largest and least stress; 0 without loads.
   type :: root_extremes_t
      real(wp) :: largest = 0.0_wp, least = 0.0_wp       !! [Pa]
      real(wp) :: arc_largest = nan, arc_least = nan     !! from the form circle; NaN without loads [m]
      integer :: tooth_largest = 0, tooth_least = 0      !! from 0
   end type root_extremes_t

contains

   !> Flank on which a contact loads both of its wheels.
   pure integer function loaded_flank(contact) result(flank)
      type(tooth_contact_t), intent(in) :: contact

      flank = merge(left_flank, right_flank, contact%pair%sigma > 0)
   end function loaded_flank

   !> Extremes over all teeth, both fillets and their arcs.
   pure subroutine root_extremes(stress, loads, extremes)
      type(root_stress_t), intent(in) :: stress
      type(root_load_t), intent(in) :: loads(:)
      type(root_extremes_t), intent(out) :: extremes
      integer :: teeth(size(loads)), i, n, tooth

      n = 0
      do i = 1, size(loads)
         tooth = modulo(loads(i)%tooth, stress%teeth)
         if (any(teeth(:n) == tooth)) cycle
         n = n + 1
         teeth(n) = tooth
         call include_tooth(stress, loads, tooth, extremes)
      end do
   end subroutine root_extremes

   !> Stresses at all arcs of both fillets of a tooth, the sum over all loads of its wheel. Equation RS3.
   pure subroutine tooth_stresses(stress, loads, tooth, fillets)
      type(root_stress_t), intent(in) :: stress
      type(root_load_t), intent(in) :: loads(:)
      integer, intent(in) :: tooth
      real(wp), intent(out) :: fillets(0:n_arcs, 2) !! (arc, right or left fillet) [Pa]
      real(wp) :: right(0:n_arcs), left(0:n_arcs)
      integer :: i

      fillets = 0
      do i = 1, size(loads)
         call root_stress(stress, loads(i)%flank, loads(i)%rho, loads(i)%tooth - tooth, right, left)
         fillets(:, right_flank) = fillets(:, right_flank) + loads(i)%line_load*right
         fillets(:, left_flank) = fillets(:, left_flank) + loads(i)%line_load*left
      end do
   end subroutine tooth_stresses

   !> Include the stresses of a tooth in the extremes.
   pure subroutine include_tooth(stress, loads, tooth, extremes)
      type(root_stress_t), intent(in) :: stress
      type(root_load_t), intent(in) :: loads(:)
      integer, intent(in) :: tooth
      type(root_extremes_t), intent(inout) :: extremes
      type(fillet_extremes_t) :: fillet
      real(wp) :: fillets(0:n_arcs, 2)
      integer :: side

      call tooth_stresses(stress, loads, tooth, fillets)
      do side = 1, 2
         fillet = fillet_extremes(stress, fillets(:, side))
         if (fillet%largest > extremes%largest) then
            extremes%largest = fillet%largest
            extremes%arc_largest = fillet%at_largest
            extremes%tooth_largest = tooth
         end if
         if (fillet%least < extremes%least) then
            extremes%least = fillet%least
            extremes%arc_least = fillet%at_least
            extremes%tooth_least = tooth
         end if
      end do
   end subroutine include_tooth

end module evl_tooth_root
