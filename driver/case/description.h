/** A resolved case as plain data: what the case file says, in SI units and radians, defaults filled in. A leaf: knows no other room. */
#ifndef EVOLVENT_DESCRIPTION_H
#define EVOLVENT_DESCRIPTION_H

#include <stdbool.h>

enum { DESCRIPTION_MAX_PARAMETERS = 8 };

typedef struct {
    bool given;
    double value;
} optional_double;

typedef struct {
    char *name;
    double youngs_modulus, poisson_ratio, density;
} material_description;

/** The parameters of one of the kinds that the model offers, as numbers. */
typedef struct {
    int kind;                               /**< index in its table, law_tables.loads or supports */
    int counts[DESCRIPTION_MAX_PARAMETERS]; /**< how many numbers each parameter of the kind has, 0: not given */
    double *numbers;                        /**< one parameter after the other */
} kind_choice;

typedef struct {
    kind_choice choice;
    bool against_housing; /**< otherwise against the ground */
} load_description;

/** A real gear; the rack in modules. */
typedef struct {
    double module, pressure_angle; /**< [m], [rad] */
    double profile_shift;
    double rack_addendum, rack_dedendum, rack_root_radius;
    optional_double tip_diameter, tip_alteration; /**< [m], in modules */
    double thickness_allowance, bore;
} gear_description;

/** Material taken off towards an end of the profile. */
typedef struct {
    double amount;
    bool by_roll_angle;
    double start; /**< diameter [m] or roll angle [rad] */
    bool is_parabolic;
} relief_description;

/** What the flanks of a real gear lack in material; all 0: nothing. */
typedef struct {
    relief_description tip_relief, root_relief;
    double profile_crowning;
    int n_pitch_errors; /**< 0 if none are listed */
    double *pitch_errors;
    int accuracy_class, seed;           /**< class 0: none */
    double runout_amount, runout_phase; /**< [m], [rad] */
} deviation_description;

typedef struct {
    char *name;
    int teeth;                    /**< 0: a disc */
    optional_double pitch_radius; /**< of a disc its radius */
    double width;
    int material; /**< index in description.materials */
    bool has_centre;
    double centre[2];
    optional_double inertia, mass, transverse_inertia;
    double axial_position;
    kind_choice support;
    int n_loads;
    load_description *loads;
    bool has_gear;
    gear_description gear;
    deviation_description deviation;
} wheel_description;

/** A law of a family's table with its parameters in the table's order. */
typedef struct {
    int law;
    double parameters[DESCRIPTION_MAX_PARAMETERS];
} law_choice;

typedef enum { TRACKING_CLOSED_FORM, TRACKING_ALGEBRAIC, TRACKING_DIFFERENTIAL } tracking_kind;

typedef struct {
    char *name;
    int driving, driven;               /**< indices in description.wheels */
    int driving_rotation;              /**< -1 clockwise, +1 counterclockwise */
    optional_double centre_line_angle; /**< [rad] */
    bool paper_rule;
    double pressure_angle; /**< [rad] if not paper_rule; 0 between real gears */
    law_choice contact, damping, friction;
    tracking_kind tracking;
    optional_double centre_distance, backlash; /**< of two real gears */
} mesh_description;

typedef struct {
    char *name;
    int wheels[2]; /**< indices in description.wheels */
    bool rigid;
    double stiffness, damping; /**< unless rigid */
} shaft_description;

typedef enum { MOTION_CONSTANT, MOTION_RATE, MOTION_HARMONIC, MOTION_TABLE } motion_kind;

typedef struct {
    int coordinate; /**< 0..2: translation along x, y, z; 3..5: rotation vector */
    motion_kind kind;
    double value, frequency, phase; /**< constant, rate or amplitude [m or rad]; [Hz]; [rad] */
    int n;                          /**< knots of a table, else 0 */
    double *time, *values;
} motion_description;

typedef enum { HOUSING_FIXED, HOUSING_PRESCRIBED, HOUSING_MOUNTED } housing_kind;

typedef struct {
    housing_kind kind;
    int n_motions;
    motion_description *motions; /**< HOUSING_PRESCRIBED; all from here on HOUSING_MOUNTED */
    double mass, centre_of_mass[3];
    double inertia[3], products_of_inertia[3]; /**< xx, yy, zz; xy, yz, xz */
    double mount_point[3], stiffness[3], damping[3], rotational_stiffness[3], rotational_damping[3];
    double force[3], moment[3];
    double position[3], orientation[4], velocity[3], angular_velocity[3];
} housing_description;

typedef enum { INITIAL_REST, INITIAL_STEADY, INITIAL_SPEEDS } initial_kind;

typedef struct {
    initial_kind kind;
    double *speeds; /**< [n_wheels] for INITIAL_SPEEDS, else NULL */
    double *gaps;   /**< [n_meshes], zeros by default */
} initial_description;

/** INTEGRATOR_OPEN: the case does not say, and the model has not been asked yet what serves it. */
typedef enum { INTEGRATOR_OPEN, INTEGRATOR_IDA, INTEGRATOR_RADAU } integrator_kind;

/** Below it rounding spoils the step control of radau. */
#define RADAU_SMALLEST_TOLERANCE 1e-13

typedef struct {
    integrator_kind integrator;
    double duration, output_interval, tolerance;
    double max_step; /**< [s] */
    initial_description initial;
} simulation_description;

typedef struct {
    char *title; /**< "" if none */
    int n_materials, n_wheels, n_meshes, n_shafts;
    material_description *materials;
    wheel_description *wheels;
    mesh_description *meshes;
    shaft_description *shafts;
    double gravity[3];
    housing_description housing;
    simulation_description simulation;
} description;

/** Free what a description holds. */
void description_clear(description *description);

/* ---- the laws, loads and supports that a model offers, as the case file's schema needs them ---- */

/** A knots parameter is called `time`; it and those at its knots are lists of one length. */
typedef enum { SHAPE_NUMBER, SHAPE_KNOTS, SHAPE_AT_KNOTS, SHAPE_PAIR } parameter_shape;

typedef struct {
    char name[32], units[32], text[96];
    parameter_shape shape;
    bool required;
    double default_value; /**< NaN: it may be missing; of a law the model finds it */
    double minimum, maximum;
    bool minimum_open, maximum_open;
} parameter_row;

typedef struct {
    char name[32], text[96], source[96];
    int n_parameters;
    parameter_row parameters[DESCRIPTION_MAX_PARAMETERS];
} kind_info;

typedef enum { LAWS_CONTACT, LAWS_DAMPING, LAWS_FRICTION, LAWS_FAMILIES } law_family;

typedef struct {
    int count[LAWS_FAMILIES];
    const kind_info *laws[LAWS_FAMILIES];
    int n_loads, n_supports;
    const kind_info *loads, *supports; /**< the kinds of load and of support */
} law_tables;

#endif
