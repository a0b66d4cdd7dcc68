!> Names of the states of a gearbox.
module evl_state_names
   use evl_gearbox, only: gearbox_t
   use evl_housing, only: n_housing_states
   use evl_local_variables, only: i_omega, i_theta, n_track
   use evl_number_text, only: write_integer
   use evl_tooth_contact, only: flank_coast
   implicit none (type, external)
   private

   public :: gearbox_state_name

   character(len=14), parameter :: track_names(n_track) = ["turn          ", "zeta          ", "dr_t          ", &
                                                           "dr_e          ", "gradient_ratio", "mu            "]
   character(len=3), parameter :: track_units(n_track) = ["rad", "m  ", "m  ", "m  ", "1  ", "m2 "]
   character(len=26), parameter :: housing_names(n_housing_states) = &
                                   ["housing_x                 ", "housing_y                 ", "housing_z                 ", &
                                    "housing_quaternion_w      ", "housing_quaternion_x      ", "housing_quaternion_y      ", &
                                    "housing_quaternion_z      ", "housing_velocity_x        ", "housing_velocity_y        ", &
                                    "housing_velocity_z        ", "housing_angular_velocity_x", "housing_angular_velocity_y", &
                                    "housing_angular_velocity_z"]
   character(len=7), parameter :: housing_units(n_housing_states) = &
                                  ["m      ", "m      ", "m      ", "1      ", "1      ", "1      ", "1      ", "m s-1  ", &
                                   "m s-1  ", "m s-1  ", "rad s-1", "rad s-1", "rad s-1"]

contains

   !> Name of a state with the index, from 0, of its wheel or mesh, and its unit; blank if there is no such state. A rotor has the
   !> name of its leader.
   subroutine gearbox_state_name(gearbox, index, name, units)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index            !! index in the state
      character(len=*), intent(out) :: name   !! such as "angle_deviation_1"
      character(len=*), intent(out) :: units  !! "1" for dimensionless states
      integer :: i, j

      name = ""
      units = ""
      if (index == i_theta) call set("reference_angle", "rad")
      if (index == i_omega) call set("reference_speed", "rad s-1")
      if (index == gearbox%i_dissipated) call set("dissipated_energy", "J")
      if (index == gearbox%i_work) call set("load_work", "J")
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%i_psi > 0 .and. wheel%leader == i) then
               if (index == wheel%i_psi) call set("angle_deviation", "rad", i)
               if (index == wheel%i_psi + 1) call set("speed_deviation", "rad s-1", i)
            end if
            do j = 1, wheel%support%n
               if (index == wheel%support%i_state(j)) call set(trim(displacement(wheel%support%n, j)), "m", i)
               if (index == wheel%support%i_state(j) + 1) call set(trim(displacement(wheel%support%n, j))//"_rate", "m s-1", i)
            end do
         end associate
      end do
      do i = 1, size(gearbox%contacts)
         if (gearbox%contacts(i)%slot > 0) cycle
         if (gearbox%contacts(i)%leads .and. index == gearbox%contacts(i)%i_normal) &
            call set(merge("coast_multiplier", "multiplier      ", gearbox%contacts(i)%flank == flank_coast), "N", &
                     gearbox%contacts(i)%mesh)
         j = index - gearbox%contacts(i)%i_track + 1
         if (gearbox%contacts(i)%i_track > 0 .and. j >= 1 .and. j <= n_track) &
            call set(track_names(j), trim(track_units(j)), gearbox%contacts(i)%mesh)
      end do
      j = index - gearbox%housing%i_state + 1
      if (gearbox%housing%is_mounted .and. j >= 1 .and. j <= n_housing_states) &
         call set(trim(housing_names(j)), trim(housing_units(j)))

   contains

      subroutine set(text, unit, number)
         character(len=*), intent(in) :: text, unit
         integer, intent(in), optional :: number !! of a wheel or mesh, from 1
         character(len=8) :: suffix

         name = text
         units = unit
         if (.not. present(number)) return
         call write_integer(number - 1, suffix)
         name = trim(text)//"_"//suffix
      end subroutine set

   end subroutine gearbox_state_name

   !> Name of a support's degree of freedom.
   pure function displacement(n, j) result(name)
      integer, intent(in) :: n, j !! number of degrees of freedom, index
      character(len=14) :: name

      name = "displacement"
      if (n == 2) name = "displacement_"//merge("x", "y", j == 1)
   end function displacement

end module evl_state_names
