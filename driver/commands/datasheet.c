#include "analyses/datasheet.h"
#include "analyses/find_mesh.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/write_bytes.h"
#include "commands/cached_case.h"
#include "commands/command.h"
#include "commands/result.h"
#include "commands/warn.h"
#include "files/output_file.h"

#include <errno.h>
#include <string.h>

typedef struct {
    const char *mesh, *output; /**< NULL: the first one; standard output */
    option_values set;
    bool json, quiet;
} datasheet_options;

typedef void (*sheet_writer)(FILE *stream, const datasheet *sheet);

/** Format of a file by the end of its name; NULL if there is none. */
static sheet_writer writer_of(const char *path)
{
    static const struct {
        const char *end;
        sheet_writer write;
    } formats[] = {{".html", datasheet_write_html}, {".md", datasheet_write_markdown}, {".json", datasheet_write_json}};
    const size_t length = strlen(path);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        const size_t n = strlen(formats[i].end);
        if (length > n && strcmp(path + length - n, formats[i].end) == 0) {
            return formats[i].write;
        }
    }
    return NULL;
}

static bool write_file(const char *path, const datasheet *sheet, evl_error *error)
{
    output_file output;
    CLEANUP_FREE char *text = NULL;
    size_t length = 0;
    FILE *stream = memory_open(&text, &length);
    writer_of(path)(stream, sheet);
    memory_close(stream, &text);
    if (!output_file_open(&output, path, error)) {
        return false;
    }
    output.is_open_end = true; /* a checksum at its end would be no HTML, Markdown or JSON */
    errno = 0;
    if (write_bytes(output.descriptor, 0, text, length) != length) {
        (void)output_file_refuse(path, errno == 0 ? EIO : errno, NULL, error);
        output_file_drop(&output, true);
        return false;
    }
    return output_file_close(&output, true, error);
}

static void print_sheet(const case_plan *plan, int mesh, const datasheet_options *options, const char *path,
                        evl_error *error)
{
    datasheet sheet;
    datasheet_make(&sheet, plan, mesh);
    if (options->json) {
        datasheet_write_json(stdout, &sheet);
    } else if (path == NULL) {
        datasheet_write_text(stdout, &sheet);
    }
    if (path != NULL && write_file(path, &sheet, error)) {
        log_note("data sheet of mesh %s: %s", sheet.name, path);
    }
    datasheet_free(&sheet);
}

static evl_exit run_datasheet(const char *file, const void *given, evl_error *error)
{
    const datasheet_options *options = given;
    case_plan plan = {0};
    int mesh;
    log_set_quiet(options->quiet);
    CLEANUP_FREE char *path =
        options->output == NULL ? NULL : result_path("data sheet", options->output, file, "", error);
    if ((options->output == NULL || path != NULL) && cached_case(&plan, file, &options->set, PLAN_ROOT_STRESS, error) &&
        find_mesh(plan.description, options->mesh, &mesh, error)) {
        warn_of_case(&plan, NULL);
        print_sheet(&plan, mesh, options, path, error);
    }
    case_plan_free(&plan);
    return error->code;
}

static const char *check_output(const void *given)
{
    const datasheet_options *options = given;
    return options->output == NULL || writer_of(options->output) != NULL
               ? NULL
               : "option '-o' needs a file that ends in .html, .md or .json";
}

static const option_row rows[] = {
    {OPTION_TEXT, 0, "--mesh", "NAME", offsetof(datasheet_options, mesh),
     "mesh of the data sheet, by name or index; the first one if not given"},
    {OPTION_TEXT, 'o', "--output", "FILE", offsetof(datasheet_options, output),
     "file to write: .html with a drawing, .md or .json; text to standard output if not given"},
    OPTION_ROW_SET(datasheet_options),
    OPTION_ROW_JSON(datasheet_options),
    OPTION_ROW_QUIET(datasheet_options),
    OPTION_ROW_HELP,
};

const command datasheet_command = {
    .name = "datasheet",
    .synopsis = "CASE.yaml [--mesh NAME] [-o FILE.html|.md|.json] [--set PATH=VALUE]... [--json] [-q]",
    .summary = "write the data sheet of a mesh: geometry, inspection, nominal stress, stiffness",
    .text = "Writes one page for a mesh: basic rack, gears, inspection dimensions, tolerances, path of contact with "
            "specific\n"
            "sliding, and at the nominal operating point Hertz pressure, stiffness, resonance speed, dynamic factor "
            "and tooth\n"
            "loss factor. A value that does not exist has a note with the reason.\n"
            "\n"
            "Examples:\n"
            "  evolvent datasheet examples/spur-pair.yaml\n"
            "  evolvent datasheet examples/two-stage-gears.yaml --mesh 1 -o stage.html\n",
    .file = "case file",
    .size = sizeof(datasheet_options),
    OPTION_ROWS(rows),
    .check = check_output,
    .run = run_datasheet,
};
