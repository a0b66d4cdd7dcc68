!> Case parameters of the strength of a material: S-N line and permissible stresses. No equation of motion uses them.
module evl_strength_description
   use evl_kinds, only: wp
   use evl_row, only: positive, row_t, span_t, type_at_knots, type_block, type_choice, type_knots, type_number
   implicit none (type, external)
   private

   public :: sn_rows, strength_rows

   type(span_t), parameter :: stresses = span_t(1.0e6_wp, 5.0e9_wp) !! plastics to hardened steel, strongly notched to unnotched

   type(row_t), parameter :: &
      strength_rows(*) = [ &
      row_t("sn", type_block, "", "S-N line of the stress in the tooth root, for the damage by load cycles", holds="sn"), &
      row_t("sigma_FP", type_number, "Pa", "permissible tooth root stress; without it there is no safety factor S_F", &
            range=positive, plausible=stresses), &
      row_t("sigma_HP", type_number, "Pa", "permissible contact stress; without it there is no safety factor S_H", &
            range=positive, plausible=stresses)]

   type(row_t), parameter :: &
      sn_rows(*) = [ &
      row_t("stress_type", type_choice, "", "whether the stresses are ranges or amplitudes (half ranges) of cycles", &
            required=.true., words="range amplitude"), &
      row_t("cycles", type_knots, "", "cycles to failure at the points of the line, strictly increasing, at least two", &
            range=positive, required=.true.), &
      row_t("stress", type_at_knots, "Pa", "stresses of these points, strictly decreasing; logarithms are linear between them", &
            range=positive, required=.true., plausible=stresses), &
      row_t("slope_above", type_number, "", "slope k of N ~ stress^-k above the first point", range=positive, required=.true., &
            plausible=span_t(1.0_wp, 50.0_wp)), &
      row_t("slope_below", type_number, "", "slope k below the last point, or none: no damage there (endurance limit)", &
            range=positive, required=.true., words="none", plausible=span_t(1.0_wp, 100.0_wp))]

end module evl_strength_description
