!> Root stress at fixed points of both fillets of the teeth near the loads of a wheel, at up to eight states with a common discrete
!> state. The range of the stress at a point follows from it.
module evl_root_points
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: lanes, wp
   use evl_output_states, only: output_states
   use evl_root_outputs, only: find_loads
   use evl_root_stress, only: n_root_points, stress_at_points
   use evl_stress_samples, only: n_arcs, n_near
   use evl_tooth_root, only: root_load_t, tooth_stresses
   implicit none (type, external)
   private

   public :: most_root_teeth, root_points

contains

   !> Largest number of teeth near loads.
   pure integer function most_root_teeth(gearbox) result(n)
      type(gearbox_t), intent(in) :: gearbox

      n = (2*n_near + 1)*size(gearbox%contacts)
   end function most_root_teeth

   !> Stresses of all teeth at most `n_near` teeth away from a load. Equation LS1.
   subroutine root_points(gearbox, states, wheel, values, n_teeth)
      type(gearbox_t), intent(in) :: gearbox
      type(output_states), intent(in) :: states !! with the forces of the tooth pairs
      integer, intent(in) :: wheel
      real(wp), intent(inout) :: values(:, :, :, :) !! (state, point, right or left fillet, tooth); as many teeth as fit [Pa]
      integer, intent(out) :: n_teeth
      type(root_load_t) :: loads(size(gearbox%contacts), lanes)
      integer :: teeth(size(values, 4)), n(lanes), i, j, l, side, tooth
      real(wp) :: fillets(0:n_arcs, 2)

      n_teeth = 0
      if (.not. gearbox%root_stresses(wheel)%exists) return
      associate (stress => gearbox%root_stresses(wheel))
         do l = 1, states%n
            call find_loads(gearbox, states%slots, wheel, l, loads(:, l), n(l))
            do i = 1, n(l)
               do j = -n_near, n_near
                  tooth = modulo(loads(i, l)%tooth + j, stress%teeth)
                  if (n_teeth == size(teeth) .or. any(teeth(:n_teeth) == tooth)) cycle
                  n_teeth = n_teeth + 1
                  teeth(n_teeth) = tooth
               end do
            end do
         end do
         do j = 1, n_teeth
            do l = 1, states%n
               call tooth_stresses(stress, loads(:n(l), l), teeth(j), fillets)
               do side = 1, 2
                  values(l, :, side, j) = stress_at_points(fillets(:, side))
               end do
            end do
         end do
      end associate
   end subroutine root_points

end module evl_root_points
