!> C interface of the influence functions of the root stress. The header documents each procedure.
module evl_capi_root_stress
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_ptr
   use evl_capi_types, only: gearbox_of
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_root_stress, only: right_flank, root_stress
   use evl_stress_samples, only: n_arcs
   implicit none (type, external)
   private

   public :: evl_gearbox_root_arcs, evl_gearbox_root_influence

contains

   integer(c_int) function evl_gearbox_root_arcs(handle, wheel, arcs) result(n) bind(c)
      integer(c_int), intent(in), value :: wheel
      real(c_double), intent(inout) :: arcs(0:n_arcs)
      include "capi/gearbox_of_handle.inc"

      n = 0
      if (.not. allocated(g%root_stresses)) return
      if (.not. g%root_stresses(wheel + 1)%exists) return
      n = n_arcs + 1
      arcs = g%root_stresses(wheel + 1)%arcs
   end function evl_gearbox_root_arcs

   subroutine evl_gearbox_root_influence(handle, wheel, n, flanks, rho, teeth, stress) bind(c)
      integer(c_int), intent(in), value :: wheel, n
      integer(c_int), intent(in) :: flanks(n), teeth(n)
      real(c_double), intent(in) :: rho(n)
      real(c_double), intent(inout) :: stress(0:n_arcs, 2, n)
      real(wp), dimension(0:n_arcs) :: right, left
      integer :: i
      include "capi/gearbox_of_handle.inc"

      do i = 1, n
         call root_stress(g%root_stresses(wheel + 1), right_flank + flanks(i), rho(i), teeth(i), right, left)
         stress(:, 1, i) = right
         stress(:, 2, i) = left
      end do
   end subroutine evl_gearbox_root_influence

end module evl_capi_root_stress
