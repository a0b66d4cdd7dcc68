/** Schema of the case file, a case as data, and derived quantities: types shared by the kernel, which creates gearboxes from cases,
 *  and by readers of case files. Plain data only: no procedures.
 *
 *  A row describes one key of a block: its type, unit, range, plausible range, default and text. The kernel holds the table of all
 *  rows (evl_rows), from which case file schema, errors and documentation are made. A case is a list of entries: a row with a value. */
#ifndef EVOLVENT_DESCRIPTION_H
#define EVOLVENT_DESCRIPTION_H

#include <stdbool.h>

enum { EVL_SHORT_LENGTH = 32, EVL_PATH_LENGTH = 192, EVL_ROW_TEXT_LENGTH = 256 };

typedef enum {
    EVL_NUMBER = 0,      /**< a number in the range, or one of `words` */
    EVL_INTEGER = 1,     /**< an integer in the range */
    EVL_PAIR = 2,        /**< [x, y], both in the range */
    EVL_TRIPLE = 3,      /**< [x, y, z], all in the range */
    EVL_QUATERNION = 4,  /**< [w, x, y, z], all in the range */
    EVL_SERIES = 5,      /**< a list of numbers */
    EVL_KNOTS = 6,       /**< knots of a table, strictly increasing, at least two */
    EVL_AT_KNOTS = 7,    /**< as many numbers as the block has knots */
    EVL_NAMED = 8,       /**< name: number, for each name */
    EVL_TEXT = 9,        /**< any text */
    EVL_NAME = 10,       /**< the name of this block in paths and references */
    EVL_REFERENCE = 11,  /**< the name of an element of the list or map `holds` of the case */
    EVL_REFERENCES = 12, /**< [name, name]: two such references */
    EVL_CHOICE = 13,     /**< one of `words` */
    EVL_BLOCK = 14,      /**< a block of type `holds` */
    EVL_LIST = 15,       /**< a list of blocks of type `holds`; the range limits their number */
    EVL_MAP = 16         /**< name: block of type `holds`, for each name; the range limits their number */
} evl_row_type;

/** One key of a block. */
typedef struct {
    char block[EVL_SHORT_LENGTH];           /**< the block that contains the key; "case" for the whole file */
    char key[EVL_SHORT_LENGTH];             /**< name of the key */
    int type;                               /**< evl_row_type */
    char unit[EVL_SHORT_LENGTH];            /**< unit of the numbers; "" if none */
    char text[EVL_ROW_TEXT_LENGTH];         /**< meaning, one line */
    double minimum, maximum;                /**< range; -/+infinity if unbounded */
    double plausible_least, plausible_most; /**< plausible magnitudes; 0 is always plausible; most 0: none given */
    bool minimum_open, maximum_open;        /**< the limit itself is not allowed */
    bool required;                          /**< the key must be present */
    char default_text
        [2 * EVL_SHORT_LENGTH]; /**< YAML; "": none, the key is omitted. {driving} stands for the value of that key */
    char words[EVL_ROW_TEXT_LENGTH]; /**< choices, separated by spaces, else "" */
    char holds[EVL_SHORT_LENGTH];    /**< block type of a block, list or map; list or map of a reference; else "" */
    char variants
        [EVL_ROW_TEXT_LENGTH]; /**< values of the block's first key for which this key is allowed, separated by spaces; ""
                                             for all; "+KEY": only together with KEY; "-KEY": only without KEY */
} evl_row;

/** One variant of a block: a law, a type of load or of support. Its rows list the variant's name in `variants`. */
typedef struct {
    char name[EVL_SHORT_LENGTH];      /**< name in the case file */
    char text[EVL_ROW_TEXT_LENGTH];   /**< description, one line */
    char source[EVL_ROW_TEXT_LENGTH]; /**< literature source; "" if none */
} evl_kind;

/** A key of a case with its value. The entries of a block, or of an element of a list or map, follow its own entry, one level deeper.
 *  A list or map has one entry per element, EVL_NAMED one per number, EVL_REFERENCES one per name. */
typedef struct {
    int row;          /**< index in the table of rows, from 0 */
    int level;        /**< nesting depth: 1 for keys of the case */
    const char *name; /**< name of the element or number; the word, text or name that is the value; else NULL or "" */
    int n;            /**< number of values */
    const double *numbers; /**< [n] values in the unit of the row */
} evl_entry;

/** A procedure of an evl_wheel_store: read or write the computed compliance data of a wheel. The key determines the data completely.
 *  @return 1: done; 0, from `find` only: not in the store; -1: failed, and the creation of the gearbox fails too */
typedef int evl_wheel_call(void *self, int n_key, const double *key, int n, double *numbers);

/** The caller's cache of compliant wheels (compliance: {model: finite_elements}), the most expensive part of creating a gearbox. Cached
 *  data are used as if they were computed. The owner of a store decides whether threads may share it. */
typedef struct {
    void *self;           /**< passed to both procedures */
    evl_wheel_call *find; /**< fill `numbers` for a key */
    evl_wheel_call *put;  /**< store computed `numbers`, or replace them by other values, which are then used */
} evl_wheel_store;

/* Initial condition of a case. */
typedef enum {
    EVL_INITIAL_EQUILIBRIUM = -1, /**< no acceleration at a mesh position; not available in a case file */
    EVL_INITIAL_REST = 0,         /**< all wheels and supports at zero speed */
    EVL_INITIAL_STEADY = 1,       /**< steady motion: slow modes at their mean, fast modes on the quasi-static path */
    EVL_INITIAL_SPEEDS = 2,       /**< prescribed initial speeds */
    EVL_INITIAL_PERIODIC = 3      /**< on a periodic orbit: evl_gearbox_periodic_start, not evl_gearbox_initial_state */
} evl_initial_kind;

typedef struct {
    int kind;             /**< evl_initial_kind */
    const double *speeds; /**< [n_wheels] [rad/s] for EVL_INITIAL_SPEEDS, else NULL */
    /** [n_meshes] initial gap between the flanks [m], negative: penetration; NULL: all in contact. For rest and speeds */
    const double *gaps;
    /** for EVL_INITIAL_EQUILIBRIUM, _STEADY and _PERIODIC, else 0: distance from the start of contact, in pitches of the first mesh in
     *  the power flow (the one with the highest mesh frequency), from 0 to 1e6; NaN: a position within a zone */
    double mesh_position;
} evl_initial;

/** Subject of a derived quantity. */
typedef enum {
    EVL_OF_WHEEL = 0,
    EVL_OF_MESH = 1,
    EVL_OF_GEAR = 2,       /**< an involute gear defined by a basic rack, ISO 21771 */
    EVL_OF_GEAR_MESH = 3,  /**< a mesh of two such gears */
    EVL_OF_DEVIATION = 4,  /**< flank deviations of a wheel */
    EVL_OF_COMPLIANCE = 5, /**< compliance of the gears of a mesh under a line load, and the resulting stiffness */
    EVL_OF_ROOT_STRESS = 6 /**< root stress in mesh i: index 2 i of its driving wheel, 2 i + 1 of its driven wheel */
} evl_of;

enum { EVL_MOST_QUANTITIES = 40 };

enum { EVL_NOTE_LENGTH = 160 };

/** A row of the data sheet of a mesh; SI units and radians. */
typedef struct {
    char section[EVL_SHORT_LENGTH]; /**< heading; rows of a section follow each other */
    char key[EVL_SHORT_LENGTH], symbol[EVL_SHORT_LENGTH];
    char unit[EVL_SHORT_LENGTH];     /**< UDUNITS; "1" if dimensionless */
    char text[3 * EVL_SHORT_LENGTH]; /**< meaning */
    char note[EVL_NOTE_LENGTH];      /**< why a value is NaN; else source or assumption; "" if none */
    int n;                           /**< 1: value[0] of the mesh; 2: one value per gear, driving gear first */
    double value[2];                 /**< NaN: does not exist */
} evl_sheet_row;

/** Drawing of a mesh. The pitch point is the origin, the driving gear (index 0) below it, the driven gear (1) above it. [m] */
typedef struct {
    int sigma;        /**< +1: the driving gear turns clockwise, -1: counterclockwise */
    int wheel[2];     /**< indices of the wheels */
    int teeth[2];     /**< numbers of teeth */
    double centre[2]; /**< y of the axles */
    double base_radius[2], pitch_radius[2], tip_radius[2];
    double root_radius[2]; /**< 0: unknown */
    double points[7][2];   /**< T1, A, B, C, D, E, T2 on the line of action: x, y; NaN: does not exist */
} evl_mesh_picture;

typedef enum {
    EVL_DIMS_NONE = 0,
    EVL_DIMS_WHEEL = 1,
    EVL_DIMS_MESH = 2,
    EVL_DIMS_WHEEL_AXIS = 3,
    EVL_DIMS_MESH_AXIS = 4,
    EVL_DIMS_SPACE = 5,       /**< x, y, z */
    EVL_DIMS_QUATERNION = 6,  /**< w, x, y, z */
    EVL_DIMS_WHEEL_SPACE = 7, /**< x, y, z of every wheel */
    EVL_DIMS_MESH_PAIR = 8,   /**< every tooth pair slot of every mesh */
    EVL_DIMS_SHAFT = 9,
    EVL_DIMS_POSITION = 10,      /**< of the static analysis: every mesh position */
    EVL_DIMS_POSITION_PAIR = 11, /**< every tooth pair slot at every mesh position */
    EVL_DIMS_HARMONIC = 12,      /**< every harmonic */
    EVL_DIMS_ACCELEROMETER = 13, /**< of the housing */
    EVL_DIMS_POSITION_WHEEL = 14 /**< of the static analysis: both wheels at every mesh position */
} evl_dims;

/** An output of a gearbox, or a derived quantity of a case; SI units and radians. */
typedef struct {
    char name[EVL_SHORT_LENGTH], units[EVL_SHORT_LENGTH]; /**< units: UDUNITS; "1" if dimensionless */
    char symbol[EVL_SHORT_LENGTH];                        /**< as in docs/reference/symbols.md; "" if none */
    char long_name[3 * EVL_SHORT_LENGTH];
    int dims;                   /**< evl_dims; the axis components are x, y */
    bool is_static, is_integer; /**< is_static: without a time dimension */
    bool is_largest;            /**< of an extreme: true for a maximum, false for a minimum */
    int monitored;              /**< of an extreme: index of the monitored output, from 0; else -1 */
    int n;                      /**< of a quantity: number of values, 1, or 2 for a point */
    double value[2];            /**< of a quantity */
    /** Name of the output whose time derivative this one is, element by element; "" if none. The derivative of a scalar output is the
     *  sum of all outputs that name it. */
    char rate_of[EVL_SHORT_LENGTH];
    char no_rate[3 * EVL_SHORT_LENGTH]; /**< reason why it is the derivative of no output, despite its unit; else "" */
} evl_output;

/** A parameter: one or more numbers given in the description. */
typedef struct {
    char path[EVL_PATH_LENGTH];  /**< path as in --set: wheels.pinion.tip_relief.amount */
    char unit[EVL_SHORT_LENGTH]; /**< "" if none; angles in degrees */
    int row;                     /**< index in the table of rows */
    int n;                       /**< number of values */
} evl_parameter;

/* Contact mode of a mesh at a state. */
typedef enum {
    EVL_CONTACT_OPEN = 0,     /**< a gap */
    EVL_CONTACT_LOADED = 1,   /**< penetration and force */
    EVL_CONTACT_UNLOADED = 2, /**< penetration, but the contact force would be tensile due to damping: no force */
    EVL_CONTACT_APART = 3,    /**< tracked flanks too far apart to be tracked */
    EVL_CONTACT_OFF = 4       /**< no tooth pair is on the path of contact */
} evl_contact_mode;

typedef struct {
    int tooth_pair;  /**< index: pitches since the start */
    int contact;     /**< evl_contact_mode */
    int friction;    /**< branch of the friction law */
    double position; /**< of the unloaded pair that entered last: pitches from the start of contact, 0 to 1 */
} evl_mesh_mode;

#endif
