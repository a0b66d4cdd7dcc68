!> Some outputs of a gearbox, asked for at many states: eight at once where the lanes of the rates serve it, else one by one as
!> `needed_outputs` tells them. An output that the lanes do not tell is told one by one beside the others. A sampler keeps what the
!> lanes need from one call to the next.
module evl_output_sampler
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_lanes, only: lanes_serve, rates_in_lanes
   use evl_gearbox_ode, only: settle_aside, settle_slots
   use evl_kinds, only: lanes, wp
   use evl_lane_columns, only: never_changes, none, not_in_lanes
   use evl_lane_outputs, only: columns_create, lane_columns, tell_in_lanes
   use evl_mode_check, only: modes_agree
   use evl_outputs, only: needed_outputs
   use evl_roots_lanes, only: roots_in_lanes
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: output_sampler, sample_outputs, sampler_create

   !> Outputs that are asked for. Their values stand one output behind the other.
   type :: output_sampler
      integer, allocatable :: wanted(:)  !! places in the table
      integer, allocatable :: before(:)  !! values before those of each; behind the last, all
      logical :: in_lanes = .false.      !! the gearbox is served there, and some of them are told there
      integer, allocatable, private :: others(:) !! of them those that are not told in lanes
      integer, allocatable, private :: constant(:) !! and those that never change
      type(lane_columns), private :: columns
      integer, allocatable, private :: integers(:) !! discrete state that the slots are settled for
      real(wp), allocatable, private :: reals(:)
      type(lane_slot), allocatable, private :: slots(:), aside(:)
      real(wp), allocatable, private :: f(:, :)     !! (lanes, states)
      real(wp), allocatable, private :: roots(:, :) !! (lanes, root functions)
      real(wp), allocatable, private :: state(:), all(:) !! of one state: itself, all values of the gearbox
      integer, allocatable, private :: place(:)     !! of each value among these
      integer, allocatable, private :: every(:)     !! 1, 2, ... of the outputs that are asked for
   end type output_sampler

contains

   !> Ask for some outputs of a gearbox.
   subroutine sampler_create(self, gearbox, wanted)
      type(output_sampler), intent(out) :: self
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: wanted(:) !! places in the table
      integer :: i, k, n, n_constant

      self%wanted = wanted
      self%before = [(sum(gearbox%output_counts(wanted(:i - 1))), i=1, size(wanted) + 1)]
      allocate (self%others(size(wanted)), self%constant(size(wanted)))
      n = 0
      n_constant = 0
      do i = 1, size(wanted)
         associate (kind => gearbox%output_lanes(wanted(i)))
            if (kind == never_changes) then
               n_constant = n_constant + 1
               self%constant(n_constant) = i
            else if (kind == not_in_lanes .or. any(wanted(:i - 1) == wanted(i))) then
               n = n + 1
               self%others(n) = i
            else if (gearbox%output_counts(wanted(i)) > 0) then ! of coast forces there are none where no mesh has coast flanks
               self%columns%of(kind) = self%before(i)
            end if
         end associate
      end do
      self%others = self%others(:n)
      self%constant = self%constant(:n_constant)
      self%in_lanes = lanes_serve(gearbox) .and. any(self%columns%of /= none)
      call columns_create(self%columns, gearbox)
      self%every = [(i, i=1, size(wanted))]
      self%place = [((gearbox%output_offsets(wanted(i)) + k, k=1, gearbox%output_counts(wanted(i))), i=1, size(wanted))]
      n = merge(size(gearbox%contacts), 0, self%in_lanes)
      allocate (self%slots(n), self%aside(n), self%all(gearbox%n_values), self%state(gearbox%n_states))
      allocate (self%f(lanes, gearbox%n_states), self%roots(lanes, gearbox%n_roots))
   end subroutine sampler_create

   !> Their values at states that share their discrete state, as in a step. Those of eight at once are those of one, to the bit.
   subroutine sample_outputs(self, gearbox, n, t, y, integers, reals, check, values, status)
      type(output_sampler), intent(inout) :: self !! scratch of it changes
      type(gearbox_t), intent(in), target :: gearbox
      integer, intent(in) :: n                    !! the first n states count; eight are told at once all the same
      real(wp), intent(in) :: t(:), reals(size(gearbox%contacts))
      real(wp), intent(in), contiguous :: y(:, :) !! (states, n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      logical, intent(in) :: check                !! as of `gearbox_outputs`
      real(wp), intent(out), contiguous :: values(:, :) !! (states, wanted values)
      type(status_t), intent(inout) :: status
      logical :: agrees

      if (.not. (self%in_lanes .and. size(t) == lanes)) then
         call tell_one_by_one(self, gearbox, self%every, n, t, y, integers, reals, check, values, status)
         return
      end if
      call settle(self, gearbox, integers, reals)
      call rates_in_lanes(gearbox, t, y, integers, reals, self%slots, self%f, status)
      if (.not. has_failed(status) .and. (check .or. self%columns%has_places)) &
         call roots_in_lanes(gearbox, y, integers, reals, self%slots, self%aside, .true., self%roots, status)
      if (has_failed(status)) return
      agrees = .true.
      if (check) agrees = modes_agree(gearbox, self%slots, self%roots)
      call tell_in_lanes(gearbox, n, self%columns, t, y, integers, self%slots, self%aside, self%f, values)
      call tell_constants(self, gearbox, values)
      if (size(self%others) > 0 .or. .not. agrees) &
         call tell_one_by_one(self, gearbox, self%others, n, t, y, integers, reals,.not. agrees, values, status)
   end subroutine sample_outputs

   !> Those that never change.
   pure subroutine tell_constants(self, gearbox, values)
      type(output_sampler), intent(in) :: self
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(inout) :: values(lanes, *)
      integer :: i, k

      do i = 1, size(self%constant)
         associate (before => self%before(self%constant(i)), offset => gearbox%output_offsets(self%wanted(self%constant(i))))
            do k = 1, self%before(self%constant(i) + 1) - before
               values(:, before + k) = gearbox%constants(offset + k)
            end do
         end associate
      end do
   end subroutine tell_constants

   !> Some of them, in one state after the other.
   subroutine tell_one_by_one(self, gearbox, which, n, t, y, integers, reals, check, values, status)
      type(output_sampler), intent(inout) :: self
      type(gearbox_t), intent(in), target :: gearbox
      integer, intent(in) :: which(:), n
      real(wp), intent(in) :: t(:), reals(:)
      real(wp), intent(in), contiguous :: y(:, :)
      integer, intent(in) :: integers(:)
      logical, intent(in) :: check
      real(wp), intent(inout), contiguous :: values(:, :)
      type(status_t), intent(inout) :: status
      integer :: i, needed, s

      needed = iany(gearbox%output_needs(self%wanted(which)))
      do s = 1, n
         self%state = y(s, :)
         call needed_outputs(gearbox, t(s), self%state, integers, reals, needed, check, self%all, status)
         if (has_failed(status)) return
         if (size(which) == size(self%wanted)) then
            call take(size(self%place), self%place, self%all, size(values, 1), s, 0, values)
            cycle
         end if
         do i = 1, size(which)
            associate (before => self%before(which(i)), behind => self%before(which(i) + 1))
               call take(behind - before, self%place(before + 1:behind), self%all, size(values, 1), s, before, values)
            end associate
         end do
      end do
   end subroutine tell_one_by_one

   !> Take the values of one state to their places.
   pure subroutine take(n, place, all, stride, state, before, values)
      integer, intent(in) :: n, place(n), stride, state
      real(wp), intent(in) :: all(*)
      integer, intent(in) :: before !! values of others
      real(wp), intent(inout) :: values(stride, *)
      integer :: k

      do k = 1, n
         values(state, before + k) = all(place(k))
      end do
   end subroutine take

   !> Settle the slots, unless they are.
   subroutine settle(self, gearbox, integers, reals)
      type(output_sampler), intent(inout) :: self
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

end module evl_output_sampler
