/** What a case file may say: one table of all keys. The keys of laws and loads are added from the tables of the model. */
#ifndef EVOLVENT_CASE_SCHEMA_H
#define EVOLVENT_CASE_SCHEMA_H

#include "case/case_tree.h"
#include "case/description.h"

typedef enum {
    KEY_NUMBER,     /**< a number in the range, or one of the words */
    KEY_INTEGER,    /**< a whole number in the range */
    KEY_PAIR,       /**< [x, y], both in the range */
    KEY_TRIPLE,     /**< [x, y, z], all in the range */
    KEY_QUATERNION, /**< [w, x, y, z], all in the range */
    KEY_SERIES,     /**< a list of numbers */
    KEY_NAMED,      /**< name: number, for each name */
    KEY_TEXT,       /**< any text */
    KEY_NAME,       /**< a word that names this block in paths and references */
    KEY_REFERENCE,  /**< the name of a material or wheel */
    KEY_REFERENCES, /**< [name, name] of two wheels */
    KEY_CHOICE,     /**< one of the words */
    KEY_BLOCK,      /**< keys of the block `holds` */
    KEY_LIST,       /**< a list of blocks `holds`, as many as the range says */
    KEY_MAP         /**< name: block `holds`, as many as the range says */
} key_type;

/** One key. */
typedef struct {
    const char *block;    /**< the block that has it; CASE_ROOT for the whole file */
    const char *variants; /**< values of the block's first key with which it may stand, separated by blanks; "" for all;
                      "+KEY": it may stand beside that key only */
    const char *key;
    key_type type;
    const char *unit; /**< "" if none */
    double minimum;   /**< range; -/+HUGE_VAL if unbounded */
    double maximum;
    bool minimum_open; /**< the end itself is refused */
    bool maximum_open;
    bool required;
    const char *default_text; /**< YAML; NULL: none, the key stays away. {driving} stands for the value of that key */
    const char *words;        /**< choices, separated by blanks, else "" */
    const char *holds;        /**< block of KEY_BLOCK, KEY_LIST, KEY_MAP, else "" */
    const char *text;         /**< what it means, one line */
} case_key;

#define CASE_ROOT "case"

typedef struct {
    int n;
    case_key *keys; /**< keys of a block stand together, the one that selects the variant first */
    int n_owned;
    char **owned; /**< texts made for the keys of laws and loads */
} case_schema;

/** The table for a model with these laws. */
case_schema *schema_create(const law_tables *laws);
void schema_delete(case_schema **schema);

/** The key of a block in a variant ("" if the block has none); NULL if there is none. */
const case_key *schema_find(const case_schema *schema, const char *block, const char *variant, const char *key);
/** Whether the key may stand in this variant. */
bool key_in_variant(const case_key *key, const char *variant);
/** The other key of the block that this one needs beside it; NULL if it needs none. */
const char *key_needs(const case_key *key);

/** "greater than 0", "from 3 to 10000": the range in words, "" if unbounded. */
void key_range_text(const case_key *key, char text[128]);

/** Check a tree against the table, fill in the defaults, and put the keys in the table's order.
 *  @param path  the case file, for the places in messages
 *  @return false with the first fault in `error` */
bool schema_check(const case_schema *schema, const char *path, case_node *root, evl_error *error);

/** Print the table as a Markdown reference. */
void schema_print(FILE *stream, const case_schema *schema);

#endif
