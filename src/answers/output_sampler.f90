!> Some outputs of a gearbox, asked for at many states: eight at once where the lanes of the rates know them, else one by one as
!> `wanted_outputs` tells them. A sampler keeps what the lanes need from one call to the next.
!>
!> An output that is told in lanes has its name in `lane_names` and a line in `tell_meshes` or `tell_wheels`; a test compares all of
!> them with those in one state.
module evl_output_sampler
   use evl_contact_point, only: tracked_pair
   use evl_discrete_state, only: leading_contact
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_gearbox_lanes, only: lanes_serve, rates_in_lanes
   use evl_gearbox_ode, only: settle_slots
   use evl_kinds, only: lanes, pi, wp
   use evl_line_lanes, only: centre_turn_in_lanes, lane_line, motion_in_lanes, turn_wheel
   use evl_local_variables, only: i_omega, i_theta
   use evl_output, only: output_t
   use evl_output_list, only: list_outputs
   use evl_outputs, only: wanted_outputs
   use evl_status, only: has_failed, status_t
   use evl_support, only: axle_deviation
   use evl_tooth_contact, only: flank_coast, flanks_loaded, tooth_contact_t
   implicit none (type, external)
   private

   public :: output_sampler, sample_outputs, sampler_create

   !> Names of the outputs that are told in lanes.
   character(len=31), parameter :: lane_names(*) = [character(len=31) :: "transmission_error", "normal_force", "coast_force", &
                                                          "mesh_torque_driving", "pairs_in_contact", "pair_normal_force", "angle", &
                                                                  "angular_velocity", "angular_acceleration", "centre_acceleration"]

   !> The same as numbers, in that order.
   enum, bind(c)
      enumerator :: lane_error = 1, lane_normal, lane_coast, lane_torque, lane_loaded, lane_pair_normal, lane_angle, lane_speed, &
         lane_acceleration, lane_axle
   end enum

   !> Outputs that are asked for. Their values stand one output behind the other.
   type :: output_sampler
      integer, allocatable :: wanted(:)  !! places in the table
      integer, allocatable :: kinds(:)   !! which of the outputs in lanes each is; 0: none
      integer, allocatable :: before(:)  !! values before those of each; behind the last, all
      logical :: in_lanes = .false.      !! all of them are told in lanes, and the gearbox is served there
      integer, allocatable, private :: integers(:) !! discrete state that the slots are settled for
      real(wp), allocatable, private :: reals(:)
      type(lane_slot), allocatable, private :: slots(:)
      real(wp), allocatable, private :: f(:, :)   !! (lanes, states)
      real(wp), allocatable, private :: all(:, :)        !! (values of the gearbox, 1)
   end type output_sampler

contains

   include "contact/transmission_error.inc"

   !> Ask for some outputs of a gearbox.
   subroutine sampler_create(self, gearbox, wanted)
      type(output_sampler), intent(out) :: self
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: wanted(:) !! places in the table
      type(output_t), allocatable :: table(:)
      integer :: i

      call list_outputs(table)
      self%wanted = wanted
      self%kinds = [(findloc(lane_names == table(wanted(i))%name, .true., dim=1), i=1, size(wanted))]
      self%before = [(sum(gearbox%output_counts(wanted(:i - 1))), i=1, size(wanted) + 1)]
      self%in_lanes = all(self%kinds > 0) .and. lanes_serve(gearbox)
      allocate (self%slots(merge(size(gearbox%contacts), 0, self%in_lanes)), self%all(gearbox%n_values, 1))
      allocate (self%f(lanes, gearbox%n_states))
   end subroutine sampler_create

   !> Their values at states that share their discrete state, as in a step. In eight states at once they may differ by rounding from
   !> those in one.
   subroutine sample_outputs(self, gearbox, t, y, integers, reals, values, status)
      type(output_sampler), intent(inout) :: self !! scratch of it changes
      type(gearbox_t), intent(in), target :: gearbox
      real(wp), intent(in) :: t(:), reals(size(gearbox%contacts))
      real(wp), intent(in), contiguous :: y(:, :) !! (states, n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: values(:, :)       !! (states, wanted values)
      type(status_t), intent(inout) :: status
      integer :: i, s

      if (self%in_lanes .and. size(t) == lanes) then
         call settle(self, gearbox, integers, reals)
         call rates_in_lanes(gearbox, t, y, integers, reals, self%slots, self%f, status)
         if (has_failed(status)) return
         do i = 1, size(self%wanted)
            associate (first => self%before(i) + 1, last => self%before(i + 1))
               if (self%kinds(i) < lane_angle) then
                  call tell_meshes(gearbox, self%kinds(i), y, integers, self%slots, values(:, first:last))
               else
                  call tell_wheels(gearbox, self%kinds(i), y, self%f, integers, values(:, first:last))
               end if
            end associate
         end do
         return
      end if
      do s = 1, size(t)
         call wanted_outputs(gearbox, t(s:s), transpose(y(s:s, :)), integers, reals, self%wanted, self%all, status)
         if (has_failed(status)) return
         do i = 1, size(self%wanted)
            associate (first => self%before(i) + 1, last => self%before(i + 1), offset => gearbox%output_offsets(self%wanted(i)))
               values(s, first:last) = self%all(offset + 1:offset + last - self%before(i), 1)
            end associate
         end do
      end do
   end subroutine sample_outputs

   !> Settle the slots, unless they are.
   subroutine settle(self, gearbox, integers, reals)
      type(output_sampler), intent(inout) :: self
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)

      if (allocated(self%integers)) then
         if (all(self%integers == integers) .and. .not. any(abs(self%reals - reals) > 0)) return
      end if
      self%integers = integers
      self%reals = reals
      call settle_slots(gearbox, integers, reals, self%slots)
   end subroutine settle

   !> One output of all meshes.
   subroutine tell_meshes(gearbox, kind, y, integers, slots, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: kind
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(:)
      type(lane_slot), intent(in) :: slots(:)         !! as the rates left them
      real(wp), intent(out), contiguous :: values(:, :) !! (lanes, of the output)
      integer :: c, m, place

      values = 0
      if (size(values) == 0) return ! as coast forces where no mesh has coast flanks
      do m = 1, size(gearbox%pairs)
         if (kind == lane_error) then
            call find_error(gearbox%contacts(leading_contact(gearbox, m, integers)), y, values(:, m))
            cycle
         end if
         do c = gearbox%first(m), gearbox%first(m + 1) - 1
            if (.not. slots(c)%touches) cycle
            associate (contact => gearbox%contacts(c), force => slots(c)%force, &
                       is_coast => gearbox%contacts(c)%flank == flank_coast)
               if (kind == lane_torque) values(:, m) = values(:, m) + force%torque_a
               if (slots(c)%mode%flanks /= flanks_loaded) cycle
               if (kind == lane_loaded) values(:, m) = values(:, m) + 1
               if (kind == lane_normal .or. (kind == lane_coast .and. is_coast)) values(:, m) = values(:, m) + force%unclipped
               place = (m - 1)*gearbox%n_pair_places + 1 + contact%slot + merge(gearbox%n_drive_places, 0, is_coast)
               if (kind == lane_pair_normal) values(:, place) = force%unclipped
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
      real(wp), intent(out), contiguous :: values(:, :) !! (lanes, of the output)
      real(wp), dimension(lanes) :: psi, rate
      integer :: i, l

      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            select case (kind)
            case (lane_angle)
               call turn_wheel(wheel%i_psi, y, psi, rate)
               values(:, i) = wheel%ratio*(y(:, i_theta) + 2*pi*integers(i_turns)) + psi
            case (lane_speed)
               call turn_wheel(wheel%i_psi, y, psi, rate)
               values(:, i) = wheel%ratio*y(:, i_omega) + rate
            case (lane_acceleration)
               call turn_wheel(wheel%i_psi, f, psi, rate)
               values(:, i) = wheel%ratio*f(:, i_omega) + rate
            case default
               values(:, 2*i - 1:2*i) = 0
               if (wheel%support%n == 0) cycle
               do l = 1, lanes
                  values(l, 2*i - 1:2*i) = axle_deviation(wheel%support, f(l, :), 1)
               end do
            end select
         end associate
      end do
   end subroutine tell_wheels

end module evl_output_sampler
