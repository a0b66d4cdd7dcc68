/** Scripts for command line completion in shells, generated from the table of commands. */
#pragma once

#include "model/output_groups.h"

#include <stdio.h>

/** Kind of a word, by its name in the table: an option's `argument` or a command's `file`. */
typedef enum {
    WORD_ANY, /**< no suggestions, such as for a number */
    WORD_FILE,
    WORD_CASE,
    WORD_DESIGN,
    WORD_FOLDER,
    WORD_SETTING, /**< a path of a number of the case, followed by = */
    WORD_MESH,    /**< a mesh of the case */
    WORD_OUTPUTS, /**< a group of outputs */
    WORD_SHELL
} word_kind;

#define COMPLETION_SHELL "shell"
#define COMPLETION_SHELLS "bash zsh fish"

word_kind completion_kind(const char *called);
/** Print a text between single quotes, as shells expect it.
 *  @param escape  characters that get a backslash, for a second interpreter */
void completion_print_quoted(FILE *stream, const char *text, const char *escape);

void completion_print_bash(FILE *stream);
void completion_print_zsh(FILE *stream);
void completion_print_fish(FILE *stream);
