#include "base/utf8.h"

#include <string.h>

int utf8_length(const char *text)
{
    const unsigned char first = (unsigned char)text[0], second = (unsigned char)text[1];
    const int length = first < 0x80                     ? 1
                       : first >= 0xc2 && first <= 0xdf ? 2
                       : first >= 0xe0 && first <= 0xef ? 3
                       : first >= 0xf0 && first <= 0xf4 ? 4
                                                        : 0;
    const bool is_odd = (first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
                        (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f);
    for (int i = 1; i < length; i++) {
        if (((unsigned char)text[i] & 0xc0) != 0x80) {
            return 0;
        }
    }
    return is_odd ? 0 : length;
}

bool utf8_is_control(const char *text)
{
    const int length = utf8_length(text);
    unsigned code = length < 2 ? (unsigned char)text[0] : (unsigned char)text[0] & (0xffU >> (length + 1));
    for (int i = 1; i < length; i++) {
        code = code << 6 | ((unsigned char)text[i] & 0x3fU);
    }
    return length > 0 && (code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x61c || code == 0x200e ||
                          code == 0x200f || (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069));
}

void utf8_make_line(char *text)
{
    for (char *c = text; *c != '\0';) {
        const int length = utf8_length(c);
        if (length == 0) {
            *c++ = '?';
        } else {
            (void)(utf8_is_control(c) && memset(c, ' ', (size_t)length));
            c += length;
        }
    }
}
