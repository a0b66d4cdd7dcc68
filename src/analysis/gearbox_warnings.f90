!> Warnings about valid but questionable parameters: limits of the force law, and values that hardly any gearbox has, which may be
!> correct but more likely have a wrong unit.
module evl_gearbox_warnings
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: pi, wp
   use evl_mesh_geometry, only: spur_pair_least_radius
   use evl_status, only: message_length, quantity, status_t, subject_mesh, subject_wheel, warn
   implicit none (type, external)
   private

   public :: check_contact_width, warn_of_speeds, warn_of_tooth_errors

   real(wp), parameter :: narrow = 0.1_wp    !! limit of the half width of the contact strip over a radius of curvature
   real(wp), parameter :: large_error = 0.1_wp !! limit of runout and thickness allowance in modules
   real(wp), parameter :: fast = 1.0e5_wp    !! limit of the speed of a wheel [rad/s]

contains

   !> Warn if the contact strip is not narrow compared with the radii of curvature; the smallest radius is at an end of the path.
   !> Equation T77.
   !>
   !> Half width of two cylinders pressed together: sqrt(4 N rho_A rho_B/(pi E* (rho_A + rho_B))), Hertz.
   subroutine check_contact_width(gearbox, index)
      type(gearbox_t), intent(inout) :: gearbox
      integer, intent(in) :: index
      real(wp) :: least, half_width

      associate (contact => gearbox%contacts(gearbox%first(index)))
         if (contact%rigid) return
         least = spur_pair_least_radius(gearbox%pairs(index))
         associate (line => gearbox%pairs(index)%rho) ! the other radius: the rest of the line, beyond it for an internal pair
            half_width = sqrt(4*contact%force_scale/contact%width*least*abs(line - least)/(pi*contact%e_star*abs(line)))
         end associate
         if (half_width > narrow*least) &
            call warn(gearbox%warnings, "under its load of about "//quantity(contact%force_scale, "N")//" the contact strip is " &
                      //quantity(half_width, "m")//" wide to either side, more than a tenth of the smallest radius of" &
                      //" curvature "//quantity(least, "m")//": the force law is stretched", subject_mesh, index)
      end associate
   end subroutine check_contact_width

   !> Warn of eccentricities and thickness allowances above a tenth of a module, which are unlikely to be intended.
   subroutine warn_of_tooth_errors(gearbox)
      type(gearbox_t), intent(inout) :: gearbox !! new warnings are appended
      integer :: i

      do i = 1, size(gearbox%wheels)
         associate (gear => gearbox%gears(i), eccentricity => gearbox%wheels(i)%deviation%eccentricity)
            if (gear%teeth == 0) cycle
            if (eccentricity > large_error*gear%normal_module) call warn_of_one("eccentricity", "eccentricity", eccentricity)
            if (-gear%thickness_allowance > large_error*gear%normal_module) &
               call warn_of_one("thickness_allowance", "thickness allowance", gear%thickness_allowance)
         end associate
      end do

   contains

      subroutine warn_of_one(field, name, length)
         character(len=*), intent(in) :: field, name
         real(wp), intent(in) :: length !! [m]

         call warn(gearbox%warnings, "the "//name//" of "//quantity(length, "m")//" is more than 0.1 modules, " &
                   //quantity(large_error*gearbox%gears(i)%normal_module, "m")//"; check its unit", subject_wheel, i, field)
      end subroutine warn_of_one

   end subroutine warn_of_tooth_errors

   !> Append one warning if wheels rotate faster than 100,000 rad/s: by a prescribed speed, where viscous loads or drives balance
   !> the torques, or at the start.
   pure subroutine warn_of_speeds(gearbox, initial, warnings)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: initial(:) !! of the wheels [rad/s]; size 0 if not given
      type(status_t), allocatable, intent(inout) :: warnings(:) !! a new warning is appended
      real(wp) :: speeds(size(gearbox%wheels))
      logical :: is_known(size(gearbox%loads))
      character(len=message_length) :: text
      integer :: i

      speeds = 0
      if (size(initial) > 0) speeds = abs(initial)
      ! constant torques define no speed, only an increasing one
      is_known = [(gearbox%loads(i)%load%prescribes .or. gearbox%loads(i)%load%by_speed, i=1, size(gearbox%loads))]
      if (any(is_known)) speeds = max(speeds, gearbox%nominal%speed_scale*abs(gearbox%wheels%ratio))
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i)%load)
            if (load%prescribes) speeds(load%wheel) = max(speeds(load%wheel), load%fastest)
         end associate
      end do
      i = findloc(speeds > fast, .true., dim=1)
      if (i == 0) return
      text = "loads and initial state give it a speed of "//quantity(speeds(i), "rad/s")
      call add_others(text, count(speeds > fast) - 1)
      text = trim(text)//"; check the units: lengths in metres, torques in N m, speeds in rad/s"
      call warn(warnings, trim(text), subject_wheel, i)
   end subroutine warn_of_speeds

   !> Append the number of other wheels to which the warning applies.
   pure subroutine add_others(text, n)
      character(len=*), intent(inout) :: text
      integer, intent(in) :: n
      character(len=40) :: number

      if (n == 1) then
         text = trim(text)//", and so has another wheel"
      else if (n > 1) then
         write (number, "(a, i0, a)") ", and ", n, " other wheels have such speeds"
         text = trim(text)//trim(number)
      end if
   end subroutine add_others

end module evl_gearbox_warnings
