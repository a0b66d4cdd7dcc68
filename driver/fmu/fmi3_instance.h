/** An instance of the FMU, and the common procedure of all interface functions: check of the mode, default locale and
 *  rounding during the call, and one line in the importer's log on failure. */
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
    IN_RUINS = 128 /**< a call ended for lack of memory, at any point: the state is undefined */
} instance_mode;
/** Modes during the motion. */
#define IN_MOTION ((unsigned)(IN_EVENT | IN_CONTINUOUS | IN_STEP))
#define IN_ANY 127U

typedef struct {
    motion *motion;
    instance_mode mode;
    bool by_steps; /**< co-simulation, else model exchange */
    bool is_begun; /**< the motion is at its start, with the present parameters and inputs */
    double t_end;  /**< DBL_MAX: not given by the importer */
    char token[SHA256_TEXT];
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback *log;
    fmi3Status status; /**< of the present call */
} instance;

typedef void instance_work(instance *instance, void *with);

/** Execute an interface function in one of the modes. @return its status */
fmi3Status instance_call(fmi3Instance handle, const char *function, unsigned modes, instance_work *work, void *with);
/** Mark the call as failed and log the reason. */
__attribute__((format(printf, 3, 4))) void instance_refuse(instance *instance, fmi3Status status, const char *format,
                                                           ...);
/** Whether n numbers from the importer are finite; else mark the call as failed. */
bool instance_are_finite(instance *instance, size_t n, const double *numbers);
/** Mark the call as failed because the motion failed. */
void instance_fail(instance *instance, dae_code code);
/** Start the motion if necessary. @return false: it failed, which is logged */
bool instance_begin(instance *instance);
