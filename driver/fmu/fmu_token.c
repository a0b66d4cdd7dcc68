#include "fmu/fmu.h"

#include <evolvent_version.h>
#include <string.h>

void fmu_token(const case_file *file, char token[SHA256_TEXT])
{
    static const char program[] = "evolvent " EVOLVENT_VERSION "\n";
    const char *text = case_text(file);
    sha256 hash;
    sha256_start(&hash);
    sha256_add(&hash, program, strlen(program));
    sha256_add(&hash, text, strlen(text));
    sha256_finish(&hash, token);
}
