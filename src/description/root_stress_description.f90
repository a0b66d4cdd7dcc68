!> Root stress of a wheel of a case, with the elements of its compliance.
module evl_root_stress_description
   use evl_compliance_description, only: find_hub
   use evl_gear, only: gear_t
   use evl_influence_store, only: influence_store_t
   use evl_kinds, only: wp
   use evl_parameter_view, only: parameter_view_t
   use evl_plane_element, only: elasticity_t, plane_strain, plane_stress
   use evl_root_stress, only: root_stress_from_samples, root_stress_t
   use evl_status, only: has_failed, status_t
   use evl_stress_samples, only: stress_samples_t
   use evl_stress_store, only: stress_by_store
   use evl_tooth_outline, only: outline_of_gear, tooth_outline_t
   implicit none (type, external)
   private

   public :: root_stress_create

contains

   !> Influence functions of the root stress; `exists` is false without `compliance` or with a model other than finite_elements.
   !>
   !> Valid: after `compliance_create` has accepted the wheel. Errors: those of the store.
   subroutine root_stress_create(wheel, material, gear, store, stress, status)
      type(parameter_view_t), intent(in) :: wheel, material
      type(gear_t), intent(in) :: gear
      class(influence_store_t), intent(inout) :: store
      type(root_stress_t), intent(out) :: stress
      type(status_t), intent(inout) :: status
      type(parameter_view_t) :: input, rack
      type(tooth_outline_t) :: outline
      type(elasticity_t) :: law
      type(stress_samples_t) :: samples
      real(wp) :: hub

      if (.not. wheel%has("compliance")) return
      call wheel%inner("compliance", input)
      if (input%word("model") /= "finite_elements") return
      call find_hub(input, gear, hub, status)
      if (has_failed(status)) return
      law = plane_strain(material%number("poisson_ratio"))
      if (input%word("state") == "plane_stress") law = plane_stress(material%number("poisson_ratio"))
      call wheel%inner("rack", rack)
      outline = outline_of_gear(gear, rack%number("root_radius"))
      call stress_by_store(store, outline, hub/gear%normal_module, input%whole("order"), law, samples, status)
      if (.not. has_failed(status)) call root_stress_from_samples(samples, outline, gear%normal_module, stress)
   end subroutine root_stress_create

end module evl_root_stress_description
