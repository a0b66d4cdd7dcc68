/* Conversion of YAML to nodes, event by event. Input that is too deep, too wide or too large stops the reading at once. */
#include "case/case_yaml.h"
#include "base/memory.h"
#include "case/case_tree.h"
#include "case/yaml_problem.h"

#include <stdlib.h>
#include <string.h>
#include <yaml.h>

enum {
    MOST_NODES = 3500 *
        1000,         /* a table of a million points; aliases multiply: a few lines can expand to any number of nodes */
    MOST_KEYS = 2000, /* of one block; names are looked up among them */
    MOST_ANCHORS = 10000,
    MOST_LEVELS = 32
};

typedef struct {
    const char *name;
    const case_node *node; /* NULL: still being read */
} anchor;

typedef struct {
    memory_arena *arena;    /* owns the nodes */
    const char *path;       /* NULL: the text of an option */
    case_location location; /* of an option */
    const char *text;       /* the complete text */
    size_t length;
    evl_error *error;
    yaml_parser_t parser;
    int n_nodes;
    case_entry *waiting; /* stack of the entries of unfinished blocks and lists */
    int n_waiting, capacity;
    anchor *anchors; /* sorted by name */
    int n_anchors;
} yaml_loader;

static case_location location_of(const yaml_loader *loader, yaml_mark_t mark)
{
    return loader->path == NULL ? loader->location
                                : (case_location){.line = (int)mark.line + 1, .column = (int)mark.column + 1};
}

/** @return NULL */
static void *refuse(const yaml_loader *loader, case_location location, const char *message)
{
    char text[EVL_ERROR_LOCATION_LENGTH];
    location_text(loader->path, location, text);
    (void)evl_error_set(loader->error, EVL_EXIT_CASE, text, "%s", message);
    return NULL;
}

/* ---- the parser ---- */

static void refuse_yaml(const yaml_loader *loader)
{
    yaml_mark_t mark;
    CLEANUP_FREE char *message =
        yaml_problem(&loader->parser, loader->path != NULL, loader->text, loader->length, &mark);
    (void)refuse(loader, location_of(loader, mark), message);
}

static bool next_event(yaml_loader *loader, yaml_event_t *event)
{
    if (!yaml_parser_parse(&loader->parser, event)) {
        refuse_yaml(loader);
        return false;
    }
    return true;
}

/* ---- anchors ---- */

/** Index of a name among the anchors, or its insertion index. */
static int anchor_index(const yaml_loader *loader, const char *name, bool *is_there)
{
    int low = 0, high = loader->n_anchors;
    *is_there = false;
    while (low < high && !*is_there) {
        const int middle = (low + high) / 2, order = strcmp(loader->anchors[middle].name, name);
        *is_there = order == 0;
        low = order == 0 ? middle : order < 0 ? middle + 1 : low;
        high = order > 0 ? middle : high;
    }
    return low;
}

static bool begin_anchor(yaml_loader *loader, const char *name, case_location location)
{
    bool is_there;
    const int at = anchor_index(loader, name, &is_there);
    if (is_there || loader->n_anchors == MOST_ANCHORS) {
        CLEANUP_FREE char *message =
            is_there ? xasprintf("the anchor '&%s' is given twice", name) : xstrdup("too many anchors");
        return refuse(loader, location, message) != NULL;
    }
    if (loader->anchors == NULL) {
        loader->anchors = xcalloc(MOST_ANCHORS, sizeof *loader->anchors);
    }
    memmove(loader->anchors + at + 1, loader->anchors + at, (size_t)(loader->n_anchors - at) * sizeof(anchor));
    loader->anchors[at] = (anchor){.name = arena_copy(loader->arena, name)};
    loader->n_anchors++;
    return true;
}

/* ---- nodes ---- */

static bool count_node(yaml_loader *loader, case_location location, int level)
{
    if (level > MOST_LEVELS) {
        return refuse(loader, location, "nested too deeply") != NULL;
    }
    return ++loader->n_nodes <= MOST_NODES ||
           refuse(loader, location, "too many values (aliases that multiply?)") != NULL;
}

/** Whether the node limit allows the same nodes once more. */
static bool count_again(yaml_loader *loader, const case_node *node, case_location location, int level)
{
    bool good = count_node(loader, location, level);
    for (int i = 0; i < node->n && good; i++) {
        good = count_again(loader, node->entries[i].value, location, level + 1);
    }
    return good;
}

static case_node *copy_of_anchor(yaml_loader *loader, const char *name, case_location location, int level)
{
    bool is_there;
    const int at = anchor_index(loader, name, &is_there);
    if (!is_there) {
        return refuse(loader, location, "not valid YAML: found undefined alias");
    }
    const case_node *node = loader->anchors[at].node;
    if (node == NULL) {
        return refuse(loader, location, "an alias that contains itself");
    }
    return count_again(loader, node, location, level) ? node_copy(loader->arena, node) : NULL;
}

static bool check_tag(const yaml_loader *loader, const unsigned char *given, const char *usual, case_location location)
{
    static const char core[] = "tag:yaml.org,2002:";
    const char *tag = (const char *)given;
    if (tag == NULL || strcmp(tag, "!") == 0 || strcmp(tag, usual) == 0) {
        return true;
    }
    const bool is_core = strncmp(tag, core, sizeof core - 1) == 0;
    CLEANUP_FREE char *message = xasprintf("the tag '%s%s' has no meaning in a case; remove it", is_core ? "!!" : "",
                                           is_core ? tag + sizeof core - 1 : tag);
    return refuse(loader, location, message) != NULL;
}

static case_node *load_scalar(yaml_loader *loader, const yaml_event_t *event, case_location location)
{
    const char *text = (const char *)event->data.scalar.value;
    if (!check_tag(loader, event->data.scalar.tag, YAML_DEFAULT_SCALAR_TAG, location)) {
        return NULL;
    }
    if (strlen(text) != event->data.scalar.length) {
        return refuse(loader, location, "a zero byte in a text");
    }
    return node_create_scalar(loader->arena, text, event->data.scalar.style == YAML_PLAIN_SCALAR_STYLE, location);
}

static case_node *load_node(yaml_loader *loader, const yaml_event_t *event, int level);

static void push_waiting(yaml_loader *loader, case_entry entry)
{
    if (loader->n_waiting == loader->capacity) {
        loader->capacity = loader->capacity == 0 ? 64 : 2 * loader->capacity;
        loader->waiting = xrealloc(loader->waiting, (size_t)loader->capacity, sizeof *loader->waiting);
    }
    loader->waiting[loader->n_waiting++] = entry;
}

/** Move the waiting entries from `first` on to a list or block. */
static case_node *take_waiting(yaml_loader *loader, int first, case_node *to)
{
    to->n = to->capacity = loader->n_waiting - first;
    if (to->n > 0) {
        to->entries = arena_packed(loader->arena, (size_t)to->n, sizeof *to->entries);
        memcpy(to->entries, loader->waiting + first, (size_t)to->n * sizeof *to->entries);
    }
    loader->n_waiting = first;
    return to;
}

static bool load_items(yaml_loader *loader, int level)
{
    bool good = true, ends = false;
    while (good && !ends) {
        yaml_event_t event;
        if (!next_event(loader, &event)) {
            return false;
        }
        ends = event.type == YAML_SEQUENCE_END_EVENT;
        if (!ends) {
            case_node *value = load_node(loader, &event, level);
            good = value != NULL;
            if (good) {
                push_waiting(loader, (case_entry){.key_location = value->location, .value = value});
            }
        }
        yaml_event_delete(&event);
    }
    return good;
}

static int by_key(const void *a, const void *b)
{
    const case_entry *left = *(const case_entry *const *)a, *right = *(const case_entry *const *)b;
    const int order = strcmp(left->key, right->key);
    return order != 0 ? order : left < right ? -1 : 1;
}

/** Refuse the first repeated key. */
static bool refuse_repeated(const yaml_loader *loader, int first)
{
    const int n = loader->n_waiting - first;
    const case_entry *repeated = NULL, *earlier = NULL;
    CLEANUP_FREE const case_entry **sorted = xcalloc((size_t)n, sizeof *sorted);
    for (int i = 0; i < n; i++) {
        sorted[i] = &loader->waiting[first + i];
    }
    qsort(sorted, (size_t)n, sizeof(const case_entry *), by_key);
    for (int i = 1; i < n; i++) {
        const bool is_same = strcmp(sorted[i - 1]->key, sorted[i]->key) == 0;
        if (is_same && (repeated == NULL || sorted[i] < repeated)) {
            earlier = sorted[i - 1];
            repeated = sorted[i];
        }
    }
    if (repeated == NULL) {
        return true;
    }
    CLEANUP_FREE char *message = loader->path == NULL ? xasprintf("the key '%s' is given twice", repeated->key)
                                                      : xasprintf("the key '%s' is given twice, first in line %d",
                                                                  repeated->key, earlier->key_location.line);
    return refuse(loader, repeated->key_location, message) != NULL;
}

/** Text of a key: a scalar, or an alias of one. */
static char *load_key(yaml_loader *loader, const yaml_event_t *event, case_location location)
{
    const bool may_be = event->type == YAML_SCALAR_EVENT || event->type == YAML_ALIAS_EVENT;
    const case_node *key = may_be ? load_node(loader, event, MOST_LEVELS) : NULL;
    if (key != NULL && key->kind == NODE_SCALAR) {
        return key->text;
    }
    return may_be && key == NULL ? NULL : refuse(loader, location, "a key must be a word");
}

/** Read a key and its value. */
static bool load_pair(yaml_loader *loader, const yaml_event_t *event, int first, int level)
{
    const case_location location = location_of(loader, event->start_mark);
    char *key = load_key(loader, event, location);
    yaml_event_t next;
    if (key == NULL) {
        return false;
    }
    if (loader->n_waiting - first == MOST_KEYS) {
        return refuse(loader, location, "too many keys in one block") != NULL;
    }
    if (!next_event(loader, &next)) {
        return false;
    }
    case_node *value = load_node(loader, &next, level);
    yaml_event_delete(&next);
    if (value != NULL) {
        push_waiting(loader, (case_entry){.key = key, .key_location = location, .value = value});
    }
    return value != NULL;
}

static bool load_pairs(yaml_loader *loader, int level)
{
    const int first = loader->n_waiting;
    bool good = true, ends = false;
    while (good && !ends) {
        yaml_event_t event;
        if (!next_event(loader, &event)) {
            return false;
        }
        ends = event.type == YAML_MAPPING_END_EVENT;
        good = ends || load_pair(loader, &event, first, level);
        yaml_event_delete(&event);
    }
    return good && refuse_repeated(loader, first);
}

static case_node *load_unnamed(yaml_loader *loader, const yaml_event_t *event, case_location location, int level)
{
    if (!count_node(loader, location, level)) {
        return NULL;
    }
    if (event->type == YAML_SCALAR_EVENT) {
        return load_scalar(loader, event, location);
    }
    const bool is_list = event->type == YAML_SEQUENCE_START_EVENT;
    const unsigned char *tag = is_list ? event->data.sequence_start.tag : event->data.mapping_start.tag;
    if (!check_tag(loader, tag, is_list ? YAML_DEFAULT_SEQUENCE_TAG : YAML_DEFAULT_MAPPING_TAG, location)) {
        return NULL;
    }
    const int first = loader->n_waiting;
    case_node *to = node_create(loader->arena, is_list ? NODE_SEQUENCE : NODE_MAPPING, location);
    const bool good = is_list ? load_items(loader, level + 1) : load_pairs(loader, level + 1);
    return good ? take_waiting(loader, first, to) : NULL;
}

/** Read the node that starts with an event. @return NULL if it was refused */
static case_node *load_node(yaml_loader *loader, const yaml_event_t *event, int level)
{
    const case_location location = location_of(loader, event->start_mark);
    if (event->type == YAML_ALIAS_EVENT) {
        return copy_of_anchor(loader, (const char *)event->data.alias.anchor, location, level);
    }
    const unsigned char *given = event->type == YAML_SCALAR_EVENT           ? event->data.scalar.anchor
                                 : event->type == YAML_SEQUENCE_START_EVENT ? event->data.sequence_start.anchor
                                                                            : event->data.mapping_start.anchor;
    const char *name = (const char *)given;
    if (name != NULL && !begin_anchor(loader, name, location)) {
        return NULL;
    }
    case_node *node = load_unnamed(loader, event, location, level);
    if (node != NULL && name != NULL) {
        bool is_there;
        loader->anchors[anchor_index(loader, name, &is_there)].node = node;
    }
    return node;
}

/* ---- the one document ---- */

/** Read the document of a stream as nodes; NULL if there is none or it was refused; error->code distinguishes these. */
static case_node *load_stream(yaml_loader *loader)
{
    case_node *root = NULL;
    bool ends = false;
    for (int n_documents = 0; !ends;) {
        yaml_event_t event;
        if (!next_event(loader, &event)) {
            return NULL;
        }
        const bool is_bracket = event.type == YAML_STREAM_START_EVENT || event.type == YAML_DOCUMENT_END_EVENT;
        const bool begins = event.type == YAML_DOCUMENT_START_EVENT;
        bool good = true;
        ends = event.type == YAML_STREAM_END_EVENT;
        n_documents += begins ? 1 : 0;
        if (!(ends || is_bracket || begins)) {
            root = n_documents == 1 ? load_node(loader, &event, 0)
                                    : refuse(loader, location_of(loader, event.start_mark),
                                             "a second YAML document; a case is one document");
            good = root != NULL;
        }
        yaml_event_delete(&event);
        if (!good) {
            return NULL;
        }
    }
    return root;
}

case_node *tree_load_yaml(memory_arena *arena, const char *path, case_location location, const char *text,
                          size_t length, evl_error *error)
{
    yaml_loader loader = {
        .arena = arena, .path = path, .location = location, .text = text, .length = length, .error = error};
    if (!yaml_parser_initialize(&loader.parser)) {
        return refuse(&loader, location, "out of memory");
    }
    yaml_parser_set_input_string(&loader.parser, (const unsigned char *)text, length);
    case_node *root = load_stream(&loader);
    yaml_parser_delete(&loader.parser);
    free(loader.waiting);
    free(loader.anchors);
    return root;
}
