/** What a case can say, a case as data, and what follows from it: the language that the kernel, which makes gearboxes of it, and
 *  the readers of case files share. Plain data without any call.
 *
 *  A row is a key of a block: its type, unit, range, plausible range, default and text. The kernel has the table of all rows
 *  (evl_rows): the case file's schema, its errors and its documentation are made from it. A case is a list of entries, each of them a row with a value. */
#ifndef EVOLVENT_DESCRIPTION_H
#define EVOLVENT_DESCRIPTION_H

#include <stdbool.h>

enum { EVL_SHORT_LENGTH = 32, EVL_PATH_LENGTH = 192, EVL_ROW_TEXT_LENGTH = 256 };

typedef enum {
    EVL_NUMBER = 0,      /**< a number in the range, or one of the words */
    EVL_INTEGER = 1,     /**< a whole number in the range */
    EVL_PAIR = 2,        /**< [x, y], both in the range */
    EVL_TRIPLE = 3,      /**< [x, y, z], all in the range */
    EVL_QUATERNION = 4,  /**< [w, x, y, z], all in the range */
    EVL_SERIES = 5,      /**< a list of numbers */
    EVL_KNOTS = 6,       /**< knots of a table, strictly increasing, at least two */
    EVL_AT_KNOTS = 7,    /**< as many numbers as the block has knots */
    EVL_NAMED = 8,       /**< name: number, for each name */
    EVL_TEXT = 9,        /**< any text */
    EVL_NAME = 10,       /**< a word that names this block in paths and references */
    EVL_REFERENCE = 11,  /**< the name of an element of the list or map `holds` of the case */
    EVL_REFERENCES = 12, /**< [name, name] of two of them */
    EVL_CHOICE = 13,     /**< one of the words */
    EVL_BLOCK = 14,      /**< keys of the block `holds` */
    EVL_LIST = 15,       /**< a list of blocks `holds`, as many as the range says */
    EVL_MAP = 16         /**< name: block `holds`, as many as the range says */
} evl_row_type;

/** One key of a block. */
typedef struct {
    char block[EVL_SHORT_LENGTH];           /**< the block that has it; "case" for the whole file */
    char key[EVL_SHORT_LENGTH];             /**< */
    int type;                               /**< evl_row_type */
    char unit[EVL_SHORT_LENGTH];            /**< of its numbers; "" if they have none */
    char text[EVL_ROW_TEXT_LENGTH];         /**< what it means, one line */
    double minimum, maximum;                /**< range; -/+infinity if unbounded */
    double plausible_least, plausible_most; /**< plausible magnitudes, beside 0; most 0: none stated */
    bool minimum_open, maximum_open;        /**< the end itself is refused */
    bool required;                          /**< */
    char default_text
        [2 * EVL_SHORT_LENGTH]; /**< YAML; "": none, the key stays away. {driving} stands for the value of that key */
    char words[EVL_ROW_TEXT_LENGTH]; /**< choices, separated by blanks, else "" */
    char holds[EVL_SHORT_LENGTH];    /**< block of a block, list or map; list or map of a reference; else "" */
    char variants
        [EVL_ROW_TEXT_LENGTH]; /**< values of the block's first key with which it may stand, separated by blanks; "" for
                                             all; "+KEY": it may stand beside that key only */
} evl_row;

/** One of the kinds of a block that has them: a law, a kind of load or of support. Its rows are those with it in `variants`. */
typedef struct {
    char name[EVL_SHORT_LENGTH];      /**< as in the case file */
    char text[EVL_ROW_TEXT_LENGTH];   /**< one line */
    char source[EVL_ROW_TEXT_LENGTH]; /**< where it comes from; "" if nowhere else */
} evl_kind;

/** A key of a case with its value. The entries of a block, or of an element of a list or map, follow its own, one level deeper.
 *  A list or map has an entry for each element, named numbers one for each number, references one for each name. */
typedef struct {
    int row;               /**< in the table */
    int level;             /**< 1 for keys of the case */
    const char *name;      /**< of the element or number; the word, text or name that is the value; else NULL or "" */
    int n;                 /**< how many numbers */
    const double *numbers; /**< in the unit of the row */
} evl_entry;

/** A procedure of an evl_wheel_store: of a wheel's key, which is all that decides about it, the numbers that were computed.
 *  @return 1: done; 0, to `find` only: they are not known; -1: failed, and so does who asked */
typedef int evl_wheel_call(void *self, int n_key, const double *key, int n, double *numbers);

/** What its owner keeps of wheels that give way (compliance: {model: finite_elements}), the dear part of a gearbox. What is found
 *  counts as if it were computed. Whether threads may share a store is its owner's affair. */
typedef struct {
    void *self;           /**< handed to both */
    evl_wheel_call *find; /**< fill the numbers of a key */
    evl_wheel_call *keep; /**< take what was computed, or put other numbers in its place, which count */
} evl_wheel_store;

/* How a case starts. */
typedef enum {
    EVL_INITIAL_EQUILIBRIUM = -1, /**< nothing accelerates at a position of the first mesh; not in a case file */
    EVL_INITIAL_REST = 0,         /**< every wheel and support at rest */
    EVL_INITIAL_STEADY = 1,       /**< steady motion: slow modes at their mean, fast modes on the quasi-static path */
    EVL_INITIAL_SPEEDS = 2,       /**< given speeds */
    EVL_INITIAL_PERIODIC = 3      /**< on a periodic orbit: evl_gearbox_periodic_start, not evl_gearbox_initial_state */
} evl_initial_kind;

typedef struct {
    int kind;             /**< evl_initial_kind */
    const double *speeds; /**< [n_wheels] [rad/s] for EVL_INITIAL_SPEEDS, else NULL */
    /** [n_meshes] initial gap between the flanks [m], negative: penetration; NULL: all touch. For rest and speeds */
    const double *gaps;
    /** of EVL_INITIAL_EQUILIBRIUM, _STEADY and _PERIODIC, else 0: pitches of the first mesh in the flow of power from the start of contact,
     *  from 0 to 1e6; NaN: a position inside a zone */
    double mesh_position;
} evl_initial;

/** What a quantity that follows from a case is of. */
typedef enum {
    EVL_OF_WHEEL = 0,
    EVL_OF_MESH = 1,
    EVL_OF_GEAR = 2,      /**< a wheel that is a real gear, ISO 21771 */
    EVL_OF_GEAR_MESH = 3, /**< a mesh of two of them */
    EVL_OF_DEVIATION = 4, /**< how the flanks of a wheel deviate */
    EVL_OF_COMPLIANCE = 5 /**< how the wheels of a mesh give way under a line load, and how stiff that makes it */
} evl_of;

enum { EVL_MOST_QUANTITIES = 40 };

typedef enum {
    EVL_DIMS_NONE = 0,
    EVL_DIMS_WHEEL = 1,
    EVL_DIMS_MESH = 2,
    EVL_DIMS_WHEEL_AXIS = 3,
    EVL_DIMS_MESH_AXIS = 4,
    EVL_DIMS_SPACE = 5,       /**< x, y, z */
    EVL_DIMS_QUATERNION = 6,  /**< w, x, y, z */
    EVL_DIMS_WHEEL_SPACE = 7, /**< x, y, z of every wheel */
    EVL_DIMS_MESH_PAIR = 8,   /**< every place for a tooth pair of every mesh */
    EVL_DIMS_SHAFT = 9,
    EVL_DIMS_POSITION = 10,      /**< of the static analysis: every position in the mesh */
    EVL_DIMS_POSITION_PAIR = 11, /**< every place for a tooth pair at every position */
    EVL_DIMS_HARMONIC = 12,      /**< every harmonic */
    EVL_DIMS_ACCELEROMETER = 13  /**< of the housing */
} evl_dims;

/** What is told of a gearbox: an output, or a quantity that follows from a case, in SI units and radians. */
typedef struct {
    char name[EVL_SHORT_LENGTH], units[EVL_SHORT_LENGTH]; /**< units: UDUNITS; "1" if without */
    char symbol[EVL_SHORT_LENGTH];                        /**< as in docs/symbols.md; "" if none */
    char long_name[3 * EVL_SHORT_LENGTH];
    int dims;                   /**< evl_dims, axis being x, y */
    bool is_static, is_integer; /**< is_static: it has no time dimension */
    bool is_largest;            /**< of an extreme: else it is the smallest */
    int watched;                /**< of an extreme: which of the watched outputs, from 0; else -1 */
    int n;                      /**< of a quantity: 1, or 2 for a point */
    double value[2];            /**< of a quantity */
    /** Output of which it is the rate, element by element; if that output has one value, its rate is the sum of all outputs that name
     *  it. "" if none. */
    char rate_of[EVL_SHORT_LENGTH];
    char no_rate[3 * EVL_SHORT_LENGTH]; /**< why it is the rate of no output, though it has the unit of one; else "" */
} evl_output;

/** A parameter: numbers that the description gives. */
typedef struct {
    char path[EVL_PATH_LENGTH];  /**< as in --set: wheels.pinion.tip_relief.amount */
    char unit[EVL_SHORT_LENGTH]; /**< "" if none; angles in degrees */
    int row;                     /**< in the table of rows */
    int n;                       /**< how many numbers */
} evl_parameter;

/* How a mesh stands at a state. */
typedef enum {
    EVL_CONTACT_OPEN = 0,     /**< a gap */
    EVL_CONTACT_LOADED = 1,   /**< penetration and force */
    EVL_CONTACT_UNLOADED = 2, /**< penetration, but the damper would pull: no force */
    EVL_CONTACT_APART = 3,    /**< tracked flanks too far apart to be tracked */
    EVL_CONTACT_OFF = 4       /**< no tooth pair is on the path of contact */
} evl_contact_mode;

typedef struct {
    int tooth_pair; /**< pitches since the start */
    int contact;    /**< evl_contact_mode */
    int friction;   /**< branch of the friction law */
    double
        position; /**< pitches, from 0 to 1, that the tooth pair which came last is, unloaded, from the start of contact */
} evl_mesh_mode;

#endif
