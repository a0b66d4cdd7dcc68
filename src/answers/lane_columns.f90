!> The outputs that are told in eight states at once, and where their values go: one column of eight behind the other.
module evl_lane_columns
   use evl_kinds, only: lanes, wp
   use evl_output, only: output_t
   implicit none (type, external)
   private

   public :: find_lanes, n_lane_outputs, never_changes, none, not_in_lanes
   public :: of_angle, of_angle_deviation, of_speed, of_acceleration, of_load_torque, of_displacement, of_velocity
   public :: of_axle_acceleration, of_support_loss, of_theta, of_turns, of_kinetic, of_potential, of_dissipated, of_work
   public :: of_lag, of_penetration, of_gap, of_curvature, of_normal, of_friction, of_sliding, of_arm_a, of_arm_b, of_ratio
   public :: of_residual_a, of_residual_b, of_line_a, of_line_b, of_tooth_pair, of_touching, of_mode, of_gap_rate
   public :: of_deviation, of_loaded, of_torque_a, of_torque_b, of_friction_loss, of_damping_loss, of_curvature_loss
   public :: of_efficiency, of_coast_gap, of_coast_force, of_pair_normal, of_pair_friction, of_pair_position
   public :: of_pair_on_path, of_pair_number, of_pair_tooth_a, of_pair_tooth_b, of_pair_mode, of_pair_kind
   public :: of_pair_penetration, of_pair_sliding, of_pair_pressure
   public :: of_point_a, of_point_b, of_bearing_force, of_bearing_moment, of_shaft_torque, of_shaft_twist, of_shaft_loss
   public :: of_tracked
   public :: needs_no_places
   public :: put, put_same, put_whole

   integer, parameter :: none = -1 !! a column of an output that is not asked for

   !> What is told in lanes, as numbers, in the order of the table.
   enum, bind(c)
      enumerator :: of_theta = 1, of_turns, of_kinetic, of_potential, of_dissipated, of_work
      enumerator :: of_angle, of_angle_deviation, of_speed, of_acceleration, of_load_torque
      enumerator :: of_displacement, of_velocity, of_axle_acceleration, of_support_loss
      enumerator :: of_lag, of_penetration, of_gap, of_curvature, of_normal, of_friction, of_sliding, of_arm_a, of_arm_b
      enumerator :: of_ratio, of_residual_a, of_residual_b, of_line_a, of_line_b
      enumerator :: of_tooth_pair, of_touching, of_mode, of_gap_rate, of_deviation, of_loaded, of_torque_a, of_torque_b
      enumerator :: of_friction_loss, of_damping_loss, of_curvature_loss, of_efficiency, of_point_a, of_point_b
      enumerator :: of_pair_normal, of_pair_friction, of_pair_position, of_pair_pressure, of_pair_on_path, of_pair_number
      enumerator :: of_pair_tooth_a, of_pair_tooth_b, of_pair_mode, of_pair_kind, of_pair_penetration, of_pair_sliding
      enumerator :: of_coast_gap, of_coast_force, of_bearing_force, of_bearing_moment
      enumerator :: of_shaft_torque, of_shaft_twist, of_shaft_loss
   end enum
   integer, parameter :: n_lane_outputs = of_shaft_loss
   integer, parameter :: not_in_lanes = 0, never_changes = -1 !! other outputs
   !> The points of tracked contacts: there are none in closed form.
   integer, parameter :: of_tracked(*) = [of_ratio, of_residual_a, of_residual_b, of_line_a, of_line_b]

   !> What is known without the places of tooth pairs that do not touch.
   integer, parameter :: needs_no_places(*) = [of_angle, of_angle_deviation, of_speed, of_acceleration, of_load_torque, &
                                               of_displacement, of_velocity, of_axle_acceleration, of_support_loss, of_theta, &
                                               of_turns, of_kinetic, of_potential, of_dissipated, of_work, of_lag, of_normal, &
                                               of_friction, of_ratio, of_residual_a, of_residual_b, of_line_a, of_line_b, &
                                               of_tooth_pair, of_mode, of_loaded, of_torque_a, of_torque_b, of_friction_loss, &
                                               of_damping_loss, of_curvature_loss, of_coast_force, of_pair_normal, &
                                               of_pair_friction, of_pair_on_path, of_pair_number, of_pair_tooth_a, &
                                               of_pair_tooth_b, of_pair_mode, of_pair_kind, of_pair_pressure, of_bearing_force, &
                                               of_bearing_moment, of_shaft_torque, of_shaft_twist, of_shaft_loss]

   !> Their names, in that order.
   character(len=31), parameter :: lane_names(n_lane_outputs) = [character(len=31) :: &
                     "reference_angle", "reference_turns", "kinetic_energy", "potential_energy", "dissipated_energy", "load_work", &
                                            "angle", "angle_deviation", "angular_velocity", "angular_acceleration", "load_torque", &
                                          "centre_displacement", "centre_velocity", "centre_acceleration", "support_damping_loss", &
         "transmission_error", "penetration", "gap", "separation_curvature", "normal_force", "friction_force", "sliding_velocity", &
                                                                 "friction_arm_driving", "friction_arm_driven", &
       "gradient_ratio", "tracking_residual_driving", "tracking_residual_driven", "line_distance_driving", "line_distance_driven", &
             "tooth_pair", "in_contact", "contact_mode", "gap_rate", "flank_deviation", "pairs_in_contact", "mesh_torque_driving", &
                                    "mesh_torque_driven", "friction_loss", "contact_damping_loss", "curvature_loss", "efficiency", &
                                                                 "contact_point_driving", "contact_point_driven", &
              "pair_normal_force", "pair_friction_force", "pair_position", "pair_contact_pressure", "pair_on_path", "pair_number", &
                          "pair_tooth_driving", "pair_tooth_driven", "pair_contact_mode", "pair_contact_kind", "pair_penetration", &
                                           "pair_sliding_velocity", "coast_gap", "coast_force", "bearing_force", "bearing_moment", &
                                                                 "shaft_torque", "shaft_twist", "shaft_damping_loss"]

contains

   !> What the lanes tell of the rows of a table, one of the numbers above each.
   pure subroutine find_lanes(table, kinds)
      type(output_t), intent(in) :: table(:)
      integer, intent(out) :: kinds(size(table))
      integer :: i, next

      next = 1
      do i = 1, size(table)
         kinds(i) = merge(never_changes, not_in_lanes, table(i)%is_static)
         if (next > n_lane_outputs) cycle
         if (table(i)%name /= lane_names(next)) cycle
         kinds(i) = next
         next = next + 1
      end do
   end subroutine find_lanes

   !> One value.
   pure subroutine put(column, element, what, values)
      integer, intent(in) :: column, element !! column: of the output, or none
      real(wp), intent(in) :: what(lanes)
      real(wp), intent(inout) :: values(lanes, *)
      integer :: l

      if (column == none) return
      !$omp simd
      do l = 1, lanes
         values(l, column + element) = what(l)
      end do
   end subroutine put

   !> One that eight states share.
   pure subroutine put_same(column, element, what, values)
      integer, intent(in) :: column, element
      real(wp), intent(in) :: what
      real(wp), intent(inout) :: values(lanes, *)

      if (column /= none) values(:, column + element) = what
   end subroutine put_same

   !> A whole number that they share.
   pure subroutine put_whole(column, element, what, values)
      integer, intent(in) :: column, element, what
      real(wp), intent(inout) :: values(lanes, *)

      call put_same(column, element, real(what, wp), values)
   end subroutine put_whole

end module evl_lane_columns
