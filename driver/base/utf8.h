/** Characters of foreign texts. Leaf module. */
#pragma once

#include <stdbool.h>

/** Bytes of the UTF-8 character at the start of a text; 0 if there is none. */
int utf8_length(const char *text);
/** Whether the character at the start is invisible and acts as a control: it ends a line (also U+0085, U+2028, U+2029),
 *  moves the cursor, or changes the direction of writing (U+061C, U+200E, U+200F, U+202A to U+202E, U+2066 to U+2069). */
bool utf8_is_control(const char *text);
/** Turn a text into one printable line: controls become blanks, invalid UTF-8 becomes question marks. */
void utf8_make_line(char *text);
