#include "commands/completion.h"

#include "base/memory.h"
#include "commands/help.h"

#include <string.h>

static const char script[] =
    "# the word of the line that names the case: its numbers have paths, its meshes names\n"
    "_evolvent_parameters() {\n"
    "    local word\n"
    "    for word in \"${(@Q)words}\"; do # as it is without its quotes\n"
    "        case $word in\n"
    "        *.yaml|*.yml) evolvent show \"$word\" --parameters 2>/dev/null && return ;;\n"
    "        esac\n"
    "    done\n"
    "}\n"
    "\n"
    "_evolvent_settings() {\n"
    "    local -a paths\n"
    "    paths=(${(f)\"$(_evolvent_parameters | sed 's/ = .*//')\"})\n"
    "    compadd -S = -- $paths\n"
    "}\n"
    "\n"
    "_evolvent_meshes() {\n"
    "    local -aU names\n"
    "    names=(${(f)\"$(_evolvent_parameters | sed -n 's/^meshes\\.\\([^.]*\\)\\..*/\\1/p')\"})\n"
    "    compadd -- $names\n"
    "}\n"
    "\n"
    "_evolvent() {\n"
    "    local -a commands\n"
    "    commands=(\n";

static const char end[] =
    "    esac\n"
    "}\n"
    "\n"
    "if [[ $funcstack[1] == _evolvent ]]; then # a file of $fpath, of which this is the function\n"
    "    _evolvent \"$@\"\n"
    "else\n"
    "    compdef _evolvent evolvent\n"
    "fi\n";

static const char *action_of(word_kind kind)
{
    static const char shells[] = "(" COMPLETION_SHELLS ")", outputs[] = "(" OUTPUT_GROUPS ")";
    static const char *const actions[] = {
        [WORD_ANY] = " ",
        [WORD_FILE] = "_files",
        [WORD_CASE] = "_files -g \"*.(yaml|yml)\"",
        [WORD_DESIGN] = "_files -g \"*.h5\"",
        [WORD_FOLDER] = "_files -/",
        [WORD_SETTING] = "_evolvent_settings",
        [WORD_MESH] = "_evolvent_meshes",
        [WORD_OUTPUTS] = outputs,
        [WORD_SHELL] = shells,
    };
    return actions[kind];
}

/** A specification of _arguments: '(-q --quiet)'{-q,--quiet}'[text]', followed by the kind of its value. */
static void print_option(FILE *stream, const option_row *row)
{
    const bool is_list = row->kind == OPTION_LIST;
    fputs(" \\\n            ", stream);
    if (row->letter != 0) {
        fprintf(stream, "'(-%c %s)'{-%c,%s}", row->letter, row->name, row->letter, row->name);
    } else {
        fprintf(stream, "'%s%s'", is_list ? "*" : "", row->name);
    }
    fputs("'['", stream);
    completion_print_quoted(stream, row->text, "[]");
    fputs("']'", stream);
    if (row->argument != NULL) {
        fputs("':'", stream);
        completion_print_quoted(stream, row->argument, ":");
        fprintf(stream, "':%s'", action_of(completion_kind(row->argument)));
    }
}

static void print_options(FILE *stream, const command *command)
{
    fputs("        _arguments -s -S", stream);
    for (int i = 0; i < command->n_options; i++) {
        print_option(stream, &command->options[i]);
    }
}

static void print_command(FILE *stream, const command *command)
{
    fprintf(stream, "    %s)\n", command->name);
    print_options(stream, command);
    fprintf(stream, " \\\n            '%s:%s:%s' ;;\n", command->takes_several ? "*" : "1", command->file,
            action_of(completion_kind(command->file)));
}

void completion_print_zsh(FILE *stream)
{
    fputs("#compdef evolvent\n# zsh completion of evolvent, from: evolvent completion zsh\n\n", stream);
    fputs(script, stream);
    for (int i = 0; i < n_commands; i++) {
        CLEANUP_FREE char *line = xasprintf("%s:%s", commands[i]->name, commands[i]->summary);
        fputs("        ", stream);
        completion_print_quoted(stream, line, "");
        fputc('\n', stream);
    }
    fputs("    )\n    if ((CURRENT == 2)); then\n        _describe command commands\n", stream);
    print_options(stream, &program_command);
    fputs("\n        return\n    fi\n    local command=$words[2]\n    shift words\n    ((CURRENT--))\n    case "
          "$command in\n",
          stream);
    for (int i = 0; i < n_commands; i++) {
        print_command(stream, commands[i]);
    }
    fputs(end, stream);
}
