!> The force laws of a contact behind one interface: elastic, viscous and friction.
!>
!> A new law is a procedure in its own file, a place in the table of laws and a case in the procedures of its family here; and, to
!> be evaluated for eight states at once, a formula in src/formulas and a loop in evl_force_lanes. A damping law that refers to the
!> mesh is another law once the mesh is known: evl_mesh_damping says which.
module evl_contact_laws
   use evl_damping, only: damping_share, impact_damping, linear_damping, one_sided_damping
   use evl_friction, only: coulomb_factor, coulomb_knee, coulomb_mode, stribeck_factor, tanh_factor
   use evl_hunt_crossley, only: flores_factor, gonthier_factor, hunt_crossley_factor, lankarani_nikravesh_factor, lee_wang_factor
   use evl_johnson, only: johnson_energy, johnson_force, johnson_limit_message, johnson_penetration
   use evl_kinds, only: pi, wp
   use evl_law_info, only: is_left_open, law_info_t, law_name_length, law_parameter_t, law_text_length, max_law_parameters, &
                           parameter_range_error
   use evl_law_table, only: contact_johnson, contact_linear, contact_power, contact_radzimovsky, contact_rigid, &
                            contact_yang_lin, damping_flores, damping_gonthier, damping_hunt_crossley, &
                            damping_lankarani_nikravesh, damping_lee_wang, damping_linear, damping_none, damping_one_sided, &
                            friction_coulomb, friction_none, friction_stribeck, friction_tanh, law_count, law_describe, &
                            laws_contact, laws_damping, laws_friction
   use evl_radzimovsky, only: radzimovsky_force, radzimovsky_limit_message, radzimovsky_penetration
   use evl_springs, only: linear_spring, power_penetration, power_spring, yang_lin_stiffness
   use evl_status, only: code_invalid_input, code_ok, code_out_of_domain, message_length, quantity
   implicit none (type, external)
   private

   public :: contact_context, elastic_result, law_choice, law_info_t, law_parameter_t, viscous_result
   public :: elastic_force, elastic_limit_message, elastic_potential, penetration_from_force, viscous_force
   public :: friction_factor, friction_knee, friction_mode, friction_acts, friction_falls
   public :: is_rigid, is_undamped, rigid_rest_velocity, rigid_restitution, undamped
   public :: has_sides, impact_share, linear_stiffness
   public :: contact_johnson, contact_linear, contact_power, contact_radzimovsky, contact_yang_lin
   public :: damping_flores, damping_gonthier, damping_hunt_crossley, damping_lankarani_nikravesh, damping_lee_wang
   public :: damping_linear, damping_none, damping_one_sided
   public :: friction_coulomb, friction_none, friction_stribeck, friction_tanh
   public :: law_count, law_describe, law_validate
   public :: law_name_length, law_text_length, laws_contact, laws_damping, laws_friction

   !> One law of a family with its parameters, in the order of the table. Assumed valid below: see law_validate.
   type :: law_choice
      integer :: law = 0                                     !! index in the family's table, from 0
      real(wp) :: parameters(max_law_parameters) = 0.0_wp    !! in the units of the table
   end type law_choice

   type(law_choice), parameter :: undamped = law_choice(law=damping_none) !! of family laws_damping

   !> What a law may know about a contact.
   type :: contact_context
      real(wp) :: h = 0.0_wp       !! penetration [m], negative for a gap
      real(wp) :: h_dot = 0.0_wp   !! its rate [m/s]
      real(wp) :: rho_sum = 0.0_wp !! rho_a + rho_b [m]
      real(wp) :: rho_a = 0.0_wp   !! radius of curvature of the driving flank [m]
      real(wp) :: rho_b = 0.0_wp   !! radius of curvature of the driven flank [m]
      real(wp) :: e_star = 0.0_wp  !! effective modulus E* [Pa]
      real(wp) :: width = 0.0_wp   !! common face width [m]
      real(wp) :: v0 = 0.0_wp      !! approach speed at the last closing [m/s]
      integer :: side = 0          !! of h' = 0, for laws with two: +1 approach, -1 separation; 0: as h' says
   end type contact_context

   !> An elastic force with its derivatives, and those of the elastic energy V as `elastic_potential` has it. The radii enter
   !> every law through their sum; r = rho_sum - h.
   type :: elastic_result
      real(wp) :: force = 0.0_wp !! [N], over the whole width
      real(wp) :: d_h = 0.0_wp   !! dF/dh at constant rho_sum [N/m]
      real(wp) :: d_rho = 0.0_wp !! dF/d(rho_sum) at constant h, which is dF/dr [N/m]
      real(wp) :: d_energy = 0.0_wp !! dV/dr at constant h [J/m]
      real(wp) :: excess = 0.0_wp   !! dV/dh - F at constant r: what V, a series, gets wrong [N]
   end type elastic_result

   !> A viscous force with its derivatives, through the elastic force too.
   type :: viscous_result
      real(wp) :: force = 0.0_wp   !! [N], over the whole width; positive when it pushes the flanks apart
      real(wp) :: d_h = 0.0_wp     !! dF/dh at constant rho_sum [N/m]
      real(wp) :: d_rho = 0.0_wp   !! dF/d(rho_sum) at constant h [N/m]
      real(wp) :: d_h_dot = 0.0_wp !! dF/dh' [N s/m]
   end type viscous_result

contains

   !> Elastic normal force, odd in h. Which sign of h counts as contact is the business of the contact mode.
   pure subroutine elastic_force(choice, ctx, result, code)
      type(law_choice), intent(in) :: choice      !! of family laws_contact
      type(contact_context), intent(in) :: ctx    !! where
      type(elastic_result), intent(out) :: result !! zero on error
      integer, intent(out) :: code                !! code_ok or code_out_of_domain
      real(wp) :: potential

      select case (choice%law)
      case (contact_johnson)
         call johnson_force(ctx%h, ctx%rho_sum, ctx%e_star, result%force, result%d_h, result%d_rho, code)
         call spread_over_width(ctx%width, ctx%e_star, ctx%h, ctx%rho_sum, result)
      case (contact_radzimovsky)
         call radzimovsky_force(ctx%h, ctx%rho_sum, ctx%e_star, result%force, result%d_h, result%d_rho, code)
         call spread_over_width(ctx%width, ctx%e_star, ctx%h, ctx%rho_sum, result)
      case (contact_rigid)
         code = code_out_of_domain
      case default
         call spring_force(choice, ctx, result%force, result%d_h, potential)
         code = code_ok
      end select
   end subroutine elastic_force

   !> The laws that depend on the penetration alone.
   pure subroutine spring_force(choice, ctx, force, d_h, potential)
      type(law_choice), intent(in) :: choice   !! contact_linear, contact_yang_lin or contact_power
      type(contact_context), intent(in) :: ctx !! where
      real(wp), intent(out) :: force           !! [N], over the whole width
      real(wp), intent(out) :: d_h             !! dF/dh [N/m]
      real(wp), intent(out) :: potential       !! elastic energy [J]

      if (choice%law == contact_power) then
         call power_spring(ctx%h, choice%parameters(1), choice%parameters(2), force, d_h, potential)
      else
         call linear_spring(ctx%h, linear_stiffness(choice, ctx%e_star, ctx%width), force, d_h, potential)
      end if
   end subroutine spring_force

   include "laws/spread_over_width.inc"

   !> Stiffness of the laws that are linear in h [N/m].
   pure real(wp) function linear_stiffness(choice, e_star, width) result(stiffness)
      type(law_choice), intent(in) :: choice   !! contact_linear or contact_yang_lin
      real(wp), intent(in) :: e_star           !! effective modulus E* [Pa]
      real(wp), intent(in) :: width            !! common face width [m]

      if (choice%law == contact_linear) then
         stiffness = choice%parameters(1)
      else
         stiffness = yang_lin_stiffness(e_star, width)
      end if
   end function linear_stiffness

   !> Whether a contact law is a constraint: it has no force law, its normal force is a multiplier.
   pure logical function is_rigid(choice)
      type(law_choice), intent(in) :: choice !! of family laws_contact

      is_rigid = choice%law == contact_rigid
   end function is_rigid

   !> Whether a damping law never gives a force.
   pure logical function is_undamped(choice)
      type(law_choice), intent(in) :: choice !! of family laws_damping

      is_undamped = choice%law == damping_none
   end function is_undamped

   !> Whether a damping law changes at h' = 0: it has a side of approach and one of separation.
   pure logical function has_sides(choice)
      type(law_choice), intent(in) :: choice !! of family laws_damping

      has_sides = choice%law == damping_one_sided
   end function has_sides

   !> Newton's coefficient of restitution of a rigid contact.
   pure real(wp) function rigid_restitution(choice)
      type(law_choice), intent(in) :: choice !! a rigid contact

      rigid_restitution = choice%parameters(1)
   end function rigid_restitution

   !> Approach speed below which an impact of a rigid contact does not rebound [m/s].
   pure real(wp) function rigid_rest_velocity(choice)
      type(law_choice), intent(in) :: choice !! a rigid contact

      rigid_rest_velocity = choice%parameters(2)
   end function rigid_rest_velocity

   !> Why elastic_force answered code_out_of_domain, as one sentence; "" for a law that never does.
   pure subroutine elastic_limit_message(choice, ctx, message)
      type(law_choice), intent(in) :: choice    !! of family laws_contact
      type(contact_context), intent(in) :: ctx  !! where
      character(len=*), intent(out) :: message  !! truncated to its length

      message = ""
      select case (choice%law)
      case (contact_johnson)
         call johnson_limit_message(ctx%h, ctx%rho_sum, message)
      case (contact_radzimovsky)
         call radzimovsky_limit_message(ctx%h, ctx%rho_sum, message)
      case (contact_rigid)
         message = "a rigid contact has no force law: its normal force is the multiplier of its constraint"
      end select
   end subroutine elastic_limit_message

   !> Penetration at which the elastic force is `force`; ctx%h is not used.
   pure subroutine penetration_from_force(choice, ctx, force, h, code)
      type(law_choice), intent(in) :: choice   !! of family laws_contact
      type(contact_context), intent(in) :: ctx !! where
      real(wp), intent(in) :: force            !! [N], over the whole width
      real(wp), intent(out) :: h               !! [m]; 0 on error
      integer, intent(out) :: code             !! code_ok or code_out_of_domain

      h = 0.0_wp
      code = code_ok
      select case (choice%law)
      case (contact_johnson)
         call johnson_penetration(force/ctx%width, ctx%rho_sum, ctx%e_star, h, code)
      case (contact_radzimovsky)
         call radzimovsky_penetration(force/ctx%width, ctx%rho_sum, ctx%e_star, h, code)
      case (contact_rigid)
         code = code_out_of_domain
      case (contact_power)
         h = power_penetration(force, choice%parameters(1), choice%parameters(2))
      case default
         h = force/linear_stiffness(choice, ctx%e_star, ctx%width)
      end select
   end subroutine penetration_from_force

   !> Elastic energy of the contact: dV = F dh where rho_sum - h is constant, as in a mesh on fixed axles. Even in h.
   pure subroutine elastic_potential(choice, ctx, potential, code, elastic)
      type(law_choice), intent(in) :: choice   !! of family laws_contact
      type(contact_context), intent(in) :: ctx !! where
      real(wp), intent(out) :: potential       !! [J]; 0 on error
      integer, intent(out), optional :: code   !! code_ok or code_out_of_domain
      real(wp), intent(in), optional :: elastic !! elastic force there, if it is known [N]
      type(elastic_result) :: result
      real(wp) :: force, d_h
      integer :: answer

      potential = 0.0_wp
      answer = code_ok
      select case (choice%law)
      case (contact_johnson, contact_radzimovsky)
         if (present(elastic)) then
            result%force = elastic
         else
            call elastic_force(choice, ctx, result, answer)
         end if
         potential = ctx%width*johnson_energy(ctx%h, abs(result%force)/ctx%width, ctx%rho_sum, ctx%e_star)
      case (contact_rigid)
         answer = code_out_of_domain
      case default
         call spring_force(choice, ctx, force, d_h, potential)
      end select
      if (present(code)) code = answer
   end subroutine elastic_potential

   !> Viscous normal force. A law that refers to the mesh gives none: see evl_mesh_damping.
   pure subroutine viscous_force(choice, ctx, elastic, result)
      type(law_choice), intent(in) :: choice      !! of family laws_damping
      type(contact_context), intent(in) :: ctx    !! where
      type(elastic_result), intent(in) :: elastic !! elastic force there, for laws that multiply it
      type(viscous_result), intent(out) :: result !! zero for the law none
      real(wp) :: share

      select case (choice%law)
      case (damping_linear)
         call linear_damping(ctx%h_dot, choice%parameters(1), result%force, result%d_h_dot)
      case (damping_one_sided)
         call one_sided_damping(ctx%h, ctx%h_dot, choice%parameters(1), damping_share(ctx%side, ctx%h_dot), result%force, &
                                result%d_h, result%d_h_dot)
      case (damping_hunt_crossley, damping_lankarani_nikravesh, damping_flores, damping_gonthier, damping_lee_wang)
         share = impact_share(choice, ctx%v0)
         result%d_h_dot = share*elastic%force
         result%force = impact_damping(share, elastic%force, ctx%h_dot)
         share = share*ctx%h_dot
         result%d_h = share*elastic%d_h
         result%d_rho = share*elastic%d_rho
      end select
   end subroutine viscous_force

   !> chi/v0 of the laws that multiply the elastic force by chi h'/v0 [s/m].
   pure real(wp) function impact_share(choice, v0) result(share)
      type(law_choice), intent(in) :: choice !! a law after Hunt and Crossley
      real(wp), intent(in) :: v0             !! approach speed at the last closing [m/s]

      share = impact_factor(choice)/max(v0, choice%parameters(2))
   end function impact_share

   !> Their chi.
   pure real(wp) function impact_factor(choice) result(chi)
      type(law_choice), intent(in) :: choice !! a law after Hunt and Crossley

      chi = 0.0_wp
      associate (restitution => choice%parameters(1))
         select case (choice%law)
         case (damping_hunt_crossley)
            chi = hunt_crossley_factor(restitution)
         case (damping_lankarani_nikravesh)
            chi = lankarani_nikravesh_factor(restitution)
         case (damping_flores)
            chi = flores_factor(restitution)
         case (damping_gonthier)
            chi = gonthier_factor(restitution)
         case (damping_lee_wang)
            chi = lee_wang_factor(restitution)
         end select
      end associate
   end function impact_factor

   !> phi of F_t = -F_n phi(v_t) on the branch `mode`, also where v_t has left that branch.
   pure subroutine friction_factor(choice, mode, v_t, factor, d_v)
      type(law_choice), intent(in) :: choice !! of family laws_friction
      integer, intent(in) :: mode            !! -1, 0 or +1, as friction_mode gives it
      real(wp), intent(in) :: v_t            !! sliding velocity [m/s]
      real(wp), intent(out) :: factor        !! phi
      real(wp), intent(out) :: d_v           !! dphi/dv_t [s/m]

      factor = 0.0_wp
      d_v = 0.0_wp
      select case (choice%law)
      case (friction_coulomb)
         call coulomb_factor(mode, v_t, choice%parameters(1), choice%parameters(2), factor, d_v)
      case (friction_tanh:friction_stribeck)
         call smooth_friction_factor(choice, v_t, factor, d_v)
      end select
   end subroutine friction_factor

   !> The laws without branches.
   pure subroutine smooth_friction_factor(choice, v_t, factor, d_v)
      type(law_choice), intent(in) :: choice !! friction_tanh or friction_stribeck
      real(wp), intent(in) :: v_t            !! sliding velocity [m/s]
      real(wp), intent(out) :: factor        !! phi
      real(wp), intent(out) :: d_v           !! dphi/dv_t [s/m]

      associate (p => choice%parameters)
         if (choice%law == friction_tanh) then
            call tanh_factor(v_t, p(1), p(2), factor, d_v)
         else
            call stribeck_factor(v_t, p(1), p(2), p(3), p(4), factor, d_v)
         end if
      end associate
   end subroutine smooth_friction_factor

   !> Whether there is any friction: its largest coefficient comes first in every law.
   elemental logical function friction_acts(choice)
      type(law_choice), intent(in) :: choice !! of family laws_friction

      friction_acts = choice%law /= friction_none .and. choice%parameters(1) > 0
   end function friction_acts

   !> Whether friction falls somewhere as the sliding velocity rises: damping is negative there.
   elemental logical function friction_falls(choice)
      type(law_choice), intent(in) :: choice !! of family laws_friction

      friction_falls = choice%law == friction_stribeck .and. choice%parameters(1) > choice%parameters(2)
   end function friction_falls

   !> The branch of the friction law that belongs to a sliding velocity: -1, 0 or +1.
   pure integer function friction_mode(choice, v_t)
      type(law_choice), intent(in) :: choice !! of family laws_friction
      real(wp), intent(in) :: v_t            !! sliding velocity [m/s]

      friction_mode = 0
      select case (choice%law)
      case (friction_coulomb)
         friction_mode = coulomb_mode(v_t, choice%parameters(1), choice%parameters(2))
      end select
   end function friction_mode

   !> The |v_t| at which the friction mode changes [m/s]; 0 if it never does.
   pure real(wp) function friction_knee(choice)
      type(law_choice), intent(in) :: choice !! of family laws_friction

      friction_knee = 0.0_wp
      select case (choice%law)
      case (friction_coulomb)
         friction_knee = coulomb_knee(choice%parameters(1), choice%parameters(2))
      end select
   end function friction_knee

   !> Check that a choice names a law of the family and that its parameters are in range.
   pure subroutine law_validate(family, choice, code, field, message)
      integer, intent(in) :: family            !! laws_contact, laws_damping or laws_friction
      type(law_choice), intent(in) :: choice   !! to check; parameters that the law does not have are ignored
      integer, intent(out) :: code             !! code_ok or code_invalid_input
      character(len=*), intent(out) :: field   !! "law", or the parameter's name; "" if valid
      character(len=*), intent(out) :: message !! one sentence; "" if valid
      type(law_info_t) :: info
      character(len=message_length) :: reason
      character(len=12) :: number
      integer :: i

      field = ""
      message = ""
      call law_describe(family, choice%law, info, code)
      if (code /= code_ok) then
         field = "law"
         write (number, "(i0)") choice%law
         message = "there is no law "//trim(number)//" in this family"
         return
      end if
      do i = 1, info%n_parameters
         if (is_left_open(info%parameters(i), choice%parameters(i))) cycle
         reason = parameter_range_error(info%parameters(i), choice%parameters(i))
         if (reason == "") cycle
         code = code_invalid_input
         field = info%parameters(i)%name
         message = trim(reason)//" (law "//trim(info%name)//")"
         return
      end do
      if (family == laws_friction .and. choice%law == friction_stribeck) then
         if (choice%parameters(1) >= choice%parameters(2)) return
         code = code_invalid_input
         field = info%parameters(1)%name
         message = trim(field)//" = "//quantity(choice%parameters(1), "")//" must be at least the kinetic_coefficient = " &
                   //quantity(choice%parameters(2), "")//" (law "//trim(info%name)//")"
      end if
   end subroutine law_validate

end module evl_contact_laws
