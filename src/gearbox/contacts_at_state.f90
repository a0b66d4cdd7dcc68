!> Tooth contacts of a gearbox at a state: positions and forces. All evaluations use these procedures.
module evl_contacts_at_state
   use evl_discrete_state, only: carries_points, flanks_of, take_mode, tooth_pair_of
   use evl_gearbox, only: gearbox_local, gearbox_t, i_turns
   use evl_kinds, only: wp
   use evl_local_variables, only: i_theta, n_local
   use evl_status, only: has_failed, status_t
   use evl_tangent_line, only: tangent_line_t
   use evl_tooth_contact, only: contact_state, flanks_apart, line_along, locate_contact, nominal_rho, touches, &
                                tracking_closed_form
   implicit none (type, external)
   private

   public :: find_tracked, flank_cache, look_at, look_at_forces, position_contact

   !> Data shared by the contacts of a flank at a state; set by the first contact that is evaluated.
   type :: flank_cache
      integer :: of = 0            !! contact evaluated before, whose local variables apply to all; 0: none
      type(tangent_line_t) :: line !! the line of action, where tracking is closed_form
   end type flank_cache

contains

   !> Evaluate contacts of one flank, all or the range of `loaded_pairs_range`: modes, positions, and forces of those that touch.
   subroutine look_at(gearbox, first, last, y, integers, reals, at, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: first, last          !! indices in the gearbox
      real(wp), intent(in) :: y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      type(contact_state), intent(inout) :: at(*) !! [contacts of the gearbox]
      type(status_t), intent(inout) :: status     !! code_out_of_domain if a law is not defined
      type(flank_cache) :: cache
      logical :: any_touch
      integer :: m

      any_touch = .false.
      do m = first, last
         call take_mode(gearbox, m, integers, reals, at(m)%mode)
         any_touch = any_touch .or. touches(at(m)%mode)
         call position_contact(gearbox, m, y, integers, cache, at)
      end do
      if (.not. any_touch) return
      associate (flank => gearbox%flanks(gearbox%contacts(first)%i_flank)%flank)
         call flank%laws(gearbox%contacts, first, last, at, status)
         if (.not. has_failed(status)) call flank%find_overlaps(gearbox%contacts, first, last, at)
      end associate
   end subroutine look_at

   !> Evaluate all contacts of one flank: whether they touch and, for those that do, modes, positions and all forces.
   subroutine look_at_forces(gearbox, first, last, y, integers, reals, cache, at, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: first, last
      real(wp), intent(in) :: y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      type(flank_cache), intent(out) :: cache     !! of the flank, if a contact touches
      type(contact_state), intent(inout) :: at(*)
      type(status_t), intent(inout) :: status     !! code_out_of_domain if a limit of a law or of the involutes is passed
      integer :: m

      do m = first, last
         at(m)%mode%flanks = flanks_of(gearbox%contacts(m), integers)
         if (.not. touches(at(m)%mode)) cycle
         call take_mode(gearbox, m, integers, reals, at(m)%mode)
         call position_contact(gearbox, m, y, integers, cache, at)
      end do
      if (cache%of == 0) return
      call gearbox%flanks(gearbox%contacts(first)%i_flank)%flank%forces(gearbox%contacts, first, last, at, status)
   end subroutine look_at_forces

   !> Compute the position of a contact.
   pure subroutine position_contact(gearbox, m, y, integers, cache, at)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: m
      real(wp), intent(in) :: y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      type(flank_cache), intent(inout) :: cache   !! of its flank
      type(contact_state), intent(inout) :: at(*) !! with its mode

      associate (contact => gearbox%contacts(m))
         if (cache%of == 0) then
            call gearbox_local(gearbox, contact, y, at(m)%q)
            if (contact%tracking == tracking_closed_form) call line_along(contact, at(m)%q, cache%line)
         else
            at(m)%q = at(cache%of)%q
         end if
         cache%of = m
         at(m)%rho_a0 = nominal_rho(contact, y(i_theta), integers(i_turns), at(m)%mode%tooth_pair)
         call locate_contact(contact, cache%line, at(m))
      end associate
   end subroutine position_contact

   !> Local variables and nominal radius of curvature of a contact whose tooth pair carries the tracked points of the flank. If it
   !> does not carry them, or tracking is off because the flanks are too far apart, the rows of the tracked variables are y' = 0.
   pure subroutine find_tracked(gearbox, index, y, integers, tracks, q, rho_a0)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index, integers(gearbox%n_integers)
      real(wp), intent(in) :: y(gearbox%n_states)
      logical, intent(out) :: tracks !! whether it carries tracked points; if false, q and rho_a0 are undefined
      real(wp), intent(out) :: q(n_local), rho_a0

      associate (contact => gearbox%contacts(index))
         tracks = carries_points(gearbox, index, integers)
         if (tracks) tracks = flanks_of(contact, integers) /= flanks_apart
         if (.not. tracks) return
         call gearbox_local(gearbox, contact, y, q)
         rho_a0 = nominal_rho(contact, y(i_theta), integers(i_turns), tooth_pair_of(contact, integers))
      end associate
   end subroutine find_tracked

end module evl_contacts_at_state
