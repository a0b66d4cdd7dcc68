/** An instance of the FMU, and how every function of the interface is called: in a mode that allows it, with the caller's locale and
 *  rounding set aside, and where it fails with one line to the importer's log. */
#pragma once

#include "fmu/fmi3.h"
#include "fmu/fmu.h"

typedef enum {
    IN_INSTANTIATED = 1,
    IN_INITIALIZATION = 2,
    IN_EVENT = 4,
    IN_CONTINUOUS = 8,
    IN_STEP = 16,
    IN_TERMINATED = 32,
    IN_CONFIGURATION = 64,
    IN_RUINS = 128 /**< a call ended for want of memory, anywhere: nothing can be said of the rest */
} instance_mode;
/** Where the motion is under way. */
#define IN_MOTION ((unsigned)(IN_EVENT | IN_CONTINUOUS | IN_STEP))
#define IN_ANY 127U

typedef struct {
    motion *motion;
    instance_mode mode;
    bool by_steps; /**< co-simulation, else model exchange */
    bool is_begun; /**< the motion is at its start, as parameters and inputs are now */
    double t_end;  /**< DBL_MAX: the importer does not say */
    char token[SHA256_TEXT];
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback *log;
    fmi3Status status; /**< of the present call */
} instance;

typedef void instance_work(instance *instance, void *with);

/** Do the work of a function of the interface in one of the modes. @return its status */
fmi3Status instance_call(fmi3Instance handle, const char *function, unsigned modes, instance_work *work, void *with);
/** The work fails: tell why. */
__attribute__((format(printf, 3, 4))) void instance_refuse(instance *instance, fmi3Status status, const char *format,
                                                           ...);
/** Whether n numbers of the importer's are finite, else the work fails. */
bool instance_are_finite(instance *instance, size_t n, const double *numbers);
/** The work fails since the motion did. */
void instance_fail(instance *instance, dae_code code);
/** Begin the motion if that is to be done yet. @return false: it failed, which is told */
bool instance_begin(instance *instance);
