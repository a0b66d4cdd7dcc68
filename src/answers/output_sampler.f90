!> Some outputs of a gearbox, asked for at many states: eight at once where the lanes of the rates serve it, else one by one as
!> `wanted_outputs` tells them. An output that the lanes do not tell is told one by one beside the others. A sampler keeps what the
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
   use evl_outputs, only: wanted_outputs
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
      real(wp), allocatable, private :: all(:, :)   !! (values of the gearbox, 1)
   end type output_sampler

contains

   !> Ask for some outputs of a gearbox.
   subroutine sampler_create(self, gearbox, wanted)
      type(output_sampler), intent(out) :: self
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: wanted(:) !! places in the table
      integer :: i, n, n_constant

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
      n = merge(size(gearbox%contacts), 0, self%in_lanes)
      allocate (self%slots(n), self%aside(n), self%all(gearbox%n_values, 1))
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
      integer :: i

      if (.not. (self%in_lanes .and. size(t) == lanes)) then
         call tell_one_by_one(self, gearbox, [(i, i=1, size(self%wanted))], n, t, y, integers, reals, check, values, status)
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
      integer :: i, s

      do s = 1, n
         call wanted_outputs(gearbox, t(s:s), transpose(y(s:s, :)), integers, reals, self%wanted(which), check, self%all, status)
         if (has_failed(status)) return
         do i = 1, size(which)
            associate (first => self%before(which(i)) + 1, last => self%before(which(i) + 1), &
                       offset => gearbox%output_offsets(self%wanted(which(i))))
               values(s, first:last) = self%all(offset + 1:offset + last + 1 - first, 1)
            end associate
         end do
      end do
   end subroutine tell_one_by_one

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
      call settle_aside(self%slots, self%aside)
   end subroutine settle

end module evl_output_sampler
