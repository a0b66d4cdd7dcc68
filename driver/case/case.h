/** Case file: read, edited by --set options, checked against the schema, and resolved to a description. */
#pragma once

#include "base/status.h"
#include "case/case_schema.h"
#include "case/description.h"

#include <stdbool.h>

typedef struct case_file case_file;
/** A case parsed once, to be edited and read any number of times. */
typedef struct case_base case_base;

/** Parse the text of a case without checking it.
 *  @param name    name in error messages, such as a path
 *  @param schema  keys and values that a case may contain; must outlive the base
 *  @return NULL with the reason in `error` */
case_base *case_base_parse(const char *name, const char *text, const case_schema *schema, evl_error *error);
void case_base_delete(case_base **base);
/** As case_read, with the base's text instead of a file. The base is not changed and must outlive the result.
 *  @param[in,out] file  a case of this base that is no longer needed, or NULL: becomes the new case. A similar case
 *                       with other numbers is produced in a small part of the time of a new one
 *  @return false with the reason in `error`; then `file` can be passed to the next call and must not be used otherwise */
bool case_override(const case_base *base, int n_set, const char *const *set_options, case_file **file,
                   evl_error *error);
/** Names of the base's elements of a list such as "meshes", as used in paths: the index for an element without a name. */
const char **case_base_elements(const case_base *base, const char *list, memory_arena *arena, int *n);
/** The text of a scalar in the base at a path as in --set; NULL if the base does not contain it. */
const char *case_base_text(const case_base *base, const char *path);
/** Whether a --set path leads to a key that a case may have, in any variant, and to elements that exist in the base.
 *  @return false with the fault of the path in error->message */
bool case_base_has_path(const case_base *base, const char *path, evl_error *error);

/** A value in the form that its key accepts. */
typedef struct {
    bool is_number, has_unit; /**< has_unit: it was given with a unit */
    double value;             /**< in the key's unit */
    const char *unit;         /**< the key's; "" if it has none */
} case_quantity;

/** As case_base_parse, of the case file at `path`. */
case_base *case_base_read(const char *path, const case_schema *schema, evl_error *error);
/** Convert the value of an option "PATH=VALUE" to a number in the unit of its key; ranges are not checked.
 *  @return false with the reason in `error`: no such path, or not a unit of the key */
bool case_base_convert(const case_base *base, const char *option, case_quantity *quantity, evl_error *error);

/** Read the case at `path` ("-": standard input), apply the options in their order, check and resolve.
 *  @param set_options  [n_set] each "PATH=VALUE"
 *  @param schema       keys and values that a case may contain
 *  @return NULL with the first fault in `error`: EVL_EXIT_USAGE for a malformed option, else EVL_EXIT_CASE */
case_file *case_read(const char *path, int n_set, const char *const *set_options, const case_schema *schema,
                     evl_error *error);
/** Same for a text. @param name  name in error messages */
case_file *case_parse(const char *name, const char *text, int n_set, const char *const *set_options,
                      const case_schema *schema, evl_error *error);
/** Free a case and set the pointer to NULL; no effect if it is already NULL. */
void case_delete(case_file **file);

/** A number outside the plausible range of its key. */
typedef struct {
    const char *text;   /**< location, path, value, range and the likely intended value, one line */
    const char *option; /**< "PATH=VALUE" of the --set option of its origin; NULL: the file */
} case_warning;

/** Former names of keys, and numbers outside the plausible ranges of their keys: one warning for each key, and one for
 *  each key and option.
 *  @param arena  owns all that is returned */
case_warning *case_warnings(const case_file *file, memory_arena *arena, int *n);

/** The case as plain data; valid as long as the case. */
const description *case_description(const case_file *file);
/** The path passed to case_read; "stdin" for standard input. */
const char *case_path(const case_file *file);
/** The complete case as YAML text: options applied, all defaults filled in (those that the model decides by
 *  case_settle_...), no derived values. Reading it gives the same description. NULL for a case of case_override, to save
 *  time. */
const char *case_text(const case_file *file);
/** Same without the keys that do not affect the motion: the title, and the step limit of a run. A new string. */
char *case_text_of_motion(const case_file *file);
/** Same in engineering units: `module: 3 mm`, and lists of more than 1000 numbers shortened. Reading it gives the same
 *  description if no list was shortened. A new string. */
char *case_text_for_reading(const case_file *file, const case_schema *schema);

/** Fill in the integrator and the longest step of a case that does not specify them, and the tolerance, which may
 *  follow from the accuracy. */
void case_settle_simulation(case_file *file, integrator_kind integrator, double tolerance);

/** Fill in the damping parameters of a mesh that are left to the model.
 *  @param parameters  all parameters of the law, in the order of its rows */
void case_settle_damping(case_file *file, int mesh, const case_schema *schema, const double *parameters);

/** The checked tree, with the file's own keys and units. */
const struct case_node *case_root(const case_file *file);

/** A message preceded by its subject, such as "meshes.pinion-gear.backlash: ...". @return a new string */
char *case_message(const char *field, const char *message);
/** Turn a refusal by the model into an error that names the location in the file or the option.
 *  @param field  path of the refused value, such as "wheels.gear.support.stiffness"; "" for the whole case. A key that
 *                is not given refers to the location of its block.
 *  @return false */
bool case_refuse(const case_file *file, const char *field, const char *message, evl_error *error);
