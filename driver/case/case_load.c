/* YAML text to nodes: the file's bytes, libyaml's document, a copy of it without aliases. */
#include "base/memory.h"
#include "case/case_tree.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <yaml.h>

enum {
    MOST_BYTES = 32 * 1024 * 1024, /* a case of that size is a mistake, such as a history in place of a case */
    MOST_NODES = 4 * 1000 * 1000,  /* aliases multiply: a few lines can mean any number of nodes */
    MOST_KEYS = 10000,             /* of one block; they are compared with each other */
    MOST_LEVELS = 32
};

typedef struct {
    memory_pool *pool; /* of the nodes */
    const char *path;  /* NULL: the text of an option */
    case_place place;  /* of an option */
    evl_error *error;
    yaml_document_t document;
    int n_nodes;
} yaml_loader;

static case_place place_of(const yaml_loader *loader, yaml_mark_t mark)
{
    return loader->path == NULL ? loader->place
                                : (case_place){.line = (int)mark.line + 1, .column = (int)mark.column + 1};
}

static void refuse(const yaml_loader *loader, case_place place, const char *message)
{
    char text[EVL_ERROR_PLACE_LENGTH];
    place_text(loader->path, place, text);
    (void)evl_error_set(loader->error, EVL_EXIT_CASE, text, "%s", message);
}

/* ---- the parser's refusals ---- */

/** The parser's reader knows only the offset of a byte that is no character. */
static yaml_mark_t mark_of_offset(const char *text, size_t length, size_t offset)
{
    yaml_mark_t mark = {0};
    for (size_t i = 0; i < offset && i < length; i++) {
        mark.column++;
        if (text[i] == '\n') {
            mark.line++;
            mark.column = 0;
        }
    }
    return mark;
}

/** A tab stands among the blanks that begin the line of `mark`. */
static bool is_indented_by_tab(const char *text, size_t length, yaml_mark_t mark)
{
    size_t i = 0;
    for (size_t line = 0; line < mark.line && i < length; i++) {
        line += text[i] == '\n' ? 1 : 0;
    }
    while (i < length && text[i] == ' ') {
        i++;
    }
    return i < length && text[i] == '\t';
}

static void refuse_yaml(const yaml_loader *loader, const yaml_parser_t *parser, const char *text, size_t length)
{
    const char *problem = parser->problem == NULL ? "unknown problem" : parser->problem;
    OWNED char *message = NULL;
    yaml_mark_t mark = parser->problem_mark;
    if (parser->error == YAML_READER_ERROR) {
        mark = mark_of_offset(text, length, parser->problem_offset);
        message = xasprintf("not readable as UTF-8 text: %s", problem);
    } else if (is_indented_by_tab(text, length, mark)) {
        message = xasprintf("not valid YAML: a tab; indent with spaces");
    } else if (parser->context != NULL && loader->path != NULL) {
        message =
            xasprintf("not valid YAML: %s (%s, line %zu)", problem, parser->context, parser->context_mark.line + 1);
    } else {
        message = xasprintf("not valid YAML: %s", problem);
    }
    refuse(loader, place_of(loader, mark), message);
}

/* ---- libyaml's document to nodes ---- */

static bool has_default_tag(const yaml_node_t *node)
{
    static const char *const tags[] = {
        [YAML_SCALAR_NODE] = YAML_DEFAULT_SCALAR_TAG,
        [YAML_SEQUENCE_NODE] = YAML_DEFAULT_SEQUENCE_TAG,
        [YAML_MAPPING_NODE] = YAML_DEFAULT_MAPPING_TAG,
    };
    return node->tag == NULL || strcmp((const char *)node->tag, tags[node->type]) == 0;
}

/** Text of a scalar without a zero byte in it; NULL if it has one. */
static const char *scalar_text(const yaml_node_t *node)
{
    const char *text = (const char *)node->data.scalar.value;
    return strlen(text) == node->data.scalar.length ? text : NULL;
}

static case_node *copy_node(yaml_loader *loader, int id, int level);

static bool copy_sequence(yaml_loader *loader, const yaml_node_t *from, int level, case_node *to)
{
    for (const int *item = from->data.sequence.items.start; item < from->data.sequence.items.top; item++) {
        case_node *value = copy_node(loader, *item, level);
        if (value == NULL) {
            return false;
        }
        node_append(to, NULL, value->place, value);
    }
    return true;
}

static bool copy_mapping(yaml_loader *loader, const yaml_node_t *from, int level, case_node *to)
{
    for (const yaml_node_pair_t *pair = from->data.mapping.pairs.start; pair < from->data.mapping.pairs.top; pair++) {
        const yaml_node_t *key = yaml_document_get_node(&loader->document, pair->key);
        const case_place place = place_of(loader, key->start_mark);
        const char *text = key->type == YAML_SCALAR_NODE ? scalar_text(key) : NULL;
        if (text == NULL) {
            refuse(loader, place, "a key has to be a word");
            return false;
        }
        const int earlier = node_find(to, text);
        if (earlier >= 0) {
            OWNED char *message = loader->path == NULL ? xasprintf("the key '%s' is given twice", text)
                                                       : xasprintf("the key '%s' is given twice, first in line %d",
                                                                   text, to->entries[earlier].key_place.line);
            refuse(loader, place, message);
            return false;
        }
        if (to->n == MOST_KEYS) {
            refuse(loader, place, "too many keys in one block");
            return false;
        }
        case_node *value = copy_node(loader, pair->value, level);
        if (value == NULL) {
            return false;
        }
        node_append(to, text, place, value);
    }
    return true;
}

static case_node *copy_node(yaml_loader *loader, int id, int level)
{
    const yaml_node_t *from = yaml_document_get_node(&loader->document, id);
    const case_place place = place_of(loader, from->start_mark);
    if (level > MOST_LEVELS) {
        refuse(loader, place, "nested too deeply (an alias that contains itself?)");
        return NULL;
    }
    if (++loader->n_nodes > MOST_NODES) {
        refuse(loader, place, "too many values (aliases that multiply?)");
        return NULL;
    }
    if (!has_default_tag(from)) {
        static const char core[] = "tag:yaml.org,2002:";
        const char *tag = (const char *)from->tag;
        const bool is_core = strncmp(tag, core, sizeof core - 1) == 0;
        OWNED char *message = xasprintf("the tag '%s%s' has no meaning in a case; remove it", is_core ? "!!" : "",
                                        is_core ? tag + sizeof core - 1 : tag);
        refuse(loader, place, message);
        return NULL;
    }
    if (from->type == YAML_SCALAR_NODE) {
        const char *text = scalar_text(from);
        if (text == NULL) {
            refuse(loader, place, "a zero byte in a text");
            return NULL;
        }
        return node_create_scalar(loader->pool, text, from->data.scalar.style == YAML_PLAIN_SCALAR_STYLE, place);
    }
    const bool is_sequence = from->type == YAML_SEQUENCE_NODE;
    case_node *to = node_create(loader->pool, is_sequence ? NODE_SEQUENCE : NODE_MAPPING, place);
    const bool good =
        is_sequence ? copy_sequence(loader, from, level + 1, to) : copy_mapping(loader, from, level + 1, to);
    return good ? to : NULL;
}

/** The first document of a parser as nodes; NULL if there is none or it is refused: then error->code tells. */
static case_node *load_document(yaml_loader *loader, yaml_parser_t *parser, const char *text, size_t length)
{
    if (!yaml_parser_load(parser, &loader->document)) {
        refuse_yaml(loader, parser, text, length);
        return NULL;
    }
    const bool is_empty = yaml_document_get_root_node(&loader->document) == NULL;
    case_node *root = is_empty ? NULL : copy_node(loader, 1, 0);
    yaml_document_delete(&loader->document);
    return root;
}

static case_node *load(yaml_loader *loader, const char *text, size_t length)
{
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser)) {
        refuse(loader, loader->place, "out of memory");
        return NULL;
    }
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, length);
    case_node *root = load_document(loader, &parser, text, length);
    if (root != NULL) {
        yaml_document_t second;
        if (!yaml_parser_load(&parser, &second)) {
            refuse_yaml(loader, &parser, text, length);
            root = NULL;
        } else {
            const yaml_node_t *extra = yaml_document_get_root_node(&second);
            if (extra != NULL) {
                refuse(loader, place_of(loader, extra->start_mark), "a second YAML document; a case is one document");
                root = NULL;
            }
            yaml_document_delete(&second);
        }
    }
    yaml_parser_delete(&parser);
    return root;
}

/* ---- files ---- */

static char *read_bytes(FILE *file, const char *path, size_t *length, evl_error *error)
{
    struct stat status;
    if (fstat(fileno(file), &status) == 0 && S_ISDIR(status.st_mode)) {
        evl_error_set(error, EVL_EXIT_CASE, path, "is a directory, not a case file");
        return NULL;
    }
    size_t capacity = 16 * 1024;
    char *text = xcalloc(capacity, 1);
    size_t n = 0;
    while (n <= MOST_BYTES && !feof(file) && !ferror(file)) {
        if (n == capacity) {
            capacity *= 2;
            text = xrealloc(text, capacity, 1);
        }
        n += fread(text + n, 1, capacity - n, file);
    }
    if (ferror(file)) {
        evl_error_set(error, EVL_EXIT_CASE, path, "cannot be read: %s", strerror(errno));
    } else if (n > MOST_BYTES) {
        evl_error_set(error, EVL_EXIT_CASE, path, "larger than %d MiB: not a case file", MOST_BYTES / 1024 / 1024);
    } else {
        *length = n;
        return text;
    }
    free(text);
    return NULL;
}

static case_node *load_named(memory_pool *pool, const char *name, const char *text, size_t length, evl_error *error)
{
    yaml_loader loader = {.pool = pool, .path = name, .error = error};
    case_node *root = load(&loader, text, length);
    if (root == NULL && error->code == EVL_EXIT_OK) {
        evl_error_set(error, EVL_EXIT_CASE, name, "is empty; a case begins with 'format: 1'");
    }
    return root;
}

case_node *tree_load_named(memory_pool *pool, const char *name, const char *text, evl_error *error)
{
    return load_named(pool, name, text, strlen(text), error);
}

const char *tree_file_name(const char *path)
{
    return strcmp(path, "-") == 0 ? "stdin" : path;
}

static case_node *load_stream(memory_pool *pool, const char *name, FILE *file, evl_error *error)
{
    size_t length = 0;
    OWNED char *text = read_bytes(file, name, &length, error);
    return text == NULL ? NULL : load_named(pool, name, text, length, error);
}

case_node *tree_load_file(memory_pool *pool, const char *path, evl_error *error)
{
    const char *name = tree_file_name(path);
    if (name != path) {
        return load_stream(pool, name, stdin, error);
    }
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        evl_error_set(error, EVL_EXIT_CASE, path, "cannot be read: %s", strerror(errno));
        return NULL;
    }
    case_node *root = load_stream(pool, path, file, error);
    (void)fclose(file);
    return root;
}

case_node *tree_load_text(memory_pool *pool, const char *text, case_place place, evl_error *error)
{
    yaml_loader loader = {.pool = pool, .place = place, .error = error};
    case_node *root = load(&loader, text, strlen(text));
    return root == NULL && error->code == EVL_EXIT_OK ? node_create_scalar(pool, "", true, place) : root;
}
