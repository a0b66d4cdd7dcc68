!> Step size limit for resolving the model with eight nodes.
!>
!> Error estimates and event search use f and the root functions at the nodes of a step, and polynomials in between. If these
!> functions repeat several times within a step, the result is arbitrary. Examples are a tooth pitch, a period of a load over
!> angle, and one of a load over time. The model specifies how far states and time may move (ode_model); otherwise only the
!> error limits the step.
submodule(evl_radau) evl_radau_step_limit
   implicit none (type, external)

   real(wp), parameter :: too_far = 1.3_wp !! in units of reach: uniform acceleration covers 1.25 after a step of 1

contains

   !> Estimate with the rates at the start, if they are known.
   module procedure step_limit
      integer :: k

      h = model%resolved_time(self%t)
      if (.not. self%stages%start_is_known) return
      do k = 1, size(self%limited)
         associate (rate => abs(self%stages%start(self%limited(k))), reach => model%reach(self%limited(k)))
            if (rate*h > reach) h = reach/rate
         end associate
      end do
   end procedure step_limit

   !> Check that the states with a reach have moved by little more than it.
   module procedure check_resolution
      real(wp) :: most
      integer :: k

      most = 0
      do k = 1, size(self%limited)
         most = max(most, maxval(abs(self%stages%z(:, self%limited(k))))/model%reach(self%limited(k)))
      end do
      is_resolved = most <= too_far
      if (.not. is_resolved) self%h = h/most
   end procedure check_resolution

end submodule evl_radau_step_limit
