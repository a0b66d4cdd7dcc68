!> Some outputs of a gearbox in eight states at once, as `gearbox_outputs` tells them in one: those that numbers of a case are made
!> of, which ask for many states. They are what the lanes of the rates know; no more is found for them.
!>
!> A name in `lane_names` and a line in `tell_meshes` or `tell_wheels` make one more; a test compares all of them with those in one
!> state.
module evl_lane_outputs
   use evl_contact_point, only: tracked_pair
   use evl_discrete_state, only: leading_contact
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_gearbox_lanes, only: lanes_serve, rates_in_lanes
   use evl_gearbox_ode, only: settle_slots
   use evl_kinds, only: lanes, pi, wp
   use evl_line_lanes, only: centre_turn_in_lanes, lane_line, motion_in_lanes, turn_wheel
   use evl_local_variables, only: i_omega, i_theta
   use evl_status, only: has_failed, status_t
   use evl_support, only: axle_deviation
   use evl_tooth_contact, only: flank_coast, flanks_loaded, tooth_contact_t
   implicit none (type, external)
   private

   public :: lane_kind, outputs_in_lanes, serves_in_lanes

   !> Names of the outputs that are told here.
   character(len=31), parameter :: lane_names(*) = [character(len=31) :: "transmission_error", "normal_force", "coast_force", &
                                                    "mesh_torque_driving", "pairs_in_contact", "pair_normal_force", "angle", &
                                                    "angular_velocity", "angular_acceleration", "centre_acceleration"]

   !> The same as numbers, in that order.
   enum, bind(c)
      enumerator :: lane_error = 1, lane_normal, lane_coast, lane_torque, lane_loaded, lane_pair_normal, lane_angle, lane_speed, &
         lane_acceleration, lane_axle
   end enum

contains

   include "contact/transmission_error.inc"

   !> Which of the outputs here one of the table is; 0: none.
   pure integer function lane_kind(name) result(kind)
      character(len=*), intent(in) :: name

      kind = findloc(lane_names == name, .true., dim=1)
   end function lane_kind

   !> Whether all wanted outputs are told here.
   pure logical function serves_in_lanes(gearbox, wanted) result(serves)
      type(gearbox_t), intent(in) :: gearbox
      logical, intent(in) :: wanted(:) !! of the table

      serves = .not. any(wanted .and. gearbox%output_lanes == 0)
      if (serves) serves = lanes_serve(gearbox)
   end function serves_in_lanes

   !> Their values at eight states that share their discrete state, as in a step; the others stay as they are.
   subroutine outputs_in_lanes(gearbox, t, y, integers, reals, wanted, values, status)
      type(gearbox_t), intent(in) :: gearbox         !! served, as `serves_in_lanes` says
      real(wp), intent(in) :: t(lanes), y(lanes, gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      logical, intent(in) :: wanted(:)               !! of the table
      real(wp), intent(inout) :: values(:, :)        !! (n_values, lanes)
      type(status_t), intent(inout) :: status        !! as of `rates_in_lanes`
      type(lane_slot) :: slots(size(gearbox%contacts))
      real(wp) :: f(lanes, gearbox%n_states)
      integer :: i

      call settle_slots(gearbox, integers, reals, slots)
      call rates_in_lanes(gearbox, t, y, integers, reals, slots, f, status)
      if (has_failed(status)) return
      do i = 1, size(wanted)
         if (.not. wanted(i)) cycle
         associate (offset => gearbox%output_offsets(i), count => gearbox%output_counts(i), kind => gearbox%output_lanes(i))
            if (count > 0 .and. kind < lane_angle) call tell_meshes(gearbox, kind, y, integers, slots, values(offset + 1:offset &
                                                                                                             + count, :))
            if (count > 0 .and. kind >= lane_angle) call tell_wheels(gearbox, kind, y, f, integers, values(offset + 1:offset &
                                                                                                           + count, :))
         end associate
      end do
   end subroutine outputs_in_lanes

   !> One output of all meshes.
   subroutine tell_meshes(gearbox, kind, y, integers, slots, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: kind
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(:)
      type(lane_slot), intent(in) :: slots(:) !! as the rates left them
      real(wp), intent(out) :: values(:, :)   !! (of the output, lanes)
      real(wp) :: row(lanes)
      integer :: c, m, place

      values = 0
      do m = 1, size(gearbox%pairs)
         if (kind == lane_error) then
            call find_error(gearbox%contacts(leading_contact(gearbox, m, integers)), y, row)
            values(m, :) = row
            cycle
         end if
         do c = gearbox%first(m), gearbox%first(m + 1) - 1
            if (.not. slots(c)%touches) cycle
            associate (contact => gearbox%contacts(c), force => slots(c)%force, is_loaded => slots(c)%mode%flanks == flanks_loaded)
               if (kind == lane_torque) values(m, :) = values(m, :) + force%torque_a
               if (.not. is_loaded) cycle
               if (kind == lane_loaded) values(m, :) = values(m, :) + 1
               if (kind == lane_normal .or. (kind == lane_coast .and. contact%flank == flank_coast)) &
                  values(m, :) = values(m, :) + force%unclipped
               place = (m - 1)*gearbox%n_pair_places + 1 + contact%slot + merge(gearbox%n_drive_places, 0, &
                                                                                contact%flank == flank_coast)
               if (kind == lane_pair_normal) values(place, :) = force%unclipped
            end associate
         end do
      end do
   end subroutine tell_meshes

   !> Transmission error of a mesh.
   subroutine find_error(leader, y, lag)
      type(tooth_contact_t), intent(in) :: leader !! the contact that speaks for it
      real(wp), intent(in) :: y(lanes, *)
      real(wp), intent(out) :: lag(lanes)
      type(lane_line) :: line
      real(wp) :: turn(lanes)

      call motion_in_lanes(leader, y, line)
      call centre_turn_in_lanes(leader, line, turn)
      lag = error_of_turns(leader%pair, line%psi_a, line%psi_b, turn)
   end subroutine find_error

   !> One output of all wheels.
   subroutine tell_wheels(gearbox, kind, y, f, integers, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: kind
      real(wp), intent(in) :: y(lanes, gearbox%n_states), f(lanes, gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(out) :: values(:, :)   !! (of the output, lanes)
      real(wp), dimension(lanes) :: psi, rate
      integer :: i, l

      values = 0
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            select case (kind)
            case (lane_angle)
               call turn_wheel(wheel%i_psi, y, psi, rate)
               values(i, :) = wheel%ratio*(y(:, i_theta) + 2*pi*integers(i_turns)) + psi
            case (lane_speed)
               call turn_wheel(wheel%i_psi, y, psi, rate)
               values(i, :) = wheel%ratio*y(:, i_omega) + rate
            case (lane_acceleration)
               call turn_wheel(wheel%i_psi, f, psi, rate)
               values(i, :) = wheel%ratio*f(:, i_omega) + rate
            case default
               if (wheel%support%n == 0) cycle
               do l = 1, lanes
                  values(2*i - 1:2*i, l) = axle_deviation(wheel%support, f(l, :), 1)
               end do
            end select
         end associate
      end do
   end subroutine tell_wheels

end module evl_lane_outputs
