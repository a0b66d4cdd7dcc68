!> The table of all force laws. The index of a law is its index in the list of its family, from 0.
module evl_law_table
   use evl_damping, only: linear_damping_law, no_damping_law, one_sided_damping_law, ratio_damping_law
   use evl_friction, only: coulomb_friction_law, no_friction_law, stribeck_friction_law, tanh_friction_law
   use evl_hunt_crossley, only: flores_law, gonthier_law, hunt_crossley_law, lankarani_nikravesh_law, lee_wang_law
   use evl_johnson, only: johnson_law
   use evl_law_info, only: law_info_t
   use evl_radzimovsky, only: radzimovsky_law
   use evl_rigid, only: rigid_law
   use evl_springs, only: linear_spring_law, power_spring_law, yang_lin_law
   use evl_status, only: code_invalid_input, code_ok
   implicit none (type, external)
   private

   public :: law_count, law_describe
   public :: laws_contact, laws_damping, laws_friction
   public :: contact_johnson, contact_radzimovsky, contact_linear, contact_yang_lin, contact_power, contact_rigid
   public :: damping_none, damping_linear, damping_one_sided, damping_hunt_crossley, damping_lankarani_nikravesh
   public :: damping_flores, damping_gonthier, damping_lee_wang, damping_ratio
   public :: friction_none, friction_coulomb, friction_tanh, friction_stribeck

   integer, parameter :: laws_contact = 0  !! family of the elastic laws; evl_law_family of the C header
   integer, parameter :: laws_damping = 1  !! family of the viscous laws
   integer, parameter :: laws_friction = 2 !! family of the friction laws

   integer, parameter :: contact_johnson = 0, contact_radzimovsky = 1, contact_linear = 2, contact_yang_lin = 3, &
                         contact_power = 4, contact_rigid = 5
   integer, parameter :: damping_none = 0, damping_linear = 1, damping_one_sided = 2, damping_hunt_crossley = 3, &
                         damping_lankarani_nikravesh = 4, damping_flores = 5, damping_gonthier = 6, damping_lee_wang = 7, &
                         damping_ratio = 8
   integer, parameter :: friction_none = 0, friction_coulomb = 1, friction_tanh = 2, friction_stribeck = 3

contains

   !> Number of laws of a family; 0 if there is no such family.
   pure integer function law_count(family) result(n)
      integer, intent(in) :: family !! laws_contact, laws_damping or laws_friction
      type(law_info_t) :: info
      integer :: code

      n = -1
      code = code_ok
      do while (code == code_ok)
         n = n + 1
         call law_describe(family, n, info, code)
      end do
   end function law_count

   !> Describe law `index` of a family: the table of all laws. Each is made alone, since a gearbox asks for those it has.
   pure subroutine law_describe(family, index, info, code)
      integer, intent(in) :: family           !! laws_contact, laws_damping or laws_friction
      integer, intent(in) :: index            !! from 0; there is none after the last
      type(law_info_t), intent(out) :: info   !! empty if there is no such law
      integer, intent(out), optional :: code  !! code_ok, or code_invalid_input if there is no such law

      select case (family)
      case (laws_contact)
         select case (index)
         case (contact_johnson)
            info = johnson_law()
         case (contact_radzimovsky)
            info = radzimovsky_law()
         case (contact_linear)
            info = linear_spring_law()
         case (contact_yang_lin)
            info = yang_lin_law()
         case (contact_power)
            info = power_spring_law()
         case (contact_rigid)
            info = rigid_law()
         end select
      case (laws_damping)
         select case (index)
         case (damping_none)
            info = no_damping_law()
         case (damping_linear)
            info = linear_damping_law()
         case (damping_one_sided)
            info = one_sided_damping_law()
         case (damping_hunt_crossley)
            info = hunt_crossley_law()
         case (damping_lankarani_nikravesh)
            info = lankarani_nikravesh_law()
         case (damping_flores)
            info = flores_law()
         case (damping_gonthier)
            info = gonthier_law()
         case (damping_lee_wang)
            info = lee_wang_law()
         case (damping_ratio)
            info = ratio_damping_law()
         end select
      case (laws_friction)
         select case (index)
         case (friction_none)
            info = no_friction_law()
         case (friction_coulomb)
            info = coulomb_friction_law()
         case (friction_tanh)
            info = tanh_friction_law()
         case (friction_stribeck)
            info = stribeck_friction_law()
         end select
      end select
      if (present(code)) code = merge(code_ok, code_invalid_input, info%name /= "")
   end subroutine law_describe

end module evl_law_table
