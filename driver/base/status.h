/** Exit codes of commands, and the one-line error message. Leaf module. */
#pragma once

#include <stdbool.h>
#include <stdio.h>

/** Every exit code of the program: name, number, meaning. */
#define EVL_EXIT_CODES(X)                                                                                              \
    X(EVL_EXIT_OK, 0, "done")                                                                                          \
    X(EVL_EXIT_PARTIAL, 1, "at least one case of a batch failed or was refused")                                       \
    X(EVL_EXIT_USAGE, 2, "invalid command line, including a malformed --set")                                          \
    X(EVL_EXIT_CASE, 3, "invalid case, including an invalid --set path or value")                                      \
    X(EVL_EXIT_INTEGRATION, 4, "the integration failed")                                                               \
    X(EVL_EXIT_MEMORY, 71, "not enough memory")                                                                        \
    X(EVL_EXIT_IO, 74, "output could not be written")                                                                  \
    X(EVL_EXIT_INTERRUPTED, 75, "interrupted by a signal")

#define EVL_EXIT_ENUMERATOR(name, number, text) name = (number),
typedef enum { EVL_EXIT_CODES(EVL_EXIT_ENUMERATOR) } evl_exit;
#undef EVL_EXIT_ENUMERATOR

/** One line "  code  meaning" for each exit code, as --help shows them. */
void evl_exit_print_table(FILE *stream);

enum { EVL_ERROR_LOCATION_LENGTH = 1280, EVL_ERROR_MESSAGE_LENGTH = 1024 };

/** Reason of a failure. code is EVL_EXIT_OK if there was none. */
typedef struct {
    evl_exit code;
    char location
        [EVL_ERROR_LOCATION_LENGTH]; /**< "CASE.yaml:12:5" or "--set wheels.gear.teeth=-3"; "" if there is none */
    char message[EVL_ERROR_MESSAGE_LENGTH]; /**< the fault and its remedy, one line without its newline */
} evl_error;

/** Fill an error; foreign text in it becomes one printable line (utf8_make_line).
 *  @param location  "" if there is none
 *  @return false, as a return value for the caller */
__attribute__((format(printf, 4, 5))) bool evl_error_set(evl_error *error, evl_exit code, const char *location,
                                                         const char *format, ...);

/** Report that a file cannot be written for the reason in errno: EVL_EXIT_IO. @return false */
bool evl_error_set_unwritten(evl_error *error, const char *path);
/** "PLACE: MESSAGE" of an error with a location, as a new string. */
char *evl_error_text(const evl_error *error);
/** Write "PLACE: MESSAGE", or "evolvent: MESSAGE" if there is no location, and a newline. */
void evl_error_print(FILE *stream, const evl_error *error);
