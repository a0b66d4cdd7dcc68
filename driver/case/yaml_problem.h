/** What libyaml's parser stumbled over, in words. Private to case/. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <yaml.h>

/** @param has_lines  whether lines of the text mean something to who reads the words
 *  @param mark       where it is. @return a new string */
char *yaml_problem(const yaml_parser_t *parser, bool has_lines, const char *text, size_t length, yaml_mark_t *mark);
