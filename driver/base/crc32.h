/** CRC-32 of zlib (ISO 3309) to detect damaged bytes. Leaf module. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include <zlib.h>

/** Continue the CRC `check` of the preceding bytes; 0 if there are none. It detects every damage within 32 consecutive
 *  bits; other damage is missed once in 4e9 times. No protection against deliberate manipulation. */
static inline uint32_t crc32_on(uint32_t check, const void *bytes, size_t n)
{
    return (uint32_t)crc32_z(check, bytes, n);
}
