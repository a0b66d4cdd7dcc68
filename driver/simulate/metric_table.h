/** The table of the metrics of a case. A metric is one row here and one line in docs/reference/numbers.md, and so is a quantity.
 *  Names, offsets, lists and the outputs to evaluate are derived from the rows.
 *
 *  A formula reads the accumulators: `w`, the window of a quantity (channel_window); `s`, the sums of a mesh
 *  (mesh_sums); `r`, the root stress of a wheel (root_extremes); `c`, the temperatures of a mesh
 *  (temperature_extremes); `n`, the index of a harmonic; `from`, a metric_source.
 *  Without the quantity or the outputs of its row a metric is NaN. */
#pragma once

/** QUANTITY(output, units, text, dimensions, least value): outputs */
#define METRIC_QUANTITIES(QUANTITY)                                                                                    \
    QUANTITY(transmission_error, "m", "transmission error", "mesh", -INFINITY)                                         \
    QUANTITY(normal_force, "N", "normal force of all tooth pairs", "mesh", 0) /* flanks only push */                   \
    QUANTITY(angular_acceleration, "rad s-2", "angular acceleration", "wheel", -INFINITY)                              \
    QUANTITY(centre_acceleration, "m s-2", "acceleration of the axle", "wheel axis", -INFINITY)                        \
    QUANTITY(accelerometer_acceleration, "m s-2", "acceleration at the accelerometer", "accelerometer", -INFINITY)

/** ROW(quantity, key, units, text, dimensions, formula): metrics of each quantity */
#define METRICS_OF_QUANTITY(ROW, of, units, text, dims)                                                                \
    ROW(of, mean, units, "mean over time of the " text, dims, w->mean)                                                 \
    ROW(of, standard_deviation, units, "standard deviation over time of the " text, dims, sqrt(w->variance))           \
    ROW(of, rms, units, "root mean square over time of the " text, dims, w->rms)                                       \
    ROW(of, peak_to_peak, units, "peak to peak " text, dims, w->high - channel_window_low(w))                          \
    ROW(of, max, units, "largest " text, dims, w->high)                                                                \
    ROW(of, min, units, "smallest " text, dims, channel_window_low(w))                                                 \
    ROW(of, crest_factor, "1",                                                                                         \
        "crest factor (largest distance from the mean over the standard deviation) of the " text, dims,                \
        w->variance > 0 ? fmax(w->high - w->mean, w->mean - w->low) / sqrt(w->variance) : NAN)                         \
    ROW(of, kurtosis, "1", "kurtosis (3 for a normal distribution) of the " text, dims,                                \
        w->variance > 0 ? w->fourth / (w->variance * w->variance) : NAN)                                               \
    ROW(of, amplitude, units, "amplitudes of the mesh orders of the " text, dims " harmonic",                          \
        hypot(w->cosine[n], w->sine[n]))                                                                               \
    ROW(of, phase, "rad", "phases of the mesh orders, A cos(2 pi n xi - phase), of the " text, dims " harmonic",       \
        atan2(w->sine[n], w->cosine[n]))

/** ROW(key, units, text, quantity of meshes or none, outputs whose accumulators it reads, formula): metrics of each mesh */
#define METRICS_OF_MESH(ROW)                                                                                           \
    ROW(share_no_contact, "1", "share of the time without contact", none, NEEDS_PAIRS, s->no_contact / s->time)        \
    ROW(share_one_pair, "1", "share of the time with one pair in contact", none, NEEDS_PAIRS, s->one_pair / s->time)   \
    ROW(share_two_pairs, "1", "share of the time with two pairs in contact", none, NEEDS_PAIRS,                        \
        s->two_pairs / s->time)                                                                                        \
    ROW(share_more_pairs, "1", "share of the time with three or more pairs in contact", none, NEEDS_PAIRS,             \
        s->more_pairs / s->time)                                                                                       \
    ROW(share_coast_flanks, "1", "share of the time with a force on the coast flanks", none, NEEDS_COAST,              \
        s->coast / s->time)                                                                                            \
    ROW(dynamic_factor, "1", "dynamic factor of the mesh force: largest normal force over its mean", normal_force,     \
        NEEDS_NOTHING, w->high / w->mean)                                                                              \
    ROW(pair_normal_force_max, "N", "largest normal force of a tooth pair", none, NEEDS_PAIR_FORCE, s->pair_force)     \
    ROW(pair_dynamic_factor, "1",                                                                                      \
        "dynamic factor of a tooth pair: largest force over its quasi-static maximum under the mean torque", none,     \
        NEEDS_PAIR_FORCE | NEEDS_TORQUE, s->pair_force / find_static_force(from))                                      \
    ROW(dynamic_factor_iso, "1",                                                                                       \
        "dynamic factor K_V of ISO 6336-1, method B, without deviations, at the nominal operating point", none,        \
        NEEDS_NOTHING, model_iso_dynamic_factor(from->model, from->index, false))                                      \
    ROW(dynamic_factor_iso_of_class, "1",                                                                              \
        "dynamic factor K_V of ISO 6336-1, method B, with the tolerances of the classes", none, NEEDS_NOTHING,         \
        model_iso_dynamic_factor(from->model, from->index, true))                                                      \
    ROW(impacts, "1", "impacts: number of contacts of flanks while no tooth pair was in contact", none, NEEDS_NOTHING, \
        (double)s->impacts)                                                                                            \
    ROW(impact_speed_max, "m s-1", "largest approach speed of the flanks", none, NEEDS_NOTHING, s->impact_speed)       \
    ROW(impact_energy, "J", "energy of impacts: kinetic energy of all approaches", none, NEEDS_NOTHING,                \
        isnan(from->mesh->mass) ? NAN : s->impact_energy)                                                              \
    ROW(transmitted_energy, "J", "energy through the mesh: integral of the magnitude of the driving wheel's power",    \
        none, NEEDS_TORQUE, s->energy)                                                                                 \
    ROW(rattle_index, "1", "rattle index: energy of impacts over transmitted energy", none, NEEDS_TORQUE,              \
        s->energy > 0 ? find_impact_energy(from, n) / s->energy : NAN)                                                 \
    ROW(friction_loss_mean, "W", "mean power lost to friction", none, NEEDS_FRICTION, s->friction / s->time)           \
    ROW(friction_efficiency, "1", "efficiency of the mesh: 1 minus friction loss over transmitted energy", none,       \
        NEEDS_FRICTION | NEEDS_TORQUE, s->energy > 0 ? 1 - s->friction / s->energy : NAN)

/** ROW(key, units, text, outputs whose accumulators of meshes it reads, formula): root stress of each wheel. They are
 *  requested by their names only, like the outputs of the root stress. */
#define METRICS_OF_ROOT(ROW)                                                                                           \
    ROW(root_stress_max, "Pa", "largest root stress of all teeth", NEEDS_NOTHING, r.high)                              \
    ROW(root_stress_min, "Pa", "least root stress of all teeth", NEEDS_NOTHING, r.low)                                 \
    ROW(root_stress_range, "Pa", "range of the root stress at one point of the fillets of all teeth", NEEDS_NOTHING,   \
        from->root_range)                                                                                              \
    ROW(root_stress_dynamic_factor, "1",                                                                               \
        "dynamic factor of the root stress: largest value over its quasi-static value under the mean torques",         \
        NEEDS_TORQUE, r.high / find_static_root(from))

/** The same for the temperatures of the tooth pairs of each mesh, requested by their names only. */
#define METRICS_OF_TEMPERATURE(ROW)                                                                                    \
    ROW(flash_temperature_max, "K", "largest flash temperature of a tooth pair, without tip edges", NEEDS_NOTHING,     \
        c.flash)                                                                                                       \
    ROW(contact_temperature_max, "K", "largest contact temperature of a tooth pair, absolute, without tip edges",      \
        NEEDS_NOTHING, c.contact)
