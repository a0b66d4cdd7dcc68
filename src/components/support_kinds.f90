!> Table of the kinds of support. The index of a kind in it, from 0, is that in the C interface.
module evl_support_kinds
   use evl_bearing_support, only: bearing_support
   use evl_fixed_support, only: fixed_support
   use evl_kind_finder, only: kind_finder
   use evl_slider_support, only: slider_support
   use evl_support, only: support_kind_t
   implicit none (type, external)
   private

   public :: support_of_kind

contains

   !> Support of the kind that a finder requests, without its parameters; not allocated if there is none.
   subroutine support_of_kind(finder, support)
      type(kind_finder), intent(inout) :: finder
      class(support_kind_t), allocatable, intent(out) :: support

      call offer(fixed_support())
      call offer(slider_support())
      call offer(bearing_support())

   contains

      subroutine offer(entry)
         class(support_kind_t), intent(in) :: entry

         if (finder%meets(entry)) allocate (support, source=entry)
      end subroutine offer

   end subroutine support_of_kind

end module evl_support_kinds
