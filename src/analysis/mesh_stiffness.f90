!> Stiffness of a mesh of compliant gears: one tooth pair at the pitch point, and two that share the load. Also c' of ISO 6336-1 for
!> the same teeth, which is a different quantity: measured single pairs of wheels with and without webs, without the wheel body.
!>
!> The approach of a pair under the line load N is h = N [ln(4 pi E* rho/N) - 1]/(pi E*) + sum over the loaded pairs l of
!> C_kl N_l: Johnson's contact, and C_kk = c_A + c_B + (K_A - K_B)/2 ln(rho_A/rho_B), C_kl = c_A,k-l + c_B,l-k. The second term
!> of C_kk corrects the split between unequal materials in (5.57). The stiffness is the secant, the total load over h.
!>
!> Source: K. L. Johnson, Contact Mechanics, 1985, (5.57); ISO 6336-1:2006, 9.3.
module evl_mesh_stiffness
   use evl_gear, only: gear_t
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: nan, pi, wp
   use evl_wheel_compliance, only: coupling_at_t, own_at_t
   implicit none (type, external)
   private

   public :: iso_stiffness, mesh_stiffness, mesh_stiffness_t, nominal_line_load, reference_circle_load

   real(wp), parameter :: usual_load = 1.0e5_wp      !! line load if there is no nominal load [N/m]
   real(wp), parameter :: full_load = 1.0e5_wp       !! limit of ISO 6336-1, below which c' decreases [N/m]
   real(wp), parameter :: steel = 2.06e11_wp         !! Young's modulus of ISO 6336-1 [Pa]
   real(wp), parameter :: usual_ratio = 0.3_wp       !! Poisson's ratio
   real(wp), parameter :: measured = 0.8_wp          !! C_M: measured over theoretical stiffness
   integer, parameter :: most_turns = 60

   !> Compliances and stiffnesses of a mesh, per unit width.
   type :: mesh_stiffness_t
      real(wp) :: driving(3) = 0.0_wp, driven(3) = 0.0_wp !! c at start, pitch point and end of the path [1/Pa]
      real(wp) :: next_driving = 0.0_wp, next_driven = 0.0_wp !! c_1 at the pitch point [1/Pa]
      real(wp) :: line_load = 0.0_wp !! line load of the stiffnesses [N/m]
      real(wp) :: single_pair = 0.0_wp !! one pair at the pitch point [Pa]
      real(wp) :: double_pair = 0.0_wp !! two pairs, half a base pitch before and after it; 0: the path is too short [Pa]
      real(wp) :: iso = 0.0_wp       !! c' of ISO 6336-1 [Pa]
   end type mesh_stiffness_t

contains

   !> Compliances and stiffnesses of a mesh; initial values if its gears are rigid.
   subroutine mesh_stiffness(gearbox, mesh, stiffness)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(mesh_stiffness_t), intent(out) :: stiffness
      type(coupling_at_t) :: next
      type(own_at_t) :: at
      real(wp) :: rho_a(3), half
      integer :: i

      associate (contact => gearbox%contacts(gearbox%first(mesh)), pair => gearbox%pairs(mesh))
         associate (a => gearbox%compliances(contact%wheel_a), b => gearbox%compliances(contact%wheel_b))
            if (.not. (a%exists .or. b%exists)) return
            rho_a = [pair%rho - pair%rho_tip_b, pair%base_radius_a*tan(pair%alpha_w), pair%rho_tip_a]
            do i = 1, 3
               call a%own(rho_a(i), at)
               stiffness%driving(i) = at%value
               call b%own(pair%rho - rho_a(i), at)
               stiffness%driven(i) = at%value
            end do
            call a%coupling(1, rho_a(2), rho_a(2), next)
            stiffness%next_driving = next%value
            call b%coupling(1, pair%rho - rho_a(2), pair%rho - rho_a(2), next)
            stiffness%next_driven = next%value
         end associate
         stiffness%line_load = nominal_line_load(gearbox, mesh)
         half = pair%base_pitch/2
         stiffness%single_pair = secant(gearbox, mesh, rho_a(2:2), stiffness%line_load)
         if (rho_a(2) - half >= rho_a(1) .and. rho_a(2) + half <= rho_a(3)) &
            stiffness%double_pair = secant(gearbox, mesh, [rho_a(2) + half, rho_a(2) - half], stiffness%line_load)
         stiffness%iso = iso_stiffness(gearbox, mesh, stiffness%line_load)
      end associate
   end subroutine mesh_stiffness

   !> Line load at the nominal operating point, or a usual one [N/m].
   pure real(wp) function nominal_line_load(gearbox, mesh) result(line_load)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh

      associate (contact => gearbox%contacts(gearbox%first(mesh)))
         line_load = gearbox%nominal%mesh_scale(mesh)/contact%width
         if (.not. line_load > 0) line_load = usual_load
      end associate
   end function nominal_line_load

   !> Load over approach of pairs that share a line load [Pa]; the first one is the pair that entered first. Equation C5.
   real(wp) function secant(gearbox, mesh, rho_a, line_load) result(stiffness)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp), intent(in) :: rho_a(:)  !! radii of curvature on the driving wheel [m]
      real(wp), intent(in) :: line_load !! total [N/m]
      real(wp) :: share(size(rho_a)), matrix(2, 2), contact_part, before
      integer :: k, turn

      associate (contact => gearbox%contacts(gearbox%first(mesh)), pair => gearbox%pairs(mesh))
         share = line_load/size(rho_a)
         stiffness = 0
         do turn = 1, most_turns
            before = stiffness
            do k = 1, size(rho_a)
               contact_part = (log(4*pi*contact%e_star*pair%rho/share(k)) - 1)/(pi*contact%e_star)
               matrix(k, k) = contact_part + own_part(gearbox, mesh, rho_a(k))
            end do
            if (size(rho_a) == 1) then
               stiffness = 1/matrix(1, 1)
               return
            end if
            matrix(1, 2) = coupling(gearbox, mesh, rho_a(1), rho_a(2))
            ! h from equal approaches of both: M N = h
            share = line_load*[matrix(2, 2) - matrix(1, 2), matrix(1, 1) - matrix(1, 2)] &
                    /(matrix(1, 1) + matrix(2, 2) - 2*matrix(1, 2))
            stiffness = line_load/(matrix(1, 1)*share(1) + matrix(1, 2)*share(2))
            if (abs(stiffness - before) <= 1e-13_wp*stiffness) exit
         end do
      end associate
   end function secant

   !> C_kk of a pair. Equation C5.
   real(wp) function own_part(gearbox, mesh, rho_a) result(c)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp), intent(in) :: rho_a
      type(own_at_t) :: a, b

      associate (contact => gearbox%contacts(gearbox%first(mesh)), pair => gearbox%pairs(mesh))
         call gearbox%compliances(contact%wheel_a)%own(rho_a, a)
         call gearbox%compliances(contact%wheel_b)%own(pair%rho - rho_a, b)
         c = a%value + b%value + (2*contact%pair%share_a - 1)/(pi*contact%e_star)*log(rho_a/(pair%rho - rho_a))
      end associate
   end function own_part

   !> C_kl of two pairs one pitch apart. Equation C5.
   real(wp) function coupling(gearbox, mesh, elder, younger) result(c)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp), intent(in) :: elder, younger !! rho on the driving wheel [m]
      type(coupling_at_t) :: a, b

      ! the driving flank faces the sense of rotation, so the tooth of the elder pair is the next one in it; on the driven wheel the
      ! flank faces the opposite sense
      associate (contact => gearbox%contacts(gearbox%first(mesh)), pair => gearbox%pairs(mesh))
         call gearbox%compliances(contact%wheel_a)%coupling(1, younger, elder, a)
         call gearbox%compliances(contact%wheel_b)%coupling(-1, pair%rho - younger, pair%rho - elder, b)
         c = a%value + b%value
      end associate
   end function coupling

   !> c' of ISO 6336-1 for a mesh of solid wheels [Pa]; NaN for an internal pair, for which the standard has no formula. Its load is
   !> F_t K_A/b, tangential at the reference circle, with K_A = 1.
   pure real(wp) function iso_stiffness(gearbox, mesh, line_load) result(stiffness)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp), intent(in) :: line_load !! normal to the flanks [N/m]
      integer :: pinion, wheel

      associate (contact => gearbox%contacts(gearbox%first(mesh)))
         ! gear 1 of the standard's formula is the pinion
         pinion = contact%wheel_a
         wheel = contact%wheel_b
         stiffness = nan
         if (gearbox%gears(pinion)%is_internal .or. gearbox%gears(wheel)%is_internal) return
         if (gearbox%gears(pinion)%teeth > gearbox%gears(wheel)%teeth) then
            pinion = contact%wheel_b
            wheel = contact%wheel_a
         end if
         ! both Young's moduli from E*, for the Poisson's ratio of metals
         stiffness = of_steel(gearbox%gears(pinion), gearbox%gears(wheel), reference_circle_load(gearbox, mesh, line_load)) &
                     *2*contact%e_star*(1 - usual_ratio**2)/steel
      end associate
   end function iso_stiffness

   !> Load tangential at the reference circles for one normal to the flanks, in its unit.   Valid: gears with basic racks
   pure real(wp) function reference_circle_load(gearbox, mesh, load) result(tangential)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp), intent(in) :: load

      associate (contact => gearbox%contacts(gearbox%first(mesh)))
         tangential = load*gearbox%pairs(mesh)%base_radius_a/gearbox%gears(contact%wheel_a)%reference_radius
      end associate
   end function reference_circle_load

   !> c' of solid wheels of steel [Pa].
   pure real(wp) function of_steel(a, b, line_load) result(stiffness)
      type(gear_t), intent(in) :: a, b
      real(wp), intent(in) :: line_load !! tangential [N/m]
      real(wp) :: flexibility, z1, z2

      z1 = a%teeth
      z2 = b%teeth
      associate (x1 => a%profile_shift, x2 => b%profile_shift)
         flexibility = 0.04723_wp + 0.15551_wp/z1 + 0.25791_wp/z2 - 0.00635_wp*x1 - 0.11654_wp*x1/z1 - 0.00193_wp*x2 &
                       - 0.24188_wp*x2/z2 + 0.00529_wp*x1**2 + 0.00182_wp*x2**2
      end associate
      stiffness = 1.0e9_wp/flexibility*measured*(of_rack(a) + of_rack(b))/2
      if (line_load < full_load) stiffness = stiffness*(line_load/full_load)**0.25_wp
   end function of_steel

   !> C_B, from the dedendum and pressure angle of the rack.
   pure real(wp) function of_rack(gear)
      type(gear_t), intent(in) :: gear

      associate (dedendum => (gear%reference_radius - gear%root_radius)/gear%normal_module + gear%generating_shift)
         of_rack = (1 + 0.5_wp*(1.2_wp - dedendum))*(1 - 0.02_wp*(20 - gear%pressure_angle*180/pi))
      end associate
   end function of_rack

end module evl_mesh_stiffness
