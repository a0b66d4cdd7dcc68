!> Serialisation of the stages of the last step and of all data that the next step uses.
module evl_stage_archive
   use evl_archive, only: archive_t, keep, keep_reals
   use evl_factor_archive, only: keep_condensed, keep_dense
   use evl_stage_solver, only: stage_solver_t
   implicit none (type, external)
   private

   public :: keep_stages

contains

   !> Serialise all data except those recomputed at creation.
   subroutine keep_stages(archive, self)
      type(archive_t), intent(inout) :: archive
      type(stage_solver_t), intent(inout) :: self

      call keep_arrays(archive, self)
      call keep_condensed(archive, self%condensed)
      call keep_dense(archive, self%dense)
      call keep(archive, self%next_coefficient)
      call keep(archive, self%start_is_known)
      call keep(archive, self%is_dense)
      call keep(archive, self%continuation%start)
      call keep(archive, self%continuation%ratio)
      call keep_reals(archive, size(self%continuation%matrix), self%continuation%matrix)
      call keep(archive, self%linear%is_used)
      call keep(archive, self%linear%error)
      call keep(archive, self%linear%h)
      call keep(archive, self%h_factored)
      call keep(archive, self%factors_are_new)
      call keep(archive, self%rate)
      call keep(archive, self%rate_sum)
      call keep(archive, self%advice)
      call keep(archive, self%iterations)
      call keep(archive, self%counts%iterations)
      call keep(archive, self%counts%evaluations)
      call keep(archive, self%counts%factorisations)
      call keep(archive, self%counts%dense)
   end subroutine keep_stages

   !> Serialise the arrays of a step.
   subroutine keep_arrays(archive, self)
      type(archive_t), intent(inout) :: archive
      type(stage_solver_t), intent(inout) :: self

      call keep_reals(archive, size(self%coupled), self%coupled)
      call keep_reals(archive, size(self%weight), self%weight)
      call keep_reals(archive, size(self%most_weight), self%most_weight)
      call keep_reals(archive, size(self%z), self%z)
      call keep_reals(archive, size(self%shifted), self%shifted)
      call keep_reals(archive, size(self%y), self%y)
      call keep_reals(archive, size(self%f), self%f)
      call keep_reals(archive, size(self%change), self%change)
      call keep_reals(archive, size(self%jacobian), self%jacobian)
      call keep_reals(archive, size(self%error), self%error)
      call keep_reals(archive, size(self%slope), self%slope)
      call keep_reals(archive, size(self%slope_at_end), self%slope_at_end)
      call keep_reals(archive, size(self%last), self%last)
      call keep_reals(archive, size(self%before), self%before)
      call keep_reals(archive, size(self%start), self%start)
      call keep_reals(archive, size(self%moved), self%moved)
      call keep_reals(archive, size(self%moved_f), self%moved_f)
   end subroutine keep_arrays

end module evl_stage_archive
