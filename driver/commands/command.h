/** A command describes itself: its name, its texts, its options, what it does. Each stands in a file of its own and is a line in
 *  commands.inc; parsing, help and complaints follow from the struct. */
#pragma once

#include "base/status.h"

#include <stddef.h>

/** The values of an option that may be repeated, in their order. */
typedef struct {
    int n;
    const char **values;
} option_values;

typedef enum {
    OPTION_TEXT,  /**< one value, a const char *; NULL if not given */
    OPTION_FLAG,  /**< none, a bool */
    OPTION_ALONE, /**< the same; no file and no other option goes with it */
    OPTION_LIST,  /**< option_values */
    OPTION_HELP   /**< none, and no place: what the command is is printed instead */
} option_kind;

typedef struct {
    option_kind kind;
    char letter;          /**< 0 if it has no short form */
    const char *name;     /**< with its dashes */
    const char *argument; /**< what its value is called */
    size_t place;         /**< of its value in the command's options */
    const char *text;
} option_row;

typedef struct {
    const char *name; /**< "": the program itself */
    const char *synopsis, *summary, *text;
    const char *file;   /**< what it works on; NULL: nothing */
    bool takes_several; /**< files, one after the other; the highest exit code is that of the command */
    size_t size;        /**< of its options, a struct that begins as zeros */
    int n_options;
    const option_row *options;
    /** What is wrong with a combination of options; NULL if nothing is, and for no check. */
    const char *(*check)(const void *options);
    /** @param file  NULL only with an option that stands alone
     *  @return the exit code; `error` says why unless that is told already */
    evl_exit (*run)(const char *file, const void *options, evl_error *error);
} command;

#define OPTION_ROWS(rows) .n_options = (int)(sizeof(rows) / sizeof *(rows)), .options = (rows)

/* Rows that several commands have, for the member of the same name in their options. */
#define OPTION_ROW_HELP {OPTION_HELP, 'h', "--help", NULL, 0, "this text"}
#define OPTION_ROW_SET(options)                                                                                        \
    {OPTION_LIST,                                                                                                      \
     0,                                                                                                                \
     "--set",                                                                                                          \
     "PATH=VALUE",                                                                                                     \
     offsetof(options, set),                                                                                           \
     "change the case, such as wheels.pinion.teeth=25; VALUE is YAML; may be repeated"}
#define OPTION_ROW_QUIET(options)                                                                                      \
    {OPTION_FLAG,                                                                                                      \
     'q',                                                                                                              \
     "--quiet",                                                                                                        \
     NULL,                                                                                                             \
     offsetof(options, quiet),                                                                                         \
     "no progress and no summary; warnings and errors only"}
#define OPTION_ROW_JSON(options)                                                                                       \
    {OPTION_FLAG, 0, "--json", NULL, offsetof(options, json), "one JSON object, in SI units and radians"}
