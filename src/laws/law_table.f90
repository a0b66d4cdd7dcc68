!> Table of all force laws, one line each. The index of a law is its position in the list of its family, from 0.
module evl_law_table
   use evl_benedict_kelley, only: benedict_kelley_t
   use evl_coulomb, only: coulomb_t
   use evl_damping_law, only: damping_law_t
   use evl_damping_ratio, only: damping_ratio_t
   use evl_elastic_law, only: elastic_law_t
   use evl_friction_law, only: friction_law_t
   use evl_impact_damping, only: impact_damping_t, impact_factors
   use evl_johnson, only: johnson_t
   use evl_kind_finder, only: kind_finder
   use evl_linear_damping, only: linear_damping_t
   use evl_linear_spring, only: linear_spring_t
   use evl_mean_roughness, only: mean_roughness_t
   use evl_no_damping, only: no_damping_t
   use evl_no_friction, only: no_friction_t
   use evl_one_sided_damping, only: one_sided_damping_t
   use evl_power_spring, only: power_spring_t
   use evl_radzimovsky, only: radzimovsky_t
   use evl_rigid, only: rigid_t
   use evl_schlenk, only: schlenk_t
   use evl_stribeck, only: stribeck_t
   use evl_tanh_friction, only: tanh_friction_t
   use evl_xu_kahraman, only: xu_kahraman_t
   use evl_yang_lin, only: yang_lin_t
   implicit none (type, external)
   private

   public :: damping_law, elastic_law, friction_law

contains

   !> Table of the elastic laws. Returns the law that a finder requests, without parameters; not allocated if there is none.
   subroutine elastic_law(finder, law)
      type(kind_finder), intent(inout) :: finder
      class(elastic_law_t), allocatable, intent(out) :: law

      call offer(johnson_t())
      call offer(radzimovsky_t())
      call offer(linear_spring_t())
      call offer(yang_lin_t())
      call offer(power_spring_t())
      call offer(rigid_t())

   contains

      subroutine offer(entry)
         class(elastic_law_t), intent(in) :: entry

         if (.not. finder%meets(entry)) return
         allocate (law, source=entry)
         law%index = finder%n - 1
      end subroutine offer

   end subroutine elastic_law

   !> Table of the damping laws. Returns the law that a finder requests, without parameters; not allocated if there is none.
   subroutine damping_law(finder, law)
      type(kind_finder), intent(inout) :: finder
      class(damping_law_t), allocatable, intent(out) :: law
      integer :: i

      call offer(no_damping_t())
      call offer(linear_damping_t())
      call offer(one_sided_damping_t())
      do i = 1, size(impact_factors)
         call offer(impact_damping_t(factor=i))
      end do
      call offer(damping_ratio_t())

   contains

      subroutine offer(entry)
         class(damping_law_t), intent(in) :: entry

         if (.not. finder%meets(entry)) return
         allocate (law, source=entry)
         law%index = finder%n - 1
      end subroutine offer

   end subroutine damping_law

   !> Table of the friction laws. Returns the law that a finder requests, without parameters; not allocated if there is none.
   subroutine friction_law(finder, law)
      type(kind_finder), intent(inout) :: finder
      class(friction_law_t), allocatable, intent(out) :: law

      call offer(no_friction_t())
      call offer(coulomb_t())
      call offer(tanh_friction_t())
      call offer(stribeck_t())
      call offer(schlenk_t())
      call offer(mean_roughness_t())
      call offer(benedict_kelley_t())
      call offer(xu_kahraman_t())

   contains

      subroutine offer(entry)
         class(friction_law_t), intent(in) :: entry

         if (.not. finder%meets(entry)) return
         allocate (law, source=entry)
         law%index = finder%n - 1
      end subroutine offer

   end subroutine friction_law

end module evl_law_table
