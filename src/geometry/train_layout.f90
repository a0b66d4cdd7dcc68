!> Layout of a gear train: pitch radii, centres and speed ratios along meshes and shafts. Gears defined by basic racks have
!> their reference radius as pitch radius, and the centre distances of their meshes are given.
module evl_train_layout
   use evl_kinds, only: pi, wp
   use evl_rational, only: operator(==), rational_scaled, rational_t, rational_value
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t, subject_mesh, subject_shaft, subject_wheel
   implicit none (type, external)
   private

   public :: layout_t, layout_resolve

   real(wp), parameter :: agreement = 1.0e-9_wp !! relative: two given numbers with a smaller difference are equal

   !> Known data of the wheels, meshes and shafts; complete after layout_resolve.
   type :: layout_t
      integer, allocatable :: teeth(:)                        !! per wheel, negative if internal; 0: a disc of known radius
      logical, allocatable :: has_radius(:), has_centre(:)    !! per wheel: whether the next two are known
      real(wp), allocatable :: pitch_radius(:), centre(:, :)  !! per wheel, negative radius if internal [m]; centre(2, wheel)
      integer, allocatable :: driving(:), driven(:)           !! per mesh
      logical, allocatable :: has_angle(:)                    !! per mesh: whether the next is known
      real(wp), allocatable :: angle(:)                       !! per mesh: from the driving to the driven axle; resolved: chi [rad]
      logical, allocatable :: has_distance(:)                 !! per mesh: its centre distance is not the sum of the pitch radii
      real(wp), allocatable :: distance(:)                    !! per mesh: that centre distance, negative if internal [m]
      integer, allocatable :: shaft_a(:), shaft_b(:)          !! per shaft: its two wheels
      type(rational_t), allocatable :: ratio(:)               !! per wheel: g, nominal speed over that of the reference wheel
   end type layout_t

contains

   !> Find every pitch radius, centre, centre line and speed ratio; report contradictions and missing data.
   !>
   !> r_driven/r_driving = z_driven/z_driving; |O_B - O_A| = |r_A + r_B|. Wheels in mesh turn in opposite directions, a wheel and
   !> its internal mate in the same, in the ratio of their teeth; wheels on a shaft turn as one about one axis.
   subroutine layout_resolve(layout, reference, status)
      type(layout_t), intent(inout) :: layout
      integer, intent(in) :: reference        !! wheel whose ratio is 1
      type(status_t), intent(inout) :: status

      call resolve_radii(layout, status)
      if (.not. has_failed(status)) call resolve_ratios(layout, reference, status)
      if (.not. has_failed(status)) call resolve_centres(layout, status)
   end subroutine layout_resolve

   !> Pitch radii from the ratios of tooth numbers.
   pure subroutine resolve_radii(layout, status)
      type(layout_t), intent(inout) :: layout
      type(status_t), intent(inout) :: status
      real(wp) :: expected
      integer :: m, a, b
      logical :: found

      found = .true.
      do while (found)
         found = .false.
         do m = 1, size(layout%driving)
            a = layout%driving(m)
            b = layout%driven(m)
            if (layout%has_distance(m) .or. (layout%has_radius(a) .eqv. layout%has_radius(b))) cycle
            if (layout%has_radius(b)) then
               a = layout%driven(m)
               b = layout%driving(m)
            end if
            layout%pitch_radius(b) = layout%pitch_radius(a)*layout%teeth(b)/layout%teeth(a)
            layout%has_radius(b) = .true.
            found = .true.
         end do
      end do
      do m = 1, size(layout%teeth)
         if (layout%has_radius(m)) cycle
         call fail(status, code_invalid_input, "its pitch radius is not given, and no mesh with a wheel of known pitch radius" &
                   //" fixes it", subject_wheel, m, "pitch_radius")
         return
      end do
      do m = 1, size(layout%driving)
         if (layout%has_distance(m)) cycle ! otherwise their ratio is that of the teeth
         associate (a => layout%driving(m), b => layout%driven(m), r => layout%pitch_radius)
            expected = r(a)*layout%teeth(b)/layout%teeth(a)
            if (abs(r(b) - expected) <= agreement*abs(expected)) cycle
            call fail(status, code_invalid_input, "pitch radius "//quantity(r(b), "m")//" does not agree with " &
                      //quantity(expected, "m")//", which the teeth and the pitch radius "//quantity(r(a), "m") &
                      //" of its mate demand", subject_wheel, b, "pitch_radius")
            return
         end associate
      end do
   end subroutine resolve_radii

   !> Centres from the centre distances and the directions of the centre lines; the first wheel is at the origin if no wheel
   !> has a centre.
   pure subroutine resolve_centres(layout, status)
      type(layout_t), intent(inout) :: layout
      type(status_t), intent(inout) :: status
      real(wp) :: distance
      integer :: m
      logical :: found

      if (.not. any(layout%has_centre)) then
         layout%has_centre(1) = .true.
         layout%centre(:, 1) = 0
      end if
      found = .true.
      do while (found)
         found = .false.
         do m = 1, size(layout%driving)
            associate (a => layout%driving(m), b => layout%driven(m))
               if (.not. layout%has_angle(m) .or. (layout%has_centre(a) .eqv. layout%has_centre(b))) cycle
               if (layout%has_centre(a)) then
                  layout%centre(:, b) = layout%centre(:, a) + offset(layout, m)
               else
                  layout%centre(:, a) = layout%centre(:, b) - offset(layout, m)
               end if
               layout%has_centre(a) = .true.
               layout%has_centre(b) = .true.
               found = .true.
            end associate
         end do
         do m = 1, size(layout%shaft_a)
            associate (a => layout%shaft_a(m), b => layout%shaft_b(m))
               if (layout%has_centre(a) .eqv. layout%has_centre(b)) cycle
               layout%centre(:, merge(b, a, layout%has_centre(a))) = layout%centre(:, merge(a, b, layout%has_centre(a)))
               layout%has_centre([a, b]) = .true.
               found = .true.
            end associate
         end do
      end do
      do m = 1, size(layout%driving)
         call check_centres(layout, m, status)
         if (has_failed(status)) return
      end do
      do m = 1, size(layout%shaft_a)
         associate (a => layout%shaft_a(m), b => layout%shaft_b(m))
            distance = norm2(layout%centre(:, b) - layout%centre(:, a))
            if (distance <= agreement*(abs(layout%pitch_radius(a)) + abs(layout%pitch_radius(b)))) cycle
            call fail(status, code_invalid_input, "its wheels must be on one axis, but their centres are " &
                      //quantity(distance, "m")//" apart", subject_shaft, m, "wheels")
            return
         end associate
      end do
   end subroutine resolve_centres

   !> Vector from the driving to the driven axle [m].
   pure function offset(layout, m) result(vector)
      type(layout_t), intent(in) :: layout
      integer, intent(in) :: m
      real(wp) :: vector(2)

      vector = abs(centre_distance(layout, m))*[cos(layout%angle(m)), sin(layout%angle(m))]
   end function offset

   !> Distance of the two axles, negative if one of the wheels is internal [m].
   pure real(wp) function centre_distance(layout, m)
      type(layout_t), intent(in) :: layout
      integer, intent(in) :: m

      centre_distance = layout%pitch_radius(layout%driving(m)) + layout%pitch_radius(layout%driven(m))
      if (layout%has_distance(m)) centre_distance = layout%distance(m)
   end function centre_distance

   !> Check that the distance of two centres is that of the mesh, and that the centre line has the given direction.
   pure subroutine check_centres(layout, m, status)
      type(layout_t), intent(inout) :: layout
      integer, intent(in) :: m
      type(status_t), intent(inout) :: status
      real(wp) :: c(2), expected, distance, angle, turned

      associate (a => layout%driving(m), b => layout%driven(m))
         if (.not. (layout%has_centre(a) .and. layout%has_centre(b))) then
            call fail(status, code_invalid_input, "the direction of its centre line is unknown; give centre_line_angle, or the" &
                      //" centres of both wheels", subject_mesh, m, "centre_line_angle")
            return
         end if
         c = layout%centre(:, b) - layout%centre(:, a)
         distance = norm2(c)
         expected = abs(centre_distance(layout, m))
         if (abs(distance - expected) > agreement*expected .and. layout%has_distance(m)) then
            call fail(status, code_invalid_input, "the centres of its wheels are "//quantity(distance, "m")//" apart, but its" &
                      //" centre distance is "//quantity(expected, "m")//"; give centre_distance or backlash, or other centres", &
                      subject_mesh, m, "centre_distance")
            return
         else if (abs(distance - expected) > agreement*expected) then
            call fail(status, code_invalid_input, "its centre is "//quantity(distance, "m")//" from that of its mate, but their" &
                      //" pitch radii add up to "//quantity(expected, "m"), subject_wheel, b, "centre")
            return
         end if
         angle = atan2(c(2), c(1))
         turned = merge(pi, 0.0_wp, centre_distance(layout, m) < 0)
         if (layout%has_angle(m)) then
            if (abs(modulo(angle - layout%angle(m) + pi, 2*pi) - pi) > agreement) &
               call fail(status, code_invalid_input, "centre line angle "//quantity(layout%angle(m)*180/pi, "deg") &
                         //" does not agree with "//quantity(angle*180/pi, "deg")//", the direction between the centres", &
                         subject_mesh, m, "centre_line_angle")
         else
            layout%angle(m) = angle
            layout%has_angle(m) = .true.
         end if
         layout%angle(m) = layout%angle(m) + turned
      end associate
   end subroutine check_centres

   !> Speed ratios along meshes and shafts, starting at the reference wheel. Equation TR6.
   subroutine resolve_ratios(layout, reference, status)
      type(layout_t), intent(inout) :: layout
      integer, intent(in) :: reference
      type(status_t), intent(inout) :: status
      logical :: known(size(layout%teeth)), found
      integer :: i, m

      allocate (layout%ratio(size(layout%teeth)))
      layout%ratio(reference) = rational_t(1, 1)
      known = .false.
      known(reference) = .true.
      found = .true.
      do while (found)
         found = .false.
         do m = 1, size(layout%driving)
            call pass_on(layout%driving(m), layout%driven(m), subject_mesh)
            if (has_failed(status)) return
         end do
         do m = 1, size(layout%shaft_a)
            call pass_on(layout%shaft_a(m), layout%shaft_b(m), subject_shaft)
            if (has_failed(status)) return
         end do
      end do
      i = findloc(known, .false., dim=1)
      if (i > 0) call fail(status, code_invalid_input, "no mesh or shaft connects it with the other wheels: separate gear trains" &
                           //" are separate cases", subject_wheel, i)

   contains

      !> Transfer the ratio from one wheel of mesh or shaft m to the other; if both are known they must agree. Equation TR6.
      subroutine pass_on(a, b, subject)
         integer, intent(in) :: a, b, subject
         integer :: from, to
         type(rational_t) :: ratio
         logical :: fits

         from = merge(a, b, known(a))
         to = merge(b, a, known(a))
         if (.not. known(from)) return
         fits = .true.
         ratio = layout%ratio(from)
         ! -z_from/z_to with a divisor > 0
         if (subject == subject_mesh) call rational_scaled(layout%ratio(from), -layout%teeth(from)*sign(1, layout%teeth(to)), &
                                                           abs(layout%teeth(to)), ratio, fits)
         if (.not. fits) then
            call fail(status, code_invalid_input, "its speed ratio to the reference wheel has too large a denominator: too" &
                      //" many stages whose teeth have no common divisor", subject_wheel, to, "teeth")
         else if (.not. known(to)) then
            layout%ratio(to) = ratio
            known(to) = .true.
            found = .true.
         else if (.not. layout%ratio(to) == ratio) then
            associate (other => layout%ratio(to))
               if (other%above == -ratio%above .and. other%below == ratio%below .and. subject == subject_mesh) then
                  call fail(status, code_invalid_input, "it closes a loop of an odd number of meshes of external wheels," &
                            //" which cannot turn", subject, m)
               else
                  call fail(status, code_invalid_input, "it closes a loop that cannot turn: one of its wheels would have to turn " &
                            //quantity(rational_value(ratio), "")//" times as fast as the reference wheel, and according to" &
                            //" the rest of the loop "//quantity(rational_value(other), "")//" times", subject, m)
               end if
            end associate
         end if
      end subroutine pass_on

   end subroutine resolve_ratios

end module evl_train_layout
