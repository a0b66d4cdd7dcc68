!> Reference data of every mesh at its nominal load, and the damping laws that depend on them.
module evl_gearbox_references
   use evl_damping_law, only: damping_law_t
   use evl_force_law, only: choice_of
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_mesh_reference, only: reference_damping, reference_of
   use evl_row, only: short_length
   use evl_status, only: code_invalid_input, fail, has_failed, message_length, quantity, status_t, subject_mesh, warn
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: gearbox_set_references

   real(wp), parameter :: much = 0.3_wp !! damping ratio above which a warning is issued: measured meshes reach 0.17

contains

   !> Compute the reference data of every mesh at its nominal load, complete the damping laws that depend on them, and warn of high
   !> damping. If a law depends on the nominal load of a mesh without load, gearbox%start_refusal is set: every start fails, but not
   !> a static analysis, which has its own load.
   !> Errors: code_invalid_input for such a law if the speeds of both wheels are prescribed.
   subroutine gearbox_set_references(gearbox, status)
      type(gearbox_t), intent(inout) :: gearbox !! including its scales
      type(status_t), intent(inout) :: status
      logical :: has_load
      integer :: m

      allocate (gearbox%references(size(gearbox%pairs)))
      do m = 1, size(gearbox%pairs)
         associate (contact => gearbox%contacts(gearbox%first(m)), reference => gearbox%references(m), &
                    flank => gearbox%flanks(gearbox%contacts(gearbox%first(m))%i_flank)%flank)
            has_load = gearbox%nominal%mesh_scale(m) > 0
            reference = reference_of(flank, contact, has_load, free_mobility(gearbox, contact))
            if (contact%damping%left_to_mesh() /= "") call complete(gearbox, m, status)
            if (has_failed(status)) return
            call reference_damping(flank, contact, reference)
            if (reference%ratio > much) &
               call warn(gearbox%warnings, &
                         "its damping ratio at the nominal load is "//quantity(reference%ratio, "")//", but measured" &
                         //" meshes have 0.03 to 0.17: vibrations at its natural frequency "//quantity(reference%frequency, "Hz") &
                         //" decay at once; {law: ratio, value: 0.07} is typical of measured meshes", subject_mesh, m, "damping")
         end associate
      end do
   end subroutine gearbox_set_references

   !> r_bA^2/J_A + r_bB^2/J_B [1/kg]; a prescribed speed counts as infinite inertia. Equations L9, OP2.
   pure real(wp) function free_mobility(gearbox, contact) result(mobility)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact

      mobility = 0
      associate (a => gearbox%wheels(contact%wheel_a), b => gearbox%wheels(contact%wheel_b))
         if (a%prescribed == 0) mobility = mobility + contact%pair%r_ba**2/a%rotor_inertia
         if (b%prescribed == 0) mobility = mobility + contact%pair%r_bb**2/b%rotor_inertia
      end associate
   end function free_mobility

   !> Complete the damping law of a mesh with its reference data.
   subroutine complete(gearbox, m, status)
      type(gearbox_t), intent(inout) :: gearbox
      integer, intent(in) :: m !! index of the mesh
      type(status_t), intent(inout) :: status
      class(damping_law_t), allocatable :: stated
      integer :: i

      associate (reference => gearbox%references(m), first => gearbox%first(m), last => gearbox%first(m + 1) - 1)
         if (.not. reference%stiffness > 0) then
            call refuse("no load presses its flanks together, so there is no nominal load", gearbox%start_refusal)
         else if (.not. reference%mass > 0) then
            call refuse("the speeds of both wheels are prescribed, so they do not vibrate on its stiffness", status)
         else
            allocate (stated, source=gearbox%contacts(first)%damping)
            call stated%complete(reference%stiffness, reference%mass, gearbox%contacts(first)%h_scale)
            reference%law = choice_of(stated)
            do i = first, last
               call stated%acting(reference%stiffness, reference%mass, gearbox%contacts(i)%damping)
            end do
         end if
      end associate

   contains

      subroutine refuse(reason, refusal)
         character(len=*), intent(in) :: reason
         type(status_t), intent(inout) :: refusal
         character(len=short_length) :: field
         character(len=len("damping.") + short_length) :: field_path
         character(len=message_length) :: message

         call gearbox%contacts(gearbox%first(m))%damping%refuse_mesh(reason, field, message)
         field_path = "damping"
         if (field /= "") field_path = "damping."//field
         if (.not. has_failed(refusal)) call fail(refusal, code_invalid_input, message, subject_mesh, m, field_path)
      end subroutine refuse

   end subroutine complete

end module evl_gearbox_references
