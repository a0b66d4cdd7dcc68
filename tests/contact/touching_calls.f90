!> Contact of relieved flanks, for the tests: a C call that the kernel does not export.
module touching_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_ptr
   use evl_contact_curvature, only: contact_curvature, first_order_gap, second_order_gap
   use evl_contact_point, only: contact_point
   use evl_gearbox, only: gearbox_t
   use evl_tooth_contact, only: contact_mode, no_mode, settle_zones
   implicit none (type, external)
   private

   public :: test_touching_flanks

contains

   !> Drive flanks of a tooth pair at radii of curvature of the driving flank [m]: excess of the first-order gap over the actual one
   !> [m], and the sum of the curvatures at the contact [1/m].
   subroutine test_touching_flanks(handle, mesh, pair, n, rho, second_order, curvature, gap) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh, pair, n
      real(c_double), intent(in) :: rho(n)
      real(c_double), intent(out) :: second_order(n), curvature(n), gap(n)
      type(gearbox_t), pointer :: g
      type(contact_point) :: point
      type(contact_mode) :: mode
      integer :: i

      call c_f_pointer(handle, g)
      associate (contact => g%contacts(g%first(mesh + 1)))
         mode = no_mode
         mode%tooth_pair = pair
         do i = 1, n
            point%rho_a = rho(i)
            point%rho_b = contact%pair%rho_0 - rho(i)
            call settle_zones(contact, contact%pair%rho_0, point, mode)
            gap(i) = first_order_gap(contact, pair, point%rho_a, point%rho_b)
            second_order(i) = second_order_gap(contact, pair, rho(i))
            curvature(i) = contact_curvature(contact, mode, point, [point%rho_a, point%rho_b])
         end do
      end associate
   end subroutine test_touching_flanks

end module touching_calls
