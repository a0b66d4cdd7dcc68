#include "case/unit.h"

#include "base/suggest.h"
#include "base/words.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- the table ---- */

/** A factor to more than double precision: both parts together. {0}: one. */
typedef struct {
    double first, rest;
} factor;

#define ONE {0, 0}
#define RPM {0.10471975511965978, -5.1697025413851275e-18}      /* pi/30 */
#define PER_RPM {9.54929658551372, 8.529296317572289e-16}       /* 30/pi */
#define DEGREE {0.017453292519943295, 2.9486522708701687e-19}   /* pi/180 */
#define PER_DEGREE {57.29577951308232, -1.9878495670576283e-15} /* 180/pi */
#define SIXTIETH {0.016666666666666666, 2.312964634635743e-19}  /* 1/60 */
#define PER_3_6 {0.2777777777777778, -1.2335811384723961e-17}   /* 1/3.6 */

/** One of it is 10^exponent times the factor in the key's unit. */
typedef struct {
    const char *name;
    int exponent;
    factor factor;
} unit;

typedef struct {
    const char *key_unit, *name;
    const unit *units; /**< the usual one first, the last one without a name */
} unit_kind;

#define SAME(name) {name, 0, ONE}
#define TEN(name, exponent) {name, exponent, ONE}
#define UNITS(...)                                                                                                     \
    (const unit[])                                                                                                     \
    {                                                                                                                  \
        __VA_ARGS__,                                                                                                   \
        {                                                                                                              \
            NULL, 0, ONE                                                                                               \
        }                                                                                                              \
    }

/* No kind has one unit with both m for milli and M for mega. `1/s` is no angular velocity: it could be turns. */
static const unit_kind kinds[] = {
    {"m", "length", UNITS(TEN("mm", -3), TEN("um", -6), TEN("nm", -9), TEN("cm", -2), SAME("m"), {"in", -4, {254, 0}})},
    {"s", "time", UNITS(SAME("s"), TEN("ms", -3), TEN("us", -6), {"min", 0, {60, 0}}, {"h", 0, {3600, 0}})},
    {"deg", "angle",
     UNITS(SAME("deg"), SAME("°"), {"rad", 0, PER_DEGREE}, {"mrad", -3, PER_DEGREE}, {"arcmin", 0, SIXTIETH})},
    {"rad/s", "angular velocity",
     UNITS({"rpm", 0, RPM}, {"1/min", 0, RPM}, SAME("rad/s"), {"deg/s", 0, DEGREE}, {"°/s", 0, DEGREE})},
    {"Hz", "frequency", UNITS(SAME("Hz"), TEN("kHz", 3), SAME("1/s"), {"1/min", 0, SIXTIETH})},
    {"N", "force", UNITS(SAME("N"), TEN("kN", 3))},
    {"N m", "torque", UNITS(SAME("N m"), TEN("kN m", 3), TEN("N mm", -3), TEN("N cm", -2), TEN("mN m", -3))},
    {"Pa", "pressure or modulus",
     UNITS(TEN("GPa", 9), TEN("MPa", 6), TEN("kPa", 3), SAME("Pa"), TEN("N/mm2", 6), TEN("kN/mm2", 9), SAME("N/m2"),
           TEN("bar", 5))},
    {"1/Pa", "compliance",
     UNITS(TEN("um mm/N", -9), TEN("mm2/N", -6), SAME("m2/N"), TEN("1/GPa", -9), TEN("1/MPa", -6), SAME("1/Pa"))},
    {"kg", "mass", UNITS(SAME("kg"), TEN("g", -3), TEN("t", 3))},
    {"kg/m3", "density", UNITS(SAME("kg/m3"), TEN("kg/dm3", 3), TEN("g/cm3", 3), TEN("t/m3", 3))},
    {"kg m2", "moment of inertia",
     UNITS(SAME("kg m2"), TEN("kg cm2", -4), TEN("kg mm2", -6), TEN("g cm2", -7), TEN("g mm2", -9))},
    {"m/s", "velocity",
     UNITS(SAME("m/s"), TEN("cm/s", -2), TEN("mm/s", -3), TEN("um/s", -6), {"m/min", 0, SIXTIETH},
           {"km/h", 0, PER_3_6})},
    {"m/s2", "acceleration", UNITS(SAME("m/s2"), TEN("mm/s2", -3))},
    {"N/m", "stiffness",
     UNITS(TEN("N/um", 6), TEN("N/mm", 3), TEN("kN/mm", 6), TEN("kN/m", 3), TEN("MN/m", 6), SAME("N/m"))},
    {"N m/rad", "torsional stiffness",
     UNITS(SAME("N m/rad"), TEN("kN m/rad", 3), TEN("MN m/rad", 6), TEN("N mm/rad", -3), {"N m/deg", 0, PER_DEGREE})},
    {"N s/m", "damping", UNITS(SAME("N s/m"), TEN("N s/mm", 3), TEN("kN s/m", 3))},
    {"N m s/rad", "torsional damping",
     UNITS(SAME("N m s/rad"), SAME("N m s"), TEN("N mm s/rad", -3), TEN("N mm s", -3), {"N m/rpm", 0, PER_RPM})},
    {"N s/m2", "damping per penetration", UNITS(SAME("N s/m2"), TEN("N s/mm2", 6))},
    {"N/m^exponent", "force per power of the penetration", UNITS(SAME("N/m^exponent"))},
    {"", "ratio", UNITS(TEN("%", -2))},
};

enum { N_KINDS = sizeof kinds / sizeof *kinds };

static const unit_kind *kind_of(const char *key_unit)
{
    int i = 0;
    while (key_unit != NULL && i < N_KINDS && strcmp(kinds[i].key_unit, key_unit) != 0) {
        i++;
    }
    return key_unit != NULL && i < N_KINDS ? &kinds[i] : NULL;
}

const char *unit_kind_name(const char *key_unit)
{
    const unit_kind *kind = kind_of(key_unit);
    return kind == NULL ? NULL : kind->name;
}

const char *unit_of_keys(int index)
{
    return index < N_KINDS ? kinds[index].key_unit : NULL;
}

/* ---- spellings ---- */

enum { N_MICROS = 3, N_POWERS = 3, N_PRODUCTS = 5, N_QUOTIENTS = 2, N_STYLES = 90, SPELLING_LENGTH = 64 };

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

static void add(char text[SPELLING_LENGTH], const char *more)
{
    const size_t length = strlen(text);
    (void)snprintf(text + length, SPELLING_LENGTH - length, "%s", more);
}

/** Letter by letter; 1/min without stroke is min-1. */
static void spell(const char *name, const style *style, char text[SPELLING_LENGTH])
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
    const bool is_verbatim = strchr(name, '^') != NULL;
    return (style->micro == 0 || strchr(name, 'u') != NULL) && (style->power == 0 || has_power) &&
           (style->product == 0 || (has_product && (style->product < N_PRODUCTS - 1 || may_join))) &&
           (style->quotient == 0 || has_stroke) &&
           (!is_verbatim || style->micro + style->power + style->product + style->quotient == 0);
}

static bool is_spelled(const char *name, const char *text)
{
    char spelling[SPELLING_LENGTH];
    const bool begins_alike = strchr("u1", name[0]) != NULL || name[0] == text[0];
    for (int i = 0; i < N_STYLES && begins_alike; i++) {
        const style style = style_at(i);
        if (has_style(name, &style)) {
            spell(name, &style, spelling);
            if (strcmp(spelling, text) == 0) {
                return true;
            }
        }
    }
    return false;
}

static const unit *find_unit(const unit_kind *kind, const char *text)
{
    const unit *unit = kind->units;
    while (unit->name != NULL && !is_spelled(unit->name, text)) {
        unit++;
    }
    return unit->name == NULL ? NULL : unit;
}

static int count_units(const unit_kind *kind)
{
    int n = 0;
    while (kind->units[n].name != NULL) {
        n++;
    }
    return n;
}

const char **unit_names(const char *key_unit, memory_pool *pool, int *n)
{
    const unit_kind *kind = kind_of(key_unit);
    *n = kind == NULL ? 0 : count_units(kind);
    const char **names = kind == NULL ? NULL : pool_calloc(pool, (size_t)*n, sizeof *names);
    for (int i = 0; i < *n; i++) {
        names[i] = kind->units[i].name;
    }
    return names;
}

const char **unit_spellings(const char *key_unit, memory_pool *pool, int *n)
{
    const unit_kind *kind = kind_of(key_unit);
    *n = 0;
    if (kind == NULL) {
        return NULL;
    }
    const char **spellings = pool_calloc(pool, (size_t)count_units(kind) * N_STYLES, sizeof *spellings);
    char spelling[SPELLING_LENGTH];
    for (int i = 0; i < count_units(kind) * N_STYLES; i++) {
        const style style = style_at(i % N_STYLES);
        const char *name = kind->units[i / N_STYLES].name;
        if (has_style(name, &style)) {
            spell(name, &style, spelling);
            spellings[(*n)++] = pool_copy(pool, spelling);
        }
    }
    return spellings;
}

/* ---- numbers ---- */

/** Digits, with a point among them or not. @return where they end */
static const char *skip_digits(const char *text, bool *has_digits)
{
    const size_t before = strspn(text, "0123456789");
    const char *point = text + before;
    const size_t behind = *point == '.' ? strspn(point + 1, "0123456789") : 0;
    *has_digits = before + behind > 0;
    return point + (*point == '.' ? 1 + behind : 0);
}

/** @param[out] digits_end  where its digits end and an exponent may begin
 *  @return where the number with which the text begins ends; NULL if there is none */
static const char *skip_number(const char *text, const char **digits_end)
{
    bool has_digits = false;
    *digits_end = skip_digits(text + (*text == '-' || *text == '+' ? 1 : 0), &has_digits);
    const char *end = *digits_end;
    if (has_digits && (*end == 'e' || *end == 'E')) {
        const char *exponent = end + (end[1] == '-' || end[1] == '+' ? 2 : 1);
        const size_t n = strspn(exponent, "0123456789");
        end = n == 0 ? end : exponent + n;
    }
    return has_digits ? end : NULL;
}

/** The double next to the decimal number times a power of ten. */
static double read_shifted(const char *text, const char *digits_end, int shift)
{
    const long written = strtol(*digits_end == 'e' || *digits_end == 'E' ? digits_end + 1 : "0", NULL, 10);
    const long most = 100000; /* beyond all doubles */
    const long exponent = (written < -most ? -most : written > most ? most : written) + shift;
    OWNED char *shifted = xasprintf("%.*se%ld", (int)(digits_end - text), text, exponent);
    return strtod(shifted, NULL);
}

quantity_kind quantity_read(const char *text, const char *key_unit, double *value, const char **unit_text)
{
    const number_kind bare = number_read(text, value);
    if (bare != NUMBER_NONE) {
        return bare == NUMBER_FINITE ? QUANTITY_NUMBER : QUANTITY_NOT_FINITE;
    }
    const char *digits_end = NULL, *end = skip_number(text, &digits_end);
    const unit_kind *kind = kind_of(key_unit);
    if (end == NULL || kind == NULL) {
        return QUANTITY_NONE;
    }
    const char *name = end + strspn(end, " ");
    const unit *unit = find_unit(kind, name);
    *unit_text = name;
    if (unit == NULL || (name == end && *name == '1')) { /* 31/min has no beginning */
        const bool begins_as_one = is_letter(*name) || *name == '%' || (unsigned char)*name >= 0x80;
        return begins_as_one || (name > end && strncmp(name, "1/", 2) == 0) ? QUANTITY_OTHER_UNIT : QUANTITY_NONE;
    }
    const double number = read_shifted(text, digits_end, unit->exponent);
    const factor factor = unit->factor;
    const double converted = factor.first == 0 ? number : fma(number, factor.first, number * factor.rest);
    if (!isfinite(converted)) {
        return QUANTITY_NOT_FINITE;
    }
    *value = converted;
    return QUANTITY_CONVERTED;
}

/* ---- refusals ---- */

/** The kinds that take a unit, with commas between them: a new string; empty if none does. */
static char *kinds_with(const char *unit)
{
    const char *names[N_KINDS];
    int n = 0;
    for (int i = 0; i < N_KINDS; i++) {
        if (find_unit(&kinds[i], unit) != NULL) {
            names[n++] = kinds[i].name;
        }
    }
    return words_join(n, names, ", ");
}

char *unit_refusal(const char *key_unit, const char *unit)
{
    int n = 0;
    OWNED const char **names = unit_names(key_unit, NULL, &n);
    OWNED char *list = words_join(n, names, ", "), *others = kinds_with(unit);
    OWNED char *hint = suggest_phrase(unit, n, names);
    OWNED char *found = others[0] != '\0' ? xasprintf("'%s' is a unit of %s", unit, others)
                                          : xasprintf("the unit '%.40s' is not known%s", unit, hint);
    return key_unit[0] == '\0' ? xasprintf("%s, and this number has none; leave it away, or write %s", found, list)
                               : xasprintf("%s; write the %s in %s", found, unit_kind_name(key_unit), list);
}

char *quantity_complaint(const char *text, const char *key_unit, const char *must, double *value)
{
    const char *unit = NULL;
    const quantity_kind kind = quantity_read(text, key_unit, value, &unit);
    return kind == QUANTITY_NUMBER || kind == QUANTITY_CONVERTED ? NULL
           : kind == QUANTITY_OTHER_UNIT                         ? unit_refusal(key_unit, unit)
                                                                 : xstrdup(must);
}
