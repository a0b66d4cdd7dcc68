/** Description of a command: name, texts, options, action. Each has a file of its own and a line in commands.inc;
 *  parsing, help and error messages follow from the struct. */
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
    OPTION_ALONE, /**< the same; no file and no other option is allowed with it */
    OPTION_LIST,  /**< option_values */
    OPTION_HELP   /**< none, and no offset: prints the help of the command */
} option_kind;

typedef struct {
    option_kind kind;
    char letter;          /**< 0 if it has no short form */
    const char *name;     /**< with its dashes */
    const char *argument; /**< name of its value */
    size_t offset;        /**< offset of its value in the command's options */
    const char *text;
} option_row;

typedef struct {
    const char *name; /**< "": the program itself */
    const char *synopsis, *summary, *text;
    const char *file;   /**< argument; NULL: none */
    bool takes_several; /**< files, one after the other; the exit code is the highest one */
    size_t size;        /**< of its options, a struct initialised to zeros */
    int n_options;
    const option_row *options;
    /** Fault of a combination of options; NULL if there is none, or no check. */
    const char *(*check)(const void *options);
    /** @param file  NULL only with an option of kind OPTION_ALONE
     *  @return the exit code; `error` has the reason unless it is already printed */
    evl_exit (*run)(const char *file, const void *options, evl_error *error);
} command;

#define OPTION_ROWS(rows) .n_options = (int)(sizeof(rows) / sizeof *(rows)), .options = (rows)

/* Rows common to several commands, for the member of the same name in their options. */
#define OPTION_ROW_HELP {OPTION_HELP, 'h', "--help", NULL, 0, "print this help"}
#define OPTION_ROW_SET(options)                                                                                        \
    {OPTION_LIST,                                                                                                      \
     0,                                                                                                                \
     "--set",                                                                                                          \
     "PATH=VALUE",                                                                                                     \
     offsetof(options, set),                                                                                           \
     "change a value of the case, such as wheels.pinion.teeth=25; VALUE is YAML; may be repeated"}
#define OPTION_ROW_QUIET(options)                                                                                      \
    {OPTION_FLAG,                                                                                                      \
     'q',                                                                                                              \
     "--quiet",                                                                                                        \
     NULL,                                                                                                             \
     offsetof(options, quiet),                                                                                         \
     "print only warnings and errors, no progress and no summary"}
#define OPTION_ROW_JSON(options)                                                                                       \
    {OPTION_FLAG, 0, "--json", NULL, offsetof(options, json), "print one JSON object, in SI units and radians"}
