/** Motions of a gearbox over one parameter that goes up and down in steps: the motion at a value begins where that of the value
 *  before ended. docs/response.md. */
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
    /** finds periodic orbits and follows them: respond_orbits; NULL: motions, up and down. Who has no use for it, links none of it */
    bool (*orbits)(const struct respond_orbits_setup *setup, evl_error *error);
    int n_values;          /**< of the range at which each branch of orbits has its stable ones too; 0: none */
    int longest;           /**< common periods of orbits at most; 0: the usual number */
    int most;              /**< common periods at a value; 0: the usual number */
    const char *path;      /**< of the result */
    struct history **kept; /**< in memory: where the result is then; NULL: on file */
    const char *versions;  /**< of all that made it */
    int n_set;
    const char *const *set;
    bool quiet;
    const volatile sig_atomic_t
        *interrupt;                    /**< ends it when it is not 0; NULL: the number of a signal to the process */
    const char *(*who)(int interrupt); /**< by whom; NULL: by that signal */
    wheel_store *wheels;               /**< known ones that give way, of the caller; NULL: none */
    void *self;
    void (*told)(void *self, const response *response); /**< hears of a response that is done; NULL: nobody does */
} respond_options;

/** Read how many common periods there may be at a value. @return false with `respond_periods` to say */
bool respond_read_most(const char *text, int *most);
extern const char respond_periods[];

/** Read at how many values there are to be orbits. @return false with `respond_values` to say */
bool respond_read_values(const char *text, int *n);
extern const char respond_values[];
/** Read of how many common periods orbits may be. @return false with `respond_longest` to say */
bool respond_read_longest(const char *text, int *n);
extern const char respond_longest[];

/** Whether anything of it would be refused. @return the exit code, with the reason in `error` */
evl_exit respond_check(const char *case_path, const respond_options *options, evl_error *error);
/** @param case_path  file of the case, or what errors call its text
 *  @return the exit code, with the reason in `error` */
evl_exit respond(const char *case_path, const respond_options *options, evl_error *error);
