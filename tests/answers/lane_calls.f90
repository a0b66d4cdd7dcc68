!> What of the table of outputs is told in lanes, for the tests: C calls that the kernel does not export.
module lane_calls
   use, intrinsic :: iso_c_binding, only: c_int
   use evl_lane_columns, only: find_lanes, n_lane_outputs, not_in_lanes
   use evl_output, only: output_t
   use evl_output_list, only: list_outputs
   implicit none (type, external)
   private

   public :: test_lane_outputs

contains

   !> How many outputs the lanes tell, and how many of these the table has; of each row of the table 1 if states are asked
   !> for it one by one.
   subroutine test_lane_outputs(n, n_found, one_by_one) bind(c)
      integer(c_int), intent(out) :: n, n_found, one_by_one(*)
      type(output_t), allocatable :: table(:)
      integer, allocatable :: kinds(:)

      call list_outputs(table)
      allocate (kinds(size(table)))
      call find_lanes(table, kinds)
      n = n_lane_outputs
      n_found = count(kinds > 0)
      one_by_one(:size(kinds)) = merge(1, 0, kinds == not_in_lanes)
   end subroutine test_lane_outputs

end module lane_calls
