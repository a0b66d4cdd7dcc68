/** CRC-32 as zlib, gzip and PNG have it (ISO 3309): whether bytes are still those that were written. A leaf. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/** On from the check of what stands before; 0 if nothing does. Any damage within 32 bits running changes it, other damage
 *  stays unseen once in 4e9 times. Not against who wants to deceive. */
uint32_t crc32_on(uint32_t check, const void *bytes, size_t n);
