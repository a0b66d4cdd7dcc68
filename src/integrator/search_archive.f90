!> Serialisation of the searches for events and extremes in the last step.
module evl_search_archive
   use evl_archive, only: archive_t, serialize, serialize_integers, serialize_logicals, serialize_reals
   use evl_extreme_finder, only: extreme_finder_t
   use evl_root_finder, only: root_finder_t
   implicit none (type, external)
   private

   public :: serialize_extremes, serialize_roots

contains

   !> Serialise the signs of the root functions, and the search in the last step.
   subroutine serialize_roots(archive, self)
      type(archive_t), intent(inout) :: archive
      type(root_finder_t), intent(inout) :: self

      call serialize_reals(archive, size(self%g), self%g)
      call serialize_reals(archive, size(self%slope), self%slope)
      call serialize_reals(archive, size(self%value), self%value)
      call serialize_reals(archive, size(self%y), self%y)
      call serialize_integers(archive, size(self%sign_now), self%sign_now)
      call serialize_integers(archive, size(self%sign_after), self%sign_after)
      call serialize_integers(archive, size(self%direction), self%direction)
      call serialize(archive, self%n_live)
      call serialize_integers(archive, size(self%live), self%live)
      call serialize(archive, self%n_near)
      call serialize_integers(archive, size(self%near), self%near)
      call serialize_logicals(archive, size(self%fresh), self%fresh)
      call serialize_integers(archive, size(self%change), self%change)
      call serialize_reals(archive, size(self%left), self%left)
      call serialize_reals(archive, size(self%right), self%right)
      call serialize_reals(archive, size(self%at_left), self%at_left)
      call serialize_reals(archive, size(self%at_right), self%at_right)
      call serialize_reals(archive, size(self%tau), self%tau)
      call serialize(archive, self%evaluations)
   end subroutine serialize_roots

   !> Serialise the rows of the monitored channels.
   subroutine serialize_extremes(archive, self)
      type(archive_t), intent(inout) :: archive
      type(extreme_finder_t), intent(inout) :: self

      call serialize(archive, self%n)
      call serialize_integers(archive, size(self%channels), self%channels)
      call serialize_reals(archive, size(self%values), self%values)
   end subroutine serialize_extremes

end module evl_search_archive
