/** Scripts by which shells complete the words of the command line, made from the table of commands. */
#pragma once

#include "model/output_groups.h"

#include <stdio.h>

/** What a word is, by what the table calls it: an option's `argument` or a command's `file`. */
typedef enum {
    WORD_ANY, /**< nothing to offer, such as a number */
    WORD_FILE,
    WORD_CASE,
    WORD_DESIGN,
    WORD_FOLDER,
    WORD_SETTING, /**< a path of a number of the case, and = behind it */
    WORD_MESH,    /**< a mesh of the case */
    WORD_OUTPUTS, /**< a group of outputs */
    WORD_SHELL
} word_kind;

#define COMPLETION_SHELL "shell"
#define COMPLETION_SHELLS "bash zsh fish"

word_kind completion_kind(const char *called);
/** A text between single quotes, as shells take it.
 *  @param escape  characters that get a backslash, for what reads the text behind the shell */
void completion_print_quoted(FILE *stream, const char *text, const char *escape);

void completion_print_bash(FILE *stream);
void completion_print_zsh(FILE *stream);
void completion_print_fish(FILE *stream);
