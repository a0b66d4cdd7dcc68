!> A look at the step just made: where watched channels of the model may have exceeded their extremes so far.
submodule(evl_radau) evl_radau_look
   use evl_extreme_finder, only: find_candidates
   implicit none (type, external)

contains

   !> Candidates for new extremes in the last step; none if nothing moved in it.
   module procedure radau_look
      n = 0
      if (.not. (self%old_h > 0 .and. self%t > self%t_before)) return
      call model%watched_nearby(self%stages%y, self%watched%n, self%watched%channels, self%watched%values)
      call find_candidates(self%watched, high, low, n, found)
   end procedure radau_look

end submodule evl_radau_look
