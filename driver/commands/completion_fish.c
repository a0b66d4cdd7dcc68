#include "commands/completion.h"

#include "commands/help.h"

static const char script[] = "# the word of the line that names the case: its numbers have paths, its meshes names\n"
                             "function __evolvent_parameters\n"
                             "    for word in (commandline -opc)\n"
                             "        if string match -qr '\\.ya?ml$' -- $word\n"
                             "            evolvent show $word --parameters 2>/dev/null\n"
                             "            and return\n"
                             "        end\n"
                             "    end\n"
                             "end\n"
                             "\n"
                             "function __evolvent_settings\n"
                             "    __evolvent_parameters | string replace -r ' = .*' '='\n"
                             "end\n"
                             "\n"
                             "function __evolvent_meshes\n"
                             "    __evolvent_parameters | string match -rg '^meshes\\.([^.]+)\\.' | sort -u\n"
                             "end\n"
                             "\n"
                             "complete -c evolvent -f\n";

static const char *source_of(word_kind kind)
{
    static const char shells[] = "-x -a '" COMPLETION_SHELLS "'", outputs[] = "-x -a '" OUTPUT_GROUPS "'";
    static const char *const sources[] = {
        [WORD_ANY] = "-x",
        [WORD_FILE] = "-rF",
        [WORD_CASE] = "-x -a '(__fish_complete_suffix .yaml)'",
        [WORD_DESIGN] = "-x -a '(__fish_complete_suffix .h5)'",
        [WORD_FOLDER] = "-x -a '(__fish_complete_directories)'",
        [WORD_SETTING] = "-x -a '(__evolvent_settings)'",
        [WORD_MESH] = "-x -a '(__evolvent_meshes)'",
        [WORD_OUTPUTS] = outputs,
        [WORD_SHELL] = shells,
    };
    return sources[kind];
}

/** @param condition  for which they are suggested */
static void print_options(FILE *stream, const command *command, const char *condition)
{
    for (int i = 0; i < command->n_options; i++) {
        const option_row *row = &command->options[i];
        fprintf(stream, "complete -c evolvent -n '%s%s' -l %s", condition, command->name, row->name + 2);
        if (row->letter != 0) {
            fprintf(stream, " -s %c", row->letter);
        }
        if (row->argument != NULL) {
            fprintf(stream, " %s", source_of(completion_kind(row->argument)));
        }
        fputs(" -d ", stream);
        completion_print_quoted(stream, row->text, "\\");
        fputc('\n', stream);
    }
}

void completion_print_fish(FILE *stream)
{
    static const char within[] = "__fish_seen_subcommand_from ";
    fputs("# fish completion of evolvent, from: evolvent completion fish\n\n", stream);
    fputs(script, stream);
    print_options(stream, &program_command, "__fish_use_subcommand");
    for (int i = 0; i < n_commands; i++) {
        const command *command = commands[i];
        fprintf(stream, "complete -c evolvent -n __fish_use_subcommand -a %s -d ", command->name);
        completion_print_quoted(stream, command->summary, "\\");
        fprintf(stream, "\ncomplete -c evolvent -n '%s%s' %s\n", within, command->name,
                source_of(completion_kind(command->file)));
        print_options(stream, command, within);
    }
}
