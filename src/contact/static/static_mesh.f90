!> Quasi-static mesh: penetration and forces of all tooth pairs of one flank, for a position of the driving wheel and a force along
!> the line of action.
!>
!> Axles are fixed. The driving wheel is at rho_A of pair 0. The driven wheel is where the torque about the driving axle is r_bA
!> times the force: dU/drho_A = F, including the contribution of friction of slowly rotating wheels. h is the transmission error,
!> the lag of the driven wheel along the line of action: rho_A + rho_B = rho + h.
module evl_static_mesh
   use evl_coupled_pairs, only: most_pairs, overlaps
   use evl_deviating_flanks, only: flank_value
   use evl_elastic_potential, only: elastic_potential, find_potential, force_derivatives, second_derivatives
   use evl_flank_deviation, only: flank_slope
   use evl_kinds, only: wp
   use evl_pair_compliance, only: assemble_compliance, pair_compliance
   use evl_pair_point, only: by_a, by_b, find_feet, pair_depth, pair_feet, penetrate, tip_t, turn_feet, zone_at
   use evl_quasi_static_friction, only: creep_friction, creep_t, relative_sliding
   use evl_status, only: code_no_solution, code_ok, code_out_of_domain, fail, has_failed, quantity, status_t
   use evl_wheel_compliance, only: wheel_compliance_t
   implicit none (type, external)
   private

   public :: loss_factor_at, pair_flanks_t, solve_static, static_mesh_t, static_state

   real(wp), parameter :: tolerance = 1.0e-13_wp !! of the force, relative
   integer, parameter :: most_turns = 100

   !> Deviations of the flanks of the pairs.
   type, abstract :: pair_flanks_t
   contains
      procedure(deviation_at), deferred :: at
   end type pair_flanks_t

   abstract interface

      !> Deviation of the flank of one wheel of a pair.
      pure subroutine deviation_at(self, wheel, pair, rho, beyond, value, turn)
         import :: pair_flanks_t, flank_slope, flank_value, wp
         implicit none (type, external)
         class(pair_flanks_t), intent(in) :: self
         integer, intent(in) :: wheel  !! by_a or by_b
         integer, intent(in) :: pair   !! number of the tooth pair
         real(wp), intent(in) :: rho   !! [m]
         logical, intent(in) :: beyond !! past the end of the flank: without the profile modifications, which are in the tip
         type(flank_value), intent(out) :: value
         type(flank_slope), intent(out) :: turn !! slope at the touching point, for a gap of second order
      end subroutine deviation_at

   end interface

   !> One flank of a mesh on fixed axles.
   type :: static_mesh_t
      type(tip_t) :: tips(2)
      real(wp) :: fillets(2) = 0.0_wp    !! radii of curvature where the fillets of A and B begin; 0: unknown [m]
      real(wp) :: line = 0.0_wp          !! rho [m]
      real(wp) :: base_pitch = 0.0_wp    !! [m]
      real(wp) :: e_star = 0.0_wp        !! effective modulus [Pa]
      real(wp) :: width = 0.0_wp         !! common face width [m]
      real(wp) :: k_difference = 0.0_wp  !! K_A - K_B [1/Pa]
      real(wp) :: turning_arm = 0.0_wp   !! factor of the product of both flanks' slopes [m]
      real(wp) :: reach = 0.0_wp         !! distance past the flank ends up to which pairs are included, with edge contact [m]
      logical :: is_drive = .true., couples = .true.
      class(wheel_compliance_t), allocatable :: a, b
      class(pair_flanks_t), allocatable :: flanks
      type(creep_t) :: creep
   end type static_mesh_t

   !> Quasi-static state of such a mesh.
   type :: static_state
      real(wp) :: h = 0.0_wp                     !! transmission error [m]
      real(wp) :: h_0 = 0.0_wp                   !! without load [m]
      real(wp) :: stiffness = 0.0_wp             !! dF/dh at constant position of the driving wheel [N/m]
      integer :: n = 0                           !! number of pairs that can touch
      integer :: numbers(most_pairs) = 0
      type(pair_feet) :: feet(most_pairs)
      type(pair_depth) :: depths(most_pairs)
      type(flank_value) :: flanks(2, most_pairs)
      type(elastic_potential) :: potential
      real(wp) :: overlap(most_pairs) = 0.0_wp   !! penetration less the gap opened by the other pairs: > 0 for a loaded pair [m]
      real(wp) :: friction(most_pairs) = 0.0_wp  !! along t on A [N]
      real(wp) :: held = 0.0_wp                  !! torque about the driving axle over its base radius [N]
   end type static_state

contains

   !> Solve for the state of the mesh under a force. Equation SA1.
   subroutine solve_static(mesh, rho_a, force, state, status, guess)
      type(static_mesh_t), intent(in) :: mesh
      real(wp), intent(in) :: rho_a !! of pair 0 [m]
      real(wp), intent(in) :: force !! torque about the driving axle over its base radius, > 0 [N]
      type(static_state), intent(out) :: state
      type(status_t), intent(inout) :: status
      real(wp), intent(in), optional :: guess !! transmission error at a neighbouring position [m]
      real(wp) :: low, high, h, off, h_0
      integer :: turn

      call find_free_play(mesh, rho_a, h_0, status)
      if (has_failed(status)) return
      low = h_0
      high = h_0
      h = h_0 + 40*force/(mesh%e_star*mesh%width) ! approximate deflection of two teeth
      if (present(guess)) h = merge(guess, h, guess > h_0)
      do turn = 1, most_turns
         call look(mesh, rho_a, h, state, status)
         if (has_failed(status)) return
         off = force - state%held
         if (abs(off) <= tolerance*force) exit
         if (off > 0) then
            low = h
         else
            high = h
         end if
         if (state%stiffness > 0) h = h + off/state%stiffness
         if (high > low) then ! the force is bracketed
            if (.not. state%stiffness > 0 .or. h <= low .or. h >= high) h = (low + high)/2
            if (.not. (low < h .and. h < high)) exit ! no number in between: the force jumps, at an end of a path
         else
            h = max(h, low + abs(low - h_0)/2)
         end if
      end do
      if (turn > most_turns) call fail(status, code_no_solution, "no transmission error was found under "//quantity(force, "N") &
                                       //" at rho_A = "//quantity(rho_a, "m"))
      state%h_0 = h_0
      if (.not. has_failed(status)) call check(mesh, state, status)
      if (.not. has_failed(status)) call check_neighbours(mesh, rho_a, state, status)
   end subroutine solve_static

   !> Transmission error at which the first pair touches.
   subroutine find_free_play(mesh, rho_a, h_0, status)
      type(static_mesh_t), intent(in) :: mesh
      real(wp), intent(in) :: rho_a
      real(wp), intent(out) :: h_0
      type(status_t), intent(inout) :: status
      type(pair_feet) :: feet
      type(flank_value) :: flanks(2)
      type(pair_depth) :: depth
      real(wp) :: h, step
      integer :: first, last, last_there, k, turn

      h_0 = huge(h_0)
      call pairs_within_reach(mesh, rho_a, 0.0_wp, first, last)
      do k = first, last + 1 ! deviations may bring the next pair onto its path, or prevent the last one from reaching it
         h = 0
         do turn = 1, most_turns
            call put(mesh, k, rho_a, h, feet, flanks, depth)
            step = -depth%h/depth%d_h(by_b)
            h = h + step
            if (abs(step) <= tolerance*mesh%base_pitch*epsilon(h)**0.25_wp .or. .not. feet%exists) exit
         end do
         call pairs_within_reach(mesh, rho_a, h, first, last_there)
         if (turn <= most_turns .and. feet%exists .and. depth%d_h(by_b) > 0 .and. k <= last_there) h_0 = min(h_0, h)
      end do
      if (h_0 < huge(h_0)) return
      call fail(status, code_no_solution, "no tooth pair can touch at rho_A = "//quantity(rho_a, "m"))
   end subroutine find_free_play

   !> Numbers of the pairs that can touch.
   pure subroutine pairs_within_reach(mesh, rho_a, h, first, last)
      type(static_mesh_t), intent(in) :: mesh
      real(wp), intent(in) :: rho_a, h
      integer, intent(out) :: first, last

      associate (ends => mesh%tips%edge%rho_end + mesh%reach, p => mesh%base_pitch)
         first = ceiling((rho_a - ends(by_a))/p)
         last = floor((rho_a + ends(by_b) - mesh%line - h)/p)
      end associate
   end subroutine pairs_within_reach

   !> Contact position and deviations of one pair.
   pure subroutine put(mesh, k, rho_a, h, feet, flanks, depth)
      type(static_mesh_t), intent(in) :: mesh
      integer, intent(in) :: k
      real(wp), intent(in) :: rho_a, h
      type(pair_feet), intent(out) :: feet
      type(flank_value), intent(out) :: flanks(2)
      type(pair_depth), intent(out) :: depth
      type(flank_slope) :: turns(2)
      real(wp) :: rho(2)
      integer :: w

      rho(by_a) = rho_a - k*mesh%base_pitch
      rho(by_b) = mesh%line + h - rho(by_a)
      call find_feet(mesh%tips, zone_at(mesh%tips, rho(by_a), rho(by_b)), rho(by_a), rho(by_b), mesh%line, feet)
      do w = by_a, by_b
         call mesh%flanks%at(w, k, merge(rho(w), feet%foot(w), w == feet%wheel), w == feet%wheel, flanks(w), turns(w))
      end do
      call turn_feet(mesh%turning_arm, turns, feet, flanks)
      call penetrate(feet, flanks, depth)
      ! rho_A + rho_B - rho equals h except for rounding
      depth%h = depth%h + (h - (rho(by_a) + rho(by_b) - mesh%line))
   end subroutine put

   !> All pairs at a transmission error, with their forces. Equation SA1.
   subroutine look(mesh, rho_a, h, state, status)
      type(static_mesh_t), intent(in) :: mesh
      real(wp), intent(in) :: rho_a, h
      type(static_state), intent(inout) :: state
      type(status_t), intent(inout) :: status
      type(pair_compliance) :: compliance
      real(wp) :: second(3, 3)
      integer :: code, first, i, last

      call pairs_within_reach(mesh, rho_a, h, first, last)
      state%n = max(last - first + 1, 0)
      state%h = h
      if (state%n > most_pairs) then
         call fail(status, code_out_of_domain, "more tooth pairs can touch at once than the program can couple")
         return
      end if
      associate (n => state%n)
         do i = 1, n
            state%numbers(i) = first + i - 1
            call put(mesh, state%numbers(i), rho_a, h, state%feet(i), state%flanks(:, i), state%depths(i))
            if (.not. state%feet(i)%exists) state%depths(i)%h = min(state%depths(i)%h, 0.0_wp)
         end do
         call assemble_compliance(mesh%a, mesh%b, mesh%k_difference, mesh%is_drive, mesh%couples, n, state%numbers(:n), &
                                  state%feet(:n), compliance)
         call find_potential(n, state%depths(:n), state%feet(:n), compliance, mesh%e_star, mesh%width, .true., state%potential, &
                             code)
         if (code /= code_ok) then
            call fail(status, code, "the forces of the tooth pairs have no solution at a transmission error of "//quantity(h, "m") &
                      //": the compliances of the wheels are inconsistent")
            return
         end if
         call overlaps(n, state%depths(:n)%h, compliance%c, state%potential%solution, state%overlap)
         second = second_derivatives(n, state%depths(:n), state%feet(:n), compliance, mesh%e_star, mesh%width, state%potential)
         state%stiffness = second(by_a, by_b)
         state%held = state%potential%gradient(by_a)
         if (abs(mesh%creep%speed) > 0) call add_friction(mesh, compliance, state)
      end associate
   end subroutine look

   !> Add the contribution of friction to the torque. Equation SA1.
   pure subroutine add_friction(mesh, compliance, state)
      type(static_mesh_t), intent(in) :: mesh
      type(pair_compliance), intent(in) :: compliance
      type(static_state), intent(inout) :: state
      real(wp) :: change(most_pairs, 3), held, d_held
      integer :: i

      associate (n => state%n, force => state%potential%solution%force, b => mesh%width)
         change = force_derivatives(n, state%depths(:n), state%feet(:n), compliance, mesh%e_star, state%potential)
         do i = 1, n
            call creep_friction(mesh%creep, state%feet(i), state%flanks(:, i), state%depths(i), b*force(i), b*change(i, by_b), &
                                state%friction(i), held, d_held)
            state%held = state%held + held
            state%stiffness = state%stiffness + d_held
         end do
      end associate
   end subroutine add_friction

   !> Loss factor at a position: sum of the normal forces times sliding velocities, over the power of the driving wheel; corner
   !> contact is included. Equation SA6.
   pure real(wp) function loss_factor_at(mesh, state, force) result(factor)
      type(static_mesh_t), intent(in) :: mesh
      type(static_state), intent(in) :: state
      real(wp), intent(in) :: force !! total tooth force [N]
      integer :: i

      factor = 0
      do i = 1, state%n
         if (state%potential%solution%force(i) > 0) &
            factor = factor + mesh%width*state%potential%solution%force(i)/force &
                     *abs(relative_sliding(mesh%creep, state%feet(i), state%flanks(:, i), state%depths(i)))
      end do
   end function loss_factor_at

   !> Fail if pairs carry load where no model exists.
   subroutine check(mesh, state, status)
      type(static_mesh_t), intent(in) :: mesh
      type(static_state), intent(in) :: state
      type(status_t), intent(inout) :: status
      integer :: i, mate

      do i = 1, state%n
         associate (feet => state%feet(i))
            if (.not. state%potential%solution%force(i) > 0 .or. feet%wheel == 0) cycle
            mate = by_a + by_b - feet%wheel
            if (feet%foot(mate) < mesh%fillets(mate)) then
               call fail(status, code_out_of_domain, &
                         "a tip edge of the "//trim(name_of(feet%wheel))//" wheel touches the fillet of the " &
                         //trim(name_of(mate))//" wheel, at a radius of curvature of "//quantity(feet%foot(mate), "m") &
                         //", which begins at "//quantity(mesh%fillets(mate), "m")//"; relieve the tips, or reduce the load")
            else if (all(feet%rho(:by_b) > mesh%tips%edge%rho_end)) then
               call fail(status, code_out_of_domain, "a tooth pair is past both ends of its path of contact and carries force" &
                         //": the teeth deflect by more than the length of the path")
            end if
         end associate
      end do
   end subroutine check

   !> Fail if pairs beyond the reach of edges would also carry load.
   subroutine check_neighbours(mesh, rho_a, state, status)
      type(static_mesh_t), intent(in) :: mesh
      real(wp), intent(in) :: rho_a
      type(static_state), intent(in) :: state
      type(status_t), intent(inout) :: status
      type(pair_feet) :: feet(most_pairs + 1)
      type(flank_value) :: flanks(2)
      type(pair_depth) :: depth
      type(pair_compliance) :: compliance
      integer :: numbers(most_pairs + 1), side

      if (.not. mesh%reach > 0) return
      associate (n => state%n, force => state%potential%solution%force)
         feet(:n) = state%feet(:n)
         numbers(:n) = state%numbers(:n)
         do side = -1, 1, 2
            numbers(n + 1) = merge(numbers(1), numbers(n), side < 0) + side
            call put(mesh, numbers(n + 1), rho_a, state%h, feet(n + 1), flanks, depth)
            if (.not. (feet(n + 1)%exists .and. depth%h > 0)) cycle
            if (n < most_pairs) then
               call assemble_compliance(mesh%a, mesh%b, mesh%k_difference, mesh%is_drive, mesh%couples, n + 1, numbers(:n + 1), &
                                        feet(:n + 1), compliance)
               if (depth%h <= dot_product(compliance%c(n + 1, :n), force(:n))) cycle
            end if
            call fail(status, code_out_of_domain, "another tooth pair would carry with a tip edge " &
                      //quantity(mesh%reach/mesh%base_pitch, "")//" pitches off its path of contact: the teeth deflect too" &
                      //" much for their size; reduce the load")
            return
         end do
      end associate
   end subroutine check_neighbours

   !> Name of a wheel for messages.
   pure character(len=7) function name_of(wheel)
      integer, intent(in) :: wheel

      name_of = merge("driving", "driven ", wheel == by_a)
   end function name_of

end module evl_static_mesh
