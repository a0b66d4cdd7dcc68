!> Steps are no longer than what eight nodes can see of the model.
!>
!> Error estimates and the search for events know f and the root functions at the nodes of a step, and what a polynomial says of
!> them in between. Where they repeat several times in a step, that is by chance: a pitch of teeth, a turn of a load that goes by
!> the angle, a cycle of a load over time. The model says how far states and time may go (ode_model); no step knows any other bound
!> than its error.
submodule(evl_radau) evl_radau_sight
   implicit none (type, external)

   real(wp), parameter :: too_far = 1.3_wp !! reaches: a motion that speeds up evenly goes 1.25, after a step of one

contains

   !> At the speed of the start, as far as that is known.
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

   !> The states with a reach have moved by little more than that.
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
