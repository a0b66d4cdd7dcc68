!> Reference data of every mesh at its nominal operating point, and the damping and friction laws that depend on them.
module evl_gearbox_references
   use evl_damping_law, only: damping_law_t
   use evl_force_law, only: choice_of
   use evl_friction_law, only: by_curvature, by_load, by_rolling, by_sliding, friction_law_t, sliding_t
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_local_friction, only: local_friction_t
   use evl_mesh_reference, only: reference_damping, reference_of
   use evl_operating_friction, only: operating_friction_t, operating_point
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
            if (.not. has_failed(status)) call complete_friction(gearbox, m, status)
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

   !> Replace a friction law that depends on the operating point; warn if a local law leaves its limits there.
   !> Errors: code_invalid_input at standstill.
   subroutine complete_friction(gearbox, m, status)
      type(gearbox_t), intent(inout) :: gearbox
      integer, intent(in) :: m !! index of the mesh
      type(status_t), intent(inout) :: status
      class(friction_law_t), allocatable :: stated
      type(operating_point) :: at
      integer :: i

      allocate (stated, source=gearbox%contacts(gearbox%first(m))%friction)
      select type (stated)
      class is (operating_friction_t)
         at = operating_point_of(gearbox, m)
         if (.not. at%rolling_speed > 0) then
            call fail(status, code_invalid_input, "the coefficient of this friction law is that of the nominal speed, at which" &
                      //" the wheels are at rest; give loads that balance at a speed, or {law: coulomb, coefficient: ...}", &
                      subject_mesh, m, "friction.law")
            return
         end if
         gearbox%references(m)%friction = stated%coefficient(at)
         do i = gearbox%first(m), gearbox%first(m + 1) - 1
            call stated%acting(at, gearbox%contacts(i)%friction)
         end do
      class is (local_friction_t)
         call warn_of_limits(gearbox, m, stated)
      end select
   end subroutine complete_friction

   !> Warn if a local friction law holds a quantity at its limit at the nominal operating point.
   subroutine warn_of_limits(gearbox, m, law)
      type(gearbox_t), intent(inout) :: gearbox
      integer, intent(in) :: m !! index of the mesh
      class(local_friction_t), intent(in) :: law
      type(operating_point) :: nominal
      type(sliding_t) :: at
      character(len=message_length) :: message

      nominal = operating_point_of(gearbox, m)
      at%x(1, by_sliding) = 0
      at%x(1, by_rolling) = nominal%rolling_speed
      at%x(1, by_load) = nominal%line_load
      at%x(1, by_curvature) = 1/nominal%radius
      at%e_star = gearbox%contacts(gearbox%first(m))%e_star
      call law%held(at, "at the pitch point at the nominal operating point", message)
      if (message /= "") call warn(gearbox%warnings, trim(message), subject_mesh, m, "friction.law")
   end subroutine warn_of_limits

   !> A mesh at the nominal operating point. Equation L24.
   pure type(operating_point) function operating_point_of(gearbox, m) result(at)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m !! index of the mesh

      associate (contact => gearbox%contacts(gearbox%first(m)), pair => gearbox%pairs(m))
         at%line_load = gearbox%nominal%mesh_load(m)/contact%width
         at%rolling_speed = 2*abs(pair%base_radius_a*contact%pair%ratio_a*gearbox%nominal%speed)*tan(pair%alpha_w)
         associate (r_a => pair%pitch_radius_a, r_b => pair%pitch_radius_b)
            at%radius = abs(r_a*r_b/(r_a + r_b))*sin(pair%alpha_w)
         end associate
         associate (a => gearbox%gears(contact%wheel_a), b => gearbox%gears(contact%wheel_b))
            at%diameter = 2*min(abs(merge(a%reference_radius, pair%pitch_radius_a, a%teeth > 0)), &
                                abs(merge(b%reference_radius, pair%pitch_radius_b, b%teeth > 0)))
         end associate
      end associate
   end function operating_point_of

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
