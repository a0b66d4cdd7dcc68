!> Root stress of a wheel in a mesh under one load: at the outer point of single contact, with the nominal line load. Nominal stress
!> of ISO 6336-3 beside the stress of finite elements.
module evl_mesh_root_stress
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: nan, wp
   use evl_mesh_stiffness, only: nominal_line_load
   use evl_nominal_root_stress, only: nominal_root_stress, nominal_root_t
   use evl_root_stress, only: fillet_extremes, fillet_extremes_t, right_flank, root_stress
   use evl_stress_samples, only: n_arcs
   use evl_tooth_outline, only: outline_of_gear
   implicit none (type, external)
   private

   public :: mesh_root_nominal, mesh_root_stress, mesh_root_t

   real(wp), parameter :: most_single = 2.0_wp !! contact ratio below which a single pair carries the load somewhere

   !> Stresses over the line load times the module are coefficients [1].
   type :: mesh_root_t
      logical :: exists = .false.       !! the wheel has root stress
      real(wp) :: line_load = 0.0_wp    !! normal to the flank [N/m]
      real(wp) :: rho = nan             !! outer point of single contact; NaN: there is none [m]
      type(nominal_root_t) :: nominal   !! factors there
      real(wp) :: nominal_stress = nan, nominal_coefficient = nan       !! NaN where the factors are not valid [Pa], [1]
      real(wp) :: tension = nan, tension_coefficient = nan              !! largest stress of the finite elements [Pa], [1]
      real(wp) :: compression = nan, compression_coefficient = nan      !! least one, negative [Pa], [1]
   end type mesh_root_t

contains

   !> Root stress of the driving or driven wheel of a mesh; initial values without finite elements. Equation RS1.
   subroutine mesh_root_stress(gearbox, mesh, is_driven, root)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      logical, intent(in) :: is_driven
      type(mesh_root_t), intent(out) :: root
      type(fillet_extremes_t) :: tension, compression
      real(wp), dimension(0:n_arcs) :: right, left
      integer :: wheel

      if (.not. allocated(gearbox%root_stresses)) return
      associate (contact => gearbox%contacts(gearbox%first(mesh)))
         wheel = merge(contact%wheel_b, contact%wheel_a, is_driven)
      end associate
      if (.not. gearbox%root_stresses(wheel)%exists) return
      call mesh_root_nominal(gearbox, mesh, is_driven, root)
      root%exists = .true.
      if (.not. root%rho > 0) return
      associate (stress => gearbox%root_stresses(wheel))
         call root_stress(stress, right_flank, root%rho, 0, right, left)
         tension = fillet_extremes(stress, right)
         compression = fillet_extremes(stress, left)
         root%tension_coefficient = stress%normal_module*tension%largest
         root%compression_coefficient = stress%normal_module*compression%least
         root%tension = tension%largest*root%line_load
         root%compression = compression%least*root%line_load
      end associate
   end subroutine mesh_root_stress

   !> Its load and nominal stress, which require no finite elements. Equations RS6, RS7.
   subroutine mesh_root_nominal(gearbox, mesh, is_driven, root)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      logical, intent(in) :: is_driven
      type(mesh_root_t), intent(out) :: root

      associate (contact => gearbox%contacts(gearbox%first(mesh)), pair => gearbox%pairs(mesh))
         root%line_load = nominal_line_load(gearbox, mesh)
         if (.not. pair%contact_ratio < most_single) return
         ! one base pitch from the other tooth's tip; the own tip, if the path is shorter
         root%rho = min(pair%rho - merge(pair%rho_tip_a, pair%rho_tip_b, is_driven) + pair%base_pitch, &
                        merge(pair%rho_tip_b, pair%rho_tip_a, is_driven))
         associate (gear => gearbox%gears(merge(contact%wheel_b, contact%wheel_a, is_driven)))
            if (gear%teeth == 0 .or. gear%is_undercut .or. gear%is_internal) return
            root%nominal = nominal_root_stress(outline_of_gear(gear, real(gear%rack_root_radius, wp)), &
                                               root%rho/gear%normal_module)
            if (root%nominal%is_valid) root%nominal_coefficient = root%nominal%stress
            root%nominal_stress = root%nominal_coefficient*root%line_load/gear%normal_module
         end associate
      end associate
   end subroutine mesh_root_nominal

end module evl_mesh_root_stress
