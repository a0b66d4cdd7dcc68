/* Conversion of nodes to YAML text. */
#include "base/memory.h"
#include "base/number.h"
#include "case/case_tree.h"

#include <stdlib.h>
#include <string.h>
#include <yaml.h>

/** Every event of a tree is well formed and the buffer grows on demand, so only memory allocation can fail. */
static void emit(yaml_emitter_t *emitter, int initialized, yaml_event_t *event)
{
    if (!initialized || !yaml_emitter_emit(emitter, event)) {
        evl_memory_run_out(1, BUFSIZ);
    }
}

static void emit_text(yaml_emitter_t *emitter, const char *text, bool plain)
{
    yaml_event_t event;
    double value = 0;
    char number[NUMBER_TEXT_LENGTH];
    if (plain && number_read(text, &value) == NUMBER_FINITE) {
        number_write(number, value); /* a YAML 1.1 reader takes 1e9 for a string and 012 for ten */
        text = number;
    }
    emit(emitter,
         yaml_scalar_event_initialize(&event, NULL, NULL, (const yaml_char_t *)text, (int)strlen(text), 1, 1,
                                      plain ? YAML_PLAIN_SCALAR_STYLE : YAML_SINGLE_QUOTED_SCALAR_STYLE),
         &event);
}

/** Nested blocks are written line by line, a block or list of single values on one line. */
static bool holds_single_values(const case_node *node)
{
    for (int i = 0; i < node->n; i++) {
        const case_node *value = node->entries[i].value;
        if (value->kind == NODE_MAPPING || (value->kind == NODE_SEQUENCE && node->kind == NODE_SEQUENCE)) {
            return false;
        }
    }
    return true;
}

static void emit_node(yaml_emitter_t *emitter, const case_node *node, int level)
{
    if (node->kind == NODE_SCALAR) {
        emit_text(emitter, node->text, node->plain);
        return;
    }
    const bool in_one_line = level > 0 && holds_single_values(node);
    const bool is_sequence = node->kind == NODE_SEQUENCE;
    yaml_event_t event;
    if (is_sequence) {
        emit(emitter,
             yaml_sequence_start_event_initialize(&event, NULL, NULL, 1,
                                                  in_one_line ? YAML_FLOW_SEQUENCE_STYLE : YAML_BLOCK_SEQUENCE_STYLE),
             &event);
    } else {
        emit(emitter,
             yaml_mapping_start_event_initialize(&event, NULL, NULL, 1,
                                                 in_one_line ? YAML_FLOW_MAPPING_STYLE : YAML_BLOCK_MAPPING_STYLE),
             &event);
    }
    for (int i = 0; i < node->n; i++) {
        if (!is_sequence) {
            emit_text(emitter, node->entries[i].key, true);
        }
        emit_node(emitter, node->entries[i].value, level + 1);
    }
    emit(emitter, is_sequence ? yaml_sequence_end_event_initialize(&event) : yaml_mapping_end_event_initialize(&event),
         &event);
}

char *tree_text(const case_node *root)
{
    char *text = NULL;
    size_t length = 0;
    FILE *stream = memory_open(&text, &length);
    yaml_emitter_t emitter;
    yaml_event_t event;
    if (!yaml_emitter_initialize(&emitter)) {
        evl_memory_run_out(1, BUFSIZ);
    }
    yaml_emitter_set_output_file(&emitter, stream);
    yaml_emitter_set_unicode(&emitter, 1);
    yaml_emitter_set_width(&emitter, 120);
    emit(&emitter, yaml_stream_start_event_initialize(&event, YAML_UTF8_ENCODING), &event);
    emit(&emitter, yaml_document_start_event_initialize(&event, NULL, NULL, NULL, 1), &event);
    emit_node(&emitter, root, 0);
    emit(&emitter, yaml_document_end_event_initialize(&event, 1), &event);
    emit(&emitter, yaml_stream_end_event_initialize(&event), &event);
    (void)yaml_emitter_flush(&emitter);
    yaml_emitter_delete(&emitter);
    memory_close(stream, &text);
    return text;
}
