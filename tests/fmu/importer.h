/** An importer of FMUs in C, which sanitizers can follow: the binary's calls, and cases as FMUs have them. */
#pragma once

#include "fmu/fmi3.h"
#include "fmu/fmu.h"

#include <stdbool.h>
#include <stddef.h>

/* clang-format off */
#define CALLS(X)                                                                                                       \
    X(InstantiateModelExchange) X(InstantiateCoSimulation) X(FreeInstance) X(EnterInitializationMode)                  \
    X(ExitInitializationMode) X(EnterEventMode) X(Terminate) X(Reset) X(EnterConfigurationMode)                        \
    X(ExitConfigurationMode) X(GetFloat64) X(SetFloat64) X(GetFMUState) X(SetFMUState) X(FreeFMUState)                 \
    X(SerializedFMUStateSize) X(SerializeFMUState) X(DeserializeFMUState) X(EvaluateDiscreteStates)                    \
    X(UpdateDiscreteStates) X(EnterContinuousTimeMode) X(CompletedIntegratorStep) X(SetTime) X(SetContinuousStates)    \
    X(GetContinuousStateDerivatives) X(GetEventIndicators) X(GetContinuousStates) X(GetNominalsOfContinuousStates)     \
    X(GetNumberOfEventIndicators) X(GetNumberOfContinuousStates) X(EnterStepMode) X(DoStep) X(GetInt32)                \
    X(SetDebugLogging)
/* clang-format on */
#define POINTER(name) extern __typeof__(fmi3##name) *name;
CALLS(POINTER)
#undef POINTER

enum { MOST = 4096, MOST_STATES = 64 };

/** A case as an FMU has it. */
typedef struct {
    const char *path;
    int n_set;
    const char *set[2];
    char folder[64];
    int n_outputs; /**< values */
} gearbox;
enum { PAPER, RATTLE, COMPLIANT, N_GEARBOXES };
extern gearbox gearboxes[N_GEARBOXES];

extern char logged[4096]; /**< the last line that an FMU said */
extern int n_logged;
void hear(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String text);

/* For a group of tests: load the binary, write the cases. */
int set_up(void **state);
int tear_down(void **state);

/** @param by_steps  co-simulation, else model exchange */
fmi3Instance make(int which, bool by_steps);
/** Through the initialization. */
void begin(fmi3Instance fmu);

enum {
    INSTANTIATED = 1,
    CONFIGURATION = 2,
    INITIALIZATION = 4,
    EVENT = 8,
    CONTINUOUS = 16,
    STEP = 32,
    TERMINATED = 64
};

/** RATTLE in one of these modes. */
fmi3Instance in_mode(int mode);

fmi3Status update(fmi3Instance fmu, bool *again);
fmi3Status step(fmi3Instance fmu, double t, double h);
/** Step `from` and those behind it, up to `to`, of a length that ends nowhere in particular. */
void steps(fmi3Instance fmu, int from, int to);
enum { STEPS = 40 };
/** All of gearboxes[which].n_outputs. */
void outputs(fmi3Instance fmu, int which, double *values);
