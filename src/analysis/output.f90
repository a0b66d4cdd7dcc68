!> Metadata of an output, its section in the table, and a list of rows.
!>
!> The list is a module separate from `evl_output_registry` so that compilers do not inline it into the fast path of the registry.
module evl_output
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: output_rows, output_t, append_row
   public :: needs_nothing, needs_rates, needs_meshes, needs_positions, needs_points, needs_torques, needs_reactions, needs_pairs
   public :: needs_pressures, needs_roots, needs_temperatures, none, rows_before_sections
   public :: dims_none, dims_wheel, dims_mesh, dims_wheel_axis, dims_mesh_axis, dims_space, dims_quaternion, dims_wheel_space
   public :: dims_accelerometer, dims_harmonic, dims_mesh_pair, dims_position, dims_position_pair, dims_position_wheel
   public :: dims_shaft
   public :: in_wheel_constants, in_mesh_constants, in_wheel_teeth, in_mesh_teeth, in_gearbox, in_wheels, in_meshes, in_pairs
   public :: in_coast, in_wheel_positions, in_mesh_positions, in_bearings, in_pose, in_mount, in_accelerometers
   public :: in_losses, in_roots, in_shaft_constants, in_shafts, in_temperatures

   integer, parameter :: dims_none = 0, dims_wheel = 1, dims_mesh = 2, dims_wheel_axis = 3, dims_mesh_axis = 4
   integer, parameter :: dims_space = 5       !! x, y, z
   integer, parameter :: dims_quaternion = 6  !! w, x, y, z
   integer, parameter :: dims_wheel_space = 7 !! x, y, z of every wheel
   integer, parameter :: dims_mesh_pair = 8   !! every tooth pair slot of every mesh
   integer, parameter :: dims_shaft = 9       !! every shaft
   integer, parameter :: dims_accelerometer = 13
   ! of the static analysis of a mesh
   integer, parameter :: dims_position = 10      !! every position
   integer, parameter :: dims_position_pair = 11 !! every tooth pair slot at every position
   integer, parameter :: dims_harmonic = 12
   integer, parameter :: dims_position_wheel = 14 !! both wheels of the mesh at every position

   !> Sections of the table, in table order. One procedure adds the rows of a section, element by element.
   enum, bind(c)
      enumerator :: in_wheel_constants = 1, in_mesh_constants, in_wheel_teeth, in_mesh_teeth
      enumerator :: in_gearbox, in_wheels, in_meshes, in_pairs, in_coast
      enumerator :: in_wheel_positions, in_mesh_positions, in_bearings, in_pose, in_mount, in_accelerometers
      enumerator :: in_shaft_constants, in_shafts, in_losses, in_roots, in_temperatures
   end enum

   !> Quantities that an output requires, one bit each; each constant includes the bits of its prerequisites.
   integer, parameter :: needs_nothing = 0                 !! beyond the state
   integer, parameter :: needs_rates = 1                   !! time derivatives of the state, and forces of the tooth contacts
   integer, parameter :: needs_meshes = 2 + needs_rates    !! sums of forces and losses over the tooth contacts of a mesh
   integer, parameter :: needs_positions = 4 + needs_meshes   !! positions of the contacts that do not touch, too
   integer, parameter :: needs_points = 8 + needs_positions   !! contact points of the leading contact of the mesh
   integer, parameter :: needs_torques = 16 + needs_rates  !! torques of loads and shafts
   integer, parameter :: needs_reactions = 32 + needs_torques !! reactions of the wheels on the housing
   integer, parameter :: needs_pairs = 64 + needs_rates    !! individual tooth pairs
   integer, parameter :: needs_pressures = 128 + needs_pairs !! contact pressures of the tooth pairs
   integer, parameter :: needs_roots = 256 + needs_pairs   !! root stress of the wheels
   integer, parameter :: needs_temperatures = 512 + needs_pressures !! flash temperatures of the tooth pairs

   integer, parameter :: none = -1 !! column of a row that is not requested

   !> One output; see `evl_output` in the C header.
   type :: output_t
      character(len=31) :: name = "", units = "", symbol = ""
      character(len=95) :: long_name = ""
      integer :: dims = dims_none
      logical :: is_static = .false., is_integer = .false.
      integer :: section = 0
      integer :: of = dims_none, length = 1 !! of: dimension of the elements of its section; length: values per element
      integer :: needs = needs_nothing
      real(wp) :: value(4) = 0.0_wp         !! values of the listed element; only if its objects are not empty
      integer :: monitored = 0                !! of an extreme: index of the monitored output
      logical :: is_largest = .false.       !! of an extreme: true for a maximum, false for a minimum
      !> Output whose time derivative it is, element by element. The derivative of a scalar output is the sum of all such rates.
      character(len=31) :: rate_of = ""
      character(len=95) :: no_rate = ""     !! why it is the derivative of no output, although it has the unit of one
   end type output_t

   !> A list of rows.
   type :: output_rows
      integer :: n = 0                            !! number of rows so far
      type(output_t), allocatable :: table(:)     !! rows 1 to n are used
      integer :: section = 0, of = dims_none      !! of the next row
      logical :: is_static = .false.              !! of the next row
      integer :: needs = needs_nothing            !! of the next row
      logical :: has_texts = .true.               !! rows include unit, symbol and text
   end type output_rows

contains

   !> Append a row.
   pure subroutine append_row(rows, name, units, symbol, text, value, is_integer, rate_of, no_rate)
      type(output_rows), intent(inout) :: rows
      character(len=*), intent(in) :: name, units, symbol, text
      real(wp), intent(in) :: value(:)
      logical, intent(in) :: is_integer
      character(len=*), intent(in), optional :: rate_of, no_rate !! as in `output_t`

      if (.not. allocated(rows%table)) allocate (rows%table(128))
      if (rows%n == size(rows%table)) rows%table = [rows%table, rows%table]
      rows%n = rows%n + 1
      associate (row => rows%table(rows%n))
         row%name = name
         if (rows%has_texts) then
            row%units = units
            row%symbol = symbol
            row%long_name = text
            if (present(no_rate)) row%no_rate = no_rate
         end if
         if (present(rate_of)) row%rate_of = rate_of
         row%dims = dims_of(rows%of, size(value))
         row%is_static = rows%is_static
         row%is_integer = is_integer
         row%section = rows%section
         row%of = rows%of
         row%length = size(value)
         row%needs = rows%needs
         row%value(:row%length) = value
      end associate
   end subroutine append_row

   !> Number of rows before each section of a table.
   pure subroutine rows_before_sections(table, before)
      type(output_t), intent(in) :: table(:)
      integer, allocatable, intent(out) :: before(:)
      integer :: i

      allocate (before(maxval(table%section)), source=0)
      do i = size(table), 1, -1
         before(table(i)%section) = i - 1
      end do
   end subroutine rows_before_sections

   !> Dimensions of an output with vectors of a given length per element; -1 if not supported.
   pure integer function dims_of(of, length) result(dims)
      integer, intent(in) :: of, length

      dims = -1
      if (length == 1) dims = of
      if (length == 2 .and. of == dims_wheel) dims = dims_wheel_axis
      if (length == 2 .and. of == dims_mesh) dims = dims_mesh_axis
      if (length == 3 .and. of == dims_wheel) dims = dims_wheel_space
      if (length == 3 .and. of == dims_none) dims = dims_space
      if (length == 4 .and. of == dims_none) dims = dims_quaternion
   end function dims_of

end module evl_output
