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

   integer, parameter :: none = -1 !! not asked for

   !> The same as numbers, in that order.
   enum, bind(c)
      enumerator :: lane_error = 1, lane_normal, lane_coast, lane_torque, lane_loaded, lane_pair_normal, lane_angle, lane_speed, &
         lane_acceleration, lane_axle
   end enum

   !> Outputs that are asked for. Their values stand one output behind the other.
   type :: output_sampler
      integer, allocatable :: wanted(:)  !! places in the table
      integer, allocatable :: before(:)  !! values before those of each; behind the last, all
      logical :: in_lanes = .false.      !! all of them are told in lanes, and the gearbox is served there
      integer :: columns(size(lane_names)) = none !! values before those of each output in lanes
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
      integer :: i, kind

      call list_outputs(table)
      self%wanted = wanted
      self%before = [(sum(gearbox%output_counts(wanted(:i - 1))), i=1, size(wanted) + 1)]
      self%in_lanes = lanes_serve(gearbox)
      do i = 1, size(wanted)
         kind = findloc(lane_names == table(wanted(i))%name, .true., dim=1)
         self%in_lanes = self%in_lanes .and. kind > 0 .and. .not. any(wanted(:i - 1) == wanted(i))
         ! of coast forces there are none where no mesh has coast flanks
         if (kind > 0 .and. gearbox%output_counts(wanted(i)) > 0) self%columns(kind) = self%before(i)
      end do
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
      real(wp), intent(out), contiguous :: values(:, :) !! (states, wanted values)
      type(status_t), intent(inout) :: status
      integer :: i, s

      if (self%in_lanes .and. size(t) == lanes) then
         call settle(self, gearbox, integers, reals)
         call rates_in_lanes(gearbox, t, y, integers, reals, self%slots, self%f, status)
         if (has_failed(status)) return
         values = 0
         call tell_meshes(gearbox, self%columns, y, integers, self%slots, values)
         call tell_wheels(gearbox, self%columns, y, self%f, integers, values)
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

   !> Outputs of meshes.
   subroutine tell_meshes(gearbox, columns, y, integers, slots, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: columns(:)
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(:)
      type(lane_slot), intent(in) :: slots(:)  !! as the rates left them
      real(wp), intent(inout) :: values(lanes, *) !! 0 in those of meshes
      integer :: c, m

      do m = 1, size(gearbox%pairs)
         if (columns(lane_error) /= none) &
            call find_error(gearbox%contacts(leading_contact(gearbox, m, integers)), y, values(:, columns(lane_error) + m))
         do c = gearbox%first(m), gearbox%first(m + 1) - 1
            if (slots(c)%touches) call tell_contact(gearbox, gearbox%contacts(c), m, columns, slots(c), values)
         end do
      end do
   end subroutine tell_meshes

   !> What a tooth contact adds to the outputs of its mesh.
   subroutine tell_contact(gearbox, contact, m, columns, slot, values)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      integer, intent(in) :: m !! mesh
      integer, intent(in) :: columns(:)
      type(lane_slot), intent(in) :: slot
      real(wp), intent(inout) :: values(lanes, *)
      logical :: is_coast
      integer :: place

      is_coast = contact%flank == flank_coast
      call add(lane_torque, m, slot%force%torque_a)
      if (slot%mode%flanks /= flanks_loaded) return
      call add(lane_loaded, m, [(1.0_wp, place=1, lanes)])
      call add(lane_normal, m, slot%force%unclipped)
      if (is_coast) call add(lane_coast, m, slot%force%unclipped)
      place = (m - 1)*gearbox%n_pair_places + 1 + contact%slot + merge(gearbox%n_drive_places, 0, is_coast)
      call add(lane_pair_normal, place, slot%force%unclipped)

   contains

      subroutine add(kind, place, what)
         integer, intent(in) :: kind, place
         real(wp), intent(in) :: what(lanes)
         integer :: l

         if (columns(kind) == none) return
         !$omp simd
         do l = 1, lanes
            values(l, columns(kind) + place) = values(l, columns(kind) + place) + what(l)
         end do
      end subroutine add

   end subroutine tell_contact

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

   !> Outputs of wheels.
   subroutine tell_wheels(gearbox, columns, y, f, integers, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: columns(:)
      real(wp), intent(in) :: y(lanes, gearbox%n_states), f(lanes, gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(inout) :: values(lanes, *) !! 0 in those of axles
      real(wp), dimension(lanes) :: psi, rate
      integer :: i, l, before

      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            call turn_wheel(wheel%i_psi, y, psi, rate)
            if (columns(lane_angle) /= none) &
               call add_turned(wheel%ratio, y(:, i_theta), 2*pi*integers(i_turns), psi, values(:, columns(lane_angle) + i))
            if (columns(lane_speed) /= none) &
               call add_turned(wheel%ratio, y(:, i_omega), 0.0_wp, rate, values(:, columns(lane_speed) + i))
            if (columns(lane_acceleration) /= none) then
               call turn_wheel(wheel%i_psi, f, psi, rate)
               call add_turned(wheel%ratio, f(:, i_omega), 0.0_wp, rate, values(:, columns(lane_acceleration) + i))
            end if
            if (columns(lane_axle) == none .or. wheel%support%n == 0) cycle
            before = columns(lane_axle) + 2*(i - 1)
            do l = 1, lanes
               values(l, before + 1:before + 2) = axle_deviation(wheel%support, f(l, :), 1)
            end do
         end associate
      end do
   end subroutine tell_wheels

   !> What the gearbox turns at a ratio, and what a wheel turns more.
   pure subroutine add_turned(ratio, turned, whole, more, value)
      real(wp), intent(in) :: ratio, turned(lanes), whole, more(lanes)
      real(wp), intent(out) :: value(lanes)
      integer :: l

      !$omp simd
      do l = 1, lanes
         value(l) = ratio*(turned(l) + whole) + more(l)
      end do
   end subroutine add_turned

end module evl_output_sampler
