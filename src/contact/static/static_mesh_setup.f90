!> Set up the quasi-static mesh (evl_static_mesh) of a tooth contact: its flank with the tips of both wheels, deviations and
!> compliance.
!>
!> The coast flank is treated as the mirror image of a drive flank with reversed pair numbers: pair k here is pair -k of the
!> contact.
module evl_static_mesh_setup
   use evl_deviating_flanks, only: flank_value, turning_arm
   use evl_flank_deviation, only: deviation_branch, deviation_on, deviation_zone, flank_branch, flank_deviation_t, flank_slope, &
                                  slope_on, zone_end
   use evl_kinds, only: pi, wp
   use evl_pair_point, only: by_a, by_b
   use evl_static_mesh, only: pair_flanks_t, static_mesh_t
   use evl_tooth_contact, only: flank_drive, tooth_contact_t, tooth_of_a, tooth_of_b
   use evl_wheel_compliance, only: wheel_compliance_t
   implicit none (type, external)
   private

   public :: static_mesh_create

   !> Flanks of two wheels with their deviations.
   type, extends(pair_flanks_t) :: two_wheels_t
      type(flank_deviation_t) :: deviations(2)
      integer :: first(2) = 0 !! teeth in pair 0
      integer :: step(2) = 0  !! difference to the teeth of the next pair
      integer :: side = 1
   contains
      procedure :: at
   end type two_wheels_t

contains

   !> Set up the mesh. Axles are at their reference positions.
   subroutine static_mesh_create(contact, a, b, couples, reach, speed, mesh)
      type(tooth_contact_t), intent(in) :: contact !! a contact of the flank
      type(wheel_compliance_t), intent(in) :: a, b !! compliance of the driving and the driven wheel
      logical, intent(in) :: couples               !! pairs deflect under each other's loads
      real(wp), intent(in) :: reach                !! distance past the path up to which pairs count, with edge contact; 0: none [m]
      real(wp), intent(in) :: speed                !! of the driving wheel in its sense of rotation, for friction; 0: none [rad/s]
      type(static_mesh_t), intent(out) :: mesh
      type(two_wheels_t), allocatable :: flanks
      integer :: next

      next = merge(1, -1, contact%flank == flank_drive)
      associate (pair => contact%pair)
         mesh%line = pair%rho_0
         mesh%base_pitch = contact%base_pitch
         mesh%e_star = contact%e_star
         mesh%width = contact%width
         ! shares of the wheels as in (5.57); without compliance of the wheels as in Johnson's law
         if (a%exists .or. b%exists) mesh%k_difference = 2*(pair%share_a - pair%share_b)/(pi*contact%e_star)
         mesh%turning_arm = turning_arm(pair)
         mesh%fillets = contact%fillets
         mesh%couples = couples
         mesh%reach = reach
         mesh%tips = contact%tips
         allocate (mesh%a, source=a)
         allocate (mesh%b, source=b)
         allocate (flanks)
         flanks%deviations(by_a) = contact%deviation_a
         flanks%deviations(by_b) = contact%deviation_b
         flanks%first = [tooth_of_a(contact, 0), tooth_of_b(contact, 0)]
         flanks%step = [tooth_of_a(contact, next), tooth_of_b(contact, next)] - flanks%first
         flanks%side = nint(pair%sigma)
         call move_alloc(flanks, mesh%flanks)
         mesh%creep%speed = merge(next*speed, 0.0_wp, contact%friction%acts())
         mesh%creep%r_b = [pair%r_ba, pair%r_bb]
         mesh%creep%width = contact%width
         mesh%creep%e_star = contact%e_star
         mesh%creep%shares = [pair%share_a, pair%share_b]
         allocate (mesh%creep%law, source=contact%friction)
      end associate
   end subroutine static_mesh_create

   !> Deviation of the flank of one wheel. Past its end, pitch errors and runout still apply.
   pure subroutine at(self, wheel, pair, rho, beyond, value, turn)
      class(two_wheels_t), intent(in) :: self
      integer, intent(in) :: wheel, pair
      real(wp), intent(in) :: rho
      logical, intent(in) :: beyond
      type(flank_value), intent(out) :: value
      type(flank_slope), intent(out) :: turn
      type(flank_branch) :: branch
      integer :: zone

      value = flank_value()
      associate (deviation => self%deviations(wheel))
         if (.not. deviation%exists) return
         zone = zone_end
         if (.not. beyond) zone = deviation_zone(deviation, rho)
         branch = deviation_branch(deviation, self%first(wheel) + pair*self%step(wheel), self%side, zone)
         if (branch%slopes) call slope_on(deviation, zone, branch, rho, turn)
      end associate
      call deviation_on(branch, rho, value%e, value%de, value%d2e)
   end subroutine at

end module evl_static_mesh_setup
