!> Serialisation of the stages of the last step and of all data that the next step uses.
module evl_stage_archive
   use evl_archive, only: archive_t, serialize, serialize_reals
   use evl_factor_archive, only: serialize_condensed, serialize_dense
   use evl_stage_solver, only: stage_solver_t
   implicit none (type, external)
   private

   public :: serialize_stages

contains

   !> Serialise all data except those recomputed at creation.
   subroutine serialize_stages(archive, self)
      type(archive_t), intent(inout) :: archive
      type(stage_solver_t), intent(inout) :: self

      call serialize_arrays(archive, self)
      call serialize_condensed(archive, self%condensed)
      call serialize_dense(archive, self%dense)
      call serialize(archive, self%next_coefficient)
      call serialize(archive, self%start_is_known)
      call serialize(archive, self%is_dense)
      call serialize(archive, self%continuation%start)
      call serialize(archive, self%continuation%ratio)
      call serialize_reals(archive, size(self%continuation%matrix), self%continuation%matrix)
      call serialize(archive, self%linear%is_used)
      call serialize(archive, self%linear%error)
      call serialize(archive, self%linear%h)
      call serialize(archive, self%h_factored)
      call serialize(archive, self%factors_are_new)
      call serialize(archive, self%rate)
      call serialize(archive, self%rate_sum)
      call serialize(archive, self%advice)
      call serialize(archive, self%iterations)
      call serialize(archive, self%counts%iterations)
      call serialize(archive, self%counts%evaluations)
      call serialize(archive, self%counts%factorisations)
      call serialize(archive, self%counts%dense)
   end subroutine serialize_stages

   !> Serialise the arrays of a step.
   subroutine serialize_arrays(archive, self)
      type(archive_t), intent(inout) :: archive
      type(stage_solver_t), intent(inout) :: self

      call serialize_reals(archive, size(self%coupled), self%coupled)
      call serialize_reals(archive, size(self%weight), self%weight)
      call serialize_reals(archive, size(self%most_weight), self%most_weight)
      call serialize_reals(archive, size(self%z), self%z)
      call serialize_reals(archive, size(self%shifted), self%shifted)
      call serialize_reals(archive, size(self%y), self%y)
      call serialize_reals(archive, size(self%f), self%f)
      call serialize_reals(archive, size(self%change), self%change)
      call serialize_reals(archive, size(self%jacobian), self%jacobian)
      call serialize_reals(archive, size(self%error), self%error)
      call serialize_reals(archive, size(self%slope), self%slope)
      call serialize_reals(archive, size(self%slope_at_end), self%slope_at_end)
      call serialize_reals(archive, size(self%last), self%last)
      call serialize_reals(archive, size(self%before), self%before)
      call serialize_reals(archive, size(self%start), self%start)
      call serialize_reals(archive, size(self%moved), self%moved)
      call serialize_reals(archive, size(self%moved_f), self%moved_f)
   end subroutine serialize_arrays

end module evl_stage_archive
