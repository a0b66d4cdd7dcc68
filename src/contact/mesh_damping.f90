!> Damping laws that refer to the mesh they act in: what only the mesh can tell, and the law that acts once it is known.
module evl_mesh_damping
   use evl_contact_laws, only: law_choice
   use evl_damping, only: ratio_damping
   use evl_kinds, only: wp
   use evl_law_info, only: is_left_open, law_info_t, law_name_length
   use evl_law_table, only: damping_flores, damping_gonthier, damping_hunt_crossley, damping_lankarani_nikravesh, &
                            damping_lee_wang, damping_linear, damping_ratio, law_describe, laws_damping
   implicit none (type, external)
   private

   public :: damping_left_to_mesh, damping_of_mesh, is_impact_damping

contains

   !> Whether a damping law multiplies the elastic force by chi h'/v0.
   pure logical function is_impact_damping(choice)
      type(law_choice), intent(in) :: choice !! of family laws_damping

      select case (choice%law)
      case (damping_hunt_crossley, damping_lankarani_nikravesh, damping_flores, damping_gonthier, damping_lee_wang)
         is_impact_damping = .true.
      case default
         is_impact_damping = .false.
      end select
   end function is_impact_damping

   !> Which parameter of a damping law only the mesh can give: its name, or that of the parameter that needs the mesh; "" if none.
   pure function damping_left_to_mesh(choice) result(name)
      type(law_choice), intent(in) :: choice !! of family laws_damping
      character(len=law_name_length) :: name
      type(law_info_t) :: info
      integer :: i

      name = ""
      call law_describe(laws_damping, choice%law, info)
      if (choice%law == damping_ratio) name = info%parameters(1)%name
      do i = 1, info%n_parameters
         if (is_left_open(info%parameters(i), choice%parameters(i))) name = info%parameters(i)%name
      end do
   end function damping_left_to_mesh

   !> The law with what the mesh gives: the choice as it was stated, complete, and the law that acts.
   pure subroutine damping_of_mesh(stiffness, mass, h_0, stated, acting)
      real(wp), intent(in) :: stiffness         !! of one tooth pair at the nominal load, k [N/m]
      real(wp), intent(in) :: mass              !! that it accelerates, m [kg]
      real(wp), intent(in) :: h_0               !! penetration under the nominal load [m]
      type(law_choice), intent(inout) :: stated !! of family laws_damping
      type(law_choice), intent(out) :: acting   !! of the laws that viscous_force knows

      if (is_impact_damping(stated) .and. damping_left_to_mesh(stated) /= "") &
         stated%parameters(2) = h_0*sqrt(stiffness/mass)
      acting = stated
      if (stated%law /= damping_ratio) return
      acting = law_choice(law=damping_linear)
      acting%parameters(1) = ratio_damping(stated%parameters(1), stiffness, mass)
   end subroutine damping_of_mesh

end module evl_mesh_damping
