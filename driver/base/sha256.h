/** SHA-256 (FIPS 180-4): a name for contents. A leaf. */
#pragma once

#include <stddef.h>
#include <stdint.h>

enum { SHA256_BLOCK = 64, SHA256_TEXT = 65 /**< hexadecimal digits and the end */ };

typedef struct {
    uint32_t state[8];
    uint64_t n_bytes;
    unsigned char block[SHA256_BLOCK]; /**< what does not fill one yet */
} sha256;

void sha256_start(sha256 *hash);
void sha256_add(sha256 *hash, const void *bytes, size_t n);
/** The name of all that was added, in lower case; nothing may be added after that. */
void sha256_finish(sha256 *hash, char text[SHA256_TEXT]);
