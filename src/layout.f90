!> Where the wheels are and how fast they turn relative to each other: pitch radii, centres and speed ratios along the meshes.
!> Real gears come with their reference radius as pitch radius, and with the centre distances of their meshes.
module evl_layout
   use evl_kinds, only: pi, wp
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t, subject_mesh, subject_wheel
   implicit none (type, external)
   private

   public :: layout_t, layout_resolve

   real(wp), parameter :: agreement = 1.0e-9_wp !! relative: two given numbers that differ less are the same

   !> What is known of the wheels and meshes before, and all of it after layout_resolve.
   type :: layout_t
      integer, allocatable :: teeth(:)                        !! per wheel
      logical, allocatable :: has_radius(:), has_centre(:)    !! per wheel: whether the next two are known
      real(wp), allocatable :: pitch_radius(:), centre(:, :)  !! per wheel [m]; centre(2, wheel)
      integer, allocatable :: driving(:), driven(:)           !! per mesh
      logical, allocatable :: has_angle(:)                    !! per mesh: whether the next is known
      real(wp), allocatable :: angle(:)                       !! per mesh: direction of the centre line [rad]
      logical, allocatable :: has_distance(:)                 !! per mesh: its centre distance is not the sum of the pitch radii
      real(wp), allocatable :: distance(:)                    !! per mesh: but this [m]
      integer, allocatable :: turn(:)                         !! per wheel: +1 turns like the reference wheel, -1 against it
   end type layout_t

contains

   !> Find every pitch radius, centre, centre line and sense of rotation; refuse what contradicts itself or cannot be found.
   !>
   !> r_driven/r_driving = z_driven/z_driving; |O_B - O_A| = r_A + r_B. Wheels in mesh turn against each other.
   pure subroutine layout_resolve(layout, reference, status)
      type(layout_t), intent(inout) :: layout
      integer, intent(in) :: reference        !! wheel that turn() counts from
      type(status_t), intent(inout) :: status

      call resolve_radii(layout, status)
      if (has_failed(status)) return
      call resolve_turns(layout, reference, status)
      if (has_failed(status)) return
      call resolve_centres(layout, status)
   end subroutine layout_resolve

   !> Pitch radii from the ratios of teeth.
   pure subroutine resolve_radii(layout, status)
      type(layout_t), intent(inout) :: layout
      type(status_t), intent(inout) :: status
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
         if (.not. layout%has_distance(m)) call check_ratio(layout, m, status)
         if (has_failed(status)) return
      end do
   end subroutine resolve_radii

   !> Pitch radii of two wheels in mesh are as their teeth.
   pure subroutine check_ratio(layout, m, status)
      type(layout_t), intent(in) :: layout
      integer, intent(in) :: m
      type(status_t), intent(inout) :: status
      real(wp) :: expected

      associate (a => layout%driving(m), b => layout%driven(m), r => layout%pitch_radius)
         expected = r(a)*layout%teeth(b)/layout%teeth(a)
         if (abs(r(b) - expected) <= agreement*expected) return
         call fail(status, code_invalid_input, "pitch radius "//quantity(r(b), "m")//" does not agree with " &
                   //quantity(expected, "m")//", which the teeth and the pitch radius "//quantity(r(a), "m") &
                   //" of its mate demand", subject_wheel, b, "pitch_radius")
      end associate
   end subroutine check_ratio

   !> Centres from the centre distances and the directions of the centre lines; the first wheel is at the origin if no wheel
   !> has a centre.
   pure subroutine resolve_centres(layout, status)
      type(layout_t), intent(inout) :: layout
      type(status_t), intent(inout) :: status
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
      end do
      do m = 1, size(layout%driving)
         call check_centres(layout, m, status)
         if (has_failed(status)) return
      end do
   end subroutine resolve_centres

   !> From the driving to the driven axle [m].
   pure function offset(layout, m) result(vector)
      type(layout_t), intent(in) :: layout
      integer, intent(in) :: m
      real(wp) :: vector(2)

      vector = centre_distance(layout, m)*[cos(layout%angle(m)), sin(layout%angle(m))]
   end function offset

   !> Distance of the two axles [m].
   pure real(wp) function centre_distance(layout, m)
      type(layout_t), intent(in) :: layout
      integer, intent(in) :: m

      centre_distance = layout%pitch_radius(layout%driving(m)) + layout%pitch_radius(layout%driven(m))
      if (layout%has_distance(m)) centre_distance = layout%distance(m)
   end function centre_distance

   !> The distance of two centres is that of the mesh, and the centre line points as given.
   pure subroutine check_centres(layout, m, status)
      type(layout_t), intent(inout) :: layout
      integer, intent(in) :: m
      type(status_t), intent(inout) :: status
      real(wp) :: c(2), expected, distance, angle

      associate (a => layout%driving(m), b => layout%driven(m))
         if (.not. (layout%has_centre(a) .and. layout%has_centre(b))) then
            call fail(status, code_invalid_input, "the direction of its centre line is not known: give centre_line_angle, or the" &
                      //" centres of both wheels", subject_mesh, m, "centre_line_angle")
            return
         end if
         c = layout%centre(:, b) - layout%centre(:, a)
         distance = norm2(c)
         expected = centre_distance(layout, m)
         if (abs(distance - expected) > agreement*expected .and. layout%has_distance(m)) then
            call fail(status, code_invalid_input, "the centres of its wheels are "//quantity(distance, "m")//" apart, but its" &
                      //" centre distance is "//quantity(expected, "m")//": give centre_distance or backlash, or other centres", &
                      subject_mesh, m, "centre_distance")
            return
         else if (abs(distance - expected) > agreement*expected) then
            call fail(status, code_invalid_input, "its centre is "//quantity(distance, "m")//" from that of its mate, but their" &
                      //" pitch radii add up to "//quantity(expected, "m"), subject_wheel, b, "centre")
            return
         end if
         angle = atan2(c(2), c(1))
         if (layout%has_angle(m)) then
            if (abs(modulo(angle - layout%angle(m) + pi, 2*pi) - pi) > agreement) then
               call fail(status, code_invalid_input, "centre line angle "//quantity(layout%angle(m)*180/pi, "deg") &
                         //" does not agree with "//quantity(angle*180/pi, "deg")//", the direction between the centres", &
                         subject_mesh, m, "centre_line_angle")
            end if
         else
            layout%angle(m) = angle
            layout%has_angle(m) = .true.
         end if
      end associate
   end subroutine check_centres

   !> Senses of rotation from the reference wheel on.
   pure subroutine resolve_turns(layout, reference, status)
      type(layout_t), intent(inout) :: layout
      integer, intent(in) :: reference
      type(status_t), intent(inout) :: status
      integer :: m, i
      logical :: found

      allocate (layout%turn(size(layout%teeth)), source=0)
      layout%turn(reference) = 1
      found = .true.
      do while (found)
         found = .false.
         do m = 1, size(layout%driving)
            associate (a => layout%turn(layout%driving(m)), b => layout%turn(layout%driven(m)))
               if (a /= 0 .and. a == b) then
                  call fail(status, code_invalid_input, "it closes a ring of an odd number of wheels, which cannot turn", &
                            subject_mesh, m)
                  return
               end if
               found = found .or. (a == 0 .neqv. b == 0)
               if (a == 0) a = -b
               if (b == 0) b = -a
            end associate
         end do
      end do
      do i = 1, size(layout%turn)
         if (layout%turn(i) /= 0) cycle
         call fail(status, code_invalid_input, "no mesh connects it with the other wheels: separate gear trains are separate" &
                   //" cases", subject_wheel, i)
         return
      end do
   end subroutine resolve_turns

end module evl_layout
