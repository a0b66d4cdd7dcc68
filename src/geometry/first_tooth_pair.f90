!> Tooth positions in a gear train: first tooth pair of every mesh, consistent with other meshes of its wheels.
!>
!> The first mesh of a train starts with a pair at the start of contact. That determines the positions of all teeth of its two
!> wheels and, through a wheel's other meshes, those of its neighbours. A mesh whose wheels are both determined closes a loop:
!> there the flanks touch only if the teeth around the loop fit; otherwise a gap within the backlash remains. Wheels on one
!> shaft are independent: the teeth determine the angle at which a wheel is fastened to its shaft.
!>
!> Let c be the angle of a tooth's middle, tau the tooth angle on the base circle, and sigma, chi as in evl_mesh_geometry. The
!> root of its flank is sigma tau/2 before c, so
!>
!>    rho_A = r_bA (alpha_w + tau_A/2 - sigma (c_A - chi))   rho_B = r_bB (pi + alpha_w + tau_B/2 - sigma (c_B - chi))
!>
!> Source: Kosenko & Gusev 2011, section 7.1, for any flank; the next tooth is a base pitch further along the line of action.
module evl_first_tooth_pair
   use evl_kinds, only: pi, wp
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t, subject_mesh
   implicit none (type, external)
   private

   public :: tooth_mesh_t, tooth_phase_t, find_tooth_phases

   real(wp), parameter :: agreement = 1.0e-9_wp !! of a base pitch: teeth around a loop that fit within this fit exactly

   !> Data of a mesh that determine tooth positions.
   type :: tooth_mesh_t
      integer :: wheel_a = 0, wheel_b = 0 !! driving and driven wheel, from 1
      integer :: sigma = 1                !! flank
      real(wp) :: chi = 0.0_wp            !! direction of the centre line [rad]
      real(wp) :: alpha_w = 0.0_wp        !! working pressure angle [rad]
      real(wp) :: rho = 0.0_wp            !! length of the line of action [m]
      real(wp) :: base_pitch = 0.0_wp     !! [m]
      real(wp) :: rho_start = 0.0_wp      !! rho_A at the start of contact [m]
      real(wp) :: backlash = 0.0_wp       !! normal backlash [m]
   end type tooth_mesh_t

   !> Position of the first tooth pair of a mesh.
   type :: tooth_phase_t
      real(wp) :: rho_start = 0.0_wp      !! its rho_A, from the start of contact to a base pitch further [m]
      real(wp) :: gap = 0.0_wp            !! between its flanks, in a mesh that closes a loop [m]
      integer :: tooth_a = 0, tooth_b = 0 !! its teeth, counted counterclockwise from the first ones of the wheels
   end type tooth_phase_t

contains

   !> Determine the tooth positions of all wheels, from the first mesh on. A mesh of wheels with unknown tooth angle begins at
   !> the start of contact.
   !> Errors: code_invalid_input for a loop whose teeth do not fit.
   pure subroutine find_tooth_phases(base_radius, tooth_angle, teeth, meshes, phases, status)
      real(wp), intent(in) :: base_radius(:)     !! of every wheel, negative if internal [m]
      real(wp), intent(in) :: tooth_angle(:)     !! tau of every wheel, of either sign if internal [rad]; 0: unknown
      integer, intent(in) :: teeth(:)            !! of every wheel
      type(tooth_mesh_t), intent(in) :: meshes(:)
      type(tooth_phase_t), intent(out) :: phases(:)
      type(status_t), intent(inout) :: status
      logical :: is_known(size(teeth)), done(size(meshes))
      real(wp) :: middle(size(teeth)) !! c of the first tooth of every wheel with known position
      integer :: m

      is_known = .false.
      middle = 0
      do m = 1, size(meshes)
         done(m) = .not. (abs(tooth_angle(meshes(m)%wheel_a)) > 0 .and. abs(tooth_angle(meshes(m)%wheel_b)) > 0)
         phases(m)%rho_start = meshes(m)%rho_start
      end do
      do while (.not. all(done))
         m = next_mesh()
         call find_phase(meshes(m), base_radius, tooth_angle, teeth, is_known, middle, phases(m))
         if (phases(m)%gap > max(meshes(m)%backlash, 0.0_wp) + agreement*meshes(m)%base_pitch) &
            call fail(status, code_invalid_input, "it closes a loop whose teeth do not fit: a gap of " &
                      //quantity(phases(m)%gap, "m")//" is left between its flanks, more than its backlash of " &
                      //quantity(meshes(m)%backlash, "m")//", and a tooth further they overlap", subject_mesh, m)
         if (has_failed(status)) return
         done(m) = .true.
      end do

   contains

      !> Next mesh: one with a wheel whose position is known, or else the first remaining one.
      pure integer function next_mesh() result(next)
         integer :: k

         next = findloc(done, .false., dim=1)
         do k = 1, size(meshes)
            if (done(k) .or. .not. (is_known(meshes(k)%wheel_a) .or. is_known(meshes(k)%wheel_b))) cycle
            next = k
            return
         end do
      end function next_mesh

   end subroutine find_tooth_phases

   !> Determine the first tooth pair of a mesh, and the first tooth of a wheel whose position is unknown. Equations TR4, TR5.
   pure subroutine find_phase(mesh, base_radius, tooth_angle, teeth, is_known, middle, phase)
      type(tooth_mesh_t), intent(in) :: mesh
      real(wp), intent(in) :: base_radius(:), tooth_angle(:)
      integer, intent(in) :: teeth(:)
      logical, intent(inout) :: is_known(:)
      real(wp), intent(inout) :: middle(:)
      type(tooth_phase_t), intent(out) :: phase
      real(wp) :: rho_a, rho_b, at_a, at_b

      associate (a => mesh%wheel_a, b => mesh%wheel_b, pitch => mesh%base_pitch)
         ! radii of curvature at chi + sigma times an angle of 0
         at_a = base_radius(a)*(mesh%alpha_w + tooth_angle(a)/2)
         at_b = base_radius(b)*(pi + mesh%alpha_w + tooth_angle(b)/2)
         rho_a = mesh%rho_start
         rho_b = mesh%rho - rho_a
         if (is_known(b)) rho_b = at_b - mesh%sigma*base_radius(b)*(middle(b) - mesh%chi)
         if (is_known(a)) then
            rho_a = at_a - mesh%sigma*base_radius(a)*(middle(a) - mesh%chi)
         else if (is_known(b)) then
            rho_a = mesh%rho - rho_b
         end if
         phase%rho_start = mesh%rho_start + remainder(rho_a - mesh%rho_start, pitch)
         rho_a = phase%rho_start
         if (is_known(a) .and. is_known(b)) phase%gap = max(remainder(mesh%rho - rho_a - rho_b, pitch), 0.0_wp)
         rho_b = mesh%rho - rho_a - phase%gap
         call take_tooth(a, mesh%chi + mesh%sigma*(at_a - rho_a)/base_radius(a), phase%tooth_a)
         call take_tooth(b, mesh%chi + mesh%sigma*(at_b - rho_b)/base_radius(b), phase%tooth_b)
         if (.not. is_known(a)) middle(a) = mesh%chi + mesh%sigma*(at_a - rho_a)/base_radius(a)
         if (.not. is_known(b)) middle(b) = mesh%chi + mesh%sigma*(at_b - rho_b)/base_radius(b)
         is_known([a, b]) = .true.
      end associate

   contains

      !> Tooth of a wheel whose middle is at an angle; it is the first one if the wheel's position is unknown.
      pure subroutine take_tooth(wheel, angle, tooth)
         integer, intent(in) :: wheel
         real(wp), intent(in) :: angle
         integer, intent(out) :: tooth

         tooth = 0
         if (is_known(wheel)) tooth = modulo(nint((angle - middle(wheel))*teeth(wheel)/(2*pi)), teeth(wheel))
      end subroutine take_tooth

   end subroutine find_phase

   !> Remainder of a length after division by the pitch, at least 0; a pitch minus rounding counts as 0 and gives a result below it.
   !> Equation TR5.
   pure real(wp) function remainder(length, pitch)
      real(wp), intent(in) :: length, pitch

      remainder = modulo(length, pitch)
      if (remainder > pitch*(1 - agreement)) remainder = remainder - pitch
   end function remainder

end module evl_first_tooth_pair
