/** CRC-32 of zlib (ISO 3309): whether bytes are still those that were written. A leaf. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include <zlib.h>

/** On from the check of what stands before; 0 if nothing does. Any damage within 32 bits running changes it, other damage
 *  stays unseen once in 4e9 times. Not against who wants to deceive. */
static inline uint32_t crc32_on(uint32_t check, const void *bytes, size_t n)
{
    return (uint32_t)crc32_z(check, bytes, n);
}
