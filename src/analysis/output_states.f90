!> Up to eight states with a common discrete state, and the quantities that outputs require of them. Eight states are evaluated
!> together if the rates support the gearbox in lanes, otherwise one by one. Quantities that are not required are not computed.
!> Lanes after the last state contain a copy of it.
module evl_output_states
   use evl_contacts_at_state, only: flank_cache, position_contact
   use evl_discrete_state, only: take_mode
   use evl_force_lanes, only: lane_slot, put_force, put_position
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_lanes, only: supports_lanes, rates_in_lanes
   use evl_gearbox_ode, only: settle_aside, settle_slots
   use evl_housing, only: frame_t, housing_fixed, housing_frame
   use evl_housing_dynamics, only: coupled_rates
   use evl_kinds, only: lanes, wp
   use evl_mode_check, only: check_modes, modes_agree
   use evl_output, only: needs_positions, needs_rates
   use evl_roots_lanes, only: roots_in_lanes
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: contact_state, touches
   implicit none (type, external)
   private

   public :: evaluate_states, output_states, states_create

   type :: output_states
      integer :: n = 0                           !! number of lanes in use
      logical :: in_lanes = .false.              !! eight states are evaluated together
      logical :: has_frames = .false.            !! the housing moves, gravity acts, or there are accelerometers
      real(wp) :: t(lanes) = 0.0_wp              !! [s]
      real(wp), allocatable :: y(:, :), f(:, :)  !! (lanes, states): states, time derivatives
      integer, allocatable :: integers(:)
      real(wp), allocatable :: reals(:)
      type(lane_slot), allocatable :: slots(:)   !! tooth contacts with their modes; touching ones with positions and forces
      type(lane_slot), allocatable :: aside(:)   !! positions of the contacts that do not touch
      type(frame_t) :: frames(lanes)             !! of the housing, with has_frames
      real(wp), allocatable, private :: roots(:, :)
      real(wp), allocatable, private :: y_1(:), f_1(:) !! of one state
      type(contact_state), allocatable, private :: contacts(:) !! of one state
   end type output_states

contains

   !> Allocate the states of a gearbox.
   subroutine states_create(self, gearbox)
      type(output_states), intent(inout) :: self
      type(gearbox_t), intent(in) :: gearbox

      self%in_lanes = supports_lanes(gearbox)
      self%has_frames = gearbox%housing%acts .or. gearbox%housing%kind /= housing_fixed &
                        .or. size(gearbox%housing%accelerometers) > 0
      associate (n => gearbox%n_states, m => size(gearbox%contacts))
         allocate (self%y(lanes, n), self%f(lanes, n), self%y_1(n), self%f_1(n), self%roots(lanes, gearbox%n_roots))
         allocate (self%slots(m), self%aside(m), self%contacts(m))
      end associate
   end subroutine states_create

   !> Set the states and compute the quantities required.
   subroutine evaluate_states(self, gearbox, needed, check, n, t, y, integers, reals, status)
      type(output_states), intent(inout) :: self
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: needed               !! bits of evl_output
      logical, intent(in) :: check                !! reject a state inconsistent with its modes, as `check_modes` does
      integer, intent(in) :: n                    !! number of states in use
      real(wp), intent(in) :: t(:), y(:, :)       !! up to eight states: t(states), y(states, n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      type(status_t), intent(inout) :: status
      logical :: with_positions
      integer :: l

      self%n = n
      do l = 1, lanes
         self%t(l) = t(min(l, n))
         self%y(l, :) = y(min(l, n), :)
      end do
      call settle(self, gearbox, integers, reals)
      with_positions = check .or. iand(needed, needs_positions) == needs_positions
      if (.not. (check .or. iand(needed, needs_rates) == needs_rates)) then
         if (self%has_frames) self%f_1 = 0 ! rates are not required
         do l = 1, merge(lanes, 0, self%has_frames)
            self%y_1 = self%y(l, :)
            call housing_frame(gearbox%housing, self%t(l), self%y_1, self%frames(l), self%f_1)
         end do
      else if (self%in_lanes .and. size(t) == lanes) then
         call rates_in_lanes(gearbox, self%t, self%y, self%integers, self%reals, self%slots, self%f, status)
         if (.not. has_failed(status) .and. with_positions) &
            call roots_in_lanes(gearbox, self%y, self%integers, self%reals, self%slots, self%aside, .true., self%roots, status)
         if (has_failed(status) .or. .not. check) return
         ! a state inconsistent with its modes: evaluate one by one to get the reason
         if (.not. modes_agree(gearbox, self%slots, self%roots)) call find_one_by_one(self, gearbox, check, with_positions, status)
      else
         call find_one_by_one(self, gearbox, check, with_positions, status)
      end if
   end subroutine evaluate_states

   !> Set up the slots if the discrete state has changed.
   subroutine settle(self, gearbox, integers, reals)
      type(output_states), intent(inout) :: self
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)

      if (allocated(self%integers)) then
         if (all(self%integers == integers) .and. .not. any(abs(self%reals - reals) > 0)) return
      end if
      if (.not. allocated(self%integers)) allocate (self%integers(size(integers)), self%reals(size(reals)))
      self%integers(:) = integers
      self%reals(:) = reals
      call settle_slots(gearbox, integers, reals, self%slots)
      call settle_aside(self%slots, self%aside)
   end subroutine settle

   !> Evaluate the states one by one.
   subroutine find_one_by_one(self, gearbox, check, with_positions, status)
      type(output_states), intent(inout) :: self
      type(gearbox_t), intent(in) :: gearbox
      logical, intent(in) :: check, with_positions
      type(status_t), intent(inout) :: status
      integer :: i, l, s

      do s = 1, self%n
         self%y_1 = self%y(s, :)
         call coupled_rates(gearbox, self%t(s), self%y_1, self%integers, self%reals, self%f_1, status, self%contacts)
         if (has_failed(status)) return
         if (with_positions) call locate_others(gearbox, self%y_1, self%integers, self%reals, self%contacts)
         if (check) call check_modes(gearbox, self%contacts, status)
         if (has_failed(status)) return
         if (self%has_frames) call housing_frame(gearbox%housing, self%t(s), self%y_1, self%frames(s), self%f_1)
         do l = s, merge(lanes, s, s == self%n)
            self%y(l, :) = self%y_1
            self%f(l, :) = self%f_1
            self%frames(l) = self%frames(s)
            do i = 1, size(self%contacts)
               if (self%slots(i)%touches) then
                  call put_position(gearbox%contacts(i), self%contacts(i), l, self%slots(i))
                  call put_force(self%contacts(i), l, self%slots(i))
               else if (with_positions) then
                  call put_position(gearbox%contacts(i), self%contacts(i), l, self%aside(i))
               end if
            end do
         end do
      end do
   end subroutine find_one_by_one

   !> Positions of the tooth contacts that do not touch.
   subroutine locate_others(gearbox, y, integers, reals, contacts)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      type(contact_state), intent(inout) :: contacts(size(gearbox%contacts)) !! from `coupled_rates`
      type(flank_cache) :: cache
      integer :: i, m

      do i = 1, size(gearbox%flanks)
         associate (flank => gearbox%flanks(i)%flank)
            cache%of = 0
            do m = flank%first, flank%last
               if (touches(contacts(m)%mode)) cycle
               call take_mode(gearbox, m, integers, reals, contacts(m)%mode)
               call position_contact(gearbox, m, y, integers, cache, contacts)
            end do
            call flank%find_overlaps(gearbox%contacts, flank%first, flank%last, contacts)
         end associate
      end do
   end subroutine locate_others

end module evl_output_states
