!> A whole integration: from t_start to t_end with output on a grid, events applied where they happen.
!>
!> The solver steps as it likes; the output is interpolated. Who wants the results extends `radau_observer`.
module evl_radau_run
   use evl_kinds, only: wp
   use evl_ode_model, only: ode_model
   use evl_radau, only: outcome_event, radau_advance, radau_interpolate, radau_restart, radau_start, radau_t
   use evl_status, only: code_no_solution, fail, has_failed, quantity, status_t
   implicit none (type, external)
   private

   public :: radau_observer, radau_integrate

   integer, parameter :: most_events_at_once = 1000 !! events without progress in time before giving up
   real(wp), parameter :: rounding = 64*epsilon(1.0_wp) !! times that differ by less, relatively, are the same
   real(wp), parameter :: grid_slack = 1.0e-6_wp     !! of an output interval: a grid point this near the end is the end

   !> Who is told. Each procedure may stop the integration by `go_on = .false.`; the state at that moment stays in the solver.
   type, abstract :: radau_observer
   contains
      procedure(output_interface), deferred :: output
      procedure :: step => ignore_step
      procedure :: event => ignore_event
   end type radau_observer

   abstract interface
      !> The state at a grid point: t_start, then every interval, then t_end.
      subroutine output_interface(self, model, t, y, go_on)
         import :: ode_model, radau_observer, wp
         implicit none (type, external)
         class(radau_observer), intent(inout) :: self
         class(ode_model), intent(in) :: model
         real(wp), intent(in) :: t
         real(wp), intent(in) :: y(:) !! [n]
         logical, intent(inout) :: go_on
      end subroutine output_interface
   end interface

contains

   !> After every step: for progress, and to stop a long way between two outputs.
   subroutine ignore_step(self, t, go_on)
      class(radau_observer), intent(inout) :: self
      real(wp), intent(in) :: t !! present time
      logical, intent(inout) :: go_on

      associate (unused => self, unused_t => t, unused_go_on => go_on)
      end associate
   end subroutine ignore_step

   !> What happened at an event, before and after; the model is in its discrete state after it.
   subroutine ignore_event(self, model, t, y_before, y_after, fired, time_event, go_on)
      class(radau_observer), intent(inout) :: self
      class(ode_model), intent(in) :: model
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y_before(:), y_after(:) !! [n]
      integer, intent(in) :: fired(:)                 !! [n_roots] as in `radau_t`
      logical, intent(in) :: time_event
      logical, intent(inout) :: go_on

      associate (unused_self => self, unused_model => model, unused_t => t, unused_before => y_before, &
                 unused_after => y_after, unused_fired => fired, unused_kind => time_event, unused_go_on => go_on)
      end associate
   end subroutine ignore_event

   !> Integrate from (t, y) to t_end; on return t and y are where it ended.
   subroutine radau_integrate(solver, model, t, y, t_end, interval, observer, status)
      type(radau_t), intent(inout) :: solver !! created for this model
      class(ode_model), intent(inout) :: model
      real(wp), intent(inout) :: t
      real(wp), intent(inout) :: y(:)        !! [n]
      real(wp), intent(in) :: t_end          !! not before t
      real(wp), intent(in) :: interval       !! of the output grid, > 0
      class(radau_observer), intent(inout) :: observer
      type(status_t), intent(inout) :: status !! as for `radau_advance`; also `code_no_solution` if events pile up
      real(wp) :: t_start, t_event, t_last
      integer :: next, at_once, outcome
      logical :: go_on, time_event

      t_start = t
      go_on = .true.
      call radau_start(solver, model, t, y, status)
      if (has_failed(status)) return
      call observer%output(model, t, y, go_on)
      next = 1
      at_once = 0
      t_last = -huge(t)
      do while (go_on .and. solver%t < t_end)
         t_event = model%next_time_event(solver%t)
         outcome = outcome_event
         if (t_event > solver%t) call radau_advance(solver, model, min(t_end, t_event), outcome, status)
         if (has_failed(status)) exit
         call observer%step(solver%t, go_on)
         call give_output()
         time_event = solver%t >= t_event
         if (go_on .and. (time_event .or. outcome == outcome_event)) then
            at_once = merge(1, at_once + 1, solver%t > t_last)
            t_last = solver%t
            if (at_once > most_events_at_once) then
               call fail(status, code_no_solution, "events pile up at time "//quantity(solver%t, "")//": the model chatters")
               exit
            end if
            call handle_event()
            if (has_failed(status)) exit
         end if
      end do
      t = solver%t
      y = solver%y
      if (go_on .and. .not. has_failed(status)) call observer%output(model, t, y, go_on)

   contains

      !> Grid points that the last step passed; the end itself is given at the end. An output at the time of an event is that
      !> before the event.
      subroutine give_output()
         real(wp) :: t_out

         do while (go_on)
            t_out = t_start + next*interval
            if (t_out - solver%t > rounding*abs(solver%t) .or. t_out > t_end - grid_slack*interval) exit
            call radau_interpolate(solver, t_out, y)
            call observer%output(model, t_out, y, go_on)
            next = next + 1
         end do
      end subroutine give_output

      !> Apply the event at the present state and go on from there.
      subroutine handle_event()
         real(wp) :: t_now

         t_now = solver%t
         y = solver%y
         call model%apply_event(t_now, y, solver%fired, time_event, status)
         if (has_failed(status)) return
         call observer%event(model, t_now, solver%y, y, solver%fired, time_event, go_on)
         call radau_restart(solver, model, t_now, y)
      end subroutine handle_event

   end subroutine radau_integrate

end module evl_radau_run
