#include "case/unit.h"

#include "base/suggest.h"
#include "base/words.h"
#include "case/unit_spelling.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- the table ---- */

/** A factor in more than double precision: the sum of both parts. {0}: one. */
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

/** 1 of this unit equals 10^exponent times the factor in the key's unit; its zero is the offset. A unit with an offset
 *  has neither exponent nor factor. */
typedef struct {
    const char *name;
    int exponent;
    factor factor;
    long double offset; /**< in the key's unit */
} unit;

typedef struct {
    const char *key_unit, *name;
    int n_read;        /**< number of units used for printed output */
    const unit *units; /**< those first, in descending order; the last one without a name */
} unit_kind;

#define SAME(name) {name, 0, ONE, 0}
#define TEN(name, exponent) {name, exponent, ONE, 0}
#define CELSIUS(name) {name, 0, ONE, 273.15L}
#define UNITS(...)                                                                                                     \
    (const unit[])                                                                                                     \
    {                                                                                                                  \
        __VA_ARGS__, {NULL, 0, ONE, 0}                                                                                 \
    }

/* No kind has both m for milli and M for mega of the same unit. `1/s` is no angular velocity: it could mean
 * revolutions. */
static const unit_kind kinds[] = {
    {"m", "length", 2,
     UNITS(TEN("mm", -3), TEN("um", -6), TEN("nm", -9), TEN("cm", -2), SAME("m"), {"in", -4, {254, 0}, 0})},
    {"s", "time", 3, UNITS(SAME("s"), TEN("ms", -3), TEN("us", -6), {"min", 0, {60, 0}, 0}, {"h", 0, {3600, 0}, 0})},
    {"deg", "angle", 1,
     UNITS(SAME("deg"), SAME("°"), {"rad", 0, PER_DEGREE, 0}, {"mrad", -3, PER_DEGREE, 0}, {"arcmin", 0, SIXTIETH, 0})},
    {"rad/s", "angular velocity", 1,
     UNITS({"rpm", 0, RPM, 0}, {"1/min", 0, RPM, 0}, SAME("rad/s"), {"deg/s", 0, DEGREE, 0}, {"°/s", 0, DEGREE, 0})},
    {"Hz", "frequency", 1, UNITS(SAME("Hz"), TEN("kHz", 3), SAME("1/s"), {"1/min", 0, SIXTIETH, 0})},
    {"N", "force", 1, UNITS(SAME("N"), TEN("kN", 3))},
    {"N m", "torque", 1, UNITS(SAME("N m"), TEN("kN m", 3), TEN("N mm", -3), TEN("N cm", -2), TEN("mN m", -3))},
    {"Pa", "pressure or modulus", 1,
     UNITS(TEN("GPa", 9), TEN("MPa", 6), TEN("kPa", 3), SAME("Pa"), TEN("N/mm2", 6), TEN("kN/mm2", 9), SAME("N/m2"),
           TEN("bar", 5), TEN("N/(mm um)", 9))},
    {"1/Pa", "compliance", 1,
     UNITS(TEN("um mm/N", -9), TEN("mm2/N", -6), SAME("m2/N"), TEN("1/GPa", -9), TEN("1/MPa", -6), SAME("1/Pa"))},
    {"kg", "mass", 2, UNITS(SAME("kg"), TEN("g", -3), TEN("t", 3))},
    {"kg/m3", "density", 1, UNITS(SAME("kg/m3"), TEN("kg/dm3", 3), TEN("g/cm3", 3), TEN("t/m3", 3))},
    {"kg m2", "moment of inertia", 2,
     UNITS(SAME("kg m2"), TEN("kg mm2", -6), TEN("kg cm2", -4), TEN("g cm2", -7), TEN("g mm2", -9))},
    {"m/s", "velocity", 3,
     UNITS(SAME("m/s"), TEN("mm/s", -3), TEN("um/s", -6), TEN("cm/s", -2), {"m/min", 0, SIXTIETH, 0},
           {"km/h", 0, PER_3_6, 0})},
    {"m/s2", "acceleration", 2, UNITS(SAME("m/s2"), TEN("mm/s2", -3))},
    {"N/m", "stiffness", 2,
     UNITS(TEN("N/um", 6), TEN("N/mm", 3), TEN("kN/mm", 6), TEN("kN/m", 3), TEN("MN/m", 6), SAME("N/m"))},
    {"N m/rad", "torsional stiffness", 1,
     UNITS(SAME("N m/rad"), TEN("kN m/rad", 3), TEN("MN m/rad", 6), TEN("N mm/rad", -3),
           {"N m/deg", 0, PER_DEGREE, 0})},
    {"N s/m", "damping", 1, UNITS(SAME("N s/m"), TEN("N s/mm", 3), TEN("kN s/m", 3))},
    {"N m s/rad", "torsional damping", 1,
     UNITS(SAME("N m s/rad"), SAME("N m s"), TEN("N mm s/rad", -3), TEN("N mm s", -3), {"N m/rpm", 0, PER_RPM, 0})},
    {"N s/m2", "damping per penetration", 1, UNITS(SAME("N s/m2"), TEN("N s/mm2", 6))},
    {"N/m^exponent", "force per power of the penetration", 1, UNITS(SAME("N/m^exponent"))},
    {"Pa s", "dynamic viscosity", 2, UNITS(TEN("mPa s", -3), SAME("Pa s"), TEN("cP", -3))},
    {"K", "absolute temperature", 1, UNITS(SAME("K"), CELSIUS("degC"), CELSIUS("°C"))},
    {"W/(m K)", "thermal conductivity", 1, UNITS(SAME("W/(m K)"), TEN("kW/(m K)", 3))},
    {"J/(kg K)", "specific heat capacity", 1, UNITS(SAME("J/(kg K)"), TEN("kJ/(kg K)", 3))},
    {"", "ratio", 1, UNITS(TEN("%", -2))},
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

/* ---- names ---- */

static const unit *find_unit(const unit_kind *kind, const char *text)
{
    const unit *unit = kind->units;
    while (unit->name != NULL && !unit_is_spelled(unit->name, text)) {
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

const char **unit_names(const char *key_unit, memory_arena *arena, int *n)
{
    const unit_kind *kind = kind_of(key_unit);
    *n = kind == NULL ? 0 : count_units(kind);
    const char **names = kind == NULL ? NULL : arena_calloc(arena, (size_t)*n, sizeof *names);
    for (int i = 0; i < *n; i++) {
        names[i] = kind->units[i].name;
    }
    return names;
}

const char **unit_spellings(const char *key_unit, memory_arena *arena, int *n)
{
    const unit_kind *kind = kind_of(key_unit);
    *n = 0;
    if (kind == NULL) {
        return NULL;
    }
    const char **spellings = arena_calloc(arena, (size_t)count_units(kind) * N_UNIT_SPELLINGS, sizeof *spellings);
    char spelling[UNIT_SPELLING_LENGTH];
    for (int i = 0; i < count_units(kind) * N_UNIT_SPELLINGS; i++) {
        if (unit_spelling(kind->units[i / N_UNIT_SPELLINGS].name, i % N_UNIT_SPELLINGS, spelling)) {
            spellings[(*n)++] = arena_copy(arena, spelling);
        }
    }
    return spellings;
}

/* ---- numbers ---- */

/** Skip digits, with or without a decimal point. @return their end */
static const char *skip_digits(const char *text, bool *has_digits)
{
    const size_t before = strspn(text, "0123456789");
    const char *point = text + before;
    const size_t behind = *point == '.' ? strspn(point + 1, "0123456789") : 0;
    *has_digits = before + behind > 0;
    return point + (*point == '.' ? 1 + behind : 0);
}

/** @param[out] digits_end  end of the digits, where an exponent may start
 *  @return end of the number at the start of the text; NULL if there is none */
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

/** The double nearest to the decimal number times a power of ten. */
static double read_shifted(const char *text, const char *digits_end, int shift)
{
    const long written = strtol(*digits_end == 'e' || *digits_end == 'E' ? digits_end + 1 : "0", NULL, 10);
    const long most = 100000; /* beyond the range of doubles */
    const long exponent = (written < -most ? -most : written > most ? most : written) + shift;
    CLEANUP_FREE char *shifted = xasprintf("%.*se%ld", (int)(digits_end - text), text, exponent);
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
    if (unit == NULL || (name == end && *name == '1')) { /* 31/min is ambiguous: the number and the unit 1/min cannot be
                                                          * separated */
        const bool begins_as_one = isalpha((unsigned char)*name) || *name == '%' || (unsigned char)*name >= 0x80;
        return begins_as_one || (name > end && strncmp(name, "1/", 2) == 0) ? QUANTITY_OTHER_UNIT : QUANTITY_NONE;
    }
    const double number = read_shifted(text, digits_end, unit->exponent);
    const factor factor = unit->factor;
    const double scaled = factor.first == 0 ? number : fma(number, factor.first, number * factor.rest);
    const double converted = unit->offset == 0 ? scaled : (double)(strtold(text, NULL) + unit->offset);
    if (!isfinite(converted)) {
        return QUANTITY_NOT_FINITE;
    }
    *value = converted;
    return QUANTITY_CONVERTED;
}

/* ---- printed output ---- */

static reading_unit reading_of(const unit *unit)
{
    const double ten = pow(10.0, -unit->exponent);
    return (reading_unit){unit->name, unit->factor.first == 0 ? ten : ten / unit->factor.first};
}

/** The largest unit in which the number is at least 0.1, unless it is 1e4 or more in it and a larger unit exists. */
static const unit *unit_of_size(const unit_kind *kind, double number)
{
    const double tenth = 0.1 - 1e-12; /* 0.1 mm in metres may be slightly less */
    int i = 0;
    while (i < kind->n_read - 1 && number != 0 && fabs(number) * reading_of(&kind->units[i]).factor < tenth &&
           fabs(number) * reading_of(&kind->units[i + 1]).factor < 1e4) {
        i++;
    }
    return &kind->units[i];
}

reading_unit unit_for_reading(const char *name, double largest)
{
    for (int i = 0; i < N_KINDS; i++) {
        const unit *given = name[0] == '\0' ? NULL : find_unit(&kinds[i], name);
        if (given != NULL) {
            const double in_key_unit = 1 / reading_of(given).factor;
            reading_unit found = reading_of(unit_of_size(&kinds[i], largest * in_key_unit));
            found.factor *= in_key_unit;
            return found;
        }
    }
    return (reading_unit){strcmp(name, "1") == 0 ? "" : name, 1};
}

reading_unit unit_of_name(const char *key_unit, const char *name)
{
    return reading_of(find_unit(kind_of(key_unit), name));
}

char *quantity_text(double value, const char *key_unit)
{
    const unit_kind *kind = kind_of(key_unit);
    char number[NUMBER_TEXT_LENGTH];
    number_write(number, value);
    if (kind == NULL || key_unit[0] == '\0') {
        return xstrdup(number);
    }
    const unit *unit = unit_of_size(kind, value);
    char shown[NUMBER_TEXT_LENGTH];
    if (unit->factor.first == 0) {
        number_write_plain(shown, read_shifted(number, number + strcspn(number, "e"), -unit->exponent));
    } else { /* a speed such as 1500 rpm, if it has few digits */
        (void)snprintf(shown, sizeof shown, "%.10g", value * reading_of(unit).factor);
    }
    char *text = xasprintf("%s %s", shown, unit->name);
    double same = 0;
    const char *behind = NULL;
    if (quantity_read(text, key_unit, &same, &behind) == QUANTITY_CONVERTED && same == value) {
        return text;
    }
    free(text);
    return xasprintf("%s %s", number, key_unit);
}

/* ---- refusals ---- */

/** Kinds of quantity that accept a unit, separated by commas: a new string; empty if none does. */
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
    CLEANUP_FREE const char **names = unit_names(key_unit, NULL, &n);
    CLEANUP_FREE char *list = words_join(n, names, ", "), *others = kinds_with(unit);
    CLEANUP_FREE char *hint = suggest_phrase(unit, n, names);
    CLEANUP_FREE char *found = others[0] != '\0'
                                   ? xasprintf("'%s' is a unit of %s", unit, others)
                                   : xasprintf("the unit '%.*s' is unknown%s", words_cut(unit, 40), unit, hint);
    return key_unit[0] == '\0' ? xasprintf("%s, and this number has none; omit it, or write %s", found, list)
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
