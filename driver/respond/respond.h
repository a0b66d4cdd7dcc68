/** Motions of a gearbox over one parameter that increases and decreases in steps: the motion at a value starts from the
 *  final state at the previous value. docs/guides/response.md. */
#pragma once

#include "base/status.h"
#include "files/response.h"
#include "files/wheel_store.h"

#include <signal.h>
#include <stdbool.h>

struct respond_orbits_setup;

typedef struct {
    const char *over; /**< PATH=FROM:TO[:STEPS] */
    const char *text; /**< of the case; NULL: that of its file */
    bool up, down;
    /** finds and continues periodic orbits: respond_orbits; NULL: motions, up and down. A pointer, so that other
     *  programs need not link it */
    bool (*orbits)(const struct respond_orbits_setup *setup, evl_error *error);
    int n_values;          /**< values in the range at which stable orbits of each branch are required, too; 0: none */
    int longest;           /**< largest length of orbits in common periods; 0: the default */
    int most;              /**< largest number of common periods at a value; 0: the default */
    const char *path;      /**< of the result */
    struct history **kept; /**< for a result in memory: receives it; NULL: on file */
    const char *versions;  /**< of the programs and libraries used */
    int n_set;
    const char *const *set;
    bool quiet;
    const volatile sig_atomic_t
        *interrupt;                    /**< ends it when it is not 0; NULL: the number of a signal to the process */
    const char *(*who)(int interrupt); /**< name of the interrupt's source; NULL: that signal */
    wheel_store *wheels;               /**< known compliant wheels, owned by the caller; NULL: none */
    void *self;
    void (*told)(void *self, const response *response); /**< called with the complete response; NULL: not called */
} respond_options;

/** Read the limit of common periods at a value. @return false, with `respond_periods` as message */
bool respond_read_most(const char *text, int *most);
extern const char respond_periods[];

/** Read the number of values for orbits. @return false, with `respond_values` as message */
bool respond_read_values(const char *text, int *n);
extern const char respond_values[];
/** Read the largest length of orbits in common periods. @return false, with `respond_longest` as message */
bool respond_read_longest(const char *text, int *n);
extern const char respond_longest[];

/** Check the request without computing. @return the exit code, with the reason in `error` */
evl_exit respond_check(const char *case_path, const respond_options *options, evl_error *error);
/** @param case_path  file of the case, or the name of its text in error messages
 *  @return the exit code, with the reason in `error` */
evl_exit respond(const char *case_path, const respond_options *options, evl_error *error);
