#include "batch/records.h"

#include "commands/command.h"

typedef struct {
    bool brief, counts;
} records_options;

static evl_exit run(const char *file, const void *given, evl_error *error)
{
    const records_options *options = given;
    const records_detail detail = options->counts ? RECORDS_COUNTS : options->brief ? RECORDS_BRIEF : RECORDS_WHOLE;
    return records(stdout, file, detail, error);
}

static const option_row rows[] = {
    {OPTION_FLAG, 0, "--brief", NULL, offsetof(records_options, brief), "omit the metrics of the cases"},
    {OPTION_FLAG, 0, "--counts", NULL, offsetof(records_options, counts),
     "print only the number of cases of each status"},
    OPTION_ROW_HELP,
};

const command records_command = {
    .name = "records",
    .synopsis = "DIR [--brief | --counts]",
    .summary = "print the recorded results of a batch",
    .text = "Prints the journals of a folder, then the last record of each case in the order of the cases. Each line\n"
            "of the output is one JSON object.\n"
            "\n"
            "Examples:\n"
            "  evolvent records torque\n"
            "  evolvent records torque --brief\n",
    .file = "folder",
    .size = sizeof(records_options),
    OPTION_ROWS(rows),
    .run = run,
};
