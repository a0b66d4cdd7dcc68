/** evolvent in another program's process: cases, their runs and analyses, results in memory.
 *
 *  Nothing here ends the process, prints, catches signals, or keeps anything between calls but what a caller holds. Any number of
 *  threads may call at once, also with one case, which no call changes; a result is that of the program evolvent to the last bit.
 *  Who gets NULL, or not EVOLVENT_OK, finds the reason in `error`: the words of the program's line. Every `error` may be NULL. Texts
 *  are UTF-8, quantities in SI units and radians. docs/calling.md has examples. */
#ifndef EVOLVENT_EVOLVENT_H
#define EVOLVENT_EVOLVENT_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/** How a call ended: the exit codes of the program. */
typedef enum evolvent_code {
    EVOLVENT_OK = 0,
    EVOLVENT_USAGE = 2,       /**< the call itself: a malformed "PATH=VALUE", a request that is none */
    EVOLVENT_CASE = 3,        /**< bad case, also a refused path or value */
    EVOLVENT_INTEGRATION = 4, /**< the integration failed */
    EVOLVENT_MEMORY = 71,     /**< not enough memory; what the call had taken of it may be lost */
    EVOLVENT_RESULT = 74,     /**< a value does not fit into the result */
    EVOLVENT_INTERRUPTED = 75 /**< *stop was set */
} evolvent_code;

typedef struct evolvent_error {
    evolvent_code code;
    char place[1280];   /**< "CASE.yaml:12:5", or the option that was given; "" if there is none */
    char message[1024]; /**< what is wrong and what to do, one line */
} evolvent_error;

/** A case that was read and checked, with its gearbox. */
typedef struct evolvent_case evolvent_case;
/** What an analysis found: variables with dimensions and attributes, as in the program's file. */
typedef struct evolvent_record evolvent_record;

/** Version of this library, such as "0.1.0". */
const char *evolvent_version(void);

/** Read the case at a path, then set what `set` says: n_set texts "PATH=VALUE". */
evolvent_case *evolvent_case_read(const char *path, int n_set, const char *const *set, evolvent_error *error);
/** The same of the text of a case. @param name  what errors call it */
evolvent_case *evolvent_case_parse(const char *name, const char *text, int n_set, const char *const *set,
                                   evolvent_error *error);
/** NULL is allowed, here and in the other procedures that free. */
void evolvent_case_free(evolvent_case *gearbox);

/** Integrate the case.
 *  @param stop    ends the run when anyone has set it to another value than 0, a handler of signals too; NULL: nothing does
 *  @param record  what there is, to be freed; also of a run that failed or was stopped, up to there. NULL if there is nothing */
evolvent_code evolvent_run(const evolvent_case *gearbox, const volatile int *stop, evolvent_record **record,
                           evolvent_error *error);

/** What `evolvent static` is asked for, as texts; NULL: as there. */
typedef struct evolvent_static_request {
    const char *mesh, *torque, *speed, *points;
} evolvent_static_request;
/** A mesh at rest under torques. @param request  NULL: nothing in particular. The others as of evolvent_run */
evolvent_code evolvent_static(const evolvent_case *gearbox, const evolvent_static_request *request,
                              const volatile int *stop, evolvent_record **record, evolvent_error *error);

/** What `evolvent respond` is asked for, as texts; NULL: as there. */
typedef struct evolvent_respond_request {
    const char *over;      /**< "PATH=FROM:TO[:STEPS]" */
    const char *direction; /**< "up", "down" or "both", which NULL is */
    const char *periods;
} evolvent_respond_request;
/** Motions over a parameter that goes up and down. The case is prepared for every value: so it is named, not handed over.
 *  @param name  path of the case file, or of its text what errors call it
 *  @param text  of the case; NULL: that of the file
 *  @param set   n_set texts "PATH=VALUE". The others as of evolvent_run: a record has the values that were done */
evolvent_code evolvent_respond(const char *name, const char *text, int n_set, const char *const *set,
                               const evolvent_respond_request *request, const volatile int *stop,
                               evolvent_record **record, evolvent_error *error);

/** What `evolvent modes` is asked for: one of these; neither: the steady state where the case starts. */
typedef struct evolvent_modes_request {
    const char *at, *mesh_position; /**< as texts; NULL: not asked for */
    int mean;                       /**< not 0: with the mean over the positions of the meshes */
} evolvent_modes_request;
/* Each a text in JSON, as the program prints it with --json, to be freed by evolvent_text_free. */
/** Natural frequencies, damping, shapes. */
char *evolvent_modes(const evolvent_case *gearbox, const evolvent_modes_request *request, const volatile int *stop,
                     evolvent_error *error);
/** The case with every default, its geometry, its warnings. */
char *evolvent_show(const evolvent_case *gearbox, evolvent_error *error);
/** The numbers that the case gives, by their paths, in their units. */
char *evolvent_parameters(const evolvent_case *gearbox, evolvent_error *error);
void evolvent_text_free(char *text);

/* ---- records ---- */

typedef enum evolvent_type {
    EVOLVENT_REAL = 0,    /**< double; NaN: no value */
    EVOLVENT_INTEGER = 1, /**< int */
    EVOLVENT_TEXT = 2     /**< const char * */
} evolvent_type;

enum { EVOLVENT_MOST_DIMENSIONS = 5 };

/** A variable; it lives as long as its record. */
typedef struct evolvent_variable {
    const char *name, *units, *long_name, *symbol;
    const char *rates; /**< variables, between blanks, whose sum is its derivative by time; "": none is known */
    evolvent_type type;
    int is_of_events; /**< not 0: of the events, whose dimensions are their own; else of the record itself */
    int rank;
    const char *dimensions[EVOLVENT_MOST_DIMENSIONS]; /**< [rank] a variable of a dimension's name is its coordinate */
    size_t lengths[EVOLVENT_MOST_DIMENSIONS];         /**< [rank] */
    const void *values;                               /**< the last dimension fastest */
    int n_flags; /**< not 0: the values 0 to n_flags - 1 mean the words of flag_meanings, between blanks */
    const char *flag_meanings;
} evolvent_variable;

/** What is said of a record as a whole, such as the whole case and how the run ended. */
typedef struct evolvent_attribute {
    const char *name;
    evolvent_type type;
    const char *text;
    double real;
    long long integer;
} evolvent_attribute;

const evolvent_variable *evolvent_record_variables(const evolvent_record *record, int *n);
const evolvent_attribute *evolvent_record_attributes(const evolvent_record *record, int *n);
/** All that is said of a record's variables but lengths and numbers: their texts, dimensions, types, and the values of those that are
 *  texts. What a caller makes of it serves every record with the same bytes. @param size  how many bytes */
const void *evolvent_record_layout(const evolvent_record *record, size_t *size);
/** A variable of the record itself by its name; NULL if there is none. */
const evolvent_variable *evolvent_record_find(const evolvent_record *record, const char *name);
void evolvent_record_free(evolvent_record *record);

#ifdef __cplusplus
}
#endif

#endif
