/** Text of a parser error of libyaml. Private to case/. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <yaml.h>

/** @param has_lines  whether line numbers of the text are meaningful to the user
 *  @param mark       location of the error. @return a new string */
char *yaml_problem(const yaml_parser_t *parser, bool has_lines, const char *text, size_t length, yaml_mark_t *mark);
