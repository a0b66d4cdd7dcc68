!> Damping laws of a contact: normal force from the rate of penetration, positive if it pushes the flanks apart. A law extends
!> `damping_law_t` in a file of its own.
!>
!> The force of a law is that of overlapping flanks; the tooth contact ensures that a contact never pulls.
module evl_damping_law
   use evl_contact_context, only: contact_context, lane_context
   use evl_elastic_law, only: elastic_result
   use evl_force_law, only: force_law_t, no
   use evl_kinds, only: lanes, wp
   use evl_row, only: is_left_open, kind_t, short_length
   implicit none (type, external)
   private

   public :: damping_law_t, no_viscous, viscous_force, viscous_result

   !> A viscous force with its derivatives.
   type :: viscous_result
      real(wp) :: force     !! [N], over the whole width
      real(wp) :: d_h       !! dF/dh at constant radii of curvature [N/m]
      real(wp) :: d_rho_a, d_rho_b !! dF/drho_a, dF/drho_b at constant h [N/m]
      real(wp) :: d_h_dot   !! dF/dh' [N s/m]
      real(wp) :: d_elastic !! dF/d(elastic force); `viscous_force` adds it to the above derivatives
   end type viscous_result
   type(viscous_result), parameter :: no_viscous = viscous_result(0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp)

   type, abstract, extends(force_law_t) :: damping_law_t
   contains
      procedure(force_formula), deferred :: evaluate
      procedure, non_overridable :: force_lanes
      procedure, nopass :: has_sides => no
      procedure, nopass :: remembers => no !! whether it uses the approach speed at the last closing
      procedure :: left_to_mesh
      procedure :: refuse_mesh
      procedure :: complete
      procedure :: acting => itself
   end type damping_law_t

   abstract interface

      !> Force of overlapping flanks in n states with a common discrete state, and optionally all its derivatives, which are
      !> zero on entry. The elastic force is the only quantity of the elastic contact that a damping law may use.
      pure subroutine force_formula(self, n, h, h_dot, elastic, v0, side, force, d_h, d_h_dot, d_elastic)
         import :: damping_law_t, wp
         implicit none (type, external)
         class(damping_law_t), intent(in) :: self
         integer, intent(in) :: n                !! 1 or 8: loops over them are vectorised
         real(wp), intent(in) :: h(n), h_dot(n)  !! as in `contact_context`
         real(wp), intent(in) :: elastic(n)      !! elastic force there [N]
         real(wp), intent(in) :: v0              !! as in `contact_context`
         integer, intent(in) :: side             !! likewise
         real(wp), intent(out) :: force(n)       !! as in `viscous_result`
         real(wp), dimension(n), intent(inout), optional :: d_h, d_h_dot, d_elastic !! likewise
      end subroutine force_formula

   end interface

contains

   !> Viscous normal force with all derivatives. A law that refers to the mesh gives no force before it is complete.
   pure subroutine viscous_force(law, ctx, elastic, result)
      class(damping_law_t), intent(in) :: law
      type(contact_context), intent(in) :: ctx
      type(elastic_result), intent(in) :: elastic !! elastic force there
      type(viscous_result), intent(out) :: result
      real(wp), dimension(1) :: force, d_h, d_h_dot, d_elastic

      d_h = 0
      d_h_dot = 0
      d_elastic = 0
      call law%evaluate(1, [ctx%h], [ctx%h_dot], [elastic%force], ctx%v0, ctx%side, force, d_h, d_h_dot, d_elastic)
      result = viscous_result(force(1), d_h(1), 0.0_wp, 0.0_wp, d_h_dot(1), d_elastic(1))
      result%d_h = result%d_h + result%d_elastic*elastic%d_h
      result%d_rho_a = result%d_rho_a + result%d_elastic*elastic%d_rho_a
      result%d_rho_b = result%d_rho_b + result%d_elastic*elastic%d_rho_b
   end subroutine viscous_force

   !> The force in eight states.
   pure subroutine force_lanes(self, at, elastic, force)
      class(damping_law_t), intent(in) :: self
      type(lane_context), intent(in) :: at
      real(wp), intent(in) :: elastic(lanes) !! elastic force [N]
      real(wp), intent(out) :: force(lanes)  !! [N]

      call self%evaluate(lanes, at%h, at%h_dot, elastic, at%v0, at%side, force)
   end subroutine force_lanes

   !> Parameter that only the mesh can provide: its key, or that of the parameter that refers to the mesh; "" if there is none.
   pure function left_to_mesh(self) result(name)
      class(damping_law_t), intent(in) :: self
      character(len=short_length) :: name
      type(kind_t) :: info
      integer :: i

      name = ""
      call self%describe(info)
      if (.not. allocated(info%rows)) return
      do i = 1, size(info%rows)
         if (is_left_open(info%rows(i), self%parameters(i))) name = info%rows(i)%key
      end do
   end function left_to_mesh

   !> Error message if a mesh cannot provide it.
   pure subroutine refuse_mesh(self, reason, field, message)
      class(damping_law_t), intent(in) :: self
      character(len=*), intent(in) :: reason   !! why it cannot
      character(len=*), intent(out) :: field   !! in the block of the law; "": the block itself
      character(len=*), intent(out) :: message !! one sentence

      field = ""
      message = trim(self%left_to_mesh())//" is missing, and it does not follow from the mesh: "//reason//"; give " &
                //self%left_to_mesh()
   end subroutine refuse_mesh

   !> Set the parameters that were left open; overridden by laws that have such parameters.
   pure subroutine complete(self, stiffness, mass, h_0)
      class(damping_law_t), intent(inout) :: self
      real(wp), intent(in) :: stiffness         !! of one tooth pair at the nominal load, k [N/m]
      real(wp), intent(in) :: mass              !! that it accelerates, m [kg]
      real(wp), intent(in) :: h_0               !! penetration under the nominal load [m]
   end subroutine complete

   !> Law that acts in a mesh, once this one is complete.
   subroutine itself(self, stiffness, mass, law)
      class(damping_law_t), intent(in) :: self
      real(wp), intent(in) :: stiffness, mass !! as in `complete`
      class(damping_law_t), allocatable, intent(out) :: law

      allocate (law, source=self)
   end subroutine itself

end module evl_damping_law
