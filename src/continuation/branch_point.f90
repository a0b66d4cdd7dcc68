!> Point of a branch of periodic orbits, its kind, and the interface of an output recorder.
module evl_branch_point
   use evl_kinds, only: wp
   use evl_periodic_orbit, only: orbit_t
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: branch_point, kind_crossing, kind_doubling, kind_fold, kind_neimark_sacker, kind_ordinary, kind_grazing, &
             kind_grazing_fold, orbit_recorder

   integer, parameter :: kind_ordinary = 0       !! no special point
   integer, parameter :: kind_fold = 1           !! the branch turns back: a multiplier 1
   integer, parameter :: kind_crossing = 2       !! a multiplier 1 where the branch continues: another branch crosses it
   integer, parameter :: kind_doubling = 3       !! a multiplier -1
   integer, parameter :: kind_neimark_sacker = 4 !! a pair of multipliers on the unit circle
   integer, parameter :: kind_grazing = 5          !! grazing: a root function touches zero without crossing it
   integer, parameter :: kind_grazing_fold = 6     !! the same with a fold of the branch: no multiplier is 1

   !> A point of a branch.
   type :: branch_point
      type(orbit_t) :: orbit
      integer :: kind = kind_ordinary
      integer :: root = 0           !! index of the root function that touches zero
      integer :: recorded = 0           !! number under which an orbit_recorder recorded it: there is no derivative. 0: none did
      real(wp) :: arclength = 0           !! distance from the last ordinary point, along its tangent, in units of the scales
   end type branch_point

   !> Recorder of outputs of an orbit, such as means and extremes, which need a run of their own. The run also checks whether
   !> the orbit is periodic; this saves the computation of a flow where predictions are good.
   type, abstract :: orbit_recorder
   contains
      procedure(record_interface), deferred :: record
   end type orbit_recorder

   abstract interface
      !> Integrate a predicted orbit over one round and record its outputs, in place of any earlier record of that number. The
      !> model has the orbit's value of the parameter.
      subroutine record_interface(self, number, orbit, status)
         import :: orbit_t, orbit_recorder, status_t
         implicit none (type, external)
         class(orbit_recorder), intent(inout) :: self
         integer, intent(in) :: number          !! >= 1
         type(orbit_t), intent(inout) :: orbit  !! `flow` gets its end, rate and same_modes; an autonomous orbit its actual period
         type(status_t), intent(inout) :: status !! touched on failure only
      end subroutine record_interface
   end interface

end module evl_branch_point
