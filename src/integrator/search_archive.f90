!> Serialisation of the searches for events and extremes in the last step.
module evl_search_archive
   use evl_archive, only: archive_t, keep, keep_integers, keep_logicals, keep_reals
   use evl_extreme_finder, only: extreme_finder_t
   use evl_root_finder, only: root_finder_t
   implicit none (type, external)
   private

   public :: keep_extremes, keep_roots

contains

   !> Serialise the signs of the root functions, and the search in the last step.
   subroutine keep_roots(archive, self)
      type(archive_t), intent(inout) :: archive
      type(root_finder_t), intent(inout) :: self

      call keep_reals(archive, size(self%g), self%g)
      call keep_reals(archive, size(self%slope), self%slope)
      call keep_reals(archive, size(self%value), self%value)
      call keep_reals(archive, size(self%y), self%y)
      call keep_integers(archive, size(self%sign_now), self%sign_now)
      call keep_integers(archive, size(self%sign_after), self%sign_after)
      call keep_integers(archive, size(self%direction), self%direction)
      call keep(archive, self%n_live)
      call keep_integers(archive, size(self%live), self%live)
      call keep(archive, self%n_near)
      call keep_integers(archive, size(self%near), self%near)
      call keep_logicals(archive, size(self%fresh), self%fresh)
      call keep_integers(archive, size(self%change), self%change)
      call keep_reals(archive, size(self%left), self%left)
      call keep_reals(archive, size(self%right), self%right)
      call keep_reals(archive, size(self%at_left), self%at_left)
      call keep_reals(archive, size(self%at_right), self%at_right)
      call keep_reals(archive, size(self%tau), self%tau)
      call keep(archive, self%evaluations)
   end subroutine keep_roots

   !> Serialise the rows of the monitored channels.
   subroutine keep_extremes(archive, self)
      type(archive_t), intent(inout) :: archive
      type(extreme_finder_t), intent(inout) :: self

      call keep(archive, self%n)
      call keep_integers(archive, size(self%channels), self%channels)
      call keep_reals(archive, size(self%values), self%values)
   end subroutine keep_extremes

end module evl_search_archive
