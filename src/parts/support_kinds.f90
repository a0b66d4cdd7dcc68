!> The table of the kinds of support. A kind's index in it, from 0, is that in the C interface.
module evl_support_kinds
   use evl_bearing_support, only: bearing_support
   use evl_fixed_support, only: fixed_support
   use evl_slider_support, only: slider_support
   use evl_support, only: support_kind_t
   implicit none (type, external)
   private

   public :: support_kind_count, support_of_kind

contains

   !> A kind; not allocated if there is no such kind.
   subroutine support_of_kind(kind, support, n_kinds)
      integer, intent(in) :: kind                        !! from 0
      class(support_kind_t), allocatable, intent(out) :: support
      integer, intent(out), optional :: n_kinds          !! how many there are
      integer :: n

      n = 0
      call offer(fixed_support())
      call offer(slider_support())
      call offer(bearing_support())
      if (present(n_kinds)) n_kinds = n

   contains

      !> The next kind of the table.
      subroutine offer(of_kind)
         class(support_kind_t), intent(in) :: of_kind

         if (n == kind) allocate (support, source=of_kind)
         n = n + 1
      end subroutine offer

   end subroutine support_of_kind

   !> How many kinds there are.
   integer function support_kind_count() result(n)
      class(support_kind_t), allocatable :: none

      call support_of_kind(-1, none, n)
   end function support_kind_count

end module evl_support_kinds
