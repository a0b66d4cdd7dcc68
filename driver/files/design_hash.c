#include "files/design_hash.h"

#include "base/memory.h"
#include "base/words.h"

#include <string.h>

static void add_integer(sha256 *hash, long long value)
{
    unsigned char bytes[sizeof(uint64_t)];
    for (size_t i = 0; i < sizeof bytes; i++) {
        bytes[i] = (unsigned char)((uint64_t)value >> 8 * i);
    }
    sha256_add(hash, bytes, sizeof bytes);
}

static void add_real(sha256 *hash, double value)
{
    long long bits = 0;
    memcpy(&bits, &value, sizeof bits);
    add_integer(hash, bits);
}

/** The length comes first, so that different pairs of texts have different input. */
static void add_text(sha256 *hash, const char *text)
{
    const size_t n = strlen(text);
    add_integer(hash, (long long)n);
    sha256_add(hash, text, n);
}

static void add_words(sha256 *hash, const char *text)
{
    CLEANUP_FREE char **words = NULL;
    const int n = words_split(text, &words);
    int n_words = 0;
    for (int i = 0; i < n; i++) { /* consecutive blanks give an empty word */
        words[n_words] = words[i];
        n_words += words[i][0] != '\0' ? 1 : 0;
    }
    add_integer(hash, n_words);
    for (int i = 0; i < n_words; i++) {
        add_text(hash, words[i]);
    }
}

static void add_column(sha256 *hash, const design_column *column, long n)
{
    static const char *const types[] = {[DESIGN_REAL] = "real", [DESIGN_INTEGER] = "integer", [DESIGN_TEXT] = "text"};
    add_text(hash, column->path);
    add_text(hash, types[column->type]);
    for (long i = 0; i < n; i++) {
        const design_value *value = &column->values[i];
        if (column->type == DESIGN_TEXT) {
            add_text(hash, value->text == NULL ? "" : value->text);
        } else if (column->type == DESIGN_INTEGER) {
            add_integer(hash, value->integer);
        } else {
            add_real(hash, value->real);
        }
    }
}

void design_hash(const design *design, const char *maker, char text[SHA256_TEXT])
{
    sha256 hash;
    sha256_start(&hash);
    add_text(&hash, "evolvent design 1");
    add_text(&hash, maker);
    add_text(&hash, design->base_case);
    add_real(&hash, design->window[0]);
    add_real(&hash, design->window[1]);
    add_words(&hash, design->metrics);
    add_words(&hash, design->history_variables);
    add_integer(&hash, design->history_every);
    add_integer(&hash, design->history_rows);
    if (design->respond_over[0] != '\0') {
        add_text(&hash, "respond");
        add_text(&hash, design->respond_over);
        add_text(&hash, design->respond_direction);
        add_integer(&hash, design->respond_periods);
    }
    add_integer(&hash, design->n_cases);
    add_integer(&hash, design->n_columns);
    for (int i = 0; i < design->n_columns; i++) {
        add_column(&hash, &design->columns[i], design->n_cases);
    }
    sha256_finish(&hash, text);
}
