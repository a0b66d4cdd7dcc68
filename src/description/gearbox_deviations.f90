!> Flank deviations of the wheels of a gearbox; rejects meshes that do not support them.
module evl_gearbox_deviations
   use evl_contact_curvature, only: largest_second_order
   use evl_deviation_description, only: deviation_create, has_deviation, profile_t
   use evl_gear, only: gear_tip_curvature
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_description, only: mesh_input, wheel_input
   use evl_kinds, only: wp
   use evl_parameter_view, only: parameter_view_t
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t, subject_mesh, subject_wheel, warn
   use evl_tooth_contact, only: tracking_closed_form
   implicit none (type, external)
   private

   public :: check_second_order, gearbox_set_deviations

   real(wp), parameter :: worth_knowing = 0.02_wp !! limit for a warning: second order of the gap over the reference penetration

contains

   !> Set the deviations of all wheels after the geometry of all meshes is known.
   !>
   !> The active profile of a wheel extends from its lowest start in any of its meshes to its tip.
   !> Errors: code_invalid_input with the wheel or the mesh and the field.
   subroutine gearbox_set_deviations(gearbox, wheels, meshes, status)
      type(gearbox_t), intent(inout) :: gearbox
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: meshes(:)
      type(status_t), intent(inout) :: status
      type(profile_t) :: profile
      integer :: i

      do i = 1, size(wheels)
         if (.not. has_deviation(wheels(i)%parameter_view_t)) cycle
         call find_profile(gearbox, wheels, meshes, i, profile, status)
         if (has_failed(status)) return
         call deviation_create(wheels(i)%parameter_view_t, profile, gearbox%wheels(i)%deviation, status)
         if (has_failed(status)) then
            status%index = i
            return
         end if
      end do
      do i = 1, size(meshes)
         call check_mesh(gearbox, meshes(i), i, status)
         if (has_failed(status)) return
      end do
   end subroutine gearbox_set_deviations

   !> Profile of a wheel. Errors: a wheel without a basic rack, or without an active profile in its meshes.
   subroutine find_profile(gearbox, wheels, meshes, index, profile, status)
      type(gearbox_t), intent(in) :: gearbox
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: meshes(:)
      integer, intent(in) :: index
      type(profile_t), intent(out) :: profile
      type(status_t), intent(inout) :: status
      integer :: i

      if (.not. wheels(index)%is_gear) then
         call fail(status, code_invalid_input, "a wheel defined by its pitch radius has no flank deviations; give it a" &
                   //" module", subject_wheel, index, "module")
         return
      end if
      associate (gear => gearbox%gears(index))
         profile%teeth = gear%teeth
         profile%base_radius = gear%base_radius
         profile%reference_radius = gear%reference_radius
         profile%tooth_angle = gear%tooth_angle
      end associate
      profile%rho_start = huge(1.0_wp)
      profile%rho_tip = gear_tip_curvature(gearbox%gears(index))
      do i = 1, size(meshes)
         associate (pair => gearbox%pairs(i))
            if (meshes(i)%driving == index) then
               profile%rho_start = min(profile%rho_start, pair%rho - pair%rho_tip_b)
            else if (meshes(i)%driven == index) then
               profile%rho_start = min(profile%rho_start, pair%rho - pair%rho_tip_a)
            end if
         end associate
      end do
      if (profile%rho_start < profile%rho_tip) return
      call fail(status, code_invalid_input, "deviations of flanks need an active profile, but no mesh gives this wheel one", &
                subject_wheel, index, "teeth")
   end subroutine find_profile

   !> Reject deviations unless tracking is in closed form and the contact is elastic.
   subroutine check_mesh(gearbox, mesh, index, status)
      type(gearbox_t), intent(in) :: gearbox
      type(mesh_input), intent(in) :: mesh
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status

      if (.not. any(gearbox%wheels([mesh%driving, mesh%driven])%deviation%exists)) return
      if (mesh%tracking /= tracking_closed_form) then
         call fail(status, code_invalid_input, "flanks with deviations cannot be tracked; choose tracking closed_form, or" &
                   //" omit the deviations of its wheels", subject_mesh, index, "tracking")
         return
      end if
      if (mesh%contact%is_rigid()) &
         call fail(status, code_invalid_input, "flanks with deviations require an elastic contact; choose another law, or" &
                   //" omit the deviations of its wheels", subject_mesh, index, "contact.law")
   end subroutine check_mesh

   !> Warn where the approximation of the gap matters: first order, or second order of each flank alone (with tip edges).
   subroutine check_second_order(gearbox, index)
      type(gearbox_t), intent(inout) :: gearbox
      integer, intent(in) :: index
      real(wp) :: gap, rho_a
      character(len=24) :: share

      associate (contact => gearbox%contacts(gearbox%first(index)))
         if (.not. contact%deviates) return
         call largest_second_order(contact, gap, rho_a)
         if (.not. gap > worth_knowing*contact%h_scale) return
         write (share, merge("(f0.1)   ", "(es9.2e3)", gap < 1.0e4_wp*contact%h_scale)) 100*gap/contact%h_scale
         if (share(1:1) == ".") share = "0"//share(:len(share) - 1)
         call warn(gearbox%warnings, "slopes of relieved flanks move the contact off the line of action: the gap, approximated to" &
                   //trim(merge(" second order of each flank alone", " first order                     ", contact%has_edges)) &
                   //", is up to "//quantity(gap, "m")//" too wide (at rho_A = "//quantity(rho_a, "m")//"), " &
                   //trim(share)//" % of the penetration "//quantity(contact%h_scale, "m")//" under the load", subject_mesh, index)
      end associate
   end subroutine check_second_order

end module evl_gearbox_deviations
