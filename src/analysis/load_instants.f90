!> Instants at which loads given by tables over time can be extreme.
!>
!> Between knots all torques and prescribed speeds are linear in time, and so are the loads that follow from equilibrium: extremes
!> are at knots. With a single table everything else is monotonic in its value: extremes are at its minimum and maximum.
module evl_load_instants
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_knots, only: next_knot
   implicit none (type, external)
   private

   public :: first_instant, instant_t, next_instant

   type :: instant_t
      real(wp) :: t = 0.0_wp               !! [s]
      integer, allocatable :: segments(:)  !! of each load: number of knots passed; 0 without a table
   end type instant_t

contains

   !> The instant before the first knot of any table.
   pure type(instant_t) function first_instant(gearbox) result(first)
      type(gearbox_t), intent(in) :: gearbox

      allocate (first%segments(size(gearbox%loads)), source=0)
   end function first_instant

   !> Go to the next instant.
   pure subroutine next_instant(gearbox, now, exists)
      type(gearbox_t), intent(in) :: gearbox
      type(instant_t), intent(inout) :: now
      logical, intent(out) :: exists
      integer :: tables(size(gearbox%loads)), i, n

      n = 0
      do i = 1, size(gearbox%loads)
         if (.not. allocated(gearbox%loads(i)%load%knots%time)) cycle
         n = n + 1
         tables(n) = i
      end do
      if (n == 1) then
         call next_extreme(gearbox, tables(1), now, exists)
      else
         call next_of_all(gearbox, tables(:n), now, exists)
      end if
   end subroutine next_instant

   !> Go to the next of the two knots with the minimum and maximum of a table.
   pure subroutine next_extreme(gearbox, table, now, exists)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: table !! index of its load
      type(instant_t), intent(inout) :: now
      logical, intent(out) :: exists
      integer :: both(2)

      associate (knots => gearbox%loads(table)%load%knots, segment => now%segments(table))
         both = [minloc(knots%values, dim=1), maxloc(knots%values, dim=1)]
         exists = any(both > segment)
         if (.not. exists) return
         segment = minval(both, mask=both > segment)
         now%t = knots%time(segment)
      end associate
   end subroutine next_extreme

   !> Go to the next knot of any of several tables.
   pure subroutine next_of_all(gearbox, tables, now, exists)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: tables(:) !! indices of their loads
      type(instant_t), intent(inout) :: now
      logical, intent(out) :: exists
      real(wp), parameter :: never = huge(1.0_wp)
      real(wp) :: next(size(tables))
      integer :: i

      next = [(next_knot(gearbox%loads(tables(i))%load%knots, now%segments(tables(i))), i=1, size(tables))]
      exists = any(next < never)
      if (.not. exists) return
      now%t = minval(next)
      do i = 1, size(tables)
         if (next(i) <= now%t) now%segments(tables(i)) = now%segments(tables(i)) + 1
      end do
   end subroutine next_of_all

end module evl_load_instants
