/** SHA-256 (FIPS 180-4): a hash that identifies contents. Leaf module. */
#pragma once

#include <stddef.h>
#include <stdint.h>

enum { SHA256_BLOCK = 64, SHA256_TEXT = 65 /**< hexadecimal digits and the terminator */ };

typedef struct {
    uint32_t state[8];
    uint64_t n_bytes;
    unsigned char block[SHA256_BLOCK]; /**< bytes of an incomplete block */
} sha256;

void sha256_start(sha256 *hash);
void sha256_add(sha256 *hash, const void *bytes, size_t n);
/** Hash of all bytes added, in lower case; none may be added afterwards. */
void sha256_finish(sha256 *hash, char text[SHA256_TEXT]);
