!> Serialisation of an integration in progress; a resumed integration is bitwise identical.
submodule(evl_radau) evl_radau_archive
   use evl_archive, only: keep, keep_integers, keep_reals
   use evl_growth, only: keep_growth
   use evl_search_archive, only: keep_extremes, keep_roots
   use evl_stage_archive, only: keep_stages
   implicit none (type, external)

contains

   !> Serialise all variable data.
   module procedure keep_radau
      call keep(archive, self%t)
      call keep_reals(archive, size(self%y), self%y)
      call keep(archive, self%t_before)
      call keep_integers(archive, size(self%fired), self%fired)
      call keep_stages(archive, self%stages)
      call keep_roots(archive, self%roots)
      call keep_extremes(archive, self%watched)
      call keep_reals(archive, size(self%y_before), self%y_before)
      call keep_reals(archive, size(self%old_z), self%old_z)
      call keep(archive, self%old_h)
      call keep(archive, self%h)
      call keep_integers(archive, size(self%came_from), self%came_from)
      call keep_reals(archive, size(self%step_after), self%step_after)
      call keep(archive, self%control%h)
      call keep(archive, self%control%error)
      call keep_growth(archive, self%growth)
      call keep(archive, self%fastest_growth%t)
      call keep(archive, self%fastest_growth%re)
      call keep(archive, self%fastest_growth%im)
      call keep(archive, self%jacobian_is_new)
      call keep(archive, self%jacobian_is_ahead)
      call keep(archive, self%jacobian_may_stay)
      call keep(archive, self%matrix_may_stay)
      call keep(archive, self%restarted)
      call keep(archive, self%rejected)
      call keep(archive, self%counts%steps)
      call keep(archive, self%counts%rejections)
      call keep(archive, self%counts%jacobians)
      call keep(archive, self%counts%root_evaluations)
      call keep(archive, self%counts%events)
      call keep(archive, self%counts%growth_cuts)
   end procedure keep_radau

end submodule evl_radau_archive
