!> The search for extremes inside a step, for tests, as a C function.
module extreme_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use callback_model, only: callback_model_t
   use evl_extreme_finder, only: candidate_t, extreme_finder_create, extreme_finder_t, find_candidates, most_candidates
   use evl_kinds, only: lanes
   implicit none (type, external)
   private

   public :: rt_find_candidates

contains

   !> Candidates of one channel from its values at the nodes: sense, time, from and to where they may lie, value of the interpolant.
   integer(c_int) function rt_find_candidates(values, is_rough, high, low, found) result(n) bind(c)
      real(c_double), intent(in) :: values(lanes)
      integer(c_int), value :: is_rough !! not 0: the channel is estimated alone
      real(c_double), value :: high, low
      real(c_double), intent(out) :: found(5, most_candidates) !! the first n of these
      type(callback_model_t) :: model
      type(extreme_finder_t) :: finder
      type(candidate_t) :: candidates(most_candidates)
      integer :: i

      model%n_rows = 1
      model%n_monitored = 1
      model%is_rough = [is_rough /= 0]
      call extreme_finder_create(finder, model)
      finder%n = 1
      finder%channels = 1
      finder%values(:, 1) = values
      call find_candidates(finder, [high], [low], n, candidates)
      do i = 1, n
         associate (of => candidates(i))
            found(:, i) = [real(of%sense, c_double), of%tau, of%left, of%right, of%value]
         end associate
      end do
   end function rt_find_candidates

end module extreme_calls
