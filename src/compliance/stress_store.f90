!> Root stress of wheels in the store of influence functions: entries with a longer key, which are computed only on request.
module evl_stress_store
   use evl_influence_store, only: influence_store_t, n_key, wheel_key
   use evl_kinds, only: wp
   use evl_plane_element, only: elasticity_t
   use evl_status, only: has_failed, status_t
   use evl_stress_samples, only: compute_stress_samples, count_stress_samples, pack_stress_samples, stress_samples_t, &
                                 stress_version, unpack_stress_samples
   use evl_tooth_outline, only: tooth_outline_t
   implicit none (type, external)
   private

   public :: stress_by_store

contains

   !> Samples of the root stress of a wheel: from the store, or computed and added to the store.
   !>
   !> Errors: those of compute_stress_samples and of the store.
   subroutine stress_by_store(store, outline, hub_radius, order, law, samples, status)
      class(influence_store_t), intent(inout) :: store
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: hub_radius !! in modules
      integer, intent(in) :: order       !! of the elements
      type(elasticity_t), intent(in) :: law
      type(stress_samples_t), intent(out) :: samples
      type(status_t), intent(inout) :: status
      real(wp) :: key(n_key + 1)
      real(wp), allocatable :: numbers(:)
      logical :: is_known

      key = [wheel_key(outline, hub_radius, order, law), real(stress_version, wp)]
      allocate (numbers(count_stress_samples(outline%teeth)))
      call store%find(key, numbers, is_known, status)
      if (has_failed(status)) return
      if (.not. is_known) then
         call compute_stress_samples(outline, hub_radius, order, law, samples, status)
         if (has_failed(status)) return
         numbers(:) = pack_stress_samples(samples)
         call store%put(key, numbers, status)
         if (has_failed(status)) return
      end if
      call unpack_stress_samples(outline%teeth, numbers, samples)
   end subroutine stress_by_store

end module evl_stress_store
