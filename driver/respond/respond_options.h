/** Request for a response, and its form for a search of periodic orbits. */
#pragma once

#include "files/response.h"
#include "files/wheel_store.h"
#include "respond/branch.h"
#include "respond/resume.h"

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
    int n_values;     /**< values in the range at which stable orbits of each branch are required, too; 0: none */
    int longest;      /**< largest length of orbits in common periods; 0: the default */
    int most;         /**< largest number of common periods at a value; 0: the default */
    const char *path; /**< of the result */
    struct history **in_memory; /**< for a result in memory: receives it; NULL: on file */
    const char *versions;       /**< of the programs and libraries used */
    int n_set;
    const char *const *set;
    bool quiet;
    const volatile sig_atomic_t
        *interrupt;                    /**< ends it when it is not 0; NULL: the number of a signal to the process */
    const char *(*who)(int interrupt); /**< name of the interrupt's source; NULL: that signal */
    wheel_store *wheels;               /**< known compliant wheels, owned by the caller; NULL: none */
    void *self;
    void (*on_response)(void *self,
                        const response *response); /**< called with the complete response; NULL: not called */
} respond_options;

typedef struct respond_orbits_setup {
    branch *sweep;          /**< the case over its range */
    const case_plan *first; /**< at its first value */
    resume *resume;         /**< its folder is open; its content is set here */
    const char *unit, *warnings;
    const respond_options *options;
} respond_orbits_setup;
