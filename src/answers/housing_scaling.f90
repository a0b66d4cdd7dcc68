!> What counts as large in the motion of a mounted housing, for error control.
!>
!> A force that is about as large as those in the gearbox and those from outside moves the housing on its mount as far as the
!> springs allow, and a free one as far as it gets in a second. The start counts as well.
module evl_housing_scaling
   use evl_gearbox, only: gearbox_t
   use evl_housing, only: at_omega, at_orientation, at_position, at_velocity, n_housing_states
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: housing_scales

   real(wp), parameter :: duration = 1.0_wp !! in which a free housing moves [s]
   real(wp), parameter :: share = 0.01_wp   !! of that motion: what the gears do to a housing is small beside its weight's sag

contains

   !> Scales of the states and of the rows, and the energy that goes with them.
   pure subroutine housing_scales(gearbox, state, row, energy)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(out) :: state(n_housing_states), row(n_housing_states)
      real(wp), intent(out) :: energy !! [J]
      real(wp) :: mass, inertia, force, moment, position, speed, angle, turn

      associate (housing => gearbox%housing)
         mass = housing%mass + sum(gearbox%wheels%support%mass)
         inertia = (housing%inertia(1, 1) + housing%inertia(2, 2) + housing%inertia(3, 3))/3
         force = sum(gearbox%contacts%force_scale) + mass*norm2(housing%gravity) + norm2(housing%force)
         moment = force*maxval(gearbox%wheels%pitch_radius) + norm2(housing%moment)
         call response(force, mass, minval(housing%stiffness), norm2(housing%velocity), position, speed)
         call response(moment, inertia, minval(housing%turn_stiffness), norm2(housing%omega), angle, turn)
      end associate
      state(at_position + 1:at_position + 3) = position
      state(at_orientation + 1:at_orientation + 4) = min(angle, 1.0_wp)/2
      state(at_velocity + 1:at_velocity + 3) = speed
      state(at_omega + 1:at_omega + 3) = turn
      row = state
      row(at_velocity + 1:at_velocity + 3) = mass*speed
      row(at_omega + 1:at_omega + 3) = inertia*turn
      energy = mass*speed**2/2 + inertia*turn**2/2
   end subroutine housing_scales

   !> How far and how fast something moves under a load.
   pure subroutine response(load, inertia, stiffness, start, distance, speed)
      real(wp), intent(in) :: load, inertia, stiffness !! stiffness 0: free
      real(wp), intent(in) :: start                    !! speed at the start
      real(wp), intent(out) :: distance, speed

      real(wp) :: period

      period = duration
      if (stiffness > 0) period = min(duration, sqrt(inertia/stiffness))
      speed = share*max(load/inertia*period, start)
      distance = speed*period
   end subroutine response

end module evl_housing_scaling
