#include "commands/completion.h"

#include "commands/help.h"

/* Suggestions for each kind of word, one per line, since words may contain blanks. */
static const char script[] =
    "# the words of the line that name the case: its numbers have paths, its meshes names\n"
    "_evolvent_parameters() {\n"
    "    local word\n"
    "    for word in \"${COMP_WORDS[@]:2}\"; do\n"
    "        case $word in\n"
    "        *.yaml | *.yml) \"${COMP_WORDS[0]}\" show \"$word\" --parameters 2>/dev/null && return ;;\n"
    "        esac\n"
    "    done\n"
    "}\n"
    "\n"
    "# lines that begin with a word, as one would type them: names come from a file, and compgen -W runs $() in them\n"
    "_evolvent_quoted() {\n"
    "    local line\n"
    "    while IFS= read -r line; do\n"
    "        printf -v line %q \"$line\"\n"
    "        [[ $line == \"$1\"* ]] && printf '%s\\n' \"$line\"\n"
    "    done\n"
    "    return 0\n"
    "}\n"
    "\n"
    "_evolvent_offer() {\n"
    "    local word=$2\n"
    "    case $1 in\n"
    "    file) compgen -f -- \"$word\" ;;\n"
    "    case) compgen -f -X '!*.yaml' -- \"$word\"; compgen -f -X '!*.yml' -- \"$word\"; compgen -d -- \"$word\" ;;\n"
    "    design) compgen -f -X '!*.h5' -- \"$word\"; compgen -d -- \"$word\" ;;\n"
    "    folder) compgen -d -- \"$word\" ;;\n"
    "    setting) _evolvent_parameters | sed 's/ = .*/=/' | _evolvent_quoted \"$word\" ;;\n"
    "    mesh) _evolvent_parameters | sed -n 's/^meshes\\.\\([^.]*\\)\\..*/\\1/p' | sort -u | "
    "_evolvent_quoted \"$word\" ;;\n"
    "    outputs) compgen -W '" OUTPUT_GROUPS "' -- \"$word\" ;;\n"
    "    shell) compgen -W '" COMPLETION_SHELLS "' -- \"$word\" ;;\n"
    "    words) compgen -W \"$3\" -- \"$word\" ;;\n"
    "    esac\n"
    "}\n"
    "\n"
    "_evolvent() {\n"
    "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}\n"
    "    local kind= options=\n"
    "    if [[ $word == = || $before == = ]]; then # bash breaks --option=value into three words\n"
    "        [[ $word == = ]] && word= || before=${COMP_WORDS[COMP_CWORD - 2]}\n"
    "        [[ $before == --* ]] || return\n"
    "    fi\n";

static const char end[] = "    [[ $kind == file || $kind == case || $kind == design || $kind == folder ]] && compopt "
                          "-o filenames 2>/dev/null\n"
                          "    [[ $kind == setting ]] && compopt -o nospace 2>/dev/null\n"
                          "    mapfile -t COMPREPLY < <(_evolvent_offer \"$kind\" \"$word\" \"$options\")\n"
                          "}\n"
                          "\n"
                          "complete -F _evolvent evolvent\n";

static const char *name_of(word_kind kind)
{
    static const char *const names[] = {
        [WORD_ANY] = "any",       [WORD_FILE] = "file",     [WORD_CASE] = "case",
        [WORD_DESIGN] = "design", [WORD_FOLDER] = "folder", [WORD_SETTING] = "setting",
        [WORD_MESH] = "mesh",     [WORD_SHELL] = "shell",   [WORD_OUTPUTS] = "outputs",
    };
    return names[kind];
}

static void print_options(FILE *stream, const command *command)
{
    for (int i = 0; i < command->n_options; i++) {
        const option_row *row = &command->options[i];
        fprintf(stream, "%s%s", i == 0 ? "" : " ", row->name);
        if (row->letter != 0) {
            fprintf(stream, " -%c", row->letter);
        }
    }
}

static void print_command(FILE *stream, const command *command)
{
    fprintf(stream, "    %s)\n        case $before in\n", command->name);
    for (int i = 0; i < command->n_options; i++) {
        const option_row *row = &command->options[i];
        if (row->argument == NULL) {
            continue;
        }
        fprintf(stream, "        %s", row->name);
        if (row->letter != 0) {
            fprintf(stream, " | -%c", row->letter);
        }
        fprintf(stream, ") kind=%s ;;\n", name_of(completion_kind(row->argument)));
    }
    fprintf(stream, "        *) [[ $word == -* ]] && kind=words || kind=%s ;;\n        esac\n        options='",
            name_of(completion_kind(command->file)));
    print_options(stream, command);
    fputs("' ;;\n", stream);
}

void completion_print_bash(FILE *stream)
{
    fputs("# bash completion of evolvent, from: evolvent completion bash\n\n", stream);
    fputs(script, stream);
    fputs("    if ((COMP_CWORD == 1)); then\n        kind=words options='", stream);
    for (int i = 0; i < n_commands; i++) {
        fprintf(stream, "%s ", commands[i]->name);
    }
    print_options(stream, &program_command);
    fputs("' command=\n    fi\n    case $command in\n", stream);
    for (int i = 0; i < n_commands; i++) {
        print_command(stream, commands[i]);
    }
    fputs("    esac\n", stream);
    fputs(end, stream);
}
