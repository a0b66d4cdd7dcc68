!> How far wheels have turned: the positions by which outputs may go. They are linear in the state while its integers stay.
module evl_turned
   use evl_gearbox, only: gearbox_t, i_turns, wheel_speed
   use evl_kinds, only: pi, wp
   use evl_local_variables, only: i_theta
   use evl_tooth_contact, only: nominal_start
   use evl_wheel_loads, only: turns_of_wheel
   implicit none (type, external)
   private

   public :: can_turn, pitches_turned, turns_made

contains

   !> Pitches of the driving wheel of a mesh from where its tooth pair 0, unloaded, is at the start of contact: the position of the
   !> static analysis. They grow in the nominal sense of that wheel.
   pure real(wp) function pitches_turned(gearbox, mesh, y, integers) result(pitches)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh, integers(:)
      real(wp), intent(in) :: y(:)

      associate (contact => gearbox%contacts(gearbox%first(mesh)))
         associate (wheel => gearbox%wheels(contact%wheel_a), rho => nominal_start(contact, integers(i_turns), 0))
            pitches = contact%pair%advance*y(i_theta)
            if (wheel%i_psi > 0) pitches = pitches - contact%pair%sigma*contact%pair%r_ba*y(wheel%i_psi)
            pitches = (pitches + (rho - contact%rho_entry))/contact%base_pitch
         end associate
      end associate
   end function pitches_turned

   !> Turns of a wheel since its start position. They grow in its nominal sense, which the first mesh gives.
   pure real(wp) function turns_made(gearbox, index, y, integers) result(turns)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index !! of the wheel
      real(wp), intent(in) :: y(:)
      integer, intent(in) :: integers(:)
      real(wp) :: whole, angle

      associate (wheel => gearbox%wheels(index))
         call turns_of_wheel(wheel, integers, whole, angle)
         angle = angle + wheel%ratio*y(i_theta)
         if (wheel%i_psi > 0) angle = angle + y(wheel%i_psi)
         turns = sign(1.0_wp, gearbox%contacts(1)%pair%advance*wheel%ratio)*(whole + angle/(2*pi))
      end associate
   end function turns_made

   !> Whether anything turns a wheel, or may: a wheel that moves at the start, a load, the housing. All wheels are connected.
   pure logical function can_turn(gearbox, index, y, yp) result(may)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index            !! of the wheel
      real(wp), intent(in) :: y(:), yp(:)     !! at the start
      integer :: i

      associate (prescribed => gearbox%wheels(index)%prescribed)
         may = gearbox%housing%acts .or. gearbox%nominal%torque_scale > 0 .or. gearbox%nominal%speed_scale > 0
         if (prescribed > 0) may = gearbox%loads(prescribed)%load%fastest > 0
         if (prescribed > 0 .or. may) return
      end associate
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            may = may .or. abs(wheel_speed(wheel, y)) > 0 .or. abs(wheel_speed(wheel, yp)) > 0
         end associate
      end do
   end function can_turn

end module evl_turned
