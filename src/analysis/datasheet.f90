!> Data sheet of a mesh: geometry, inspection, tolerances, nominal stress, stiffness and dynamics as rows.
!>
!> A row has a value per gear, driving gear first, or one of the mesh, in SI units and radians. A value that does not exist is NaN,
!> and the note of its row gives the reason. Otherwise the note names the source, or an assumption.
module evl_datasheet
   use evl_datasheet_dynamics, only: add_stiffness
   use evl_datasheet_geometry, only: add_gears, add_mesh, add_points, add_rack
   use evl_datasheet_inspection, only: add_inspection, add_tolerances
   use evl_datasheet_load, only: add_load, add_loss_factor, add_pressures, add_root_stress
   use evl_datasheet_rows, only: sheet_row_t, sheet_t
   use evl_gearbox, only: gearbox_t
   use evl_path_points, only: path_points_of, path_points_t
   implicit none (type, external)
   private

   public :: datasheet_of

   integer, parameter :: most_rows = 160

contains

   !> Rows of a mesh.
   subroutine datasheet_of(gearbox, mesh, rows)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(sheet_row_t), allocatable, intent(out) :: rows(:)
      type(sheet_t) :: to
      type(path_points_t) :: points
      integer :: wheels(2)

      allocate (to%rows(most_rows))
      associate (contact => gearbox%contacts(gearbox%first(mesh)))
         wheels = [contact%wheel_a, contact%wheel_b]
      end associate
      points = path_points_of(gearbox%pairs(mesh))
      call add_rack(gearbox%gears(wheels), to)
      call add_gears(gearbox, mesh, gearbox%gears(wheels), to)
      call add_inspection(gearbox%gears(wheels), to)
      call add_tolerances(gearbox, wheels, to)
      call add_mesh(gearbox, mesh, to)
      call add_points(points, to)
      call add_load(gearbox, mesh, to)
      call add_pressures(gearbox, mesh, points, to)
      call add_root_stress(gearbox, mesh, to)
      call add_loss_factor(gearbox, mesh, to)
      call add_stiffness(gearbox, mesh, to)
      rows = to%rows(:to%n)
   end subroutine datasheet_of

end module evl_datasheet
