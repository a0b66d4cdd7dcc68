!> Springs and dampers of supports and shafts.
module evl_springs_and_dampers
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: damper_power, spring_damper, support_acceleration

contains

   include "components/springs_and_dampers.inc"

end module evl_springs_and_dampers
