!> A whole integration of a chain of oscillators with output on a grid: the loop that who calls the integrator writes.
module chain_run
   use evl_kinds, only: wp
   use evl_radau, only: outcome_event, radau_advance, radau_interpolate, radau_restart, radau_start, radau_t
   use evl_status, only: has_failed, status_t
   use oscillator_chain, only: kick, next_kick, oscillator_chain_t
   implicit none (type, external)
   private

   public :: run_chain

   real(wp), parameter :: rounding = 64*epsilon(1.0_wp) !! times that differ by less, relatively, are the same
   real(wp), parameter :: grid_slack = 1.0e-6_wp        !! of an output interval: a grid point this near the end is the end

contains

   !> Integrate from (t, y) to t_end, which they are afterwards.
   subroutine run_chain(solver, chain, t, y, t_end, interval, rows, status)
      type(radau_t), intent(inout) :: solver !! created for this chain
      type(oscillator_chain_t), intent(inout) :: chain
      real(wp), intent(inout) :: t
      real(wp), intent(inout) :: y(:)
      real(wp), intent(in) :: t_end, interval
      real(wp), intent(inout) :: rows(:, :)   !! [n, outputs] state at the start, after every interval, and at the end
      type(status_t), intent(inout) :: status
      real(wp) :: t_start, t_out
      integer :: next, outcome

      t_start = t
      call radau_start(solver, chain, t, y, status)
      if (has_failed(status)) return
      next = 1
      call put(y)
      do while (solver%t < t_end)
         call radau_advance(solver, chain, min(t_end, next_kick(chain)), outcome, status)
         if (has_failed(status)) return
         do ! an output at the time of an event is that before the event
            t_out = t_start + (next - 1)*interval
            if (t_out - solver%t > rounding*abs(solver%t) .or. t_out > t_end - grid_slack*interval) exit
            call radau_interpolate(solver, t_out, y)
            call put(y)
         end do
         y = solver%y
         if (solver%t >= next_kick(chain)) then
            call kick(chain, y)
         else if (outcome /= outcome_event) then
            cycle
         end if
         t = solver%t
         call radau_restart(solver, chain, t, y)
      end do
      t = solver%t
      call put(y)

   contains

      !> The next row.
      subroutine put(state)
         real(wp), intent(in) :: state(:)

         if (next <= size(rows, 2)) rows(:, next) = state
         next = next + 1
      end subroutine put

   end subroutine run_chain

end module chain_run
