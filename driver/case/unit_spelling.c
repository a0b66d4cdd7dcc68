#include "case/unit_spelling.h"

#include <ctype.h>
#include <stdio.h>
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

/** m2, m^2, m²; below the stroke of a name that is spelled without one: m-2, m^-2, m⁻². */
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

static void add(char text[UNIT_SPELLING_LENGTH], const char *more)
{
    const size_t length = strlen(text);
    (void)snprintf(text + length, UNIT_SPELLING_LENGTH - length, "%s", more);
}

/** Letter by letter; 1/min without stroke is min-1. */
static void spell(const char *name, const style *style, char text[UNIT_SPELLING_LENGTH])
{
    const bool has_stroke = style->quotient == 0;
    bool is_below = false;
    text[0] = '\0';
    for (const char *c = name; *c != '\0'; c++) {
        const char letter[2] = {*c, '\0'};
        if (*c == '/') {
            is_below = true;
            add(text, has_stroke ? letter : text[0] == '\0' ? "" : products[style->product]);
        } else if (*c == ' ') {
            add(text, products[style->product]);
        } else if (*c == '2' || *c == '3') {
            add(text, power_text(style, is_below && !has_stroke, *c));
        } else if (*c != '1' || has_stroke) {
            add(text, *c == 'u' ? micros[style->micro] : letter);
        }
        if (is_letter(*c) && !is_letter(c[1]) && c[1] != '2' && c[1] != '3') {
            add(text, power_text(style, is_below && !has_stroke, '1'));
        }
    }
}

/** Whether the name in this style is another spelling than in the earlier ones. Symbols without anything between them are read
 *  behind N and kg, as in Nm. */
static bool has_style(const char *name, const style *style)
{
    const bool has_stroke = strchr(name, '/') != NULL, has_blank = strchr(name, ' ') != NULL;
    const bool has_power = strpbrk(name, "23") != NULL || style->quotient == 1;
    const bool has_product = has_blank || (style->quotient == 1 && name[0] != '1');
    const bool may_join = has_blank && style->quotient == 0 && (strstr(name, "N ") || strstr(name, "kg "));
    const bool is_verbatim = strpbrk(name, "^(") != NULL;
    return (style->micro == 0 || strchr(name, 'u') != NULL) && (style->power == 0 || has_power) &&
           (style->product == 0 || (has_product && (style->product < N_PRODUCTS - 1 || may_join))) &&
           (style->quotient == 0 || has_stroke) &&
           (!is_verbatim || style->micro + style->power + style->product + style->quotient == 0);
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

bool unit_is_spelled(const char *name, const char *text)
{
    char spelling[UNIT_SPELLING_LENGTH];
    const bool begins_alike = strchr("u1", name[0]) != NULL || name[0] == text[0];
    for (int i = 0; i < N_UNIT_SPELLINGS && begins_alike; i++) {
        if (unit_spelling(name, i, spelling) && strcmp(spelling, text) == 0) {
            return true;
        }
    }
    return false;
}
