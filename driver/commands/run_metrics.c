#include "commands/run_metrics.h"

#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static double of_mesh(const model_output *rows, const double *values, int row, int mesh)
{
    return values[rows[row].offset + mesh];
}

/** ", 4 impacts at up to 19.7 mm/s", or nothing. */
static void write_impacts(char *text, size_t size, double impacts, double speed)
{
    text[0] = '\0';
    if (impacts > 0) {
        snprintf(text, size, ", %.0f impact%s at up to %.3g mm/s", impacts, impacts > 1 ? "s" : "", 1e3 * speed);
    }
}

/** ", of a tooth pair 1.07, by ISO 6336-1, method B, without deviations 1.01": those that exist. */
static void write_other_factors(char *text, size_t size, const model_output *rows, const double *values, int mesh)
{
    static const struct {
        int row;
        const char *text;
    } factors[] = {{METRIC_pair_dynamic_factor, "of a tooth pair"},
                   {METRIC_dynamic_factor_iso, "K_V by ISO 6336-1, method B, without deviations"},
                   {METRIC_dynamic_factor_iso_of_class, "with those of the classes"}};
    text[0] = '\0';
    for (size_t i = 0; i < sizeof factors / sizeof *factors; i++) {
        const double factor = of_mesh(rows, values, factors[i].row, mesh);
        const size_t length = strlen(text);
        if (!isnan(factor)) {
            snprintf(text + length, size - length, ", %s %.4g", factors[i].text, factor);
        }
    }
}

/** "; flash temperature of the flanks 96.3 K, contact temperature 459.5 K (186.3 degC)", or nothing. */
static void write_temperatures(char *text, size_t size, double flash, double contact)
{
    static const double zero_celsius = 273.15; /* [K] */
    text[0] = '\0';
    if (!isnan(flash)) {
        snprintf(text, size, "; flash temperature of the flanks %.4g K, contact temperature %.4g K (%.4g degC)", flash,
                 contact, contact - zero_celsius);
    }
}

/** Report whether the motion is settled in the window. */
static void report_settled(const settled_result *settled, const metric_span *span)
{
    if (settled->is_settled > 0) {
        log_note("the motion has settled before the window from %.6g to %.6g s", span->from, span->to);
    } else if (settled->reason[0] != '\0') {
        const bool is_unknown = isnan(settled->is_settled);
        (is_unknown ? log_note : log_warning)("the window from %.6g to %.6g s %s: %s", span->from, span->to,
                                              is_unknown ? "may not be settled" : "is not settled", settled->reason);
    }
}

void report_metrics(const metrics *metrics, const model_names *names)
{
    model_output rows[N_METRIC_ROWS];
    CLEANUP_FREE double *values = xcalloc((size_t)metric_rows_lay_out(names, rows), sizeof *values);
    metrics_conclude(metrics, values);
    const metric_span span = metrics_span(metrics);
    for (int m = 0; m < names->meshes.n && span.periods > 0; m++) {
        const double first = values[rows[METRIC_transmission_error_amplitude].offset + m * METRIC_HARMONICS];
        char impacts[64], factors[160], temperatures[128];
        write_other_factors(factors, sizeof factors, rows, values, m);
        write_impacts(impacts, sizeof impacts, of_mesh(rows, values, METRIC_impacts, m),
                      of_mesh(rows, values, METRIC_impact_speed_max, m));
        write_temperatures(temperatures, sizeof temperatures, of_mesh(rows, values, METRIC_flash_temperature_max, m),
                           of_mesh(rows, values, METRIC_contact_temperature_max, m));
        log_note("mesh %s from %.6g to %.6g s: force %.5g N; dynamic factor of the mesh force %.4g%s; transmission "
                 "error %.4g "
                 "um, peak to peak %.4g um, first order %.4g um; without contact %.3g %%%s%s",
                 names->meshes.names[m], span.from, span.to, of_mesh(rows, values, METRIC_normal_force_mean, m),
                 of_mesh(rows, values, METRIC_dynamic_factor, m), factors,
                 1e6 * of_mesh(rows, values, METRIC_transmission_error_mean, m),
                 1e6 * of_mesh(rows, values, METRIC_transmission_error_peak_to_peak, m), 1e6 * first,
                 100 * of_mesh(rows, values, METRIC_share_no_contact, m), impacts, temperatures);
    }
    report_settled(metrics_settled(metrics), &span);
}
