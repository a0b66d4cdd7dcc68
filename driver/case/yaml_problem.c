#include "case/yaml_problem.h"

#include "base/memory.h"

/** For an invalid character the parser reports only the byte offset. */
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

/** Whether a tab is among the blanks at the start of the line of `mark`. */
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

char *yaml_problem(const yaml_parser_t *parser, bool has_lines, const char *text, size_t length, yaml_mark_t *mark)
{
    const char *problem = parser->problem == NULL ? "unknown problem" : parser->problem;
    *mark = parser->problem_mark;
    if (parser->error == YAML_MEMORY_ERROR) {
        return xstrdup("out of memory");
    }
    if (parser->error == YAML_READER_ERROR) {
        *mark = mark_of_offset(text, length, parser->problem_offset);
        return xasprintf("not readable as UTF-8 text: %s", problem);
    }
    if (is_indented_by_tab(text, length, *mark)) {
        return xstrdup("not valid YAML: a tab; indent with spaces");
    }
    if (parser->context != NULL && has_lines) {
        return xasprintf("not valid YAML: %s (%s, line %zu)", problem, parser->context, parser->context_mark.line + 1);
    }
    return xasprintf("not valid YAML: %s", problem);
}
