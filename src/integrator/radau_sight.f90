!> Step size limit for resolving the model with eight nodes.
!>
!> Error estimates and event search use f and the root functions at the nodes of a step, and polynomials in between. If these
!> functions repeat several times within a step, the result is arbitrary. Examples are a tooth pitch, a period of a load over
!> angle, and one of a load over time. The model specifies how far states and time may move (ode_model); otherwise only the
!> error limits the step.
submodule(evl_radau) evl_radau_sight
   implicit none (type, external)

   real(wp), parameter :: too_far = 1.3_wp !! in units of reach: uniform acceleration covers 1.25 after a step of 1

contains

   !> Estimate with the rates at the start, if they are known.
   module procedure longest_in_sight
      integer :: k

      h = model%time_in_sight(self%t)
      if (.not. self%stages%start_is_known) return
      do k = 1, size(self%limited)
         associate (rate => abs(self%stages%start(self%limited(k))), reach => model%reach(self%limited(k)))
            if (rate*h > reach) h = reach/rate
         end associate
      end do
   end procedure longest_in_sight

   !> Check that the states with a reach have moved by little more than it.
   module procedure stay_in_sight
      real(wp) :: most
      integer :: k

      most = 0
      do k = 1, size(self%limited)
         most = max(most, maxval(abs(self%stages%z(:, self%limited(k))))/model%reach(self%limited(k)))
      end do
      is_in_sight = most <= too_far
      if (.not. is_in_sight) self%h = h/most
   end procedure stay_in_sight

end submodule evl_radau_sight
