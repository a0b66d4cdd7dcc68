!> Root stress of the wheels of a gearbox. Gearboxes are created without it; it is added on request.
module evl_gearbox_root_stress
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_description, only: mesh_input, read_description, wheel_input
   use evl_influence_store, only: influence_store_t
   use evl_parameter_view, only: description_t, parameter_view_t
   use evl_root_stress_description, only: root_stress_create
   use evl_shaft, only: shaft_t
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: gearbox_add_root_stress

contains

   !> Add the influence functions of the root stress of all wheels with finite elements; none are computed if a gearbox has them.
   !>
   !> Errors: those of the store.
   subroutine gearbox_add_root_stress(description, store, gearbox, status)
      type(description_t), target, intent(in) :: description !! of the gearbox
      class(influence_store_t), intent(inout) :: store       !! as for `gearbox_create`
      type(gearbox_t), intent(inout) :: gearbox
      type(status_t), intent(inout) :: status
      type(parameter_view_t) :: root
      type(wheel_input), allocatable :: wheels(:)
      type(mesh_input), allocatable :: meshes(:)
      type(shaft_t), allocatable :: shafts(:)
      integer :: i

      if (allocated(gearbox%root_stresses)) return
      call root%all_of(description)
      call read_description(root, wheels, meshes, shafts, status)
      if (has_failed(status)) return
      allocate (gearbox%root_stresses(size(wheels)))
      do i = 1, size(wheels)
         call root_stress_create(wheels(i)%parameter_view_t, wheels(i)%material, gearbox%gears(i), store, &
                                 gearbox%root_stresses(i), status)
         if (.not. has_failed(status)) cycle
         status%index = i
         deallocate (gearbox%root_stresses)
         return
      end do
   end subroutine gearbox_add_root_stress

end module evl_gearbox_root_stress
