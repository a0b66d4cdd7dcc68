!> Torques that follow from a motion: of a load that prescribes a speed, and in shafts.
module evl_outside_torques
   use evl_gearbox, only: gearbox_t, wheel_speed
   use evl_housing, only: frame_t
   use evl_kinds, only: wp
   use evl_shaft, only: shaft_torque
   use evl_wheel_loads, only: known_torques, wheel_spin_torque
   implicit none (type, external)
   private

   public :: load_torques, shaft_torques

contains

   !> Torque of the loads of every wheel; a load that prescribes a speed brings what its rotor needs [N m].
   pure subroutine load_torques(gearbox, t, y, f, frame, integers, mesh_torque, load_torque)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), f(gearbox%n_states)    !! f: rates of the states
      type(frame_t), intent(in) :: frame       !! of the housing there
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: mesh_torque(:)   !! of the meshes on every wheel [N m]
      real(wp), intent(out) :: load_torque(size(gearbox%wheels))
      real(wp) :: needed(size(gearbox%wheels))
      integer :: i

      call known_torques(gearbox, t, y, integers, load_torque)
      if (gearbox%housing%acts) then
         do i = 1, size(gearbox%wheels)
            load_torque(i) = load_torque(i) + wheel_spin_torque(gearbox, i, frame%omega(3), t, y, integers)
         end do
      end if
      if (.not. any(gearbox%wheels%prescribed > 0)) return
      call needed_torques(gearbox, y, f, frame, mesh_torque + load_torque, needed)
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%prescribed == 0 .or. wheel%leader /= i) cycle
            associate (driver => gearbox%loads(wheel%prescribed)%load%wheel)
               load_torque(driver) = load_torque(driver) + sum(needed, mask=gearbox%wheels%leader == i)
            end associate
         end associate
      end do
   end subroutine load_torques

   !> Torque that every wheel needs for its motion beside that of its meshes, loads and elastic shafts [N m].
   pure subroutine needed_torques(gearbox, y, f, frame, torque, needed)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states), f(gearbox%n_states)
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: torque(:)    !! of meshes and loads on every wheel
      real(wp), intent(out) :: needed(:)
      real(wp) :: carried
      integer :: i

      do i = 1, size(gearbox%wheels)
         needed(i) = gearbox%wheels(i)%inertia*(wheel_speed(gearbox%wheels(i), f) + frame%alpha(3)) - torque(i)
      end do
      do i = 1, size(gearbox%shafts)
         associate (shaft => gearbox%shafts(i))
            if (shaft%rigid) cycle
            carried = shaft_torque(shaft, y)
            needed(shaft%wheel_a) = needed(shaft%wheel_a) + carried
            needed(shaft%wheel_b) = needed(shaft%wheel_b) - carried
         end associate
      end do
   end subroutine needed_torques

   !> Torque of every shaft on its second wheel: by its law, or, if it is rigid, what the wheels behind it need [N m].
   pure subroutine shaft_torques(gearbox, y, f, frame, torque, carried)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states), f(gearbox%n_states)
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: torque(:)    !! of meshes and all loads on every wheel [N m]
      real(wp), intent(out) :: carried(:)
      real(wp) :: needed(size(gearbox%wheels))
      integer :: i, k

      call needed_torques(gearbox, y, f, frame, torque, needed)
      do i = 1, size(gearbox%shafts)
         if (gearbox%shafts(i)%rigid) then
            carried(i) = 0
            do k = 1, size(gearbox%shafts(i)%behind) ! a rotor's shafts form no ring
               carried(i) = carried(i) + needed(gearbox%shafts(i)%behind(k))
            end do
         else
            carried(i) = shaft_torque(gearbox%shafts(i), y)
         end if
      end do
   end subroutine shaft_torques

end module evl_outside_torques
