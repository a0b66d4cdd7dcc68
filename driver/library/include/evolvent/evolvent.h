/** evolvent within another program's process: cases, runs and analyses, results in memory.
 *
 *  The library does not end the process, print, catch signals or keep data between calls, except the objects that the
 *  caller holds. Any number of threads may call it at once, also with one case, which no call changes. Results are
 *  bitwise those of the program evolvent. If a call returns NULL, or not EVOLVENT_OK, the reason is in `error`, with
 *  the program's message. Every `error` may be NULL. Texts are UTF-8, quantities in SI units and radians.
 *  docs/guides/calling.md has examples. */
#ifndef EVOLVENT_EVOLVENT_H
#define EVOLVENT_EVOLVENT_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Result of a call: the exit codes of the program. */
typedef enum evolvent_code {
    EVOLVENT_OK = 0,
    EVOLVENT_USAGE = 2,       /**< the call itself: a malformed "PATH=VALUE", an invalid request */
    EVOLVENT_CASE = 3,        /**< bad case, also a refused path or value */
    EVOLVENT_INTEGRATION = 4, /**< the integration failed */
    EVOLVENT_MEMORY = 71,     /**< not enough memory; memory allocated by the call may be lost */
    EVOLVENT_RESULT = 74,     /**< a value does not fit into the result */
    EVOLVENT_INTERRUPTED = 75 /**< *stop was set */
} evolvent_code;

typedef struct evolvent_error {
    evolvent_code code;
    char place[1280];   /**< "CASE.yaml:12:5", or the option; "" if there is none */
    char message[1024]; /**< the fault and its remedy, one line */
} evolvent_error;

/** A case, read and checked, with its gearbox. */
typedef struct evolvent_case evolvent_case;
/** Result of an analysis: variables with dimensions and attributes, as in the program's file. */
typedef struct evolvent_record evolvent_record;

/** Version of this library, such as "0.1.0". */
const char *evolvent_version(void);

/** Read the case at a path, then apply `set`: n_set texts "PATH=VALUE". */
evolvent_case *evolvent_case_read(const char *path, int n_set, const char *const *set, evolvent_error *error);
/** Same for the text of a case. @param name  name in error messages */
evolvent_case *evolvent_case_parse(const char *name, const char *text, int n_set, const char *const *set,
                                   evolvent_error *error);
/** NULL is allowed, as in the other procedures that free. */
void evolvent_case_free(evolvent_case *gearbox);

/** Integrate the case.
 *  @param stop    ends the run when set to a value other than 0, also by a signal handler; NULL: no interrupt
 *  @param record  the result, to be freed; for a run that failed or was stopped, the part so far. NULL if there is none */
evolvent_code evolvent_run(const evolvent_case *gearbox, const volatile int *stop, evolvent_record **record,
                           evolvent_error *error);

/** Options of `evolvent static`, as texts; NULL: the default there. */
typedef struct evolvent_static_request {
    const char *mesh, *torque, *speed, *points;
} evolvent_static_request;
/** Quasi-static analysis of a mesh under torques. @param request  NULL: defaults. The others as in evolvent_run */
evolvent_code evolvent_static(const evolvent_case *gearbox, const evolvent_static_request *request,
                              const volatile int *stop, evolvent_record **record, evolvent_error *error);

enum { EVOLVENT_ROOT_ARCS = 13 };
/** Stress in the fillets of a tooth by unit line loads on the flanks of a wheel with finite elements: its influence functions.
 *  @param wheel   its index
 *  @param flanks  [n] 0: right flank of the loaded tooth, which faces counterclockwise; 1: left flank
 *  @param rho     [n] radius of curvature of the flank at the load [m]
 *  @param teeth   [n] index of the loaded tooth minus that of the stressed one, counterclockwise
 *  @param arcs    [EVOLVENT_ROOT_ARCS] from the form circle [m]
 *  @param stress  [n][2][EVOLVENT_ROOT_ARCS] at these arcs of the right fillet, then of the left one [1/m] */
evolvent_code evolvent_root_influence(const evolvent_case *gearbox, int wheel, int n, const int *flanks,
                                      const double *rho, const int *teeth, double *arcs, double *stress,
                                      evolvent_error *error);

/** Options of `evolvent respond`, as texts; NULL: the default there. */
typedef struct evolvent_respond_request {
    const char *over;      /**< "PATH=FROM:TO[:STEPS]" */
    const char *direction; /**< "up", "down" or "both" (NULL) */
    const char *periods;
} evolvent_respond_request;
/** Motions over an increasing and decreasing parameter. The case is prepared again for every value: pass its name or
 *  text.
 *  @param name  path of the case file, or the name of its text in error messages
 *  @param text  of the case; NULL: that of the file
 *  @param set   n_set texts "PATH=VALUE". The others as in evolvent_run: a record has the values done so far */
evolvent_code evolvent_respond(const char *name, const char *text, int n_set, const char *const *set,
                               const evolvent_respond_request *request, const volatile int *stop,
                               evolvent_record **record, evolvent_error *error);

/** Options of `evolvent modes`: at most one of these; none: the steady state at the start of the case. */
typedef struct evolvent_modes_request {
    const char *at, *mesh_position; /**< as texts; NULL: not requested */
    int mean;                       /**< not 0: the mean over the positions of the meshes */
} evolvent_modes_request;
/* Each returns a text to be freed by evolvent_text_free: JSON, as the program prints it with --json, unless stated
 * otherwise. */
/** Natural frequencies, damping, mode shapes. */
char *evolvent_modes(const evolvent_case *gearbox, const evolvent_modes_request *request, const volatile int *stop,
                     evolvent_error *error);
/** The case with all defaults, its geometry, its warnings. */
char *evolvent_show(const evolvent_case *gearbox, evolvent_error *error);
/** The numbers of the case by their paths, in their units. */
char *evolvent_parameters(const evolvent_case *gearbox, evolvent_error *error);
/** Data sheet of a mesh.
 *  @param mesh  name or index, as a text; NULL: the first one
 *  @param html  0: JSON; else HTML with a drawing, an element <section> of a page */
char *evolvent_datasheet(const evolvent_case *gearbox, const char *mesh, int html, evolvent_error *error);
void evolvent_text_free(char *text);

/* ---- records ---- */

typedef enum evolvent_type {
    EVOLVENT_REAL = 0,    /**< double; NaN: no value */
    EVOLVENT_INTEGER = 1, /**< int */
    EVOLVENT_TEXT = 2     /**< const char * */
} evolvent_type;

enum { EVOLVENT_MOST_DIMENSIONS = 5 };

/** A variable; valid as long as its record. */
typedef struct evolvent_variable {
    const char *name, *units, *long_name, *symbol;
    const char *rates; /**< names, separated by blanks, of variables that sum to its time derivative; "": unknown */
    evolvent_type type;
    int is_of_events; /**< not 0: belongs to the events, which have their own dimensions; else to the record itself */
    int rank;
    const char *dimensions[EVOLVENT_MOST_DIMENSIONS]; /**< [rank] a variable of a dimension's name is its coordinate */
    size_t lengths[EVOLVENT_MOST_DIMENSIONS];         /**< [rank] */
    const void *values;                               /**< the last dimension fastest */
    int n_flags; /**< not 0: the values 0 to n_flags - 1 have the meanings in flag_meanings, separated by blanks */
    const char *flag_meanings;
} evolvent_variable;

/** An attribute of the whole record, such as the case and how the run ended. */
typedef struct evolvent_attribute {
    const char *name;
    evolvent_type type;
    const char *text;
    double real;
    long long integer;
} evolvent_attribute;

const evolvent_variable *evolvent_record_variables(const evolvent_record *record, int *n);
const evolvent_attribute *evolvent_record_attributes(const evolvent_record *record, int *n);
/** Description of a record's variables without lengths and numbers: texts, dimensions, types, and the values of text
 *  variables. Data derived from it are valid for every record with the same bytes. @param size  number of bytes */
const void *evolvent_record_layout(const evolvent_record *record, size_t *size);
/** A variable of the record itself by its name; NULL if there is none. */
const evolvent_variable *evolvent_record_find(const evolvent_record *record, const char *name);
void evolvent_record_free(evolvent_record *record);

#ifdef __cplusplus
}
#endif

#endif
