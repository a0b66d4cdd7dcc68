!> Watched outputs of a gearbox at a state, without the data that only other outputs need.
!>
!> There is one channel for each watched output of each mesh. For an output of tooth pairs the channel is the largest value of the
!> pairs. It has a kink where one pair takes over from another, but such a kink is no maximum.
!>
!> One table defines the watched outputs and the extremes reported over the run. An extreme belongs to an output of a mesh or of its
!> tooth pairs and has its unit and its symbol. Its name is that of the output with `_max` or `_min`; the time at which it is first
!> reached has the additional suffix `_time`.
module evl_extrema_monitor
   use evl_closed_form, only: transmission_error
   use evl_contact_curvature, only: contact_curvature, contact_pressure, pressure_at
   use evl_contact_friction, only: friction_factor
   use evl_contact_roots, only: contact_roots
   use evl_contacts_at_state, only: look_at
   use evl_discrete_state, only: leading_contact
   use evl_friction_law, only: n_sliding
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_events, only: turns_root
   use evl_kinds, only: wp
   use evl_local_variables, only: i_theta
   use evl_root_kinds, only: n_root_kinds
   use evl_status, only: has_failed, status_t
   use evl_tooth_contact, only: contact_state, edge_wheel, feet_of, flank_drive, flanks_loaded, flanks_off, locate_anywhere, &
                                tooth_contact_t, touches, tracking_closed_form, unclipped
   implicit none (type, external)
   private

   public :: channel_of, mesh_states, n_channels, n_cached, monitored_at, monitored_of_mesh
   public :: extreme_t, extremes_table, n_monitored_outputs
   public :: monitor_normal, monitor_friction, monitor_error, monitor_sliding, monitor_pair_normal, monitor_pair_pressure, &
             monitor_penetration

   integer, parameter :: n_cached = 3 !! reals stored for each tooth contact

   !> Watched outputs: those with one value per mesh, then those of tooth pairs.
   enum, bind(c)
      enumerator :: monitor_normal = 1, monitor_friction, monitor_error, monitor_sliding
      enumerator :: monitor_pair_normal, monitor_pair_pressure, monitor_penetration
   end enum

   !> One extreme; see `evl_extreme` in the C header.
   type :: extreme_t
      character(len=31) :: output = ""
      character(len=95) :: long_name = ""
      integer :: monitored = 0       !! one of the watched outputs
      logical :: is_largest = .true.
   end type extreme_t

   type(extreme_t), parameter :: extremes_table(*) = &
                                 [extreme_t("normal_force", &
                                            "largest normal force of all tooth pairs; rigid contact: between impacts", &
                                            monitor_normal), &
                                  extreme_t("pair_normal_force", &
                                            "largest normal force of a tooth pair; rigid contact: between impacts", &
                                            monitor_pair_normal), &
                                  extreme_t("friction_force", &
                                            "largest friction force on the driving wheel along t", &
                                            monitor_friction), &
                                  extreme_t("friction_force", &
                                            "smallest friction force on the driving wheel along t", &
                                            monitor_friction, .false.), &
                                  extreme_t("pair_contact_pressure", &
                                            "largest contact pressure of a tooth pair", &
                                            monitor_pair_pressure), &
                                  extreme_t("penetration", "largest penetration of the flanks", monitor_penetration), &
                                  extreme_t("transmission_error", "largest transmission error", monitor_error), &
                                  extreme_t("transmission_error", "smallest transmission error", monitor_error, .false.), &
                                  extreme_t("sliding_velocity", "largest sliding velocity along t", monitor_sliding), &
                                  extreme_t("sliding_velocity", "smallest sliding velocity along t", monitor_sliding, .false.)]

   integer, parameter :: n_monitored_outputs = maxval(extremes_table%monitored)

contains

   !> Number of channels.
   pure integer function n_channels(gearbox) result(n)
      type(gearbox_t), intent(in) :: gearbox

      n = n_monitored_outputs*size(gearbox%pairs)
   end function n_channels

   !> Channel of an output of a mesh.
   pure integer function channel_of(mesh, monitored) result(channel)
      integer, intent(in) :: mesh, monitored

      channel = n_monitored_outputs*(mesh - 1) + monitored
   end function channel_of

   !> All channels at a state; quantities of touching flanks are 0 if none touch. Optionally also the root functions, which use the
   !> same data. The pressure of a tooth pair far below the largest value so far may then be an estimate.
   subroutine monitored_at(gearbox, y, integers, reals, values, status, roots, near, highest, cached)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(out) :: values(n_channels(gearbox))
      type(status_t), intent(inout) :: status
      real(wp), intent(out), optional :: roots(gearbox%n_roots) !! as in `gearbox_roots`; requires the following arguments
      real(wp), intent(in), optional :: near                    !! above this fraction of the largest value so far all is exact
      real(wp), intent(in), optional :: highest(n_channels(gearbox)) !! the largest values so far
      real(wp), intent(inout), optional :: cached(n_cached, size(gearbox%contacts)) !! as in `estimate_curvature`
      type(contact_state) :: at(size(gearbox%contacts))
      integer :: directions(n_root_kinds)
      integer :: i, leader, m
      real(wp) :: normal

      values = 0
      do i = 1, size(gearbox%flanks)
         associate (flank => gearbox%flanks(i)%flank, first => gearbox%flanks(i)%flank%first, last => gearbox%flanks(i)%flank%last)
            call look_at(gearbox, first, last, y, integers, reals, at, status)
            if (has_failed(status)) return
            leader = 0
            if (gearbox%contacts(first)%flank == flank_drive) leader = leading_contact(gearbox, gearbox%contacts(first)%mesh, &
                                                                                       integers)
            do m = first, last
               associate (contact => gearbox%contacts(m))
                  if (present(roots)) call contact_roots(flank, gearbox%contacts(m), at(m), &
                                                         directions, roots(contact%i_root + 1))
                  if (m == leader) call monitor_mesh(contact, at(m), values)
                  if (touches(at(m)%mode)) call monitor_pair(contact, at(m), values)
                  if (at(m)%mode%flanks /= flanks_loaded) cycle
                  normal = unclipped(at(m))
                  if (.not. normal > 0) cycle
                  associate (channel => channel_of(contact%mesh, monitor_pair_pressure))
                     if (present(cached) .and. contact%deviates) then
                        call raise_pressure(contact, at(m), normal, near*highest(channel), cached(:, m), values(channel))
                     else
                        call raise(exact_pressure(contact, at(m), normal), values(channel))
                     end if
                  end associate
               end associate
            end do
         end associate
      end do
      if (present(roots)) roots(gearbox%n_roots) = turns_root(y(i_theta))
   end subroutine monitored_at

   !> Channels of one mesh, as in `monitored_at`.
   subroutine monitored_of_mesh(gearbox, mesh, y, integers, reals, values, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp), intent(in) :: y(gearbox%n_states)    !! of its `mesh_states`; the others are not used
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(inout) :: values(n_channels(gearbox)) !! those of the other meshes are unchanged
      type(status_t), intent(inout) :: status
      type(contact_state) :: at(size(gearbox%contacts))
      integer :: i, leader, m
      real(wp) :: normal

      values(channel_of(mesh, 1):channel_of(mesh, n_monitored_outputs)) = 0
      leader = leading_contact(gearbox, mesh, integers)
      do i = gearbox%contacts(gearbox%first(mesh))%i_flank, gearbox%contacts(gearbox%first(mesh + 1) - 1)%i_flank
         associate (first => gearbox%flanks(i)%flank%first, last => gearbox%flanks(i)%flank%last)
            call look_at(gearbox, first, last, y, integers, reals, at, status)
            if (has_failed(status)) return
            do m = first, last
               associate (contact => gearbox%contacts(m))
                  if (m == leader) call monitor_mesh(contact, at(m), values)
                  if (touches(at(m)%mode)) call monitor_pair(contact, at(m), values)
                  if (at(m)%mode%flanks /= flanks_loaded) cycle
                  normal = unclipped(at(m))
                  if (normal > 0) call raise(exact_pressure(contact, at(m), normal), &
                                             values(channel_of(mesh, monitor_pair_pressure)))
               end associate
            end do
         end associate
      end do
   end subroutine monitored_of_mesh

   !> States on which the contacts of a mesh depend, in ascending order.
   pure subroutine mesh_states(gearbox, mesh, states)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      integer, allocatable, intent(out) :: states(:)
      integer :: i, k, m

      states = [i_theta]
      do m = gearbox%first(mesh), gearbox%first(mesh + 1) - 1
         do k = 1, size(gearbox%contacts(m)%links)
            associate (state => gearbox%contacts(m)%links(k)%state)
               if (any(states == state)) cycle
               i = count(states < state)
               states = [states(:i), state, states(i + 1:)]
            end associate
         end do
      end do
   end subroutine mesh_states

   !> Contact pressure of a tooth pair under a force.
   real(wp) function exact_pressure(contact, at, normal) result(pressure)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      real(wp), intent(in) :: normal !! F_n > 0 [N]

      if (contact%deviates) then
         pressure = contact_pressure(contact, at%mode, normal, at%point, feet_of(at))
      else
         pressure = pressure_at(contact, normal, 1/at%point%rho_a + 1/at%point%rho_b)
      end if
   end function exact_pressure

   !> Channels of the contact that represents its mesh, whether it touches or not.
   pure subroutine monitor_mesh(contact, at, values)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(inout) :: at !! off the path its point is extrapolated along the involutes
      real(wp), intent(inout) :: values(:)

      if (at%mode%flanks == flanks_off .and. contact%tracking == tracking_closed_form) call locate_anywhere(contact, .false., at)
      associate (before => channel_of(contact%mesh, 0))
         values(before + monitor_error) = transmission_error(contact%pair, contact%axles_rest, at%q)
         values(before + monitor_sliding) = at%point%v_t
      end associate
   end subroutine monitor_mesh

   !> Channels of a tooth pair with overlapping flanks, except its pressure.
   pure subroutine monitor_pair(contact, at, values)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      real(wp), intent(inout) :: values(:)
      real(wp) :: factor, d_factor(n_sliding), normal
      integer :: before

      before = channel_of(contact%mesh, 0)
      if (contact%flank == flank_drive) call raise(at%point%h, values(before + monitor_penetration))
      if (at%mode%flanks /= flanks_loaded) return
      normal = unclipped(at)
      call raise(normal, values(before + monitor_pair_normal))
      values(before + monitor_normal) = values(before + monitor_normal) + normal
      if (contact%flank /= flank_drive .or. contact%friction%is_none()) return
      call friction_factor(contact, at%mode, at%point, normal, factor, d_factor)
      values(before + monitor_friction) = values(before + monitor_friction) - normal*factor
   end subroutine monitor_pair

   !> Raise the pressure of a mesh to that of a tooth pair. A pressure far below the limit is estimated, except for an edge, where
   !> the exact value is cheap.
   pure subroutine raise_pressure(contact, at, normal, limit, cached, pressure)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      real(wp), intent(in) :: normal !! F_n > 0 [N]
      real(wp), intent(in) :: limit  !! of estimates [Pa]
      real(wp), intent(inout) :: cached(n_cached)
      real(wp), intent(inout) :: pressure
      real(wp) :: estimate

      estimate = huge(limit)
      if (edge_wheel(at%mode) == 0) then
         call estimate_curvature(contact, at, cached, estimate)
         estimate = pressure_at(contact, normal, max(estimate, 0.0_wp))
      end if
      if (.not. estimate <= limit) estimate = contact_pressure(contact, at%mode, normal, at%point, feet_of(at))
      call raise(estimate, pressure)
   end subroutine raise_pressure

   !> Estimate of the sum of the curvatures of both flanks of a tooth pair, linear from the position of the last evaluation.
   pure subroutine estimate_curvature(contact, at, cached, curvature)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_state), intent(in) :: at
      real(wp), intent(inout) :: cached(n_cached) !! rho_A, curvature and slope there; zeros: none yet
      real(wp), intent(out) :: curvature
      real(wp), parameter :: reach = 1.0e-2_wp  !! range of a slope, relative to the radii of curvature; a tenth without slope
      real(wp) :: travel, far, slope, found

      travel = at%point%rho_a - cached(1)
      far = reach*min(abs(at%point%rho_a), abs(at%point%rho_b))
      if (.not. (cached(2) > 0 .and. abs(travel) <= merge(far, far/10, abs(cached(3)) > 0))) then
         found = contact_curvature(contact, at%mode, at%point, feet_of(at))
         slope = 0
         if (cached(2) > 0 .and. abs(travel) > 0 .and. abs(travel) < 2*far) slope = (found - cached(2))/travel
         cached = [at%point%rho_a, found, slope]
         travel = 0
      end if
      curvature = cached(2) + cached(3)*travel
   end subroutine estimate_curvature

   !> Maximum of two values. NaN is ignored, for example the pressure of flanks too concave to touch at one point.
   elemental subroutine raise(value, largest)
      real(wp), intent(in) :: value
      real(wp), intent(inout) :: largest

      if (value > largest) largest = value
   end subroutine raise

end module evl_extrema_monitor
