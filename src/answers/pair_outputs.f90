!> What the tooth pairs of a mesh tell one by one. Every mesh has the same places for them: the slots of the drive flank, then those
!> of the coast flank. A place where no tooth pair is on the path has no force, and no point.
module evl_pair_outputs
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_contact_point, only: contact_point
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_output, only: dims_mesh_pair, in_pairs, needs_pairs
   use evl_teller, only: begin, fills, needs, tell, teller_t
   use evl_tooth_contact, only: contact_force, contact_mode, contact_state, edge_wheel, feet_of, flank_coast, flanks_off, &
                                no_force, no_mode, tooth_contact_t, tooth_of_a, tooth_of_b
   use evl_touching_flanks, only: contact_pressure
   implicit none (type, external)
   private

   public :: no_point, nowhere, tell_pair, tell_pairs

   real(wp), parameter :: nan = transfer(int(z"7FF8000000000000", int64), 1.0_wp)
   !> Off the path.
   type(contact_point), parameter :: no_point = contact_point(exists=.false., h=nan, h_dot=nan, rho_a=nan, rho_b=nan, s=nan, &
                                                              c=nan, &
                                                              l_a=nan, l_b=nan, v_t=nan, arm_a=nan, arm_b=nan, tilt=nan, &
                                                              rho_dot=nan, omega_a=nan, omega_b=nan, multiplier=nan)
   real(wp), parameter :: nowhere(2) = [nan, nan]

contains

   !> A tooth contact; off the path without point and force.
   subroutine tell_pair(teller, place, contact, mode, point, foot, force, tooth_a, tooth_b)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: place            !! of all of all meshes
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      real(wp), intent(in) :: foot(2)         !! roll lengths at which A and B are loaded [m]
      type(contact_force), intent(in) :: force
      integer, intent(in) :: tooth_a, tooth_b !! its teeth, from 0
      real(wp) :: pressure

      call begin(teller, in_pairs, dims_mesh_pair, place)
      call needs(teller, needs_pairs)
      call tell(teller, "pair_normal_force", "N", "F_nk", "normal force of a tooth pair", force%normal)
      call tell(teller, "pair_friction_force", "N", "F_tk", "friction force of a tooth pair on the driving wheel along t", &
                force%friction)
      call tell(teller, "pair_position", "m", "rho_Ak", &
                "radius of curvature of the driving flank at the contact; NaN off the path", point%rho_a)
      pressure = 0
      if (fills(teller)) pressure = contact_pressure(contact, mode, force%normal, point, foot)
      call tell(teller, "pair_contact_pressure", "Pa", "p_k", &
                "largest contact pressure; NaN where a hollow flank has no Hertzian one, and on a sharp tip edge", pressure)
      call tell(teller, "pair_on_path", "1", "", "1 if the tooth pair is on the path of contact, or within reach of its edges", &
                mode%flanks /= flanks_off)
      call tell(teller, "pair_number", "1", "k", "the tooth pair: pitches since the start", mode%tooth_pair)
      call tell(teller, "pair_tooth_driving", "1", "", "its tooth of the driving wheel, from 0, counterclockwise", tooth_a)
      call tell(teller, "pair_tooth_driven", "1", "", "its tooth of the driven wheel, from 0, counterclockwise", tooth_b)
      call tell(teller, "pair_contact_mode", "1", "", &
                "0 open, 1 loaded, 2 overlapping without force, 3 too far apart to track, 4 off the path", mode%flanks)
      call tell(teller, "pair_contact_kind", "1", "", &
                "0 flank meets flank, or may; 1 a tip edge of the driving wheel; 2 one of the driven wheel", edge_wheel(mode))
      call tell(teller, "pair_penetration", "m", "h_k", "penetration of the flanks, negative for a gap; NaN off the path", point%h)
      call tell(teller, "pair_sliding_velocity", "m s-1", "v_tk", "sliding velocity of a tooth pair along t; NaN off the path", &
                point%v_t, no_rate="difference of the velocities of two flanks: no output has its integral")
   end subroutine tell_pair

   !> All tooth pairs of a mesh.
   subroutine tell_pairs(teller, gearbox, mesh, contacts)
      type(teller_t), intent(inout) :: teller
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(contact_state), intent(in) :: contacts(:) !! all of them, with their points
      type(contact_mode) :: nothing
      integer :: m, before, place

      nothing = no_mode
      nothing%flanks = flanks_off
      before = (mesh - 1)*gearbox%n_pair_places
      if (gearbox%first(mesh + 1) - gearbox%first(mesh) < gearbox%n_pair_places) then
         do place = before + 1, before + gearbox%n_pair_places
            call tell_pair(teller, place, gearbox%contacts(gearbox%first(mesh)), nothing, no_point, nowhere, no_force, 0, 0)
         end do
      end if
      do m = gearbox%first(mesh), gearbox%first(mesh + 1) - 1
         associate (contact => gearbox%contacts(m), mode => contacts(m)%mode)
            place = before + 1 + contact%slot + merge(gearbox%n_drive_places, 0, contact%flank == flank_coast)
            associate (tooth_a => modulo(tooth_of_a(contact, mode%tooth_pair), gearbox%wheels(contact%wheel_a)%teeth), &
                       tooth_b => modulo(tooth_of_b(contact, mode%tooth_pair), gearbox%wheels(contact%wheel_b)%teeth))
               if (mode%flanks == flanks_off) then
                  call tell_pair(teller, place, contact, mode, no_point, nowhere, no_force, tooth_a, tooth_b)
               else
                  call tell_pair(teller, place, contact, mode, contacts(m)%point, feet_of(contacts(m)), contacts(m)%force, &
                                 tooth_a, tooth_b)
               end if
            end associate
         end associate
      end do
   end subroutine tell_pairs

end module evl_pair_outputs
