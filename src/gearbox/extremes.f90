!> Which outputs of a mesh are watched between the outputs, and which of their extremes over the run are told: one table.
!>
!> An extreme belongs to an output of a mesh or of its tooth pairs; its name is that of the output with `_max` or `_min`, the
!> time at which it was first reached has `_time` behind that.
module evl_extremes
   implicit none (type, external)
   private

   public :: extreme_t, extremes_table, n_extremes, n_watched_outputs
   public :: watch_normal, watch_friction, watch_error, watch_sliding, watch_pair_normal, watch_pair_pressure, watch_penetration

   integer, parameter :: n_extremes = 10

   !> Watched outputs: those that a mesh has once, then those of its tooth pairs.
   integer, parameter :: watch_normal = 1, watch_friction = 2, watch_error = 3, watch_sliding = 4
   integer, parameter :: watch_pair_normal = 5, watch_pair_pressure = 6, watch_penetration = 7
   integer, parameter :: n_watched_outputs = 7

   !> One extreme; see `evl_extreme` in the C header.
   type :: extreme_t
      character(len=31) :: output = "", units = "", symbol = ""
      character(len=95) :: long_name = ""
      integer :: watched = 0       !! one of the watched outputs
      logical :: is_largest = .true.
   end type extreme_t

contains

   !> The table.
   pure function extremes_table() result(t)
      type(extreme_t) :: t(n_extremes)

      t(1) = extreme_t("normal_force", "N", "F_n", "largest normal force of all tooth pairs; of rigid contact between impacts", &
                       watch_normal)
      t(2) = extreme_t("pair_normal_force", "N", "F_nk", "largest normal force of a tooth pair; of rigid contact between impacts", &
                       watch_pair_normal)
      t(3) = extreme_t("friction_force", "N", "F_t", "largest friction force on the driving wheel along t", watch_friction)
      t(4) = extreme_t("friction_force", "N", "F_t", "smallest friction force on the driving wheel along t", watch_friction, &
                       .false.)
      t(5) = extreme_t("pair_contact_pressure", "Pa", "p_k", "largest contact pressure of a tooth pair", watch_pair_pressure)
      t(6) = extreme_t("penetration", "m", "h", "largest penetration of the flanks", watch_penetration)
      t(7) = extreme_t("transmission_error", "m", "Delta", "largest transmission error", watch_error)
      t(8) = extreme_t("transmission_error", "m", "Delta", "smallest transmission error", watch_error, .false.)
      t(9) = extreme_t("sliding_velocity", "m s-1", "v_t", "largest sliding velocity along t", watch_sliding)
      t(10) = extreme_t("sliding_velocity", "m s-1", "v_t", "smallest sliding velocity along t", watch_sliding, .false.)
   end function extremes_table

end module evl_extremes
