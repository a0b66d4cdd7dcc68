!> The flank of a mesh that is loaded by a torque of its driving wheel.
module evl_pressed_flank
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_status, only: code_invalid_input, fail, quantity, status_t, subject_none
   use evl_tooth_contact, only: flank_coast
   implicit none (type, external)
   private

   public :: find_pressed, lag_of, pressed_t

   !> The loaded flank.
   type :: pressed_t
      integer :: contact = 0        !! index of one of its contacts
      integer :: turns = 1          !! +1 drive flank; -1 coast flank, where compliance reduces the lag of the driven wheel
      real(wp) :: play = 0.0_wp     !! backlash from the drive flank to this flank [m]
      real(wp) :: rho_a = 0.0_wp    !! of pair 0 at position 0 [m]
   end type pressed_t

contains

   !> Find the flank loaded by a torque, or fail with the reason.
   subroutine find_pressed(gearbox, mesh, torque, speed, flank, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp), intent(in) :: torque, speed
      type(pressed_t), intent(out) :: flank
      type(status_t), intent(inout) :: status
      integer :: n

      if (.not. (abs(torque) > 0 .and. ieee_is_finite(torque))) then
         call fail(status, code_invalid_input, "a torque of "//quantity(torque, "N m")//" of the driving wheel loads no" &
                   //" flanks; give one above 0, in the sense of driving_rotation, or one below 0, which loads the coast" &
                   //" flanks", subject_none)
         return
      end if
      if (.not. ieee_is_finite(speed)) then
         call fail(status, code_invalid_input, "the speed for sliding friction must be finite", subject_none)
         return
      end if
      associate (drive => gearbox%contacts(gearbox%first(mesh)), pair => gearbox%pairs(mesh))
         flank%contact = gearbox%first(mesh)
         flank%rho_a = pair%rho_start_a
         if (torque > 0) return
         do n = gearbox%first(mesh), gearbox%first(mesh + 1) - 1
            if (gearbox%contacts(n)%flank == flank_coast) exit
         end do
         associate (coast => gearbox%contacts(n))
            flank%contact = n
            flank%turns = -1
            flank%play = drive%pair%gap_0 + coast%pair%gap_0
            flank%rho_a = coast%rho_entry
         end associate
      end associate
   end subroutine find_pressed

   !> Lag of the driven wheel at an overlap h of the flanks without deviations [m]. Equation SA3.
   pure real(wp) function lag_of(flank, h) result(lag)
      type(pressed_t), intent(in) :: flank
      real(wp), intent(in) :: h

      lag = flank%turns*(h + flank%play)
   end function lag_of

end module evl_pressed_flank
