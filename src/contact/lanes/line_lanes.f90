!> Line of action of a flank and motion of its wheels for eight states at once; all tooth contacts of the flank share them.
module evl_line_lanes
   use evl_closed_form, only: centre_line_angle
   use evl_contact_point, only: tracked_pair
   use evl_kinds, only: lanes, wp
   use evl_local_variables, only: i_omega, i_theta, wheel_link
   use evl_tangent_line, only: small_sine, tangent_angle, tangent_line_t
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: lane_line, line_in_lanes, motion_in_lanes, centre_turn_in_lanes, turn_wheel

   !> Motion of the wheels and line of action in eight states.
   type :: lane_line
      real(wp), dimension(lanes) :: theta, omega, psi_a, psi_b, psi_dot_a, psi_dot_b !! as the local variables
      real(wp), dimension(lanes) :: u_t, u_e, v_t, v_e !! displacement and velocity of axle B relative to axle A
      real(wp), dimension(lanes) :: margin             !! positive if there is a line of action
      real(wp), dimension(lanes) :: d_rho, rho, angle, s, c !! as in `tangent_line_t`
      integer :: mesh = 0, flank = 0                   !! to which the line belongs; 0: none yet
   end type lane_line

contains

   include "numerics/all_positive.inc"
   include "contact/tangent_line.inc"
   include "contact/small_angle.inc"
   include "contact/centre_line.inc"

   !> Compute motion and line of action for the flank of a tooth contact, unless they are already present.
   subroutine line_in_lanes(contact, y, line)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: y(lanes, *)       !! (lanes, states)
      type(lane_line), intent(inout) :: line    !! empty, or of a flank in the same states
      real(wp) :: r, rho_0
      integer :: l

      if (line%mesh == contact%mesh .and. line%flank == contact%flank) return
      line%mesh = contact%mesh
      line%flank = contact%flank
      call motion_in_lanes(contact, y, line)
      if (contact%axles_rest) then
         call rest_line(contact%rest_line, line)
         return
      end if
      r = contact%pair%r_b
      rho_0 = contact%pair%rho_0
      !$omp simd
      do l = 1, lanes
         call tangent_line(r, rho_0, line%u_t(l), line%u_e(l), line%margin(l), line%d_rho(l), line%rho(l), line%s(l), &
                           line%c(l))
         line%angle(l) = small_angle(line%s(l))
      end do
      if (.not. all_positive(small_sine - abs(line%s))) call large_angles(line%s, line%c, line%angle)
   end subroutine line_in_lanes

   !> Motion of the wheels alone.
   pure subroutine motion_in_lanes(contact, y, line)
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: y(lanes, *)       !! (lanes, states)
      type(lane_line), intent(inout) :: line

      line%theta = y(:, i_theta)
      line%omega = y(:, i_omega)
      call turn_wheel(contact%link_a%i_psi, y, line%psi_a, line%psi_dot_a)
      call turn_wheel(contact%link_b%i_psi, y, line%psi_b, line%psi_dot_b)
      call move_axles(contact%link_a, contact%link_b, y, line)
   end subroutine motion_in_lanes

   !> Deviation of a wheel from its nominal rotation, and its rate.
   pure subroutine turn_wheel(i_psi, y, psi, psi_dot)
      integer, intent(in) :: i_psi         !! index of psi in the state, psi' follows; 0: none, as for the reference rotor
      real(wp), intent(in) :: y(lanes, *)
      real(wp), intent(out) :: psi(lanes), psi_dot(lanes)

      if (i_psi == 0) then
         psi = 0
         psi_dot = 0
      else
         psi = y(:, i_psi)
         psi_dot = y(:, i_psi + 1)
      end if
   end subroutine turn_wheel

   !> Motion of axle B relative to axle A.
   pure subroutine move_axles(link_a, link_b, y, line)
      type(wheel_link), intent(in) :: link_a, link_b
      real(wp), intent(in) :: y(lanes, *)
      type(lane_line), intent(inout) :: line
      real(wp), dimension(lanes) :: u_t, u_e, v_t, v_e

      call move_axle(link_b, y, line%u_t, line%u_e, line%v_t, line%v_e)
      if (link_a%n == 0) return
      call move_axle(link_a, y, u_t, u_e, v_t, v_e)
      line%u_t = line%u_t - u_t
      line%u_e = line%u_e - u_e
      line%v_t = line%v_t - v_t
      line%v_e = line%v_e - v_e
   end subroutine move_axles

   !> Displacement and velocity of an axle.
   pure subroutine move_axle(link, y, u_t, u_e, v_t, v_e)
      type(wheel_link), intent(in) :: link
      real(wp), intent(in) :: y(lanes, *)
      real(wp), dimension(lanes), intent(out) :: u_t, u_e, v_t, v_e

      if (link%n == 0) then
         u_t = 0
         u_e = 0
         v_t = 0
         v_e = 0
         return
      end if
      associate (s => link%i_state(1), along_t => link%along_t(1), along_e => link%along_e(1))
         ! start the sum with 0 as in the version for one state: at standstill the result is not -0
         u_t = 0 + along_t*y(:, s)
         u_e = 0 + along_e*y(:, s)
         v_t = 0 + along_t*y(:, s + 1)
         v_e = 0 + along_e*y(:, s + 1)
      end associate
      if (link%n == 1) return
      associate (s => link%i_state(2), along_t => link%along_t(2), along_e => link%along_e(2))
         u_t = u_t + along_t*y(:, s)
         u_e = u_e + along_e*y(:, s)
         v_t = v_t + along_t*y(:, s + 1)
         v_e = v_e + along_e*y(:, s + 1)
      end associate
   end subroutine move_axle

   !> Line of action between fixed axles.
   pure subroutine rest_line(at_rest, line)
      type(tangent_line_t), intent(in) :: at_rest
      type(lane_line), intent(inout) :: line

      line%margin = merge(1.0_wp, 0.0_wp, at_rest%exists)
      line%d_rho = at_rest%d_rho
      line%rho = at_rest%rho
      line%angle = at_rest%angle
      line%s = at_rest%s
      line%c = at_rest%c
   end subroutine rest_line

   !> Angles, if one is too large for the series. Not vectorised: the vector library's arc tangent differs in the last bits.
   subroutine large_angles(s, c, angle)
      real(wp), intent(in) :: s(lanes), c(lanes)
      real(wp), intent(out) :: angle(lanes)
      integer :: l

      !GCC$ novector
      do l = 1, lanes
         angle(l) = tangent_angle(s(l), c(l))
      end do
   end subroutine large_angles

   !> Rotation of the centre line [rad].
   subroutine centre_turn_in_lanes(contact, line, turn)
      type(tooth_contact_t), intent(in) :: contact
      type(lane_line), intent(in) :: line
      real(wp), intent(out) :: turn(lanes)
      real(wp), dimension(lanes) :: along, across
      type(tracked_pair) :: pair
      integer :: l

      if (contact%axles_rest) then
         turn = 0
         return
      end if
      pair = contact%pair
      !$omp simd
      do l = 1, lanes
         call centre_line(pair, line%u_t(l), line%u_e(l), along(l), across(l))
         turn(l) = small_arctangent(across(l)/along(l))
      end do
      if (all_positive(small_sine*along - abs(across))) return
      !GCC$ novector
      do l = 1, lanes
         turn(l) = centre_line_angle(along(l), across(l))
      end do
   end subroutine centre_turn_in_lanes

end module evl_line_lanes
