!> Meshes of compliant gears: restrictions on other case parameters, and creation of their flanks.
module evl_compliant_mesh
   use evl_compliant_flank, only: compliant_flank_t
   use evl_coupled_compliant_flank, only: coupled_compliant_flank_t
   use evl_flank, only: flank_slot, flank_t
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_description, only: mesh_input, wheel_input
   use evl_kinds, only: pi, wp
   use evl_pair_compliance, only: assemble_compliance, pair_compliance
   use evl_pair_point, only: by_a, pair_feet
   use evl_parameter_view, only: parameter_view_t
   use evl_status, only: code_invalid_input, fail, quantity, status_t, subject_mesh, subject_wheel
   use evl_tooth_contact, only: tracking_closed_form
   use evl_wheel_compliance, only: wheel_compliance_t
   implicit none (type, external)
   private

   public :: check_compliant_mesh, make_flank

   real(wp), parameter :: edge_reach = 0.4_wp !! range beyond the path of contact in which tip edges can carry load [base pitches]
   real(wp), parameter :: heavy = 1.0e6_wp    !! line load at which tables are checked; contacts are softer at smaller ones [N/m]
   integer, parameter :: n_looked = 50        !! number of positions checked

contains

   !> Check the parameters of a mesh of compliant gears. Gear compliance is added to Johnson's contact at the contact points of the
   !> closed form. Tooth coupling needs coupling data of the wheels.
   subroutine check_compliant_mesh(gearbox, wheels, mesh, index, status)
      type(gearbox_t), intent(in) :: gearbox !! including its compliances
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: mesh
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status
      type(parameter_view_t) :: contact

      ! one by one: gfortran 12 copies elements selected by an index list and does not free the copies
      associate (a => gearbox%compliances(mesh%driving), b => gearbox%compliances(mesh%driven))
         if (.not. (a%exists .or. b%exists)) then
            if (mesh%word("edge_contact") == "true") call check_edges()
            if (mesh%word("tooth_coupling") == "true") &
               call refuse("tooth coupling results from compliant wheels, but none of these has a compliance; give one, or" &
                           //" omit this", "tooth_coupling")
            return
         end if
         call mesh%inner("contact", contact)
         if (contact%word("law") /= "johnson") then
            call refuse("a wheel with compliance requires contact {law: johnson}, to which its c is added, not " &
                        //trim(contact%word("law")), "contact.law")
         else if (mesh%tracking /= tracking_closed_form) then
            call refuse("a wheel with compliance requires tracking: closed_form", "tracking")
         else if (mesh%word("tooth_coupling") == "true" .and. &
                  any([a%exists, b%exists] .and. [a%neighbours, b%neighbours] == 0)) then
            call refuse("a wheel with compliance {model: analytic}, or a table without c_1, does not include deflections by" &
                        //" loads of neighbouring teeth; give false, or finite_elements to the wheel", "tooth_coupling")
         else if (couples(gearbox, mesh) .and. any([a%neighbours, b%neighbours] == 1)) then ! from a table
            call check_tables(gearbox, wheels, mesh, index, status)
         end if
      end associate

   contains

      !> Check tip edges on rigid flanks.
      subroutine check_edges()
         call mesh%inner("contact", contact)
         if (contact%word("law") /= "johnson") then
            call refuse("corner contact requires contact {law: johnson}, not "//trim(contact%word("law")), "edge_contact")
         else if (mesh%tracking /= tracking_closed_form) then
            call refuse("corner contact requires tracking: closed_form", "edge_contact")
         else if (.not. all(gearbox%gears([mesh%driving, mesh%driven])%normal_module > 0)) then
            call refuse("corner contact requires gears with a basic rack; give both wheels a module, or false", "edge_contact")
         end if
      end subroutine check_edges

      subroutine refuse(message, field)
         character(len=*), intent(in) :: message, field

         call fail(status, code_invalid_input, message, subject_mesh, index, field)
      end subroutine refuse

   end subroutine check_compliant_mesh

   !> Check that tables determine the forces of two loaded tooth pairs: at all positions with two pairs in contact, their compliance
   !> matrix, contact included, must be positive definite.
   subroutine check_tables(gearbox, wheels, mesh, index, status)
      type(gearbox_t), intent(in) :: gearbox
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: mesh
      integer, intent(in) :: index
      type(status_t), intent(inout) :: status
      type(pair_feet) :: feet(2)
      type(pair_compliance) :: compliance
      real(wp) :: k(2), own(2), reach, rho(2), contact, from, to
      integer :: i, worse

      associate (pair => gearbox%pairs(index), a => gearbox%compliances(mesh%driving), b => gearbox%compliances(mesh%driven))
         k = [half_plane(wheels(mesh%driving)%material), half_plane(wheels(mesh%driven)%material)]
         contact = sum(k)/2*(log(8*pair%rho/(sum(k)*heavy)) - 2) ! dh/dN of Johnson's law, K_A + K_B = 2/(pi E*)
         reach = merge(edge_reach, 0.0_wp, has_edges(gearbox, mesh))*pair%base_pitch
         from = pair%rho_start_a - reach + pair%base_pitch
         to = pair%rho_tip_a + reach
         do i = 0, n_looked
            if (to < from) return
            rho = from + real(i, wp)/n_looked*(to - from) - [0.0_wp, pair%base_pitch]
            feet(1)%foot = min([rho(1), pair%rho - rho(1)], [pair%rho_tip_a, pair%rho_tip_b])
            feet(2)%foot = min([rho(2), pair%rho - rho(2)], [pair%rho_tip_a, pair%rho_tip_b])
            call assemble_compliance(a, b, k(1) - k(2), .true., .true., 2, [0, 1], feet, compliance)
            own = [compliance%c(1, 1), compliance%c(2, 2)] + contact
            if (all(own > 0) .and. compliance%c(1, 2)**2 < product(own)) cycle
            worse = merge(mesh%driving, mesh%driven, a%neighbours == 1)
            call fail(status, code_invalid_input, "two loaded tooth pairs would have undefined forces: loaded at rho = " &
                      //quantity(feet(1)%foot(by_a), "m")//" and "//quantity(feet(2)%foot(by_a), "m")//" of the driving" &
                      //" wheel, each deflects by "//quantity(compliance%c(1, 2), "1/Pa")//" under the other's load, and only by " &
                      //quantity(own(1), "1/Pa")//" and "//quantity(own(2), "1/Pa")//" under its own; give c and c_1 of one" &
                      //" wheel, c_1 below c", subject_wheel, worse, "compliance.c_1")
            return
         end do
      end associate
   end subroutine check_tables

   !> Whether the compliance of the tooth pairs of a mesh is coupled.
   pure logical function couples(gearbox, mesh)
      type(gearbox_t), intent(in) :: gearbox
      type(mesh_input), intent(in) :: mesh

      couples = any(gearbox%compliances([mesh%driving, mesh%driven])%neighbours > 0) .and. mesh%word("tooth_coupling") /= "false"
   end function couples

   !> Whether tip edges make contact before and after the path of contact.
   pure logical function has_edges(gearbox, mesh)
      type(gearbox_t), intent(in) :: gearbox
      type(mesh_input), intent(in) :: mesh

      has_edges = mesh%word("edge_contact") == "true"
      if (mesh%word("edge_contact") == "") has_edges = any(gearbox%compliances([mesh%driving, mesh%driven])%exists)
   end function has_edges

   !> Allocate the flank type of a mesh. Built in place: gfortran 12 frees copies of nested polymorphic components twice.
   subroutine make_flank(gearbox, wheels, mesh, slot)
      type(gearbox_t), intent(in) :: gearbox
      type(wheel_input), intent(in) :: wheels(:)
      type(mesh_input), intent(in) :: mesh
      type(flank_slot), intent(out) :: slot

      associate (a => mesh%driving, b => mesh%driven)
         if (.not. (any(gearbox%compliances([a, b])%exists) .or. has_edges(gearbox, mesh))) then
            allocate (flank_t :: slot%flank)
            return
         end if
         if (couples(gearbox, mesh)) then
            allocate (coupled_compliant_flank_t :: slot%flank)
         else
            allocate (compliant_flank_t :: slot%flank)
         end if
         slot%flank%bends = .true.
         slot%flank%couples = couples(gearbox, mesh)
         select type (flank => slot%flank)
         class is (compliant_flank_t)
            call take_wheel(gearbox%compliances(a), flank%a)
            call take_wheel(gearbox%compliances(b), flank%b)
            if (any(gearbox%compliances([a, b])%exists)) &
               flank%k_difference = half_plane(wheels(a)%material) - half_plane(wheels(b)%material)
            if (has_edges(gearbox, mesh)) flank%reach = edge_reach
         end select
      end associate
   end subroutine make_flank

   !> Copy the compliance of a wheel.
   subroutine take_wheel(compliance, wheel)
      type(wheel_compliance_t), intent(in) :: compliance
      class(wheel_compliance_t), allocatable, intent(out) :: wheel

      allocate (wheel_compliance_t :: wheel)
      select type (wheel)
      type is (wheel_compliance_t)
         wheel = compliance
      end select
   end subroutine take_wheel

   !> K = 2 (1 - nu**2)/(pi E) [1/Pa]
   pure real(wp) function half_plane(material)
      type(parameter_view_t), intent(in) :: material

      half_plane = 2*(1 - material%number("poisson_ratio")**2)/(pi*material%number("youngs_modulus"))
   end function half_plane

end module evl_compliant_mesh
