!> Which outputs of a mesh are watched between the outputs, and which of their extremes over the run are told: one table.
!>
!> An extreme belongs to an output of a mesh or of its tooth pairs and has its unit and its symbol; its name is that of the output
!> with `_max` or `_min`, the time at which it was first reached has `_time` behind that.
module evl_extremes
   implicit none (type, external)
   private

   public :: extreme_t, extremes_table, n_watched_outputs
   public :: watch_normal, watch_friction, watch_error, watch_sliding, watch_pair_normal, watch_pair_pressure, watch_penetration

   !> Watched outputs: those that a mesh has once, then those of its tooth pairs.
   enum, bind(c)
      enumerator :: watch_normal = 1, watch_friction, watch_error, watch_sliding
      enumerator :: watch_pair_normal, watch_pair_pressure, watch_penetration
   end enum

   !> One extreme; see `evl_extreme` in the C header.
   type :: extreme_t
      character(len=31) :: output = ""
      character(len=95) :: long_name = ""
      integer :: watched = 0       !! one of the watched outputs
      logical :: is_largest = .true.
   end type extreme_t

   type(extreme_t), parameter :: extremes_table(*) = &
                                 [extreme_t("normal_force", &
                                            "largest normal force of all tooth pairs; of rigid contact between impacts", &
                                            watch_normal), &
                                  extreme_t("pair_normal_force", &
                                            "largest normal force of a tooth pair; of rigid contact between impacts", &
                                            watch_pair_normal), &
                                  extreme_t("friction_force", &
                                            "largest friction force on the driving wheel along t", &
                                            watch_friction), &
                                  extreme_t("friction_force", &
                                            "smallest friction force on the driving wheel along t", &
                                            watch_friction, .false.), &
                                  extreme_t("pair_contact_pressure", &
                                            "largest contact pressure of a tooth pair", &
                                            watch_pair_pressure), &
                                  extreme_t("penetration", "largest penetration of the flanks", watch_penetration), &
                                  extreme_t("transmission_error", "largest transmission error", watch_error), &
                                  extreme_t("transmission_error", "smallest transmission error", watch_error, .false.), &
                                  extreme_t("sliding_velocity", "largest sliding velocity along t", watch_sliding), &
                                  extreme_t("sliding_velocity", "smallest sliding velocity along t", watch_sliding, .false.)]

   integer, parameter :: n_watched_outputs = maxval(extremes_table%watched)

end module evl_extremes
