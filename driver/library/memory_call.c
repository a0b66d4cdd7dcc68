/* Failed allocations in the library. By memory.h this function does not return, which is true within every call; but
 * the kernel may be called without the library, and then continues as it would on its own. */
#include "library/boundary.h"

void evl_memory_run_out(size_t count, size_t size);

void evl_memory_run_out(size_t count, size_t size)
{
    boundary_leave(count, size);
}
