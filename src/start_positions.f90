!> Positions and speeds that a start is made of.
module evl_start_positions
   use evl_closed_form, only: track_closed_form
   use evl_contact_point, only: contact_point
   use evl_gearbox, only: gearbox_local, gearbox_t, i_theta
   use evl_kinds, only: wp
   use evl_load, only: load_speed
   use evl_local_variables, only: n_local
   use evl_mesh, only: mesh_nominal_rho
   implicit none (type, external)
   private

   public :: closed_form_point, prescribed_speed, set_gaps

contains

   !> The speed that a load prescribes at t [rad/s].
   pure real(wp) function prescribed_speed(gearbox, load, t, integers) result(speed)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: load, integers(:)
      real(wp), intent(in) :: t

      associate (l => gearbox%loads(load))
         if (l%i_segment > 0) then
            speed = load_speed(l, t, integers(l%i_segment))
         else
            speed = load_speed(l, t, 0)
         end if
      end associate
   end function prescribed_speed

   !> Turn the wheels, from the reference wheel on, until every mesh has the given penetration.
   pure subroutine set_gaps(gearbox, penetrations, y)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: penetrations(:) !! of the meshes [m]
      real(wp), intent(inout) :: y(:)
      logical :: placed(size(gearbox%wheels)), found
      real(wp) :: psi(size(gearbox%wheels)), arc
      integer :: m

      placed = .false.
      placed(gearbox%reference) = .true.
      psi = 0
      found = .true.
      do while (found)
         found = .false.
         do m = 1, size(gearbox%meshes)
            associate (mesh => gearbox%meshes(m), a => gearbox%meshes(m)%wheel_a, b => gearbox%meshes(m)%wheel_b)
               if (placed(a) .eqv. placed(b)) cycle
               arc = -mesh%pair%sigma*penetrations(m) ! r_bA psi_A + r_bB psi_B
               if (placed(a)) then
                  psi(b) = (arc - mesh%pair%r_ba*psi(a))/mesh%pair%r_bb
               else
                  psi(a) = (arc - mesh%pair%r_bb*psi(b))/mesh%pair%r_ba
               end if
               placed(a) = .true.
               placed(b) = .true.
               found = .true.
            end associate
         end do
      end do
      do m = 1, size(gearbox%wheels)
         if (gearbox%wheels(m)%i_psi > 0) y(gearbox%wheels(m)%i_psi) = psi(m)
      end do
   end subroutine set_gaps

   !> The contact of a mesh by the closed form, whatever its tracking.
   subroutine closed_form_point(gearbox, index, y, turns, teeth, point)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index, turns, teeth
      real(wp), intent(in) :: y(:)
      type(contact_point), intent(out) :: point
      real(wp) :: q(n_local)

      associate (mesh => gearbox%meshes(index))
         call gearbox_local(gearbox, mesh, y, q)
         call track_closed_form(mesh%pair, mesh_nominal_rho(mesh, y(i_theta), turns, teeth), q, point)
      end associate
   end subroutine closed_form_point

end module evl_start_positions
