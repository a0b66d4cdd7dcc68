#include "commands/checkpoint_options.h"

#include "base/memory.h"
#include "base/number.h"

#include <string.h>

bool checkpoint_minutes(const char *text, double *seconds)
{
    double minutes = 0;
    const bool good = number_read(text, &minutes) == NUMBER_FINITE && minutes > 0;
    *seconds = 60 * minutes;
    return good;
}

int checkpoint_times(const char *text, double *at)
{
    int n = 0;
    double before = 0;
    CLEANUP_FREE char *copy = xstrdup(text);
    char *rest = NULL;
    for (const char *word = strtok_r(copy, ",", &rest); word != NULL; word = strtok_r(NULL, ",", &rest), n++) {
        double t = 0;
        if (number_read(word, &t) != NUMBER_FINITE || !(t > before)) {
            return -1;
        }
        before = t;
        if (at != NULL) {
            at[n] = t;
        }
    }
    return n > 0 ? n : -1;
}

bool checkpoint_options_any(const checkpoint_options *options)
{
    return options->continues || options->minutes != NULL || options->at != NULL || options->max_minutes != NULL;
}

const char *checkpoint_options_check(const checkpoint_options *options)
{
    double seconds = 0;
    if (options->minutes != NULL && !checkpoint_minutes(options->minutes, &seconds)) {
        return "--checkpoint takes minutes, a number above 0";
    }
    if (options->max_minutes != NULL && !checkpoint_minutes(options->max_minutes, &seconds)) {
        return "--max-time takes minutes, a number above 0";
    }
    if (options->at != NULL && checkpoint_times(options->at, NULL) < 0) {
        return "--checkpoint-at takes increasing model times above 0 in seconds, separated by commas";
    }
    return NULL;
}
