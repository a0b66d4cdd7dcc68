!> Largest root stress of a wheel in static equilibrium under the torques of all its meshes: reference of a dynamic factor.
!>
!> The stress is that of the teeth at the position where their own mesh alone stresses them most, under the loads of all meshes at
!> this position. The other meshes act on distant teeth, so that their part is small and varies slowly.
module evl_static_wheel_root
   use evl_coupled_pairs, only: most_pairs
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: nan, wp
   use evl_pair_point, only: by_a, by_b
   use evl_pressed_flank, only: find_pressed, pressed_t
   use evl_static_analysis, only: find_largest, measure_mesh, static_plan_t
   use evl_static_extremes, only: extremes_t
   use evl_static_mesh, only: solve_static, static_mesh_t, static_state
   use evl_static_mesh_setup, only: static_mesh_create
   use evl_static_roots, only: static_loads
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: nominal_start
   use evl_tooth_root, only: root_extremes, root_extremes_t, root_load_t
   implicit none (type, external)
   private

   public :: find_wheel_root

contains

   !> Equation RS8. Errors: those of `find_largest`.
   subroutine find_wheel_root(gearbox, wheel, first, pitches, torques, stress, status)
      type(gearbox_t), intent(in), target :: gearbox
      integer, intent(in) :: wheel
      integer, intent(in) :: first(:), pitches(:) !! of each mesh, as for `find_largest`
      real(wp), intent(in) :: torques(:)          !! of the driving wheel of each mesh, in its sense of rotation [N m]
      real(wp), intent(out) :: stress             !! NaN if no mesh loads the wheel [Pa]
      type(status_t), intent(inout) :: status
      type(extremes_t) :: extremes
      type(root_extremes_t) :: found
      integer :: m, side

      stress = nan
      do m = 1, size(gearbox%pairs)
         if (.not. belongs(gearbox, m, wheel) .or. abs(torques(m)) <= 0) cycle
         side = merge(by_a, by_b, gearbox%contacts(gearbox%first(m))%wheel_a == wheel)
         call find_largest(gearbox, m, first(m), pitches(m), torques(m), .true., extremes, status)
         if (has_failed(status)) exit
         if (extremes%largest_root(side)%tooth < 0) cycle
         call find_stress(gearbox, wheel, m, extremes%largest_root(side)%position, torques, found, status)
         if (has_failed(status)) exit
         if (.not. stress >= found%largest) stress = found%largest
      end do
      if (has_failed(status)) stress = nan
   end subroutine find_wheel_root

   !> Whether a wheel belongs to a mesh.
   pure logical function belongs(gearbox, mesh, wheel)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh, wheel

      associate (contact => gearbox%contacts(gearbox%first(mesh)))
         belongs = contact%wheel_a == wheel .or. contact%wheel_b == wheel
      end associate
   end function belongs

   !> Extremes of all loaded teeth of a wheel under the loads of all its meshes, where one mesh is at position x.
   subroutine find_stress(gearbox, wheel, mesh, x, torques, found, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: wheel, mesh
      real(wp), intent(in) :: x !! [pitches]
      real(wp), intent(in) :: torques(:)
      type(root_extremes_t), intent(out) :: found
      type(status_t), intent(inout) :: status
      type(root_load_t) :: loads(most_pairs*size(gearbox%pairs)), of_mesh(2, most_pairs)
      type(pressed_t) :: flank
      type(static_mesh_t) :: static_mesh
      type(static_plan_t) :: plan
      type(static_state) :: state
      real(wp) :: theta !! angle of the reference wheel [rad]
      integer :: m, n, n_of_mesh, pairs(most_pairs), side

      call find_pressed(gearbox, mesh, torques(mesh), 0.0_wp, flank, status)
      if (has_failed(status)) return
      associate (contact => gearbox%contacts(flank%contact), pair => gearbox%pairs(mesh))
         theta = (flank%rho_a + flank%turns*(x*pair%base_pitch) - nominal_start(contact, 0, 0))/contact%pair%advance
      end associate
      n = 0
      do m = 1, size(gearbox%pairs)
         if (.not. belongs(gearbox, m, wheel) .or. abs(torques(m)) <= 0) cycle
         call measure_mesh(gearbox, m, plan, status)
         if (.not. has_failed(status)) call find_pressed(gearbox, m, torques(m), 0.0_wp, flank, status)
         if (has_failed(status)) return
         associate (contact => gearbox%contacts(flank%contact), pair => gearbox%pairs(m))
            call static_mesh_create(contact, gearbox%compliances(contact%wheel_a), gearbox%compliances(contact%wheel_b), &
                                    gearbox%flanks(contact%i_flank)%flank%couples, plan%reach, 0.0_wp, static_mesh)
            call solve_static(static_mesh, nominal_start(contact, 0, 0) + contact%pair%advance*theta, &
                              abs(torques(m))/pair%base_radius_a, state, status)
            if (has_failed(status)) return
            call static_loads(contact, flank%turns, 0, state, of_mesh, pairs, n_of_mesh)
            side = merge(by_a, by_b, contact%wheel_a == wheel)
            loads(n + 1:n + n_of_mesh) = of_mesh(side, :n_of_mesh)
            n = n + n_of_mesh
         end associate
      end do
      call root_extremes(gearbox%root_stresses(wheel), loads(:n), found)
   end subroutine find_stress

end module evl_static_wheel_root
