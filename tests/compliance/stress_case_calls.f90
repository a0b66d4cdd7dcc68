!> Root stress of the first wheel of a case.
module stress_case_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_status, status_to_c
   use evl_gear, only: gear_t
   use evl_gear_derivation, only: gear_derive
   use evl_influence_store, only: influence_store_t
   use evl_kinds, only: wp
   use evl_parameter_view, only: description_t, parameter_view_t
   use evl_root_stress, only: fillet_extremes, fillet_extremes_t, root_stress, root_stress_t
   use evl_root_stress_description, only: root_stress_create
   use evl_status, only: has_failed, status_t
   use evl_stress_samples, only: n_arcs
   use first_wheel_of, only: first_wheel
   implicit none (type, external)
   private

   public :: test_root_stress_of_case

contains

   !> Largest and least stress over line load of the right fillet by a load on the right flank; 0 if the wheel has no root stress.
   integer(c_int) function test_root_stress_of_case(description, rho, extremes, outcome) result(exists) bind(c)
      type(c_ptr), intent(in), value :: description
      real(c_double), intent(in), value :: rho
      real(c_double), intent(inout) :: extremes(2)
      type(c_status), intent(inout) :: outcome
      type(description_t), pointer :: d
      type(parameter_view_t) :: root
      type(parameter_view_t), allocatable :: materials(:)
      type(gear_t) :: gear
      type(influence_store_t) :: store
      type(root_stress_t) :: stress
      type(fillet_extremes_t) :: extreme
      type(status_t) :: status
      real(wp) :: right(0:n_arcs), left(0:n_arcs)

      call c_f_pointer(description, d)
      call root%all_of(d)
      call root%elements("materials", materials)
      call gear_derive(first_wheel(description), gear, status)
      if (.not. has_failed(status)) call root_stress_create(first_wheel(description), materials(1), gear, store, stress, status)
      call status_to_c(status, outcome)
      exists = merge(1, 0, stress%exists)
      call root_stress(stress, 1, rho, 0, right, left)
      extreme = fillet_extremes(stress, right)
      extremes = [extreme%largest, extreme%least]
   end function test_root_stress_of_case

end module stress_case_calls
