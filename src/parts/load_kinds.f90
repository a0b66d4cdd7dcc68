!> The table of the kinds of load. A kind's index in it, from 0, is that in the C interface.
module evl_load_kinds
   use evl_constant_load, only: constant_load
   use evl_harmonic_load, only: harmonic_load
   use evl_load, only: load_t
   use evl_speed_load, only: speed_load
   use evl_table_load, only: table_load
   use evl_viscous_load, only: viscous_load
   implicit none (type, external)
   private

   public :: load_kind_count, load_of_kind

contains

   !> A load of a kind, without its parameters; not allocated if there is no such kind.
   subroutine load_of_kind(kind, load, n_kinds)
      integer, intent(in) :: kind                        !! from 0
      class(load_t), allocatable, intent(out) :: load
      integer, intent(out), optional :: n_kinds          !! how many there are
      integer :: n

      n = 0
      call offer(constant_load())
      call offer(viscous_load())
      call offer(table_load())
      call offer(speed_load())
      call offer(harmonic_load())
      if (present(n_kinds)) n_kinds = n

   contains

      !> The next kind of the table.
      subroutine offer(of_kind)
         class(load_t), intent(in) :: of_kind

         if (n == kind) allocate (load, source=of_kind)
         n = n + 1
      end subroutine offer

   end subroutine load_of_kind

   !> How many kinds there are.
   integer function load_kind_count() result(n)
      class(load_t), allocatable :: none

      call load_of_kind(-1, none, n)
   end function load_kind_count

end module evl_load_kinds
