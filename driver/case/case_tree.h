/** Case file as a tree of nodes with their origin: a line of the file or a --set option.
 *  libyaml is used by case_yaml.c and case_write.c only. */
#pragma once

#include "base/json.h"
#include "base/memory.h"
#include "base/status.h"

#include <evolvent/description.h>
#include <stdbool.h>

/** Origin of a node. */
typedef struct {
    int line, column;   /**< from 1; 0 if not from the file */
    const char *option; /**< "PATH=VALUE" of the --set option, not owned; NULL if from the file */
} case_location;

typedef enum { NODE_SCALAR, NODE_SEQUENCE, NODE_MAPPING } node_kind;

typedef struct case_node case_node;

/** One entry of a sequence (key NULL) or mapping. */
typedef struct {
    char *key;
    const char *former; /**< name under which the key was given, if that is a former one; else NULL */
    case_location key_location;
    case_node *value;
    const evl_row *row; /**< of a key accepted by schema_check; else NULL */
} case_entry;

/** A tree is valid as long as the arena in which it was created. */
struct case_node {
    memory_arena *arena;
    node_kind kind;
    case_location location;
    char *text;          /**< of a scalar, else NULL */
    const char *written; /**< original text of a number given with a unit; else NULL */
    bool plain;          /**< scalar without quotes: may be a number or null */
    int n;               /**< entries of a sequence or mapping */
    int capacity;
    case_entry *entries;
};

/* ---- nodes ---- */

case_node *node_create(memory_arena *arena, node_kind kind, case_location location);
case_node *node_create_scalar(memory_arena *arena, const char *text, bool plain, case_location location);
/** A copy of the tree with the same locations. */
case_node *node_copy(memory_arena *arena, const case_node *node);

/** Append; copies `key` (NULL in a sequence). */
void node_append(case_node *node, const char *key, case_location key_location, case_node *value);
/** Index of the entry with this key, or -1. */
int node_find(const case_node *mapping, const char *key);
/** The value of a key, or NULL. */
case_node *node_get(const case_node *mapping, const char *key);
/** The text of a scalar value of a key, or NULL. */
const char *node_get_text(const case_node *mapping, const char *key);
/* For blocks checked by the schema: the key exists and has the type. */
double node_number(const case_node *node);
bool node_is_number(const case_node *node);
double node_get_number(const case_node *mapping, const char *key);
/** The number with its unit, for messages: "0.003 m", or "3 mm (0.003 m)" if it was given in mm. A new string. */
char *node_quantity(const case_node *node, const char *unit);

/** Replace a number with a unit by a number in the key's unit. */
void node_convert(case_node *node, double value);

/** Whether a value is missing: null, ~ or empty. */
bool node_is_null(const case_node *node);
/** "a list", "a block", "nothing" or the quoted start of the scalar, for messages. */
void node_describe(const case_node *node, char text[64]);

/** Name of an element of a list of blocks in paths: its `name`, else "driving-driven" of a mesh.
 *  @return a new string, or NULL if it has none */
char *node_element_name(const case_node *element);

/** Index given by the first segment of a path: digits only, else -1. */
int node_index(const char *path);
/** Index of the entry for a segment of a path, an element of a list by name or number; -1 if none. */
int node_step(const case_node *node, const char *segment);

/** "PATH:LINE:COLUMN" or "--set OPTION". */
void location_text(const char *path, case_location location, char text[EVL_ERROR_LOCATION_LENGTH]);

/* ---- reading, editing, writing ---- */

/** Name of a file in messages: its path, or "stdin" for "-" (standard input). */
const char *tree_file_name(const char *path);

/** Read the one YAML document of a file. @return NULL with the reason in `error` */
case_node *tree_load_file(memory_arena *arena, const char *path, evl_error *error);
/** Read the one YAML document of a text; line numbers in messages refer to a file called `name`. */
case_node *tree_load_named(memory_arena *arena, const char *name, const char *text, evl_error *error);
/** Read a YAML text; all its nodes get `location`, which error messages name as well.
 *  @return NULL with the reason in `error`; empty text gives a null scalar */
case_node *tree_load_text(memory_arena *arena, const char *text, case_location location, evl_error *error);

/** Write a tree as JSON: unquoted numbers are numbers, all other scalars are text. */
void tree_write_json(json_writer *writer, const char *key, const case_node *node);

/** Apply one --set option "PATH=VALUE" to the tree. New nodes refer to `option`, which must outlive the tree. Unknown
 *  keys are added; the schema check refuses them later. Former keys are renamed, in the path and in the value.
 *  @return false with the reason in `error`: EVL_EXIT_USAGE if malformed, EVL_EXIT_CASE if refused */
bool tree_set(case_node *root, const char *option, evl_error *error);

/** The tree as YAML text, a new string. */
char *tree_text(const case_node *root);
