!> Table of the kinds of load. The index of a kind in it, from 0, is that in the C interface.
module evl_load_kinds
   use evl_constant_load, only: constant_load
   use evl_drive_load, only: drive_load
   use evl_harmonic_load, only: harmonic_load
   use evl_kind_finder, only: kind_finder
   use evl_load, only: load_t
   use evl_loss_load, only: loss_load
   use evl_speed_load, only: speed_load
   use evl_table_load, only: table_load
   use evl_viscous_load, only: viscous_load
   implicit none (type, external)
   private

   public :: load_of_kind

contains

   !> Load of the kind that a finder requests, without its parameters; not allocated if there is none.
   subroutine load_of_kind(finder, load)
      type(kind_finder), intent(inout) :: finder
      class(load_t), allocatable, intent(out) :: load

      call offer(constant_load())
      call offer(viscous_load())
      call offer(table_load())
      call offer(speed_load())
      call offer(harmonic_load())
      call offer(drive_load())
      call offer(loss_load())

   contains

      subroutine offer(entry)
         class(load_t), intent(in) :: entry

         if (finder%meets(entry)) allocate (load, source=entry)
      end subroutine offer

   end subroutine load_of_kind

end module evl_load_kinds
