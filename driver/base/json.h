/** Writes JSON, one value after the other, indented or as one line. A leaf. */
#pragma once

#include <stdbool.h>
#include <stdio.h>

typedef struct {
    FILE *stream;
    bool is_line; /**< no new lines and no blanks, numbers with at most 17 digits as they come: for logs */
    int level;
    bool has_values; /**< the innermost object or array has one already */
} json_writer;

/* `key` is NULL in an array and at the top. */
void json_open(json_writer *writer, const char *key, char bracket);
/** @param bracket  '}' or ']' */
void json_close(json_writer *writer, char bracket);
/** UTF-8 text; what is none is replaced. */
void json_text(json_writer *writer, const char *key, const char *text);
/** In the shortest form that reads back exactly; null if it is not finite. */
void json_number(json_writer *writer, const char *key, double value);
void json_numbers(json_writer *writer, const char *key, int n, const double *values);
void json_integer(json_writer *writer, const char *key, long value);
void json_truth(json_writer *writer, const char *key, bool value);
