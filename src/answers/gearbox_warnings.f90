!> Numbers of a gearbox that are allowed but worth knowing: those that stretch the force law, and those that hardly any gearbox has;
!> they may be right, but more likely a unit is wrong.
module evl_gearbox_warnings
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: pi, wp
   use evl_mesh_geometry, only: spur_pair_least_radius
   use evl_status, only: message_length, quantity, status_t, subject_mesh, subject_wheel, warn
   implicit none (type, external)
   private

   public :: check_contact_width, check_face_width, warn_of_sizes, warn_of_speeds

   real(wp), parameter :: narrow = 0.1_wp    !! half width of the contact strip over a radius of curvature: warn above
   real(wp), parameter :: heavy = 1.0e3_wp   !! mass of a wheel [kg]
   real(wp), parameter :: large = 1.0_wp     !! its pitch radius [m]
   real(wp), parameter :: coarse = 0.1_wp    !! its module [m]
   real(wp), parameter :: wide = 1.0_wp      !! common face width of a mesh [m]
   real(wp), parameter :: fast = 1.0e5_wp    !! its speed [rad/s]

contains

   !> The contact strip has to stay narrow beside the radii of curvature, of which one is smallest at an end of the path.
   !>
   !> Half width of two cylinders pressed together: sqrt(4 N rho_A rho_B/(pi E* (rho_A + rho_B))), Hertz.
   subroutine check_contact_width(gearbox, index)
      type(gearbox_t), intent(inout) :: gearbox
      integer, intent(in) :: index
      real(wp) :: least, other, half_width

      associate (contact => gearbox%contacts(gearbox%first(index)))
         if (contact%rigid) return
         least = spur_pair_least_radius(gearbox%pairs(index))
         other = gearbox%pairs(index)%rho - least
         half_width = sqrt(4*contact%force_scale/contact%width*least*other/(pi*contact%e_star*(least + other)))
         if (half_width > narrow*least) &
            call warn(gearbox%warnings, "under its load of about "//quantity(contact%force_scale, "N")//" the contact strip is " &
                      //quantity(half_width, "m")//" wide to either side, more than a tenth of the smallest radius of" &
                      //" curvature "//quantity(least, "m")//": the force law is stretched", subject_mesh, index)
      end associate
   end subroutine check_contact_width

   !> A face width above a metre: millimetres were given as metres.
   subroutine check_face_width(gearbox, index)
      type(gearbox_t), intent(inout) :: gearbox
      integer, intent(in) :: index

      associate (width => gearbox%contacts(gearbox%first(index))%width)
         if (width > wide) call warn(gearbox%warnings, "its common face width is "//quantity(width, "m") &
                                     //": are millimetres given as metres?", subject_mesh, index)
      end associate
   end subroutine check_face_width

   !> One warning of wheels above a tonne, above a radius of a metre, or of modules above 100 mm: millimetres were given as metres.
   pure subroutine warn_of_sizes(gearbox)
      type(gearbox_t), intent(inout) :: gearbox !! its warnings grow
      logical :: unlikely(size(gearbox%wheels))
      character(len=message_length) :: text
      integer :: i

      associate (mass => gearbox%wheels%mass, radius => gearbox%wheels%pitch_radius, module => gearbox%gears%normal_module)
         unlikely = mass > heavy .or. radius > large .or. module > coarse
         i = findloc(unlikely, .true., dim=1)
         if (i == 0) return
         text = ""
         if (mass(i) > heavy) text = trim(text)//", its mass is "//quantity(mass(i), "kg")
         if (radius(i) > large) text = trim(text)//", its pitch radius is "//quantity(radius(i), "m")
         if (module(i) > coarse) text = trim(text)//", its module is "//quantity(module(i), "m")
      end associate
      call add_others(text, count(unlikely) - 1)
      text = trim(text)//": are millimetres given as metres?"
      call warn(gearbox%warnings, trim(text(3:)), subject_wheel, i)
   end subroutine warn_of_sizes

   !> One warning of wheels that turn faster than 100,000 rad/s: as prescribed, where viscous loads or drives balance the torques,
   !> or at the start.
   pure subroutine warn_of_speeds(gearbox, initial, warnings)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: initial(:) !! of the wheels [rad/s]; size 0 if not given
      type(status_t), allocatable, intent(inout) :: warnings(:) !! grows
      real(wp) :: speeds(size(gearbox%wheels))
      logical :: is_known(size(gearbox%loads))
      character(len=message_length) :: text
      integer :: i

      speeds = 0
      if (size(initial) > 0) speeds = abs(initial)
      ! torques alone give no speed, only one that grows
      is_known = [(gearbox%loads(i)%load%prescribes .or. gearbox%loads(i)%load%by_speed, i=1, size(gearbox%loads))]
      if (any(is_known)) speeds = max(speeds, gearbox%nominal%speed_scale*abs(gearbox%wheels%ratio))
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i)%load)
            if (load%prescribes) speeds(load%wheel) = max(speeds(load%wheel), load%fastest)
         end associate
      end do
      i = findloc(speeds > fast, .true., dim=1)
      if (i == 0) return
      text = "by loads and start it turns at "//quantity(speeds(i), "rad/s")
      call add_others(text, count(speeds > fast) - 1)
      text = trim(text)//": are lengths given in metres, torques in N m, speeds in rad/s?"
      call warn(warnings, trim(text), subject_wheel, i)
   end subroutine warn_of_speeds

   !> Say how many other wheels are like the one that is named.
   pure subroutine add_others(text, n)
      character(len=*), intent(inout) :: text
      integer, intent(in) :: n
      character(len=40) :: number

      if (n == 1) then
         text = trim(text)//", and another wheel is like it"
      else if (n > 1) then
         write (number, "(a, i0, a)") ", and ", n, " other wheels are like it"
         text = trim(text)//trim(number)
      end if
   end subroutine add_others

end module evl_gearbox_warnings
