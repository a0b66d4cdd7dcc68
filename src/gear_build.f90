!> The real gears of a gearbox and their meshes, from its description.
module evl_gear_build
   use evl_gear_geometry, only: agreement, gear_derive, gear_t, thin_tip
   use evl_gear_mesh, only: gear_mesh_derive, gear_mesh_input, gear_mesh_t
   use evl_gearbox_description, only: mesh_input, wheel_input
   use evl_kinds, only: wp
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t, subject_mesh, subject_wheel, warn
   implicit none (type, external)
   private

   public :: gears_build

contains

   !> Derive all gears and meshes, and write warnings down. Wheels and meshes that are no real gears get initial values.
   !>
   !> Errors: code_invalid_input with subject, index and field.
   pure subroutine gears_build(wheels, meshes, gears, gear_meshes, warnings, status)
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: meshes(:)
      type(gear_t), intent(out) :: gears(size(wheels))
      type(gear_mesh_t), intent(out) :: gear_meshes(size(meshes))
      type(status_t), allocatable, intent(inout) :: warnings(:) !! grows
      type(status_t), intent(inout) :: status
      integer :: i

      do i = 1, size(wheels)
         if (.not. wheels(i)%has_gear) cycle
         call gear_derive(wheels(i)%teeth, wheels(i)%gear, gears(i), status)
         if (.not. has_failed(status)) call check_pitch_radius(wheels(i), gears(i), status)
         if (has_failed(status)) then
            status%index = i
            return
         end if
         if (gears(i)%tip_thickness < thin_tip*gears(i)%normal_module) &
            call warn(warnings, "the tooth is "//quantity(gears(i)%tip_thickness, "m")//" thick on the tip circle, less than " &
                      //quantity(thin_tip, "")//" modules: such a tip breaks easily", subject_wheel, i)
      end do
      do i = 1, size(meshes)
         call build_mesh(wheels, gears, meshes(i), gear_meshes(i), status)
         if (has_failed(status)) then
            status%subject = subject_mesh
            status%index = i
            return
         end if
         if (gear_meshes(i)%exists .and. gear_meshes(i)%contact_ratio < 1) &
            call warn(warnings, "its contact ratio is "//quantity(gear_meshes(i)%contact_ratio, "")//", less than 1: contact is" &
                      //" lost in every pitch", subject_mesh, i)
      end do
   end subroutine gears_build

   !> The mesh of two real gears, if it is one; no mesh of one real gear with another wheel.
   pure subroutine build_mesh(wheels, gears, given, mesh, status)
      type(wheel_input), intent(in) :: wheels(:)
      type(gear_t), intent(in) :: gears(:)
      type(mesh_input), intent(in) :: given
      type(gear_mesh_t), intent(inout) :: mesh
      type(status_t), intent(inout) :: status

      associate (a => given%driving, b => given%driven)
         if (wheels(a)%has_gear .neqv. wheels(b)%has_gear) then
            call refuse(status, "", "one of its wheels has a module and the other has none: give both a module, or none of them" &
                        //" and the mesh a pressure angle")
         else if (.not. wheels(a)%has_gear .and. given%has_centre_distance) then
            call refuse(status, "centre_distance", "a centre distance is for two wheels with a module; the pitch radii of" &
                        //" these give theirs")
         else if (.not. wheels(a)%has_gear .and. given%has_backlash .and. .not. given%backlash >= 0) then
            call refuse(status, "backlash", "backlash "//quantity(given%backlash, "m")//" must not be negative")
         else if (wheels(a)%has_gear .and. (given%paper_rule .or. abs(given%pressure_angle) > 0)) then
            call refuse(status, "pressure_angle", "a pressure angle of the mesh is for wheels without module; the working" &
                        //" pressure angle of these follows from their centre distance")
         else if (wheels(a)%has_gear) then
            call gear_mesh_derive(gears(a), gears(b), gear_mesh_input(given%has_centre_distance, given%has_backlash, &
                                                                      given%centre_distance, given%backlash), mesh, status)
         end if
      end associate
   end subroutine build_mesh

   !> A pitch radius that is given beside a module is the reference radius.
   pure subroutine check_pitch_radius(wheel, gear, status)
      type(wheel_input), intent(in) :: wheel
      type(gear_t), intent(in) :: gear
      type(status_t), intent(inout) :: status

      if (.not. wheel%has_pitch_radius) return
      if (abs(wheel%pitch_radius - gear%reference_radius) <= agreement*gear%reference_radius) return
      call fail(status, code_invalid_input, "pitch radius "//quantity(wheel%pitch_radius, "m")//" does not agree with the" &
                //" reference radius "//quantity(gear%reference_radius, "m")//", which teeth and module give", subject_wheel, &
                field="pitch_radius")
   end subroutine check_pitch_radius

   !> Refuse something of a mesh.
   pure subroutine refuse(status, field, message)
      type(status_t), intent(inout) :: status
      character(len=*), intent(in) :: field, message

      call fail(status, code_invalid_input, message, subject_mesh, field=field)
   end subroutine refuse

end module evl_gear_build
