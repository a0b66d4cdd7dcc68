#include "case/unit_spelling.h"

#include "base/memory.h"

#include <ctype.h>
#include <stddef.h>
#include <string.h>

enum { N_MICROS = 3, N_POWERS = 3, N_PRODUCTS = 5 };

static const char *const micros[N_MICROS] = {"u", "µ", "μ"}; /* U+00B5, and the Greek letter U+03BC */
static const char *const products[N_PRODUCTS] = {" ", "·", "⋅", "*", ""};

/** A choice from each list. */
typedef struct {
    int micro, power, product, quotient;
} style;

static style style_at(int i)
{
    return (style){.micro = i % N_MICROS,
                   .power = i / N_MICROS % N_POWERS,
                   .product = i / (N_MICROS * N_POWERS) % N_PRODUCTS,
                   .quotient = i / (N_MICROS * N_POWERS * N_PRODUCTS)};
}

/** m2, m^2, m²; in the denominator of a name spelled without a slash: m-2, m^-2, m⁻². */
static const char *power_text(const style *style, bool is_negative, char digit)
{
    static const char *const texts[2][N_POWERS][3] = {{{"", "2", "3"}, {"", "^2", "^3"}, {"", "²", "³"}},
                                                      {{"-1", "-2", "-3"}, {"^-1", "^-2", "^-3"}, {"⁻¹", "⁻²", "⁻³"}}};
    return texts[is_negative ? 1 : 0][style->power][digit - '1'];
}

static bool is_letter(char c)
{
    return isalpha((unsigned char)c) != 0;
}

/** A text under construction. */
typedef struct {
    char *text;
    size_t length;
} spelled;

static void add(spelled *spelled, const char *more)
{
    for (; *more != '\0' && spelled->length + 1 < UNIT_SPELLING_LENGTH; more++) {
        spelled->text[spelled->length++] = *more;
    }
    spelled->text[spelled->length] = '\0';
}

/** Spell letter by letter; 1/min without slash is min-1, and W/(m K) is W m-1 K-1. */
static void spell(const char *name, const style *style, char text[UNIT_SPELLING_LENGTH])
{
    const bool has_stroke = style->quotient == 0;
    bool is_below = false;
    spelled so_far = {text, 0};
    text[0] = '\0';
    for (const char *c = name; *c != '\0'; c++) {
        const char letter[2] = {*c, '\0'};
        if (*c == '/') {
            is_below = true;
            add(&so_far, has_stroke ? letter : text[0] == '\0' ? "" : products[style->product]);
        } else if (*c == ' ') {
            add(&so_far, products[style->product]);
        } else if ((*c == '(' || *c == ')') && !has_stroke) {
            continue;
        } else if (*c == '2' || *c == '3') {
            add(&so_far, power_text(style, is_below && !has_stroke, *c));
        } else if (*c != '1' || has_stroke) {
            add(&so_far, *c == 'u' ? micros[style->micro] : letter);
        }
        if (is_letter(*c) && !is_letter(c[1]) && c[1] != '2' && c[1] != '3') {
            add(&so_far, power_text(style, is_below && !has_stroke, '1'));
        }
    }
}

/** Whether the name is its only spelling: N/m^exponent. */
static bool is_verbatim(const char *name)
{
    return strchr(name, '^') != NULL;
}

/** Whether the name in this style differs from its earlier spellings. Symbols without a separator are accepted behind N
 *  and kg, as in Nm. */
static bool has_style(const char *name, const style *style)
{
    const bool has_stroke = strchr(name, '/') != NULL, has_blank = strchr(name, ' ') != NULL;
    const bool has_power = strpbrk(name, "23") != NULL || style->quotient == 1;
    const bool has_product = has_blank || (style->quotient == 1 && name[0] != '1');
    const bool may_join = has_blank && style->quotient == 0 && (strstr(name, "N ") || strstr(name, "kg "));
    return (style->micro == 0 || strchr(name, 'u') != NULL) && (style->power == 0 || has_power) &&
           (style->product == 0 || (has_product && (style->product < N_PRODUCTS - 1 || may_join))) &&
           (style->quotient == 0 || has_stroke) &&
           (!is_verbatim(name) || style->micro + style->power + style->product + style->quotient == 0);
}

bool unit_spelling(const char *name, int i, char text[UNIT_SPELLING_LENGTH])
{
    const style style = style_at(i);
    const bool has = has_style(name, &style);
    if (has) {
        spell(name, &style, text);
    }
    return has;
}

void unit_typeset(const char *name, char text[UNIT_SPELLING_LENGTH])
{
    spell(strcmp(name, "deg") == 0 ? "°" : name, &(style){.micro = 1, .power = 2, .product = 1}, text);
}

/** Next letter, `u` for micro; '\0' at the end. @param[in,out] text  moved behind it */
static char next_letter(const char **text)
{
    while (**text != '\0') {
        for (int i = 1; i < N_MICROS; i++) {
            const size_t length = strlen(micros[i]);
            if (strncmp(*text, micros[i], length) == 0) {
                *text += length;
                return 'u';
            }
        }
        const char c = *(*text)++;
        if (is_letter(c)) {
            return c;
        }
    }
    return '\0';
}

/** All spellings have the same letters: in most cases this rules out a text quickly. */
static bool has_letters(const char *name, const char *text)
{
    char letter = '\0';
    do {
        letter = next_letter(&name);
        if (letter != next_letter(&text)) {
            return false;
        }
    } while (letter != '\0');
    return true;
}

bool unit_is_spelled(const char *name, const char *text)
{
    char spelling[UNIT_SPELLING_LENGTH];
    bool is_spelled = strcmp(name, text) == 0;
    const bool may_be = !is_spelled && has_letters(name, text);
    for (int i = 1; i < N_UNIT_SPELLINGS && may_be && !is_spelled; i++) {
        is_spelled = unit_spelling(name, i, spelling) && strcmp(spelling, text) == 0;
    }
    return is_spelled;
}

char *unit_of_results(const char *name)
{
    CLEANUP_FREE char *copy = xstrdup(name);
    char *below = strchr(copy, '/'), *rest = NULL;
    if (below == NULL || is_verbatim(name)) {
        return xstrdup(name);
    }
    *below++ = '\0';
    char *text = xstrdup(strcmp(copy, "1") == 0 ? "" : copy); /* 1/Pa is Pa-1 */
    for (const char *word = strtok_r(below, " ()", &rest); word != NULL; word = strtok_r(NULL, " ()", &rest)) {
        const size_t letters = strcspn(word, "0123456789");
        char *longer = xasprintf("%s%s%.*s-%s", text, text[0] == '\0' ? "" : " ", (int)letters, word,
                                 word[letters] == '\0' ? "1" : word + letters);
        free(text);
        text = longer;
    }
    return text;
}
