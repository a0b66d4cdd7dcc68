!> Serialisation of an integration in progress; a resumed integration is bitwise identical.
submodule(evl_radau) evl_radau_archive
   use evl_archive, only: serialize, serialize_integers, serialize_reals
   use evl_growth, only: serialize_growth
   use evl_search_archive, only: serialize_extremes, serialize_roots
   use evl_stage_archive, only: serialize_stages
   implicit none (type, external)

contains

   !> Serialise all variable data.
   module procedure serialize_radau
      call serialize(archive, self%t)
      call serialize_reals(archive, size(self%y), self%y)
      call serialize(archive, self%t_before)
      call serialize_integers(archive, size(self%fired), self%fired)
      call serialize_stages(archive, self%stages)
      call serialize_roots(archive, self%roots)
      call serialize_extremes(archive, self%monitored)
      call serialize_reals(archive, size(self%y_before), self%y_before)
      call serialize_reals(archive, size(self%old_z), self%old_z)
      call serialize(archive, self%old_h)
      call serialize(archive, self%h)
      call serialize_integers(archive, size(self%came_from), self%came_from)
      call serialize_reals(archive, size(self%step_after), self%step_after)
      call serialize(archive, self%control%h)
      call serialize(archive, self%control%error)
      call serialize_growth(archive, self%growth)
      call serialize(archive, self%fastest_growth%t)
      call serialize(archive, self%fastest_growth%re)
      call serialize(archive, self%fastest_growth%im)
      call serialize(archive, self%jacobian_is_new)
      call serialize(archive, self%jacobian_is_ahead)
      call serialize(archive, self%jacobian_may_stay)
      call serialize(archive, self%matrix_may_stay)
      call serialize(archive, self%restarted)
      call serialize(archive, self%rejected)
      call serialize(archive, self%counts%steps)
      call serialize(archive, self%counts%rejections)
      call serialize(archive, self%counts%jacobians)
      call serialize(archive, self%counts%root_evaluations)
      call serialize(archive, self%counts%events)
      call serialize(archive, self%counts%growth_cuts)
   end procedure serialize_radau

end submodule evl_radau_archive
