!> Table of all rows: the schema of the case file, block by block. Rows of a component are defined in the component's module.
module evl_case_table
   use evl_accelerometer, only: accelerometer_rows
   use evl_compliance_description, only: compliance_rows
   use evl_damping_law, only: damping_law_t
   use evl_deviation_description, only: accuracy_rows, eccentricity_rows, relief_rows
   use evl_elastic_law, only: elastic_law_t
   use evl_event_log, only: list_event_kinds
   use evl_friction_law, only: friction_law_t
   use evl_gear, only: cutter_rows, fillet_rows, rack_rows
   use evl_gearbox_description, only: lubricant_rows, material_rows, mesh_rows, wheel_rows
   use evl_gearbox_initial, only: initial_rows
   use evl_housing_description, only: housing_rows, mount_rows
   use evl_housing_motion, only: motion_rows
   use evl_kind_finder, only: kind_finder
   use evl_kinds, only: wp
   use evl_law_table, only: damping_law, elastic_law, friction_law
   use evl_load, only: load_t
   use evl_load_kinds, only: load_of_kind
   use evl_row, only: join_words, kind_t, not_negative, positive, range_t, read_default, row_t, span_t, type_block, &
                      type_choice, type_integer, type_list, type_map, type_number, type_reference, type_text, type_triple
   use evl_shaft, only: shaft_rows
   use evl_strength_description, only: sn_rows, strength_rows
   use evl_support, only: support_kind_t
   use evl_support_kinds, only: support_of_kind
   implicit none (type, external)
   private

   public :: case_table, kinds_of

   type(range_t), parameter :: some_outputs = range_t(1.0_wp, 1000000.0_wp) !! per pitch or turn

   type(row_t), parameter :: case_rows(*) = [ &
                             row_t("format", type_integer, "", "version of this format: 1", required=.true.), &
                             row_t("title", type_text, "", "title of the case and its history", default="''"), &
                          row_t("materials", type_map, "", "materials by name", range=range_t(1.0_wp, 1000.0_wp), required=.true., &
                                   holds="material"), &
                             row_t("wheels", type_list, "", "wheels (gears and discs), in the order of the history", &
                                   range=range_t(2.0_wp, 1000.0_wp), &
                                   required=.true., holds="wheel"), &
                             row_t("meshes", type_list, "", "gear meshes between wheels", &
                                   range=range_t(1.0_wp, 1000.0_wp), required=.true., &
                                   holds="mesh"), &
                             row_t("shafts", type_list, "", "shafts that connect wheels on one axis", &
                                   range=range_t(0.0_wp, 1000.0_wp), default="[]", &
                                   holds="shaft"), &
                             row_t("lubricant", type_block, "", "lubricant of all meshes, for friction laws that need it", &
                                   holds="lubricant"), &
                             row_t("gravity", type_triple, "m/s2", "gravitational acceleration, ground frame", &
                                   default="[0, 0, 0]", &
                                   plausible=span_t(0.0_wp, 100.0_wp)), &
                             row_t("housing", type_block, "", "motion of the housing", default="{kind: fixed}", holds="housing"), &
                             row_t("simulation", type_block, "", "time span, outputs and" &
                                   //" integrator", required=.true., holds="simulation")]

   type(row_t), parameter :: &
      simulation_rows(*) = [ &
      row_t("duration", type_number, "s", "simulated time, from 0", range=positive, required=.true., &
            plausible=span_t(1.0e-8_wp, 1.0e5_wp)), &
      row_t("output_interval", type_number, "s", "time between outputs, at most the duration; alternative to `output`", &
            range=positive, plausible=span_t(1.0e-10_wp, 1.0e3_wp)), &
      row_t("output", type_block, "", "output positions: one of interval, per_pitch and per_turn", holds="output"), &
      row_t("outputs", type_text, "", "variables of the history: names of variables and groups, separated by commas; all if" &
            //" not given"), &
      row_t("tolerance", type_number, "", "permitted error per step, relative to the scale of each state", &
            range=range_t(1e-14_wp, 0.001_wp), default="1e-9", variants="-accuracy"), &
      row_t("accuracy", type_number, "", "permitted error of the penetrations relative to the largest one; replaces tolerance," &
            //" which follows from it for each integrator", range=range_t(1e-9_wp, 0.001_wp)), &
      row_t("initial", type_block, "", "state at time 0", default="{kind: rest}", holds="initial"), &
      row_t("metrics", type_block, "", "metrics of the case over a window of whole pitches or revolutions; none if" &
            //" not given", holds="metrics"), &
      row_t("integrator", type_choice, "", &
            "ida (SUNDIALS): all cases; radau: the default for closed_form tracking without rigid contact and without a mounted" &
            //" housing", words="ida radau"), &
      row_t("max_step", type_number, "s", "largest step of the integrator, or none: limited by the error only; if not given," &
            //" none with radau and 0.02 with ida", range=positive, words="none", &
            plausible=span_t(1.0e-10_wp, 1.0e3_wp)), &
      row_t("max_steps", type_number, "", "largest number of steps of a run, 1e9 if not given, or none: no limit; a thousandth" &
            //" of it, at least 1e6, limits the steps within a millionth of the run", &
            range=range_t(1.0_wp, 1.0e15_wp), words="none")]

   type(row_t), parameter :: output_rows(*) = [ &
                             row_t("interval", type_number, "s", "the same as `output_interval`", range=positive, &
                                   plausible=span_t(1.0e-10_wp, 1.0e3_wp)), &
                             row_t("per_pitch", type_integer, "", "outputs per pitch of a mesh", range=some_outputs), &
                             row_t("mesh", type_reference, "", "the mesh whose driving wheel defines the pitches", holds="meshes", &
                                   variants="+per_pitch"), &
                             row_t("per_turn", type_integer, "", "outputs per revolution of a wheel", range=some_outputs), &
                             row_t("wheel", type_reference, "", "the wheel that defines the revolutions", &
                                   holds="wheels", variants="+per_turn")]

   type(row_t), parameter :: &
      metrics_rows(*) = [ &
      row_t("from", type_number, "s", "the window starts with the first whole period after this time; half of the duration if" &
            //" not given", range=not_negative, plausible=span_t(0.0_wp, 1.0e5_wp)), &
      row_t("to", type_number, "s", "the window ends with the last whole period before this time; the end of the case if" &
            //" not given", range=positive, &
            plausible=span_t(1.0e-8_wp, 1.0e5_wp)), &
      row_t("pitches_of", type_reference, "", "mesh; the periods are its pitches; the first mesh if neither is given", &
            holds="meshes"), &
      row_t("turns_of", type_reference, "", "wheel; the periods are its revolutions; alternative to pitches_of", holds="wheels")]

   type(row_t), parameter :: support_rows(*) = [row_t("kind", type_choice, "", "", default="fixed")]

   type(row_t), parameter :: load_rows(*) = [ &
                             row_t("kind", type_choice, "", "", required=.true.), &
                             row_t("against", type_choice, "", "body loaded by the reaction torque, and reference of speeds", &
                                   default="ground", &
                                   words="ground housing")]

contains

   !> All rows. Rows of a block are contiguous; the row that selects the variant is first.
   subroutine case_table(rows)
      type(row_t), allocatable, intent(out) :: rows(:)
      type(row_t), allocatable :: buffer(:)
      integer :: i, n

      allocate (buffer(288))
      n = 0
      call put("case", case_rows)
      call put("material", material_rows)
      call put("strength", strength_rows)
      call put("sn", sn_rows)
      call put("wheel", wheel_rows)
      call put("rack", rack_rows)
      call put("fillet", fillet_rows)
      call put("cutter", cutter_rows)
      call put("relief", relief_rows)
      call put("accuracy", accuracy_rows)
      call put("eccentricity", eccentricity_rows)
      call put("compliance", compliance_rows)
      call put_kinds("support", support_rows, is_joined=.true.)
      call put_kinds("load", load_rows, is_joined=.true.)
      call put("mesh", mesh_rows)
      call put("lubricant", lubricant_rows)
      call put("shaft", shaft_rows)
      call put("housing", housing_rows)
      call put("translation", motion_rows("m", "displacement", "m/s", "velocity", 1000.0_wp, 300.0_wp))
      call put("rotation", motion_rows("deg", "angle", "rad/s", "rate of the angle", 3600.0_wp, 1000.0_wp))
      call put("mount", mount_rows)
      call put("accelerometer", accelerometer_rows)
      call put("simulation", simulation_rows)
      call put("output", output_rows)
      call put("initial", initial_rows)
      call put("metrics", metrics_rows)
      call put_kinds("contact", [row_t("law", type_choice, "", "law of the normal elastic force", default="johnson")])
      call put_kinds("damping", [row_t("law", type_choice, "", "law of the normal viscous force", default="none")])
      call put_kinds("friction", [row_t("law", type_choice, "", "law of the tangential force", default="none")])
      rows = buffer(:n)
      do i = 1, n
         call read_default(rows(i))
         if (rows(i)%type >= type_block) rows(i)%first_held = max(findloc(rows%block, rows(i)%holds, dim=1), 0)
      end do

   contains

      !> Append the rows of a block.
      subroutine put(block, more)
         character(len=*), intent(in) :: block
         type(row_t), intent(in) :: more(:)

         if (n + size(more) > size(buffer)) buffer = [buffer, buffer]
         buffer(n + 1:n + size(more)) = more
         buffer(n + 1:n + size(more))%block = block
         n = n + size(more)
      end subroutine put

      !> Append the rows of a block with variants: those in `first`, the first of which selects the variant, then those of each
      !> variant. If is_joined, a row common to several variants is listed once; otherwise (laws) each variant has its own rows.
      subroutine put_kinds(block, first, is_joined)
         character(len=*), intent(in) :: block
         type(row_t), intent(in) :: first(:)
         logical, intent(in), optional :: is_joined
         type(kind_t), allocatable :: kinds(:)
         integer :: i, j, k, start, same

         call kinds_of(block, kinds)
         start = n + 1
         call put(block, first)
         call join_words(kinds%name, " ", buffer(start)%words)
         if (buffer(start)%text == "") call join_words(kinds%text, "; ", buffer(start)%text)
         do i = 1, size(kinds)
            do k = 1, size(kinds(i)%rows)
               same = 0
               if (present(is_joined)) same = findloc([(means_same(buffer(j), kinds(i)%rows(k)), j=start, n)], .true., dim=1)
               if (same > 0) then
                  buffer(start + same - 1)%variants = trim(buffer(start + same - 1)%variants)//" "//kinds(i)%name
               else
                  call put(block, kinds(i)%rows(k:k))
                  buffer(n)%variants = kinds(i)%name
               end if
            end do
         end do
      end subroutine put_kinds

   end subroutine case_table

   !> Whether two rows are identical except for their variants.
   pure logical function means_same(a, b)
      type(row_t), intent(in) :: a, b

      means_same = a%key == b%key .and. a%text == b%text .and. a%type == b%type .and. (a%required .eqv. b%required)
   end function means_same

   !> Variants of a block; size 0 if it has none.
   subroutine kinds_of(block, kinds)
      character(len=*), intent(in) :: block !! contact, damping, friction, load, support or event
      type(kind_t), allocatable, intent(out) :: kinds(:)
      type(kind_finder) :: finder

      if (block == "event") then
         call list_event_kinds(kinds)
         return
      end if
      call walk(finder)
      allocate (finder%kinds(finder%n))
      finder%n = 0
      call walk(finder)
      call move_alloc(finder%kinds, kinds)

   contains

      subroutine walk(finder)
         type(kind_finder), intent(inout) :: finder
         class(elastic_law_t), allocatable :: elastic
         class(damping_law_t), allocatable :: damping
         class(friction_law_t), allocatable :: friction
         class(load_t), allocatable :: load
         class(support_kind_t), allocatable :: support

         select case (block)
         case ("contact")
            call elastic_law(finder, elastic)
         case ("damping")
            call damping_law(finder, damping)
         case ("friction")
            call friction_law(finder, friction)
         case ("load")
            call load_of_kind(finder, load)
         case ("support")
            call support_of_kind(finder, support)
         end select
      end subroutine walk

   end subroutine kinds_of

end module evl_case_table
