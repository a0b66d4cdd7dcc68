/** JSON writer: one value after the other, indented or on one line. Leaf module. */
#pragma once

#include <stdbool.h>
#include <stdio.h>

typedef struct {
    FILE *stream;
    bool is_line; /**< no newlines or blanks, numbers with up to 17 digits, not the shortest form: for logs */
    int level;
    bool has_values; /**< the innermost object or array already has a value */
} json_writer;

/* `key` is NULL in an array and at the top level. */
void json_open(json_writer *writer, const char *key, char bracket);
/** @param bracket  '}' or ']' */
void json_close(json_writer *writer, char bracket);
/** Write UTF-8 text; invalid bytes are replaced. */
void json_text(json_writer *writer, const char *key, const char *text);
/** Write the shortest form that reads back exactly; null if the value is not finite. */
void json_number(json_writer *writer, const char *key, double value);
void json_numbers(json_writer *writer, const char *key, int n, const double *values);
void json_integer(json_writer *writer, const char *key, long value);
void json_truth(json_writer *writer, const char *key, bool value);
