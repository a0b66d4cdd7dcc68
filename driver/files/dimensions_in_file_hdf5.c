#include "files/dimensions_in_file_hdf5.h"

#include "files/netcdf_common_hdf5.h"

bool dimensions_define(dimensions *dimensions, netcdf_file *file)
{
    bool good = true;
    for (int i = 0; i < N_DIMENSIONS && good; i++) {
        const dimension_values *values = &dimensions->values[i];
        const bool is_text = values->variable.type == NETCDF_TEXT;
        good = !values->is_there ||
               netcdf_define_values(file, file->id, &dimensions->of[i], &values->variable, values->n,
                                    is_text ? netcdf_cached.text : H5T_NATIVE_DOUBLE,
                                    is_text ? (const void *)values->names : (const void *)values->numbers);
    }
    return good;
}

bool dimensions_finish(dimensions *dimensions, netcdf_file *file)
{
    bool good = true;
    for (int i = 0; i < N_DIMENSIONS && good; i++) {
        good = scale_list_users(file, dimensions->of[i].scale);
    }
    return good;
}
