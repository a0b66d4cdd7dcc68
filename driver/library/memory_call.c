/* Where there is no memory in the library. memory.h says of this that it does not return, which is so in every call; but the kernel may
 * be called past the library, and then goes on as it would without it. */
#include "library/boundary.h"

void evl_memory_run_out(size_t count, size_t size);

void evl_memory_run_out(size_t count, size_t size)
{
    boundary_leave(count, size);
}
