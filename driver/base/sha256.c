#include "base/sha256.h"

#include <stdio.h>
#include <string.h>

/* Section 4.2.2: fractions of the cube roots of the first 64 primes. */
static const uint32_t constants[SHA256_BLOCK] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

static uint32_t turn(uint32_t word, int bits)
{
    return word >> bits | word << (32 - bits);
}

/** Section 6.2.2. */
static void take_block(uint32_t state[8], const unsigned char *block)
{
    uint32_t w[SHA256_BLOCK], s[8];
    for (int t = 0; t < 16; t++) {
        const unsigned char *word = block + (size_t)(4 * t);
        w[t] = (uint32_t)word[0] << 24 | (uint32_t)word[1] << 16 | (uint32_t)word[2] << 8 | (uint32_t)word[3];
    }
    for (int t = 16; t < SHA256_BLOCK; t++) {
        const uint32_t early = w[t - 15], late = w[t - 2];
        w[t] = w[t - 16] + (turn(early, 7) ^ turn(early, 18) ^ early >> 3) + w[t - 7] +
               (turn(late, 17) ^ turn(late, 19) ^ late >> 10);
    }
    memcpy(s, state, sizeof s);
    for (int t = 0; t < SHA256_BLOCK; t++) {
        const uint32_t a = s[0], e = s[4];
        const uint32_t one =
            s[7] + (turn(e, 6) ^ turn(e, 11) ^ turn(e, 25)) + ((e & s[5]) ^ (~e & s[6])) + constants[t] + w[t];
        const uint32_t two = (turn(a, 2) ^ turn(a, 13) ^ turn(a, 22)) + ((a & s[1]) ^ (a & s[2]) ^ (s[1] & s[2]));
        memmove(s + 1, s, 7 * sizeof *s);
        s[4] += one;
        s[0] = one + two;
    }
    for (int i = 0; i < 8; i++) {
        state[i] += s[i];
    }
}

void sha256_start(sha256 *hash)
{
    /* Section 5.3.3: fractions of the square roots of the first 8 primes. */
    *hash = (sha256){
        .state = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19}};
}

void sha256_add(sha256 *hash, const void *bytes, size_t n)
{
    const unsigned char *next = bytes;
    while (n > 0) {
        const size_t buffered = hash->n_bytes % SHA256_BLOCK, available = SHA256_BLOCK - buffered,
                     part = n < available ? n : available;
        memcpy(hash->block + buffered, next, part);
        if (part == available) {
            take_block(hash->state, hash->block);
        }
        hash->n_bytes += part;
        next += part;
        n -= part;
    }
}

void sha256_finish(sha256 *hash, char text[SHA256_TEXT])
{
    enum { LENGTH = 8 }; /* bytes of the bit count at the end of the last block */
    static const unsigned char padding[SHA256_BLOCK] = {0x80};
    const uint64_t n_bits = 8 * hash->n_bytes;
    const size_t buffered = hash->n_bytes % SHA256_BLOCK;
    unsigned char length[LENGTH];
    for (int i = 0; i < LENGTH; i++) {
        length[i] = (unsigned char)(n_bits >> (56 - 8 * i));
    }
    const size_t blocks = buffered < SHA256_BLOCK - LENGTH ? 1 : 2;
    sha256_add(hash, padding, blocks * SHA256_BLOCK - LENGTH - buffered);
    sha256_add(hash, length, LENGTH);
    for (int i = 0; i < 8; i++) {
        (void)snprintf(text + (size_t)(8 * i), 9, "%08x", (unsigned)hash->state[i]);
    }
}
