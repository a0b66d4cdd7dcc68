/** A case file: read, edited by --set options, checked against the schema, and resolved to a description. */
#pragma once

#include "base/status.h"
#include "case/case_schema.h"
#include "case/description.h"

#include <stdbool.h>

typedef struct case_file case_file;
/** A case that was parsed once, to be edited and read any number of times. */
typedef struct case_base case_base;

/** Parse the text of a case; nothing is checked yet.
 *  @param name  what errors call it, such as a path
 *  @param schema  what a case may say; has to outlive the base
 *  @return NULL with the reason in `error` */
case_base *case_base_parse(const char *name, const char *text, const case_schema *schema, evl_error *error);
void case_base_delete(case_base **base);
/** The same as case_read with the base's text for a file. The base stays as it is and has to outlive the result.
 *  @param[in,out] file  a case of this base that is not needed any more, or NULL: becomes the new case. A case like it,
 *                       with other numbers, is made in a small part of the time that a new one takes
 *  @return false with the reason in `error`; then `file` serves for the next call and for nothing else */
bool case_edit(const case_base *base, int n_set, const char *const *set_options, case_file **file, evl_error *error);
/** Names of the base's elements of a list such as "meshes", as paths call them: the index where an element has no name. */
const char **case_base_elements(const case_base *base, const char *list, memory_pool *pool, int *n);
/** The text of a scalar that the base gives, as paths of --set lead to it; NULL if it gives none there. */
const char *case_base_text(const case_base *base, const char *path);
/** Whether a --set path leads to a key that a case may have, in whatever variant, and to elements that the base has.
 *  @return false with what is wrong with the path in error->message */
bool case_base_has_path(const case_base *base, const char *path, evl_error *error);

/** A value as its key takes it. */
typedef struct {
    bool is_number, has_unit; /**< has_unit: it was given with one */
    double value;             /**< in the key's unit */
    const char *unit;         /**< the key's; "" if it has none */
} case_quantity;

/** As case_base_parse, of the case file at `path`. */
case_base *case_base_read(const char *path, const case_schema *schema, evl_error *error);
/** What the value of an option "PATH=VALUE" is as a number in the unit of its key; no range is looked at.
 *  @return false with the reason in `error`: no such path, or not a unit of the key */
bool case_base_convert(const case_base *base, const char *option, case_quantity *quantity, evl_error *error);

/** Read the case at `path` ("-": standard input), apply the options in their order, check and resolve.
 *  @param set_options  [n_set] each "PATH=VALUE"
 *  @param schema       what a case may say
 *  @return NULL with the first thing that is wrong in `error`: EVL_EXIT_USAGE for a malformed option,
 *  else EVL_EXIT_CASE */
case_file *case_read(const char *path, int n_set, const char *const *set_options, const case_schema *schema,
                     evl_error *error);
/** The same of a text. @param name  what errors call it */
case_file *case_parse(const char *name, const char *text, int n_set, const char *const *set_options,
                      const case_schema *schema, evl_error *error);
/** Free a case and set the pointer to NULL. Nothing happens if it is NULL already. */
void case_delete(case_file **file);

/** A number outside the plausible range of its key. */
typedef struct {
    const char *text;   /**< location, path, value, range and the likely value, one line */
    const char *option; /**< "PATH=VALUE" of the --set option that gave it; NULL: the file */
} case_warning;

/** Numbers outside the plausible ranges of their keys: a warning for each key, and another one for each key and option.
 *  @param pool  of all that is returned */
case_warning *case_warnings(const case_file *file, memory_pool *pool, int *n);

/** The case as plain data; lives as long as the case. */
const description *case_description(const case_file *file);
/** The file as it was given to case_read; "stdin" for standard input. */
const char *case_path(const case_file *file);
/** The whole case as YAML text: options applied, every default filled in (those that the
 *  model decides by case_settle_...), nothing derived. Reading it gives the same description. NULL for a case of case_edit, which spares the time. */
const char *case_text(const case_file *file);
/** The same less what has no part in the motion: the title, and the steps after which a run gives up. A new string. */
char *case_text_of_motion(const case_file *file);
/** The same in engineering units: `module: 3 mm`, and lists of more than 1000 numbers cut. Reading it gives the same description too if
 *  none was cut. A new string. */
char *case_text_for_reading(const case_file *file, const case_schema *schema);

/** Fill in the integrator of a case that does not name one, its longest step, and the tolerance, which the case may leave to its
 *  accuracy. */
void case_settle_simulation(case_file *file, integrator_kind integrator, double tolerance);

/** Fill in what the damping law of a mesh leaves to the model.
 *  @param parameters  all of the law, in the order of its rows */
void case_settle_damping(case_file *file, int mesh, const case_schema *schema, const double *parameters);

/** The checked tree itself, with the file's own keys and units. */
const struct case_node *case_root(const case_file *file);

/** A message with what it is about in front, such as "meshes.pinion-gear.backlash: ...". @return a new string */
char *case_message(const char *field, const char *message);
/** Turn a refusal by the model into an error that names the place in the file or the option.
 *  @param field  path of what is refused, such as "wheels.gear.support.stiffness"; "" for the whole case. A key that the case does
 *                not give leads to the place of its block.
 *  @return false */
bool case_refuse(const case_file *file, const char *field, const char *message, evl_error *error);
