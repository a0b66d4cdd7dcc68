#include "base/crc32.h"

#include <stdbool.h>

enum { AT_ONCE = 8 }; /* bytes: each has a table of what it does from its distance to the end */
static const uint32_t polynomial = 0xedb88320U;

static uint32_t tables[AT_ONCE][256];

static void fill_tables(void)
{
    for (uint32_t byte = 0; byte < 256; byte++) {
        uint32_t rest = byte;
        for (int bit = 0; bit < 8; bit++) {
            rest = (rest >> 1) ^ ((rest & 1U) != 0 ? polynomial : 0);
        }
        tables[0][byte] = rest;
    }
    for (int k = 1; k < AT_ONCE; k++) {
        for (int byte = 0; byte < 256; byte++) {
            const uint32_t before = tables[k - 1][byte];
            tables[k][byte] = (before >> 8) ^ tables[0][before & 0xffU];
        }
    }
}

static uint32_t little_endian(const unsigned char *bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

uint32_t crc32_on(uint32_t check, const void *bytes, size_t n)
{
    static bool is_ready;
    if (!is_ready) {
        fill_tables();
        is_ready = true;
    }
    const unsigned char *next = bytes;
    uint32_t rest = ~check;
    for (; n >= AT_ONCE; n -= AT_ONCE, next += AT_ONCE) {
        const uint32_t low = rest ^ little_endian(next), high = little_endian(next + 4);
        rest = tables[7][low & 0xffU] ^ tables[6][low >> 8 & 0xffU] ^ tables[5][low >> 16 & 0xffU] ^
               tables[4][low >> 24] ^ tables[3][high & 0xffU] ^ tables[2][high >> 8 & 0xffU] ^
               tables[1][high >> 16 & 0xffU] ^ tables[0][high >> 24];
    }
    for (; n > 0; n--, next++) {
        rest = (rest >> 8) ^ tables[0][(rest ^ *next) & 0xffU];
    }
    return ~rest;
}
