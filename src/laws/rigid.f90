!> What rigid contact says of itself as a law: it has no force of its own, its flanks are a constraint of the gearbox.
module evl_rigid
   use evl_kinds, only: wp
   use evl_law_info, only: law_info_t, law_parameter
   implicit none (type, external)
   private

   public :: rigid_law

contains

   !> The entry of the law table.
   pure type(law_info_t) function rigid_law() result(info)

      info%name = "rigid"
      info%description = "unilateral constraint; the normal force is its multiplier"
      info%source = "Kosenko & Gusev 2011, section 7.3; impacts after Newton"
      info%n_parameters = 2
      info%parameters(1) = law_parameter("restitution", "1", "rebound speed over approach speed of an impact", &
                                         default_value=0.0_wp, minimum=0.0_wp, maximum=1.0_wp)
      info%parameters(2) = law_parameter("rest_velocity", "m/s", "approach speed below which an impact does not rebound", &
                                         default_value=1.0e-6_wp, minimum=0.0_wp, minimum_open=.true.)
   end function rigid_law

end module evl_rigid
